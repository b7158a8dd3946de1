//! Ground, shelves of goods, anything that is seen from above: heights on a regular grid, as a solid.

use nalgebra::Point3;
use thiserror::Error;

use super::cloud::{above, below};
use super::{Aabb, Lump};
use crate::model::TriMesh;

/// Heights on a regular grid: the solid between them and a level floor. Metres, in the frame of whatever owns it.
///
/// The sample of row `r` and column `c` is at x = `c` times the spacing along x, y = `r` times that along y; its height is z. Four
/// neighbours are corners of a cell, which the diagonal from the first sample to the one a row and a column further on cuts into two
/// triangles; each stands on the floor as a prism. A height that is no number is not known: triangles with such a corner are left
/// out, so that there is a hole.
#[derive(Debug, Clone)]
pub struct HeightField {
    columns: usize,
    spacing: [f64; 2],
    floor: f64,
    /// Row by row.
    heights: Vec<f64>,
    steepest: f64,
    /// Cells, then blocks of two by two of them, and so on up to one that is all.
    levels: Vec<Level>,
}

/// Blocks of cells.
#[derive(Debug, Clone, PartialEq)]
struct Level {
    columns: usize,
    rows: usize,
    blocks: Vec<Block>,
}

/// A block of cells of a height field.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Block {
    /// Lowest x, y and highest x, y; rounded outwards.
    pub bounds: [f32; 4],
    /// Everything in it between the floor and here is solid; minus infinity where something is missing. Rounded down.
    pub lowest: f32,
    /// Nothing in it is higher; minus infinity where nothing is known. Rounded up.
    pub highest: f32,
}

/// What is not known is equal, too.
impl PartialEq for HeightField {
    fn eq(&self, other: &Self) -> bool {
        let bits = |field: &Self| field.heights.iter().map(|h| h.to_bits()).collect::<Vec<u64>>();
        (self.columns, self.spacing, self.floor) == (other.columns, other.spacing, other.floor)
            && bits(self) == bits(other)
    }
}

/// Why heights are not a height field.
#[derive(Debug, Clone, Copy, Error, PartialEq)]
pub enum HeightFieldError {
    /// There are no cells.
    #[error(
        "a height field of {0} by {1} samples; it needs at least two rows and two columns of the same length"
    )]
    Shape(usize, usize),
    /// There are too many samples.
    #[error("a height field of more than {most} samples", most = HeightField::MOST_SAMPLES)]
    TooMany,
    /// No triangle has three known corners.
    #[error("a height field without three heights that belong together")]
    Empty,
    /// A height is farther out than any place in a robot's world.
    #[error("sample {1} in row {0} is no height within {far} m", far = HeightField::FARTHEST)]
    Height(usize, usize),
    /// A distance of samples is not usable.
    #[error("the spacing of a height field has to be positive, and all of it within {far} m", far = HeightField::FARTHEST)]
    Spacing,
    /// The floor is not below all heights.
    #[error("the floor of a height field has to be below its lowest height, {0} m")]
    Floor(f64),
}

impl HeightField {
    /// Most samples of one field.
    pub const MOST_SAMPLES: usize = 1 << 24;

    /// Largest size of a coordinate, metres.
    pub const FARTHEST: f64 = 1e4;

    /// A field of `columns` by as many rows as `heights`, given row by row, has. `spacing` is along x and y. Without a `floor` it
    /// is one spacing below the lowest height.
    pub fn new(
        columns: usize,
        mut heights: Vec<f64>,
        spacing: [f64; 2],
        floor: Option<f64>,
    ) -> Result<Self, HeightFieldError> {
        let rows = heights.len().checked_div(columns).unwrap_or(0);
        if columns < 2 || rows < 2 || rows * columns != heights.len() {
            return Err(HeightFieldError::Shape(rows, columns));
        }
        if heights.len() > Self::MOST_SAMPLES {
            return Err(HeightFieldError::TooMany);
        }
        if let Some(bad) = heights.iter().position(|h| h.abs() > Self::FARTHEST) {
            return Err(HeightFieldError::Height(bad / columns, bad % columns));
        }
        let side = [spacing[0] * (columns - 1) as f64, spacing[1] * (rows - 1) as f64];
        if !spacing.iter().all(|s| *s > 1e-6) || !side.iter().all(|s| *s <= Self::FARTHEST) {
            return Err(HeightFieldError::Spacing);
        }
        // One zero and one way to say that nothing is known, so that equal fields are equal bit by bit.
        heights.iter_mut().for_each(|h| *h = if h.is_nan() { f64::NAN } else { *h + 0.0 });
        let lowest = heights.iter().copied().fold(f64::INFINITY, f64::min);
        let floor = floor.unwrap_or(lowest - spacing[0].max(spacing[1]));
        if lowest.is_finite() && !(floor < lowest && floor >= -2.0 * Self::FARTHEST) {
            return Err(HeightFieldError::Floor(lowest));
        }
        let mut field = Self { columns, spacing, floor, heights, steepest: 0.0, levels: Vec::new() };
        let cells = field.cells();
        if cells.blocks.iter().all(|block| block.highest == f32::NEG_INFINITY) {
            return Err(HeightFieldError::Empty);
        }
        field.steepest = field.steepest_triangle();
        field.levels.push(cells);
        while let Some(last) = field.levels.last().filter(|level| level.blocks.len() > 1) {
            let next = last.halved();
            field.levels.push(next);
        }
        Ok(field)
    }

    /// Samples in a row.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.heights.len() / self.columns
    }

    /// Distance of samples along x and y, metres.
    pub fn spacing(&self) -> [f64; 2] {
        self.spacing
    }

    /// z of what it stands on, metres.
    pub fn floor(&self) -> f64 {
        self.floor
    }

    /// Heights, row by row; no number where they are not known.
    pub fn heights(&self) -> &[f64] {
        &self.heights
    }

    /// The largest slope of a triangle, metres for each metre.
    pub fn steepest(&self) -> f64 {
        self.steepest
    }

    /// A sample as a point.
    pub fn sample(&self, row: usize, column: usize) -> Point3<f64> {
        let height = self.heights[row * self.columns + column];
        Point3::new(self.spacing[0] * column as f64, self.spacing[1] * row as f64, height)
    }

    /// The triangles of a cell: the one beside its first row, and the one beside its first column, counter-clockwise seen from above.
    /// `None` for those that have an unknown corner.
    pub fn triangles(&self, row: usize, column: usize) -> [Option<[Point3<f64>; 3]>; 2] {
        let [a, b, c, d] = [(0, 0), (0, 1), (1, 0), (1, 1)].map(|(r, k)| self.sample(row + r, column + k));
        let known = |triangle: [Point3<f64>; 3]| triangle.iter().all(|p| !p.z.is_nan()).then_some(triangle);
        [known([a, b, d]), known([a, d, c])]
    }

    /// Number of levels of blocks; the last has one, level zero has the cells.
    pub fn levels(&self) -> usize {
        self.levels.len()
    }

    /// A block by level, row and column; `None` beyond the last ones. Below it are those of twice its row and column, and one more.
    pub fn block(&self, level: usize, row: usize, column: usize) -> Option<&Block> {
        let level = &self.levels[level];
        (row < level.rows && column < level.columns).then(|| &level.blocks[row * level.columns + column])
    }

    /// Box around all of it.
    pub fn bounds(&self) -> Aabb {
        self.bounds_of(&self.levels[self.levels.len() - 1].blocks[0])
    }

    /// What to show of it: its triangles, of every n-th sample so that there are no more than about `most` of these, with walls down to
    /// the floor where it ends.
    pub fn mesh(&self, most: usize) -> TriMesh {
        let (rows, columns) = (self.rows(), self.columns);
        let step = (1..).find(|s| rows.div_ceil(*s) * columns.div_ceil(*s) <= most.max(4)).unwrap_or(1);
        let picks = |n: usize| -> Vec<usize> {
            let mut picks: Vec<usize> = (0..n - 1).step_by(step).collect();
            picks.push(n - 1);
            picks
        };
        let (picked_rows, picked_columns) = (picks(rows), picks(columns));
        let mut mesh = TriMesh::default();
        let mut numbers = Vec::new();
        for sample in picked_rows.iter().flat_map(|&r| picked_columns.iter().map(move |&c| self.sample(r, c)))
        {
            let known = !sample.z.is_nan();
            numbers.push(known.then_some(mesh.vertices.len() as u32));
            mesh.vertices.extend(known.then_some(sample));
        }
        let width = picked_columns.len();
        for corner in (0..numbers.len() - width).filter(|i| i % width + 1 < width) {
            let [a, b, c, d] = [corner, corner + 1, corner + width, corner + width + 1].map(|i| numbers[i]);
            for face in [[a, b, d], [a, d, c]] {
                if let [Some(a), Some(b), Some(c)] = face {
                    mesh.faces.push([a, b, c]);
                }
            }
        }
        let mut sides: std::collections::BTreeSet<(u32, u32)> = Default::default();
        for &[a, b, c] in &mesh.faces {
            sides.extend([(a, b), (b, c), (c, a)]);
        }
        for &(a, b) in sides.iter().filter(|(a, b)| !sides.contains(&(*b, *a))) {
            let below = [a, b]
                .map(|i| Point3::new(mesh.vertices[i as usize].x, mesh.vertices[i as usize].y, self.floor));
            let first = mesh.vertices.len() as u32;
            mesh.vertices.extend(below);
            mesh.faces.extend([[b, a, first], [b, first, first + 1]]);
        }
        mesh
    }

    fn bounds_of(&self, block: &Block) -> Aabb {
        let [x, y, to_x, to_y] = block.bounds.map(f64::from);
        Aabb { low: Point3::new(x, y, self.floor), high: Point3::new(to_x, to_y, f64::from(block.highest)) }
    }

    fn cells(&self) -> Level {
        let (rows, columns) = (self.rows() - 1, self.columns - 1);
        let cell = |i: usize| {
            let (row, column) = (i / columns, i % columns);
            let (low, high) = (self.sample(row, column), self.sample(row + 1, column + 1));
            let triangles = self.triangles(row, column);
            let corners = || triangles.iter().flatten().flatten().map(|p| p.z);
            let lowest = match triangles {
                [Some(_), Some(_)] => below(corners().fold(f64::INFINITY, f64::min)),
                _ => f32::NEG_INFINITY,
            };
            let highest = above(corners().fold(f64::NEG_INFINITY, f64::max));
            Block { bounds: [below(low.x), below(low.y), above(high.x), above(high.y)], lowest, highest }
        };
        Level { columns, rows, blocks: (0..rows * columns).map(cell).collect() }
    }

    fn steepest_triangle(&self) -> f64 {
        let [sx, sy] = self.spacing;
        let mut steepest: f64 = 0.0;
        for row in 0..self.rows() - 1 {
            for column in 0..self.columns - 1 {
                let [one, other] = self.triangles(row, column);
                let of_one = one.map(|[a, b, d]| ((b.z - a.z) / sx).hypot((d.z - b.z) / sy));
                let of_other = other.map(|[a, d, c]| ((d.z - c.z) / sx).hypot((c.z - a.z) / sy));
                steepest = of_one.into_iter().chain(of_other).fold(steepest, f64::max);
            }
        }
        steepest
    }

    /// See [`Pile::walk`](super::Pile::walk).
    pub(super) fn walk(&self, from: &Point3<f64>, visit: &mut impl FnMut(&Lump, bool) -> bool) {
        let mut stack = vec![(self.levels.len() - 1, 0, 0)];
        while let Some((level, row, column)) = stack.pop() {
            let Some(block) = self.block(level, row, column).filter(|b| b.highest > f32::NEG_INFINITY) else {
                continue;
            };
            if !visit(&Lump::Box { bounds: self.bounds_of(block), radius: 0.0 }, false) {
                continue;
            }
            if level == 0 {
                for top in self.triangles(row, column).into_iter().flatten() {
                    visit(&Lump::Prism { top, floor: self.floor }, true);
                }
                continue;
            }
            // The nearest quarter comes last onto the stack, the one across from it first.
            let [x, y, to_x, to_y] = block.bounds.map(f64::from);
            let near = |at: f64, low: f64, high: f64| usize::from(at > 0.5 * (low + high));
            let (near_row, near_column) = (near(from.y, y, to_y), near(from.x, x, to_x));
            for (r, c) in [(1, 1), (1, 0), (0, 1), (0, 0)] {
                stack.push((level - 1, 2 * row + (near_row ^ r), 2 * column + (near_column ^ c)));
            }
        }
    }
}

impl Level {
    /// Blocks of two by two.
    fn halved(&self) -> Self {
        let (rows, columns) = (self.rows.div_ceil(2), self.columns.div_ceil(2));
        let block = |i: usize| {
            let (row, column) = (i / columns * 2, i % columns * 2);
            let each = [(0, 0), (0, 1), (1, 0), (1, 1)].into_iter().filter_map(|(r, c)| {
                let (row, column) = (row + r, column + c);
                (row < self.rows && column < self.columns).then(|| self.blocks[row * self.columns + column])
            });
            let joined = |a: Block, b: Block| Block {
                bounds: std::array::from_fn(|k| {
                    if k < 2 { a.bounds[k].min(b.bounds[k]) } else { a.bounds[k].max(b.bounds[k]) }
                }),
                lowest: a.lowest.min(b.lowest),
                highest: a.highest.max(b.highest),
            };
            each.reduce(joined).expect("a block has at least one below it")
        };
        Self { columns, rows, blocks: (0..rows * columns).map(block).collect() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn blocks_hold_what_is_below_them(
            (columns, heights) in (2..9_usize, 2..9_usize).prop_flat_map(|(rows, columns)| {
                let height = prop_oneof![5 => -1.0..1.0, 1 => Just(f64::NAN)];
                (Just(columns), prop::collection::vec(height, rows * columns))
            }),
        ) {
            let Ok(field) = HeightField::new(columns, heights.clone(), [0.1, 0.2], None) else {
                let lone = HeightField::new(columns, heights, [0.1, 0.2], None);
                prop_assert_eq!(lone, Err(HeightFieldError::Empty));
                return Ok(());
            };
            for row in 0..field.rows() - 1 {
                for column in 0..columns - 1 {
                    let triangles = field.triangles(row, column);
                    let (mut r, mut c) = (row, column);
                    for level in 0..field.levels() {
                        let block = field.block(level, r, c).unwrap();
                        for corner in triangles.iter().flatten().flatten() {
                            prop_assert!(field.bounds_of(block).padded(1e-12).contains(corner));
                            prop_assert!(f64::from(block.lowest) <= corner.z);
                        }
                        if triangles.contains(&None) {
                            prop_assert_eq!(block.lowest, f32::NEG_INFINITY);
                        }
                        (r, c) = (r / 2, c / 2);
                    }
                    prop_assert_eq!((r, c), (0, 0));
                }
            }
            let mut prisms = 0;
            field.walk(&Point3::origin(), &mut |lump, leaf| {
                prisms += usize::from(leaf && matches!(lump, Lump::Prism { .. }));
                true
            });
            let known = |i: usize| field.triangles(i / (columns - 1), i % (columns - 1)).iter().flatten().count();
            prop_assert_eq!(prisms, (0..(field.rows() - 1) * (columns - 1)).map(known).sum::<usize>());
        }
    }

    #[test]
    fn what_is_no_field_is_refused() {
        let field = |columns, heights: &[f64], spacing, floor| {
            HeightField::new(columns, heights.to_vec(), spacing, floor)
        };
        let unit = [1.0, 1.0];
        assert_eq!(field(2, &[0.0; 5], unit, None), Err(HeightFieldError::Shape(2, 2)));
        assert_eq!(field(0, &[], unit, None), Err(HeightFieldError::Shape(0, 0)));
        assert_eq!(field(2, &[0.0, 0.0, 0.0, 1e6], unit, None), Err(HeightFieldError::Height(1, 1)));
        assert_eq!(field(2, &[f64::NAN, 0.0, 0.0, f64::NAN], unit, None), Err(HeightFieldError::Empty));
        assert_eq!(field(2, &[f64::NAN; 4], unit, None), Err(HeightFieldError::Empty));
        assert_eq!(field(2, &[0.0; 4], [1.0, 0.0], None), Err(HeightFieldError::Spacing));
        assert_eq!(field(2, &[0.0; 4], [f64::NAN, 1.0], None), Err(HeightFieldError::Spacing));
        assert_eq!(field(2, &[0.5; 4], unit, Some(0.5)), Err(HeightFieldError::Floor(0.5)));
        let plain = field(2, &[0.0, 1.0, 0.0, 1.0], unit, None).unwrap();
        assert_eq!((plain.floor(), plain.steepest(), plain.levels()), (-1.0, 1.0, 1));
    }
}
