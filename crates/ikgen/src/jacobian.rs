//! The Jacobian of a chain as it is described.

use nalgebra::Matrix6;
use robotc_core::model::{ChainMotion, SerialChain};

/// Determinant of the Jacobian at the tip without the `given` variables; `None` unless six remain.
pub(crate) fn jacobian_determinant(chain: &SerialChain, values: &[f64], given: &[usize]) -> Option<f64> {
    let columns = jacobian(chain, values);
    let left: Vec<usize> = (0..columns.len()).filter(|v| !given.contains(v)).collect();
    if left.len() != 6 {
        return None;
    }
    Some(Matrix6::from_fn(|i, j| columns[left[j]][i]).determinant())
}

/// Columns of the Jacobian: velocity of the tip, then angular velocity, in the base frame.
pub(crate) fn jacobian(chain: &SerialChain, values: &[f64]) -> Vec<[f64; 6]> {
    let tip = chain.forward(values).translation.vector;
    let mut columns = vec![[0.0; 6]; chain.variables.len()];
    let mut at = robotc_core::Pose::identity();
    for joint in &chain.joints {
        at *= joint.previous_from_joint;
        let axis = at.rotation * joint.axis.into_inner();
        let value = joint.multiplier * values[joint.variable] + joint.offset;
        let (linear, angular) = match joint.motion {
            ChainMotion::Revolute => (axis.cross(&(tip - at.translation.vector)), axis),
            ChainMotion::Prismatic => (axis, nalgebra::Vector3::zeros()),
        };
        for i in 0..3 {
            columns[joint.variable][i] += joint.multiplier * linear[i];
            columns[joint.variable][3 + i] += joint.multiplier * angular[i];
        }
        match joint.motion {
            ChainMotion::Revolute => {
                at.rotation *= nalgebra::UnitQuaternion::from_axis_angle(&joint.axis, value);
            }
            ChainMotion::Prismatic => at.translation.vector += axis * value,
        }
    }
    columns
}
