//! The published solvers.

use nalgebra as na;
use robotc_ik_bench::Arm;

use crate::contender::{Contender, Task};

/// `ik-geo`: which of its solvers an arm is for.
pub enum Class {
    /// Spherical wrist, axes 2 and 3 parallel.
    SphericalTwoParallel,
    /// Axes 2, 3 and 4 parallel, 5 and 6 meeting.
    ThreeParallelTwoIntersecting,
}

/// `ik-geo` on an arm.
pub struct IkGeo {
    robot: ik_geo::robot::Robot,
    tasks: Vec<(ik_geo::nalgebra::Matrix3<f64>, ik_geo::nalgebra::Vector3<f64>)>,
    answers: Vec<(ik_geo::nalgebra::Vector6<f64>, bool)>,
}

impl IkGeo {
    /// The solver of this class, given the points of the arm.
    pub fn new(arm: &Arm, class: &Class) -> Self {
        use ik_geo::nalgebra::{Matrix3x6, SMatrix, Vector3};
        let h: Vec<_> = arm.axes.iter().map(|(axis, _)| Vector3::from(*axis)).collect();
        let points = arm.axes.iter().map(|(_, point)| *point).chain([arm.tip]);
        let points: Vec<_> = std::iter::once([0.0; 3]).chain(points).map(Vector3::from).collect();
        let p: Vec<_> = points.windows(2).map(|w| w[1] - w[0]).collect();
        let (h, p) = (Matrix3x6::from_columns(&h), SMatrix::<f64, 3, 7>::from_columns(&p));
        let robot = match class {
            Class::SphericalTwoParallel => ik_geo::robot::spherical_two_parallel(h, p),
            Class::ThreeParallelTwoIntersecting => ik_geo::robot::three_parallel_two_intersecting(h, p),
        };
        Self { robot, tasks: Vec::new(), answers: Vec::new() }
    }
}

impl Contender for IkGeo {
    fn load(&mut self, tasks: &[Task]) {
        use ik_geo::nalgebra::{Matrix3, Vector3};
        let convert = |task: &Task| {
            let rotation = Matrix3::from_column_slice(task.rotation.as_slice());
            (rotation, Vector3::from_column_slice(task.position.as_slice()))
        };
        self.tasks = tasks.iter().map(convert).collect();
    }

    fn solve(&mut self, task: usize) -> usize {
        use ik_geo::robot::IKSolver;
        let (rotation, position) = self.tasks[task];
        self.answers = self.robot.ik(rotation, position);
        self.answers.len()
    }

    fn answers(&self) -> Vec<Vec<f64>> {
        let exact = self.answers.iter().filter(|(_, least_squares)| !least_squares);
        exact.map(|(joints, _)| joints.iter().copied().collect()).collect()
    }
}

/// `rs-opw-kinematics` on the KR 6, with its own parameters of that arm.
pub struct Opw {
    solver: rs_opw_kinematics::kinematics_impl::OPWKinematics,
    /// Its tool frame in ours.
    ours_from_theirs: na::UnitQuaternion<f64>,
    tasks: Vec<rs_opw_kinematics::pose::Pose>,
    answers: Vec<[f64; 6]>,
}

impl Opw {
    /// The KR 6 R900 as the crate describes it.
    pub fn kr6() -> Self {
        use rs_opw_kinematics::kinematic_traits::Kinematics as _;
        use rs_opw_kinematics::parameters::opw_kinematics::Parameters;
        let parameters = Parameters::kuka_kr6_r900_2();
        let solver = rs_opw_kinematics::kinematics_impl::OPWKinematics::new(parameters);
        let zero = solver.forward(&[0.0; 6]).rotation;
        let zero = na::Quaternion::new(zero.w, zero.x, zero.y, zero.z);
        let ours_from_theirs = na::UnitQuaternion::from_quaternion(zero);
        Self { solver, ours_from_theirs, tasks: Vec::new(), answers: Vec::new() }
    }
}

impl Contender for Opw {
    fn load(&mut self, tasks: &[Task]) {
        use rs_opw_kinematics::glam::{DQuat, DVec3};
        let convert = |task: &Task| {
            let q = quaternion(&task.rotation) * self.ours_from_theirs;
            let rotation = DQuat::from_xyzw(q.i, q.j, q.k, q.w);
            let p = task.position;
            rs_opw_kinematics::pose::Pose { translation: DVec3::new(p.x, p.y, p.z), rotation }
        };
        self.tasks = tasks.iter().map(convert).collect();
    }

    fn solve(&mut self, task: usize) -> usize {
        use rs_opw_kinematics::kinematic_traits::Kinematics as _;
        self.answers = self.solver.inverse(&self.tasks[task]);
        self.answers.len()
    }

    fn answers(&self) -> Vec<Vec<f64>> {
        self.answers.iter().map(|q| q.to_vec()).collect()
    }
}

/// `crx-kinematics` on the CRX-10iA. It takes millimetres and answers in degrees, the third joint against the second.
pub struct Crx {
    solver: crx_kinematics::Crx,
    tasks: Vec<nalgebra_of_crx::Isometry3<f64>>,
    answers: Vec<crx_kinematics::ik::IkSolution>,
}

impl Crx {
    /// The CRX-10iA.
    pub fn new_10ia() -> Self {
        Self { solver: crx_kinematics::Crx::new_10ia(), tasks: Vec::new(), answers: Vec::new() }
    }
}

impl Contender for Crx {
    fn load(&mut self, tasks: &[Task]) {
        use nalgebra_of_crx::{Isometry3, Quaternion, Translation3, UnitQuaternion};
        let theirs_at_zero = self.solver.fk(&[0.0; 6]).rotation;
        let convert = |task: &Task| {
            let q = quaternion(&task.rotation);
            let q = UnitQuaternion::from_quaternion(Quaternion::new(q.w, q.i, q.j, q.k)) * theirs_at_zero;
            let p = task.position * 1e3;
            Isometry3::from_parts(Translation3::new(p.x, p.y, p.z), q)
        };
        self.tasks = tasks.iter().map(convert).collect();
    }

    fn solve(&mut self, task: usize) -> usize {
        self.answers = self.solver.ik(&self.tasks[task]);
        self.answers.len()
    }

    fn answers(&self) -> Vec<Vec<f64>> {
        let convert = |solution: &crx_kinematics::ik::IkSolution| {
            let mut joints = solution.joints.map(f64::to_radians);
            joints[2] += joints[1];
            joints.to_vec()
        };
        self.answers.iter().map(convert).collect()
    }
}

fn quaternion(rotation: &na::Matrix3<f64>) -> na::UnitQuaternion<f64> {
    let rotation = na::Rotation3::from_matrix_unchecked(*rotation);
    na::UnitQuaternion::from_rotation_matrix(&rotation)
}
