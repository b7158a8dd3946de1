//! XML tree to draft: one function for each URDF element.

use std::collections::BTreeMap;

use super::attributes::{number, numbers, parse_numbers, required};
use super::draft::{
    Draft, GeometryDraft, JointDraft, JointKind, LimitsDraft, LinkDraft, MimicDraft, Name, ShapeDraft,
};
use super::grouped::{Grouped, and_others};
use crate::diag::{Diagnostic, Diagnostics, nearest};
use crate::model::{Inertial, Origin};
use crate::xml::Element;

/// Children of `<robot>` that this reader knows; others are extensions of some simulator and are skipped.
const KNOWN: [&str; 6] = ["link", "joint", "material", "gazebo", "transmission", "ros2_control"];

/// Most links, and most joints, of a robot: beyond that the checks, which compare each with each, would take minutes.
const MOST_PARTS: usize = 10_000;

/// The draft of a `<robot>` element, or `None` if it is not one.
pub(super) fn read(root: &Element, found: &mut Diagnostics) -> Option<Draft> {
    if root.name != "robot" {
        let message = format!("the root element is `<{}>`: not a robot description", root.name);
        let mut d = Diagnostic::error("R0207", message).at(root.span, "not `<robot>`").expected("`<robot>`");
        if root.name == "sdf" {
            d = d.hint("this is an SDFormat file; convert it to URDF");
        }
        found.push(d);
        return None;
    }
    let name = match root.value("name").map(str::trim).filter(|n| !n.is_empty()) {
        Some(name) => name.to_owned(),
        None => {
            found.push(
                Diagnostic::warning("R0208", "the robot has no name; it is called `robot`")
                    .at(root.span, "`name` is missing"),
            );
            "robot".to_owned()
        }
    };
    if root.named("link").count().max(root.named("joint").count()) > MOST_PARTS {
        let message = format!("the robot has more than {MOST_PARTS} links or joints");
        found.push(Diagnostic::error("R0206", message).at(root.span, "this robot"));
        return None;
    }
    let colours = materials(root, found);
    let mut masses = Grouped::default();
    let mut draft = Draft { name, span: root.span, links: Vec::new(), joints: Vec::new() };
    let mut xacro = Grouped::default();
    for element in root.elements() {
        match element.name.as_str() {
            "link" => draft.links.extend(link(element, &colours, &mut masses, found)),
            "joint" => draft.joints.extend(joint(element, found)),
            other if other.starts_with("xacro:") => xacro.add(element.span, other),
            other => {
                if let Some(meant) = nearest(other, KNOWN).filter(|meant| *meant != other) {
                    let message = format!("unknown element `<{other}>` is ignored");
                    let hint = format!("did you mean `<{meant}>`?");
                    found.push(Diagnostic::warning("R0210", message).at(element.span, "unknown").hint(hint));
                }
            }
        }
    }
    masses.finish(found, |count, first| {
        Diagnostic::warning(
            "R0230",
            format!("link `{first}`{} has no positive mass; its inertia is ignored", and_others(count)),
        )
    });
    xacro.finish(found, |count, first| {
        Diagnostic::warning(
            "R0211",
            format!("xacro element `<{first}>`{} in a plain URDF; ignored", and_others(count)),
        )
        .hint("give the file the ending .xacro to have them expanded")
    });
    Some(draft)
}

/// Colours of the materials defined beside the links, by name.
fn materials(root: &Element, found: &mut Diagnostics) -> BTreeMap<String, [f64; 4]> {
    let mut colours = BTreeMap::new();
    for material in root.named("material") {
        if let (Some(name), Some(rgba)) = (material.value("name"), colour(material, found)) {
            colours.insert(name.to_owned(), rgba);
        }
    }
    colours
}

fn colour(material: &Element, found: &mut Diagnostics) -> Option<[f64; 4]> {
    let rgba = material.child("color")?.attribute("rgba")?;
    // A colour is no reason to refuse a robot.
    let mut complaints = Diagnostics::new();
    let parsed = parse_numbers::<4>(rgba, &mut complaints);
    for mut complaint in complaints {
        complaint.severity = crate::diag::Severity::Warning;
        found.push(complaint);
    }
    parsed.map(|c| c.map(|x| x.clamp(0.0, 1.0)))
}

fn named(element: &Element, attribute: &str, context: &str, found: &mut Diagnostics) -> Option<Name> {
    let attribute = required(element, attribute, context, found)?;
    Some(Name { text: attribute.value.trim().to_owned(), span: attribute.span })
}

fn link(
    element: &Element,
    colours: &BTreeMap<String, [f64; 4]>,
    masses: &mut Grouped,
    found: &mut Diagnostics,
) -> Option<LinkDraft> {
    let name = named(element, "name", "the robot", found)?;
    let mut geometries = |kind: &str| {
        let elements = element.named(kind);
        elements.filter_map(|e| geometry(e, &name.text, colours, found)).collect::<Vec<_>>()
    };
    let visuals = geometries("visual");
    let collisions = geometries("collision");
    let inertial = element.child("inertial").and_then(|e| inertial(e, &name, masses, found));
    Some(LinkDraft { name, visuals, collisions, inertial })
}

fn origin(parent: &Element, found: &mut Diagnostics) -> Origin {
    match parent.child("origin") {
        None => Origin::default(),
        Some(e) => {
            Origin { xyz: numbers(e, "xyz", [0.0; 3], found), rpy: numbers(e, "rpy", [0.0; 3], found) }
        }
    }
}

fn geometry(
    element: &Element,
    link: &str,
    colours: &BTreeMap<String, [f64; 4]>,
    found: &mut Diagnostics,
) -> Option<GeometryDraft> {
    let Some(shape) = element.child("geometry").and_then(|g| g.elements().next()) else {
        let message = format!("`<{}>` of link `{link}` has no shape; ignored", element.name);
        found.push(Diagnostic::warning("R0231", message).at(element.span, "empty"));
        return None;
    };
    let shape = self::shape(shape, link, found)?;
    let colour = element.child("material").and_then(|m| {
        colour(m, found).or_else(|| m.value("name").and_then(|name| colours.get(name).copied()))
    });
    Some(GeometryDraft { origin: origin(element, found), shape, colour })
}

fn shape(element: &Element, link: &str, found: &mut Diagnostics) -> Option<ShapeDraft> {
    let positive = |name: &str, found: &mut Diagnostics| -> Option<f64> {
        let attribute = required(element, name, &format!("link `{link}`"), found)?;
        let [x] = parse_numbers::<1>(attribute, found)?;
        size_is_positive(x, attribute, found).then_some(x)
    };
    match element.name.as_str() {
        "box" => {
            let attribute = required(element, "size", &format!("link `{link}`"), found)?;
            let size = parse_numbers::<3>(attribute, found)?;
            size.iter().all(|&x| size_is_positive(x, attribute, found)).then_some(ShapeDraft::Box { size })
        }
        "cylinder" => {
            let (radius, length) = (positive("radius", found), positive("length", found));
            Some(ShapeDraft::Cylinder { radius: radius?, length: length? })
        }
        "capsule" => {
            let (radius, length) = (positive("radius", found), positive("length", found));
            Some(ShapeDraft::Capsule { radius: radius?, length: length? })
        }
        "sphere" => Some(ShapeDraft::Sphere { radius: positive("radius", found)? }),
        "mesh" => {
            let uri = named(element, "filename", &format!("link `{link}`"), found)?;
            let scale = match element.attribute("scale") {
                None => [1.0; 3],
                Some(attribute) => match attribute.value.split_whitespace().count() {
                    // One factor for all axes is common and has one meaning.
                    1 => parse_numbers::<1>(attribute, found).map(|[s]| [s; 3])?,
                    _ => parse_numbers::<3>(attribute, found)?,
                },
            };
            if scale.contains(&0.0) {
                let message = format!("a mesh of link `{link}` is scaled to nothing");
                let span = element.attribute("scale").map_or(element.span, |a| a.span);
                found.push(
                    Diagnostic::error("R0231", message).at(span, "zero").expected("factors other than zero"),
                );
                return None;
            }
            Some(ShapeDraft::Mesh { uri, scale })
        }
        other => {
            let mut d = Diagnostic::error(
                "R0231",
                format!("link `{link}` has a shape `{other}`, which URDF does not know"),
            )
            .at(element.span, "unknown shape")
            .expected("box, cylinder, capsule, sphere or mesh");
            if let Some(meant) = nearest(other, ["box", "cylinder", "capsule", "sphere", "mesh"]) {
                d = d.hint(format!("did you mean `{meant}`?"));
            }
            found.push(d);
            None
        }
    }
}

fn size_is_positive(x: f64, attribute: &crate::xml::Attribute, found: &mut Diagnostics) -> bool {
    if x <= 0.0 {
        let message = format!("`{}` is {x}; the shape is ignored", attribute.name);
        found.push(
            Diagnostic::warning("R0231", message).at(attribute.span, "here").expected("a positive number"),
        );
    }
    x > 0.0
}

fn inertial(
    element: &Element,
    link: &Name,
    masses: &mut Grouped,
    found: &mut Diagnostics,
) -> Option<Inertial> {
    let mass = element.child("mass").and_then(|m| number(m, "value", found))?;
    if mass <= 0.0 {
        masses.add(link.span, &link.text);
        return None;
    }
    let names = ["ixx", "ixy", "ixz", "iyy", "iyz", "izz"];
    let tensor = element.child("inertia");
    let inertia = names.map(|name| tensor.and_then(|t| number(t, name, found)).unwrap_or(0.0));
    Some(Inertial { origin: origin(element, found), mass, inertia })
}

fn joint(element: &Element, found: &mut Diagnostics) -> Option<JointDraft> {
    let name = named(element, "name", "the robot", found)?;
    let context = format!("joint `{}`", name.text);
    let kind = kind(element, &context, found);
    let mut end = |which: &str| {
        let Some(e) = element.child(which) else {
            let message = format!("{context} has no `<{which}>`");
            found.push(
                Diagnostic::error("R0208", message).at(element.span, format!("`<{which}>` is missing")),
            );
            return None;
        };
        named(e, "link", &context, found)
    };
    let (parent, child) = (end("parent"), end("child"));
    let axis = element.child("axis");
    let limit = element.child("limit");
    let safety = element.child("safety_controller");
    let soft = |name: &str, found: &mut Diagnostics| safety.and_then(|s| number(s, name, found));
    let moves = kind.is_some_and(JointKind::moves);
    // Numbers of a fixed joint's axis and limits mean nothing: they are not even looked at.
    let limits = match limit.filter(|_| moves) {
        None => LimitsDraft::default(),
        Some(e) => LimitsDraft {
            lower: number(e, "lower", found),
            upper: number(e, "upper", found),
            velocity: number(e, "velocity", found),
            effort: number(e, "effort", found),
        },
    };
    let mimic = element.child("mimic").filter(|_| moves).and_then(|m| {
        Some(MimicDraft {
            joint: named(m, "joint", &context, found)?,
            multiplier: number(m, "multiplier", found).unwrap_or(1.0),
            offset: number(m, "offset", found).unwrap_or(0.0),
        })
    });
    Some(JointDraft {
        kind: kind?,
        parent: parent?,
        child: child?,
        origin: origin(element, found),
        axis: axis.filter(|_| moves).map_or([1.0, 0.0, 0.0], |a| numbers(a, "xyz", [1.0, 0.0, 0.0], found)),
        axis_span: axis.map_or(element.span, |a| a.attribute("xyz").map_or(a.span, |x| x.span)),
        limits,
        limits_span: limit.map_or(element.span, |l| l.span),
        soft_limits: (soft("soft_lower_limit", found), soft("soft_upper_limit", found)),
        mimic,
        name,
    })
}

fn kind(element: &Element, context: &str, found: &mut Diagnostics) -> Option<JointKind> {
    let attribute = required(element, "type", context, found)?;
    let written = attribute.value.trim();
    let known = JointKind::NAMES.iter().find(|(name, _)| *name == written);
    if known.is_none() {
        let names = JointKind::NAMES.map(|(name, _)| name);
        let mut d = Diagnostic::error("R0220", format!("{context} has the unknown type `{written}`"))
            .at(attribute.span, "unknown type")
            .expected(names.join(", "));
        if let Some(meant) = nearest(written, names) {
            d = d.hint(format!("did you mean `{meant}`?"));
        }
        found.push(d);
    }
    known.map(|(_, kind)| *kind)
}
