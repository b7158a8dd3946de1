//! Where a closed hand touches: patches, not points, because two hard points never close.

use nalgebra::Unit;
use robotc_core::Pose;
use robotc_core::geom::ConvexParts;
use robotc_planning::grasp::Contact;

use crate::kinds::grip::surface::{Surface, SurfacePoint};

/// What counts as touching.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct PatchOptions {
    /// Surface points no more than this farther from a finger than the nearest are touched, metres: how far pad and object
    /// give way.
    pub(super) depth: f64,
    /// Farthest that the nearest surface point may be, metres: a finger stops at the convex parts of the object, which
    /// stand off its surface.
    pub(super) gap: f64,
    /// Most points that stand for one finger's patch.
    pub(super) points: usize,
}

/// Contacts of one finger link: surface points of the object within reach of its parts, thinned to those far apart.
pub(super) fn patch(
    parts: &ConvexParts,
    object_from_link: &Pose,
    surface: &Surface,
    options: &PatchOptions,
) -> Vec<Contact> {
    let Some(bounds) = parts.bounds() else { return Vec::new() };
    let reach = bounds.padded(options.gap + options.depth);
    let link_from_object = object_from_link.inverse();
    let centre_in_object = object_from_link * bounds.centre();
    let near: Vec<(f64, &SurfacePoint)> = surface
        .of_cubes(|cube, radius| reach.distance_to(&(link_from_object * cube)) <= radius)
        .filter_map(|s| {
            let point_in_link = link_from_object * s.point;
            reach.contains(&point_in_link).then(|| (parts.height(&point_in_link), s))
        })
        .collect();
    let nearest = near.iter().map(|(height, _)| *height).fold(f64::INFINITY, f64::min);
    if nearest > options.gap {
        return Vec::new();
    }
    let mut touched = Vec::new();
    for (_, s) in near.iter().filter(|(height, _)| *height <= nearest.max(0.0) + options.depth) {
        // The finger presses from its side of the surface, whichever way the face is wound.
        let inward = -s.normal.into_inner();
        let away = s.point - centre_in_object;
        let inward = if inward.dot(&away) >= 0.0 { inward } else { -inward };
        touched.push(Contact { point_in_object: s.point, normal_in_object: Unit::new_unchecked(inward) });
    }
    spread(touched, options.points)
}

/// At most `count` of the contacts, each the farthest from those taken before; the first is farthest from the mean.
fn spread(contacts: Vec<Contact>, count: usize) -> Vec<Contact> {
    if contacts.len() <= count {
        return contacts;
    }
    let sum: nalgebra::Vector3<f64> = contacts.iter().map(|c| c.point_in_object.coords).sum();
    let mean = nalgebra::Point3::from(sum / contacts.len() as f64);
    let mut distance: Vec<f64> = contacts.iter().map(|c| (c.point_in_object - mean).norm()).collect();
    let mut chosen = Vec::with_capacity(count);
    for _ in 0..count {
        let mut farthest = 0;
        for i in 1..contacts.len() {
            if distance[i] > distance[farthest] {
                farthest = i;
            }
        }
        chosen.push(contacts[farthest]);
        if chosen.len() == 1 {
            distance.fill(f64::INFINITY);
        }
        for (d, c) in distance.iter_mut().zip(&contacts) {
            *d = d.min((c.point_in_object - contacts[farthest].point_in_object).norm());
        }
    }
    chosen
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector3;
    use robotc_core::geom::box_part;

    #[test]
    fn a_pad_on_a_face_gives_the_corners_of_their_overlap() {
        let object = box_part(Vector3::new(0.06, 0.06, 0.06)).mesh();
        let pad = ConvexParts::new(vec![box_part(Vector3::new(0.01, 0.02, 0.02))]);
        let object_from_pad = Pose::translation(0.035 + 2e-4, 0.0, 0.0);
        let options = PatchOptions { depth: 1e-3, gap: 1e-3, points: 4 };
        let contacts = patch(&pad, &object_from_pad, &Surface::new(&object, 0.002), &options);
        assert_eq!(contacts.len(), 4);
        for c in &contacts {
            let p = c.point_in_object;
            assert!((p.x - 0.03).abs() < 1e-9 && c.normal_in_object.x < -0.99);
            assert!(p.y.abs() > 0.006 && p.z.abs() > 0.006, "{p}");
        }
    }

    #[test]
    fn a_pad_that_is_away_touches_nothing() {
        let object = box_part(Vector3::new(0.06, 0.06, 0.06)).mesh();
        let pad = ConvexParts::new(vec![box_part(Vector3::new(0.01, 0.02, 0.02))]);
        let options = PatchOptions { depth: 1e-3, gap: 1e-3, points: 4 };
        assert!(
            patch(&pad, &Pose::translation(0.04, 0.0, 0.0), &Surface::new(&object, 0.002), &options)
                .is_empty()
        );
    }
}
