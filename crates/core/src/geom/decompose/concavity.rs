//! How far a hull stands off the solid it is meant to cover.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use nalgebra::{Point3, Vector3};

use super::super::hull::Hull;
use super::super::{Aabb, MeshIndex};
use super::Piece;

/// The whole mesh, as a surface with an inside where it is closed.
pub(super) struct Solid {
    surface: MeshIndex,
    size: f64,
}

/// Rays of the inside test: three skew lines, both ways.
const RAYS: [[f64; 3]; 3] = [[0.83, 0.31, 0.47], [-0.29, 0.89, 0.35], [0.21, -0.37, 0.91]];

/// The distance of a hull from the solid is found to within this fraction of itself.
const PRECISION: f64 = 0.05;

impl Solid {
    pub(super) fn new(whole: &Piece) -> Self {
        let corners = |f: &[u32; 3]| f.map(|v| whole.vertices[v as usize]);
        let mut triangles: Vec<[Point3<f64>; 3]> = whole.faces.iter().map(corners).collect();
        let mut has_face = vec![false; whole.vertices.len()];
        whole.faces.iter().flatten().for_each(|&v| has_face[v as usize] = true);
        let lone = whole.vertices.iter().zip(&has_face).filter(|(_, has)| !**has);
        triangles.extend(lone.map(|(p, _)| [*p; 3]));
        let faces = (0..triangles.len() as u32).collect();
        let bounds = Aabb::of_points(&whole.vertices).expect("a piece has vertices");
        Self { surface: MeshIndex::of_triangles(triangles, faces), size: bounds.diagonal() }
    }

    /// Diagonal of the bounding box, metres.
    pub(super) fn size(&self) -> f64 {
        self.size
    }

    /// The largest distance of a point of the hull's surface from the solid, to a twentieth of itself, when it is
    /// above `tolerance`; else anything up to `tolerance`. Not searched further once above `enough`.
    ///
    /// Branch and bound, most promising triangle first, since the distance changes by no more than the point moves.
    pub(super) fn farthest(&self, hull: &Hull, tolerance: f64, enough: f64) -> f64 {
        let mut farthest: f64 = 0.0;
        let mut open = BinaryHeap::new();
        for t in &hull.triangles {
            let patch = self.patch(t.map(|i| hull.points[i as usize]), tolerance, None);
            farthest = farthest.max(patch.proven);
            open.push(patch);
        }
        while let Some(patch) = open.pop() {
            if patch.possible <= tolerance.max(farthest) * (1.0 + PRECISION) || farthest > enough {
                break;
            }
            for half in halves(patch.corners) {
                let half = self.patch(half, tolerance, Some(&patch));
                farthest = farthest.max(half.proven);
                open.push(half);
            }
        }
        farthest
    }

    fn patch(&self, corners: [Point3<f64>; 3], tolerance: f64, parent: Option<&Patch>) -> Patch {
        let [a, b, c] = corners;
        let middle = Point3::from((a.coords + b.coords + c.coords) / 3.0);
        let radius = corners.iter().map(|p| (p - middle).norm()).fold(0.0, f64::max);
        let moved = parent.map_or(f64::INFINITY, |p| (p.middle - middle).norm());
        let reach = parent.map_or(f64::INFINITY, |p| (p.distance + moved) * (1.0 + 1e-9));
        let distance = self.surface.nearest(&middle, reach).map_or(0.0, |n| n.distance);
        let mut patch =
            Patch { corners, middle, distance, inside: None, proven: 0.0, possible: distance + radius };
        if distance <= tolerance {
            return patch;
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
        patch
    }

    /// Whether rays from the point say that it is inside, all but one of them: an odd number of crossings, or more one
    /// way than the other. An open vessel lets several out; one may slip through a seam.
    fn is_inside(&self, point: &Point3<f64>) -> bool {
        let mut doubts = 0;
        for direction in RAYS.iter().flat_map(|&r| [Vector3::from(r), -Vector3::from(r)]) {
            let (mut turns, mut count) = (0, 0);
            let mut last = f64::NEG_INFINITY;
            for hit in self.surface.all_hits(point, &direction, f64::INFINITY) {
                // The two faces of an edge are one crossing.
                if hit.at - last < 1e-9 * self.size {
                    continue;
                }
                last = hit.at;
                count += 1;
                turns += if hit.normal.dot(&direction) > 0.0 { 1 } else { -1 };
            }
            if count % 2 == 0 && turns == 0 {
                doubts += 1;
                if doubts > 1 {
                    return false;
                }
            }
        }
        true
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
