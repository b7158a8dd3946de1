//! `isaac_grasp` YAML, version 1.0: what the grasp editor of Isaac Sim writes and its importer reads.

use std::collections::BTreeMap;
use std::fmt::Write;

use nalgebra::{Quaternion, Translation3, UnitQuaternion};
use robotc_core::Pose;
use serde::Deserialize;

use super::{FileGrasp, FormatError, GraspFile};

#[derive(Deserialize)]
struct File {
    format: String,
    #[serde(default)]
    object_frame_link: String,
    #[serde(default)]
    gripper_frame_link: String,
    grasps: BTreeMap<String, Entry>,
}

#[derive(Deserialize)]
struct Entry {
    #[serde(default = "one")]
    confidence: f64,
    position: [f64; 3],
    orientation: Orientation,
    #[serde(default)]
    cspace_position: BTreeMap<String, f64>,
    #[serde(default)]
    pregrasp_cspace_position: BTreeMap<String, f64>,
}

#[derive(Deserialize)]
struct Orientation {
    w: f64,
    xyz: [f64; 3],
}

fn one() -> f64 {
    1.0
}

pub(super) fn read(text: &str) -> Result<GraspFile, FormatError> {
    let wrong = |reason: String| FormatError { format: "isaac_grasp", reason };
    let file: File = serde_saphyr::from_str(text).map_err(|error| wrong(error.to_string()))?;
    if file.format != "isaac_grasp" {
        return Err(wrong(format!("its format is \"{}\"", file.format)));
    }
    let mut joints: Vec<String> =
        file.grasps.values().flat_map(|g| g.cspace_position.keys().cloned()).collect();
    joints.sort();
    joints.dedup();
    // Names end in numbers, which sort as numbers.
    let mut entries: Vec<(String, Entry)> = file.grasps.into_iter().collect();
    let number = |name: &str| {
        let digits = name.rfind(|c: char| !c.is_ascii_digit()).map_or(0, |i| i + 1);
        name[digits..].parse::<u64>().unwrap_or(u64::MAX)
    };
    entries.sort_by_key(|(name, _)| number(name));
    let grasp = |(name, entry): (String, Entry)| {
        let Orientation { w, xyz: [x, y, z] } = entry.orientation;
        let rotation = UnitQuaternion::try_new(Quaternion::new(w, x, y, z), 1e-6)
            .ok_or_else(|| wrong(format!("the orientation of {name} has no length")))?;
        let values = |map: &BTreeMap<String, f64>| {
            let value = |joint: &String| map.get(joint).copied();
            joints.iter().map(value).collect::<Option<Vec<f64>>>().unwrap_or_default()
        };
        let (closed, open) = (values(&entry.cspace_position), values(&entry.pregrasp_cspace_position));
        let numbers = entry.position.iter().chain(&closed).chain(&open).chain([&entry.confidence]);
        if !numbers.chain(rotation.coords.iter()).all(|x| x.is_finite()) {
            return Err(wrong(format!("{name} holds a number that is not finite")));
        }
        let object_from_gripper = Pose::from_parts(Translation3::from(entry.position), rotation);
        Ok(FileGrasp { object_from_gripper, closed, open, confidence: entry.confidence })
    };
    let grasps = entries.into_iter().map(grasp).collect::<Result<_, _>>()?;
    Ok(GraspFile { object: file.object_frame_link, gripper_link: file.gripper_frame_link, joints, grasps })
}

pub(super) fn write(file: &GraspFile) -> String {
    let mut text = String::from("format: isaac_grasp\nformat_version: 1.0\n\n");
    let line = |text: &mut String, line: String| {
        text.push_str(&line);
        text.push('\n');
    };
    line(&mut text, format!("object_frame_link: {}", quoted(&file.object)));
    line(&mut text, format!("gripper_frame_link: {}\n", quoted(&file.gripper_link)));
    line(&mut text, "grasps:".into());
    for (i, grasp) in file.grasps.iter().enumerate() {
        let p = grasp.object_from_gripper.translation.vector;
        let q = grasp.object_from_gripper.rotation.quaternion();
        line(&mut text, format!("  grasp_{i}:\n    confidence: {}", number(grasp.confidence)));
        line(&mut text, format!("    position: {}", list(&[p.x, p.y, p.z])));
        line(&mut text, format!("    orientation: {{w: {}, xyz: {}}}", number(q.w), list(&[q.i, q.j, q.k])));
        for (key, values) in [("cspace_position", &grasp.closed), ("pregrasp_cspace_position", &grasp.open)] {
            line(&mut text, format!("    {key}:"));
            for (joint, value) in file.joints.iter().zip(values) {
                line(&mut text, format!("      {}: {}", quoted(joint), number(*value)));
            }
        }
    }
    if file.grasps.is_empty() {
        // An empty map, not nothing.
        text.truncate(text.trim_end().len());
        text.push_str(" {}\n");
    }
    text
}

fn list(numbers: &[f64]) -> String {
    let mut text = String::from("[");
    for (i, x) in numbers.iter().enumerate() {
        let comma = if i > 0 { ", " } else { "" };
        write!(text, "{comma}{}", number(*x)).expect("text takes everything");
    }
    text + "]"
}

/// A number that YAML 1.1 takes for one as well: it wants a point before an exponent, and a sign in it.
fn number(x: f64) -> String {
    let text = format!("{x:?}");
    let Some((digits, exponent)) = text.split_once('e') else { return text };
    let point = if digits.contains('.') { "" } else { ".0" };
    let sign = if exponent.starts_with('-') { "" } else { "+" };
    format!("{digits}{point}e{sign}{exponent}")
}

/// A text in double quotes, in which JSON and YAML agree.
fn quoted(text: &str) -> String {
    serde_json::Value::from(text).to_string()
}
