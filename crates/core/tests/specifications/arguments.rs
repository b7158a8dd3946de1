//! Descriptions in xacro with arguments, in a checkout that is called otherwise than its package.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use robotc_core::diag::Sources;
use robotc_core::spec::{InitOptions, ParameterTable, init, load_robot};
use robotc_core::system::MemorySystem;

const MAIN: &str = r#"<robot name="arm" xmlns:xacro="http://www.ros.org/wiki/xacro">
<xacro:arg name="upper"/>
<xacro:include filename="$(find arm_description)/urdf/joint.xacro"/>
<link name="base_link"/>
<xacro:joint name="a" parent="base_link" child="upper" upper="$(arg upper)"/>
<xacro:joint name="b" parent="upper" child="fore" upper="1"/>
<xacro:joint name="c" parent="fore" child="tool" upper="1"/>
</robot>"#;

const JOINT: &str = r#"<robot xmlns:xacro="http://www.ros.org/wiki/xacro">
<xacro:macro name="joint" params="name parent child upper">
<link name="${child}"><collision><geometry><box size="0.1 0.1 0.1"/></geometry></collision></link>
<joint name="${name}" type="revolute"><parent link="${parent}"/><child link="${child}"/><axis xyz="0 0 1"/>
<origin xyz="0.3 0 0"/><limit lower="-1" upper="${upper}" effort="1" velocity="1"/></joint>
</xacro:macro></robot>"#;

fn checkout() -> MemorySystem {
    let mut system = MemorySystem::new();
    system.insert("robots/checkout/package.xml", "<package><name>arm_description</name></package>");
    system.insert("robots/checkout/urdf/arm.urdf.xacro", MAIN);
    system.insert("robots/checkout/urdf/joint.xacro", JOINT);
    system
}

fn options(arguments: &[(&str, &str)]) -> InitOptions {
    InitOptions {
        description: "robots/checkout/urdf/arm.urdf.xacro".into(),
        arguments: arguments
            .iter()
            .map(|(name, value)| ((*name).into(), (*value).into()))
            .collect::<BTreeMap<_, _>>(),
        folder: "robots".into(),
        ..InitOptions::default()
    }
}

#[test]
fn arguments_are_written_and_read_again() {
    let mut system = checkout();
    let mut sources = Sources::new();
    let (text, found) = init(&system, &mut sources, &options(&[("upper", "2.5")]));
    let text = text.unwrap_or_else(|| panic!("{}", found.to_plain_text(&sources)));
    assert!(text.contains("[arguments]\n\"upper\" = \"2.5\"\n"), "{text}");

    let path = PathBuf::from("robots/arm.robot.toml");
    system.insert(&path, text);
    let mut sources = Sources::new();
    let (spec, found) = load_robot(&system, &mut sources, Path::new(&path), &ParameterTable::default());
    let spec = spec.unwrap_or_else(|| panic!("{}", found.to_plain_text(&sources)));
    let dof = spec.robot.model.dofs().iter().next().expect("a joint that moves");
    assert_eq!(dof.upper, 2.5);
}

#[test]
fn an_argument_that_is_missing_says_how_to_give_it() {
    let mut sources = Sources::new();
    let (text, found) = init(&checkout(), &mut sources, &options(&[]));
    assert!(text.is_none());
    let told = found.to_plain_text(&sources);
    assert!(told.contains("give it by `--argument upper=VALUE`, or under [arguments]"), "{told}");
}
