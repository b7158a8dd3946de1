//! `init`: what it writes loads, over real robots.

use std::path::{Path, PathBuf};

use robotc_core::LinkIdx;
use robotc_core::diag::Sources;
use robotc_core::robot::{Base, Robot};
use robotc_core::spec::{InitOptions, ParameterTable, init, load_robot};
use robotc_core::system::{ReadError, System};

use super::disk::Disk;

/// A triangle of 10 cm, standing in for meshes that the collection of arms leaves out.
const STAND_IN: &str = "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 0.1 0 0\nvertex 0 0.1 0.1\n\
                        endloop\nendfacet\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 0 0.1 0.1\n\
                        vertex 0.1 0 0\nendloop\nendfacet\nendsolid s\n";

/// Files of the disk, one written specification, and stand-ins for missing meshes.
struct WithMeshes {
    disk: Disk,
    stand_in: bool,
    written: Option<(PathBuf, String)>,
}

impl WithMeshes {
    fn stands_in(&self, path: &Path) -> bool {
        let ending = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_lowercase();
        self.stand_in && ["stl", "dae", "obj"].contains(&ending.as_str()) && !self.disk.exists(path)
    }
}

impl System for WithMeshes {
    fn read(&self, path: &Path) -> Result<Vec<u8>, ReadError> {
        match &self.written {
            Some((written, text)) if written == path => Ok(text.clone().into_bytes()),
            _ if self.stands_in(path) => Ok(STAND_IN.as_bytes().to_vec()),
            _ => self.disk.read(path),
        }
    }

    fn exists(&self, path: &Path) -> bool {
        self.stands_in(path) || self.disk.exists(path)
    }
}

/// The text that `init` writes for a description below the shared data, and the robot that loading it gives.
fn guess(
    folder: &Path,
    description: &str,
    srdf: Option<&str>,
    stand_in: bool,
) -> Result<(String, Robot), String> {
    let disk = Disk { root: folder.to_path_buf() };
    let mut system = WithMeshes { disk, stand_in, written: None };
    let mut sources = Sources::new();
    let options = InitOptions {
        description: description.into(),
        srdf: srdf.map(PathBuf::from),
        folder: "specs".into(),
        ..InitOptions::default()
    };
    let (text, found) = init(&system, &mut sources, &options);
    let text = text.ok_or_else(|| found.to_plain_text(&sources))?;
    let path = PathBuf::from("specs/guess.robot.toml");
    system.written = Some((path.clone(), text.clone()));
    let mut sources = Sources::new();
    let (spec, found) = load_robot(&system, &mut sources, &path, &ParameterTable::default());
    let own = found.iter().any(|d| d.code.starts_with("R01") || d.code.starts_with("R04"));
    match spec {
        Some(spec) if !own => Ok((text, (*spec.robot).clone())),
        _ => Err(format!("{}{text}", found.to_plain_text(&sources))),
    }
}

fn shared() -> Option<PathBuf> {
    let given = std::env::var_os("ROBOTC_SHARED_DATA").map(PathBuf::from);
    let folder = given.unwrap_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data"));
    if folder.is_dir() {
        return Some(folder);
    }
    eprintln!("skipped: shared data not present");
    None
}

/// Description, whether it drives, and for each arm: degrees of freedom, tip, `closing` of its gripper.
type Expected = (&'static str, bool, &'static [(usize, &'static str, &'static [f64])]);

const ROBOTS: &[Expected] = &[
    ("robots/franka_panda_hand/panda.urdf", false, &[(7, "panda_hand", &[-1.0])]),
    ("robots/xarm6_gripper/xarm6_with_gripper.urdf", false, &[(6, "xarm_gripper_base_link", &[1.0])]),
    (
        "robots/barrett_wam7_bhand/wam7_bhand.urdf",
        false,
        &[(7, "wam/bhand/bhand_palm_link", &[0.0, 0.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0])],
    ),
    (
        "robots/pr2_simplified/pr2_simplified.urdf",
        true,
        &[
            (7, "r_gripper_palm_link", &[-1.0, -1.0, 1.0, 1.0]),
            (7, "l_gripper_palm_link", &[-1.0, -1.0, 1.0, 1.0]),
        ],
    ),
    ("robots/fetch/fetch.urdf", true, &[(7, "gripper_link", &[-1.0, -1.0])]),
    ("robots/kinova_gen3_robotiq_2f85/gen3_2f85.urdf", false, &[(7, "gen3_robotiq_85_base_link", &[1.0])]),
];

#[test]
fn complete_robots_are_understood() {
    let Some(folder) = shared() else { return };
    for (file, drives, arms) in ROBOTS {
        // One robot misses meshes of a camera.
        let stand_in = file.contains("kinova");
        let (text, robot) = guess(&folder, file, None, stand_in).unwrap();
        assert_eq!(robot.base != Base::Fixed, *drives, "{text}");
        let found: Vec<(usize, &str, &[f64])> = robot
            .arms
            .iter()
            .map(|arm| {
                let closing = arm.gripper.map_or(&[][..], |g| &robot.grippers[g].closing);
                (arm.dofs.len(), robot.model.links()[arm.tip].name.as_str(), closing)
            })
            .collect();
        assert_eq!(found, *arms, "{text}");
    }
}

#[test]
fn the_tool_frame_lies_between_the_finger_tips() {
    let Some(folder) = shared() else { return };
    // The makers give 0.1034 m for the Panda, and 0.172 m to the very tips for the other.
    for (file, height) in [(ROBOTS[0].0, 0.1034), (ROBOTS[1].0, 0.165)] {
        let (_, robot) = guess(&folder, file, None, false).unwrap();
        let tool = robot.grippers[0].palm_from_tool.translation.vector;
        assert!(tool.xy().norm() < 1e-3 && (tool.z - height).abs() < 0.01, "{file}: {tool}");
        assert!((robot.grippers[0].approach_in_tool.z - 1.0).abs() < 1e-12);
    }
}

#[test]
fn a_single_jaw_closes_on_its_palm() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/specifications");
    let (text, robot) = guess(&folder, "one_jaw.urdf", None, false).unwrap();
    let gripper = &robot.grippers[0];
    let names = |links: &[LinkIdx]| -> Vec<String> {
        links.iter().map(|&link| robot.model.links()[link].name.clone()).collect()
    };
    assert_eq!(names(&gripper.fingers), ["gripper_jaw", "link4"], "{text}");
    assert_eq!(names(&gripper.fixed_jaw(&robot.model)), ["link4"]);
    assert_eq!(gripper.closing, [-1.0], "{text}");
    // Half-way between the jaw when it is open and the palm.
    assert!((gripper.palm_from_tool.translation.y - 0.035).abs() < 1e-3, "{text}");
}

#[test]
fn groups_of_an_srdf_come_first() {
    let Some(folder) = shared() else { return };
    let panda = "motionbenchmaker/urdf/panda/panda";
    let srdf = format!("{panda}.srdf");
    let (text, robot) = guess(&folder, &format!("{panda}.urdf"), Some(&srdf), true).unwrap();
    assert_eq!(robot.arms[0].name, "panda_arm", "{text}");
    assert_eq!(robot.arms[0].home.as_ref().unwrap()[3], -2.356, "{text}");
    assert!(robot.arms[0].gripper.is_none(), "its fingers are fixed: {text}");
    assert!(robot.ignored_pairs.len() > 10, "{text}");
}

#[test]
fn every_arm_gets_a_specification_that_loads() {
    let Some(folder) = shared() else { return };
    let index = std::fs::read_to_string(folder.join("arms/INDEX.tsv")).unwrap();
    let mut failures = Vec::new();
    let (mut count, mut agree) = (0, 0);
    for row in index.lines().skip(1) {
        let cells: Vec<&str> = row.split('\t').collect();
        let (file, dofs) = (cells[0], cells[3].parse::<usize>().unwrap());
        count += 1;
        match guess(&folder, &format!("arms/{file}"), None, true) {
            Ok((_, robot)) => agree += usize::from(robot.arms.iter().any(|arm| arm.dofs.len() == dofs)),
            Err(why) => failures.push(format!("{file}: {why}")),
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
    // The index names one chain of each robot, chosen by people; a waist or a finger may differ.
    assert!(count > 100 && agree * 100 >= count * 95, "{agree} of {count} agree with the index");
}
