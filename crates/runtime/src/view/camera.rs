//! The camera that a page opens with. `js/camera.js` does the same in the browser.

use nalgebra::{Point3, Vector3};

use crate::record::{Bounds, Group, Recording};

/// How much more than what is framed the free part of the picture shows.
const MARGIN: f64 = 1.06;
/// Pictures narrower than this, in pixels, have facts folded away and two rows of controls below.
const NARROW: f64 = 900.0;
/// What controls take from the left, top and bottom of a wide and of a narrow picture, pixels.
const TAKEN_WIDE: [f64; 3] = [268.0, 0.0, 92.0];
const TAKEN_NARROW: [f64; 3] = [0.0, 64.0, 122.0];

/// A camera that looks at a target, z up, in a picture with controls at its edges.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    /// The point in the middle of the free part of the picture, in the world.
    pub target: Point3<f64>,
    /// Direction from target to eye, about z from x; radians.
    pub azimuth: f64,
    /// Height of the eye above the horizon; radians.
    pub elevation: f64,
    /// From target to eye, metres.
    pub distance: f64,
    /// Angle between lower and upper edge of the picture; radians.
    pub fov_y: f64,
    /// Width and height of the picture, in pixels as style sheets count them.
    pub size: [f64; 2],
}

impl Camera {
    /// The camera of a page just opened with this width and height: it sees the whole [`focus`] of a recording.
    pub fn opening(recording: &Recording, size: [f64; 2]) -> Self {
        let focus = focus(recording);
        let around = focus.iter().copied().reduce(|a, b| a.join(&b)).expect("a focus is never empty");
        let (target, azimuth) = (around.centre(), opening_azimuth(recording));
        let mut camera = Self { target, azimuth, elevation: 0.38, distance: 1.0, fov_y: 0.52, size };
        let [right, up, back] = camera.axes();
        let Free { share, .. } = camera.free();
        let tan_y = libm::tan(camera.fov_y / 2.0) / MARGIN;
        let tan_x = tan_y * size[0] / size[1];
        let needed = focus.iter().flat_map(Bounds::corners).map(|corner| {
            let p = corner - camera.target;
            p.dot(&back)
                + (p.dot(&right).abs() / (tan_x * share[0])).max(p.dot(&up).abs() / (tan_y * share[1]))
        });
        camera.distance = needed.fold(0.0, f64::max);
        camera
    }

    /// The camera of a picture of this width and height without controls, from the side from which a page opens.
    pub(super) fn still(recording: &Recording, [width, height]: [f64; 2]) -> Still {
        let [left, top, bottom] = TAKEN_WIDE;
        // The free part of a picture that is larger by the controls; wide ones have theirs at these places.
        let camera = Self::opening(recording, [width.max(NARROW) + left, height + top + bottom]);
        Still { camera, corner: [left + 0.5 * (width.max(NARROW) - width), top] }
    }

    /// The part of the picture that no control covers.
    fn free(&self) -> Free {
        let [width, height] = self.size;
        let [left, top, bottom] = if width < NARROW { TAKEN_NARROW } else { TAKEN_WIDE };
        Free {
            middle: [left / width, (bottom - top) / height],
            share: [1.0 - left / width, (1.0 - (top + bottom) / height).max(0.2)],
        }
    }

    /// Unit vectors to the right and top of the picture and towards the eye, in the world.
    fn axes(&self) -> [Vector3<f64>; 3] {
        let back = direction(self.azimuth, self.elevation);
        let right = Vector3::z().cross(&back).normalize();
        [right, back.cross(&right), back]
    }

    /// Where a point in the world is seen, in pixels from the left and top of the picture; `None` for points behind the
    /// eye.
    pub fn project(&self, p_in_world: &Point3<f64>) -> Option<[f64; 2]> {
        let [right, up, back] = self.axes();
        let [width, height] = self.size;
        let [middle_x, middle_y] = self.free().middle;
        let from_eye = p_in_world - (self.target + back * self.distance);
        let ahead = -from_eye.dot(&back);
        let scale = height / 2.0 / libm::tan(self.fov_y / 2.0) / ahead;
        let x = from_eye.dot(&right) * scale + middle_x * width / 2.0;
        let y = from_eye.dot(&up) * scale + middle_y * height / 2.0;
        (ahead > 0.0).then_some([width / 2.0 + x, height / 2.0 - y])
    }
}

/// A camera, and where in its picture a smaller one begins.
pub(super) struct Still {
    camera: Camera,
    corner: [f64; 2],
}

impl Still {
    /// Where a point is seen, pixels from left and top, and its distance from the plane of the eye; `None` behind the eye.
    pub(super) fn see(&self, p_in_world: &Point3<f64>) -> Option<[f64; 3]> {
        let [x, y] = self.camera.project(p_in_world)?;
        let back = self.back();
        let depth = self.camera.distance - (p_in_world - self.camera.target).dot(&back);
        Some([x - self.corner[0], y - self.corner[1], depth])
    }

    /// Direction towards the eye, in the world.
    pub(super) fn back(&self) -> Vector3<f64> {
        self.camera.axes()[2]
    }
}

/// The free part of a picture, whose coordinates go from -1 to 1 with y up.
struct Free {
    /// Its middle.
    middle: [f64; 2],
    /// Its share of width and height.
    share: [f64; 2],
}

/// Unit vector of an azimuth about z and an elevation above the horizon.
fn direction(azimuth: f64, elevation: f64) -> Vector3<f64> {
    let (sin_a, cos_a) = libm::sincos(azimuth);
    let (sin_e, cos_e) = libm::sincos(elevation);
    Vector3::new(cos_e * cos_a, cos_e * sin_a, sin_e)
}

/// What a picture is about: extents of robots and objects over the whole timeline, with the obstacles unless they are
/// much larger. A hall around a robot is not what people came to see. Never empty.
pub(super) fn focus(recording: &Recording) -> Vec<Bounds> {
    let joined = |all: &[Bounds]| all.iter().copied().reduce(|a, b| a.join(&b)).map_or(0.0, |b| b.diagonal());
    let mut main = recording.node_bounds(&[Group::Robot, Group::Object, Group::Reach]);
    let obstacles = recording.node_bounds(&[Group::Obstacle]);
    if main.is_empty() || joined(&obstacles) < 2.0 * joined(&main) {
        main.extend(obstacles);
    }
    if main.is_empty() {
        main.push(Bounds { low: Point3::new(-0.5, -0.5, 0.0), high: Point3::new(0.5, 0.5, 1.0) });
    }
    main
}

/// The side from which obstacles hide least of what objects do: of directions all around, the one nearest to the front
/// right of the robot among the best.
fn opening_azimuth(recording: &Recording) -> f64 {
    const FRONT_RIGHT: f64 = -0.82;
    const DIRECTIONS: usize = 24;
    let watched = watched_points(recording);
    let obstacles = recording.node_bounds(&[Group::Obstacle]);
    let hidden = |azimuth: f64| {
        let towards_eye = direction(azimuth, 0.38);
        watched.iter().filter(|p| obstacles.iter().any(|o| meets(o, p, &towards_eye))).count()
    };
    // Steps to alternating sides, so that of equals the first found is the nearest.
    let turns = (0..DIRECTIONS).map(|i| {
        let step = i.div_ceil(2) as f64 * if i % 2 == 1 { 1.0 } else { -1.0 };
        FRONT_RIGHT + step * std::f64::consts::TAU / DIRECTIONS as f64
    });
    turns.min_by_key(|&azimuth| hidden(azimuth)).unwrap_or(FRONT_RIGHT)
}

/// Middles of objects at moments of the timeline, and where the tool was.
fn watched_points(recording: &Recording) -> Vec<Point3<f64>> {
    const MOMENTS: usize = 24;
    let moments = (0..=MOMENTS).map(|i| recording.duration() * i as f64 / MOMENTS as f64);
    let objects = recording.nodes().enumerate().filter(|(_, node)| node.group == Group::Object);
    let middles = objects.flat_map(|(index, node)| {
        let surfaces = node.parts.iter().filter_map(|part| {
            let (low, high) = recording.surfaces()[part.surface].bounds()?;
            let middle = Point3::from(std::array::from_fn(|k| f64::from(low[k] + high[k]) / 2.0));
            Some(part.node_from_part * middle)
        });
        let surfaces: Vec<_> = surfaces.collect();
        moments.clone().flat_map(move |time| {
            let world_from_node = recording.world_from_node(index, time);
            surfaces.clone().into_iter().map(move |p| world_from_node * p)
        })
    });
    let paths =
        recording.nodes().iter().filter(|node| node.group == Group::Path).flat_map(|node| &node.lines);
    let on_paths = paths.flat_map(|lines| {
        let every = lines.points.len().div_ceil(MOMENTS).max(1);
        lines.points.iter().step_by(every).map(|p| Point3::from(p.map(f64::from)))
    });
    middles.chain(on_paths).collect()
}

/// Whether the ray from `origin` along `towards` meets a box that `origin` is not in.
fn meets(bounds: &Bounds, origin: &Point3<f64>, towards: &Vector3<f64>) -> bool {
    let (mut enter, mut leave) = (f64::NEG_INFINITY, f64::INFINITY);
    for axis in 0..3 {
        let a = (bounds.low[axis] - origin[axis]) / towards[axis];
        let b = (bounds.high[axis] - origin[axis]) / towards[axis];
        enter = enter.max(a.min(b));
        leave = leave.min(a.max(b));
    }
    enter <= leave && enter > 0.0
}

#[cfg(test)]
mod tests {
    use robotc_core::Pose;
    use robotc_core::model::{Geometry, Origin, Shape};

    use super::*;

    fn block(size: [f64; 3]) -> Vec<Geometry> {
        vec![Geometry { origin: Origin::default(), shape: Shape::Box { size }, colour: None }]
    }

    fn scene(size: [f64; 3]) -> Recording {
        let mut recording = Recording::new("test");
        recording.add_body("block", Group::Object, &block(size), Pose::translation(3.0, -1.0, 0.5));
        recording
    }

    #[test]
    fn everything_framed_is_in_the_free_part_and_fills_it() {
        for size in [[0.2, 0.2, 0.2], [3.0, 0.2, 0.1], [0.1, 0.1, 2.0]] {
            for picture in [[1280.0, 720.0], [400.0, 800.0]] {
                let recording = scene(size);
                let camera = Camera::opening(&recording, picture);
                let free = camera.free();
                let corners = focus(&recording)[0].corners();
                let seen = corners.map(|p| camera.project(&p).expect("ahead"));
                let reach = |axis: usize, sign: f64| {
                    let half = picture[axis] / 2.0;
                    let away = |s: &[f64; 2]| (sign * (s[axis] - half) / half - free.middle[axis]).abs();
                    seen.iter().map(away).fold(0.0, f64::max) / free.share[axis]
                };
                let fullest = reach(0, 1.0).max(reach(1, -1.0));
                assert!((fullest - 1.0 / MARGIN).abs() < 1e-9, "{size:?} in {picture:?}: {fullest}");
            }
        }
    }

    #[test]
    fn the_target_is_in_the_middle_of_the_free_part_and_up_is_up() {
        let recording = scene([1.0; 3]);
        let camera = Camera::opening(&recording, [1000.0, 600.0]);
        let [x, y] = camera.project(&camera.target).expect("ahead");
        assert!((x - (1000.0 + 268.0) / 2.0).abs() < 1e-9 && (y - (600.0 - 92.0) / 2.0).abs() < 1e-9);
        let above = camera.project(&(camera.target + Vector3::z() * 0.1)).expect("ahead");
        assert!(above[1] < y && (above[0] - x).abs() < 1e-9);
    }

    #[test]
    fn a_wall_in_front_is_looked_round() {
        let mut recording = scene([0.1; 3]);
        let open = Camera::opening(&recording, [800.0, 600.0]);
        let between = open.target + direction(open.azimuth, 0.0) * 0.3;
        let wall = Pose::translation(between.x, between.y, between.z);
        recording.add_body("wall", Group::Obstacle, &block([0.2, 0.2, 0.6]), wall);
        let camera = Camera::opening(&recording, [800.0, 600.0]);
        assert!((camera.azimuth - open.azimuth).abs() > 0.1, "{}", camera.azimuth);
    }
}
