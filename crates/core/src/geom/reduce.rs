//! Polytopes with few corners around point sets with many.
//!
//! Edges of the hull are contracted to one corner each, the cheapest first. The new corner lies above all faces around the
//! edge, so that nothing is ever left outside, and is the one of those that adds the least volume: a linear program in
//! three variables (progressive hulls: Sander, Gu, Gortler, Hoppe, Snyder, "Silhouette clipping", 2000).

use nalgebra::{Matrix3, Point3, Rotation3, Vector3};

use super::hull::{Hull, convex_hull, facet_normal, grow_to_cover};
use super::{Aabb, ConvexPart, HullError};

/// Hulls with more corners than this are thinned first.
const MOST_CORNERS: usize = 1500;
/// Rounding of heights, as a fraction of the size.
const SLACK: f64 = 1e-10;
/// No new corner is farther from its edge, in sizes.
const FAR: f64 = 10.0;
/// Steps of a linear program before it is given up; a dozen are usual.
const MOST_PIVOTS: usize = 100;
/// Shares of a normal in others below this are rounding.
const TINY: f64 = 1e-12;

/// A convex part with at most `limit` corners (8 or more) that contains all `points`: their hull when that is small enough,
/// else a polytope around it.
pub(super) fn part_with_at_most(limit: usize, points: &[Point3<f64>]) -> Result<ConvexPart, HullError> {
    let hull = convex_hull(points)?;
    if hull.points.len() <= limit {
        return Ok(ConvexPart::from_hull(hull));
    }
    let coords: Vec<Vector3<f64>> = hull.points.iter().map(|p| p.coords).collect();
    let mut small = thinned(hull, MOST_CORNERS)?;
    while small.points.len() > limit {
        let fewer = convex_hull(&contracted(&small, limit))?;
        if fewer.points.len() >= small.points.len() {
            small = thinned(small, limit)?;
            break;
        }
        small = fewer;
    }
    grow_to_cover(&mut small, &coords);
    Ok(ConvexPart::from_hull(small))
}

/// The plane of a triangle of a hull.
struct Facet {
    corners: [u32; 3],
    normal: Vector3<f64>,
    offset: f64,
    area: f64,
}

/// An edge that could become one corner.
struct Contraction {
    edge: [u32; 2],
    corner: Point3<f64>,
    cost: f64,
}

/// The corners after one round: the cheapest contractions, none beside another, and never fewer than `limit` are left.
fn contracted(hull: &Hull, limit: usize) -> Vec<Point3<f64>> {
    let size = Aabb::of_points(&hull.points).map_or(0.0, |bounds| bounds.diagonal());
    let facets: Vec<Facet> = hull.triangles.iter().filter_map(|t| facet(hull, t)).collect();
    let mut around: Vec<Vec<usize>> = vec![Vec::new(); hull.points.len()];
    for (i, facet) in facets.iter().enumerate() {
        facet.corners.iter().for_each(|&v| around[v as usize].push(i));
    }
    let edges = hull.triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]).filter(|[a, b]| a < b);
    let mut found: Vec<Contraction> =
        edges.filter_map(|edge| contraction(hull, &facets, &around, size, edge)).collect();
    found.sort_by(|a, b| a.cost.total_cmp(&b.cost).then(a.edge.cmp(&b.edge)));

    // Only the cheapest, and a quarter of the way at most: costs change with every contraction nearby.
    found.truncate(found.len().div_ceil(4));
    let most = (hull.points.len() - limit).div_ceil(4);
    let mut touched = vec![false; hull.points.len()];
    let mut gone = vec![false; hull.points.len()];
    let mut points = Vec::new();
    for Contraction { edge, corner, .. } in found {
        if points.len() == most {
            break;
        }
        if edge.iter().any(|&v| touched[v as usize]) {
            continue;
        }
        for v in edge {
            gone[v as usize] = true;
            around[v as usize]
                .iter()
                .flat_map(|&f| facets[f].corners)
                .for_each(|n| touched[n as usize] = true);
        }
        points.push(corner);
    }
    points.extend(hull.points.iter().zip(gone).filter(|(_, gone)| !gone).map(|(p, _)| *p));
    points
}

fn facet(hull: &Hull, &corners: &[u32; 3]) -> Option<Facet> {
    let normal = facet_normal(&hull.points, &corners)?;
    let [a, b, c] = corners.map(|v| hull.points[v as usize]);
    let area = 0.5 * (b - a).cross(&(c - a)).norm();
    Some(Facet { corners, normal, offset: normal.dot(&a.coords), area })
}

/// The corner that takes the place of an edge, and the volume that it adds. The cube of the way that it goes is added, which
/// is nothing for blunt edges and keeps needles from growing longer.
fn contraction(
    hull: &Hull,
    facets: &[Facet],
    around: &[Vec<usize>],
    size: f64,
    edge: [u32; 2],
) -> Option<Contraction> {
    let [a, b] = edge.map(|v| hull.points[v as usize]);
    let middle = nalgebra::center(&a, &b);
    let mut beside: Vec<usize> = edge.iter().flat_map(|&v| &around[v as usize]).copied().collect();
    beside.sort_unstable();
    beside.dedup();
    // Heights are counted from the middle of the edge, where they are small.
    let plane = |f: &Facet| (f.normal, f.offset - f.normal.dot(&middle.coords));
    let planes: Vec<(Vector3<f64>, f64)> = beside.iter().map(|&f| plane(&facets[f])).collect();
    let growth = beside.iter().map(|&f| facets[f].normal * facets[f].area).sum();
    let corner = middle + lowest_above(&planes, &growth, FAR * size, SLACK * size)?;
    let mut ring: Vec<u32> = beside.iter().flat_map(|&f| facets[f].corners).collect();
    ring.sort_unstable();
    ring.dedup();
    let added = |f: &usize| {
        let f = &facets[*f];
        (f.normal.dot(&corner.coords) - f.offset).max(0.0) * f.area / 3.0
    };
    // Few faces are below the corner; each counts once, in the order of their numbers.
    let all = ring.iter().flat_map(|&v| &around[v as usize]).copied();
    let mut below: Vec<usize> = all.filter(|f| added(f) > 0.0).collect();
    below.sort_unstable();
    below.dedup();
    let volume: f64 = below.iter().map(added).sum();
    let way = (corner - a).norm().min((corner - b).norm()).min((corner - middle).norm());
    Some(Contraction { edge, corner, cost: volume + way.powi(3) })
}

/// The point with the least `growth . p` that is on or above all planes `(n, d)`, `n . p >= d - slack`; `None` when there is none.
///
/// A dual simplex: three planes meet at a point that nothing above them is better than. While a plane is violated it takes
/// the place of one of them. The first three are far below, so far that none of them is left in the end.
fn lowest_above(
    planes: &[(Vector3<f64>, f64)],
    growth: &Vector3<f64>,
    far: f64,
    slack: f64,
) -> Option<Vector3<f64>> {
    let up = growth.try_normalize(f64::MIN_POSITIVE)?;
    let turn = Rotation3::rotation_between(&Vector3::repeat(1.0), &up)
        .unwrap_or_else(|| Rotation3::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI));
    // Rows: normals of the three planes.
    let mut normals = turn.matrix().transpose();
    let mut offsets = Vector3::repeat(-far);
    for _ in 0..MOST_PIVOTS {
        let inverse = normals.try_inverse()?;
        let point = inverse * offsets;
        let below = planes.iter().map(|(n, d)| d - n.dot(&point));
        let (worst, depth) = below.enumerate().max_by(|a, b| a.1.total_cmp(&b.1).then(b.0.cmp(&a.0)))?;
        if depth <= slack {
            return (point.norm() < far).then_some(point);
        }
        let (normal, offset) = planes[worst];
        let weights = inverse.tr_mul(&up);
        let shares = inverse.tr_mul(&normal);
        let ratio = |i: &usize| weights[*i].max(0.0) / shares[*i];
        let leaving = (0..3).filter(|&i| shares[i] > TINY).min_by(|a, b| ratio(a).total_cmp(&ratio(b)))?;
        normals.set_row(leaving, &normal.transpose());
        offsets[leaving] = offset;
    }
    None
}

/// The hull of at most `count` of its corners, those farthest in evenly spread directions, grown until it contains the others. The
/// directions are even in axes in which the hull is as long as it is wide, so that thin hulls do not grow thick.
fn thinned(hull: Hull, count: usize) -> Result<Hull, HullError> {
    if hull.points.len() <= count {
        return Ok(hull);
    }
    let n = hull.points.len() as f64;
    let coords: Vec<Vector3<f64>> = hull.points.iter().map(|p| p.coords).collect();
    let mean = coords.iter().sum::<Vector3<f64>>() / n;
    let spread = coords.iter().fold(Matrix3::zeros(), |sum, p| sum + (p - mean) * (p - mean).transpose() / n);
    let axes = spread.symmetric_eigen();
    let largest = axes.eigenvalues.max();
    let lengths = axes.eigenvalues.map(|x| x.max(largest * 1e-12).sqrt());
    let mut chosen: Vec<usize> = (0..count)
        .map(|i| {
            let even = spiral(i, count).component_div(&lengths);
            let direction = axes.eigenvectors * even;
            let farther =
                |a: usize, b: usize| if direction.dot(&(coords[b] - coords[a])) > 0.0 { b } else { a };
            (0..coords.len()).reduce(farther).expect("a hull has corners")
        })
        .collect();
    chosen.sort_unstable();
    chosen.dedup();
    let chosen: Vec<Point3<f64>> = chosen.into_iter().map(|i| hull.points[i]).collect();
    let mut small = convex_hull(&chosen)?;
    grow_to_cover(&mut small, &coords);
    Ok(small)
}

/// Direction `i` of `count` that are spread evenly, on a spiral from pole to pole.
fn spiral(i: usize, count: usize) -> Vector3<f64> {
    const GOLDEN_ANGLE: f64 = 2.399_963_229_728_653;
    let z = 1.0 - (2 * i + 1) as f64 / count as f64;
    let radius = (1.0 - z * z).sqrt();
    let angle = GOLDEN_ANGLE * i as f64;
    Vector3::new(radius * libm::cos(angle), radius * libm::sin(angle), z)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::Seed;

    /// Points of a surface around the origin, the volume inside it, and how much more a cover with 32 corners may have.
    fn solids() -> Vec<(&'static str, Vec<Point3<f64>>, f64, f64)> {
        let ring = |n: usize, radius: f64, z: f64| {
            (0..n).map(move |i| {
                let angle = std::f64::consts::TAU * i as f64 / n as f64;
                Point3::new(radius * libm::cos(angle), radius * libm::sin(angle), z)
            })
        };
        let can = [-0.06, 0.06].into_iter().flat_map(|z| ring(96, 0.033, z)).collect();
        let plate = [-1e-4, 1e-4].into_iter().flat_map(|z| ring(96, 0.1, z)).collect();
        let cone = ring(96, 0.05, 0.0).chain([Point3::new(0.0, 0.0, 0.1)]).collect();
        let mut rng = Seed::new(1).rng();
        let ball = (0..3000).map(|_| Point3::from(rng.direction().into_inner() * 0.1)).collect();
        let needle = (0..3000).map(|_| {
            let d = rng.direction().into_inner() * 0.1;
            Point3::new(d.x, d.y * 0.02, d.z * 0.02)
        });
        let needle = needle.collect();
        let pi = std::f64::consts::PI;
        let ball_volume = 4.0 / 3.0 * pi * 1e-3;
        vec![
            ("can", can, pi * 0.033 * 0.033 * 0.12, 0.02),
            ("plate", plate, pi * 0.1 * 0.1 * 2e-4, 0.02),
            ("cone", cone, pi * 0.05 * 0.05 * 0.1 / 3.0, 0.03),
            ("ball", ball, ball_volume, 0.22),
            ("needle", needle, ball_volume * 4e-4, 0.22),
        ]
    }

    #[test]
    fn few_corners_cover_round_solids_tightly() {
        for (name, points, volume, most) in solids() {
            let part = part_with_at_most(32, &points).unwrap();
            assert!(part.points().len() <= 32, "{name}");
            let size = Aabb::of_points(&points).unwrap().diagonal();
            for p in &points {
                assert!(part.height(p) <= 1e-9 * size, "{name}: {p} is outside");
            }
            let more = part.volume() / volume - 1.0;
            assert!(more < most, "{name}: {more:.3} more volume");
            let longer = Aabb::of_points(part.points()).unwrap().diagonal() / size - 1.0;
            assert!(longer < 0.15, "{name}: longer by {longer:.3}");
        }
    }

    #[test]
    fn sharp_solids_keep_their_corners() {
        // A box whose faces are full of points is still a box.
        let mut rng = Seed::new(2).rng();
        let points: Vec<Point3<f64>> = (0..2000)
            .map(|i| {
                let mut p = Vector3::from_fn(|_, _| rng.range(-1.0, 1.0));
                p[i % 3] = p[i % 3].signum();
                if i < 8 {
                    p = Vector3::new(i & 1, i >> 1 & 1, i >> 2).map(|k| 2.0 * k as f64 - 1.0);
                }
                Point3::from(p.component_mul(&Vector3::new(0.1, 0.2, 0.02)))
            })
            .collect();
        let part = part_with_at_most(8, &points).unwrap();
        assert!((part.volume() / (8.0 * 0.1 * 0.2 * 0.02) - 1.0).abs() < 1e-6, "{}", part.volume());
    }
}
