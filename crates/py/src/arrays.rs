//! Between numpy arrays and our types.

use nalgebra::{Matrix3, Matrix4, Rotation3, Translation3, UnitQuaternion, Vector3};
use numpy::{PyArray2, PyArrayMethods, PyReadonlyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use robotc_core::Pose;

/// A pose as a 4 x 4 homogeneous matrix.
pub(crate) fn matrix<'py>(py: Python<'py>, pose: &Pose) -> Bound<'py, PyArray2<f64>> {
    rows(py, &matrix_rows(pose), 4)
}

/// The four rows of the homogeneous matrix of a pose.
pub(crate) fn matrix_rows(pose: &Pose) -> Vec<Vec<f64>> {
    let m: Matrix4<f64> = pose.to_homogeneous();
    (0..4).map(|i| (0..4).map(|j| m[(i, j)]).collect()).collect()
}

/// A table with this many columns; rows may be none.
pub(crate) fn rows<'py>(py: Python<'py>, rows: &[Vec<f64>], columns: usize) -> Bound<'py, PyArray2<f64>> {
    let array = PyArray2::zeros(py, [rows.len(), columns], false);
    let mut writer = array.readwrite();
    let mut view = writer.as_array_mut();
    for (i, row) in rows.iter().enumerate() {
        for (j, value) in row.iter().enumerate() {
            view[(i, j)] = *value;
        }
    }
    drop(writer);
    array
}

/// The pose of a 4 x 4 homogeneous matrix; its rotation must be orthonormal to 1e-6.
pub(crate) fn pose(matrix: &PyReadonlyArray2<'_, f64>) -> PyResult<Pose> {
    let m = matrix.as_array();
    if m.shape() != [4, 4] {
        return Err(PyValueError::new_err(format!("a pose is a 4 x 4 matrix, not {:?}", m.shape())));
    }
    let rotation = Matrix3::from_fn(|i, j| m[(i, j)]);
    let off = (rotation * rotation.transpose() - Matrix3::identity()).norm();
    let last_row = [m[(3, 0)], m[(3, 1)], m[(3, 2)], m[(3, 3)] - 1.0];
    // Written so that NaN is refused.
    let proper = off < 1e-6 && rotation.determinant() > 0.0 && last_row.iter().all(|x| x.abs() < 1e-9);
    let position = Vector3::new(m[(0, 3)], m[(1, 3)], m[(2, 3)]);
    if !proper || !position.iter().all(|x| x.is_finite()) {
        return Err(PyValueError::new_err("not a rigid transform: its rotation is not orthonormal"));
    }
    let rotation = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(rotation));
    Ok(Pose::from_parts(Translation3::from(position), rotation))
}
