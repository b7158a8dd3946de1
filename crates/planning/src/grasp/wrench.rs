//! The wrenches that contacts can exert on an object.
//!
//! A contact presses with a unit normal force inside its friction cone. The cone is replaced by a pyramid inside it; each edge
//! gives a wrench: a force, and its torque about the centre of mass divided by a length of the object, so that both
//! have one unit (Ferrari and Canny, "Planning optimal grasps", 1992; thesis section 4.2).

use nalgebra::{Point3, Unit, Vector3, Vector6};

use robotc_core::robot::Hold;

use super::Contact;

/// What a contact can do.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactModel {
    /// Coulomb friction coefficient.
    pub friction: f64,
    /// Edges of the pyramid that stands for the friction cone; at least 3.
    pub cone_edges: usize,
    /// Torques are taken about this point of the object frame: its centre of mass.
    pub centre: Point3<f64>,
    /// Torques are divided by this length, metres: the largest distance of the object's surface from `centre`.
    pub length: f64,
    /// Where the hand attracts, a contact pulls as hard as it presses.
    pub hold: Hold,
}

/// The wrenches of all pyramid edges, contact by contact: unit normal force plus friction (x, y, z), then its scaled torque;
/// in the object frame. Where the hand attracts, that of the unit pull follows those of each contact's edges.
pub fn wrenches(contacts: &[Contact], model: &ContactModel) -> Vec<Vector6<f64>> {
    let step = std::f64::consts::TAU / model.cone_edges as f64;
    let edges: Vec<(f64, f64)> = (0..model.cone_edges)
        .map(|edge| step * edge as f64)
        .map(|angle| (model.friction * libm::cos(angle), model.friction * libm::sin(angle)))
        .collect();
    let mut out = Vec::with_capacity(contacts.len() * model.cone_edges);
    for contact in contacts {
        let (u, v) = tangents(&contact.normal_in_object);
        let arm = (contact.point_in_object - model.centre) / model.length;
        for (along_u, along_v) in &edges {
            let force = contact.normal_in_object.into_inner() + u * *along_u + v * *along_v;
            let torque = arm.cross(&force);
            out.push(Vector6::new(force.x, force.y, force.z, torque.x, torque.y, torque.z));
        }
        if model.hold == Hold::Attract {
            let force = -contact.normal_in_object.into_inner();
            let torque = arm.cross(&force);
            out.push(Vector6::new(force.x, force.y, force.z, torque.x, torque.y, torque.z));
        }
    }
    out
}

/// Two unit vectors that make a right-handed frame with `normal`.
pub fn tangents(normal: &Unit<Vector3<f64>>) -> (Vector3<f64>, Vector3<f64>) {
    let smallest = normal.iamin();
    let mut other = Vector3::zeros();
    other[smallest] = 1.0;
    let u = normal.cross(&other).normalize();
    (u, normal.cross(&u))
}

/// The wrench farthest along a direction, the first of several: its position and height.
pub(super) fn support(wrenches: &[Vector6<f64>], direction: &Vector6<f64>) -> (usize, f64) {
    let mut best = (0, f64::NEG_INFINITY);
    for (i, w) in wrenches.iter().enumerate() {
        let height = w.dot(direction);
        if height > best.1 {
            best = (i, height);
        }
    }
    best
}
