//! A checked draft as plain URDF text, the form that any URDF reader takes.

use std::fmt::Write;

use super::draft::{Draft, GeometryDraft, JointDraft, JointKind, LinkDraft, ShapeDraft};
use crate::model::Origin;

/// The canonical text of `draft`. Numbers are written so that they read back to the same bits.
pub(super) fn text(draft: &Draft) -> String {
    let mut out = String::new();
    // Writing to a string cannot fail.
    let _ = write(&mut out, draft);
    out
}

/// The canonical text of one link; alike links have the same text.
pub(super) fn link(link: &LinkDraft) -> String {
    let mut out = String::new();
    let _ = write_link(&mut out, link);
    out
}

fn write(out: &mut String, draft: &Draft) -> std::fmt::Result {
    writeln!(out, "<robot name=\"{}\">", escaped(&draft.name))?;
    for link in &draft.links {
        write_link(out, link)?;
    }
    for joint in &draft.joints {
        write_joint(out, joint)?;
    }
    writeln!(out, "</robot>")
}

fn write_link(out: &mut String, link: &LinkDraft) -> std::fmt::Result {
    writeln!(out, "<link name=\"{}\">", escaped(&link.name.text))?;
    if let Some(inertial) = &link.inertial {
        let [ixx, ixy, ixz, iyy, iyz, izz] = inertial.inertia;
        writeln!(out, "<inertial>{}<mass value=\"{}\"/>", origin(&inertial.origin), inertial.mass)?;
        writeln!(
            out,
            "<inertia ixx=\"{ixx}\" ixy=\"{ixy}\" ixz=\"{ixz}\" iyy=\"{iyy}\" iyz=\"{iyz}\" izz=\"{izz}\"/></inertial>"
        )?;
    }
    for (tag, geometries) in [("visual", &link.visuals), ("collision", &link.collisions)] {
        for geometry in geometries {
            write_geometry(out, tag, geometry)?;
        }
    }
    writeln!(out, "</link>")
}

fn write_geometry(out: &mut String, tag: &str, geometry: &GeometryDraft) -> std::fmt::Result {
    write!(out, "<{tag}>{}<geometry>", origin(&geometry.origin))?;
    match &geometry.shape {
        ShapeDraft::Box { size } => write!(out, "<box size=\"{}\"/>", joined(size))?,
        ShapeDraft::Cylinder { radius, length } => {
            write!(out, "<cylinder radius=\"{radius}\" length=\"{length}\"/>")?
        }
        ShapeDraft::Capsule { radius, length } => {
            write!(out, "<capsule radius=\"{radius}\" length=\"{length}\"/>")?
        }
        ShapeDraft::Sphere { radius } => write!(out, "<sphere radius=\"{radius}\"/>")?,
        ShapeDraft::Mesh { uri, scale } => {
            write!(out, "<mesh filename=\"{}\" scale=\"{}\"/>", escaped(&uri.text), joined(scale))?;
        }
    }
    write!(out, "</geometry>")?;
    if let Some(rgba) = geometry.colour.filter(|_| tag == "visual") {
        write!(out, "<material name=\"\"><color rgba=\"{}\"/></material>", joined(&rgba))?;
    }
    writeln!(out, "</{tag}>")
}

fn write_joint(out: &mut String, joint: &JointDraft) -> std::fmt::Result {
    let (name, kind) = (escaped(&joint.name.text), joint.kind.name());
    writeln!(out, "<joint name=\"{name}\" type=\"{kind}\">{}", origin(&joint.origin))?;
    writeln!(
        out,
        "<parent link=\"{}\"/><child link=\"{}\"/>",
        escaped(&joint.parent.text),
        escaped(&joint.child.text)
    )?;
    if joint.kind != JointKind::Fixed {
        writeln!(out, "<axis xyz=\"{}\"/>", joined(&joint.axis))?;
        let limits = &joint.limits;
        let [lower, upper, velocity, effort] =
            [limits.lower, limits.upper, limits.velocity, limits.effort].map(|x| x.unwrap_or(0.0));
        writeln!(
            out,
            "<limit lower=\"{lower}\" upper=\"{upper}\" velocity=\"{velocity}\" effort=\"{effort}\"/>"
        )?;
    }
    if let Some(mimic) = &joint.mimic {
        let (leader, multiplier, offset) = (escaped(&mimic.joint.text), mimic.multiplier, mimic.offset);
        writeln!(out, "<mimic joint=\"{leader}\" multiplier=\"{multiplier}\" offset=\"{offset}\"/>")?;
    }
    writeln!(out, "</joint>")
}

fn origin(origin: &Origin) -> String {
    format!("<origin xyz=\"{}\" rpy=\"{}\"/>", joined(&origin.xyz), joined(&origin.rpy))
}

fn joined(numbers: &[f64]) -> String {
    let words: Vec<String> = numbers.iter().map(f64::to_string).collect();
    words.join(" ")
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
        .replace('\'', "&apos;")
}
