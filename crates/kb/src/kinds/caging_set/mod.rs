//! How a gripper can hold a door or a drawer loosely: poses between whose parts the handle is caught.

#[cfg(feature = "build")]
mod cage;
#[cfg(feature = "build")]
mod explore;

use nalgebra::{Quaternion, Translation3, UnitQuaternion};
use robotc_core::Pose;
use robotc_core::ids::{Idx, LinkIdx};
use robotc_planning::caging::CageGrasp;
pub use robotc_planning::caging::{Cage, CageHold};
use serde::{Deserialize, Serialize};

use crate::codec;
use crate::graph::{Dep, PlanError, Planner};
use crate::kind::{DecodeError, Kind, Portability};
use crate::kinds::ConvexParts;
use crate::kinds::grip::{GripperInputs, diagonal};
use crate::parameters::round_step;
use crate::project::{OfGripperAndArticle, OfShape};
use crate::projection::{Limits, Mechanism, Shapes};
use crate::record::Parts;

/// The kind; its artefact is a list of [`Cage`]s: first those that hold both ways, in each kind of hold those with contact first.
///
/// The hand comes in on the handle as for a grasp, closes, and opens again a little. It cages when the article cannot move by
/// more than `slack` without hitting the hand, there and wherever the hand is jittered to (thesis section 4.2.2, algorithm
/// 4.2; Diankov, Srinivasa, Ferguson and Kuffner, "Manipulation planning with caging grasps", 2008). What
/// stops the article in one direction only can push or pull it (section 3.4). More grips are found by moving those a little,
/// over and over: as far as the hand can turn and shift round the handle, without gaps between neighbours.
pub struct CagingSet;

/// What a caging set is computed from.
pub struct Inputs {
    gripper: GripperInputs,
    article: Mechanism,
    /// Joint that opens it, and values of all joints.
    joint: (usize, Vec<f64>),
    handle: (LinkIdx, Shapes),
    /// Parts of the links that the joint moves.
    moving: Vec<(LinkIdx, Dep<ConvexParts>)>,
}

crate::parameters! {
    /// Parameters of a caging set.
    pub struct CagingParameters {
        /// Distance between the rays that find points of the handle.
        spacing: f64 ["m"] in 0.0001..=10.0 = auto "at most a twelfth of the handle's diagonal";
        /// Directions of approach for each point: against the normal, then evenly round a cone about that.
        directions: u32 [""] in 1..=64 = 5;
        /// Half angle of that cone.
        cone: f64 ["rad"] in 0.0..=1.5 = 0.4;
        /// Equal turns of the hand about the direction of approach.
        rolls: u32 [""] in 1..=360 = 8;
        /// Distances of standing back after the first touch, evenly up to most_standoff.
        standoffs: u32 [""] in 1..=16 = 4;
        /// Largest distance of standing back.
        most_standoff: f64 ["m"] in 0.0..=1.0 = auto "at most half of the hand's size";
        /// Most approaches that are tried, drawn at random from all.
        approaches: u32 [""] in 1..=10000000 = 3000;
        /// How far the fingers open again after they closed, as a share of the way back to the preshape.
        looseness: f64 [""] in 0.0..=1.0 = 0.3;
        /// How far the article may move at the hand before it is stopped.
        slack: f64 ["m"] in 0.0001..=1.0 = auto "at most a third of the hand's size";
        /// How far the article may move in the closed hand that is in contact.
        play: f64 ["m"] in 0.0001..=0.1 = 0.004;
        /// How far the hand is moved to test a cage.
        jitter: f64 ["m"] in 0.0..=0.1 = 0.003;
        /// How far the hand is turned to test a cage.
        jitter_turn: f64 ["rad"] in 0.0..=1.0 = 0.05;
        /// Number of jittered hands, clear of the article, that have to cage it: M of the thesis.
        needed: u32 [""] in 0..=10000 = 20;
        /// Number of jittered hands that are drawn to find them: N of the thesis.
        tries: u32 [""] in 0..=100000 = 100;
        /// Tries of moving a grip that is known a little, to find more that it can change to.
        explored: u32 [""] in 0..=1000000 = 0;
        /// Grips from approaches that these start from, drawn at random from those in contact, all others being left
        /// out; 0 for all.
        explored_from: u32 [""] in 0..=100000 = 0;
        /// Farthest that a grip is shifted in a try.
        explored_shift: f64 ["m"] in 0.0001..=0.1 = 0.015;
        /// Farthest that a grip is turned in a try.
        explored_turn: f64 ["rad"] in 0.001..=1.0 = 0.25;
        /// Most grips that are kept of each kind of hold.
        most: u32 [""] in 1..=100000 = 200;
    }
}

impl Kind for CagingSet {
    const NAME: &'static str = "caging_set";
    const FORMAT: u32 = 1;
    const ALGORITHM: u32 = 2;
    const PORTABILITY: Portability = Portability::Portable;
    const DOC: &'static str = "The ways a gripper can hold a door or drawer loosely, so that it cannot get away: cages, pulls and pushes.";

    type Subject = OfGripperAndArticle;
    type Inputs = Inputs;
    type Parameters = CagingParameters;
    type Artefact = Vec<Cage>;

    fn inputs(planner: &mut Planner<'_>, subject: &OfGripperAndArticle) -> Result<Inputs, PlanError> {
        let gripper = GripperInputs::plan(planner, subject.gripper)?;
        let task = planner.project().task().expect("articles belong to a task").clone();
        let article = &task.articles[subject.article];
        let mut moving = Vec::new();
        for (link, body) in article.moving_bodies() {
            moving.push((link, planner.need::<ConvexParts>(&OfShape::Obstacle(body))?));
        }
        Ok(Inputs {
            gripper,
            article: Mechanism::whole(&article.model, Limits::Dropped),
            joint: (article.dof.index(), article.configuration.values().to_vec()),
            handle: (article.handle, Shapes::of(&article.model.links()[article.handle].collisions)),
            moving,
        })
    }

    fn key_parts(inputs: &Inputs, parts: &mut Parts) {
        let Inputs { gripper, article, joint, handle, moving } = inputs;
        gripper.key_parts(parts);
        article.key_parts(parts);
        parts.add("joint values", "article", joint);
        parts.add("handle", "", &handle.0.index());
        handle.1.key_parts("handle", parts);
        let moving: Vec<usize> = moving.iter().map(|(link, _)| link.index()).collect();
        parts.add("moving links", "article", &moving);
    }

    fn defaults(inputs: &Inputs) -> CagingParameters {
        let reach = inputs.gripper.size();
        CagingParameters {
            spacing: round_step(diagonal(&inputs.handle.1.surface().vertices) / 12.0),
            most_standoff: round_step(reach / 2.0),
            slack: round_step(reach / 3.0),
            ..CagingParameters::constants()
        }
    }

    fn encode(artefact: &Vec<Cage>) -> Vec<u8> {
        codec::encode(&artefact.iter().map(Stored::of).collect::<Vec<_>>())
    }

    fn decode(bytes: &[u8]) -> Result<Vec<Cage>, DecodeError> {
        codec::decode::<Vec<Stored>>(bytes)?.into_iter().map(Stored::cage).collect()
    }

    fn summary(artefact: &Vec<Cage>) -> String {
        let count = |hold: CageHold| artefact.iter().filter(|c| c.hold == hold).count();
        let contact = artefact.iter().filter(|c| c.hold == CageHold::Both && c.grasp.contact).count();
        let [both, opening, closing] = [CageHold::Both, CageHold::Opening, CageHold::Closing].map(count);
        format!(
            "{both} cages, {contact} of them with contact; {opening} that only open, {closing} that only close"
        )
    }
}

/// A cage as stored: plain numbers, metres and radians.
#[derive(Serialize, Deserialize)]
struct Stored {
    position: [f64; 3],
    rotation: [f64; 4],
    contact: bool,
    hold: u8,
    preshape: u32,
    loose: Vec<f64>,
    closed: Vec<f64>,
}

impl Stored {
    fn of(cage: &Cage) -> Self {
        let pose = &cage.grasp.part_from_tool;
        Self {
            position: pose.translation.vector.into(),
            rotation: pose.rotation.coords.into(),
            contact: cage.grasp.contact,
            hold: match cage.hold {
                CageHold::Both => 0,
                CageHold::Opening => 1,
                CageHold::Closing => 2,
            },
            preshape: cage.preshape as u32,
            loose: cage.loose.clone(),
            closed: cage.closed.clone(),
        }
    }

    fn cage(self) -> Result<Cage, DecodeError> {
        let numbers = self.position.iter().chain(&self.rotation).chain(&self.loose).chain(&self.closed);
        if !numbers.copied().all(f64::is_finite) {
            return Err(DecodeError::new("a number is not finite"));
        }
        let rotation = UnitQuaternion::new_unchecked(Quaternion::from(self.rotation));
        if (rotation.norm() - 1.0).abs() > 1e-9 {
            return Err(DecodeError::new("a rotation is not of unit length"));
        }
        let part_from_tool = Pose::from_parts(Translation3::from(self.position), rotation);
        let hold = match self.hold {
            0 => CageHold::Both,
            1 => CageHold::Opening,
            2 => CageHold::Closing,
            _ => return Err(DecodeError::new("a hold is unknown")),
        };
        Ok(Cage {
            grasp: CageGrasp { part_from_tool, contact: self.contact },
            hold,
            preshape: self.preshape as usize,
            loose: self.loose,
            closed: self.closed,
        })
    }
}

#[cfg(feature = "build")]
mod build {
    use robotc_core::geom::{ConvexParts as Parts3, MeshIndex};
    use robotc_core::ids::DofIdx;
    use robotc_core::model::{Configuration, JointMotion, Kinematics, TriMesh};
    use robotc_planning::mechanism::{Mechanism as Axis, MechanismMotion};

    use super::cage::{CageOptions, Caged, Seedling};
    use super::explore::ExploreOptions;
    use super::*;
    use crate::kind::{Build, BuildError, Context};
    use crate::kinds::grip::surface::{ApproachOptions, approaches};

    /// The moving part in its axis frame.
    struct Part {
        parts: Parts3,
        handle: TriMesh,
        motion: MechanismMotion,
    }

    impl Part {
        fn load(inputs: &Inputs, context: &Context<'_>) -> Result<Self, BuildError> {
            let model = inputs.article.model();
            let dof: DofIdx = Idx::new(inputs.joint.0);
            let joint = &model.joints()[model.dofs()[dof].joint];
            let motion = match joint.motion {
                JointMotion::Prismatic => MechanismMotion::Slide,
                _ => MechanismMotion::Hinge,
            };
            let kinematics = Kinematics::new(model.clone());
            let at = Configuration::from_values(inputs.joint.1.clone());
            let root_from_axis = kinematics.root_from_link(&at, joint.child) * Axis::link_from_axis(joint);
            let axis_from = |link| root_from_axis.inverse() * kinematics.root_from_link(&at, link);
            let mut parts = Parts3::default();
            for (link, dep) in &inputs.moving {
                parts.extend(context.load(dep)?.transformed(&axis_from(*link)));
            }
            let handle = inputs.handle.1.surface().transformed(&axis_from(inputs.handle.0));
            Ok(Self { parts, handle, motion })
        }
    }

    fn options(p: &CagingParameters) -> CageOptions {
        CageOptions {
            looseness: p.looseness,
            slack: p.slack,
            play: p.play,
            jitter: p.jitter,
            jitter_turn: p.jitter_turn,
            needed: p.needed,
            tries: p.tries,
        }
    }

    impl Build for CagingSet {
        fn build(
            inputs: &Inputs,
            parameters: &CagingParameters,
            context: &Context<'_>,
        ) -> Result<Vec<Cage>, BuildError> {
            let part = Part::load(inputs, context)?;
            let shapes = inputs.gripper.load(context)?;
            let hand = inputs.gripper.hand(&shapes);
            let step = parameters.most_standoff / f64::from(parameters.standoffs);
            let approach_options = ApproachOptions {
                spacing: parameters.spacing,
                rolls: parameters.rolls as usize,
                directions: parameters.directions as usize,
                cone: parameters.cone,
                standoffs: (1..=parameters.standoffs).map(|k| step * f64::from(k)).collect(),
                rays: vec![nalgebra::Vector3::zeros()],
                preshapes: hand.gripper().preshapes.len(),
                most: parameters.approaches as usize,
            };
            let index = MeshIndex::new(&part.handle);
            let approaches = approaches(&part.handle, &index, &approach_options, context.seed());
            if approaches.is_empty() {
                return Err(BuildError::Impossible("the handle has no surface".into()));
            }
            let options = options(parameters);
            let caged = Caged { hand: &hand, parts: &part.parts, motion: part.motion, options: &options };
            let found = context.map(&approaches, |i, approach| {
                let seed = context.seed().split("jitter").at(i as u64);
                caged.attempt(&approach.start(&hand.gripper().approach_in_tool), seed)
            })?;
            let mut found: Vec<Cage> = found.into_iter().flatten().collect();
            if parameters.explored_from > 0 {
                found.retain(|cage| cage.hold == CageHold::Both && cage.grasp.contact);
                context.seed().split("first").rng().shuffle(&mut found);
                found.truncate(parameters.explored_from as usize);
            }
            let explore = ExploreOptions {
                tries: parameters.explored,
                shift: parameters.explored_shift,
                turn: parameters.explored_turn,
            };
            explore.explore(&caged, &mut found, context.seed().split("explored"), |count, make| {
                let numbers: Vec<u32> = (0..count).collect();
                context.map(&numbers, |number, _| make(number))
            })?;
            let mut cages = Vec::new();
            for hold in [CageHold::Both, CageHold::Opening, CageHold::Closing] {
                let mut of_hold: Vec<&Cage> = found.iter().filter(|c| c.hold == hold).collect();
                of_hold.sort_by_key(|c| !c.grasp.contact);
                cages.extend(of_hold.into_iter().take(parameters.most as usize).cloned());
            }
            Ok(cages)
        }

        /// Each grip is clear of the article, and stops it again in steps half as long.
        fn check(
            artefact: &Vec<Cage>,
            inputs: &Inputs,
            parameters: &CagingParameters,
            context: &Context<'_>,
        ) -> Result<(), BuildError> {
            let part = Part::load(inputs, context)?;
            let shapes = inputs.gripper.load(context)?;
            let hand = inputs.gripper.hand(&shapes);
            let options = options(parameters);
            let caged = Caged { hand: &hand, parts: &part.parts, motion: part.motion, options: &options };
            let fingers = hand.gripper().dofs.len();
            for (i, cage) in artefact.iter().enumerate() {
                let wrong = |what: &str| Err(BuildError::Check(format!("grip {i} {what}")));
                let known = cage.preshape < hand.gripper().preshapes.len();
                if !known || cage.loose.len() != fingers || cage.closed.len() != fingers {
                    return wrong("does not belong to this gripper");
                }
                let seedling = Seedling { part_from_tool: cage.grasp.part_from_tool, values: &cage.loose };
                if caged.touches(&seedling, 0.0) {
                    return wrong("is inside of the article");
                }
                let stops = |ahead: f64| caged.stops(&seedling, ahead * parameters.slack, 2);
                let (forth, back) = (stops(1.0), stops(-1.0));
                let holds = match cage.hold {
                    CageHold::Both => forth && back,
                    CageHold::Opening => back,
                    CageHold::Closing => forth,
                };
                if !holds {
                    return wrong("lets the article go");
                }
            }
            Ok(())
        }
    }
}
