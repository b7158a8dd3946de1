//! The surface of an object as points with normals, and the approaches that start from it.

use nalgebra::{Point3, Unit, Vector3};
use robotc_core::Seed;
use robotc_core::geom::MeshIndex;
use robotc_core::model::TriMesh;
use robotc_planning::grasp::tangents;

use super::strategy::Approach;

/// A point of a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SurfacePoint {
    /// Object frame, metres.
    pub(crate) point: Point3<f64>,
    /// Outward as the faces are wound; a surface that is not closed may have it the other way round.
    pub(crate) normal: Unit<Vector3<f64>>,
}

/// Points spread over all faces, about `spacing` metres apart: each face is cut into equal triangles no longer than
/// that, one point in each. In face order.
pub(crate) fn sample(mesh: &TriMesh, spacing: f64) -> Vec<SurfacePoint> {
    let mut out = Vec::new();
    for face in 0..mesh.faces.len() {
        let Some(normal) = Unit::try_new(mesh.area_vector(face), 1e-14) else { continue };
        let [a, b, c] = mesh.triangle(face);
        let longest = (b - a).norm().max((c - b).norm()).max((a - c).norm());
        let cuts = ((longest / spacing).ceil() as usize).clamp(1, 400);
        let step = 1.0 / cuts as f64;
        for i in 0..cuts {
            for j in 0..cuts - i {
                let mut push = |u: f64, v: f64| {
                    out.push(SurfacePoint { point: a + (b - a) * (u * step) + (c - a) * (v * step), normal });
                };
                push(i as f64 + 1.0 / 3.0, j as f64 + 1.0 / 3.0);
                if j + 1 < cuts - i {
                    push(i as f64 + 2.0 / 3.0, j as f64 + 2.0 / 3.0);
                }
            }
        }
    }
    thin(out, spacing)
}

/// Keeps one point of each cube of edge `spacing` and normal octant, the first.
fn thin(points: Vec<SurfacePoint>, spacing: f64) -> Vec<SurfacePoint> {
    let mut seen = std::collections::BTreeSet::new();
    let cell = |p: &SurfacePoint| {
        let c = p.point.coords / spacing;
        let octant = p.normal.map(|x| x >= 0.0);
        (c.x.floor() as i64, c.y.floor() as i64, c.z.floor() as i64, octant.x, octant.y, octant.z)
    };
    points.into_iter().filter(|p| seen.insert(cell(p))).collect()
}

/// Surface points in cubes, so that those near a finger are found without looking at all.
pub(crate) struct Surface {
    points: Vec<SurfacePoint>,
    /// Ball around the points of a cube, and where they are among `points`.
    cubes: Vec<(Point3<f64>, f64, std::ops::Range<usize>)>,
}

/// Edge of a cube, in distances of the points.
const CUBE: f64 = 8.0;

impl Surface {
    /// Points of a mesh about `spacing` metres apart.
    pub(crate) fn new(mesh: &TriMesh, spacing: f64) -> Self {
        let mut points = sample(mesh, spacing);
        let edge = CUBE * spacing;
        let cell = |p: &SurfacePoint| {
            let c = p.point.coords / edge;
            (c.x.floor() as i64, c.y.floor() as i64, c.z.floor() as i64)
        };
        points.sort_by_key(cell);
        let mut cubes = Vec::new();
        let mut first = 0;
        for i in 1..=points.len() {
            if i == points.len() || cell(&points[i]) != cell(&points[first]) {
                let inside = &points[first..i];
                let centre =
                    inside.iter().map(|p| p.point.coords).sum::<Vector3<f64>>() / inside.len() as f64;
                let radius = inside.iter().map(|p| (p.point.coords - centre).norm()).fold(0.0, f64::max);
                cubes.push((Point3::from(centre), radius, first..i));
                first = i;
            }
        }
        Self { points, cubes }
    }

    /// All points, cube by cube.
    pub(crate) fn points(&self) -> &[SurfacePoint] {
        &self.points
    }

    /// The points of all cubes whose ball (centre, radius) satisfies `near`.
    pub(crate) fn of_cubes(
        &self,
        near: impl Fn(&Point3<f64>, f64) -> bool,
    ) -> impl Iterator<Item = &SurfacePoint> {
        let chosen = self.cubes.iter().filter(move |(centre, radius, _)| near(centre, *radius));
        chosen.flat_map(|(_, _, range)| &self.points[range.clone()])
    }
}

/// What approaches are tried.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ApproachOptions {
    /// Distance between the rays that find surface points, metres.
    pub(crate) spacing: f64,
    /// Equal turns about the direction of approach.
    pub(crate) rolls: usize,
    /// Directions for each surface point: against its normal, then evenly round a cone about that.
    pub(crate) directions: usize,
    /// Half angle of that cone, radians.
    pub(crate) cone: f64,
    /// Distances to stand back after the first touch, metres.
    pub(crate) standoffs: Vec<f64>,
    /// Approach rays of the hand: where each starts beside the tool's origin, in the tool frame, metres.
    pub(crate) rays: Vec<Vector3<f64>>,
    /// Number of preshapes of the gripper.
    pub(crate) preshapes: usize,
    /// Most approaches; more than that are thinned at random.
    pub(crate) most: usize,
}

/// Approaches, in the order: surface point, direction, roll, ray of the hand, preshape, standoff.
///
/// Surface points are where rays from the six sides of the box around the object first meet it (thesis section 4.2).
/// Hands come in against the normal there, and along a cone around that direction.
pub(crate) fn approaches(
    mesh: &TriMesh,
    index: &MeshIndex,
    options: &ApproachOptions,
    seed: Seed,
) -> Vec<Approach> {
    let mut out = Vec::new();
    for (target_in_object, inward) in seen_from_box(mesh, index, options.spacing) {
        for direction_in_object in cone(&inward, options.directions, options.cone) {
            for roll in 0..options.rolls {
                let roll = std::f64::consts::TAU * roll as f64 / options.rolls as f64;
                for &ray_in_tool in &options.rays {
                    for preshape in 0..options.preshapes {
                        out.extend(options.standoffs.iter().map(|&standoff| Approach {
                            target_in_object,
                            direction_in_object,
                            roll,
                            ray_in_tool,
                            preshape,
                            standoff,
                        }));
                    }
                }
            }
        }
    }
    if out.len() > options.most {
        let mut kept: Vec<usize> = (0..out.len()).collect();
        seed.split("approaches").rng().shuffle(&mut kept);
        kept.truncate(options.most);
        kept.sort_unstable();
        return kept.into_iter().map(|i| out[i]).collect();
    }
    out
}

/// Points where rays from the sides of the bounding box first meet the surface, with the inward normal there.
fn seen_from_box(mesh: &TriMesh, index: &MeshIndex, spacing: f64) -> Vec<(Point3<f64>, Unit<Vector3<f64>>)> {
    let Some((low, high)) = mesh.bounds() else { return Vec::new() };
    let size = high - low;
    let mut found = Vec::new();
    for axis in 0..3 {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        let counts = [u, v].map(|k| ((size[k] / spacing).floor() as usize).max(1));
        for side in [1.0, -1.0] {
            let mut direction = Vector3::zeros();
            direction[axis] = side;
            for i in 0..counts[0] {
                for j in 0..counts[1] {
                    let mut origin = if side > 0.0 { low } else { high };
                    origin[axis] -= side * spacing;
                    origin[u] = low[u] + size[u] * (i as f64 + 0.5) / counts[0] as f64;
                    origin[v] = low[v] + size[v] * (j as f64 + 0.5) / counts[1] as f64;
                    let Some(hit) = index.first_hit(&origin, &direction, size[axis] + 2.0 * spacing) else {
                        continue;
                    };
                    // The ray came from outside, whichever way the face is wound.
                    let inward = if hit.normal.dot(&direction) > 0.0 { hit.normal } else { -hit.normal };
                    found.push((hit.point, inward));
                }
            }
        }
    }
    found
}

/// `axis` itself, then `count - 1` directions evenly round a cone of this half angle about it.
fn cone(axis: &Unit<Vector3<f64>>, count: usize, half_angle: f64) -> Vec<Unit<Vector3<f64>>> {
    let mut out = vec![*axis];
    let (u, v) = tangents(axis);
    let ring = count.saturating_sub(1);
    for k in 0..ring {
        let angle = std::f64::consts::TAU * k as f64 / ring as f64;
        let side = u * libm::cos(angle) + v * libm::sin(angle);
        let direction = axis.into_inner() * libm::cos(half_angle) + side * libm::sin(half_angle);
        out.push(Unit::new_normalize(direction));
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use robotc_core::geom::box_part;

    #[test]
    fn samples_lie_on_the_surface_at_the_asked_spacing() {
        let mesh = box_part(Vector3::new(0.1, 0.2, 0.3)).mesh();
        let points = sample(&mesh, 0.01);
        let area = 2.0 * (0.1 * 0.2 + 0.2 * 0.3 + 0.1 * 0.3);
        let expected = area / (0.01 * 0.01);
        assert!(
            points.len() as f64 > 0.6 * expected && (points.len() as f64) < 2.0 * expected,
            "{}",
            points.len()
        );
        for p in &points {
            let outside = [0.05, 0.1, 0.15].iter().enumerate().map(|(k, half)| p.point[k].abs() - half);
            assert!(outside.fold(f64::NEG_INFINITY, f64::max).abs() < 1e-12);
        }
    }

    #[test]
    fn cubes_hold_every_point_once() {
        let mesh = box_part(Vector3::new(0.1, 0.2, 0.3)).mesh();
        let surface = Surface::new(&mesh, 0.01);
        assert_eq!(surface.of_cubes(|_, _| true).count(), sample(&mesh, 0.01).len());
        let place = Point3::new(0.05, 0.03, 0.1);
        let near = |p: &&SurfacePoint| (p.point - place).norm() < 0.02;
        let found =
            surface.of_cubes(|centre, radius| (centre - place).norm() < radius + 0.02).filter(near).count();
        assert_eq!(found, surface.points().iter().filter(near).count());
        assert!(found > 5);
    }

    #[test]
    fn approaches_point_into_the_object() {
        let mesh = box_part(Vector3::new(0.1, 0.1, 0.1)).mesh();
        let options = ApproachOptions {
            spacing: 0.025,
            rolls: 4,
            directions: 5,
            cone: 0.3,
            standoffs: vec![0.0, 0.01],
            rays: vec![Vector3::zeros()],
            preshapes: 1,
            most: 10_000,
        };
        let draw =
            |options: &ApproachOptions| approaches(&mesh, &MeshIndex::new(&mesh), options, Seed::new(1));
        let all = draw(&options);
        assert_eq!(all.len(), 6 * 16 * 5 * 4 * 2);
        assert_eq!(draw(&ApproachOptions { most: 100, ..options.clone() }).len(), 100);
        for a in &all {
            assert!(a.direction_in_object.dot(&a.target_in_object.coords) < 0.0);
        }
    }
}
