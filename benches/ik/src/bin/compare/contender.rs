//! What is timed: anything that gives the joint vectors of a pose.

use nalgebra::{Matrix3, Vector3};

/// A pose to solve.
pub struct Task {
    /// The generating joint vector.
    pub joints: Vec<f64>,
    /// `base_from_tip`.
    pub rotation: Matrix3<f64>,
    /// Its position in metres.
    pub position: Vector3<f64>,
    /// The values of the given joints, for our solvers.
    pub free: Vec<f64>,
}

/// A solver of one arm.
pub trait Contender {
    /// Brings the poses into the form that the solver takes; not timed.
    fn load(&mut self, tasks: &[Task]);

    /// Poses solved by one call: the time of a call is shared out among them.
    fn group(&self) -> usize {
        1
    }

    /// How often each of them is in it.
    fn repeats(&self) -> usize {
        1
    }

    /// Solves the pose of this number; returns the number of answers.
    fn solve(&mut self, task: usize) -> usize;

    /// The answers of the last call that are not marked as least-squares, joints as described by the arm.
    fn answers(&self) -> Vec<Vec<f64>>;
}

/// A generated solver.
pub struct Generated {
    /// Name of the arm.
    pub arm: &'static str,
    /// Which back end, with which options.
    pub flavour: &'static str,
    /// The solver.
    pub solver: Box<dyn Contender>,
}

/// Makes a contender of a generated module.
macro_rules! contender {
    ($arm:expr, $flavour:expr, $module:ident) => {{
        struct Solver {
            tasks: Vec<($module::Frame, [f64; $module::FREE.len()])>,
            found: $module::Solutions,
        }
        impl crate::contender::Contender for Solver {
            fn load(&mut self, tasks: &[crate::contender::Task]) {
                self.tasks.clear();
                for task in tasks {
                    let (r, p) = (&task.rotation, &task.position);
                    let row = |i: usize| [r[(i, 0)], r[(i, 1)], r[(i, 2)]];
                    let pose =
                        $module::Frame { rotation: [row(0), row(1), row(2)], position: [p.x, p.y, p.z] };
                    self.tasks.push((pose, task.free[..].try_into().expect("one value each")));
                }
            }

            fn solve(&mut self, task: usize) -> usize {
                let (pose, free) = &self.tasks[task];
                $module::solve(pose, free, &mut self.found);
                self.found.as_slice().len()
            }

            fn answers(&self) -> Vec<Vec<f64>> {
                self.found.as_slice().iter().map(|v| v.to_vec()).collect()
            }
        }
        let solver = Solver { tasks: Vec::new(), found: $module::Solutions::new() };
        Generated { arm: $arm, flavour: $flavour, solver: Box::new(solver) }
    }};
}
pub(crate) use contender;
