//! A disc that drives in a plane and carries an arm of three links: a mobile robot that is cheap enough for many runs.

use std::f64::consts::{PI, TAU};

use robotc_core::rng::Rng;

use super::workspace::Workspace;
use crate::edge::{EdgeChecker, Obstruction};
use crate::space::{Axis, Space};

const LINKS: [f64; 3] = [0.6, 0.5, 0.25];
const REACH: f64 = LINKS[0] + LINKS[1] + LINKS[2];
const BASE_RADIUS: f64 = 0.3;
const LINK_RADIUS: f64 = 0.04;
/// Metres that a radian of turning of the tool counts as.
const RADIAN: f64 = 0.3;

/// Lower and upper corner.
type Box2 = ([f64; 2], [f64; 2]);

/// Where the disc drives.
pub(super) struct Floor {
    pub(super) name: &'static str,
    /// As high as the arm: in the way of everything.
    pub(super) walls: Vec<Box2>,
    /// Lower than the arm: in the way of the base only.
    pub(super) tables: Vec<Box2>,
    pub(super) start: [f64; 5],
    /// x, y and heading of the tool.
    pub(super) goal: [f64; 3],
}

/// Four places of the kinds that mobile robots meet.
pub(super) fn floors() -> Vec<Floor> {
    let folded = |x: f64, y: f64| [x, y, 0.0, 2.4, -2.2];
    vec![
        Floor {
            name: "shelf",
            walls: vec![([8.6, 4.3], [9.6, 4.4]), ([8.6, 5.6], [9.6, 5.7]), ([9.6, 4.3], [9.7, 5.7])],
            tables: vec![([8.6, 4.3], [9.7, 5.7])],
            start: folded(1.5, 5.0),
            goal: [9.2, 5.0, 0.0],
        },
        Floor {
            name: "table",
            walls: vec![([4.5, 0.0], [4.7, 6.0])],
            tables: vec![([6.0, 3.0], [9.0, 5.0])],
            start: folded(1.5, 2.0),
            goal: [8.2, 4.4, -PI / 2.0],
        },
        Floor {
            name: "doorway",
            walls: vec![([4.9, 0.0], [5.1, 4.4]), ([4.9, 5.4], [5.1, 10.0])],
            tables: vec![([8.5, 0.0], [10.0, 2.0])],
            start: folded(2.0, 8.0),
            goal: [8.9, 1.5, 0.0],
        },
        Floor {
            name: "round the table",
            walls: vec![([7.0, 2.0], [7.1, 8.0])],
            tables: vec![([3.0, 2.0], [7.0, 8.0])],
            start: folded(1.0, 5.0),
            goal: [7.5, 5.0, PI],
        },
    ]
}

/// The robot: x and y of the base, three joints.
pub(super) struct Planar {
    space: Space,
    walls: Vec<Box2>,
    tables: Vec<Box2>,
    /// What is kept from everything: half the resolution, so that edges are free without gaps.
    pub(super) padding: f64,
    /// States looked at.
    pub(super) looked: u64,
}

impl Planar {
    pub(super) fn new(floor: &Floor) -> Self {
        let joint = Axis::bounded(-2.6, 2.6);
        let axes = vec![Axis::bounded(0.0, 10.0), Axis::bounded(0.0, 10.0), Axis::wrapping(), joint, joint];
        let (walls, tables) = (floor.walls.clone(), floor.tables.clone());
        Self { space: Space::new(axes), walls, tables, padding: 0.01, looked: 0 }
    }

    /// Base, elbow, wrist, tool.
    fn joints(q: &[f64]) -> [[f64; 2]; 4] {
        let mut points = [[q[0], q[1]]; 4];
        let mut heading = 0.0;
        for i in 0..3 {
            heading += q[2 + i];
            let (sin, cos) = libm::sincos(heading);
            points[i + 1] = [points[i][0] + LINKS[i] * cos, points[i][1] + LINKS[i] * sin];
        }
        points
    }

    /// The tool alone, at its resolution.
    pub(super) fn tool_is_free(walls: &[Box2], from: &[f64; 3], to: &[f64; 3]) -> bool {
        let steps = (distance(from, to) / 0.05).ceil().max(1.0);
        (0..=steps as usize).all(|k| {
            let [x, y, heading] = toward(from, to, k as f64 / steps);
            let (sin, cos) = libm::sincos(heading);
            let wrist = [x - LINKS[2] * cos, y - LINKS[2] * sin];
            let inside = |v: f64| (0.0..=10.0).contains(&v);
            inside(x) && inside(y) && walls.iter().all(|b| segment_gap(wrist, [x, y], b) > LINK_RADIUS)
        })
    }
}

fn turn(from: f64, to: f64) -> f64 {
    let d = to - from;
    d - TAU * (d / TAU).round()
}

fn distance(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    libm::hypot(a[0] - b[0], a[1] - b[1]) + RADIAN * turn(a[2], b[2]).abs()
}

fn toward(from: &[f64; 3], to: &[f64; 3], t: f64) -> [f64; 3] {
    let mix = |i: usize| from[i] + t * (to[i] - from[i]);
    [mix(0), mix(1), from[2] + t * turn(from[2], to[2])]
}

fn point_gap(p: [f64; 2], (low, high): &Box2) -> f64 {
    let gap = |i: usize| (low[i] - p[i]).max(p[i] - high[i]).max(0.0);
    libm::hypot(gap(0), gap(1))
}

/// Distance of a segment from a box: the gap of a point is convex along the segment.
fn segment_gap(a: [f64; 2], b: [f64; 2], other: &Box2) -> f64 {
    let at = |t: f64| point_gap([a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])], other);
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..24 {
        let (l, h) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
        if at(l) <= at(h) { high = h } else { low = l }
    }
    at(0.5 * (low + high))
}

impl EdgeChecker for Planar {
    fn space(&self) -> &Space {
        &self.space
    }

    fn state(&mut self, q: &[f64]) -> Result<f64, Obstruction> {
        self.looked += 1;
        if !self.space.contains(q) {
            return Err(Obstruction::Bounds);
        }
        let joints = Self::joints(q);
        let mut room = f64::INFINITY;
        for (i, b) in self.walls.iter().chain(&self.tables).enumerate() {
            let mut gap = point_gap(joints[0], b) - BASE_RADIUS;
            if i < self.walls.len() {
                for pair in joints.windows(2) {
                    gap = gap.min(segment_gap(pair[0], pair[1], b) - LINK_RADIUS);
                }
            }
            gap -= self.padding;
            if gap <= 0.0 {
                return Err(Obstruction::Contact(i as u32));
            }
            room = room.min(gap);
        }
        Ok(room)
    }

    fn travel(&self, difference: &[f64]) -> f64 {
        let reach = |i: usize| LINKS[i..].iter().sum::<f64>();
        let turns: f64 = (0..3).map(|i| reach(i) * difference[2 + i].abs()).sum();
        libm::hypot(difference[0], difference[1]) + turns
    }

    fn resolution(&self) -> f64 {
        0.02
    }
}

/// The space of the tool's poses: x, y, heading.
pub(super) struct Tool {
    walls: Vec<Box2>,
    space: Space,
}

impl Tool {
    pub(super) fn new(floor: &Floor) -> Self {
        Self { walls: floor.walls.clone(), space: Planar::new(floor).space }
    }
}

impl Workspace for Tool {
    type Point = [f64; 3];

    fn point(&self, q: &[f64]) -> [f64; 3] {
        let [x, y] = Planar::joints(q)[3];
        [x, y, q[2] + q[3] + q[4]]
    }

    fn distance(&self, a: &[f64; 3], b: &[f64; 3]) -> f64 {
        distance(a, b)
    }

    fn sample(&self, rng: &mut Rng) -> [f64; 3] {
        [rng.range(0.0, 10.0), rng.range(0.0, 10.0), rng.range(-PI, PI)]
    }

    fn toward(&self, from: &[f64; 3], to: &[f64; 3], step: f64) -> [f64; 3] {
        toward(from, to, (step / distance(from, to).max(1e-12)).min(1.0))
    }

    fn tool_motion(&mut self, from: &[f64; 3], to: &[f64; 3]) -> bool {
        Planar::tool_is_free(&self.walls, from, to)
    }

    fn pull(&self, q: &[f64], to: &[f64; 3]) -> Vec<f64> {
        let (joints, here) = (Planar::joints(q), self.point(q));
        let error = [to[0] - here[0], to[1] - here[1], RADIAN * turn(here[2], to[2])];
        let mut columns = vec![[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        for joint in &joints[..3] {
            columns.push([-(here[1] - joint[1]), here[0] - joint[0], RADIAN]);
        }
        let dot = |a: &[f64; 3], b: &[f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let direction: Vec<f64> = columns.iter().map(|c| dot(c, &error)).collect();
        let mut moved = [0.0; 3];
        for (column, d) in columns.iter().zip(&direction) {
            for i in 0..3 {
                moved[i] += d * column[i];
            }
        }
        let scale = dot(&error, &moved) / dot(&moved, &moved).max(1e-12);
        direction.iter().map(|d| scale * d).collect()
    }

    fn solutions(&mut self, q: &[f64], to: &[f64; 3]) -> Vec<Vec<f64>> {
        let (sin, cos) = libm::sincos(to[2]);
        let (x, y) = (to[0] - LINKS[2] * cos - q[0], to[1] - LINKS[2] * sin - q[1]);
        let bend = (x * x + y * y - LINKS[0] * LINKS[0] - LINKS[1] * LINKS[1]) / (2.0 * LINKS[0] * LINKS[1]);
        if bend.abs() > 1.0 {
            return vec![];
        }
        let mut found: Vec<Vec<f64>> = [libm::acos(bend), -libm::acos(bend)]
            .into_iter()
            .map(|elbow| {
                let shoulder = libm::atan2(y, x)
                    - libm::atan2(LINKS[1] * libm::sin(elbow), LINKS[0] + LINKS[1] * libm::cos(elbow));
                vec![q[0], q[1], shoulder, elbow, turn(shoulder + elbow, to[2])]
            })
            .filter(|q| self.space.contains(q))
            .collect();
        found.sort_by(|a, b| self.space.distance(a, q).total_cmp(&self.space.distance(b, q)));
        found
    }

    fn base(&self) -> &[usize] {
        &[0, 1]
    }

    fn base_distance(&self, q: &[f64], to: &[f64; 3]) -> f64 {
        libm::hypot(to[0] - q[0], to[1] - q[1])
    }

    fn sample_near(&self, space: &Space, to: &[f64; 3], rng: &mut Rng) -> Vec<f64> {
        let mut q = space.sample(rng);
        let (distance, angle) = (self.reach() * rng.unit().sqrt(), rng.range(-PI, PI));
        q[0] = to[0] + distance * libm::cos(angle);
        q[1] = to[1] + distance * libm::sin(angle);
        space.clamp(&mut q);
        q
    }

    fn reach(&self) -> f64 {
        REACH
    }
}
