//! Joint axes and position limits: what to assume where a file gives none that can be used.

use std::f64::consts::PI;

use super::draft::{Draft, JointDraft, JointKind};
use super::grouped::{Grouped, and_others};
use crate::diag::{Diagnostic, Diagnostics};

/// Assumed for a prismatic joint without limits, metres to both sides: a joint that drives a base in a hall.
const ASSUMED_TRAVEL: f64 = 10.0;

/// Repairs axes and limits of all moving joints.
pub(super) fn check(draft: &mut Draft, found: &mut Diagnostics) {
    let mut slow = Grouped::default();
    let mut unnormalised = Grouped::default();
    for joint in draft.joints.iter_mut().filter(|j| j.kind.moves()) {
        axis(joint, &mut unnormalised, found);
        if joint.mimic.is_none() {
            position(joint, found);
            if joint.limits.velocity.is_some_and(|v| v <= 0.0) {
                slow.add(joint.limits_span, &joint.name.text);
            }
        }
        joint.limits.velocity = joint.limits.velocity.filter(|&v| v > 0.0);
    }
    unnormalised.finish(found, |count, first| {
        Diagnostic::warning(
            "R0223",
            format!(
                "the axis of joint `{first}`{} is no unit vector; only its direction counts",
                and_others(count)
            ),
        )
    });
    slow.finish(found, |count, first| {
        Diagnostic::warning(
            "R0227",
            format!(
                "joint `{first}`{} has no positive velocity limit; taken as not given",
                and_others(count)
            ),
        )
    });
}

fn axis(joint: &JointDraft, unnormalised: &mut Grouped, found: &mut Diagnostics) {
    let length = joint.axis.iter().map(|x| x * x).sum::<f64>().sqrt();
    if length < 1e-9 || !length.is_finite() {
        let message = format!("joint `{}` moves, but its axis has no direction", joint.name.text);
        found.push(
            Diagnostic::error("R0222", message)
                .at(joint.axis_span, "no direction")
                .expected("a unit vector such as \"0 0 1\""),
        );
    } else if (length - 1.0).abs() > 1e-3 {
        unnormalised.add(joint.axis_span, &joint.name.text);
    }
}

fn position(joint: &mut JointDraft, found: &mut Diagnostics) {
    if joint.kind == JointKind::Continuous {
        return;
    }
    let assume = |lower: f64, upper: f64, why: String| {
        let unit = if joint.kind == JointKind::Prismatic { "m" } else { "rad" };
        let message = format!("joint `{}` {why}; {lower:.4} to {upper:.4} {unit} are used", joint.name.text);
        Diagnostic::warning("R0224", message)
            .at(joint.limits_span, "here")
            .hint("give lower and upper in `<limit>`")
    };
    let half = if joint.kind == JointKind::Prismatic { ASSUMED_TRAVEL } else { PI };
    let (lower, upper, finding) = match (joint.limits.lower, joint.limits.upper) {
        (Some(lower), Some(upper)) if lower < upper => (lower, upper, None),
        (Some(lower), Some(upper)) if lower > upper => {
            let message = format!("limits of joint `{}` are the wrong way round; swapped", joint.name.text);
            let d = Diagnostic::warning("R0225", message).at(joint.limits_span, "lower is above upper");
            (upper, lower, Some(d))
        }
        (Some(at), Some(_)) => {
            let message = format!("joint `{}` cannot move: lower and upper are both {at}", joint.name.text);
            (at, at, Some(Diagnostic::warning("R0225", message).at(joint.limits_span, "an empty range")))
        }
        given => match (joint.soft_limits, given) {
            ((Some(lower), Some(upper)), _) if lower < upper => (
                lower,
                upper,
                Some(assume(lower, upper, "has limits only in its safety controller".to_owned())),
            ),
            // A bound that is not written is zero (URDF 1.0), where that leaves a range.
            (_, (None, Some(upper))) if upper > 0.0 => {
                (0.0, upper, Some(assume(0.0, upper, "has no lower limit".to_owned())))
            }
            (_, (Some(lower), None)) if lower < 0.0 => {
                (lower, 0.0, Some(assume(lower, 0.0, "has no upper limit".to_owned())))
            }
            _ => (-half, half, Some(assume(-half, half, "has no position limits".to_owned()))),
        },
    };
    if let Some(finding) = finding {
        found.push(finding);
    }
    (joint.limits.lower, joint.limits.upper) = (Some(lower), Some(upper));
}
