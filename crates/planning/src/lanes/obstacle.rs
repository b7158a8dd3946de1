//! Bodies that stand still, as the lane kernel sees them.

use nalgebra::Vector3;
use pulp::Simd;
use robotc_core::Pose;
use robotc_core::geom::{ConvexPart, Pile};
use robotc_core::model::Shape;

use super::lane::{Lanes, Vector, minus};
use super::pile::{self, Question};

/// A solid with its pose in the root frame of the robot.
#[derive(Debug, Clone)]
pub(super) struct Obstacle {
    solid: Solid,
    /// Root coordinates of the middle.
    middle: [f32; 3],
    /// Rows of the rotation that takes root coordinates to its own.
    rows: [[f32; 3]; 3],
    /// Whether its z axis is that of the root frame.
    upright: bool,
    /// The exact shape, a polytope around this solid, stands out by no more than this; metres.
    pub(super) pad: f32,
    /// Middle and radius of a ball around the exact shape, in the root frame.
    pub(super) ball: ([f64; 3], f64),
}

#[derive(Debug, Clone)]
enum Solid {
    Sphere(f32),
    /// Half edge lengths.
    Box([f32; 3]),
    /// Radius and half length.
    Cylinder(f32, f32),
    Capsule(f32, f32),
    /// Normals and offsets, about the middle.
    Planes(Vec<[f32; 4]>),
    /// In its own frame, at the middle.
    Pile(Pile),
}

/// Tilts that move no point of a solid by more than rounding does, radians.
const LEVEL: f32 = 1e-7;

/// The exact shapes of round solids are polytopes around them; by how much these stand out, as a fraction of the radius.
const SPHERE_PAD: f64 = 0.06;
const CYLINDER_PAD: f64 = 0.02;
const CAPSULE_PAD: f64 = 0.15;

impl Obstacle {
    /// A primitive or a pile; `None` for a mesh.
    pub(super) fn of_shape(shape: &Shape, root_from_shape: &Pose) -> Option<Self> {
        let half = |x: f64| (0.5 * x) as f32;
        let (solid, pad, radius) = match *shape {
            Shape::Sphere { radius } => (Solid::Sphere(radius as f32), SPHERE_PAD * radius, radius),
            Shape::Box { size } => (Solid::Box(size.map(half)), 0.0, 0.5 * Vector3::from(size).norm()),
            Shape::Cylinder { radius, length } => {
                let solid = Solid::Cylinder(radius as f32, half(length));
                (solid, CYLINDER_PAD * radius, radius.hypot(0.5 * length))
            }
            Shape::Capsule { radius, length } => {
                let solid = Solid::Capsule(radius as f32, half(length));
                (solid, CAPSULE_PAD * radius, radius + 0.5 * length)
            }
            Shape::Mesh { .. } => return None,
            Shape::Cloud { .. } | Shape::HeightField { .. } => {
                return Pile::of_shape(shape).map(|pile| Self::of_pile(&pile, root_from_shape));
            }
        };
        Some(Self::new(solid, root_from_shape, pad, radius))
    }

    /// A convex polytope.
    pub(super) fn of_part(part: &ConvexPart, root_from_part: &Pose) -> Self {
        let (centre, radius) = part.bounding_sphere();
        let plane = |plane: &robotc_core::geom::Plane| {
            let n = plane.normal;
            [n.x as f32, n.y as f32, n.z as f32, (-plane.height(&centre)) as f32]
        };
        let planes = Solid::Planes(part.planes().iter().map(plane).collect());
        Self::new(planes, &(root_from_part * nalgebra::Translation3::from(centre.coords)), 0.0, radius)
    }

    /// A cloud or a height field.
    pub(super) fn of_pile(pile: &Pile, root_from_pile: &Pose) -> Self {
        let bounds = pile.bounds();
        let farthest = bounds.low.coords.norm().max(bounds.high.coords.norm()) + bounds.diagonal();
        let from_root = root_from_pile.translation.vector.norm();
        // Its points, and where it is, are rounded to single precision.
        let pad = 2e-6 * (1.0 + farthest + from_root);
        let radius = 0.5 * bounds.diagonal();
        let mut obstacle = Self::new(Solid::Pile(pile.clone()), root_from_pile, pad, radius);
        obstacle.ball.0 = (root_from_pile * bounds.centre()).coords.into();
        obstacle
    }

    fn new(solid: Solid, root_from_solid: &Pose, pad: f64, radius: f64) -> Self {
        let middle = root_from_solid.translation.vector;
        let rotation = root_from_solid.rotation.to_rotation_matrix();
        let row = |i: usize| [0, 1, 2].map(|k| rotation.matrix()[(k, i)] as f32);
        let rows = [row(0), row(1), row(2)];
        Self {
            solid,
            middle: [middle.x as f32, middle.y as f32, middle.z as f32],
            rows,
            upright: rows[2][0].abs() < LEVEL && rows[2][1].abs() < LEVEL && rows[2][2] > 0.0,
            // The polytope of a solid is at least as large in every direction; rounded up.
            pad: (pad * (1.0 + 1e-6)) as f32,
            ball: ([middle.x, middle.y, middle.z], radius + pad),
        }
    }

    /// Squares of a lower and of an upper bound of the distance to `point`, in the root frame, as far as the question asks for them.
    #[inline(always)]
    pub(super) fn squared_distance<S: Simd>(
        &self,
        simd: S,
        point: &Vector<S>,
        question: Question<S>,
    ) -> (Lanes<S>, Lanes<S>) {
        let splat = |x: f32| Lanes::splat(simd, x);
        let zero = splat(0.0);
        let [mx, my, mz] = self.middle;
        let from_middle = minus(point, &[splat(mx), splat(my), splat(mz)]);
        if let Solid::Sphere(radius) = self.solid {
            let [x, y, z] = from_middle;
            let gap = ((x * x + y * y + z * z).sqrt() - splat(radius)).max(zero);
            let squared = gap * gap;
            return (squared, squared);
        }
        let [x, y, z] = if self.upright {
            [flat(&from_middle, &self.rows[0]), flat(&from_middle, &self.rows[1]), from_middle[2]]
        } else {
            let [row_x, row_y, row_z] = &self.rows;
            [along(&from_middle, row_x), along(&from_middle, row_y), along(&from_middle, row_z)]
        };
        match &self.solid {
            Solid::Sphere(_) => (zero, zero),
            Solid::Box(half) => {
                let (x, y, z) = (
                    beyond(x, splat(half[0]), zero),
                    beyond(y, splat(half[1]), zero),
                    beyond(z, splat(half[2]), zero),
                );
                let squared = x * x + y * y + z * z;
                (squared, squared)
            }
            Solid::Cylinder(radius, half) => {
                let aside = ((x * x + y * y).sqrt() - splat(*radius)).max(zero);
                let z = beyond(z, splat(*half), zero);
                let squared = aside * aside + z * z;
                (squared, squared)
            }
            Solid::Capsule(radius, half) => {
                let z = beyond(z, splat(*half), zero);
                let gap = ((x * x + y * y + z * z).sqrt() - splat(*radius)).max(zero);
                let squared = gap * gap;
                (squared, squared)
            }
            Solid::Pile(pile) => {
                let (least, most) = pile::squared_distance(simd, pile, &[x, y, z], question);
                // Rounding proves no contact, either.
                let most = most.sqrt() + splat(self.pad);
                (least, most * most)
            }
            Solid::Planes(planes) => {
                let mut height = splat(f32::NEG_INFINITY);
                for [nx, ny, nz, offset] in planes {
                    height = height.max(x * *nx + y * *ny + z * *nz - splat(*offset));
                }
                // Above a face nothing is known of the distance but that it is no less. Inside it is zero.
                let outside = height.max(zero);
                let squared = outside * outside;
                (squared, squared * f32::MAX)
            }
        }
    }
}

/// A coordinate along a row.
#[inline(always)]
fn along<S: Simd>(v: &Vector<S>, row: &[f32; 3]) -> Lanes<S> {
    flat(v, row) + v[2] * row[2]
}

/// A coordinate along a row without z.
#[inline(always)]
fn flat<S: Simd>(v: &Vector<S>, row: &[f32; 3]) -> Lanes<S> {
    v[0] * row[0] + v[1] * row[1]
}

/// How far a coordinate is beyond half an edge, on either side.
#[inline(always)]
fn beyond<S: Simd>(x: Lanes<S>, half: Lanes<S>, zero: Lanes<S>) -> Lanes<S> {
    (x.abs() - half).max(zero)
}
