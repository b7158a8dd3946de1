//! The volume of the hull of a few points, fast.

use nalgebra::{Point3, Vector3};

struct Face {
    corners: [u32; 3],
    normal: Vector3<f64>,
    offset: f64,
}

/// Volume of the convex hull of a few dozen points: faces are rebuilt as each point is added. Good for comparing; points
/// within rounding of a face count as inside.
pub(super) fn hull_volume(points: &[Point3<f64>]) -> f64 {
    let Some(mut faces) = first_tetrahedron(points) else { return 0.0 };
    let mut horizon: Vec<(u32, u32)> = Vec::new();
    let scale = points.iter().map(|p| (p - points[0]).norm()).fold(0.0, f64::max);
    let tolerance = 1e-10 * scale;
    for (i, point) in points.iter().enumerate() {
        horizon.clear();
        let mut k = 0;
        while k < faces.len() {
            if faces[k].normal.dot(&point.coords) - faces[k].offset > tolerance {
                let [a, b, c] = faces.swap_remove(k).corners;
                for edge in [(a, b), (b, c), (c, a)] {
                    match horizon.iter().position(|&(x, y)| (y, x) == edge) {
                        Some(at) => drop(horizon.swap_remove(at)),
                        None => horizon.push(edge),
                    }
                }
            } else {
                k += 1;
            }
        }
        for &(a, b) in &horizon {
            faces.push(face(points, [a, b, i as u32]));
        }
    }
    let origin = points[0];
    let six_fold: f64 = faces
        .iter()
        .map(|f| {
            let [a, b, c] = f.corners.map(|v| points[v as usize] - origin);
            a.cross(&b).dot(&c)
        })
        .sum();
    six_fold / 6.0
}

fn face(points: &[Point3<f64>], corners: [u32; 3]) -> Face {
    let [a, b, c] = corners.map(|v| points[v as usize]);
    let normal = (b - a).cross(&(c - a)).try_normalize(0.0).unwrap_or_else(Vector3::zeros);
    Face { corners, normal, offset: normal.dot(&a.coords) }
}

/// Four points that span space, as outward faces; `None` when all lie in a plane.
fn first_tetrahedron(points: &[Point3<f64>]) -> Option<Vec<Face>> {
    let a = *points.first()?;
    let farthest = |measure: &dyn Fn(&Point3<f64>) -> f64| {
        let best = (0..points.len()).max_by(|&i, &j| measure(&points[i]).total_cmp(&measure(&points[j])))?;
        Some((best, measure(&points[best])))
    };
    let (ib, length) = farthest(&|p| (p - a).norm())?;
    let ab = points[ib] - a;
    let (ic, area) = farthest(&|p| ab.cross(&(p - a)).norm())?;
    let normal = ab.cross(&(points[ic] - a));
    let (id, height) = farthest(&|p| normal.dot(&(p - a)).abs())?;
    if length <= 0.0 || area <= 0.0 || height <= 1e-12 * length * length * length {
        return None;
    }
    let above = normal.dot(&(points[id] - a)) > 0.0;
    let (b, c) = if above { (ic as u32, ib as u32) } else { (ib as u32, ic as u32) };
    let d = id as u32;
    Some([[0, b, c], [0, c, d], [c, b, d], [b, 0, d]].map(|corners| face(points, corners)).into())
}

#[cfg(test)]
mod tests {
    use super::super::ConvexPart;
    use super::*;
    use crate::rng::Seed;

    #[test]
    fn volumes_agree_with_the_full_hull() {
        let mut rng = Seed::new(2).rng();
        for case in 0..200 {
            let n = 4 + rng.below(60);
            let mut points: Vec<_> = (0..n)
                .map(|_| Point3::new(rng.range(0.0, 1.0), rng.range(0.0, 2.0), rng.range(5.0, 6.0)))
                .collect();
            if case % 3 == 0 {
                points.iter_mut().for_each(|p| p.coords = p.coords.map(|x| (x * 4.0).round() / 4.0));
            }
            let expected = ConvexPart::hull_of(&points).expect("finite").volume();
            assert!((hull_volume(&points) - expected).abs() < 1e-4, "{case}");
        }
        assert_eq!(hull_volume(&[]), 0.0);
        assert_eq!(hull_volume(&[Point3::origin(); 5]), 0.0);
    }
}
