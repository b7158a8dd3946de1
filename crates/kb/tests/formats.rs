//! Grasps as files that other programs wrote, and that they read: `crates/py/tests/test_grasp_files.py` reads the one of here
//! with numpy, which wrote the other.

use nalgebra::{Translation3, UnitQuaternion, Vector3};
use robotc_core::Pose;
use robotc_kb::formats::{FileGrasp, GraspFile, GraspFormat};

/// Two grasps whose numbers are known.
fn known() -> GraspFile {
    let quarter = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), std::f64::consts::FRAC_PI_2);
    let grasp = |z: f64, confidence: f64| FileGrasp {
        object_from_gripper: Pose::from_parts(Translation3::new(0.1, -0.2, z), quarter),
        closed: vec![0.5 * z, 0.01],
        open: vec![0.04, 0.04],
        confidence,
    };
    GraspFile {
        object: "größe".into(),
        gripper_link: "palm".into(),
        joints: vec!["left".into(), "right_finger".into()],
        grasps: vec![grasp(0.25, 1.0), grasp(0.5, 0.75)],
    }
}

fn golden(name: &str) -> std::path::PathBuf {
    std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden").join(name)
}

#[test]
fn arrays_are_written_as_they_were() {
    let (path, bytes) = (golden("grasps.npz"), known().write(GraspFormat::Npz));
    if std::env::var_os("BLESS").is_some() {
        std::fs::write(&path, &bytes).expect("a file");
    }
    assert!(std::fs::read(&path).is_ok_and(|expected| expected == bytes), "{} differs", path.display());
}

#[test]
fn arrays_of_numpy_are_read() {
    let bytes = std::fs::read(golden("numpy.npz")).expect("a committed file");
    let file = GraspFile::read(&bytes, GraspFormat::Npz).expect("it is one");
    let known = known();
    assert_eq!(
        (&file.object, &file.gripper_link, &file.joints),
        (&known.object, &known.gripper_link, &known.joints)
    );
    for (a, b) in file.grasps.iter().zip(&known.grasps) {
        let between = a.object_from_gripper.inv_mul(&b.object_from_gripper);
        // Written in single precision.
        assert!(between.translation.vector.norm() < 1e-7 && between.rotation.angle() < 1e-6);
        assert_eq!((&a.closed, &a.open, a.confidence), (&b.closed, &b.open, b.confidence));
    }
    let packed = std::fs::read(golden("numpy_compressed.npz")).expect("a committed file");
    let refused = GraspFile::read(&packed, GraspFormat::Npz).expect_err("it is compressed");
    assert!(refused.to_string().contains("numpy.savez"), "{refused}");
}
