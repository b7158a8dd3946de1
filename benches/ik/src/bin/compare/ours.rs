//! The run-time library: the bytecode, pose by pose and in batches.

use robotc_core::Pose;
use robotc_core::ik::{IkSolutions, InverseKinematics as _};
use robotc_ikgen::run::Batch;
use robotc_ikgen::{Compiled, Solver};

use crate::contender::{Contender, Task};
use crate::trial::Entrant;

/// The engines of the run-time library.
pub fn entrants(compiled: &Compiled) -> Vec<Entrant> {
    let single = Bytecode { solver: compiled.solver(), tasks: Vec::new(), found: IkSolutions::new() };
    let batched = Batched {
        solver: compiled.solver(),
        poses: Vec::new(),
        free: Vec::new(),
        repeats: 1,
        found: Batch::default(),
        current: 0,
    };
    vec![
        Entrant { name: "robotc bytecode".into(), solver: Box::new(single) },
        Entrant { name: "robotc bytecode, batch".into(), solver: Box::new(batched) },
    ]
}

struct Bytecode {
    solver: Solver,
    tasks: Vec<(Pose, Vec<f64>)>,
    found: IkSolutions,
}

impl Contender for Bytecode {
    fn load(&mut self, tasks: &[Task]) {
        self.tasks = tasks.iter().map(|task| (pose(task), task.free.clone())).collect();
    }

    fn solve(&mut self, task: usize) -> usize {
        let (pose, free) = &self.tasks[task];
        self.solver.solve(pose, free, &mut self.found);
        self.found.len()
    }

    fn answers(&self) -> Vec<Vec<f64>> {
        self.found.iter().map(<[f64]>::to_vec).collect()
    }
}

/// Poses of a batch.
const BATCH: usize = 1000;

/// All poses in one call, again and again until they are [`BATCH`].
struct Batched {
    solver: Solver,
    poses: Vec<Pose>,
    free: Vec<f64>,
    repeats: usize,
    found: Batch,
    /// Which of them is looked at.
    current: usize,
}

impl Contender for Batched {
    fn load(&mut self, tasks: &[Task]) {
        self.repeats = BATCH.div_ceil(tasks.len());
        let all = || (0..self.repeats).flat_map(|_| tasks);
        self.poses = all().map(pose).collect();
        self.free = all().flat_map(|task| task.free.clone()).collect();
    }

    fn group(&self) -> usize {
        self.poses.len() / self.repeats
    }

    fn repeats(&self) -> usize {
        self.repeats
    }

    fn solve(&mut self, task: usize) -> usize {
        if task == 0 {
            self.solver.solve_batch(&self.poses, &self.free, &mut self.found);
        }
        self.current = task;
        self.found.len()
    }

    fn answers(&self) -> Vec<Vec<f64>> {
        self.found.solutions(self.current).map(<[f64]>::to_vec).collect()
    }
}

fn pose(task: &Task) -> Pose {
    let rotation = nalgebra::Rotation3::from_matrix_unchecked(task.rotation);
    Pose::from_parts(task.position.into(), nalgebra::UnitQuaternion::from_rotation_matrix(&rotation))
}
