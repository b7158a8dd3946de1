//! `cargo xtask depots [TRIALS]`: many processes build one specification through every kind of depot, and are killed.
//!
//! Each worker is a process with a knowledge base of its own, as if on a machine of its own; they meet in the depot only. In
//! every trial each worker is killed outright at random moments and started again until it gets to the end. What a newcomer
//! then gets from the depot must be, byte for byte, what one process makes alone.

mod servers;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use anyhow::{Context, ensure};

use self::servers::{Bucket, Database};
use crate::workspace;

const FIXTURES: &str = "crates/cli/tests/fixtures";
const TASK: &str = "tidy.task.toml";

/// Stands for the number of a run in the address of a depot.
const RUN: &str = "RUN";

/// Numbers of shards that are tried.
const SHARDS: [usize; 3] = [1, 3, 7];

/// Runs the trials and prints a table of them.
pub(crate) fn run(args: &[String]) -> anyhow::Result<()> {
    let trials: u32 = args.first().map_or(Ok(3), |n| n.parse()).context("the number of trials")?;
    workspace::execute(&["cargo", "build", "--locked", "-p", "robotc", "--features", "cloud,postgres"])?;
    let program = workspace::root().join("target/debug/robotc").canonicalize()?;
    let folder = tempfile::tempdir()?;
    let bucket = Bucket::start(folder.path())?;
    let database = Database::start(folder.path())?;

    let under = |name: &str| folder.path().join(name).join(RUN);
    let mut depots = vec![
        ("folder", under("depots").display().to_string()),
        ("`file://`", format!("file://{}", under("objects").display())),
    ];
    if let Some(bucket) = &bucket {
        depots.push(("`s3://`", format!("s3://{}/{RUN}", bucket.name)));
    }
    if let Some(database) = &database {
        depots.push(("`postgres://`", database.address.clone()));
    }
    if let (Some(bucket), Some(database)) = (&bucket, &database) {
        depots
            .push(("`s3://` and `postgres://`", format!("s3://{}/{RUN},{}", bucket.name, database.address)));
    }
    let mut workshop = Workshop { program, folder: folder.path().to_owned(), settings: BTreeMap::new() };
    workshop.settings.extend(bucket.iter().flat_map(|bucket| bucket.settings.clone()));
    for file in std::fs::read_dir(workspace::root().join(FIXTURES))? {
        let file = file?.path();
        std::fs::copy(&file, folder.path().join(file.file_name().context("a name")?))?;
    }

    let start = Instant::now();
    let expected = workshop.lock("alone")?;
    println!("one process alone: {:.1} s", start.elapsed().as_secs_f64());
    println!("| depot | shards | trials | whole | kills | seconds a trial |\n|---|---|---|---|---|---|");
    let mut random = Random(0x9e37_79b9_7f4a_7c15);
    let mut number = 0;
    // An empty depot for each run: a place of its own, and where that is a database, emptied.
    let mut empty = |depot: &str| -> anyhow::Result<String> {
        number += 1;
        if let Some(database) = &database {
            database.clear()?;
        }
        let address = depot.replace(RUN, &number.to_string());
        if let Some(place) = address.strip_prefix("file://") {
            std::fs::create_dir_all(place)?;
        }
        Ok(address)
    };
    for (name, depot) in &depots {
        for shards in SHARDS {
            let (start, mut kills) = (Instant::now(), 0);
            for _ in 0..trials {
                kills += workshop.trial(&empty(depot)?, shards, &expected, &mut random)?;
            }
            let seconds = start.elapsed().as_secs_f64() / f64::from(trials);
            println!("| {name} | {shards} | {trials} | {trials} | {kills} | {seconds:.0} |");
        }
        workshop.share(&empty(depot)?, &expected).with_context(|| (*name).to_owned())?;
    }
    Ok(())
}

/// Where the processes work.
struct Workshop {
    program: PathBuf,
    folder: PathBuf,
    settings: BTreeMap<String, String>,
}

impl Workshop {
    /// The program, with the knowledge base of one machine.
    fn robotc(&self, machine: &str, arguments: &[&str]) -> Command {
        let mut command = Command::new(&self.program);
        command.current_dir(&self.folder).envs(&self.settings);
        command
            .env("ROBOTC_STORE", self.folder.join(machine))
            .env("XDG_CACHE_HOME", self.folder.join(machine));
        command.args(["--threads", "1"]).args(arguments);
        command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
        command
    }

    fn succeeds(&self, machine: &str, arguments: &[&str]) -> anyhow::Result<String> {
        let output = self.robotc(machine, arguments).output()?;
        let errors = String::from_utf8_lossy(&output.stderr);
        ensure!(output.status.success(), "{}: {errors}", arguments.join(" "));
        Ok(String::from_utf8(output.stdout)? + &errors)
    }

    /// Kind, subject, key and content of every artefact on a machine; computes what it lacks.
    fn lock(&self, machine: &str) -> anyhow::Result<String> {
        let lock = format!("{machine}.lock");
        self.succeeds(machine, &["compile", TASK, "--lock", &lock])?;
        Ok(std::fs::read_to_string(self.folder.join(lock))?)
    }

    /// Builds everything by workers that are killed; the number of kills.
    fn trial(
        &self,
        depot: &str,
        shards: usize,
        expected: &str,
        random: &mut Random,
    ) -> anyhow::Result<usize> {
        let plan = self.succeeds("alone", &["plan-build", TASK])?;
        let mut kills = 0;
        let mut machines = vec!["newcomer".to_owned()];
        for step in plan.lines() {
            let recipe = step.split(' ').next().context("a recipe")?;
            let shards = if step.ends_with("in shards") { shards } else { 1 };
            let workers: Vec<(String, String)> =
                (0..shards).map(|i| (format!("worker{i}"), format!("{i}/{shards}"))).collect();
            for round in 0_u32.. {
                let mut alive = Vec::new();
                for (machine, shard) in &workers {
                    let arguments = ["build", TASK, "--node", recipe, "--shard", shard, "--depot", depot];
                    alive.push(self.robotc(machine, &arguments).stderr(Stdio::null()).spawn()?);
                }
                // Ever later, so that every trial ends.
                let time = Duration::from_secs_f64(random.next() * 0.5 * f64::from(round + 1));
                let end = Instant::now() + time;
                let mut left = alive.len();
                while left > 0 && Instant::now() < end {
                    std::thread::sleep(Duration::from_millis(2));
                    left = 0;
                    for worker in &mut alive {
                        left += usize::from(worker.try_wait()?.is_none());
                    }
                }
                for worker in &mut alive {
                    if worker.try_wait()?.is_none() {
                        worker.kill()?;
                        kills += 1;
                    }
                    worker.wait()?;
                }
                if left == 0 {
                    break;
                }
            }
            machines.extend(workers.into_iter().map(|(machine, _)| machine));
            // Whoever comes finds it, or puts the pieces together.
            self.succeeds("newcomer", &["build", TASK, "--node", recipe, "--depot", depot])?;
        }
        let lock = self.lock("newcomer")?;
        ensure!(lock == expected, "{depot}, {shards} shards: other bytes than one process alone gives");
        let verified = self.succeeds("newcomer", &["kb", "verify", "--store", depot]);
        if depot.contains("://") {
            ensure!(verified?.starts_with("whole"), "{depot}: not whole");
        }
        for machine in machines {
            remove(&self.folder.join(machine))?;
        }
        Ok(kills)
    }

    /// One machine compiles into a shared knowledge base; another has nothing left to do.
    fn share(&self, address: &str, expected: &str) -> anyhow::Result<()> {
        if !address.contains("://") {
            return Ok(());
        }
        for machine in ["first", "second"] {
            let lock = format!("{machine}.lock");
            let told = self.succeeds(machine, &["compile", TASK, "--lock", &lock, "--store", address])?;
            ensure!(std::fs::read_to_string(self.folder.join(lock))? == expected, "{address}: other bytes");
            ensure!(told.contains("up to date") == (machine == "second"), "{machine}: {told}");
        }
        let listed = self.succeeds("third", &["kb", "ls", "--store", address])?.lines().count();
        let planned = self.succeeds("alone", &["plan-build", TASK])?.lines().count();
        ensure!(listed == planned, "{address}: {listed} artefacts listed, {planned} planned");
        ["first", "second", "third"].iter().try_for_each(|machine| remove(&self.folder.join(machine)))
    }
}

fn remove(folder: &Path) -> anyhow::Result<()> {
    if folder.exists() { Ok(std::fs::remove_dir_all(folder)?) } else { Ok(()) }
}

/// A series of numbers in [0, 1): splitmix64, the same in every campaign.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }
}
