//! `check` over each kind of file.

use std::path::Path;

use robotc_core::diag::Sources;
use robotc_core::spec::check;
use robotc_core::urdf::LoadOptions;

use super::disk::{Disk, parameters};

fn summary(file: &str) -> Result<(&'static str, String, String), String> {
    let mut sources = Sources::new();
    let disk = Disk::of_checkout("tests/specs");
    let (summary, found) =
        check(&disk, &mut sources, Path::new(file), &parameters(), &LoadOptions::default());
    assert_ne!(summary.is_some(), found.has_errors());
    match summary {
        Some(summary) => Ok((summary.what, summary.name, summary.facts.join("; "))),
        None => Err(found.to_plain_text(&sources)),
    }
}

#[test]
fn each_kind_of_file_is_recognised() {
    let (what, name, facts) = summary("files/semantic.robot.toml").unwrap();
    assert_eq!((what, name.as_str()), ("robot specification", "semantic"));
    let model = "7 links, 6 joints, 4 degrees of freedom, 7 of the links with collision shapes";
    let expected = format!(
        "{model}; arm upper: 3 joints from base_link to palm, gripper hand; gripper hand: 1 joint, 2 finger links, \
         1 preshape; planar base, not holonomic"
    );
    assert_eq!(facts, expected);
    let (what, _, facts) = summary("files/wedge.task.toml").unwrap();
    assert_eq!(what, "task specification");
    assert_eq!(facts, "robot semantic, arm upper; 2 objects, 1 obstacle, 2 goals");
    let (what, name, facts) = summary("files/arm.urdf").unwrap();
    assert_eq!((what, name.as_str(), facts.as_str()), ("robot description", "small_arm", model));
    let (what, _, facts) = summary("files/arm.srdf").unwrap();
    assert_eq!(
        (what, facts.as_str()),
        ("semantic description", "3 groups; 1 end effector; 2 disabled pairs")
    );
    let (what, _, facts) = summary("files/joint_limits.yaml").unwrap();
    assert_eq!((what, facts.as_str()), ("joint limits", "2 joints"));
}

#[test]
fn a_link_may_be_said_to_have_no_shape() {
    // `mesh_missing.robot.toml`, which does not say so, is among the findings.
    let (_, _, facts) = summary("files/bracket.robot.toml").unwrap();
    assert!(
        facts.starts_with("3 links, 2 joints, 1 degree of freedom, 2 of the links with collision shapes"),
        "{facts}"
    );
}

#[test]
fn other_files_are_refused() {
    assert!(summary("files/wedge.obj").unwrap_err().contains("error[R0115]"));
    assert!(summary("files/nothing").unwrap_err().contains("error[R0001]"));
}
