//! Distances to point clouds and height fields, in lanes.
//!
//! All lanes go down the tree of the pile together: a node is left out when it is too far from every one of them. What a lane is
//! told depends on its own point alone, not on where others lead, so that it is the same with any number of lanes.
//!
//! A sphere that has spheres below it is only asked whether it comes near; then nodes that are small against it stand for what is in
//! them. That a configuration in each lane and one tree for all of them suit each other is as in Ramsey, Kingston, Thomason and Kavraki,
//! "Collision-affording point trees" (2024), whose tree is of another kind: it holds for each leaf all points that a sphere may touch.

use pulp::Simd;
use robotc_core::geom::{Block, HeightField, Pile, PointCloud};

use super::lane::{Lanes, Vector};

/// What is asked of a pile.
#[derive(Clone, Copy)]
pub(super) struct Question<S: Simd> {
    /// Distances beyond this do not matter, metres.
    pub(super) limit: Lanes<S>,
    /// Nodes no larger than this stand for what is in them, metres; zero asks for everything.
    pub(super) coarse: f32,
}

/// Squares of a lower and an upper bound of the distances found so far.
struct Found<S: Simd> {
    least: Lanes<S>,
    most: Lanes<S>,
    /// What is farther does not matter.
    limit: Lanes<S>,
}

impl<S: Simd> Found<S> {
    #[inline(always)]
    fn new(simd: S, limit: Lanes<S>) -> Self {
        let nothing = Lanes::splat(simd, f32::INFINITY);
        Self { least: nothing, most: nothing, limit: limit * limit }
    }

    /// Whether something at this distance, squared, matters in some lane. Nothing that would be nearest, or whose upper bound would be
    /// the lowest, is left out.
    #[inline(always)]
    fn is_of_use(&self, squared: Lanes<S>) -> bool {
        squared.less_equal(self.limit.min(self.most)).any()
    }

    #[inline(always)]
    fn add(&mut self, least: Lanes<S>, most: Lanes<S>) {
        self.least = self.least.min(least);
        self.most = self.most.min(most);
    }
}

/// Squares of a lower and an upper bound of the distance of `point`, in the frame of the pile, as far as asked.
#[inline(always)]
pub(super) fn squared_distance<S: Simd>(
    simd: S,
    pile: &Pile,
    point: &Vector<S>,
    question: Question<S>,
) -> (Lanes<S>, Lanes<S>) {
    match pile {
        Pile::Cloud(cloud) => of_cloud(simd, cloud, point, question),
        Pile::Field(field) => of_field(simd, field, point, question),
    }
}

#[inline(always)]
fn of_cloud<S: Simd>(
    simd: S,
    cloud: &PointCloud,
    point: &Vector<S>,
    Question { limit, coarse }: Question<S>,
) -> (Lanes<S>, Lanes<S>) {
    let splat = |x: f32| Lanes::splat(simd, x);
    let zero = splat(0.0);
    let radius = splat(cloud.radius() as f32);
    let mut found = Found::new(simd, limit + radius);
    // A node and its sibling for each level below the root.
    let mut stack = [1_u32; 64];
    let mut top = 1;
    while top > 0 {
        top -= 1;
        let node = stack[top] as usize;
        let sides = cloud.node(node);
        let [low, high] = [[sides[0], sides[1], sides[2]], [sides[3], sides[4], sides[5]]];
        let squared = to_box(point, low.map(splat), high.map(splat), zero);
        if !found.is_of_use(squared) {
            continue;
        }
        if (0..3).all(|k| high[k] - low[k] <= coarse) {
            let across = |k: usize| (point[k] - splat(low[k])).abs().max((point[k] - splat(high[k])).abs());
            let (x, y, z) = (across(0), across(1), across(2));
            found.add(squared, x * x + y * y + z * z);
        } else if let Some(points) = cloud.leaf(node) {
            for p in points {
                let [x, y, z] = [
                    point[0] - splat(p.x as f32),
                    point[1] - splat(p.y as f32),
                    point[2] - splat(p.z as f32),
                ];
                let squared = x * x + y * y + z * z;
                found.add(squared, squared);
            }
        } else {
            stack[top] = 2 * node as u32 + 1;
            stack[top + 1] = 2 * node as u32;
            top += 2;
        }
    }
    let beyond = |squared: Lanes<S>| {
        let gap = (squared.sqrt() - radius).max(zero);
        gap * gap
    };
    (beyond(found.least), beyond(found.most))
}

#[inline(always)]
fn of_field<S: Simd>(
    simd: S,
    field: &HeightField,
    point: &Vector<S>,
    Question { limit, coarse }: Question<S>,
) -> (Lanes<S>, Lanes<S>) {
    let splat = |x: f32| Lanes::splat(simd, x);
    let zero = splat(0.0);
    let floor = splat(field.floor() as f32);
    let mut found = Found::new(simd, limit);
    let mut stack = [(0_u32, 0_u32, 0_u32); 64];
    stack[0].0 = field.levels() as u32 - 1;
    let mut top = 1;
    while top > 0 {
        top -= 1;
        let (level, row, column) = stack[top];
        let Some(block) = field.block(level as usize, row as usize, column as usize) else { continue };
        // Where nothing is known it is below everything, and infinitely far.
        let Block { bounds: [x, y, to_x, to_y], lowest, highest } = *block;
        let (low, high) = ([splat(x), splat(y), floor], [splat(to_x), splat(to_y), splat(highest)]);
        let squared = to_box(point, low, high, zero);
        if !found.is_of_use(squared) {
            continue;
        }
        let filled = to_box(point, low, [high[0], high[1], splat(lowest)], zero);
        if (to_x - x).max(to_y - y) <= coarse {
            found.add(squared, filled);
        } else if level == 0 {
            cell(simd, field, (row as usize, column as usize), point, squared, &mut found);
        } else {
            // Only an upper bound.
            found.most = found.most.min(filled);
            for (i, (r, c)) in [(1, 1), (1, 0), (0, 1), (0, 0)].into_iter().enumerate() {
                stack[top + i] = (level - 1, 2 * row + r, 2 * column + c);
            }
            top += 4;
        }
    }
    (found.least, found.most)
}

/// The two prisms of a cell; `to_bounds` is the square of the distance to their box.
#[inline(always)]
fn cell<S: Simd>(
    simd: S,
    field: &HeightField,
    (row, column): (usize, usize),
    point: &Vector<S>,
    to_bounds: Lanes<S>,
    found: &mut Found<S>,
) {
    let splat = |x: f32| Lanes::splat(simd, x);
    let zero = splat(0.0);
    let [sx, sy] = field.spacing().map(|s| s as f32);
    let corner = field.sample(row, column);
    let [x, y] = [point[0] - splat(corner.x as f32), point[1] - splat(corner.y as f32)];
    let z = point[2];
    // How far beside the cell, and on which side of its diagonal.
    let aside = [zero.max(splat(0.0) - x).max(x - splat(sx)), zero.max(splat(0.0) - y).max(y - splat(sy))];
    let aside = aside[0] * aside[0] + aside[1] * aside[1];
    let diagonal = (y * sx - x * sy) * (1.0 / (sx * sx + sy * sy).sqrt());
    for (i, triangle) in field.triangles(row, column).into_iter().enumerate() {
        let Some([a, b, c]) = triangle else { continue };
        let heights = [a.z, b.z, c.z].map(|z| z as f32);
        let slope = match i {
            0 => [(heights[1] - heights[0]) / sx, (heights[2] - heights[1]) / sy],
            _ => [(heights[1] - heights[2]) / sx, (heights[2] - heights[0]) / sy],
        };
        let above = z - splat(heights[0]) - x * slope[0] - y * slope[1];
        let upright = 1.0 / (1.0 + slope[0] * slope[0] + slope[1] * slope[1]).sqrt();
        let plane = (above * upright).max(zero);
        let across = if i == 0 { diagonal.max(zero) } else { (splat(0.0) - diagonal).max(zero) };
        let least = to_bounds.max(plane * plane).max(across * across);
        // Straight down to the triangle, or up to the floor; only for what is above or below it.
        let straight = above.max(splat(field.floor() as f32) - z).max(zero);
        let beside = aside + across * across;
        let mut most = straight * straight + beside * f32::MAX;
        for p in [a, b, c] {
            let [dx, dy, dz] =
                [point[0] - splat(p.x as f32), point[1] - splat(p.y as f32), z - splat(p.z as f32)];
            most = most.min(dx * dx + dy * dy + dz * dz);
        }
        // Rounding may make the lower one larger, never by more than the caller allows for.
        found.add(least.min(most), most);
    }
}

/// Square of the distance to a box.
#[inline(always)]
fn to_box<S: Simd>(point: &Vector<S>, low: Vector<S>, high: Vector<S>, zero: Lanes<S>) -> Lanes<S> {
    let beyond = |k: usize| (low[k] - point[k]).max(point[k] - high[k]).max(zero);
    let (x, y, z) = (beyond(0), beyond(1), beyond(2));
    x * x + y * y + z * z
}
