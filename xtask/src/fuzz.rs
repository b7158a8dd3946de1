//! `cargo xtask fuzz [TARGET...] [--seconds N]`: fuzzes the readers and keeps what was learnt.
//!
//! For each target: files of the repository and the corpus of before are the seeds; libFuzzer runs for N seconds; the corpus
//! is minimised and cut to a size that can be committed, and the line of the target in `docs/campaigns/fuzz.md` is written.
//! An input that breaks something is put into `fuzz/findings`, from where the tests replay it, and the task fails.
//!
//! Real files of others (`ROBOTC_SHARED_DATA`, or `../shared/data`) are run as they are before that. They take no part in the
//! mutations, since the corpus is published and they may not be.
//!
//! It needs cargo-fuzz (`cargo install cargo-fuzz --locked`) and a nightly compiler.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::{Context, ensure};

use crate::workspace::root;

/// A target: its name, and the endings of files that are its seeds.
type Target = (&'static str, &'static [&'static str]);

const TARGETS: &[Target] = &[
    // Its seeds are compiled; see `crates/fuzz/examples/artefacts.rs`.
    ("artefact", &[]),
    ("grasps", &["acronym.json", "isaac_grasp.yaml", "npz"]),
    ("joint_limits", &["yaml"]),
    ("mesh", &["dae", "obj", "stl"]),
    ("scan", &["csv", "npy", "pcd", "ply", "png", "xyz"]),
    ("program", &["ik"]),
    ("spec", &["toml"]),
    ("srdf", &["srdf"]),
    ("urdf", &["urdf"]),
    ("xacro", &["xacro"]),
];

/// Folders of the repository in which seeds are looked for.
const SEED_FOLDERS: &[&str] = &["specs", "tests", "crates/core/tests", "crates/ikgen/tests"];

/// Seconds for each target when no number is given.
const SECONDS: u64 = 600;

/// Longest input, bytes.
const LONGEST: u64 = 8192;

/// Bytes of a corpus that are kept.
const CORPUS: u64 = 300_000;

/// Longest file of others, bytes.
const LONGEST_REAL: u64 = 4_000_000;

/// What no input may take: megabytes of memory, megabytes in one piece, and seconds; those of more than five are reported.
/// All leave room for the sanitiser: without it these would be about a fifth.
const LIMITS: &[&str] =
    &["-rss_limit_mb=2048", "-malloc_limit_mb=512", "-timeout=20", "-report_slow_units=5"];

/// The table that is kept.
const TABLE: &str = "docs/campaigns/fuzz.md";

/// Fuzzes the targets that are named, or all; stops at the first that finds something.
pub(crate) fn run(args: &[String]) -> anyhow::Result<()> {
    let (targets, seconds) = parse(args)?;
    build()?;
    for target in targets {
        let campaign = Campaign::new(target)?;
        let row = campaign.run(seconds)?;
        println!("| {} | {row} |", target.0);
        write_row(target.0, &row)?;
        let found = campaign.found()?;
        ensure!(found.is_empty(), "these inputs break something, or take long:\n{}", found.join("\n"));
    }
    Ok(())
}

fn parse(args: &[String]) -> anyhow::Result<(Vec<&'static Target>, u64)> {
    let (mut targets, mut seconds) = (Vec::new(), SECONDS);
    let mut args = args.iter();
    while let Some(arg) = args.next() {
        if arg == "--seconds" {
            seconds = args.next().and_then(|n| n.parse().ok()).context("--seconds needs a number")?;
        } else {
            let known = || TARGETS.iter().map(|(name, _)| *name).collect::<Vec<_>>().join(", ");
            let target = TARGETS.iter().find(|(name, _)| name == arg);
            targets.push(target.with_context(|| format!("no target `{arg}`; targets are {}", known()))?);
        }
    }
    Ok((if targets.is_empty() { TARGETS.iter().collect() } else { targets }, seconds))
}

/// Builds all targets once, with the nightly compiler, below `target/fuzz`.
fn build() -> anyhow::Result<()> {
    let mut command = Command::new("cargo");
    // What this task was started with must not choose the compiler.
    command.env_remove("RUSTUP_TOOLCHAIN").current_dir(root());
    let built = command.args(["+nightly", "fuzz", "build", "--target-dir", "target/fuzz"]).status()?;
    ensure!(built.success(), "the targets do not build; it takes cargo-fuzz and a nightly compiler");
    Ok(())
}

/// The folder of what [`build`] built: below the name of this machine's target.
fn programs() -> anyhow::Result<PathBuf> {
    let version = Command::new("rustc").arg("-vV").output()?;
    let version = String::from_utf8_lossy(&version.stdout);
    let host = version.lines().find_map(|line| line.strip_prefix("host: ")).context("rustc has a host")?;
    Ok(root().join("target/fuzz").join(host).join("release"))
}

/// One target being fuzzed.
struct Campaign {
    target: &'static Target,
    /// Scratch: what libFuzzer grows.
    work: PathBuf,
    /// Scratch: inputs that break something, by libFuzzer's names.
    broken: PathBuf,
}

/// What libFuzzer said last.
#[derive(Debug, Default, PartialEq, Eq)]
struct Progress {
    executions: u64,
    coverage: u64,
}

impl Campaign {
    fn new(target: &'static Target) -> anyhow::Result<Self> {
        let scratch = root().join("target/fuzz/campaign").join(target.0);
        if scratch.exists() {
            std::fs::remove_dir_all(&scratch)?;
        }
        let campaign = Self { target, work: scratch.join("corpus"), broken: scratch.join("broken") };
        std::fs::create_dir_all(&campaign.work)?;
        std::fs::create_dir_all(&campaign.broken)?;
        Ok(campaign)
    }

    /// Real files, then fuzzing from the seeds, then a minimal corpus; the cells of the table.
    fn run(&self, seconds: u64) -> anyhow::Result<String> {
        self.seed()?;
        let real = self.real_files()?;
        if !real.is_empty() {
            self.read(&real)?;
        }
        let (time, longest) = (format!("-max_total_time={seconds}"), format!("-max_len={LONGEST}"));
        let Progress { executions, coverage } =
            self.fuzzer(std::slice::from_ref(&self.work), &[&time, &longest])?;
        let minimal = self.work.with_file_name("minimal");
        std::fs::create_dir_all(&minimal)?;
        self.fuzzer(&[minimal.clone(), self.work.clone()], &["-merge=1", &longest])?;
        let corpus = root().join("fuzz/corpus").join(self.target.0);
        let (files, bytes) = keep(&minimal, &corpus)?;
        let (real, kilobytes, found) = (real.len(), bytes.div_ceil(1000), self.found()?.len());
        Ok(format!(
            "{real} | {seconds} | {executions} | {coverage} | {files} files, {kilobytes} kB | {found}"
        ))
    }

    /// Fills the scratch corpus from the repository.
    fn seed(&self) -> anyhow::Result<()> {
        let (name, endings) = *self.target;
        let mut seeds = Vec::new();
        for folder in SEED_FOLDERS.iter().filter(|_| !endings.is_empty()) {
            files(&root().join(folder), endings, LONGEST, &mut seeds)?;
        }
        for kind in ["corpus", "findings"] {
            files(&root().join("fuzz").join(kind).join(name), &[], LONGEST, &mut seeds)?;
        }
        for (number, seed) in seeds.iter().enumerate() {
            std::fs::copy(seed, self.work.join(format!("seed{number}")))?;
        }
        if name == "artefact" {
            let folder = self.work.display().to_string();
            let build =
                ["cargo", "run", "--quiet", "--package", "robotc-fuzz", "--example", "artefacts", "--"];
            crate::workspace::execute(&[&build[..], &[&folder]].concat())?;
        }
        Ok(())
    }

    /// Files with the target's endings that are not part of the repository.
    fn real_files(&self) -> anyhow::Result<Vec<PathBuf>> {
        let given = std::env::var_os("ROBOTC_SHARED_DATA").map(PathBuf::from);
        let folder = given.unwrap_or_else(|| root().join("../shared/data"));
        let mut found = Vec::new();
        for entry in std::fs::read_dir(folder).into_iter().flatten() {
            let path = entry?.path();
            if !path.ends_with("sealed") && path.is_dir() && !self.target.1.is_empty() {
                files(&path, self.target.1, LONGEST_REAL, &mut found)?;
            }
        }
        Ok(found)
    }

    /// Reads files as they are; an error names the one that breaks something. They are not kept: they are not ours.
    fn read(&self, files: &[PathBuf]) -> anyhow::Result<()> {
        let (broke, log) = self.libfuzzer(files, &[])?;
        let last = log.lines().rfind(|line| line.starts_with("Running: ")).unwrap_or_default();
        ensure!(!broke, "{} breaks: {last}", self.target.0);
        Ok(())
    }

    /// Runs libFuzzer on folders, of which it grows the first.
    fn fuzzer(&self, inputs: &[PathBuf], options: &[&str]) -> anyhow::Result<Progress> {
        // How it ends is no failure of this task: what was found tells.
        let (_, log) = self.libfuzzer(inputs, options)?;
        Ok(progress(&log))
    }

    /// Whether libFuzzer broke off, and what it said.
    fn libfuzzer(&self, inputs: &[PathBuf], options: &[&str]) -> anyhow::Result<(bool, String)> {
        let log = self.broken.with_file_name("log");
        let mut command = Command::new(programs()?.join(self.target.0));
        command.args(inputs).args(LIMITS).args(options).arg("-seed=1");
        command.arg(format!("-artifact_prefix={}/", self.broken.display()));
        // SQLite's sources define some globals twice; nothing of ours can.
        command.env("ASAN_OPTIONS", "detect_odr_violation=0");
        let status = command.stdout(Stdio::null()).stderr(std::fs::File::create(&log)?).status()?;
        Ok((!status.success(), String::from_utf8_lossy(&std::fs::read(&log)?).into_owned()))
    }

    /// Puts the inputs that break something where the tests replay them; their paths.
    fn found(&self) -> anyhow::Result<Vec<String>> {
        let findings = root().join("fuzz/findings").join(self.target.0);
        let mut found = Vec::new();
        files(&self.broken, &[], u64::MAX, &mut found)?;
        let mut kept = Vec::new();
        for file in found {
            std::fs::create_dir_all(&findings)?;
            let to = findings.join(file.file_name().context("a file has a name")?);
            std::fs::copy(&file, &to)?;
            kept.push(to.display().to_string());
        }
        Ok(kept)
    }
}

/// All files below a folder with one of the endings (any, when there are none) that are not longer than this; sorted.
fn files(folder: &Path, endings: &[&str], longest: u64, found: &mut Vec<PathBuf>) -> anyhow::Result<()> {
    let Ok(entries) = std::fs::read_dir(folder) else { return Ok(()) };
    let mut paths: Vec<PathBuf> = entries.map(|entry| Ok(entry?.path())).collect::<std::io::Result<_>>()?;
    paths.sort();
    for path in paths {
        let ending = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_lowercase();
        if path.is_dir() {
            files(&path, endings, longest, found)?;
        } else if (endings.is_empty() || endings.contains(&ending.as_str()))
            && std::fs::metadata(&path)?.len() <= longest
        {
            found.push(path);
        }
    }
    Ok(())
}

/// Makes the smallest files of a minimal corpus the one that is committed; their number and bytes.
fn keep(minimal: &Path, corpus: &Path) -> anyhow::Result<(usize, u64)> {
    let mut all = Vec::new();
    files(minimal, &[], LONGEST, &mut all)?;
    ensure!(!all.is_empty(), "the minimal corpus is empty");
    let size = |file: &PathBuf| std::fs::metadata(file).map_or(u64::MAX, |data| data.len());
    all.sort_by_key(size);
    if corpus.exists() {
        std::fs::remove_dir_all(corpus)?;
    }
    std::fs::create_dir_all(corpus)?;
    let (mut count, mut bytes) = (0, 0);
    for file in all {
        if bytes + size(&file) > CORPUS {
            break;
        }
        std::fs::copy(&file, corpus.join(file.file_name().context("a file has a name")?))?;
        bytes += size(&file);
        count += 1;
    }
    Ok((count, bytes))
}

/// What the last status line of a log says.
fn progress(log: &str) -> Progress {
    let line = log.lines().rfind(|line| line.starts_with('#') && line.contains(" cov: ")).unwrap_or_default();
    let number = |text: &str| text.split_whitespace().next().and_then(|word| word.parse().ok()).unwrap_or(0);
    Progress {
        executions: number(line.trim_start_matches('#')),
        coverage: line.split_once(" cov: ").map_or(0, |(_, rest)| number(rest)),
    }
}

/// Writes the row of a target into the table, which has the targets by name.
fn write_row(target: &str, row: &str) -> anyhow::Result<()> {
    let path = root().join(TABLE);
    let text = std::fs::read_to_string(&path).with_context(|| format!("there is no {TABLE}"))?;
    std::fs::write(&path, with_row(&text, target, row)?)?;
    Ok(())
}

/// The page with another row of a target.
fn with_row(text: &str, target: &str, row: &str) -> anyhow::Result<String> {
    let lines: Vec<&str> = text.lines().collect();
    let start = lines.iter().position(|line| line.starts_with("|---")).context("the page has no table")? + 1;
    let end = start + lines[start..].iter().take_while(|line| line.starts_with('|')).count();
    let mut rows: BTreeMap<&str, String> = BTreeMap::new();
    for line in &lines[start..end] {
        rows.insert(line.split('|').nth(1).unwrap_or_default().trim(), (*line).to_owned());
    }
    rows.insert(target, format!("| {target} | {row} |"));
    let mut page: Vec<String> = lines[..start].iter().map(|line| (*line).to_owned()).collect();
    page.extend(rows.into_values());
    page.extend(lines[end..].iter().map(|line| (*line).to_owned()));
    Ok(page.join("\n") + "\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_status_line_counts() {
        let log = "INFO: Seed: 1\n#10\tINITED cov: 5 ft: 6 corp: 1/1b\n\
                   #2048\tDONE   cov: 77 ft: 99 corp: 9/12Kb lim: 40 exec/s: 3 rss: 50Mb\nDone 2048 runs in 3 second(s)\n";
        assert_eq!(progress(log), Progress { executions: 2048, coverage: 77 });
        assert_eq!(progress("killed"), Progress::default());
    }

    #[test]
    fn rows_stand_by_name_and_are_replaced() {
        let page = "# T\n\n| a | b |\n|---|---|\n| mesh | 1 |\n| urdf | 2 |\n\nMore.\n";
        let page = with_row(&with_row(page, "spec", "3").unwrap(), "mesh", "4").unwrap();
        assert_eq!(page, "# T\n\n| a | b |\n|---|---|\n| mesh | 4 |\n| spec | 3 |\n| urdf | 2 |\n\nMore.\n");
    }
}
