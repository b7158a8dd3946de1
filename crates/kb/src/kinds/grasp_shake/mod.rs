//! How well grasps stand being shaken, by simulation.

#[cfg(feature = "shake")]
mod rig;

use robotc_core::robot::Hold;
use robotc_planning::grasp::Grasp;
use serde::{Deserialize, Serialize};

use super::{ConvexParts, GraspSet};
use crate::codec;
use crate::graph::{Dep, PlanError, Planner};
use crate::kind::{DecodeError, Kind, Portability};
use crate::kinds::grip::{GripperInputs, diagonal};
use crate::parameters::round_step;
use crate::project::{OfGripperAndObject, OfObject, OfShape, Project, Subject};
use crate::projection::Shapes;
use crate::record::Parts;
use crate::resolve::{Knowledge, LoadError};

/// The kind; its artefact is [`Shaken`].
///
/// The hand stands where a grasp wants it and closes with a given force on the object, which is not quite where it should be; then the
/// object is lifted and pulled in six directions, with low friction and with high. Only simulated where `grasps` asks
/// for it, since a hundred grasps take seconds.
pub struct GraspShake;

/// What shaking is computed from.
#[cfg_attr(not(feature = "shake"), expect(dead_code, reason = "artefacts that only generators load"))]
pub struct Inputs {
    gripper: GripperInputs,
    object_parts: Dep<ConvexParts>,
    grasps: Dep<GraspSet>,
    /// Diagonal of the object.
    size: f64,
    friction: f64,
}

crate::parameters! {
    /// Parameters of shaking.
    pub struct ShakeParameters {
        /// Grasps of the set that are shaken, best first; none are unless asked for.
        grasps: u32 [""] in 0..=100000 = 0;
        /// Displacements of the object that each is shaken with, for each friction.
        tries: u32 [""] in 1..=1000 = 2;
        /// The low friction.
        low_friction: f64 [""] in 0.01..=10.0 = auto "0.6 times that of the object";
        /// The high friction.
        high_friction: f64 [""] in 0.01..=10.0 = auto "1.6 times that of the object";
        /// How far the object is shifted, at most.
        shift: f64 ["m"] in 0.0..=1.0 = auto "1 cm, at most a tenth of the object's diagonal";
        /// How far it is turned, at most.
        turn: f64 ["rad"] in 0.0..=1.5 = 0.0873;
        /// Force of a drive at the farthest point that it moves, in weights of the object.
        squeeze: f64 [""] in 0.0..=1000.0 = 10.0;
        /// Acceleration in each direction.
        pull: f64 ["m/s2"] in 0.0..=1000.0 = 10.0;
        /// How long each direction is pulled.
        seconds: f64 ["s"] in 0.01..=60.0 = 0.25;
        /// Step of the simulation.
        step: f64 ["s"] in 0.0001..=0.01 = 0.002;
    }
}

/// How the best grasps of a set stood being shaken.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Shaken {
    /// Pulls of each grasp, over all displacements and both frictions.
    pub pulls: u32,
    /// Of these, the pulls that it withstood; in the order of the set, for its first grasps.
    pub withstood: Vec<u32>,
}

impl Shaken {
    /// Share of the pulls that a grasp withstood, by its position in the set; `None` when it was not shaken.
    pub fn share(&self, grasp: usize) -> Option<f64> {
        Some(f64::from(*self.withstood.get(grasp)?) / f64::from(self.pulls.max(1)))
    }

    /// The grasps of the set with scores times the share of pulls that they withstood, best first; equal ones keep their order.
    /// One that was not shaken counts as one that withstood as much as the others do in the mean.
    pub fn ranked(&self, grasps: &[Grasp]) -> Vec<Grasp> {
        let shares: Vec<Option<f64>> = (0..grasps.len()).map(|i| self.share(i)).collect();
        let known = shares.iter().flatten();
        let mean = known.clone().sum::<f64>() / known.count().max(1) as f64;
        let score = |(grasp, share): (&Grasp, &Option<f64>)| Grasp {
            score: grasp.score * share.unwrap_or(mean),
            ..grasp.clone()
        };
        let mut ranked: Vec<Grasp> = grasps.iter().zip(&shares).map(score).collect();
        ranked.sort_by(|a, b| b.score.total_cmp(&a.score));
        ranked
    }
}

/// The grasps of a gripper and an object, best first: by what shaking says too, where it was asked for.
pub fn ranked_grasps(knowledge: &Knowledge, subject: &OfGripperAndObject) -> Result<Vec<Grasp>, LoadError> {
    let grasps = knowledge.load::<GraspSet>(subject)?;
    match knowledge.load::<GraspShake>(subject) {
        Ok(shaken) => Ok(shaken.ranked(&grasps)),
        Err(LoadError::NotPlanned { .. }) => Ok((*grasps).clone()),
        Err(error) => Err(error),
    }
}

impl Kind for GraspShake {
    const NAME: &'static str = "grasp_shake";
    const FORMAT: u32 = 1;
    const ALGORITHM: u32 = 1;
    // Long simulations of contact turn a difference in the last bit into another result.
    const PORTABILITY: Portability = Portability::SameTarget;
    const IN_PIECES: bool = true;
    const DOC: &'static str = "How the best grasps of a set stand being lifted and shaken in simulation; ranks them, where `grasps` asks for it.";

    type Subject = OfGripperAndObject;
    type Inputs = Inputs;
    type Parameters = ShakeParameters;
    type Artefact = Shaken;

    fn subjects(project: &Project) -> Vec<OfGripperAndObject> {
        let asked = project.given().get(Self::NAME, "grasps").is_some();
        // What attracts holds by a force that the simulation does not know.
        let closes = |s: &OfGripperAndObject| project.robot().grippers[s.gripper].hold == Hold::Close;
        if asked { OfGripperAndObject::all(project).into_iter().filter(closes).collect() } else { Vec::new() }
    }

    fn inputs(planner: &mut Planner<'_>, subject: &OfGripperAndObject) -> Result<Inputs, PlanError> {
        let gripper = GripperInputs::plan(planner, subject.gripper)?;
        let object_parts = planner.need::<ConvexParts>(&OfShape::Object(subject.object))?;
        let grasps = planner.need::<GraspSet>(subject)?;
        let task = planner.project().task().expect("objects belong to a task");
        let object = &task.objects[subject.object];
        let size = diagonal(&Shapes::of(&object.geometry).surface().vertices);
        Ok(Inputs { gripper, object_parts, grasps, size, friction: object.friction })
    }

    fn key_parts(inputs: &Inputs, parts: &mut Parts) {
        // Artefacts are added by the planner; of size and friction follow defaults of parameters, which are part of the key.
        let Inputs { gripper, object_parts: _, grasps: _, size: _, friction: _ } = inputs;
        gripper.key_parts(parts);
    }

    fn default_from(project: &Project, subject: &OfGripperAndObject, parameter: &str) -> Option<String> {
        parameter.ends_with("friction").then(|| OfObject(subject.object).label(project))
    }

    fn defaults(inputs: &Inputs) -> ShakeParameters {
        ShakeParameters {
            low_friction: (0.6 * inputs.friction).clamp(0.01, 10.0),
            high_friction: (1.6 * inputs.friction).clamp(0.01, 10.0),
            shift: round_step(inputs.size / 10.0).min(0.01),
            ..ShakeParameters::constants()
        }
    }

    fn encode(artefact: &Shaken) -> Vec<u8> {
        codec::encode(artefact)
    }

    fn decode(bytes: &[u8]) -> Result<Shaken, DecodeError> {
        let shaken: Shaken = codec::decode(bytes)?;
        if shaken.withstood.iter().any(|&count| count > shaken.pulls) {
            return Err(DecodeError::new("a grasp withstood more than it was shaken"));
        }
        Ok(shaken)
    }

    fn summary(artefact: &Shaken) -> String {
        let whole = artefact.withstood.iter().filter(|&&count| count == artefact.pulls).count();
        let count = artefact.withstood.len();
        format!("{count} grasps shaken, {whole} of them withstood all {} pulls", artefact.pulls)
    }
}

/// A build without the simulation says so; what others computed is loaded all the same.
#[cfg(all(feature = "build", not(feature = "shake")))]
mod without {
    use super::*;
    use crate::kind::{Build, BuildError, Context};

    const HOW: &str = "this robotc has no simulation: build it with --features shake";

    impl Build for GraspShake {
        fn build(_: &Inputs, _: &ShakeParameters, _: &Context<'_>) -> Result<Shaken, BuildError> {
            Err(BuildError::Impossible(HOW.into()))
        }

        fn check(_: &Shaken, _: &Inputs, _: &ShakeParameters, _: &Context<'_>) -> Result<(), BuildError> {
            Err(BuildError::Impossible(HOW.into()))
        }
    }
}

#[cfg(feature = "shake")]
mod build {
    use nalgebra::{Translation3, UnitQuaternion, Vector3};
    use robotc_core::Pose;
    use robotc_core::rng::Rng;

    use super::rig::{Rig, ShakeOptions, Try};
    use super::*;
    use crate::kind::{Build, BuildError, Context};
    use crate::kinds::grasp_set::centre_of_volume;

    /// Pulls after lifting: both ways along the axes of the object.
    const WAYS: usize = 6;

    impl Build for GraspShake {
        fn build(
            inputs: &Inputs,
            parameters: &ShakeParameters,
            context: &Context<'_>,
        ) -> Result<Shaken, BuildError> {
            let (object, grasps) = (context.load(&inputs.object_parts)?, context.load(&inputs.grasps)?);
            let shapes = inputs.gripper.load(context)?;
            let hand = inputs.gripper.hand(&shapes);
            let centre = centre_of_volume(&object);
            let options = ShakeOptions {
                squeeze: parameters.squeeze,
                pull: parameters.pull,
                seconds: parameters.seconds,
                step: parameters.step,
                lost: 0.05_f64.min(0.5 * inputs.size),
                room: 3.0 * parameters.shift.max(1e-3),
            };
            let rig = Rig::new(inputs.gripper.mechanism.model(), &hand, &object, centre, options)
                .ok_or_else(|| BuildError::Impossible("the object has no volume".into()))?;
            let gripper = hand.gripper();
            let tool_from_palm = gripper.palm_from_tool.inverse();
            let shake = |i: usize, grasp: &Grasp| {
                let mut rng = context.seed().split("displacements").at(i as u64).rng();
                let mut directions = vec![grasp.approach_in_object.into_inner()];
                directions.extend((0..WAYS).map(|way| {
                    let mut direction = Vector3::zeros();
                    direction[way % 3] = if way < 3 { 1.0 } else { -1.0 };
                    direction
                }));
                let mut withstood = 0;
                for _ in 0..parameters.tries {
                    let object_from_displaced = displacement(parameters, &centre.coords, &mut rng);
                    for friction in [parameters.low_friction, parameters.high_friction] {
                        let attempt = Try {
                            object_from_palm: grasp.object_from_tool * tool_from_palm,
                            closed: &grasp.closed,
                            open: &gripper.preshapes[grasp.preshape].values,
                            object_from_displaced,
                            friction,
                        };
                        withstood += rig.withstood(&attempt, &directions);
                    }
                }
                withstood
            };
            let best = &grasps[..grasps.len().min(parameters.grasps as usize)];
            let withstood = context.map_in_pieces("shaken", best, shake)?;
            Ok(Shaken { pulls: pulls(parameters), withstood })
        }

        fn check(
            artefact: &Shaken,
            inputs: &Inputs,
            parameters: &ShakeParameters,
            context: &Context<'_>,
        ) -> Result<(), BuildError> {
            let grasps = context.load(&inputs.grasps)?.len().min(parameters.grasps as usize);
            if artefact.withstood.len() != grasps || artefact.pulls != pulls(parameters) {
                return Err(BuildError::Check("not every grasp was shaken as often as asked for".into()));
            }
            Ok(())
        }
    }

    fn pulls(parameters: &ShakeParameters) -> u32 {
        2 * parameters.tries * (1 + WAYS as u32)
    }

    /// A turn about the centre, and a shift.
    fn displacement(parameters: &ShakeParameters, centre: &Vector3<f64>, rng: &mut Rng) -> Pose {
        let angle = rng.range(-parameters.turn, parameters.turn);
        let turn = UnitQuaternion::from_axis_angle(&rng.direction(), angle);
        let shift = rng.direction().into_inner() * rng.range(0.0, parameters.shift);
        Pose::from_parts(Translation3::from(shift + centre - turn * centre), turn)
    }
}
