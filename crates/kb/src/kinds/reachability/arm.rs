//! An arm by itself: exact inverse kinematics within limits and free of self-collision. What no cell decides.

use std::f64::consts::PI;
use std::sync::Arc;

use nalgebra::Point3;
use robotc_core::geom::{ConvexParts as Parts3, any_within};
use robotc_core::ids::{Idx, LinkIdx};
use robotc_core::ik::{IkSolutions, InverseKinematics};
use robotc_core::model::{ChainMotion, SerialChain};
use robotc_core::{Configuration, DofIdx, Kinematics, LinkPoses, Pose, TypedVec};
use robotc_ikgen::run::Batch;
use robotc_ikgen::{Program, Solver};

use super::freedom::{FreeValues, values_of};
use crate::kinds::{ArmPairs, ConvexParts, IkSolver, LinkPairs};
use crate::project::{OfArm, OfShape, Subject};
use crate::projection::{Limits, Mechanism};
use crate::resolve::{Knowledge, LoadError};

/// An arm with what it carries rigidly, seen apart from the rest of its robot.
///
/// Fingers and other arms are not part of it: their posture changes, and a plan is checked with them anyhow.
pub struct ArmAlone {
    pub(super) chain: SerialChain,
    pub(super) solver: Solver,
    pub(super) kinematics: Kinematics,
    pub(super) base: LinkIdx,
    tip: LinkIdx,
    dofs: Vec<DofIdx>,
    /// Of the free joints: their limits, or one turn.
    pub(super) free_ranges: Vec<(f64, f64)>,
    pub(super) links: TypedVec<LinkIdx, Arc<Parts3>>,
    /// A sphere around each link, in its frame: most pairs are far from each other.
    spheres: TypedVec<LinkIdx, (Point3<f64>, f64)>,
    /// Pairs of links that the first joint moves together: what it does is nothing to them.
    pub(super) together: Vec<(LinkIdx, LinkIdx)>,
    /// Pairs of a link that stays with the base, and one that the first joint moves.
    pub(super) against_base: Vec<(LinkIdx, LinkIdx)>,
}

/// Values of the free joints that go through the solver together.
const TOGETHER: usize = 8;

/// Room for intermediate results, so that a loop allocates once.
#[derive(Default)]
pub struct Scratch {
    solutions: IkSolutions,
    batch: Batch,
    pub(super) joints: Vec<f64>,
    configuration: Option<Configuration>,
    pub(super) poses: LinkPoses,
}

impl ArmAlone {
    /// An arm from its mechanism, with the indices of base and tip there, and artefacts. `links` holds the shapes by
    /// link of the mechanism. The error says why the program does not fit.
    pub fn new(
        mechanism: &Mechanism,
        [base, tip]: [LinkIdx; 2],
        program: &Program,
        links: TypedVec<LinkIdx, Arc<Parts3>>,
        pairs: &LinkPairs,
    ) -> Result<Self, String> {
        let kinematics = Kinematics::new(mechanism.model().clone());
        let chain = SerialChain::between(&kinematics, base, tip).map_err(|error| error.to_string())?;
        let solver = Solver::new(program.clone(), &chain).map_err(|error| error.to_string())?;
        let model = kinematics.model();
        let dofs: Vec<DofIdx> = chain.variables.iter().map(|variable| variable.dof).collect();
        let moved = model.subtree(model.joints()[model.dofs()[dofs[0]].joint].child);
        let (mut together, mut against_base) = (Vec::new(), Vec::new());
        for &(a, b) in &pairs.0 {
            match (moved.contains(&a), moved.contains(&b)) {
                (true, true) => together.push((a, b)),
                (true, false) => against_base.push((b, a)),
                _ => against_base.push((a, b)),
            }
        }
        let range = |&variable: &usize| {
            let v = &chain.variables[variable];
            if v.lower.is_finite() && v.upper.is_finite() { (v.lower, v.upper) } else { (-PI, PI) }
        };
        let spheres = links.iter().map(|parts| sphere_around(parts)).collect();
        let free_ranges = solver.free_variables().iter().map(range).collect();
        Ok(Self {
            chain,
            solver,
            kinematics,
            base,
            tip,
            dofs,
            free_ranges,
            links,
            spheres,
            together,
            against_base,
        })
    }

    /// An arm of a compiled robot.
    pub fn load(knowledge: &Knowledge, arm: usize) -> Result<Self, LoadError> {
        let project = knowledge.graph().project();
        let robot = project.robot();
        let unplanned = || LoadError::NotPlanned { kind: "ik_solver", subject: OfArm(arm).label(project) };
        let (base, tip) = (robot.arms[arm].base, robot.arms[arm].tip);
        let (mechanism, ends, originals) =
            Mechanism::arm(&robot.model, base, tip, Limits::Kept).map_err(|_| unplanned())?;
        let mut links: TypedVec<LinkIdx, Arc<Parts3>> =
            originals.iter().map(|_| Default::default()).collect();
        for (i, &link) in originals.iter().enumerate() {
            if !robot.model.links()[link].collisions.is_empty() {
                links[LinkIdx::new(i)] = knowledge.load::<ConvexParts>(&OfShape::Link(link))?;
            }
        }
        let program = knowledge.load::<IkSolver>(&OfArm(arm))?;
        let pairs = knowledge.load::<ArmPairs>(&OfArm(arm))?;
        Self::new(&mechanism, ends, &program, links, &pairs).map_err(|_| unplanned())
    }

    /// The link that carries the tip.
    pub fn tip(&self) -> LinkIdx {
        self.tip
    }

    /// The shapes of the links, by link of the arm's mechanism.
    pub fn shapes(&self) -> &TypedVec<LinkIdx, Arc<Parts3>> {
        &self.links
    }

    /// The arm's mechanism.
    pub fn kinematics(&self) -> &Kinematics {
        &self.kinematics
    }

    /// The pose of the chain's base in the frame of the mechanism's root.
    pub fn root_from_base(&self) -> Pose {
        let mut scratch = Scratch::default();
        let joints = vec![0.0; self.chain.variables.len()];
        self.pose(&joints, &mut scratch);
        *scratch.poses.root_from(self.base)
    }

    /// The chain from base to tip.
    pub fn chain(&self) -> &SerialChain {
        &self.chain
    }

    /// Whether the arm touches itself or what it stands on. `joints` are the values of the chain's variables.
    pub fn collides(&self, joints: &[f64], scratch: &mut Scratch) -> bool {
        self.pose(joints, scratch);
        self.touch(&self.together, &scratch.poses) || self.touch(&self.against_base, &scratch.poses)
    }

    /// A joint vector that reaches a tip pose within limits and without self-collision; `None` when there is none for
    /// `samples` evenly spaced values of each free joint.
    pub fn reach(&self, base_from_tip: &Pose, samples: usize, scratch: &mut Scratch) -> Option<Vec<f64>> {
        self.reach_with(base_from_tip, &self.free_values(samples), scratch)
    }

    /// As [`reach`](Self::reach), where a byte says which values of the free joints are tried first. A free first joint is
    /// seen from an azimuth `about` its axis.
    pub(super) fn reach_from(
        &self,
        base_from_tip: &Pose,
        witness: u8,
        about: Option<f64>,
        samples: usize,
        scratch: &mut Scratch,
    ) -> Option<Vec<f64>> {
        if self.free_ranges.is_empty() {
            return self.reach(base_from_tip, samples, scratch);
        }
        let ranges = self.ranges_about(about);
        let free = FreeValues::evenly(&ranges, samples).from(&values_of(witness, &ranges), &ranges);
        self.reach_with(base_from_tip, &free, scratch)
    }

    /// Ranges of the free joints; for poses that were turned by an azimuth about the first axis, from one at which that joint
    /// is not limited, the range of a free first joint is a turn about that azimuth.
    pub(super) fn ranges_about(&self, azimuth: Option<f64>) -> Vec<(f64, f64)> {
        let mut ranges = self.free_ranges.clone();
        if let (Some(azimuth), Some(&0)) = (azimuth, self.solver.free_variables().first()) {
            ranges[0] = (azimuth - PI, azimuth + PI);
        }
        ranges
    }

    /// As [`reach`](Self::reach), for these values of the free joints, in this order.
    pub fn reach_with(
        &self,
        base_from_tip: &Pose,
        free: &FreeValues,
        scratch: &mut Scratch,
    ) -> Option<Vec<f64>> {
        self.reach_where(base_from_tip, free, scratch, |_, _| true)
    }

    /// As [`reach_with`](Self::reach_with), the first joint vector that is accepted, say because it touches nothing around
    /// the arm. `accept` also gets the poses of the arm's links in the frame of the mechanism's root.
    ///
    /// The last look at a pose that nothing reaches is for the values in the middle of the list, with all care for singular
    /// poses.
    pub fn reach_where(
        &self,
        base_from_tip: &Pose,
        free: &FreeValues,
        scratch: &mut Scratch,
        mut accept: impl FnMut(&[f64], &LinkPoses) -> bool,
    ) -> Option<Vec<f64>> {
        let (mut batch, mut joints) =
            (std::mem::take(&mut scratch.batch), std::mem::take(&mut scratch.joints));
        let mut solutions = std::mem::take(&mut scratch.solutions);
        let mut fits = |solution: &[f64], scratch: &mut Scratch| {
            let fits = self.within_limits(solution, 0, &mut joints)
                && !self.collides(&joints, scratch)
                && accept(&joints, &scratch.poses);
            fits.then(|| joints.clone())
        };
        let mut found = None;
        let (mut at, middle) = (0, free.len() / 2);
        // Care would find again what is not lost at first sight.
        let mut care = !free.is_empty();
        while free.width() > 0 && found.is_none() && at < free.len() {
            let count = self.solve_from(at, base_from_tip, free, &mut batch);
            found = (0..count).find_map(|i| batch.solutions(i).find_map(|solution| fits(solution, scratch)));
            care &= !(at..at + count).contains(&middle) || batch.solutions(middle - at).len() == 0;
            at += count;
        }
        if found.is_none() && care {
            self.solver.solve(base_from_tip, free.row(middle), &mut solutions);
            found = solutions.iter().find_map(|solution| fits(solution, scratch));
        }
        (scratch.batch, scratch.solutions, scratch.joints) = (batch, solutions, joints);
        found
    }

    /// Solves a tip pose for a few values of the free joints, from the one at `at` on; how many they are.
    fn solve_from(&self, at: usize, base_from_tip: &Pose, free: &FreeValues, batch: &mut Batch) -> usize {
        let count = TOGETHER.min(free.len() - at);
        let rows: Vec<f64> = (at..at + count).flat_map(|i| free.row(i)).copied().collect();
        self.solver.solve_batch_once(&[*base_from_tip; TOGETHER][..count], &rows, batch);
        count
    }

    /// Joint vectors within limits that reach a tip pose, for these values of the free joints, a few of them at a time: each group is
    /// given to `enough`, until that says so. Nothing is looked at for self-collisions.
    pub fn reach_in_groups(
        &self,
        base_from_tip: &Pose,
        free: &FreeValues,
        scratch: &mut Scratch,
        mut enough: impl FnMut(&[Vec<f64>]) -> bool,
    ) {
        let mut at = 0;
        while at < free.len() {
            let count = self.solve_from(at, base_from_tip, free, &mut scratch.batch);
            let mut group = Vec::new();
            for solution in (0..count).flat_map(|i| scratch.batch.solutions(i)) {
                if self.within_limits(solution, 0, &mut scratch.joints) {
                    group.push(scratch.joints.clone());
                }
            }
            at += count;
            if enough(&group) {
                return;
            }
        }
    }

    /// Of the joint vectors that reach a tip pose within limits and without self-collision, for `samples` evenly spaced values
    /// of each free joint, the one with the largest manipulability, with that; `None` when there is none.
    pub fn most_manipulable(
        &self,
        base_from_tip: &Pose,
        samples: usize,
        scratch: &mut Scratch,
    ) -> Option<(Vec<f64>, f64)> {
        let mut best: Option<(Vec<f64>, f64)> = None;
        self.reach_where(base_from_tip, &self.free_values(samples), scratch, |joints, _| {
            let found = self.manipulability(joints);
            if best.as_ref().is_none_or(|(_, most)| found > *most) {
                best = Some((joints.to_vec(), found));
            }
            false
        });
        best
    }

    /// All joint vectors that reach a tip pose within limits and without self-collision, for `samples` evenly spaced values of
    /// each free joint, each once.
    ///
    /// At the [centre](super::Grid::centre) of a cell their number is the count that the thesis keeps for it (algorithm 4.4), and
    /// each is a witness. They are found when asked for, as exactly as any stored would be.
    pub fn solutions(&self, base_from_tip: &Pose, samples: usize, scratch: &mut Scratch) -> Vec<Vec<f64>> {
        /// Joint values nearer to each other than this are of one solution, radians or metres.
        const SAME: f64 = 1e-6;
        let mut all: Vec<Vec<f64>> = Vec::new();
        self.reach_where(base_from_tip, &self.free_values(samples), scratch, |joints, _| {
            let same = |other: &Vec<f64>| other.iter().zip(joints).all(|(a, b)| (a - b).abs() < SAME);
            if !all.iter().any(same) {
                all.push(joints.to_vec());
            }
            false
        });
        all
    }

    /// Manipulability at a joint vector: the square root of det(J J^T) of the tip's 6-row Jacobian, angles in radians and
    /// lengths in metres (Yoshikawa, "Manipulability of robotic mechanisms", 1985). Zero where the arm is singular, and for
    /// arms with fewer than six joints.
    pub fn manipulability(&self, joints: &[f64]) -> f64 {
        let mut scratch = Scratch::default();
        self.pose(joints, &mut scratch);
        let all = self.kinematics.jacobian(&scratch.poses, self.tip, &Point3::origin());
        let columns: Vec<_> = self.dofs.iter().map(|dof| all.column(dof.index())).collect();
        let jacobian = nalgebra::Matrix6xX::from_columns(&columns);
        (&jacobian * jacobian.transpose()).determinant().max(0.0).sqrt()
    }

    pub(super) fn pose(&self, joints: &[f64], scratch: &mut Scratch) {
        let neutral = || Configuration::neutral(self.kinematics.model());
        let q = scratch.configuration.get_or_insert_with(neutral);
        q.set(&self.dofs, joints);
        self.kinematics.link_poses(q, &mut scratch.poses);
    }

    pub(super) fn touch(&self, pairs: &[(LinkIdx, LinkIdx)], poses: &LinkPoses) -> bool {
        let around = |link: LinkIdx| (poses.root_from(link) * self.spheres[link].0, self.spheres[link].1);
        pairs.iter().any(|&(a, b)| {
            let ((centre_a, radius_a), (centre_b, radius_b)) = (around(a), around(b));
            let reach = radius_a + radius_b + 1e-9;
            (centre_a - centre_b).norm_squared() <= reach * reach
                && any_within(&self.links[a], poses.root_from(a), &self.links[b], poses.root_from(b), 0.0)
        })
    }

    /// Brings every joint from `first` on within its limits by full turns; `false` when one cannot be.
    pub(super) fn within_limits(&self, solution: &[f64], first: usize, joints: &mut Vec<f64>) -> bool {
        joints.clear();
        joints.extend_from_slice(solution);
        let turn = std::f64::consts::TAU;
        for (i, variable) in self.chain.variables.iter().enumerate().skip(first) {
            let inside = |v: f64| (variable.lower..=variable.upper).contains(&v);
            if inside(joints[i]) {
                continue;
            }
            let joint = self.chain.joints.iter().find(|joint| joint.variable == i);
            let revolves = joint.is_some_and(|joint| joint.motion == ChainMotion::Revolute);
            match [joints[i] - turn, joints[i] + turn].into_iter().find(|v| revolves && inside(*v)) {
                Some(value) => joints[i] = value,
                None => return false,
            }
        }
        true
    }

    /// Evenly spaced values of the free joints within their limits: all combinations, one empty one without free joints.
    pub fn free_values(&self, samples: usize) -> FreeValues {
        FreeValues::evenly(&self.free_ranges, samples)
    }
}

/// A sphere that holds all parts: centre and radius, about the middle of their box.
fn sphere_around(parts: &Parts3) -> (Point3<f64>, f64) {
    let Some(bounds) = parts.bounds() else { return (Point3::origin(), 0.0) };
    let centre = bounds.centre();
    let points = parts.iter().flat_map(|part| part.points());
    (centre, points.map(|point| (point - centre).norm()).fold(0.0, f64::max))
}
