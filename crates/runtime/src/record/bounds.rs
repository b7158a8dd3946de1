//! Extents.

use nalgebra::Point3;

use super::{Group, Recording};

/// An axis-aligned box in the world, metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    /// Lowest corner.
    pub low: Point3<f64>,
    /// Highest corner.
    pub high: Point3<f64>,
}

impl Bounds {
    /// The eight corners; the x of the high corner comes with bit 0 of the position, y with bit 1, z with bit 2.
    pub fn corners(&self) -> [Point3<f64>; 8] {
        std::array::from_fn(|i| {
            let pick = |axis: usize| if i >> axis & 1 == 1 { self.high[axis] } else { self.low[axis] };
            Point3::new(pick(0), pick(1), pick(2))
        })
    }

    /// Middle.
    pub fn centre(&self) -> Point3<f64> {
        nalgebra::center(&self.low, &self.high)
    }

    /// Length of the diagonal.
    pub fn diagonal(&self) -> f64 {
        (self.high - self.low).norm()
    }

    /// The smallest box around both.
    pub fn join(&self, other: &Self) -> Self {
        Self { low: self.low.inf(&other.low), high: self.high.sup(&other.high) }
    }

    /// The smallest box around points; `None` for none.
    pub fn around(points: impl IntoIterator<Item = Point3<f64>>) -> Option<Self> {
        points.into_iter().map(|p| Self { low: p, high: p }).reduce(|a, b| a.join(&b))
    }
}

/// Extents of the nodes of a set of groups, each over the whole timeline.
pub(super) fn of_nodes(recording: &Recording, groups: &[Group]) -> Vec<Bounds> {
    let shown = recording.nodes().enumerate().filter(|(_, node)| groups.contains(&node.group));
    shown.filter_map(|(index, _)| of_node(recording, index)).collect()
}

/// Extent of a node's surfaces over the whole timeline, sampled where the node or an ancestor has a pose.
fn of_node(recording: &Recording, index: super::NodeIdx) -> Option<Bounds> {
    let node = &recording.nodes()[index];
    let corners_in_node: Vec<Point3<f64>> = node
        .parts
        .iter()
        .filter_map(|part| {
            let (low, high) = recording.surfaces()[part.surface].bounds()?;
            let wide = |p: [f32; 3]| Point3::from(p.map(f64::from));
            Some(Bounds { low: wide(low), high: wide(high) }.corners().map(|p| part.node_from_part * p))
        })
        .flatten()
        .collect();
    let mut times = vec![0.0];
    let mut at = Some(index);
    while let Some(ancestor) = at {
        times.extend(recording.nodes()[ancestor].track.samples().iter().map(|s| s.time));
        at = recording.nodes()[ancestor].parent;
    }
    Bounds::around(times.into_iter().flat_map(|time| {
        let world_from_node = recording.world_from_node(index, time);
        corners_in_node.iter().map(move |p| world_from_node * p)
    }))
}
