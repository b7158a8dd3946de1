//! Polytopes with few corners around point sets with many.

use nalgebra::{Point3, Vector3};

use super::hull::{Hull, convex_hull, grow_to_cover};
use super::{ConvexPart, HullError};

/// Corners added at a time while the polytope grows towards the hull.
const BATCH: usize = 2;

/// A convex part with at most `limit` corners that contains all `points`: their hull when that is small enough, else
/// the hull of well-chosen points, grown about its middle until it covers the rest.
///
/// The points are chosen in axes in which the set is as long as it is wide, so that thin parts do not grow thick.
pub(super) fn part_with_at_most(limit: usize, points: &[Point3<f64>]) -> Result<ConvexPart, HullError> {
    let hull = convex_hull(points)?;
    if hull.points.len() <= limit {
        return Ok(ConvexPart::from_hull(hull));
    }
    let chosen = choose(&hull, limit)?;
    let mut small = convex_hull(&chosen)?;
    let coords: Vec<Vector3<f64>> = hull.points.iter().map(|p| p.coords).collect();
    grow_to_cover(&mut small, &coords);
    Ok(ConvexPart::from_hull(small))
}

/// Corners of the hull that leave as little of it outside as possible: start with the extremes along the axes, then add
/// whatever sticks out most.
fn choose(hull: &Hull, limit: usize) -> Result<Vec<Point3<f64>>, HullError> {
    let n = hull.points.len() as f64;
    let mean = hull.points.iter().map(|p| p.coords).sum::<Vector3<f64>>() / n;
    let covariance = hull.points.iter().fold(nalgebra::Matrix3::zeros(), |sum, p| {
        let d = p.coords - mean;
        sum + d * d.transpose() / n
    });
    let eigen = covariance.symmetric_eigen();
    let largest = eigen.eigenvalues.max();
    let round: Vec<Point3<f64>> = hull
        .points
        .iter()
        .map(|p| {
            let mut d = eigen.eigenvectors.tr_mul(&(p.coords - mean));
            for k in 0..3 {
                d[k] /= eigen.eigenvalues[k].max(largest * 1e-12).sqrt();
            }
            Point3::from(d)
        })
        .collect();
    let mut chosen: Vec<usize> = Vec::with_capacity(limit);
    let add = |chosen: &mut Vec<usize>, i: usize| {
        if !chosen.contains(&i) && chosen.len() < limit {
            chosen.push(i);
        }
    };
    for k in 0..3 {
        for sign in [1.0, -1.0] {
            let farthest = (0..round.len())
                .reduce(|a, b| if sign * round[b][k] > sign * round[a][k] { b } else { a })
                .expect("a hull has points");
            add(&mut chosen, farthest);
        }
    }
    while chosen.len() < limit {
        let corners: Vec<_> = chosen.iter().map(|&i| round[i]).collect();
        let part = ConvexPart::from_hull(convex_hull(&corners)?);
        let mut outside: Vec<(f64, usize)> = (0..round.len())
            .filter(|i| !chosen.contains(i))
            .map(|i| (part.height(&round[i]), i))
            .filter(|(height, _)| *height > 1e-9)
            .collect();
        outside.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        if outside.is_empty() {
            break;
        }
        for &(_, i) in outside.iter().take(BATCH) {
            add(&mut chosen, i);
        }
    }
    Ok(chosen.into_iter().map(|i| hull.points[i]).collect())
}
