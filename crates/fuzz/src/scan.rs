//! What sensors measured: points and heights.

use std::sync::Arc;

use robotc_core::geom::{HeightField, Pile, PointCloud};
use robotc_core::scan;

/// Any bytes as points and as heights: an error, or numbers of which a solid is made or refused.
pub(crate) fn scan(bytes: &[u8]) {
    if let Ok(found) = scan::points(bytes) {
        assert!(!found.points.is_empty());
        assert!(found.points.iter().all(|p| p.iter().all(|x| x.is_finite())));
        if let Ok(cloud) = PointCloud::new(found.points, 0.01) {
            whole(&Pile::Cloud(Arc::new(cloud)));
        }
    }
    if let Ok(grid) = scan::grid(bytes) {
        assert!(grid.columns > 0 && grid.values.len().is_multiple_of(grid.columns));
        if let Ok(field) = HeightField::new(grid.columns, grid.values, [0.01, 0.02], None) {
            assert!(!field.mesh(1000).faces.is_empty());
            whole(&Pile::Field(Arc::new(field)));
        }
    }
}

/// Every lump is within the covers above it.
fn whole(pile: &Pile) {
    let bounds = pile.bounds().padded(1e-9 * (1.0 + pile.bounds().diagonal()));
    let mut lumps = 0;
    pile.walk(&bounds.centre(), |lump, leaf| {
        let within = lump.bounds();
        assert!(bounds.contains(&within.low) && bounds.contains(&within.high));
        lumps += usize::from(leaf);
        true
    });
    assert!(lumps > 0);
}
