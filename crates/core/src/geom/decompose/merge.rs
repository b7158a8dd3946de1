//! Joining neighbouring pieces again whose common hull is still close to the solid.

use std::collections::BTreeMap;

use super::super::hull::Hull;
use super::super::{Aabb, HullError};
use super::Measured;
use super::concavity::Solid;

/// Joins pairs of pieces, the one that adds the least volume first, while the hull of the pair stays within
/// its tolerance of the solid.
///
/// A pair that was refused covers some place too far from the solid. So does every pair of pieces made of those two,
/// which is therefore not looked at.
pub(super) fn join(pieces: Vec<Measured>, solid: &Solid) -> Result<Vec<Measured>, HullError> {
    let tolerance = solid.tolerance();
    let mut next_id = pieces.len();
    let mut live: Vec<(usize, Measured)> = pieces.into_iter().enumerate().collect();
    let mut refused: BTreeMap<[usize; 2], f64> = BTreeMap::new();
    let mut pairs: Vec<Pair> = Vec::new();
    for (j, b) in live.iter().enumerate() {
        for a in &live[..j] {
            pairs.extend(Pair::of(a, b, tolerance)?);
        }
    }
    loop {
        let first = |a: &usize, b: &usize| {
            let (a, b) = (&pairs[*a], &pairs[*b]);
            a.added.total_cmp(&b.added).then(a.ids.cmp(&b.ids))
        };
        let Some(best) = (0..pairs.len()).min_by(first) else { break };
        let Pair { ids, hull, volume, limit: most, .. } = pairs.swap_remove(best);
        let concavity = solid.farthest(&hull, most);
        if concavity > most {
            refused.insert(ids, concavity);
            continue;
        }
        pairs.retain(|p| !p.ids.iter().any(|id| ids.contains(id)));
        let [a, b] = ids.map(|id| {
            let at = live.iter().position(|(live, _)| *live == id).expect("a pair refers to live pieces");
            live.remove(at).1
        });
        let joined = (next_id, Measured { piece: a.piece.joined(&b.piece), hull, concavity, volume });
        for other in &live {
            let known = ids.iter().filter_map(|&id| refused.get(&[id.min(other.0), id.max(other.0)]));
            let known = known.fold(0.0, |a: f64, b| a.max(*b));
            if known > limit(&other.1, &joined.1, tolerance) {
                refused.insert([other.0, next_id], known);
            } else {
                pairs.extend(Pair::of(other, &joined, tolerance)?);
            }
        }
        live.push(joined);
        next_id += 1;
    }
    Ok(live.into_iter().map(|(_, piece)| piece).collect())
}

/// How far the common hull of two pieces may stand off the solid.
fn limit(a: &Measured, b: &Measured, tolerance: f64) -> f64 {
    tolerance.max(a.concavity).max(b.concavity)
}

/// Two pieces that may become one.
struct Pair {
    /// Numbers of the pieces, lower first.
    ids: [usize; 2],
    /// Volume that the common hull has beyond the hulls of the two.
    added: f64,
    hull: Hull,
    volume: f64,
    /// How far the common hull may stand off the solid.
    limit: f64,
}

impl Pair {
    /// The pair, unless the pieces are apart.
    fn of(
        (id_a, a): &(usize, Measured),
        (id_b, b): &(usize, Measured),
        tolerance: f64,
    ) -> Result<Option<Self>, HullError> {
        let bounds = |m: &Measured| Aabb::of_points(&m.hull.points).expect("a hull has points");
        if !bounds(a).padded(tolerance).intersects(&bounds(b)) {
            return Ok(None);
        }
        let corners: Vec<_> = a.hull.points.iter().chain(&b.hull.points).copied().collect();
        let hull = super::convex_hull(&corners)?;
        let volume = hull.volume();
        let added = volume - a.volume - b.volume;
        Ok(Some(Self { ids: [*id_a, *id_b], added, hull, volume, limit: limit(a, b, tolerance) }))
    }
}
