//! Forward kinematics and Jacobians of real arms against Pinocchio's, recorded by `xtask/reference/fk_reference.py`.

use std::path::Path;

use nalgebra::{DMatrix, Matrix4, Point3};
use robotc_core::urdf::MeshPolicy;
use robotc_core::{Configuration, DofIdx, Kinematics, LinkPoses, SerialChain};
use serde_json::Value;

use crate::data::{load, shared};

/// Largest difference of a matrix entry: metres or pure numbers.
const TOLERANCE: f64 = 1e-12;

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect()
}

#[test]
fn kinematics_agree_with_pinocchio() {
    let Some(folder) = shared().map(|s| s.join("arms")) else { return };
    let recorded = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/reference/fk.json");
    let recorded: Value = serde_json::from_str(&std::fs::read_to_string(recorded).unwrap()).unwrap();
    let mut worst = (0.0, String::new());
    let mut arms = 0;
    for (file, arm) in recorded.as_object().unwrap() {
        let (model, _, text) = load(&folder.join(file), MeshPolicy::Ignore);
        let kinematics = Kinematics::new(model.unwrap_or_else(|| panic!("{text}")).into());
        let error = arm["cases"].as_array().unwrap().iter().map(|case| difference(&kinematics, arm, case));
        let error = error.fold(0.0, f64::max);
        if error >= worst.0 {
            worst = (error, file.clone());
        }
        arms += 1;
    }
    println!("{arms} arms; largest difference {:.1e} ({})", worst.0, worst.1);
    assert!(arms >= 125 && worst.0 < TOLERANCE, "{} differs by {:.1e}", worst.1, worst.0);
}

/// The largest difference of a pose or Jacobian entry in one recorded configuration.
fn difference(kinematics: &Kinematics, arm: &Value, case: &Value) -> f64 {
    let model = kinematics.model();
    let link = |key: &str| model.link_named(arm[key].as_str().unwrap()).unwrap();
    let (base, tip) = (link("base"), link("tip"));
    let chain = SerialChain::between(kinematics, base, tip).unwrap();
    let dofs: Vec<DofIdx> = chain.variables.iter().map(|v| v.dof).collect();
    let q = numbers(&case["q"]);
    // The reference holds all other joints at zero, within their limits or not.
    let mut configuration = Configuration::from_values(vec![0.0; model.dofs().len()]);
    configuration.set(&dofs, &q);

    let pose = Matrix4::from_row_slice(&[numbers(&case["pose"]), vec![0.0, 0.0, 0.0, 1.0]].concat());
    let mut poses = LinkPoses::default();
    kinematics.link_poses(&configuration, &mut poses);
    let base_from_root = poses.root_from(base).inverse();
    let by_tree = (base_from_root * poses.root_from(tip)).to_homogeneous();
    let by_chain = chain.forward(&q).to_homogeneous();

    let jacobian = DMatrix::from_row_slice(6, q.len(), &numbers(&case["jacobian"]));
    let in_root = kinematics.jacobian(&poses, tip, &Point3::origin());
    let turn = base_from_root.rotation.to_rotation_matrix();
    let mut worst = (by_tree - pose).amax().max((by_chain - pose).amax());
    for (column, &dof) in dofs.iter().enumerate() {
        let ours = in_root.column(robotc_core::ids::Idx::index(dof));
        let linear = turn * ours.fixed_rows::<3>(0);
        let angular = turn * ours.fixed_rows::<3>(3);
        for row in 0..3 {
            worst = worst.max((linear[row] - jacobian[(row, column)]).abs());
            worst = worst.max((angular[row] - jacobian[(row + 3, column)]).abs());
        }
    }
    worst
}
