//! Decompositions of made-up and of real meshes.

use nalgebra::{Point3, Vector3};

use super::super::box_part;
use super::*;

fn height(mesh: &TriMesh, parts: &ConvexParts) -> f64 {
    mesh.vertices.iter().map(|p| parts.height(p)).fold(f64::NEG_INFINITY, f64::max)
}

#[test]
fn a_box_is_one_part() {
    let mesh = box_part(Vector3::new(1.0, 2.0, 3.0)).mesh();
    let parts = decompose(&mesh, &DecomposeOptions::default()).expect("finite");
    assert_eq!(parts.len(), 1);
    assert!((parts.as_slice()[0].volume() - 6.0).abs() < 1e-9);
}

#[test]
fn two_boxes_stay_two() {
    let mut mesh = box_part(Vector3::repeat(1.0)).mesh();
    mesh.append(&box_part(Vector3::repeat(1.0)).mesh().transformed(&crate::Pose::translation(1.5, 0.0, 0.0)));
    let parts = decompose(&mesh, &DecomposeOptions::default()).expect("finite");
    assert_eq!(parts.len(), 2);
    assert!((parts.iter().map(|p| p.volume()).sum::<f64>() - 2.0).abs() < 1e-6);
}

/// Meshes below the shared data folder, as loaded, without their file's scale.
fn real_mesh(path: &str) -> Option<TriMesh> {
    let root = std::env::var("ROBOTC_SHARED_DATA")
        .unwrap_or_else(|_| concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data").to_owned());
    let bytes = std::fs::read(format!("{root}/{path}")).ok()?;
    let scene = mesh_loader::Loader::default().load_from_slice(&bytes, path).expect("the file is a mesh");
    let mut mesh = TriMesh::default();
    for m in scene.meshes {
        let vertices = m.vertices.iter().map(|v| Point3::from(v.map(f64::from))).collect();
        mesh.append(&TriMesh { vertices, faces: m.faces });
    }
    Some(mesh)
}

/// Some of each kind: closed and open, thick and thin, made of one sheet, made of many parts.
const REAL_MESHES: &[&str] = &[
    "objects/household/mug.obj",
    "objects/household/mug_col.obj",
    "objects/household/tray_textured.obj",
    "objects/industrial/ariac_regulator_collision.stl",
    "objects/tools/cordless_drill.stl",
    "objects/ycb/004_sugar_box.obj",
    "objects/articulated/kitchen/motion_bench_maker/configs/scenes/kitchen/meshes/cupboard_door_l.stl",
    "robots/franka_panda_hand/meshes/collision/hand.obj",
    "robots/franka_panda_hand/meshes/collision/link5.obj",
    "robots/fetch/fetch_description/meshes/elbow_flex_link_collision.STL",
    "robots/barrett_wam7_bhand/barrett_model/models/sw_meshes/bhand/bhand_finger_med_link_fine.stl",
];

#[test]
fn parts_cover_real_meshes_and_are_small() {
    let options = DecomposeOptions::default();
    for path in REAL_MESHES {
        let Some(mesh) = real_mesh(path) else {
            println!("skipped: shared data not present");
            return;
        };
        let parts = decompose(&mesh, &options).expect("real meshes have finite vertices");
        let (low, high) = mesh.bounds().expect("real meshes have vertices");
        let size = (high - low).norm();
        assert!(height(&mesh, &parts) <= 1e-9 * size, "{path}: {}", height(&mesh, &parts));
        let mut rng = crate::rng::Seed::new(1).rng();
        for _ in 0..1000 {
            let [a, b, c] = mesh.triangle(rng.below(mesh.faces.len()));
            let (u, v) = (rng.unit(), rng.unit());
            let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
            let p = a + (b - a) * u + (c - a) * v;
            assert!(parts.height(&p) <= 1e-6 * size, "{path}: {p} sticks out by {}", parts.height(&p));
        }
        assert!(parts.len() <= options.max_parts, "{path}: {} parts", parts.len());
        assert!(parts.iter().all(|p| p.points().len() <= options.max_vertices), "{path}");
        for part in &parts {
            let again = ConvexPart::from_raw(part.points().to_vec(), part.triangles().to_vec());
            assert_eq!(again.as_ref(), Ok(part), "{path}");
        }
        assert_eq!(decompose(&mesh, &options).as_ref(), Ok(&parts), "{path}: not the same twice");
    }
}

#[test]
fn almost_convex_links_are_one_part() {
    for link in ["link0", "link1", "link2", "link3", "link4", "link5", "link7", "hand", "finger"] {
        let Some(mesh) = real_mesh(&format!("robots/franka_panda_hand/meshes/collision/{link}.obj")) else {
            println!("skipped: shared data not present");
            return;
        };
        let parts = decompose(&mesh, &DecomposeOptions::default()).expect("finite");
        assert_eq!(parts.len(), 1, "{link}");
    }
}

/// A cup of revolution about z with a square handle in the xz plane: outer radius 40 mm, wall 3 mm, height 100 mm,
/// handle from 40 to 70 mm with a hole 21 mm wide and 52 mm high.
fn cup() -> TriMesh {
    let profile = [(0.0, 0.0), (0.04, 0.0), (0.04, 0.1), (0.037, 0.1), (0.037, 0.004), (0.0, 0.004)];
    let n = 32;
    let mut mesh = TriMesh::default();
    for i in 0..n {
        let angle = std::f64::consts::TAU * f64::from(i) / f64::from(n);
        let at = |(r, z): (f64, f64)| Point3::new(r * libm::cos(angle), r * libm::sin(angle), z);
        mesh.vertices.extend(profile.map(at));
    }
    let k = profile.len() as u32;
    for i in 0..n {
        let (a, b) = (k * i, k * ((i + 1) % n));
        for j in 0..k - 1 {
            mesh.faces.extend([[a + j, b + j, b + j + 1], [a + j, b + j + 1, a + j + 1]]);
        }
    }
    let bars = [
        ([0.035, 0.008, 0.009], [0.0525, 0.0245]),
        ([0.035, 0.008, 0.009], [0.0525, 0.0855]),
        ([0.009, 0.008, 0.07], [0.0655, 0.055]),
    ];
    for (size, [x, z]) in bars {
        let bar = box_part(Vector3::from(size)).mesh();
        mesh.append(&bar.transformed(&crate::Pose::translation(x, 0.0, z)));
    }
    mesh
}

#[test]
fn a_finger_fits_into_cup_and_handle() {
    let mesh = cup();
    let parts = decompose(&mesh, &DecomposeOptions::default()).expect("finite");
    assert!(height(&mesh, &parts) <= 1e-9);
    // A finger 16 mm thick inside the cup, 20 mm off its axis and 20 mm above its floor, and in the handle.
    let finger = super::super::sphere_part(0.008);
    for place in [[0.0, 0.0, 0.09], [0.02, 0.0, 0.05], [-0.01, 0.017, 0.024], [0.0505, 0.0, 0.055]] {
        let pose = crate::Pose::translation(place[0], place[1], place[2]);
        let identity = crate::Pose::identity();
        let blocked = parts.iter().any(|p| super::super::intersects(p, &identity, &finger, &pose));
        assert!(!blocked, "{place:?} is filled");
    }
    // The wall itself is not.
    assert!(parts.contains(&Point3::new(-0.0385, 0.0, 0.05)));
}

#[test]
fn refuses_what_has_no_shape() {
    let options = DecomposeOptions::default();
    assert_eq!(decompose(&TriMesh::default(), &options), Err(HullError::NoPoints));
    let bad = TriMesh { vertices: vec![Point3::new(f64::INFINITY, 0.0, 0.0)], faces: vec![] };
    assert_eq!(decompose(&bad, &options), Err(HullError::NotFinite));
    let lone = TriMesh { vertices: vec![Point3::new(1.0, 2.0, 3.0)], faces: vec![[0, 0, 7]] };
    let parts = decompose(&lone, &options).expect("a point has a tiny part");
    assert!(parts.contains(&lone.vertices[0]));
}
