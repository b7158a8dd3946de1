//! Joint limits from all their sources, the first that says something counting: `[limits].joints`, MoveIt's
//! `joint_limits.yaml`, the description, `[limits].default`, and last a careful default with a warning.

use std::collections::BTreeMap;

use super::document::Table;
use super::lookup;
use crate::diag::{Diagnostic, Diagnostics, Span};
use crate::ids::DofIdx;
use crate::model::{DynamicLimits, RobotModel};

/// What one source says about a joint.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
struct Said {
    lower: Option<f64>,
    upper: Option<f64>,
    /// Velocity, acceleration, jerk.
    dynamics: [Option<f64>; 3],
}

impl Said {
    /// What `self` says, and where it says nothing, what `other` says.
    fn or(self, other: Self) -> Self {
        Self {
            lower: self.lower.or(other.lower),
            upper: self.upper.or(other.upper),
            dynamics: std::array::from_fn(|i| self.dynamics[i].or(other.dynamics[i])),
        }
    }

    fn from_table(table: &Table) -> Self {
        Self {
            lower: table.number("lower"),
            upper: table.number("upper"),
            dynamics: ["velocity", "acceleration", "jerk"].map(|key| table.number(key).filter(|x| *x > 0.0)),
        }
    }
}

const DYNAMICS: [&str; 3] = ["velocity", "acceleration", "jerk"];
const UNITS: [&str; 3] = ["rad/s or m/s", "rad/s^2 or m/s^2", "rad/s^3 or m/s^3"];

/// The model, to which `joint_limits` has been applied, with the limits of the specification. `place` is where the warning
/// about missing limits goes.
pub(super) fn apply(
    model: &RobotModel,
    robot: &Table,
    place: Span,
    diagnostics: &mut Diagnostics,
) -> RobotModel {
    let fallback =
        robot.table("limits").and_then(|l| l.table("default")).map(Said::from_table).unwrap_or_default();
    let mut written: BTreeMap<DofIdx, (Said, Span)> = BTreeMap::new();
    for entry in robot.table("limits").map(|l| l.entries("joints")).unwrap_or_default() {
        let dof = lookup::dof(model, (&entry.key, entry.key_span), diagnostics);
        if let Some((dof, table)) = dof.zip(entry.node.table()) {
            written.insert(dof, (Said::from_table(table), entry.key_span));
        }
    }

    let mut bounds = BTreeMap::new();
    let mut assumed: [Vec<&str>; 3] = Default::default();
    for (index, dof) in model.dofs().enumerate() {
        let (spec, spec_place) = written.get(&index).copied().unwrap_or((Said::default(), place));
        let d = dof.dynamics;
        let described = [d.velocity, d.acceleration, d.jerk];
        let from_description = std::array::from_fn(|i| d.given[i].then_some(described[i]));
        let said = spec.or(Said { dynamics: from_description, ..Said::default() }).or(fallback);
        let given = said.dynamics.map(|x| x.is_some());
        for (i, names) in assumed.iter_mut().enumerate() {
            if !given[i] {
                names.push(&dof.name);
            }
        }
        let dynamics = DynamicLimits {
            velocity: said.dynamics[0].unwrap_or(d.velocity),
            acceleration: said.dynamics[1].unwrap_or(d.acceleration),
            jerk: said.dynamics[2].unwrap_or(d.jerk),
            given,
        };
        let lower = spec.lower.unwrap_or(dof.lower);
        let upper = spec.upper.unwrap_or(dof.upper);
        let in_order = lower <= upper && lower.is_finite() == upper.is_finite();
        if !in_order {
            diagnostics.push(out_of_order(&dof.name, lower, upper).at(spec_place, "these limits"));
        }
        let (lower, upper) = if in_order { (lower, upper) } else { (dof.lower, dof.upper) };
        bounds.insert(index, (lower, upper, dynamics));
    }
    // Amid errors the limits may be there, only wrong.
    if let Some(warning) = assumption(&assumed, model.dofs().len()).filter(|_| !diagnostics.has_errors()) {
        diagnostics.push(warning.at(place, "limits left open"));
    }
    model.with_limits(|index, _| bounds[&index])
}

fn out_of_order(joint: &str, lower: f64, upper: f64) -> Diagnostic {
    let message = if lower > upper {
        format!("joint \"{joint}\" has its lower limit {lower} above its upper limit {upper}")
    } else {
        format!("joint \"{joint}\" turns without end, and only one limit is given")
    };
    Diagnostic::error("R0413", message).expected("`lower` and `upper`, in this order of size")
}

/// One warning about all limits that no source gives.
fn assumption(assumed: &[Vec<&str>; 3], dofs: usize) -> Option<Diagnostic> {
    let d = DynamicLimits::DEFAULT;
    let defaults = [d.velocity, d.acceleration, d.jerk];
    let parts: Vec<String> = (0..3)
        .filter(|&i| !assumed[i].is_empty())
        .map(|i| {
            let joints = match assumed[i].len() {
                n if n == dofs && n > 1 => "all joints".to_owned(),
                1 => format!("joint {}", assumed[i][0]),
                _ => format!("joints {}", assumed[i].join(", ")),
            };
            format!("{} of {joints}: {} {}", DYNAMICS[i], defaults[i], UNITS[i])
        })
        .collect();
    if parts.is_empty() {
        return None;
    }
    Some(
        Diagnostic::warning("R0412", format!("no file gives these limits, so they are assumed: {}", parts.join("; ")))
            .expected("velocity, acceleration and jerk of each joint")
            .hint("write `[limits]` with `default = { velocity = .., acceleration = .., jerk = .. }`, or `joint_limits`"),
    )
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::super::{document, file};
    use super::*;
    use crate::diag::Sources;
    use crate::ids::Idx;
    use crate::joint_limits;
    use crate::model::{JointMotion, Origin, RobotBuilder};
    use crate::system::MemorySystem;

    fn model() -> RobotModel {
        let mut robot = RobotBuilder::new("two");
        for link in ["a", "b", "c"] {
            robot.link(link, vec![], vec![], None);
        }
        let dynamics = DynamicLimits { velocity: 3.0, given: [true, false, false], ..DynamicLimits::DEFAULT };
        let limits = (-1.0, 1.0, false, dynamics);
        let endless = (f64::NEG_INFINITY, f64::INFINITY, true, DynamicLimits::DEFAULT);
        let z = [0.0, 0.0, 1.0];
        robot.moving("j1", JointMotion::Revolute, "a", "b", Origin::default(), z, limits, None);
        robot.moving("j2", JointMotion::Revolute, "b", "c", Origin::default(), z, endless, None);
        robot.build().unwrap()
    }

    fn applied(text: &str, moveit: &str) -> (RobotModel, String) {
        let mut sources = Sources::new();
        let id = sources.add("r.toml", text);
        let mut diagnostics = Diagnostics::new();
        let table = document::parse(&sources, id, &mut diagnostics);
        let mut system = MemorySystem::new();
        system.insert("joint_limits.yaml", moveit);
        let (limits, found) = joint_limits::load(&system, &mut sources, Path::new("joint_limits.yaml"));
        diagnostics.extend(found);
        let model = joint_limits::apply(&limits, &model(), &mut diagnostics);
        let place = Span { file: id, start: 0, end: 0 };
        let model = apply(&model, &table, place, &mut diagnostics);
        (model, file::by_place(diagnostics).to_plain_text(&sources))
    }

    #[test]
    fn the_first_source_that_says_something_counts() {
        let text = "[limits]\ndefault = { velocity = 9.0, acceleration = 8.0, jerk = 7.0 }\n\
                    joints.j2 = { jerk = 70.0, lower = -2, upper = 2 }\n";
        let moveit = "joint_limits:\n  j1: { has_acceleration_limits: true, max_acceleration: 4.0, \
                      has_position_limits: true, min_position: -1.0, max_position: 0.5 }\n  \
                      j2: { has_velocity_limits: true, max_velocity: 2.0, has_jerk_limits: true, max_jerk: 1.0 }\n";
        let (model, findings) = applied(text, moveit);
        assert_eq!(findings, "");
        let [j1, j2] = [0, 1].map(|i| model.dofs()[DofIdx::new(i)].clone());
        assert_eq!((j1.dynamics.velocity, j1.dynamics.acceleration, j1.dynamics.jerk), (3.0, 4.0, 7.0));
        assert_eq!((j2.dynamics.velocity, j2.dynamics.acceleration, j2.dynamics.jerk), (2.0, 8.0, 70.0));
        assert_eq!((j1.lower, j1.upper, j2.lower, j2.upper, j2.continuous), (-1.0, 0.5, -2.0, 2.0, false));
        assert_eq!(j1.dynamics.given, [true; 3]);
    }

    #[test]
    fn what_is_left_open_is_assumed_with_one_warning() {
        let (model, findings) = applied("[limits]\ndefault.acceleration = 5.0\n", "joint_limits: {}\n");
        assert_eq!(findings.lines().count(), 1, "{findings}");
        assert!(findings.contains("velocity of joint j2: 1 rad/s"), "{findings}");
        assert!(findings.contains("jerk of all joints: 20 "), "{findings}");
        assert!(!findings.contains("acceleration of"), "{findings}");
        let j2 = &model.dofs()[DofIdx::new(1)];
        assert_eq!(j2.dynamics.given, [false, true, false]);
        assert!(j2.continuous);
    }

    #[test]
    fn limits_out_of_order_are_refused() {
        let all = "default = { velocity = 1, acceleration = 1, jerk = 1 }";
        let (_, findings) =
            applied(&format!("[limits]\n{all}\njoints.j1 = {{ lower = 2 }}\n"), "joint_limits: {}\n");
        assert!(findings.contains("3:8: error[R0413]"), "{findings}");
        let (_, findings) =
            applied(&format!("[limits]\n{all}\njoints.j2 = {{ lower = 2 }}\n"), "joint_limits: {}\n");
        assert!(findings.contains("turns without end"), "{findings}");
    }
}
