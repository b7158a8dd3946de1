//! Joining neighbouring pieces again whose common hull is still close to the solid.

use super::super::hull::Hull;
use super::super::{Aabb, HullError};
use super::Measured;
use super::concavity::Solid;

/// Joins pairs of pieces, the one that adds the least volume first, while the hull of the pair stays within
/// `tolerance` of the solid.
pub(super) fn join(
    mut pieces: Vec<Measured>,
    solid: &Solid,
    tolerance: f64,
) -> Result<Vec<Measured>, HullError> {
    let mut pairs: Vec<Pair> = Vec::new();
    let mut next_id = pieces.len();
    let mut ids: Vec<usize> = (0..pieces.len()).collect();
    for j in 1..pieces.len() {
        for i in 0..j {
            pairs.extend(Pair::of(&pieces[i], &pieces[j], [ids[i], ids[j]], solid, tolerance)?);
        }
    }
    loop {
        let order = |a: &usize, b: &usize| {
            let (a, b) = (&pairs[*a], &pairs[*b]);
            a.added.total_cmp(&b.added).then(a.ids.cmp(&b.ids))
        };
        let Some(best) = (0..pairs.len()).min_by(order) else { break };
        let Pair { ids: both, hull, concavity, volume, .. } = pairs.swap_remove(best);
        pairs.retain(|p| !p.ids.iter().any(|id| both.contains(id)));
        let [first, second] = both.map(|id| {
            let at = ids.iter().position(|&x| x == id).expect("a pair refers to live pieces");
            ids.remove(at);
            pieces.remove(at)
        });
        let joined = Measured { piece: first.piece.joined(&second.piece), hull, concavity, volume };
        for (piece, &id) in pieces.iter().zip(&ids) {
            pairs.extend(Pair::of(piece, &joined, [id, next_id], solid, tolerance)?);
        }
        ids.push(next_id);
        pieces.push(joined);
        next_id += 1;
    }
    Ok(pieces)
}

/// Two pieces that may become one.
struct Pair {
    ids: [usize; 2],
    added: f64,
    hull: Hull,
    concavity: f64,
    volume: f64,
}

impl Pair {
    fn of(
        a: &Measured,
        b: &Measured,
        ids: [usize; 2],
        solid: &Solid,
        tolerance: f64,
    ) -> Result<Option<Self>, HullError> {
        let bounds = |m: &Measured| Aabb::of_points(&m.hull.points).expect("a hull has points");
        if !bounds(a).padded(tolerance).intersects(&bounds(b)) {
            return Ok(None);
        }
        // The hulls stand for the pieces until the join is made: their corners are all that counts.
        let corners: Vec<_> = a.hull.points.iter().chain(&b.hull.points).copied().collect();
        let hull = super::convex_hull(&corners)?;
        let limit = tolerance.max(a.concavity).max(b.concavity);
        let concavity = solid.farthest(&hull, tolerance, limit);
        if concavity > limit {
            return Ok(None);
        }
        let volume = hull.volume();
        let added = volume - a.volume - b.volume;
        Ok(Some(Self { ids, added, hull, concavity, volume }))
    }
}
