//! `cargo xtask tidy`: the architecture invariants that text can show, marks that must not land, and links in documentation.

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::bail;

/// Text that may not appear in the sources of some crates.
struct Rule {
    why: &'static str,
    folders: &'static [&'static str],
    except: &'static [&'static str],
    words: &'static [&'static str],
}

const RULES: &[Rule] = &[
    Rule {
        why: "core, ikgen, planning and vision do no input or output and read no clock (invariant 1)",
        folders: &["crates/core/src", "crates/ikgen/src", "crates/planning/src", "crates/vision/src"],
        except: &[],
        words: &["std::fs", "std::env", "std::time", "std::process", "Instant::now", "SystemTime"],
    },
    Rule {
        why: "ikgen, planning and vision know neither kb nor each other (invariant 2)",
        folders: &["crates/ikgen/src", "crates/planning/src", "crates/vision/src", "crates/core/src"],
        except: &[],
        words: &["robotc_kb", "robotc_runtime"],
    },
    Rule {
        why: "planning and vision do not know ikgen (invariant 2)",
        folders: &["crates/planning/src", "crates/vision/src", "crates/core/src"],
        except: &[],
        words: &["robotc_ikgen"],
    },
    Rule {
        why: "only cli, py and xtask read the environment or choose a thread count (invariant 5)",
        folders: &["crates/kb/src", "crates/runtime/src"],
        except: &[],
        words: &["std::env::", "ThreadPoolBuilder"],
    },
    Rule {
        why: "no crate names a robot (invariant 8)",
        folders: &[
            "crates/core/src",
            "crates/ikgen/src",
            "crates/planning/src",
            "crates/vision/src",
            "crates/kb/src",
            "crates/runtime/src",
        ],
        except: &[],
        words: &["\"panda_joint", "\"ur5", "\"wam"],
    },
    Rule {
        why: "parry and glam stay behind core::geom (invariant 10)",
        folders: &["crates"],
        except: &["crates/core/src/geom"],
        words: &["parry3d", "glamx::", "use glam"],
    },
    Rule {
        why: "unfinished work does not land",
        folders: &["crates", "xtask/src"],
        except: &["xtask/src/tidy.rs"],
        words: &["todo!(", "unimplemented!(", "TODO", "FIXME", "#[ignore"],
    },
];

/// Longest file that needs no second look.
const LONGEST_FILE: usize = 1000;

/// Checks all rules; the error lists every breach as `file:line: why`.
pub(crate) fn run(_args: &[String]) -> anyhow::Result<()> {
    let root = crate::workspace::root();
    let mut breaches = Vec::new();
    for rule in RULES {
        for folder in rule.folders {
            for file in sources(&root.join(folder)) {
                check_file(&root, &file, rule, &mut breaches);
            }
        }
    }
    for file in sources(&root.join("crates")) {
        let lines = std::fs::read_to_string(&file)?.lines().count();
        if lines > LONGEST_FILE {
            breaches.push(format!("{}: {lines} lines; one idea a file", shown(&root, &file)));
        }
    }
    breaches.extend(crate::docs::breaches(&root));
    check_generators(&mut breaches)?;
    if !breaches.is_empty() {
        bail!("{}", breaches.join("\n"));
    }
    println!("tidy: all rules kept");
    Ok(())
}

/// Features that link generators.
const GENERATORS: &[&str] = &["robotc-kb feature \"build\"", "robotc-ikgen feature \"generate\""];

/// An application that only plans links no generator (invariant 4): built alone, no dependency of the example asks for
/// one; the command line, which compiles, shows that the words are the right ones.
fn check_generators(breaches: &mut Vec<String>) -> anyhow::Result<()> {
    for (package, has_generators) in [("robotc-embedded", false), ("robotc", true)] {
        let tree = Command::new(env!("CARGO"))
            .args(["tree", "--locked", "--package", package, "--edges", "features,normal"])
            .current_dir(crate::workspace::root())
            .output()?;
        if !tree.status.success() {
            bail!("cargo tree failed: {}", String::from_utf8_lossy(&tree.stderr));
        }
        let tree = String::from_utf8_lossy(&tree.stdout);
        for feature in GENERATORS {
            if tree.contains(feature) != has_generators {
                let verb = if has_generators { "lacks" } else { "links" };
                breaches.push(format!("{package} {verb} {feature}"));
            }
        }
    }
    Ok(())
}

fn check_file(root: &Path, file: &Path, rule: &Rule, breaches: &mut Vec<String>) {
    let name = shown(root, file);
    // Unit tests may do what the code they test may not.
    if file.ends_with("tests.rs") || rule.except.iter().any(|except| name.starts_with(except)) {
        return;
    }
    let Ok(text) = std::fs::read_to_string(file) else { return };
    let code = text.split("#[cfg(test)]\nmod ").next().unwrap_or_default();
    for (number, line) in code.lines().enumerate() {
        let is_comment = line.trim_start().starts_with("//");
        for word in rule.words {
            if line.contains(word) && !is_comment {
                breaches.push(format!("{name}:{}: `{word}`: {}", number + 1, rule.why));
            }
        }
    }
}

/// All Rust files under a folder, sorted; `tests`, `benches` and `examples` folders are left out.
fn sources(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let Ok(entries) = std::fs::read_dir(folder) else { return found };
    for entry in entries.flatten() {
        let path = entry.path();
        let name = entry.file_name();
        if path.is_dir() {
            if !["tests", "benches", "examples", "target"].iter().any(|skip| name == *skip) {
                found.extend(sources(&path));
            }
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
    found.sort();
    found
}

fn shown(root: &Path, file: &Path) -> String {
    file.strip_prefix(root).unwrap_or(file).display().to_string()
}
