//! Proof of a solver: what it solved of random and singular poses, judged by the independent checker.

pub mod complete;
pub mod poses;

use robotc_core::Seed;
use robotc_core::ik::{IkSolutions, InverseKinematics as _};
use robotc_core::model::SerialChain;
use serde::Serialize;

use crate::check;
use crate::generate::{Compiled, Refusal};
use crate::{GoalType, Solver};

/// Largest error of a right answer: metres, and Frobenius norm of the rotation difference.
pub const TOLERANCE: f64 = 1e-9;

/// An answer is the generating joint vector if it is this close, radians modulo a turn or metres.
pub const RECOVERED: f64 = 1e-6;

/// Sizes of a proof.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ProofOptions {
    /// Poses of each set.
    pub poses: usize,
    /// Seed of the poses.
    pub seed: u64,
}

impl Default for ProofOptions {
    fn default() -> Self {
        Self { poses: 1000, seed: 1 }
    }
}

/// What a solver did on one set of poses.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SetReport {
    /// random, wrist, elbow, shoulder, zero, grid90 or near; see [`poses::sets`].
    pub name: String,
    /// Poses tried.
    pub poses: usize,
    /// Poses with at least one right answer.
    pub solved: usize,
    /// Poses whose generating joint vector was among the answers. Only asked for on the random set: at a singular pose it
    /// may be one of infinitely many.
    pub recovered: usize,
    /// Answers that do not reach the pose.
    pub wrong: usize,
    /// Largest error of all answers.
    pub max_error: f64,
    /// Answers per pose.
    pub mean_solutions: f64,
    /// Median time of a call.
    pub median_ns: f64,
    /// 99th percentile of the time of a call.
    pub p99_ns: f64,
}

/// What is known of a solver, or why there is none.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Report {
    /// Class of the chain and how it is solved.
    pub class: String,
    /// What is asked for: the name of a [`GoalType`](crate::GoalType).
    #[serde(rename = "type")]
    pub kind: String,
    /// Names of the variables that the caller gives.
    pub free_joints: Vec<String>,
    /// Which equations the solver solves, in the order in which it does: the remarks of its program.
    pub equations: Vec<String>,
    /// Difference between the described chain and the ideal one: radians and metres, the larger.
    pub snap_max: f64,
    /// Seconds that compilation took.
    pub generation_s: f64,
    /// Bytes of the generated Rust source.
    pub source_bytes: usize,
    /// Whether the solver passed its own check; it is not to be used otherwise.
    pub emitted: bool,
    /// Why not; empty when emitted.
    pub reason: String,
    /// One entry for each set of poses.
    pub sets: Vec<SetReport>,
}

impl Report {
    /// The report of a chain that was not solved.
    pub fn refused(refusal: &Refusal, goal: GoalType, generation_s: f64) -> Self {
        Self {
            class: String::new(),
            kind: goal.name().into(),
            free_joints: Vec::new(),
            equations: Vec::new(),
            snap_max: 0.0,
            generation_s,
            source_bytes: 0,
            emitted: false,
            reason: refusal.reason.clone(),
            sets: Vec::new(),
        }
    }

    /// The set of this name.
    pub fn set(&self, name: &str) -> Option<&SetReport> {
        self.sets.iter().find(|s| s.name == name)
    }
}

/// Tries a compiled solver on all sets of poses. `now` is a clock in seconds; only times depend on it.
///
/// The solver is refused (`emitted` false) when an answer is wrong, or a random pose is not solved.
pub fn prove(
    compiled: &Compiled,
    generation_s: f64,
    options: &ProofOptions,
    now: &dyn Fn() -> f64,
) -> Report {
    let chain = compiled.chain();
    let solver = compiled.solver();
    let seed = Seed::new(options.seed).split("ikgen proof");
    let sets: Vec<SetReport> = poses::sets(compiled.longer_chain(), &compiled.free, options.poses, seed)
        .iter()
        .map(|set| prove_set(chain, &solver, set, now))
        .collect();
    let wrong: usize = sets.iter().map(|s| s.wrong).sum();
    let random = &sets[0];
    let reason = if wrong > 0 {
        format!("{wrong} wrong answers")
    } else if random.solved < random.poses {
        format!("solves only {} of {} random poses", random.solved, random.poses)
    } else {
        String::new()
    };
    Report {
        class: compiled.class.clone(),
        kind: compiled.program.goal.name().into(),
        free_joints: compiled
            .free
            .iter()
            .map(|v| compiled.longer_chain().variables[*v].name.clone())
            .collect(),
        equations: compiled.program.remarks().into_iter().map(String::from).collect(),
        snap_max: compiled.snap,
        generation_s,
        source_bytes: compiled.rust_source(&crate::backend::RustOptions::default()).len(),
        emitted: reason.is_empty(),
        reason,
        sets,
    }
}

/// Tries a solver of a chain on one set of poses; the joint vectors of the set are those of the chain with the joints that the goal
/// type adds.
pub fn prove_set(
    chain: &SerialChain,
    solver: &Solver,
    set: &poses::PoseSet,
    now: &dyn Fn() -> f64,
) -> SetReport {
    let goal = solver.program().goal;
    let longer = goal.extended(chain);
    let slides = poses::slides(chain);
    let mut out = IkSolutions::new();
    let mut report = SetReport {
        name: set.name.into(),
        poses: set.vectors.len(),
        solved: 0,
        recovered: 0,
        wrong: 0,
        max_error: 0.0,
        mean_solutions: 0.0,
        median_ns: 0.0,
        p99_ns: 0.0,
    };
    let mut times = Vec::with_capacity(set.vectors.len());
    let mut solutions = 0;
    for vector in &set.vectors {
        let base_from_tip = longer.forward(vector);
        let free: Vec<f64> = solver.free_variables().iter().map(|v| vector[*v]).collect();
        let start = now();
        solver.solve(&base_from_tip, &free, &mut out);
        times.push((now() - start) * 1e9);
        solutions += out.len();
        let mut right = false;
        for values in out.iter() {
            let error = check::goal_distance(goal, chain, values, &free, &base_from_tip);
            report.max_error = report.max_error.max(error);
            if error <= TOLERANCE {
                right = true;
            } else {
                report.wrong += 1;
            }
        }
        report.solved += usize::from(right);
        let recovered = out.iter().any(|v| check::same(v, vector, &slides, RECOVERED));
        report.recovered += usize::from(set.regular && recovered);
    }
    times.sort_by(f64::total_cmp);
    if let Some(last) = times.len().checked_sub(1) {
        report.mean_solutions = solutions as f64 / times.len() as f64;
        report.median_ns = times[last / 2];
        report.p99_ns = times[last * 99 / 100];
    }
    report
}
