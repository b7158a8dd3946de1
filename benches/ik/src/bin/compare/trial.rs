//! One arm, one set of poses, all solvers.

use std::time::Instant;

use robotc_core::{Pose, SerialChain};
use robotc_ik_bench::Arm;
use robotc_ikgen::check;
use robotc_ikgen::report::poses::PoseSet;

use crate::contender::{Contender, Task};

/// A solver in the race.
pub struct Entrant {
    /// Its name in the table.
    pub name: String,
    /// What is called.
    pub solver: Box<dyn Contender>,
}

/// What one solver did on one set.
pub struct Row {
    /// The arm.
    pub arm: &'static str,
    /// The set of poses.
    pub set: &'static str,
    /// The solver.
    pub solver: String,
    /// Poses of the set.
    pub poses: usize,
    /// Poses with an answer that reaches them to 1e-6.
    pub solved: usize,
    /// Poses whose generating joint vector is among the answers; of the random set only.
    pub recovered: Option<usize>,
    /// Answers, not marked as least-squares, that miss by more than 1e-6.
    pub wrong: usize,
    /// Answers per pose.
    pub mean_solutions: f64,
    /// Median over poses of the fastest of five calls, nanoseconds.
    pub median_ns: f64,
    /// Mean over poses of the same.
    pub mean_ns: f64,
}

/// An answer reaches a pose if it is this near: metres, and Frobenius norm of the rotation difference.
const TOLERANCE: f64 = 1e-6;

/// Times and judges all solvers; a peer that solves another arm is not judged.
pub fn run(
    arm: &Arm,
    chain: &SerialChain,
    set: &PoseSet,
    tasks: &[Task],
    entrants: &mut [Entrant],
    all_judged: bool,
) -> Vec<Row> {
    for entrant in entrants.iter_mut() {
        entrant.solver.load(tasks);
    }
    let clock = overhead();
    let mut fastest = vec![vec![f64::INFINITY; tasks.len()]; entrants.len()];
    for _ in 0..5 {
        for task in 0..tasks.len() {
            for (entrant, fastest) in entrants.iter_mut().zip(&mut fastest) {
                let group = entrant.solver.group();
                if task % group != 0 {
                    continue;
                }
                // A batch takes longer than the slices in which a processor is shared with others.
                let slow = entrant.solver.repeats() > 1;
                let slow_start = if slow { processor_ns() } else { None };
                let start = Instant::now();
                let found = entrant.solver.solve(task);
                let elapsed = start.elapsed().as_nanos() as f64 - clock;
                let elapsed = slow_start.and_then(|start| Some(processor_ns()? - start)).unwrap_or(elapsed);
                std::hint::black_box(found);
                let end = (task + group).min(tasks.len());
                let share = elapsed / ((end - task) * entrant.solver.repeats()) as f64;
                fastest[task..end].iter_mut().for_each(|t| *t = t.min(share));
            }
        }
    }
    let slides = vec![false; chain.variables.len()];
    let mut rows = Vec::new();
    for (entrant, mut times) in entrants.iter_mut().zip(fastest) {
        times.sort_by(f64::total_cmp);
        let mut row = Row {
            arm: arm.name,
            set: set.name,
            solver: entrant.name.clone(),
            poses: tasks.len(),
            solved: 0,
            recovered: set.regular.then_some(0),
            wrong: 0,
            mean_solutions: 0.0,
            median_ns: times[times.len() / 2],
            mean_ns: times.iter().sum::<f64>() / times.len() as f64,
        };
        let judged = all_judged || entrant.name.starts_with("robotc");
        for (i, task) in tasks.iter().enumerate().filter(|_| judged) {
            entrant.solver.solve(i);
            let pose: Pose = chain.forward(&task.joints);
            let answers = entrant.solver.answers();
            let right = answers.iter().filter(|q| check::distance(chain, q, &pose) <= TOLERANCE).count();
            row.solved += usize::from(right > 0);
            row.wrong += answers.len() - right;
            row.mean_solutions += answers.len() as f64 / tasks.len() as f64;
            if let Some(recovered) = &mut row.recovered {
                *recovered +=
                    usize::from(answers.iter().any(|q| check::same(q, &task.joints, &slides, 1e-6)));
            }
        }
        rows.push(row);
    }
    rows
}

/// Nanoseconds that this thread has had a processor, where the system says so.
#[cfg(target_os = "linux")]
fn processor_ns() -> Option<f64> {
    const THREAD_CPU_TIME: i32 = 3;
    unsafe extern "C" {
        fn clock_gettime(clock: i32, time: *mut [i64; 2]) -> i32;
    }
    let mut time = [0; 2];
    // SAFETY: on 64-bit Linux a `timespec` is two numbers of 64 bits, and the call writes no more than that.
    let failed = unsafe { clock_gettime(THREAD_CPU_TIME, &mut time) };
    (failed == 0).then(|| time[0] as f64 * 1e9 + time[1] as f64)
}

#[cfg(not(target_os = "linux"))]
fn processor_ns() -> Option<f64> {
    None
}

/// Nanoseconds that reading the clock takes.
fn overhead() -> f64 {
    let once = |_| {
        let start = Instant::now();
        start.elapsed().as_nanos() as f64
    };
    let mut times: Vec<f64> = (0..10_001).map(once).collect();
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}
