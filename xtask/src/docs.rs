//! Documentation that must not rot: links between files, and the files that the map of the thesis names.

use std::path::{Path, PathBuf};

/// The page whose every path in backquotes has to exist.
const MAP: &str = "docs/thesis.md";

/// What is broken, as `file:line: what`: relative links of the pages at the root and under `docs/` and `specs/`, and
/// paths in backquotes on the map of the thesis.
pub(crate) fn breaches(root: &Path) -> Vec<String> {
    let mut breaches = Vec::new();
    for page in pages(root) {
        let name = page.strip_prefix(root).unwrap_or(&page).display().to_string();
        let Ok(text) = std::fs::read_to_string(&page) else { continue };
        let folder = page.parent().unwrap_or(root);
        let mut in_code = false;
        for (number, line) in text.lines().enumerate() {
            in_code ^= line.starts_with("```");
            if in_code {
                continue;
            }
            let number = number + 1;
            for link in links(line) {
                if !folder.join(link).exists() {
                    breaches.push(format!("{name}:{number}: the link to {link} leads nowhere"));
                }
            }
            if name == MAP {
                for path in paths(line).filter(|path| !root.join(path).exists()) {
                    breaches.push(format!("{name}:{number}: there is no {path}"));
                }
            }
        }
    }
    if !root.join(MAP).is_file() {
        breaches.push(format!("there is no {MAP}"));
    }
    breaches
}

/// Markdown files at the root, and under `docs` and `specs`; sorted.
fn pages(root: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut folders = vec![root.join("docs"), root.join("specs")];
    let mut look = |folder: &Path, folders: Option<&mut Vec<PathBuf>>| {
        let entries = std::fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
        let (inner, files): (Vec<PathBuf>, Vec<PathBuf>) = entries.partition(|path| path.is_dir());
        found.extend(files.into_iter().filter(|file| file.extension().is_some_and(|e| e == "md")));
        if let Some(folders) = folders {
            folders.extend(inner);
        }
    };
    look(root, None);
    while let Some(folder) = folders.pop() {
        look(&folder, Some(&mut folders));
    }
    found.sort();
    found
}

/// Targets of `[text](target)` that are files: no addresses, no places on the same page.
fn links(line: &str) -> impl Iterator<Item = &str> {
    line.split("](").skip(1).filter_map(|rest| {
        let target = rest.split(')').next()?.split('#').next()?;
        (!target.is_empty() && !target.contains("://")).then_some(target)
    })
}

/// Paths in backquotes: words with a slash and no space.
fn paths(line: &str) -> impl Iterator<Item = &str> {
    line.split('`').skip(1).step_by(2).filter(|word| word.contains('/') && !word.contains(' '))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn links_and_paths_are_found() {
        let line = "[a](b/c.md#d) `x/y.rs` [e](https://f) `no path` [g](#h) `cargo` ![i](j.png)";
        assert_eq!(links(line).collect::<Vec<_>>(), ["b/c.md", "j.png"]);
        assert_eq!(paths(line).collect::<Vec<_>>(), ["x/y.rs"]);
    }
}
