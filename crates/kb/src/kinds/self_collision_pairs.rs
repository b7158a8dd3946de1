//! Which pairs of links have to be tested for self-collision.

use robotc_core::LinkIdx;
use robotc_core::ids::Idx;
use serde::{Deserialize, Serialize};

use super::ConvexParts;
use crate::codec;
use crate::graph::{Dep, PlanError, Planner};
use crate::kind::{DecodeError, Kind, Portability};
use crate::project::{OfRobot, OfShape, Subject};
use crate::projection::{Limits, Mechanism};
use crate::record::Parts;

/// The kind; its artefact is a [`PairTable`].
///
/// No pair is left out for want of evidence: one that never touched in samples is left out only when its distance
/// was bounded away from zero over all configurations, by boxes of joint values in which neither link can travel
/// as far as the other is away (Schwarzer, Saha and Latombe, "Exact collision checking of robot paths", 2002).
pub struct SelfCollisionPairs;

crate::parameters! {
    /// Parameters of [`SelfCollisionPairs`].
    pub struct PairParameters {
        /// Random configurations in which every pair is tested.
        samples: u32 [""] in 100..=1000000 = 1000;
        /// Boxes of joint values that may be spent to prove that a pair never touches.
        boxes: u32 [""] in 0..=10000000 = 4000;
    }
}

/// Joints, shapes, and the pairs that the specification excludes.
pub struct Robot {
    mechanism: Mechanism,
    bodies: Vec<(LinkIdx, Dep<ConvexParts>)>,
    ignored: Vec<(LinkIdx, LinkIdx)>,
}

/// What is known about a pair of links.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum PairState {
    /// They touch in some configurations and not in others: tested.
    Touching,
    /// They never touched, but no proof was found: tested.
    Unproven,
    /// They never touch, by proof: not tested.
    Clear,
    /// One hangs on the other, with no other body between: not tested.
    Adjacent,
    /// They touched in every sample, which shapes of links do that overlap a little in design: not tested.
    Always,
    /// The specification excludes them: not tested.
    Ignored,
}

impl PairState {
    /// Whether collision checks have to test such a pair.
    pub fn tested(self) -> bool {
        matches!(self, Self::Touching | Self::Unproven)
    }
}

/// All pairs of links that have shapes and can move against each other; lower index first, ascending.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct PairTable {
    /// Pairs with what is known about them.
    pub pairs: Vec<(LinkIdx, LinkIdx, PairState)>,
}

impl PairTable {
    /// The pairs that have to be tested.
    pub fn tested(&self) -> impl Iterator<Item = (LinkIdx, LinkIdx)> {
        self.pairs.iter().filter(|(_, _, state)| state.tested()).map(|&(a, b, _)| (a, b))
    }
}

impl Kind for SelfCollisionPairs {
    const NAME: &'static str = "self_collision_pairs";
    const FORMAT: u32 = 1;
    const ALGORITHM: u32 = 1;
    const PORTABILITY: Portability = Portability::Portable;
    const DOC: &'static str =
        "Which pairs of links can touch. Collision checks leave out the pairs that provably never do.";

    type Subject = OfRobot;
    type Inputs = Robot;
    type Parameters = PairParameters;
    type Artefact = PairTable;

    fn inputs(planner: &mut Planner<'_>, _subject: &OfRobot) -> Result<Robot, PlanError> {
        let robot = planner.project().robot();
        let mut bodies = Vec::new();
        for shape in OfShape::all(planner.project()) {
            if let OfShape::Link(link) = shape {
                bodies.push((link, planner.need::<ConvexParts>(&shape)?));
            }
        }
        let ignored = robot.ignored_pairs.clone();
        Ok(Robot { mechanism: Mechanism::whole(&robot.model, Limits::Kept), bodies, ignored })
    }

    fn key_parts(inputs: &Robot, parts: &mut Parts) {
        let Robot { mechanism, bodies, ignored } = inputs;
        mechanism.key_parts(parts);
        let bodies: Vec<usize> = bodies.iter().map(|(link, _)| link.index()).collect();
        parts.add("links with shapes", "", &bodies);
        let ignored: Vec<(usize, usize)> = ignored.iter().map(|(a, b)| (a.index(), b.index())).collect();
        parts.add("ignored pairs", "", &ignored);
    }

    fn defaults(_inputs: &Robot) -> PairParameters {
        PairParameters::constants()
    }

    fn encode(artefact: &PairTable) -> Vec<u8> {
        let row =
            |&(a, b, state): &(LinkIdx, LinkIdx, PairState)| (a.index() as u32, b.index() as u32, state);
        codec::encode(&artefact.pairs.iter().map(row).collect::<Vec<_>>())
    }

    fn decode(bytes: &[u8]) -> Result<PairTable, DecodeError> {
        let rows: Vec<(u32, u32, PairState)> = codec::decode(bytes)?;
        if rows.iter().any(|(a, b, _)| a >= b)
            || rows.windows(2).any(|w| (w[0].0, w[0].1) >= (w[1].0, w[1].1))
        {
            return Err(DecodeError::new("pairs are not in order"));
        }
        let link = |i: u32| LinkIdx::new(i as usize);
        Ok(PairTable { pairs: rows.into_iter().map(|(a, b, state)| (link(a), link(b), state)).collect() })
    }

    fn summary(artefact: &PairTable) -> String {
        let count = |state| artefact.pairs.iter().filter(|(_, _, s)| *s == state).count();
        format!(
            "{} of {} pairs are tested; never touching {}, adjacent {}, always touching {}, ignored {}",
            artefact.tested().count(),
            artefact.pairs.len(),
            count(PairState::Clear),
            count(PairState::Adjacent),
            count(PairState::Always),
            count(PairState::Ignored),
        )
    }
}

#[cfg(feature = "build")]
mod build {
    use robotc_core::geom::{self, ConvexParts as Parts3};
    use robotc_core::model::{Configuration, Dof, JointMotion, Kinematics, LinkPoses, RobotModel};
    use robotc_core::rng::Rng;
    use robotc_core::{DofIdx, Pose};
    use std::sync::Arc;

    use super::*;
    use crate::kind::{Build, BuildError, Context};

    impl Build for SelfCollisionPairs {
        fn build(
            inputs: &Robot,
            parameters: &PairParameters,
            context: &Context<'_>,
        ) -> Result<PairTable, BuildError> {
            let bodies = Bodies::load(inputs, context)?;
            let mut rng = context.seed().split("samples").rng();
            let samples: Vec<LinkPoses> =
                (0..parameters.samples).map(|_| bodies.poses(&random(bodies.model(), &mut rng))).collect();
            let pairs = bodies.moving_pairs();
            let states = context.map(&pairs, |_, &(a, b)| {
                if inputs.ignored.contains(&(a, b)) {
                    PairState::Ignored
                } else if adjacent(bodies.model(), a, b, &bodies.has_shape) {
                    PairState::Adjacent
                } else {
                    bodies.examine(a, b, &samples, parameters.boxes)
                }
            })?;
            let row = |((a, b), state)| (a, b, state);
            Ok(PairTable { pairs: pairs.into_iter().zip(states).map(row).collect() })
        }

        /// Fresh samples contradict no claim that two links never touch, and the pairs are complete.
        fn check(
            artefact: &PairTable,
            inputs: &Robot,
            parameters: &PairParameters,
            context: &Context<'_>,
        ) -> Result<(), BuildError> {
            let bodies = Bodies::load(inputs, context)?;
            let expected = bodies.moving_pairs();
            if !artefact.pairs.iter().map(|&(a, b, _)| (a, b)).eq(expected) {
                return Err(BuildError::Check("the table does not hold every pair once".into()));
            }
            let clear = artefact.pairs.iter().filter(|(_, _, state)| *state == PairState::Clear);
            let clear: Vec<_> = clear.map(|&(a, b, _)| (a, b)).collect();
            let mut rng = context.seed().split("check").rng();
            for _ in 0..parameters.samples.min(200) {
                context.checkpoint()?;
                let q = random(bodies.model(), &mut rng);
                let poses = bodies.poses(&q);
                if let Some((a, b)) = clear.iter().find(|&&(a, b)| bodies.within(a, b, &poses, 0.0)) {
                    return Err(BuildError::Check(format!("links {a} and {b} touch at {:?}", q.values())));
                }
            }
            Ok(())
        }
    }

    /// Whether nothing but links without shapes is between two rigid bodies of a robot.
    fn adjacent(model: &RobotModel, a: LinkIdx, b: LinkIdx, has_shape: &[bool]) -> bool {
        let (top_a, top_b) = (top(model, a), top(model, b));
        let path = |from: LinkIdx, to: LinkIdx| -> Option<Vec<LinkIdx>> {
            let joints = model.joints_between(to, from)?;
            Some(joints.iter().map(|&j| top(model, model.joints()[j].parent)).collect())
        };
        let Some(between) = path(top_a, top_b).or_else(|| path(top_b, top_a)) else { return false };
        let shaped = |body: LinkIdx| model.rigid_group(body).iter().any(|&l| has_shape[l.index()]);
        between.into_iter().filter(|&body| body != top_a && body != top_b).all(|body| !shaped(body))
    }

    /// The highest link of the rigid body that a link belongs to.
    fn top(model: &RobotModel, link: LinkIdx) -> LinkIdx {
        let group = model.rigid_group(link);
        let is_top = |&&l: &&LinkIdx| model.parent(l).is_none_or(|parent| !group.contains(&parent));
        *group.iter().find(is_top).expect("a rigid body has a highest link")
    }

    fn random(model: &RobotModel, rng: &mut Rng) -> Configuration {
        let draw = |dof: &Dof| {
            let (low, high) = range(dof);
            rng.range(low, high)
        };
        Configuration::from_values(model.dofs().iter().map(draw).collect())
    }

    /// The values that a degree of freedom can have, where infinite ones repeat or are given up.
    fn range(dof: &Dof) -> (f64, f64) {
        let (low, high) = dof.sampling_range();
        let finite = |x: f64| if x.is_finite() { x } else { std::f64::consts::PI.copysign(x) };
        (finite(low), finite(high))
    }

    /// The bodies of a robot with their shapes.
    struct Bodies {
        kinematics: Kinematics,
        shapes: Vec<Option<Arc<Parts3>>>,
        has_shape: Vec<bool>,
    }

    impl Bodies {
        fn load(inputs: &Robot, context: &Context<'_>) -> Result<Self, BuildError> {
            let model = inputs.mechanism.model();
            let mut shapes = vec![None; model.links().len()];
            for (link, dep) in &inputs.bodies {
                shapes[link.index()] = Some(context.load(dep)?).filter(|parts| !parts.is_empty());
            }
            let has_shape = shapes.iter().map(Option::is_some).collect();
            Ok(Self { kinematics: Kinematics::new(model.clone()), shapes, has_shape })
        }

        fn model(&self) -> &RobotModel {
            self.kinematics.model()
        }

        fn poses(&self, q: &Configuration) -> LinkPoses {
            let mut poses = LinkPoses::default();
            self.kinematics.link_poses(q, &mut poses);
            poses
        }

        /// Pairs of links with shapes that are not one rigid body; lower index first, ascending.
        fn moving_pairs(&self) -> Vec<(LinkIdx, LinkIdx)> {
            let model = self.model();
            let links: Vec<LinkIdx> = model.links().indices().filter(|l| self.has_shape[l.index()]).collect();
            let mut pairs = Vec::new();
            for (i, &a) in links.iter().enumerate() {
                let rigid = model.rigid_group(a);
                pairs.extend(links[i + 1..].iter().filter(|b| !rigid.contains(b)).map(|&b| (a, b)));
            }
            pairs
        }

        fn shape(&self, link: LinkIdx) -> &Parts3 {
            self.shapes[link.index()].as_deref().expect("pairs are made of links with shapes")
        }

        /// Whether two links are not more than `margin` apart; "no" is certain.
        fn within(&self, a: LinkIdx, b: LinkIdx, poses: &LinkPoses, margin: f64) -> bool {
            let (root_from_a, root_from_b) = (poses.root_from(a), poses.root_from(b));
            let sphere = |parts: &Parts3, pose: &Pose| -> Vec<_> {
                parts.iter().map(|p| p.bounding_sphere()).map(|(c, r)| (pose * c, r)).collect()
            };
            let (near_a, near_b) = (sphere(self.shape(a), root_from_a), sphere(self.shape(b), root_from_b));
            let apart = |i: usize, j: usize| {
                let reach = near_a[i].1 + near_b[j].1 + margin;
                (near_a[i].0 - near_b[j].0).norm_squared() > reach * reach * (1.0 + 1e-12)
            };
            self.shape(a).iter().enumerate().any(|(i, part_a)| {
                self.shape(b).iter().enumerate().any(|(j, part_b)| {
                    !apart(i, j) && geom::within(part_a, root_from_a, part_b, root_from_b, margin)
                })
            })
        }

        /// What samples and proof say about a pair.
        fn examine(&self, a: LinkIdx, b: LinkIdx, samples: &[LinkPoses], boxes: u32) -> PairState {
            let mut outcomes = samples.iter().map(|poses| self.within(a, b, poses, 0.0));
            let Some(first) = outcomes.next() else { return PairState::Unproven };
            match (first, outcomes.any(|touches| touches != first)) {
                (_, true) => PairState::Touching,
                (true, false) => PairState::Always,
                (false, false) => self.prove_clear(a, b, boxes),
            }
        }

        /// Covers all configurations by boxes in whose middle the links are farther apart than they can come closer
        /// within the box. Ends with `Touching` where they touch, or `Unproven` when the boxes are spent.
        fn prove_clear(&self, a: LinkIdx, b: LinkIdx, boxes: u32) -> PairState {
            let model = self.model();
            let speeds = self.approach_speeds(a, b);
            let mut q = Configuration::neutral(model);
            let whole: Vec<(DofIdx, f64, f64, f64)> = speeds
                .iter()
                .map(|&(dof, speed)| {
                    let (low, high) = range(&model.dofs()[dof]);
                    (dof, speed, 0.5 * (low + high), 0.5 * (high - low))
                })
                .collect();
            let mut open = vec![whole];
            for _ in 0..boxes {
                let Some(mut joints) = open.pop() else { return PairState::Clear };
                for &(dof, _, middle, _) in &joints {
                    q[dof] = middle;
                }
                let poses = self.poses(&q);
                let travel: f64 = joints.iter().map(|(_, speed, _, half)| speed * half).sum();
                if !self.within(a, b, &poses, travel * (1.0 + 1e-9) + 1e-9) {
                    continue;
                }
                if self.within(a, b, &poses, 0.0) {
                    return PairState::Touching;
                }
                let widest = joints.iter_mut().max_by(|x, y| (x.1 * x.3).total_cmp(&(y.1 * y.3)));
                let Some(widest) = widest else { return PairState::Unproven };
                let (dof, middle, half) = (widest.0, widest.2, 0.5 * widest.3);
                widest.3 = half;
                for side in [-half, half] {
                    let mut part = joints.clone();
                    for joint in part.iter_mut().filter(|joint| joint.0 == dof) {
                        joint.2 = middle + side;
                    }
                    open.push(part);
                }
            }
            if open.is_empty() { PairState::Clear } else { PairState::Unproven }
        }

        /// For each degree of freedom between two links, how fast at most it brings them together: metres per unit,
        /// in any configuration.
        ///
        /// A joint moves all that is on one side of it rigidly against the other; no point of a link is farther from the
        /// joint's axis than the bones between are long, seen from either link.
        fn approach_speeds(&self, a: LinkIdx, b: LinkIdx) -> Vec<(DofIdx, f64)> {
            let model = self.model();
            let mut ancestors = vec![a];
            while let Some(parent) = model.parent(*ancestors.last().expect("not empty")) {
                ancestors.push(parent);
            }
            let common = std::iter::successors(Some(b), |&l| model.parent(l)).find(|l| ancestors.contains(l));
            let common = common.expect("links of a robot have a common ancestor");
            let up = model.joints_between(common, a).expect("an ancestor");
            let down = model.joints_between(common, b).expect("an ancestor");

            // Bones from one link to the other: a's side upwards, then b's side downwards.
            let path: Vec<_> = up.iter().rev().chain(&down).copied().collect();
            let slide = |dof: DofIdx, factor: f64, offset: f64| {
                let (low, high) = range(&model.dofs()[dof]);
                (factor * low + offset).abs().max((factor * high + offset).abs())
            };
            let drive = |j| match model.joints()[j].drive {
                robotc_core::model::Drive::Fixed => None,
                robotc_core::model::Drive::Dof(dof) => Some((dof, 1.0, 0.0)),
                robotc_core::model::Drive::Mimic { dof, multiplier, offset } => {
                    Some((dof, multiplier, offset))
                }
            };
            // Between the frames of the parent and of the child of a joint.
            let bone = |j| {
                let joint = &model.joints()[j];
                let slides = joint.motion == JointMotion::Prismatic;
                let extra = drive(j).filter(|_| slides).map_or(0.0, |(dof, f, o)| slide(dof, f, o));
                joint.parent_from_joint().translation.vector.norm() + extra
            };
            let radius = |link: LinkIdx| {
                let far = self.shape(link).points().map(|p| p.coords.norm());
                far.fold(0.0, f64::max)
            };
            // The axis passes through the origin of the joint's child frame, or slides along itself: when walking up
            // from a, the child's frame is the near end of the bone; walking down to b, the far one.
            let mut from_a = Vec::new();
            let mut length = radius(a);
            for (i, &j) in path.iter().enumerate() {
                let upwards = i < up.len();
                from_a.push(if upwards { length } else { length + bone(j) });
                length += bone(j);
            }
            let mut from_b = vec![0.0; path.len()];
            let mut length = radius(b);
            for (i, &j) in path.iter().enumerate().rev() {
                let upwards = i < up.len();
                from_b[i] = if upwards { length + bone(j) } else { length };
                length += bone(j);
            }
            let mut speeds: Vec<(DofIdx, f64)> = Vec::new();
            for (i, &j) in path.iter().enumerate() {
                let Some((dof, factor, _)) = drive(j) else { continue };
                let speed = match model.joints()[j].motion {
                    JointMotion::Revolute => factor.abs() * f64::min(from_a[i], from_b[i]),
                    _ => factor.abs(),
                };
                match speeds.iter_mut().find(|(known, _)| *known == dof) {
                    Some((_, sum)) => *sum += speed,
                    None => speeds.push((dof, speed)),
                }
            }
            speeds
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_out_of_order_are_refused() {
        let link = LinkIdx::new;
        let row = |a, b| (link(a), link(b), PairState::Touching);
        for (pairs, good) in [
            (vec![row(0, 1), row(0, 2), row(1, 2)], true),
            (vec![row(1, 0)], false),
            (vec![row(1, 1)], false),
            (vec![row(0, 2), row(0, 1)], false),
            (vec![row(0, 1), row(0, 1)], false),
        ] {
            let bytes = SelfCollisionPairs::encode(&PairTable { pairs });
            assert_eq!(SelfCollisionPairs::decode(&bytes).is_ok(), good);
        }
    }
}
