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
    let batched =
        Batched { solver: compiled.solver(), poses: Vec::new(), free: Vec::new(), found: Batch::default() };
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

/// Many poses in one call.
struct Batched {
    solver: Solver,
    poses: Vec<Pose>,
    free: Vec<f64>,
    found: Batch,
}

impl Contender for Batched {
    fn load(&mut self, tasks: &[Task]) {
        self.poses = tasks.iter().map(pose).collect();
        self.free = tasks.iter().flat_map(|task| task.free.clone()).collect();
    }

    fn group(&self) -> usize {
        BATCH
    }

    fn solve(&mut self, task: usize) -> usize {
        let end = (task + BATCH).min(self.poses.len());
        let given = self.free.len() / self.poses.len();
        self.solver.solve_batch(
            &self.poses[task..end],
            &self.free[task * given..end * given],
            &mut self.found,
        );
        self.found.len()
    }

    fn answers(&self) -> Vec<Vec<f64>> {
        self.found.solutions(0).map(<[f64]>::to_vec).collect()
    }
}

fn pose(task: &Task) -> Pose {
    let rotation = nalgebra::Rotation3::from_matrix_unchecked(task.rotation);
    Pose::from_parts(task.position.into(), nalgebra::UnitQuaternion::from_rotation_matrix(&rotation))
}
