//! All real arms load, without their meshes too, and have the chain that their index says.

use robotc_core::urdf::MeshPolicy;
use robotc_core::{Kinematics, SerialChain};

use crate::data::{index, load, shared};

#[test]
fn every_arm_loads_with_its_chain() {
    let Some(folder) = shared().map(|s| s.join("arms")) else { return };
    let mut faults = String::new();
    for row in index(&folder) {
        let file = row.get("file");
        let (model, _, text) = load(&folder.join(file), MeshPolicy::SkipAway);
        let Some(model) = model else {
            faults += &text;
            continue;
        };
        let (Some(base), Some(tip)) =
            (model.link_named(row.get("base_link")), model.link_named(row.get("tip_link")))
        else {
            faults += &format!("{file}: base or tip is missing\n");
            continue;
        };
        let kinematics = Kinematics::new(model.into());
        match SerialChain::between(&kinematics, base, tip) {
            Err(error) => faults += &format!("{file}: {error}\n"),
            Ok(chain) => {
                let names: Vec<&str> = chain.variables.iter().map(|v| v.name.as_str()).collect();
                if names.join(",") != row.get("joints") {
                    faults +=
                        &format!("{file}: joints {} instead of {}\n", names.join(","), row.get("joints"));
                }
            }
        }
    }
    assert!(faults.is_empty(), "{faults}");
}
