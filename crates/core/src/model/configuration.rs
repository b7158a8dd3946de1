//! Joint values of a whole robot.

use std::ops::{Index, IndexMut};

use super::RobotModel;
use crate::ids::{DofIdx, Idx};

/// A value for each degree of freedom of a robot, radians or metres.
#[derive(Debug, Clone, PartialEq)]
pub struct Configuration {
    values: Vec<f64>,
}

impl Configuration {
    /// Zero where the limits allow it, else the nearest limit.
    pub fn neutral(model: &RobotModel) -> Self {
        let values = model.dofs().iter().map(|d| 0.0_f64.clamp(d.lower, d.upper)).collect();
        Self { values }
    }

    /// These values, in the order of the model's degrees of freedom.
    pub fn from_values(values: Vec<f64>) -> Self {
        Self { values }
    }

    /// The values, in the order of the model's degrees of freedom.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// The values of these degrees of freedom, in their order.
    pub fn select(&self, dofs: &[DofIdx]) -> Vec<f64> {
        dofs.iter().map(|&d| self[d]).collect()
    }

    /// Sets these degrees of freedom; `values` in the order of `dofs`.
    pub fn set(&mut self, dofs: &[DofIdx], values: &[f64]) {
        assert_eq!(dofs.len(), values.len(), "one value for each degree of freedom");
        for (&dof, &value) in dofs.iter().zip(values) {
            self[dof] = value;
        }
    }
}

impl Index<DofIdx> for Configuration {
    type Output = f64;
    fn index(&self, dof: DofIdx) -> &f64 {
        &self.values[dof.index()]
    }
}

impl IndexMut<DofIdx> for Configuration {
    fn index_mut(&mut self, dof: DofIdx) -> &mut f64 {
        &mut self.values[dof.index()]
    }
}
