//! Descriptions of robots that others wrote: URDF, xacro, SRDF, joint limits, meshes.

use std::path::Path;

use robotc_core::diag::{Diagnostics, Sources};
use robotc_core::spec::{self, InitOptions};
use robotc_core::urdf::{self, LoadOptions};
use robotc_core::{joint_limits as limits_file, mesh as mesh_file, srdf as srdf_file};

use crate::surroundings::{no_parameters, shown, surroundings};

/// Any bytes as a URDF file: findings or a model, and from a model a specification that loads.
pub(crate) fn urdf(bytes: &[u8]) {
    described("robot.urdf", bytes);
}

/// Any bytes as a xacro file.
pub(crate) fn xacro(bytes: &[u8]) {
    described("robot.xacro", bytes);
}

fn described(name: &str, bytes: &[u8]) {
    let mut system = surroundings();
    system.insert(name, bytes);
    let mut sources = Sources::new();
    let (model, found) = urdf::load(&system, &mut sources, Path::new(name), &LoadOptions::default());
    assert_eq!(model.is_none(), found.has_errors());
    shown(&found, &sources);
    if model.is_none() {
        return;
    }
    let options = InitOptions { description: name.into(), ..InitOptions::default() };
    let (Some(text), _) = spec::init(&system, &mut Sources::new(), &options) else { return };
    system.insert("guessed.robot.toml", text.as_bytes());
    let mut sources = Sources::new();
    let (_, found) =
        spec::load_robot(&system, &mut sources, Path::new("guessed.robot.toml"), &no_parameters());
    assert!(!found.has_errors(), "what was guessed is refused: {}\n{text}", found.to_plain_text(&sources));
}

/// Any bytes as an SRDF file, alone and beside the robot it is about.
pub(crate) fn srdf(bytes: &[u8]) {
    let mut system = surroundings();
    system.insert("robot.srdf", bytes);
    let (model, _) =
        urdf::load(&system, &mut Sources::new(), Path::new("files/arm.urdf"), &LoadOptions::default());
    for model in [None, model.as_ref()] {
        let mut sources = Sources::new();
        let (_, found) = srdf_file::load(&system, &mut sources, Path::new("robot.srdf"), model);
        shown(&found, &sources);
    }
}

/// Any bytes as a joint limit file: limits that are given are usable.
pub(crate) fn joint_limits(bytes: &[u8]) {
    let mut system = surroundings();
    system.insert("joint_limits.yaml", bytes);
    let mut sources = Sources::new();
    let (limits, found) = limits_file::load(&system, &mut sources, Path::new("joint_limits.yaml"));
    shown(&found, &sources);
    for joint in limits.values() {
        let speeds = [joint.velocity, joint.acceleration, joint.jerk];
        assert!(speeds.into_iter().flatten().all(|x| x > 0.0 && x.is_finite()));
    }
    let (model, _) = urdf::load(&system, &mut sources, Path::new("files/arm.urdf"), &LoadOptions::default());
    let mut found = Diagnostics::new();
    limits_file::apply(&limits, &model.expect("the arm is right"), &mut found);
    shown(&found, &sources);
}

/// Any bytes as a mesh file of each format: an error or a sound mesh.
pub(crate) fn mesh(bytes: &[u8]) {
    for extension in ["stl", "obj", "dae"] {
        if let Ok(loaded) = mesh_file::read(bytes, extension) {
            let count = loaded.mesh.vertices.len();
            assert!(loaded.mesh.faces.iter().flatten().all(|&v| (v as usize) < count));
            assert!(loaded.mesh.vertices.iter().all(|v| v.coords.iter().all(|x| x.is_finite())));
        }
    }
}
