//! How a gripper can hold an object: force-closure grasps, best first.

#[cfg(feature = "build")]
mod contacts;
mod coverage;
#[cfg(feature = "build")]
mod generate;
#[cfg(feature = "build")]
mod steadiness;
mod stored;
#[cfg(feature = "build")]
mod tips;

#[cfg(feature = "shake")]
pub(crate) use build::centre_of_volume;
use robotc_planning::grasp::Grasp;

use crate::codec;
use crate::graph::{Dep, PlanError, Planner};
use crate::kind::{DecodeError, Kind, Portability};
use crate::kinds::ConvexParts;
use crate::kinds::grip::{GripperInputs, diagonal};
use crate::parameters::round_step;
use stored::Stored;

use crate::project::{OfGripperAndObject, OfObject, OfShape, Project, Subject};
use crate::projection::Shapes;
use crate::record::Parts;

/// The kind; its artefact is a list of [`Grasp`]s, best first.
///
/// Rays find points of the object's surface; the hand approaches each from several directions, with several turns,
/// preshapes and standoffs, closes, and is kept when its contact patches resist every wrench (thesis section 4.2) and it is
/// repeatable (algorithm 4.1). Magnets and suction cups touch instead, with contacts as wide as their tips whose normals agree
/// (figure 4.16). The best of all directions of approach are kept, ranked by the force that
/// they bear at the centre of mass times the share of disturbed grasps that bear half of it.
pub struct GraspSet;

/// What a grasp set is computed from.
#[cfg_attr(not(feature = "build"), expect(dead_code, reason = "artefacts that only generators load"))]
pub struct Inputs {
    gripper: GripperInputs,
    object: Shapes,
    object_parts: Dep<ConvexParts>,
    friction: f64,
}

crate::parameters! {
    /// Parameters of a grasp set.
    pub struct GraspParameters {
        /// Distance between the rays that find points of the surface.
        spacing: f64 ["m"] in 0.0001..=10.0 = auto "at most a twelfth of the object's diagonal";
        /// Directions of approach for each point: against the normal, then evenly round a cone about that.
        directions: u32 [""] in 1..=64 = 5;
        /// Half angle of that cone.
        cone: f64 ["rad"] in 0.0..=1.5 = 0.4;
        /// Equal turns of the hand about the direction of approach.
        rolls: u32 [""] in 1..=360 = 8;
        /// Distances of standing back after the first touch, evenly from least_standoff to most_standoff.
        standoffs: u32 [""] in 1..=16 = 4;
        /// Smallest distance of standing back.
        least_standoff: f64 ["m"] in 0.0..=1.0 = auto "at most a fiftieth of the hand's size";
        /// Largest distance of standing back.
        most_standoff: f64 ["m"] in 0.0..=1.0 = auto "at most the hand's size";
        /// Approach rays of the hand: along the tool's axis, then evenly round it.
        rays: u32 [""] in 1..=16 = 1;
        /// Distance of those beside the tool's axis from it.
        ray_radius: f64 ["m"] in 0.0..=1.0 = auto "at most a tenth of the hand's size";
        /// Most approaches that are tried, drawn at random from all.
        approaches: u32 [""] in 1..=10000000 = 8000;
        /// Coulomb friction between finger and object.
        friction: f64 [""] in 0.01..=10.0 = auto "that of the object";
        /// Edges of the pyramid that stands for a friction cone.
        cone_edges: u32 [""] in 3..=64 = 8;
        /// Surface points no more than this farther from a finger than the nearest are touched: how far pad and object give way.
        patch_depth: f64 ["m"] in 0.0001..=0.1 = auto "a 120th of the object's diagonal, from 0.5 to 2 mm";
        /// How far the convex parts of the object may stand off its surface where a finger touches them.
        cover_gap: f64 ["m"] in 0.0..=1.0 = auto "at most a twentieth of the object's diagonal";
        /// Most points that stand for the patch of one finger.
        patch_points: u32 [""] in 1..=64 = 6;
        /// Smallest epsilon of a grasp that is kept.
        least_epsilon: f64 [""] in 0.0..=1.0 = 0.01;
        /// How far points of the object are displaced, at most, to test how repeatable a grasp is.
        disturbance: f64 ["m"] in 0.0..=1.0 = auto "1 cm, at most a tenth of the object's diagonal";
        /// Number of such disturbed grasps; 0 leaves the test out.
        repeats: u32 [""] in 0..=10000 = 16;
        /// A grasp is fragile when this much of the deviation of the hand exceeds the disturbance.
        slip: f64 [""] in 0.0..=10.0 = 0.7;
        /// Of tips that attract: smallest width of the contacts as a share of that of the tips, in every direction.
        footprint: f64 [""] in 0.0..=1.0 = 0.7;
        /// Of tips that attract: largest angle of a contact's normal to their mean.
        agreement: f64 ["rad"] in 0.0..=1.5 = 0.3;
        /// Whether the volume of what a grasp resists is computed too; it takes longer than all else.
        volumes: bool = false;
        /// Most grasps that are kept, best first.
        most_grasps: u32 [""] in 1..=100000 = 600;
    }
}

impl Kind for GraspSet {
    const NAME: &'static str = "grasp_set";
    const FORMAT: u32 = 2;
    const ALGORITHM: u32 = 7;
    const PORTABILITY: Portability = Portability::Portable;
    const IN_PIECES: bool = true;
    const DOC: &'static str =
        "The ways a gripper can hold an object: force-closure grasps with their contacts, best first.";

    type Subject = OfGripperAndObject;
    type Inputs = Inputs;
    type Parameters = GraspParameters;
    type Artefact = Vec<Grasp>;

    fn inputs(planner: &mut Planner<'_>, subject: &OfGripperAndObject) -> Result<Inputs, PlanError> {
        let gripper = GripperInputs::plan(planner, subject.gripper)?;
        let object_parts = planner.need::<ConvexParts>(&OfShape::Object(subject.object))?;
        let task = planner.project().task().expect("objects belong to a task");
        let object = &task.objects[subject.object];
        let (object, friction) = (Shapes::of(&object.geometry), object.friction);
        Ok(Inputs { gripper, object, object_parts, friction })
    }

    fn key_parts(inputs: &Inputs, parts: &mut Parts) {
        // Artefacts are added by the planner; friction is the default of a parameter, which is part of the key.
        let Inputs { gripper, object, object_parts: _, friction: _ } = inputs;
        gripper.key_parts(parts);
        object.key_parts("object", parts);
    }

    fn default_from(project: &Project, subject: &OfGripperAndObject, parameter: &str) -> Option<String> {
        (parameter == "friction").then(|| OfObject(subject.object).label(project))
    }

    fn defaults(inputs: &Inputs) -> GraspParameters {
        let size = diagonal(&inputs.object.surface().vertices);
        let reach = inputs.gripper.size();
        GraspParameters {
            spacing: round_step(size / 12.0),
            least_standoff: round_step(reach / 50.0),
            most_standoff: round_step(reach),
            friction: inputs.friction,
            cover_gap: round_step(size / 20.0),
            patch_depth: (size / 120.0).clamp(0.0005, 0.002),
            ray_radius: round_step(reach / 10.0),
            disturbance: round_step(size / 10.0).min(0.01),
            ..GraspParameters::constants()
        }
    }

    fn encode(artefact: &Vec<Grasp>) -> Vec<u8> {
        codec::encode(&artefact.iter().map(Stored::of).collect::<Vec<_>>())
    }

    fn decode(bytes: &[u8]) -> Result<Vec<Grasp>, DecodeError> {
        codec::decode::<Vec<Stored>>(bytes)?.into_iter().map(Stored::grasp).collect()
    }

    fn summary(artefact: &Vec<Grasp>) -> String {
        match artefact.first() {
            Some(best) => {
                let (count, sides) = (artefact.len(), coverage::coverage(artefact));
                let of = coverage::DIRECTIONS;
                format!(
                    "{count} grasps from {sides} of {of} sides, the best with epsilon {:.3}",
                    best.epsilon
                )
            }
            None => "no grasp".to_owned(),
        }
    }
}

#[cfg(feature = "build")]
mod build {
    use robotc_core::geom::{self, MeshIndex};
    use robotc_core::robot::{Gripper, Hold};
    use robotc_planning::grasp::{ContactModel, closes, tangents, wrenches};

    use super::contacts::PatchOptions;
    use super::generate::{Candidate, GenerateOptions, Generator};
    use super::steadiness::SteadinessOptions;
    use super::tips::TipOptions;
    use nalgebra::{Point3, Vector3};

    use super::*;
    use crate::kind::{Build, BuildError, Context};
    use crate::kinds::grip::surface::ApproachOptions;

    /// Grasps that are judged before it is asked whether there are enough.
    const JUDGED_AT_ONCE: usize = 256;

    /// A piece that another process left is sealed: only a fault of this program makes it unreadable.
    fn damaged(error: DecodeError) -> BuildError {
        BuildError::Check(error.to_string())
    }

    fn options(p: &GraspParameters, gripper: &Gripper) -> GenerateOptions {
        let steps = p.standoffs.max(2) - 1;
        let standoff =
            |k| p.least_standoff + (p.most_standoff - p.least_standoff) * f64::from(k) / f64::from(steps);
        let (u, v) = tangents(&gripper.approach_in_tool);
        let beside = |k: u32| {
            let angle = std::f64::consts::TAU * f64::from(k) / f64::from(p.rays.max(2) - 1);
            (u * libm::cos(angle) + v * libm::sin(angle)) * p.ray_radius
        };
        // A finger stops at the parts that cover the object; a tip has to get to its surface.
        let gap = match gripper.hold {
            Hold::Close => p.cover_gap,
            Hold::Attract => p.cover_gap.min(p.patch_depth),
        };
        let rays = std::iter::once(Vector3::zeros()).chain((0..p.rays - 1).map(beside)).collect();
        GenerateOptions {
            approaches: ApproachOptions {
                spacing: p.spacing,
                rolls: p.rolls as usize,
                directions: p.directions as usize,
                cone: p.cone,
                standoffs: match gripper.hold {
                    Hold::Close => (0..p.standoffs).map(standoff).collect(),
                    Hold::Attract => vec![0.0],
                },
                rays,
                preshapes: gripper.preshapes.len(),
                most: p.approaches as usize,
            },
            patch: PatchOptions { depth: p.patch_depth, gap, points: p.patch_points as usize },
            surface_spacing: (2.0 * p.patch_depth).min(p.spacing),
            friction: p.friction,
            cone_edges: p.cone_edges as usize,
            least_epsilon: p.least_epsilon,
            volumes: p.volumes,
            steadiness: SteadinessOptions {
                disturbance: p.disturbance,
                repeats: p.repeats as usize,
                slip: p.slip,
            },
            tips: TipOptions { footprint: p.footprint, agreement: p.agreement },
        }
    }

    impl Build for GraspSet {
        fn build(
            inputs: &Inputs,
            parameters: &GraspParameters,
            context: &Context<'_>,
        ) -> Result<Vec<Grasp>, BuildError> {
            let shapes = inputs.gripper.load(context)?;
            let hand = inputs.gripper.hand(&shapes);
            let object_parts = context.load(&inputs.object_parts)?;
            let options = options(parameters, hand.gripper());
            let mesh = inputs.object.surface();
            let centre = centre_of_volume(&object_parts);
            let generator = Generator::new(&hand, &mesh, &object_parts, centre, &options, context.seed())
                .ok_or_else(|| BuildError::Impossible("the object has no surface".into()))?;
            let trials =
                context.map_in_pieces("trials", &generator.approaches, |_, a| generator.attempt(a))?;
            let (candidates, counts) = generator.candidates(trials).map_err(damaged)?;
            let mut grasps = Vec::new();
            for (i, some) in candidates.chunks(JUDGED_AT_ONCE).enumerate() {
                if grasps.len() < parameters.most_grasps as usize {
                    let judge = |_, c: &Candidate| generator.judge(c).as_ref().map(Stored::of);
                    let judged = context.map_in_pieces(&format!("judged-{i}"), some, judge)?;
                    let judged = judged.into_iter().flatten().map(Stored::grasp);
                    grasps.extend(judged.collect::<Result<Vec<_>, _>>().map_err(damaged)?);
                }
            }
            if grasps.is_empty() {
                context.warn(&format!("no grasp: {counts}"));
            }
            grasps.truncate(parameters.most_grasps as usize);
            grasps.sort_by(|a, b| b.score.total_cmp(&a.score));
            Ok(grasps)
        }

        fn check(
            artefact: &Vec<Grasp>,
            inputs: &Inputs,
            parameters: &GraspParameters,
            context: &Context<'_>,
        ) -> Result<(), BuildError> {
            let wrong = |i: usize, what: &str| Err(BuildError::Check(format!("grasp {i} {what}")));
            let mesh = inputs.object.surface();
            let index = MeshIndex::new(&mesh);
            let object_parts = context.load(&inputs.object_parts)?;
            let shapes = inputs.gripper.load(context)?;
            let hand = inputs.gripper.hand(&shapes);
            let centre = centre_of_volume(&object_parts);
            let model = ContactModel {
                friction: parameters.friction,
                cone_edges: parameters.cone_edges as usize,
                centre,
                length: 1.0,
                hold: hand.gripper().hold,
            };
            for (i, grasp) in artefact.iter().enumerate() {
                let gripper = hand.gripper();
                if grasp.preshape >= gripper.preshapes.len() || grasp.closed.len() != gripper.dofs.len() {
                    return wrong(i, "does not belong to this gripper");
                }
                if grasp.contacts.iter().any(|c| index.nearest(&c.point_in_object, 1e-6).is_none()) {
                    return wrong(i, "has a contact off the surface");
                }
                // Force closure does not depend on the unit of torque.
                if !closes(&wrenches(&grasp.contacts, &model)) {
                    return wrong(i, "does not close");
                }
                let object_from_palm = grasp.object_from_tool * gripper.palm_from_tool.inverse();
                for (link, palm_from_link) in hand.links.iter().zip(hand.palm_from_links(&grasp.closed)) {
                    let pose = object_from_palm * palm_from_link;
                    let inside = |p: &Point3<f64>| object_parts.height(&(pose * p)) < -parameters.patch_depth;
                    if link.parts.points().any(inside) {
                        return wrong(i, "has the hand inside of the object");
                    }
                }
            }
            Ok(())
        }
    }

    /// Centre of the volume of the parts: the centre of mass where the density is the same everywhere.
    pub(crate) fn centre_of_volume(parts: &geom::ConvexParts) -> Point3<f64> {
        let (mut volume, mut moment) = (0.0, Vector3::zeros());
        for part in parts {
            let points = part.points();
            for triangle in part.triangles() {
                let [a, b, c] = triangle.map(|v| points[v as usize].coords);
                let six = a.dot(&b.cross(&c));
                volume += six;
                moment += (a + b + c) * (six / 4.0);
            }
        }
        if volume > 0.0 {
            return Point3::from(moment / volume);
        }
        parts.bounds().map_or_else(Point3::origin, |bounds| bounds.centre())
    }
}
