//! The same robot with other limits.

use super::{Dof, DynamicLimits, ModelError, RobotModel};
use crate::ids::DofIdx;

impl RobotModel {
    /// The same robot with these speed limits; degrees of freedom that are not listed keep theirs.
    pub fn with_dynamics(&self, limits: &[(DofIdx, DynamicLimits)]) -> Self {
        let mut model = self.clone();
        for &(dof, dynamics) in limits {
            model.dofs[dof].dynamics = dynamics;
        }
        model
    }

    /// The same robot with position ranges narrowed to these (lower, upper), radians or metres: a range never grows.
    ///
    /// A continuous joint that gets a finite range is continuous no more. Fails when nothing is left of a range.
    pub fn with_position_limits(&self, ranges: &[(DofIdx, f64, f64)]) -> Result<Self, ModelError> {
        let mut model = self.clone();
        for &(dof, lower, upper) in ranges {
            let dof = &mut model.dofs[dof];
            if lower.is_nan() || upper.is_nan() {
                return Err(ModelError::NotFinite(format!("the position range of joint {}", dof.name)));
            }
            (dof.lower, dof.upper) = (dof.lower.max(lower), dof.upper.min(upper));
            if dof.lower > dof.upper {
                return Err(ModelError::EmptyRange(dof.name.clone()));
            }
            dof.continuous &= dof.lower.is_infinite() && dof.upper.is_infinite();
        }
        Ok(model)
    }

    /// The same robot with limits that replace those of the description, wider ones included: `limits` gives lower bound,
    /// upper bound and speeds of each degree of freedom.
    ///
    /// A continuous joint stays continuous where both bounds are infinite. Bounds must be in order and not NaN.
    pub fn with_limits(&self, limits: impl Fn(DofIdx, &Dof) -> (f64, f64, DynamicLimits)) -> Self {
        let mut model = self.clone();
        for (index, described) in self.dofs.enumerate() {
            let (lower, upper, dynamics) = limits(index, described);
            assert!(lower <= upper, "bounds of {} are in order", described.name);
            let dof = &mut model.dofs[index];
            dof.continuous &= lower.is_infinite() && upper.is_infinite();
            (dof.lower, dof.upper, dof.dynamics) = (lower, upper, dynamics);
        }
        model
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::super::{JointMotion, Origin, RobotBuilder};
    use super::*;
    use crate::ids::Idx;

    fn two_joints() -> RobotModel {
        let mut builder = RobotBuilder::new("r");
        for link in ["a", "b", "c"] {
            builder.link(link, Vec::new(), Vec::new(), None);
        }
        let z = [0.0, 0.0, 1.0];
        let turn = JointMotion::Revolute;
        let free = (f64::NEG_INFINITY, f64::INFINITY, true, DynamicLimits::DEFAULT);
        let bounded = (-1.0, 2.0, false, DynamicLimits::DEFAULT);
        builder.moving("j", turn, "a", "b", Origin::default(), z, free, None);
        builder.moving("k", turn, "b", "c", Origin::default(), z, bounded, None);
        builder.build().unwrap()
    }

    #[test]
    fn ranges_only_narrow() {
        let (j, k) = (DofIdx::new(0), DofIdx::new(1));
        let model = two_joints().with_position_limits(&[(j, -PI, PI), (k, -9.0, 1.5)]).unwrap();
        assert_eq!(
            (model.dofs()[j].lower, model.dofs()[j].upper, model.dofs()[j].continuous),
            (-PI, PI, false)
        );
        assert_eq!((model.dofs()[k].lower, model.dofs()[k].upper), (-1.0, 1.5));
        let error = two_joints().with_position_limits(&[(k, 3.0, 4.0)]).unwrap_err();
        assert_eq!(error, ModelError::EmptyRange("k".to_owned()));
    }

    #[test]
    fn dynamics_replace_those_listed() {
        let fast = DynamicLimits { velocity: 9.0, given: [true, false, false], ..DynamicLimits::DEFAULT };
        let model = two_joints().with_dynamics(&[(DofIdx::new(1), fast)]);
        assert_eq!(model.dofs()[DofIdx::new(0)].dynamics, DynamicLimits::DEFAULT);
        assert_eq!(model.dofs()[DofIdx::new(1)].dynamics, fast);
    }
}
