//! Support points of polytopes with many corners.
//!
//! A corner with no higher neighbour is the highest: the polytope is convex. The climb starts from a corner that is highest
//! for a direction close by, so that it takes a few steps only.

use nalgebra::{Point3, Vector3};

/// Neighbours of corners, and where climbs start.
#[derive(Debug)]
pub(super) struct Climb {
    /// For each corner, where its neighbours begin; one more at the end.
    first: Vec<u32>,
    neighbours: Vec<u32>,
    /// The highest corner for each cell of directions.
    starts: Vec<u32>,
}

/// Cells along each edge of a cube around all directions.
const CELLS: usize = 6;

impl Climb {
    pub(super) fn new(points: &[Point3<f64>], triangles: &[[u32; 3]]) -> Self {
        let mut edges: Vec<(u32, u32)> = triangles
            .iter()
            .flat_map(|&[a, b, c]| [(a, b), (b, a), (b, c), (c, b), (c, a), (a, c)])
            .collect();
        edges.sort_unstable();
        edges.dedup();
        let mut first = vec![0; points.len() + 1];
        for &(a, _) in &edges {
            first[a as usize + 1] += 1;
        }
        for i in 1..first.len() {
            first[i] += first[i - 1];
        }
        let neighbours = edges.into_iter().map(|(_, b)| b).collect();
        let mut climb = Self { first, neighbours, starts: Vec::new() };
        let mut at = 0;
        for cell in 0..6 * CELLS * CELLS {
            at = climb.from(points, at, &middle(cell));
            climb.starts.push(at as u32);
        }
        climb
    }

    /// The corner farthest along a direction.
    pub(super) fn farthest(&self, points: &[Point3<f64>], direction: &Vector3<f64>) -> usize {
        self.from(points, self.starts[cell(direction)] as usize, direction)
    }

    fn from(&self, points: &[Point3<f64>], mut at: usize, direction: &Vector3<f64>) -> usize {
        let height = |i: usize| direction.dot(&points[i].coords);
        let mut highest = height(at);
        loop {
            let mut next = at;
            for &neighbour in &self.neighbours[self.first[at] as usize..self.first[at + 1] as usize] {
                let above = height(neighbour as usize);
                if above > highest {
                    (next, highest) = (neighbour as usize, above);
                }
            }
            if next == at {
                return at;
            }
            at = next;
        }
    }
}

/// The cell of a direction: the face of the cube that it goes through, and where.
fn cell(direction: &Vector3<f64>) -> usize {
    let axis = direction.iamax();
    let along = direction[axis];
    if along == 0.0 || !along.is_finite() {
        return 0;
    }
    let place = |k: usize| {
        let x = direction[(axis + k) % 3] / along.abs();
        (((x + 1.0) * 0.5 * CELLS as f64) as usize).min(CELLS - 1)
    };
    let face = 2 * axis + usize::from(along < 0.0);
    (face * CELLS + place(1)) * CELLS + place(2)
}

/// A direction in the middle of a cell.
fn middle(cell: usize) -> Vector3<f64> {
    let (face, u, v) = (cell / (CELLS * CELLS), cell / CELLS % CELLS, cell % CELLS);
    let axis = face / 2;
    let at = |i: usize| (2 * i + 1) as f64 / CELLS as f64 - 1.0;
    let mut direction = Vector3::zeros();
    direction[axis] = if face % 2 == 0 { 1.0 } else { -1.0 };
    direction[(axis + 1) % 3] = at(u);
    direction[(axis + 2) % 3] = at(v);
    direction
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::ConvexPart;
    use crate::rng::Seed;

    #[test]
    fn climbing_finds_the_farthest_corner() {
        let mut rng = Seed::new(8).rng();
        for round in 0..8 {
            // Round, flat and cornered clouds; some with many points in one plane.
            let stretch = Vector3::new(1.0, 0.3, if round % 2 == 0 { 0.01 } else { 2.0 });
            let cloud: Vec<Point3<f64>> = (0..600)
                .map(|i| {
                    let mut v = rng.direction().into_inner();
                    if round % 4 > 1 && i % 2 == 0 {
                        v.z = v.z.signum() * 0.5;
                    }
                    Point3::from(v.component_mul(&stretch))
                })
                .collect();
            let part = ConvexPart::hull_of(&cloud).unwrap();
            let climb = Climb::new(part.points(), part.triangles());
            let axes = [Vector3::x(), -Vector3::y(), Vector3::z(), Vector3::zeros()];
            let directions = (0..400).map(|_| rng.direction().into_inner()).collect::<Vec<_>>();
            for d in axes.iter().chain(&directions) {
                let expected =
                    part.points().iter().map(|p| d.dot(&p.coords)).fold(f64::NEG_INFINITY, f64::max);
                let found = d.dot(&part.points()[climb.farthest(part.points(), d)].coords);
                assert!(expected - found <= 1e-9, "{expected} {found} {d}");
            }
        }
    }

    #[test]
    fn cells_contain_their_middles() {
        for i in 0..6 * CELLS * CELLS {
            assert_eq!(cell(&middle(i)), i);
        }
    }
}
