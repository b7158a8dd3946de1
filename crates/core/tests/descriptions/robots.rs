//! Complete robots with their meshes.

use std::sync::Arc;

use nalgebra::Point3;
use robotc_core::RobotModel;
use robotc_core::model::{Geometry, Shape, TriMesh};
use robotc_core::urdf::MeshPolicy;

use crate::data::{files, load, shared};

fn meshes(geometries: &[Geometry]) -> impl Iterator<Item = (&Arc<TriMesh>, &str)> {
    geometries.iter().filter_map(|g| match &g.shape {
        Shape::Mesh { mesh, uri } => Some((mesh, uri.as_str())),
        _ => None,
    })
}

#[test]
fn every_robot_loads_with_its_meshes() {
    let Some(folder) = shared().map(|s| s.join("robots")) else { return };
    let mut loaded = 0;
    for path in files(&folder, "urdf") {
        // The mount of a camera is in another package of the Kinova robot.
        let is_incomplete = path.ends_with("gen3_2f85.urdf");
        let policy = if is_incomplete { MeshPolicy::SkipAway } else { MeshPolicy::Load };
        let (model, _, text) = load(&path, policy);
        let model = model.unwrap_or_else(|| panic!("{text}"));
        let links = model.links().iter();
        let count = links.clone().map(|l| meshes(&l.collisions).count()).sum::<usize>();
        assert!(count > 5, "{}: {count} collision meshes", path.display());
        for (mesh, uri) in links.flat_map(|l| meshes(&l.collisions).chain(meshes(&l.visuals))) {
            let (low, high) = mesh.bounds().unwrap();
            let size = (high - low).norm();
            assert!(size > 0.005 && size < 3.0, "{}: {uri} measures {size} m", path.display());
        }
        loaded += 1;
    }
    assert_eq!(loaded, 7);
}

#[test]
fn a_missing_collision_mesh_names_the_joints_that_are_affected() {
    let Some(folder) = shared().map(|s| s.join("robots")) else { return };
    let path = folder.join("kinova_gen3_robotiq_2f85/gen3_2f85.urdf");
    let (model, _, text) = load(&path, MeshPolicy::Load);
    assert!(model.is_none());
    let line = text.lines().find(|l| l.contains("error[R0302]")).unwrap();
    assert!(
        line.contains(":726:25:") && line.contains("`gen3_joint_1`, `gen3_joint_2`, `gen3_joint_3`"),
        "{line}"
    );
    assert!(load(&path, MeshPolicy::SkipMissing).0.is_some());
}

/// Bounds of all meshes of one use in the frame of a link.
fn bounds(geometries: &[Geometry]) -> (Point3<f64>, Point3<f64>) {
    let mut all = TriMesh::default();
    for g in geometries {
        if let Shape::Mesh { mesh, .. } = &g.shape {
            all.append(&mesh.transformed(&g.origin.pose()));
        }
    }
    all.bounds().unwrap()
}

/// Links that are described twice, by COLLADA for one use and STL for the other: both must say the same.
#[test]
fn collada_and_stl_of_one_link_agree() {
    let Some(folder) = shared().map(|s| s.join("robots")) else { return };
    let agree = |model: &RobotModel, link: &str, tolerance: f64| {
        let link = &model.links()[model.link_named(link).unwrap()];
        let (visual, collision) = (bounds(&link.visuals), bounds(&link.collisions));
        let apart = (visual.0 - collision.0).amax().max((visual.1 - collision.1).amax());
        assert!(apart < tolerance, "{}: {apart} m apart", link.name);
    };
    let model = |file: &str, policy| load(&folder.join(file), policy).0.unwrap();
    let tiago = model("tiago/tiago.urdf", MeshPolicy::Load);
    for link in ["arm_1_link", "arm_2_link", "arm_3_link", "arm_4_link", "arm_5_link"] {
        agree(&tiago, link, 0.04);
    }
    let fetch = model("fetch/fetch.urdf", MeshPolicy::Load);
    for link in ["shoulder_pan_link", "upperarm_roll_link", "elbow_flex_link", "wrist_roll_link"] {
        agree(&fetch, link, 0.02);
    }
    let wam = model("barrett_wam7_bhand/wam7_bhand.urdf", MeshPolicy::Load);
    for link in ["wam/upper_arm_link", "wam/forearm_link", "wam/wrist_yaw_link", "wam/bhand_palm_link"] {
        if wam.link_named(link).is_some() {
            agree(&wam, link, 0.02);
        }
    }
}

#[test]
fn meshes_are_shared_by_file_and_scale() {
    let Some(folder) = shared().map(|s| s.join("robots")) else { return };
    let (model, _, text) = load(&folder.join("franka_panda_hand/panda.urdf"), MeshPolicy::Load);
    let model = model.unwrap_or_else(|| panic!("{text}"));
    let link = |name: &str| &model.links()[model.link_named(name).unwrap()];
    let mesh = |name: &str| meshes(&link(name).collisions).next().unwrap().0;
    assert!(Arc::ptr_eq(mesh("panda_leftfinger"), mesh("panda_rightfinger")));
}
