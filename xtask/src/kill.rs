//! `cargo xtask kill [TRIALS] [PROGRAM]`: a compilation is killed at random moments and must always be resumable.
//!
//! Each trial starts `robotc compile` on an empty knowledge base, kills it outright (no signal handler runs) after a random
//! time, and compiles again, over and over, until one run gets to the end. After every kill the store must verify, and in the
//! end its lock file must be that of a compilation that nobody disturbed.

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use anyhow::{Context, bail, ensure};

/// Trials when no number is given: what the project promises.
const TRIALS: u32 = 100;

/// Compiled in every trial: a robot, its objects and their grasps, so that every kind is at work, in a few seconds.
const SPECIFICATION: &str = "specs/tasks/mug_to_shelf.task.toml";

/// Runs the trials and prints a table of them.
pub(crate) fn run(args: &[String]) -> anyhow::Result<()> {
    let trials: u32 = args.first().map_or(Ok(TRIALS), |n| n.parse()).context("the number of trials")?;
    let program = match args.get(1) {
        Some(program) => std::path::absolute(program)?,
        None => {
            crate::workspace::execute(&["cargo", "build", "--release", "--locked", "-p", "robotc"])?;
            crate::workspace::root().join("target/release/robotc")
        }
    };
    let specification = crate::workspace::root().join(SPECIFICATION);
    let folder = tempfile::tempdir()?;

    let undisturbed = Trial::new(&program, &specification, folder.path().join("undisturbed"));
    let start = Instant::now();
    ensure!(undisturbed.compile()?.wait()?.success(), "the compilation fails without being killed");
    let whole = start.elapsed();
    let expected = std::fs::read_to_string(undisturbed.lock())?;
    println!("undisturbed: {:.2} s", whole.as_secs_f64());

    let mut random = 0x9e37_79b9_7f4a_7c15_u64;
    let (mut kills, mut leftovers) = (0, 0);
    for number in 0..trials {
        let trial = Trial::new(&program, &specification, folder.path().join(format!("trial{number}")));
        let mut finished = false;
        for round in 0_u32.. {
            let mut child = trial.compile()?;
            // Ever later kills: every trial comes to an end, and late stages are hit as well as early ones.
            let share = next(&mut random) * (1.0 + 0.25 * f64::from(round));
            finished = wait_until(&mut child, whole.mul_f64(share))?;
            if finished {
                break;
            }
            child.kill()?;
            child.wait()?;
            kills += 1;
            leftovers += trial.verify().with_context(|| format!("trial {number}, kill {round}"))?;
        }
        ensure!(finished, "the last round finishes");
        trial.verify().with_context(|| format!("trial {number}, after the end"))?;
        let lock = std::fs::read_to_string(trial.lock())?;
        ensure!(lock == expected, "trial {number}: the lock file differs from the undisturbed one");
        std::fs::remove_dir_all(&trial.folder)?;
    }
    println!(
        "{trials} of {trials} trials whole: {kills} kills, {leftovers} stray files left behind and tolerated"
    );
    Ok(())
}

/// One knowledge base that is compiled into.
struct Trial<'a> {
    program: &'a Path,
    specification: &'a Path,
    folder: PathBuf,
}

impl<'a> Trial<'a> {
    fn new(program: &'a Path, specification: &'a Path, folder: PathBuf) -> Self {
        Self { program, specification, folder }
    }

    fn lock(&self) -> PathBuf {
        self.folder.join("robotc.lock")
    }

    fn command(&self) -> Command {
        let mut command = Command::new(self.program);
        command.env("ROBOTC_STORE", self.folder.join("store")).stdout(Stdio::null()).stderr(Stdio::null());
        command
    }

    fn compile(&self) -> anyhow::Result<Child> {
        std::fs::create_dir_all(&self.folder)?;
        let mut command = self.command();
        command.arg("compile").arg("--lock").arg(self.lock()).arg(self.specification);
        command.spawn().context("could not start robotc")
    }

    /// Verifies the store; the number of files that nothing refers to.
    fn verify(&self) -> anyhow::Result<usize> {
        let output =
            self.command().args(["kb", "verify"]).stdout(Stdio::piped()).stderr(Stdio::piped()).output()?;
        if !output.status.success() {
            bail!("the store does not verify: {}", String::from_utf8_lossy(&output.stderr));
        }
        let text = String::from_utf8_lossy(&output.stdout);
        let files =
            text.split(", ").find_map(|part| part.split_once(" file")).map_or("0", |(count, _)| count);
        Ok(files.parse().unwrap_or(0))
    }
}

/// Whether the process ends, successfully, within the time.
fn wait_until(child: &mut Child, time: Duration) -> anyhow::Result<bool> {
    let end = Instant::now() + time;
    while Instant::now() < end {
        match child.try_wait()? {
            Some(status) if status.success() => return Ok(true),
            Some(status) => bail!("a compilation failed by itself: {status}"),
            None => std::thread::sleep(Duration::from_millis(1)),
        }
    }
    Ok(false)
}

/// The next of a series of numbers in [0, 1): splitmix64, the same in every campaign.
fn next(state: &mut u64) -> f64 {
    *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let mut z = *state;
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
}
