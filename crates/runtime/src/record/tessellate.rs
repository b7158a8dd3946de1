//! Primitive shapes as surfaces with smooth normals.

use nalgebra::{Point3, Vector3};

use super::Surface;

/// Segments of a full circle.
const ROUND: usize = 48;
/// Rings from pole to equator.
const QUARTER: usize = 12;

/// A box with full edge lengths, centred. Its edges are broken by a small bevel, which is what catches the light.
pub(super) fn cuboid(size: [f64; 3]) -> Surface {
    let half = Vector3::from(size) / 2.0;
    let bevel = (0.04 * half.min()).min(0.003);
    let inner = half.add_scalar(-bevel);
    let mut surface = Surface::default();
    for axis in 0..3 {
        for sign in [-1.0, 1.0] {
            face(&mut surface, &half, &inner, axis, sign);
        }
    }
    for axis in 0..3 {
        for (s, t) in [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)] {
            edge(&mut surface, &half, &inner, axis, s, t);
        }
    }
    for i in 0..8 {
        let sign = |axis: usize| if i >> axis & 1 == 1 { 1.0 } else { -1.0 };
        corner(&mut surface, &half, &inner, Vector3::new(sign(0), sign(1), sign(2)));
    }
    surface
}

/// The corner of the box of signs `signs` as seen from the face of `axis`: at full extent along it, inset across.
fn rim(half: &Vector3<f64>, inner: &Vector3<f64>, axis: usize, signs: &Vector3<f64>) -> Point3<f64> {
    let mut p = inner.component_mul(signs);
    p[axis] = half[axis] * signs[axis];
    Point3::from(p)
}

fn axis_normal(axis: usize, sign: f64) -> Vector3<f64> {
    let mut n = Vector3::zeros();
    n[axis] = sign;
    n
}

fn face(surface: &mut Surface, half: &Vector3<f64>, inner: &Vector3<f64>, axis: usize, sign: f64) {
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    let ring = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(a, b)| {
        let mut signs = Vector3::zeros();
        (signs[axis], signs[u], signs[v]) = (sign, a, b);
        surface.push_vertex(&rim(half, inner, axis, &signs), &axis_normal(axis, sign))
    });
    fan(surface, &ring, sign < 0.0);
}

/// The bevel along `axis`, between the faces of sign `s` and `t` of the two other axes.
fn edge(surface: &mut Surface, half: &Vector3<f64>, inner: &Vector3<f64>, axis: usize, s: f64, t: f64) {
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    let ring = [(-1.0, u), (-1.0, v), (1.0, v), (1.0, u)].map(|(along, of_face)| {
        let mut signs = Vector3::zeros();
        (signs[axis], signs[u], signs[v]) = (along, s, t);
        let normal = axis_normal(of_face, if of_face == u { s } else { t });
        surface.push_vertex(&rim(half, inner, of_face, &signs), &normal)
    });
    fan(surface, &ring, s * t < 0.0);
}

fn corner(surface: &mut Surface, half: &Vector3<f64>, inner: &Vector3<f64>, signs: Vector3<f64>) {
    let ring = [0, 1, 2]
        .map(|axis| surface.push_vertex(&rim(half, inner, axis, &signs), &axis_normal(axis, signs[axis])));
    fan(surface, &ring, signs.product() < 0.0);
}

/// Triangles of a convex ring of vertices, turned when `flipped`.
fn fan(surface: &mut Surface, ring: &[u32], flipped: bool) {
    for pair in ring[1..].windows(2) {
        let (b, c) = if flipped { (pair[1], pair[0]) } else { (pair[0], pair[1]) };
        surface.triangles.push([ring[0], b, c]);
    }
}

/// A cylinder along z, centred, with flat ends.
pub(super) fn cylinder(radius: f64, length: f64) -> Surface {
    let half = length / 2.0;
    let bevel = (0.06 * radius.min(half)).min(0.003);
    revolve(&[
        ((0.0, half), (0.0, 1.0)),
        ((radius - bevel, half), (0.0, 1.0)),
        ((radius, half - bevel), (1.0, 0.0)),
        ((radius, bevel - half), (1.0, 0.0)),
        ((radius - bevel, -half), (0.0, -1.0)),
        ((0.0, -half), (0.0, -1.0)),
    ])
}

/// A sphere, centred.
pub(super) fn sphere(radius: f64) -> Surface {
    capsule(radius, 0.0)
}

/// A cylinder along z with half spheres at its ends, centred; `length` without the caps.
pub(super) fn capsule(radius: f64, length: f64) -> Surface {
    let cap = |ring: usize, height: f64| {
        let angle = std::f64::consts::FRAC_PI_2 * ring as f64 / QUARTER as f64;
        let (s, c) = libm::sincos(angle);
        ((radius * s, height + radius * c), (s, c))
    };
    let half = length / 2.0;
    let top = (0..=QUARTER).map(|ring| cap(ring, half));
    let bottom = (QUARTER..=2 * QUARTER).map(|ring| cap(ring, -half));
    let skip = usize::from(length == 0.0);
    revolve(&top.chain(bottom.skip(skip)).collect::<Vec<_>>())
}

/// The surface that a profile sweeps about z: pairs of (radius, z) and the normal there, from the top down.
fn revolve(profile: &[((f64, f64), (f64, f64))]) -> Surface {
    let mut surface = Surface::default();
    for step in 0..=ROUND {
        // The seam is met exactly, so that the surface closes.
        let angle = std::f64::consts::TAU * (step % ROUND) as f64 / ROUND as f64;
        let (sin, cos) = libm::sincos(angle);
        for &((r, z), (across, up)) in profile {
            let normal = Vector3::new(across * cos, across * sin, up);
            surface.push_vertex(&Point3::new(r * cos, r * sin, z), &normal);
        }
    }
    let rows = profile.len() as u32;
    for step in 0..ROUND as u32 {
        for row in 0..rows - 1 {
            let here = step * rows + row;
            let next = here + rows;
            let (top_r, bottom_r) = (profile[row as usize].0.0, profile[row as usize + 1].0.0);
            if bottom_r > 1e-12 * top_r.max(1.0) {
                surface.triangles.push([here, here + 1, next + 1]);
            }
            if top_r > 1e-12 * bottom_r.max(1.0) {
                surface.triangles.push([here, next + 1, next]);
            }
        }
    }
    surface
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wide(p: [f32; 3]) -> Vector3<f64> {
        Vector3::from(p.map(f64::from))
    }

    /// Volume enclosed by a surface: the sum of signed tetrahedra to the origin. Wrong when a face is turned.
    fn volume(surface: &Surface) -> f64 {
        let signed = surface.triangles.iter().map(|t| {
            let [a, b, c] = t.map(|v| wide(surface.positions[v as usize]));
            a.dot(&b.cross(&c)) / 6.0
        });
        signed.sum()
    }

    #[test]
    fn primitives_enclose_about_their_volume_and_face_outwards() {
        use std::f64::consts::PI;
        let cases = [
            ("box", cuboid([0.2, 0.3, 0.5]), 0.03),
            ("flat box", cuboid([1.0, 1.5, 0.01]), 0.015),
            ("cylinder", cylinder(0.1, 0.4), PI * 0.004),
            ("sphere", sphere(0.2), PI * 0.032 / 3.0),
            ("capsule", capsule(0.1, 0.3), PI * (0.003 + 0.004 / 3.0)),
        ];
        for (name, surface, expected) in cases {
            let found = volume(&surface);
            assert!((found / expected - 1.0).abs() < 0.02, "{name}: {found} for {expected}");
            for t in &surface.triangles {
                let [a, b, c] = t.map(|v| wide(surface.positions[v as usize]));
                let across = (b - a).cross(&(c - a));
                assert!(across.norm() > 0.0, "{name}: a face without area");
                for v in t {
                    assert!(
                        across.dot(&wide(surface.normals[*v as usize])) > 0.0,
                        "{name}: a normal points inwards"
                    );
                }
            }
        }
    }

    #[test]
    fn extents_are_exact() {
        assert_eq!(cuboid([0.5, 1.0, 2.0]).bounds(), Some(([-0.25, -0.5, -1.0], [0.25, 0.5, 1.0])));
        let (low, high) = cylinder(0.5, 2.0).bounds().expect("it has vertices");
        assert_eq!((low[2], high[2]), (-1.0, 1.0));
        assert!((high[0] - 0.5).abs() < 1e-7);
    }
}
