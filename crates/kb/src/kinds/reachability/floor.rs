//! What stands on the floor, and whether a base fits between it.

use nalgebra::{Point2, Point3, Vector2};
use robotc_core::Pose;
use robotc_core::geom::{ConvexParts, ConvexPolygon};
use robotc_planning::placement::Prism;

use super::placement::Placement;

/// Outlines of obstacles on the floor, as far as they are as high as a base.
///
/// Each convex part counts with all of its outline, also where only some of it is as low as the base: a footprint that is
/// called clear is clear.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Floor {
    outlines: Vec<Outline>,
}

/// An outline with a circle around it.
#[derive(Debug, Clone, PartialEq)]
struct Outline {
    polygon: ConvexPolygon,
    centre: Point2<f64>,
    radius: f64,
}

impl Floor {
    /// The obstacles that are in the heights of `base` somewhere; the base's plane is z = 0 of the world.
    pub fn new<'a>(obstacles: impl IntoIterator<Item = (&'a ConvexParts, Pose)>, base: &Prism) -> Self {
        let mut outlines = Vec::new();
        for (parts, world_from_parts) in obstacles {
            for part in parts.iter() {
                let points: Vec<_> = part.points().iter().map(|p| world_from_parts * p).collect();
                let lowest = points.iter().map(|p| p.z).fold(f64::INFINITY, f64::min);
                let highest = points.iter().map(|p| p.z).fold(f64::NEG_INFINITY, f64::max);
                if lowest < base.heights.1 && highest > base.heights.0 {
                    outlines.push(Outline::around(points.iter().map(|p| p.xy())));
                }
            }
        }
        Self { outlines }
    }

    /// Whether a footprint touches no obstacle when its base stands there.
    pub fn is_clear(&self, base: &Prism, placement: &Placement) -> bool {
        let [x, y] = placement.position;
        // Two circles about the base, one that holds the footprint and one that it holds, settle most places.
        let middle = Point3::new(0.0, 0.0, 0.5 * (base.heights.0 + base.heights.1));
        let within = (-base.excess(&middle)).max(0.0);
        let around = base.footprint.iter().map(|[a, b]| a * a + b * b).fold(0.0, f64::max).sqrt();
        let mut unsettled = Vec::new();
        for outline in &self.outlines {
            let (dx, dy) = (outline.centre.x - x, outline.centre.y - y);
            let touching = around + outline.radius + ROUNDING;
            if dx * dx + dy * dy > touching * touching {
                continue;
            }
            let distance = distance(outline.polygon.corners(), &Point2::new(x, y));
            if distance < within - ROUNDING {
                return false;
            }
            if distance <= around + ROUNDING {
                unsettled.push(outline);
            }
        }
        if unsettled.is_empty() {
            return true;
        }
        let (sine, cosine) = (libm::sin(placement.yaw), libm::cos(placement.yaw));
        let placed = |[a, b]: &[f64; 2]| Point2::new(x + cosine * a - sine * b, y + sine * a + cosine * b);
        let footprint = ConvexPolygon::hull_of(base.footprint.iter().map(placed));
        unsettled.iter().all(|outline| footprint.is_apart_from(&outline.polygon))
    }
}

/// Distances this near to a circle's radius settle nothing, metres.
const ROUNDING: f64 = 1e-9;

/// Distance of a point from a convex polygon, its corners counter-clockwise; zero inside.
fn distance(corners: &[Point2<f64>], point: &Point2<f64>) -> f64 {
    let mut inside = corners.len() > 2;
    let mut nearest = f64::INFINITY;
    for (i, a) in corners.iter().enumerate() {
        let (along, to) = (corners[(i + 1) % corners.len()] - a, point - a);
        inside &= along.perp(&to) >= 0.0;
        let share = (to.dot(&along) / along.norm_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
        nearest = nearest.min((to - along * share).norm_squared());
    }
    if inside { 0.0 } else { nearest.sqrt() }
}

impl Outline {
    /// The convex hull of points.
    fn around(points: impl Iterator<Item = Point2<f64>>) -> Self {
        let polygon = ConvexPolygon::hull_of(points);
        let corners = polygon.corners();
        let sum: Vector2<f64> = corners.iter().map(|corner| corner.coords).sum();
        let centre = Point2::from(sum / corners.len() as f64);
        let radius = corners.iter().map(|corner| (corner - centre).norm()).fold(0.0, f64::max);
        Self { polygon, centre, radius }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;
    use robotc_core::Seed;
    use robotc_core::geom::box_part;

    use super::*;

    #[test]
    fn footprints_are_clear_where_no_point_of_them_is_in_an_obstacle() {
        let base = Prism {
            footprint: vec![[0.3, -0.2], [0.3, 0.2], [-0.3, 0.2], [-0.3, -0.2]],
            heights: (0.0, 0.5),
        };
        let table = ConvexParts::new(vec![box_part(Vector3::new(1.2, 0.7, 0.4))]);
        let shelf = ConvexParts::new(vec![box_part(Vector3::new(3.0, 3.0, 0.1))]);
        let turned = Pose::new(Vector3::new(0.2, 0.1, 0.3), Vector3::z() * 0.4);
        let floor = Floor::new([(&table, turned), (&shelf, Pose::translation(0.0, 0.0, 0.6))], &base);
        let mut rng = Seed::new(1).rng();
        let mut clear = 0;
        for _ in 0..2000 {
            let position = [rng.range(-1.5, 1.5), rng.range(-1.5, 1.5)];
            let placement = Placement { position, yaw: rng.range(-3.0, 3.0), target: 0, mount: 0 };
            let world_from_base = placement.world_from_mobile();
            // A lattice of points of the footprint, seen from the table.
            let touching = (0..=60).any(|i| {
                (0..=40).any(|j| {
                    let point = Vector3::new(0.01 * f64::from(i) - 0.3, 0.01 * f64::from(j) - 0.2, 0.3);
                    table.contains(&(turned.inverse() * world_from_base * nalgebra::Point3::from(point)))
                })
            });
            let found = floor.is_clear(&base, &placement);
            clear += usize::from(found);
            assert!(!(found && touching), "{placement:?}");
            if !found && !touching {
                // Only a corner may be cut that the lattice misses.
                let grown = Prism {
                    footprint: base.footprint.iter().map(|c| c.map(|x| 0.93 * x)).collect(),
                    ..base.clone()
                };
                assert!(floor.is_clear(&grown, &placement), "{placement:?}");
            }
        }
        assert!(clear > 200 && clear < 1800, "{clear}");
    }
}
