//! How hard a held object can be pulled: what a grasp is for.
//!
//! Epsilon asks about every wrench alike, and counts torques that nothing will ever exert. Gravity and acceleration pull at the
//! centre of mass; a grasp far from it has to bear their lever as well, which is what lets go in practice.

use nalgebra::Vector6;

use super::closure::closes;

/// Halvings of the range of strengths.
const HALVINGS: usize = 7;

/// Whether contacts whose normal forces sum to one bear more than a force of `force` at the centre of mass, whichever of the six
/// ways along the axes it pulls. `wrenches` as [`closes`] takes them, torques about the centre of mass.
pub fn bears(wrenches: &[Vector6<f64>], force: f64) -> bool {
    (0..6).all(|way| {
        let mut pull = Vector6::zeros();
        pull[way / 2] = if way % 2 == 0 { force } else { -force };
        // The pull is borne when it lies inside the hull: when the hull around it closes.
        let around: Vec<Vector6<f64>> = wrenches.iter().map(|w| w - pull).collect();
        closes(&around)
    })
}

/// The largest force that contacts whose normal forces sum to one bear at the centre of mass, along the weakest of six ways, to 1/128
/// and from below: at most 1.
pub fn strength(wrenches: &[Vector6<f64>]) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if bears(wrenches, middle) {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}

#[cfg(test)]
mod tests {
    use robotc_core::robot::Hold;

    use super::super::{Contact, ContactModel, wrenches};
    use super::*;
    use nalgebra::{Point3, Unit, Vector3};

    /// Two pads of four points each, 40 mm apart along x, `away` from the centre of mass along z.
    fn pads(away: f64, friction: f64) -> Vec<Vector6<f64>> {
        let mut contacts = Vec::new();
        for side in [-1.0, 1.0] {
            for (y, z) in [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)] {
                contacts.push(Contact {
                    point_in_object: Point3::new(side * 0.02, y * 0.01, away + z * 0.01),
                    normal_in_object: Unit::new_unchecked(Vector3::x() * -side),
                });
            }
        }
        let model = ContactModel {
            friction,
            cone_edges: 8,
            centre: Point3::origin(),
            length: 0.05,
            hold: Hold::Close,
        };
        wrenches(&contacts, &model)
    }

    #[test]
    fn a_pinch_at_the_centre_bears_its_friction() {
        // Along x the pads push; across, friction bears at most its share of the normal forces.
        let strong = strength(&pads(0.0, 0.5));
        assert!(strong > 0.4 && strong <= 0.5, "{strong}");
    }

    #[test]
    fn a_lever_takes_strength_away_and_friction_gives_it() {
        let strengths = [0.0, 0.02, 0.04, 0.08].map(|away| strength(&pads(away, 0.5)));
        assert!(strengths.windows(2).all(|w| w[1] <= w[0]), "{strengths:?}");
        assert!(strengths[3] < 0.5 * strengths[0] && strengths[3] > 0.0, "{strengths:?}");
        assert!(strength(&pads(0.04, 0.2)) < strengths[2]);
    }

    #[test]
    fn what_does_not_close_bears_nothing() {
        let one_side: Vec<_> = pads(0.0, 0.5).into_iter().take(8 * 4).collect();
        assert_eq!(strength(&one_side), 0.0);
        assert!(!bears(&one_side, 0.0));
    }
}
