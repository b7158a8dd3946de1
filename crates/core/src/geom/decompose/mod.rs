//! Covering a mesh with convex parts (thesis section 4.1, convex decomposition of links and objects).
//!
//! The surface is cut by planes, piece by piece, until the hull of each piece stays close to the solid; pieces whose
//! common hull is close enough are then joined again. Cutting the surface itself, not voxels of it, has two
//! consequences: nothing of the surface is ever outside the parts, and the mesh need not be closed. Where it is
//! closed its inside is covered as well, for a solid cut by a plane lies in the hull of the surface on its side.

mod concavity;
mod cut;
mod merge;
mod outside;
mod piece;

use super::hull::convex_hull;
use super::reduce::part_with_at_most;
use super::{ConvexPart, ConvexParts, HullError};
use crate::model::TriMesh;
use concavity::Solid;
use piece::Piece;

/// How closely convex parts follow a mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DecomposeOptions {
    /// How far the hull of a part may stand off the solid before the part is cut, as a fraction of the diagonal of
    /// the mesh's bounding box, at least 0.01. Hollows and openings narrower than about twice this are filled, and so
    /// is what cannot be reached from outside.
    pub concavity: f64,
    /// Most parts; when reached, the hulls are what they are.
    pub max_parts: usize,
    /// Most corners of a part, at least 8. Rounder hulls are replaced by a slightly larger polytope with this many.
    pub max_vertices: usize,
}

impl Default for DecomposeOptions {
    fn default() -> Self {
        Self { concavity: 0.03, max_parts: 32, max_vertices: 32 }
    }
}

/// Smaller concavities are taken for this: cells of space are counted by its cube.
const MIN_CONCAVITY: f64 = 0.01;

/// Convex parts that together contain every vertex and every face of `mesh`, and its inside where it is closed.
///
/// One part when the mesh is convex to within the tolerance. The order of the parts follows from the mesh alone.
/// Fails without vertices, or when a coordinate is not a finite number; faces that refer to missing vertices are
/// left out.
pub fn decompose(mesh: &TriMesh, options: &DecomposeOptions) -> Result<ConvexParts, HullError> {
    let whole = Piece::new(mesh)?;
    let solid = Solid::new(&whole, options.concavity.max(MIN_CONCAVITY));
    let tolerance = solid.tolerance();
    let max_parts = options.max_parts.max(1);

    let mut open = vec![Measured::new(whole, &solid)?];
    let mut done: Vec<Measured> = Vec::new();
    while !open.is_empty() && open.len() + done.len() < max_parts {
        let worst = (0..open.len()).reduce(|a, b| if open[b].concavity > open[a].concavity { b } else { a });
        let worst = open.swap_remove(worst.expect("some piece is open"));
        if worst.concavity <= tolerance {
            done.push(worst);
            continue;
        }
        let halves = cut::best_plane(&worst.piece).and_then(|plane| worst.piece.cut(&plane));
        match halves {
            Some((low, high)) => {
                open.push(Measured::new(low, &solid)?);
                open.push(Measured::new(high, &solid)?);
            }
            None => done.push(worst),
        }
    }
    done.append(&mut open);
    let joined = merge::join(done, &solid)?;

    let mut parts: Vec<ConvexPart> = Vec::with_capacity(joined.len());
    for measured in &joined {
        parts.push(part_with_at_most(options.max_vertices.max(8), &measured.piece.vertices)?);
    }
    drop_redundant(&mut parts);
    Ok(ConvexParts::new(parts))
}

/// A piece with the hull it would become.
struct Measured {
    piece: Piece,
    hull: super::hull::Hull,
    concavity: f64,
    volume: f64,
}

impl Measured {
    fn new(piece: Piece, solid: &Solid) -> Result<Self, HullError> {
        let hull = convex_hull(&piece.vertices)?;
        let concavity = solid.farthest(&hull, f64::INFINITY);
        let volume = hull.volume();
        Ok(Self { piece, hull, concavity, volume })
    }
}

/// Removes parts that lie in another part.
fn drop_redundant(parts: &mut Vec<ConvexPart>) {
    let inside = |a: &ConvexPart, b: &ConvexPart| a.points().iter().all(|p| b.contains(p));
    let mut i = 0;
    while i < parts.len() {
        let covered = (0..parts.len()).any(|j| j != i && inside(&parts[i], &parts[j]));
        if covered {
            parts.remove(i);
        } else {
            i += 1;
        }
    }
}

#[cfg(test)]
mod tests;
