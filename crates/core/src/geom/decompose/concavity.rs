//! How far a hull stands off the solid it is meant to cover.

use std::cell::OnceCell;
use std::cmp::Ordering;
use std::collections::BinaryHeap;

use nalgebra::Point3;

use super::super::hull::Hull;
use super::super::{Aabb, MeshIndex};
use super::Piece;
use super::outside::Outside;

/// The whole mesh, as a surface with an inside: all that a ball as wide as the tolerance does not reach from outside.
pub(super) struct Solid {
    surface: MeshIndex,
    bounds: Aabb,
    tolerance: f64,
    outside: OnceCell<Outside>,
}

/// The distance of a hull from the solid is found to within this fraction of itself.
const PRECISION: f64 = 0.1;

impl Solid {
    /// The solid of a mesh; a hull may stand off it by `concavity` times its diagonal.
    pub(super) fn new(whole: &Piece, concavity: f64) -> Self {
        let corners = |f: &[u32; 3]| f.map(|v| whole.vertices[v as usize]);
        let mut triangles: Vec<[Point3<f64>; 3]> = whole.faces.iter().map(corners).collect();
        let mut has_face = vec![false; whole.vertices.len()];
        whole.faces.iter().flatten().for_each(|&v| has_face[v as usize] = true);
        let lone = whole.vertices.iter().zip(&has_face).filter(|(_, has)| !**has);
        triangles.extend(lone.map(|(p, _)| [*p; 3]));
        let faces = (0..triangles.len() as u32).collect();
        let bounds = Aabb::of_points(&whole.vertices).expect("a piece has vertices");
        let surface = MeshIndex::of_triangles(triangles, faces);
        Self { surface, bounds, tolerance: concavity * bounds.diagonal(), outside: OnceCell::new() }
    }

    /// How far a hull may stand off, metres.
    pub(super) fn tolerance(&self) -> f64 {
        self.tolerance
    }

    /// The largest distance of a point of the hull's surface from the solid, to a tenth of itself, when it is
    /// above the tolerance; else anything up to it. Not searched further once above `enough`.
    ///
    /// Branch and bound, most promising triangle first, since the distance changes by no more than the point moves.
    pub(super) fn farthest(&self, hull: &Hull, enough: f64) -> f64 {
        let mut farthest: f64 = 0.0;
        let mut open = BinaryHeap::new();
        let bound = |farthest: f64| self.tolerance.max(farthest) * (1.0 + PRECISION);
        for t in &hull.triangles {
            let corners = t.map(|i| hull.points[i as usize]);
            let Some(patch) = self.patch(corners, bound(farthest), None) else { continue };
            farthest = farthest.max(patch.proven);
            open.push(patch);
        }
        while let Some(patch) = open.pop() {
            if patch.possible <= bound(farthest) || farthest > enough {
                break;
            }
            for half in halves(patch.corners) {
                let Some(half) = self.patch(half, bound(farthest), Some(&patch)) else { continue };
                farthest = farthest.max(half.proven);
                open.push(half);
            }
        }
        farthest
    }

    /// What is known of a triangle; `None` when no point of it is farther off than `bound`.
    fn patch(&self, corners: [Point3<f64>; 3], bound: f64, parent: Option<&Patch>) -> Option<Patch> {
        let [a, b, c] = corners;
        let middle = Point3::from((a.coords + b.coords + c.coords) / 3.0);
        let radius = corners.iter().map(|p| (p - middle).norm()).fold(0.0, f64::max);
        let moved = parent.map_or(f64::INFINITY, |p| (p.middle - middle).norm());
        let reach = parent.map_or(f64::INFINITY, |p| (p.distance + moved) * (1.0 + 1e-9));
        let near_enough = bound - radius;
        let distance = self.surface.near_enough(&middle, reach, near_enough).map_or(0.0, |n| n.distance);
        if distance <= near_enough {
            return None;
        }
        let mut patch =
            Patch { corners, middle, distance, inside: None, proven: 0.0, possible: distance + radius };
        if distance <= self.tolerance {
            return Some(patch);
        }
        // No surface lies between the middles when they are nearer to each other than to it.
        let known = parent.filter(|p| moved < p.distance.max(distance)).and_then(|p| p.inside);
        let inside = known.unwrap_or_else(|| self.is_inside(&middle));
        patch.inside = Some(inside);
        if inside {
            patch.possible = radius - distance;
        } else {
            patch.proven = distance;
        }
        Some(patch)
    }

    /// Whether a point, farther from the surface than the tolerance, is out of reach from outside.
    fn is_inside(&self, point: &Point3<f64>) -> bool {
        !self.outside.get_or_init(|| Outside::new(&self.surface, &self.bounds, self.tolerance)).reaches(point)
    }
}

/// A triangle of a hull's surface, and what is known of its distance from the solid.
struct Patch {
    corners: [Point3<f64>; 3],
    middle: Point3<f64>,
    /// From the middle to the surface of the solid.
    distance: f64,
    /// Whether the middle is inside the solid, where that was asked.
    inside: Option<bool>,
    /// Some point is this far off.
    proven: f64,
    /// No point is farther off.
    possible: f64,
}

impl Ord for Patch {
    fn cmp(&self, other: &Self) -> Ordering {
        let place = |p: &Self| [p.middle.x, p.middle.y, p.middle.z];
        let by_place = || {
            let pairs = place(self).into_iter().zip(place(other));
            pairs.map(|(a, b)| a.total_cmp(&b)).find(|o| o.is_ne()).unwrap_or(Ordering::Equal)
        };
        self.possible.total_cmp(&other.possible).then_with(by_place)
    }
}

impl PartialOrd for Patch {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Patch {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Patch {}

/// The triangle cut through its longest edge.
fn halves([a, b, c]: [Point3<f64>; 3]) -> [[Point3<f64>; 3]; 2] {
    let length = |e: &[Point3<f64>; 3]| (e[1] - e[0]).norm_squared();
    let edges = [[a, b, c], [b, c, a], [c, a, b]];
    let longest = edges.into_iter().reduce(|x, y| if length(&y) > length(&x) { y } else { x });
    let [p, q, r] = longest.expect("a triangle has edges");
    let half = nalgebra::center(&p, &q);
    [[p, half, r], [half, q, r]]
}
