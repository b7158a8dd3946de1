//! What sensors measured, from files: points of PLY, PCD, NPY and text files, heights of PNG, NPY and text files.
//!
//! The readers never panic on a bad file, and take no more memory than a few times its size and that of what it may hold at most.

mod image;
mod pcd;
mod ply;
mod table;

use nalgebra::Point3;
use thiserror::Error;

use crate::geom::{HeightField, PointCloud};
use crate::npy;

/// Points as read, in the unit and frame of the file.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Points {
    /// At least one; all coordinates are finite.
    pub points: Vec<Point3<f64>>,
    /// How many more the file has whose coordinates are not finite: places of an image without a depth, most often.
    pub dropped: usize,
}

/// Numbers on a grid as read.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    /// Numbers in each row; at least one.
    pub columns: usize,
    /// Row by row, at least one row; no number where the file has none.
    pub values: Vec<f64>,
    /// The largest value that the file could hold, when that is known: 255 or 65535 of an image.
    pub full: Option<f64>,
}

/// Why a file gives no points, or no heights.
#[derive(Debug, Clone, Error, PartialEq, Eq)]
pub enum ScanError {
    /// The content is no format known here.
    #[error("not {0}")]
    UnknownFormat(&'static str),
    /// The file ends early, contradicts itself or is of a kind that is not read.
    #[error("{0}")]
    Malformed(String),
    /// Nothing is left.
    #[error("holds no {0}")]
    Empty(&'static str),
    /// More than any scene needs: an error, or an attack.
    #[error("holds more than {0} {1}")]
    TooLarge(usize, &'static str),
}

/// Formats of points, for messages.
pub const POINT_FORMATS: &str = "a PLY, PCD or NPY file, or a text file with three numbers in each line";

/// Formats of grids, for messages.
pub const GRID_FORMATS: &str = "a grey PNG or an NPY file, or a text file with a row of numbers in each line";

/// Reads points. The content decides the format: PLY (text, binary), PCD (text, binary, compressed), NPY with an array of at least
/// three columns, else text with the coordinates as the first three numbers of each line.
pub fn points(bytes: &[u8]) -> Result<Points, ScanError> {
    let all = match bytes {
        _ if ply::is_ply(bytes) => ply::read(bytes)?,
        _ if npy::is_npy(bytes) => points_of_array(bytes)?,
        _ if pcd::is_pcd(bytes) => pcd::read(bytes)?,
        _ => table::points(bytes)?,
    };
    let count = all.len();
    let finite = |p: &[f64; 3]| p.iter().all(|x| x.is_finite());
    let points: Vec<Point3<f64>> = all.into_iter().filter(finite).map(Point3::from).collect();
    match points.is_empty() {
        true => Err(ScanError::Empty("points")),
        false => Ok(Points { dropped: count - points.len(), points }),
    }
}

/// Reads numbers on a grid. The content decides the format: PNG (grey, 1 to 16 bits; transparent places have no number), NPY with an
/// array of two dimensions, else text with a row in each line.
pub fn grid(bytes: &[u8]) -> Result<Grid, ScanError> {
    let grid = match bytes {
        _ if image::is_png(bytes) => image::read(bytes)?,
        _ if npy::is_npy(bytes) => {
            let numbers = numbers_of_array(bytes)?;
            let shape = numbers.shape();
            let &[rows, columns] = shape else {
                return Err(ScanError::Malformed(format!(
                    "an array of shape {shape:?} is no grid; it needs two dimensions"
                )));
            };
            if rows * columns > HeightField::MOST_SAMPLES {
                return Err(ScanError::TooLarge(HeightField::MOST_SAMPLES, "samples"));
            }
            Grid { columns, values: numbers.in_rows(), full: None }
        }
        _ => table::grid(bytes)?,
    };
    match grid.values.is_empty() {
        true => Err(ScanError::Empty("heights")),
        false => Ok(grid),
    }
}

fn numbers_of_array(bytes: &[u8]) -> Result<npy::Numbers<'_>, ScanError> {
    match npy::read(bytes).map_err(|wrong| ScanError::Malformed(wrong.to_string()))? {
        npy::Array::Numbers(numbers) => Ok(numbers),
        npy::Array::Texts(_) => Err(ScanError::Malformed("holds texts, not numbers".into())),
    }
}

/// The first three numbers along the last dimension of an array.
fn points_of_array(bytes: &[u8]) -> Result<Vec<[f64; 3]>, ScanError> {
    let numbers = numbers_of_array(bytes)?;
    let shape = numbers.shape();
    let Some((&width, rows)) = shape.split_last().filter(|(width, rows)| **width >= 3 && !rows.is_empty())
    else {
        return Err(ScanError::Malformed(format!(
            "an array of shape {shape:?} is no list of points; it needs three columns"
        )));
    };
    bounded(rows.iter().product())?;
    Ok(numbers.in_rows().chunks_exact(width).map(|row| [row[0], row[1], row[2]]).collect())
}

/// Refuses more points than a cloud may have.
fn bounded(count: usize) -> Result<usize, ScanError> {
    match count > PointCloud::MOST_POINTS {
        true => Err(ScanError::TooLarge(PointCloud::MOST_POINTS, "points")),
        false => Ok(count),
    }
}

#[cfg(test)]
mod tests;
