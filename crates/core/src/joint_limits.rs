//! MoveIt's `joint_limits.yaml`: velocity, acceleration and jerk limits that URDF has no room for.

use std::collections::BTreeMap;
use std::fmt;
use std::path::Path;

use serde::de::{Deserialize, Deserializer, MapAccess, SeqAccess, Visitor};
use serde_saphyr::{Location, Spanned};

use crate::diag::{Diagnostic, Diagnostics, FileId, Sources, Span, nearest};
use crate::model::{DynamicLimits, RobotModel};
use crate::system::System;

/// What a file says about one joint; `None` where it says nothing, or says that there is no limit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointLimits {
    /// Smallest position, radians or metres.
    pub lower: Option<f64>,
    /// Largest position, radians or metres.
    pub upper: Option<f64>,
    /// rad/s or m/s; positive.
    pub velocity: Option<f64>,
    /// rad/s^2 or m/s^2; positive.
    pub acceleration: Option<f64>,
    /// rad/s^3 or m/s^3; positive.
    pub jerk: Option<f64>,
    /// Where the joint is named.
    pub span: Span,
}

impl JointLimits {
    /// `dynamics` with what is given here in its place, marked as given.
    pub fn applied_to(&self, dynamics: DynamicLimits) -> DynamicLimits {
        let mut given = dynamics.given;
        let mut choose = |at: usize, new: Option<f64>, old: f64| {
            given[at] |= new.is_some();
            new.unwrap_or(old)
        };
        let velocity = choose(0, self.velocity, dynamics.velocity);
        let acceleration = choose(1, self.acceleration, dynamics.acceleration);
        let jerk = choose(2, self.jerk, dynamics.jerk);
        DynamicLimits { velocity, acceleration, jerk, given }
    }
}

/// `model` with the limits of a file: speeds replaced, positions narrowed, never widened.
///
/// Names that the model does not have, and ranges of which nothing is left, are warned of and change nothing. Limits of
/// fixed and mimic joints have no effect and are passed over.
pub fn apply(
    limits: &BTreeMap<String, JointLimits>,
    model: &RobotModel,
    found: &mut Diagnostics,
) -> RobotModel {
    let mut model = model.clone();
    for (name, limits) in limits {
        let Some(dof) = model.dof_named(name) else {
            if model.joint_named(name).is_none() {
                let message = format!("the robot has no joint `{name}`");
                let mut d = Diagnostic::warning("R0272", message).at(limits.span, "no such joint");
                if let Some(meant) = nearest(name, model.dofs().iter().map(|d| d.name.as_str())) {
                    d = d.hint(format!("did you mean `{meant}`?"));
                }
                found.push(d);
            }
            continue;
        };
        model = model.with_dynamics(&[(dof, limits.applied_to(model.dofs()[dof].dynamics))]);
        let range = (limits.lower.unwrap_or(f64::NEG_INFINITY), limits.upper.unwrap_or(f64::INFINITY));
        match model.with_position_limits(&[(dof, range.0, range.1)]) {
            Ok(narrowed) => model = narrowed,
            Err(error) => found.push(
                Diagnostic::warning("R0272", format!("{error}; the range of the description is kept"))
                    .at(limits.span, "limits of this joint"),
            ),
        }
    }
    model
}

/// Keys that name a number, with the switch that turns it off.
const NUMBERS: [(&str, &str); 5] = [
    ("min_position", "has_position_limits"),
    ("max_position", "has_position_limits"),
    ("max_velocity", "has_velocity_limits"),
    ("max_acceleration", "has_acceleration_limits"),
    ("max_jerk", "has_jerk_limits"),
];

/// Keys that MoveIt and ros2_control know and this program has no use for.
const UNUSED: [&str; 10] = [
    "has_deceleration_limits",
    "max_deceleration",
    "has_effort_limits",
    "max_effort",
    "angle_wraparound",
    "has_soft_limits",
    "soft_lower_limit",
    "soft_upper_limit",
    "k_position",
    "k_velocity",
];

/// Reads the file at `path`: limits by joint name. Joints with faulty entries keep what is right in them.
///
/// `joint_limits:` may stand at the top or deeper, as ROS parameter files have it.
pub fn load(
    system: &dyn System,
    sources: &mut Sources,
    path: &Path,
) -> (BTreeMap<String, JointLimits>, Diagnostics) {
    let mut found = Diagnostics::new();
    let text = match system.read(path).map(String::from_utf8) {
        Ok(Ok(text)) => text,
        Ok(Err(_)) => {
            found.push(Diagnostic::error("R0002", format!("{} is not UTF-8 text", path.display())));
            return (BTreeMap::new(), found);
        }
        Err(error) => {
            found.push(Diagnostic::unreadable(path, &error));
            return (BTreeMap::new(), found);
        }
    };
    let file = sources.add(path.display().to_string(), text);
    let limits = parse(sources.text(file), file, &mut found);
    (limits, found)
}

fn parse(text: &str, file: FileId, found: &mut Diagnostics) -> BTreeMap<String, JointLimits> {
    let place = |location: Location| span(text, file, location);
    let root: Node = match serde_saphyr::from_str(text) {
        Ok(root) => root,
        Err(error) => {
            let at = error.location().map_or(Span { file, start: 0, end: 0 }, place);
            let message = error.without_snippet().to_string();
            let message = message.lines().next().unwrap_or_default().to_owned();
            found.push(Diagnostic::error("R0270", message).at(at, "here"));
            return BTreeMap::new();
        }
    };
    let Some(joints) = root.find("joint_limits", 0) else {
        let at = Span { file, start: 0, end: 0 };
        found.push(
            Diagnostic::warning("R0271", "no `joint_limits:` in this file")
                .at(at, "nowhere in here")
                .expected("joint_limits: followed by joint names"),
        );
        return BTreeMap::new();
    };
    let mut limits = BTreeMap::new();
    for (name, value) in joints {
        let at = place(name.referenced);
        match &value.value {
            Node::Map(entries) => {
                let joint = joint(entries, at, &place, found);
                if limits.insert(name.value.clone(), joint).is_some() {
                    let message = format!("joint `{}` is given twice", name.value);
                    found.push(Diagnostic::error("R0271", message).at(at, "second time"));
                }
            }
            _ => found.push(
                Diagnostic::error("R0271", format!("joint `{}` has no limits", name.value))
                    .at(at, "not a table")
                    .expected("max_velocity, max_acceleration, ..."),
            ),
        }
    }
    limits
}

fn joint(
    entries: &Entries,
    at: Span,
    place: &dyn Fn(Location) -> Span,
    found: &mut Diagnostics,
) -> JointLimits {
    let get = |key: &str| entries.iter().find(|(k, _)| k.value == key).map(|(_, v)| v);
    let switched_off = |switch: &str| matches!(get(switch).map(|v| &v.value), Some(Node::Bool(false)));
    let mut numbers = [None; NUMBERS.len()];
    for (slot, (key, switch)) in numbers.iter_mut().zip(NUMBERS) {
        let Some(value) = get(key).filter(|_| !switched_off(switch)) else { continue };
        let is_position = switch == "has_position_limits";
        match value.value {
            Node::Number(x) if x.is_finite() && (is_position || x > 0.0) => *slot = Some(x + 0.0),
            _ => {
                let expected = if is_position { "a number" } else { "a positive number" };
                found.push(
                    Diagnostic::error("R0271", format!("`{key}` is not {expected}"))
                        .at(place(value.referenced), "this value")
                        .expected(expected),
                );
            }
        }
    }
    for (key, value) in entries {
        let name = key.value.as_str();
        let is_switch = NUMBERS.iter().any(|(_, switch)| *switch == name);
        if is_switch && !matches!(value.value, Node::Bool(_)) {
            let d = Diagnostic::error("R0271", format!("`{name}` is not true or false"));
            found.push(d.at(place(value.referenced), "this value").expected("true or false"));
        }
        if is_switch || NUMBERS.iter().any(|(number, _)| *number == name) || UNUSED.contains(&name) {
            continue;
        }
        let known = NUMBERS.iter().flat_map(|(number, switch)| [*number, *switch]);
        let mut d = Diagnostic::warning("R0271", format!("unknown key `{name}` is ignored"))
            .at(place(key.referenced), "unknown");
        if let Some(meant) = nearest(name, known) {
            d = d.hint(format!("did you mean `{meant}`?"));
        }
        found.push(d);
    }
    let [mut lower, mut upper, velocity, acceleration, jerk] = numbers;
    if let (Some(low), Some(high)) = (lower, upper)
        && low > high
    {
        found.push(
            Diagnostic::error("R0271", "`min_position` is above `max_position`").at(at, "of this joint"),
        );
        (lower, upper) = (None, None);
    }
    JointLimits { lower, upper, velocity, acceleration, jerk, span: at }
}

/// The character that a location of the YAML reader means.
fn span(text: &str, file: FileId, location: Location) -> Span {
    let line = usize::try_from(location.line()).unwrap_or(0).saturating_sub(1);
    let column = usize::try_from(location.column()).unwrap_or(0).saturating_sub(1);
    let start: usize = text.split_inclusive('\n').take(line).map(str::len).sum();
    let rest = text[start..].lines().next().unwrap_or_default();
    let start = start + rest.char_indices().nth(column).map_or(rest.len(), |(i, _)| i);
    let word = text[start..].find([':', '\n', '\r', ' ', '#', ',']).unwrap_or(text.len() - start);
    Span { file, start, end: start + word }
}

type Entries = Vec<(Spanned<String>, Spanned<Node>)>;

/// A YAML value with the places of what is in it.
#[derive(Debug)]
enum Node {
    Map(Entries),
    Number(f64),
    Bool(bool),
    /// Lists, texts and nothing: no limit is written with them.
    Other,
}

impl Node {
    /// The table under `key`, here or deeper.
    fn find(&self, key: &str, depth: usize) -> Option<&Entries> {
        let Node::Map(entries) = self else { return None };
        let here = entries.iter().find(|(k, _)| k.value == key).and_then(|(_, v)| match &v.value {
            Node::Map(found) => Some(found),
            _ => None,
        });
        here.or_else(|| match depth {
            0..4 => entries.iter().find_map(|(_, v)| v.value.find(key, depth + 1)),
            _ => None,
        })
    }
}

impl<'de> Deserialize<'de> for Node {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(NodeVisitor)
    }
}

struct NodeVisitor;

impl<'de> Visitor<'de> for NodeVisitor {
    type Value = Node;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a YAML value")
    }

    fn visit_bool<E>(self, value: bool) -> Result<Node, E> {
        Ok(Node::Bool(value))
    }

    fn visit_i64<E>(self, value: i64) -> Result<Node, E> {
        Ok(Node::Number(value as f64))
    }

    fn visit_u64<E>(self, value: u64) -> Result<Node, E> {
        Ok(Node::Number(value as f64))
    }

    fn visit_f64<E>(self, value: f64) -> Result<Node, E> {
        Ok(Node::Number(value))
    }

    fn visit_str<E>(self, _: &str) -> Result<Node, E> {
        Ok(Node::Other)
    }

    fn visit_unit<E>(self) -> Result<Node, E> {
        Ok(Node::Other)
    }

    fn visit_none<E>(self) -> Result<Node, E> {
        Ok(Node::Other)
    }

    fn visit_some<D: Deserializer<'de>>(self, deserializer: D) -> Result<Node, D::Error> {
        Node::deserialize(deserializer)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> Result<Node, A::Error> {
        while items.next_element::<Node>()?.is_some() {}
        Ok(Node::Other)
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Node, A::Error> {
        let mut entries = Vec::new();
        while let Some(entry) = map.next_entry()? {
            entries.push(entry);
        }
        Ok(Node::Map(entries))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{JointMotion, Origin, RobotBuilder};
    use crate::system::MemorySystem;

    fn read(text: &str) -> (BTreeMap<String, JointLimits>, String) {
        let mut system = MemorySystem::new();
        system.insert("limits.yaml", text);
        let mut sources = Sources::new();
        let (limits, found) = load(&system, &mut sources, Path::new("limits.yaml"));
        (limits, found.to_plain_text(&sources))
    }

    #[test]
    fn limits_of_a_moveit_file() {
        let (limits, text) = read(
            "default_velocity_scaling_factor: 0.1\njoint_limits:\n  a:\n    has_velocity_limits: true\n    \
             max_velocity: 2.5\n    has_acceleration_limits: false\n    max_acceleration: 0\n  b:\n    \
             max_jerk: 1e3\n    min_position: -1\n    max_position: 2\n",
        );
        assert_eq!(text, "");
        let a = limits["a"];
        assert_eq!((a.velocity, a.acceleration, a.jerk, a.lower), (Some(2.5), None, None, None));
        let b = limits["b"];
        assert_eq!((b.velocity, b.jerk, b.lower, b.upper), (None, Some(1000.0), Some(-1.0), Some(2.0)));
    }

    #[test]
    fn limits_may_be_nested_as_ros_parameters() {
        let (limits, text) =
            read("/**:\n  ros__parameters:\n    joint_limits:\n      j: {max_velocity: 1}\n");
        assert_eq!((limits["j"].velocity, text.as_str()), (Some(1.0), ""));
    }

    #[test]
    fn all_faults_are_told_with_their_places() {
        let (limits, text) = read(
            "joint_limits:\n  a:\n    max_velocty: 1\n    max_acceleration: fast\n    max_jerk: -2\n  b: 3\n  c:\n    \
             min_position: 2\n    max_position: 1\n",
        );
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(
            lines,
            [
                "limits.yaml:4:23: error[R0271]: `max_acceleration` is not a positive number; expected a positive number",
                "limits.yaml:5:15: error[R0271]: `max_jerk` is not a positive number; expected a positive number",
                "limits.yaml:3:5: warning[R0271]: unknown key `max_velocty` is ignored; hint: did you mean `max_velocity`?",
                "limits.yaml:6:3: error[R0271]: joint `b` has no limits; expected max_velocity, max_acceleration, ...",
                "limits.yaml:7:3: error[R0271]: `min_position` is above `max_position`",
            ]
        );
        assert_eq!(limits["c"].lower, None);
    }

    #[test]
    fn limits_are_applied_where_they_are_given() {
        let mut builder = RobotBuilder::new("r");
        builder.link("base", Vec::new(), Vec::new(), None);
        builder.link("arm", Vec::new(), Vec::new(), None);
        let limits = (-1.0, 1.0, false, DynamicLimits::DEFAULT);
        let turn = JointMotion::Revolute;
        builder.moving("turn", turn, "base", "arm", Origin::default(), [0.0, 0.0, 1.0], limits, None);
        let model = builder.build().unwrap();
        let (limits, _) =
            read("joint_limits:\n  turn: {max_jerk: 7, max_position: 0.5}\n  trun: {max_velocity: 1}\n");
        let mut found = Diagnostics::new();
        let limited = apply(&limits, &model, &mut found);
        let dof = &limited.dofs()[limited.dof_named("turn").unwrap()];
        let expected = DynamicLimits { jerk: 7.0, given: [false, false, true], ..DynamicLimits::DEFAULT };
        assert_eq!((dof.dynamics, dof.lower, dof.upper), (expected, -1.0, 0.5));
        let found: Vec<&Diagnostic> = found.iter().collect();
        assert_eq!(
            (found.len(), found[0].code, found[0].hint.as_deref()),
            (1, "R0272", Some("did you mean `turn`?"))
        );
    }

    #[test]
    fn broken_yaml_is_an_error_with_a_line() {
        let (limits, text) = read("joint_limits:\n  a: [1, 2\n  b: }\n");
        assert!(limits.is_empty());
        assert!(text.starts_with("limits.yaml:3:") && text.contains("error[R0270]"), "{text}");
    }
}
