//! From URDF as `urdf_rs` reads it to the robot model.

use super::draft::{Draft, JointKind};
use super::meshes::MeshSource;
use crate::diag::{Diagnostic, Diagnostics};
use crate::model::{
    DynamicLimits, Geometry, Inertial, JointMotion, ModelError, Origin, RobotBuilder, RobotModel,
};

/// The model of `robot`, which is `draft` read back. Meshes come from `meshes`.
pub(super) fn lower(
    draft: &Draft,
    robot: &urdf_rs::Robot,
    meshes: &mut MeshSource<'_>,
    found: &mut Diagnostics,
) -> Option<RobotModel> {
    if let Err(difference) = agree(draft, robot) {
        found.push(internal(&difference));
        return None;
    }
    let mut builder = RobotBuilder::new(robot.name.clone());
    for (written, link) in draft.links.iter().zip(&robot.links) {
        let mut geometries = Vec::with_capacity(link.visual.len() + link.collision.len());
        for (visual, written) in link.visual.iter().zip(&written.visuals) {
            let colour = written.colour.map(|c| c.map(|x| x as f32));
            if let Some(shape) = meshes.visual(&visual.geometry, written, &link.name, found) {
                geometries.push(Geometry { origin: origin(&visual.origin), shape, colour });
            }
        }
        let mut collisions = Vec::with_capacity(link.collision.len());
        for (collision, written) in link.collision.iter().zip(&written.collisions) {
            if let Some(shape) = meshes.collision(&collision.geometry, written, &link.name, found) {
                collisions.push(Geometry { origin: origin(&collision.origin), shape, colour: None });
            }
        }
        let inertial = written.inertial.is_some().then(|| inertial(&link.inertial));
        builder.link(&link.name, geometries, collisions, inertial);
    }
    for (written, joint) in draft.joints.iter().zip(&robot.joints) {
        let (parent, child) = (&joint.parent.link, &joint.child.link);
        let motion = match written.kind {
            JointKind::Revolute | JointKind::Continuous => JointMotion::Revolute,
            JointKind::Prismatic => JointMotion::Prismatic,
            JointKind::Fixed | JointKind::Floating | JointKind::Planar => {
                builder.fixed(&joint.name, parent, child, origin(&joint.origin));
                continue;
            }
        };
        let mimic = joint
            .mimic
            .as_ref()
            .map(|m| (m.joint.clone(), m.multiplier.unwrap_or(1.0), m.offset.unwrap_or(0.0)));
        let continuous = written.kind == JointKind::Continuous;
        let (lower, upper) = match continuous {
            true => (f64::NEG_INFINITY, f64::INFINITY),
            false => (joint.limit.lower, joint.limit.upper),
        };
        let limits = (lower, upper, continuous, dynamics(joint.limit.velocity));
        builder.moving(
            &joint.name,
            motion,
            parent,
            child,
            origin(&joint.origin),
            *joint.axis.xyz,
            limits,
            mimic,
        );
    }
    builder.build().map_err(|error| found.push(refused(draft, &error))).ok()
}

/// Velocity as given; acceleration and jerk are not part of URDF.
fn dynamics(velocity: f64) -> DynamicLimits {
    if velocity > 0.0 {
        DynamicLimits { velocity, given: [true, false, false], ..DynamicLimits::DEFAULT }
    } else {
        DynamicLimits::DEFAULT
    }
}

fn origin(pose: &urdf_rs::Pose) -> Origin {
    Origin { xyz: *pose.xyz, rpy: *pose.rpy }
}

fn inertial(inertial: &urdf_rs::Inertial) -> Inertial {
    let i = &inertial.inertia;
    Inertial {
        origin: origin(&inertial.origin),
        mass: inertial.mass.value,
        inertia: [i.ixx, i.ixy, i.ixz, i.iyy, i.iyz, i.izz],
    }
}

/// Whether what was read back has the parts that were written.
fn agree(draft: &Draft, robot: &urdf_rs::Robot) -> Result<(), String> {
    if (draft.links.len(), draft.joints.len()) != (robot.links.len(), robot.joints.len()) {
        return Err("a different number of links or joints".to_owned());
    }
    for (a, b) in draft.links.iter().zip(&robot.links) {
        let counts = (b.visual.len(), b.collision.len());
        if a.name.text != b.name || (a.visuals.len(), a.collisions.len()) != counts {
            return Err(format!("link `{}` differs", a.name.text));
        }
    }
    for (a, b) in draft.joints.iter().zip(&robot.joints) {
        if a.name.text != b.name || a.parent.text != b.parent.link || a.child.text != b.child.link {
            return Err(format!("joint `{}` differs", a.name.text));
        }
    }
    Ok(())
}

/// A finding about this program, not about the file.
pub(super) fn internal(what: &str) -> Diagnostic {
    Diagnostic::error("R0290", format!("internal: the checked description does not read back: {what}"))
        .hint("this is a fault of robotc; please report it with the file")
}

/// What the builder refused although the draft was checked.
fn refused(draft: &Draft, error: &ModelError) -> Diagnostic {
    Diagnostic::error("R0291", error.to_string()).at(draft.span, "in this robot")
}
