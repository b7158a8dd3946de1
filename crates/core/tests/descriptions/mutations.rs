//! Files made worse at random, by a fixed seed: whatever comes, the readers answer with findings.

use std::path::Path;

use robotc_core::diag::{Diagnostics, Sources};
use robotc_core::rng::{Rng, Seed};
use robotc_core::system::MemorySystem;
use robotc_core::urdf::{self, LoadOptions};
use robotc_core::{joint_limits, mesh, srdf};

use crate::data::shared;

const URDF: &str = include_str!("samples/arm.urdf");
const XACRO: &str = include_str!("samples/arm.urdf.xacro");
const SRDF: &str = include_str!("samples/arm.srdf");
const LIMITS: &str = include_str!("samples/joint_limits.yaml");
const DAE: &str = include_str!("samples/plate.dae");
const OBJ: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1/1 2/2 4/4\nf -1 -2 -3\n";
const STL: &str = "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n\
                   endsolid s\n";

/// Pieces that files break on.
const SPLINTERS: [&str; 24] = [
    "<",
    ">",
    "/>",
    "</",
    "\"",
    "'",
    "&",
    "&#x0;",
    "<!--",
    "-->",
    "<![CDATA[",
    "]]>",
    "<?xml",
    "${",
    "}",
    "$(",
    "nan",
    "1e999",
    "-",
    "\u{0}",
    "<<<<<<< a\n",
    "99999999999999999999",
    "<robot>",
    "xmlns:",
];

/// `bytes` with one to four faults put in.
fn mutated(bytes: &[u8], rng: &mut Rng) -> Vec<u8> {
    let mut out = bytes.to_vec();
    for _ in 0..=rng.below(4) {
        if out.is_empty() {
            break;
        }
        let at = rng.below(out.len());
        let end = (at + rng.below(40)).min(out.len());
        match rng.below(7) {
            0 => out[at] ^= 1 << rng.below(8),
            1 => out.truncate(at),
            2 => drop(out.drain(at..end)),
            3 => drop(out.splice(at..at, SPLINTERS[rng.below(SPLINTERS.len())].bytes())),
            4 => {
                let piece = out[at..end].to_vec();
                let to = rng.below(out.len());
                drop(out.splice(to..to, piece));
            }
            5 => swap_lines(&mut out, rng),
            _ => out[at] = rng.bits() as u8,
        }
    }
    out
}

fn swap_lines(bytes: &mut Vec<u8>, rng: &mut Rng) {
    let mut lines: Vec<Vec<u8>> = bytes.split(|b| *b == b'\n').map(<[u8]>::to_vec).collect();
    let (a, b) = (rng.below(lines.len()), rng.below(lines.len()));
    lines.swap(a, b);
    *bytes = lines.join(&b'\n');
}

/// Every finding must have a place that can be shown.
fn shown(found: &Diagnostics, sources: &Sources) {
    assert!(found.is_empty() || !found.to_plain_text(sources).is_empty());
}

/// Reads `bytes` as the file `name` by the reader that the name calls for.
fn read(name: &str, bytes: &[u8]) {
    let mut system = MemorySystem::new();
    system.insert(name, bytes);
    let mut sources = Sources::new();
    let path = Path::new(name);
    match path.extension().and_then(|e| e.to_str()).unwrap_or_default() {
        "urdf" | "xacro" => {
            let (model, found) = urdf::load(&system, &mut sources, path, &LoadOptions::default());
            assert_eq!(model.is_none(), found.has_errors());
            shown(&found, &sources);
        }
        "srdf" => shown(&srdf::load(&system, &mut sources, path, None).1, &sources),
        "yaml" => shown(&joint_limits::load(&system, &mut sources, path).1, &sources),
        extension => {
            if let Ok(loaded) = mesh::read(bytes, extension) {
                let count = loaded.mesh.vertices.len();
                assert!(loaded.mesh.faces.iter().flatten().all(|&v| (v as usize) < count));
                assert!(loaded.mesh.vertices.iter().all(|v| v.coords.iter().all(|x| x.is_finite())));
            }
        }
    }
}

fn try_mutations(name: &str, bytes: &[u8], count: usize) {
    let seed = Seed::new(20).split(name);
    for i in 0..count {
        read(name, &mutated(bytes, &mut seed.at(i as u64).rng()));
    }
}

#[test]
fn samples_are_right_before_they_are_made_worse() {
    for (name, text) in [("a.urdf", URDF), ("a.urdf.xacro", XACRO)] {
        let mut system = MemorySystem::new();
        system.insert(name, text);
        let mut sources = Sources::new();
        let (model, found) = urdf::load(&system, &mut sources, Path::new(name), &LoadOptions::default());
        assert_eq!((model.unwrap().dofs().len(), found.to_plain_text(&sources).as_str()), (2, ""));
    }
    assert_eq!(mesh::read(DAE.as_bytes(), "dae").unwrap().mesh.faces.len(), 2);
}

#[test]
fn mutated_descriptions_are_answered() {
    try_mutations("a.urdf", URDF.as_bytes(), 3000);
    try_mutations("a.urdf.xacro", XACRO.as_bytes(), 3000);
    try_mutations("a.srdf", SRDF.as_bytes(), 1500);
    try_mutations("joint_limits.yaml", LIMITS.as_bytes(), 1500);
}

#[test]
fn mutated_meshes_are_answered() {
    try_mutations("m.dae", DAE.as_bytes(), 2000);
    try_mutations("m.obj", OBJ.as_bytes(), 2000);
    try_mutations("m.stl", STL.as_bytes(), 2000);
    let mut binary = vec![b' '; 80];
    binary.extend(3_u32.to_le_bytes());
    binary.extend((0..150).map(|i| i as u8));
    try_mutations("b.stl", &binary, 2000);
}

#[test]
fn mutated_real_files_are_answered() {
    let Some(folder) = shared() else { return };
    for file in [
        "arms/ur_ur5e.urdf",
        "arms/kawada_nextage_open.urdf",
        "broken-urdf/mycobot_ros__mycobot_pro_600_moveit.urdf",
        "robots/tiago/meshes/arm/arm_3_collision.dae",
        "robots/barrett_wam7_bhand/barrett_model/models/sw_meshes/bhand/bhand_finger_med_link_convex.dae",
    ] {
        let bytes = std::fs::read(folder.join(file)).unwrap();
        try_mutations(file.rsplit('/').next().unwrap(), &bytes, 60);
    }
}
