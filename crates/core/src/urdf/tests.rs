//! What is made of small descriptions, right and wrong.

use std::f64::consts::PI;

use super::*;
use crate::model::{Drive, JointMotion, Shape};
use crate::system::MemorySystem;

/// The model of a robot with this body, and the findings.
fn read_with(body: &str, files: &[(&str, &str)], options: &LoadOptions) -> (Option<RobotModel>, String) {
    let mut system = MemorySystem::new();
    system.insert("d/r.urdf", format!("<robot name=\"r\">\n{body}\n</robot>"));
    for (path, text) in files {
        system.insert(*path, *text);
    }
    let mut sources = Sources::new();
    let (model, found) = load(&system, &mut sources, Path::new("d/r.urdf"), options);
    (model, found.to_plain_text(&sources))
}

fn read(body: &str) -> (Option<RobotModel>, String) {
    read_with(body, &[], &LoadOptions::default())
}

fn clean(body: &str) -> RobotModel {
    let (model, text) = read(body);
    assert_eq!(text, "", "{body}");
    model.unwrap()
}

const LINKS: &str = "<link name=\"a\"/><link name=\"b\"/><link name=\"c\"/>";

/// A joint from one link to another with more in it.
fn joint(name: &str, kind: &str, parent: &str, child: &str, more: &str) -> String {
    format!(
        "\n<joint name=\"{name}\" type=\"{kind}\"><parent link=\"{parent}\"/><child link=\"{child}\"/>{more}</joint>"
    )
}

const LIMIT: &str = "<limit lower=\"-1\" upper=\"2\" velocity=\"3\" effort=\"1\"/>";

#[test]
fn numbers_arrive_as_written() {
    let origin = "<origin xyz=\"0.1 -0 1e-3\" rpy=\"1.5707963267948966 0 0\"/><axis xyz=\"0 0 2\"/>";
    let (model, text) = read(&format!(
        "{LINKS}{}{}",
        joint("j", "revolute", "a", "b", &format!("{origin}{LIMIT}")),
        joint("k", "fixed", "b", "c", "")
    ));
    assert!(text.contains("warning[R0223]"), "{text}");
    let model = model.unwrap();
    let j = &model.joints()[model.joint_named("j").unwrap()];
    assert_eq!(
        (j.origin.xyz, j.origin.rpy, j.axis),
        ([0.1, 0.0, 1e-3], [PI / 2.0, 0.0, 0.0], [0.0, 0.0, 2.0])
    );
    assert!(j.origin.xyz[1].is_sign_positive());
    let dof = &model.dofs()[model.dof_named("j").unwrap()];
    assert_eq!((dof.lower, dof.upper, dof.dynamics.velocity), (-1.0, 2.0, 3.0));
    assert_eq!(dof.dynamics.given, [true, false, false]);
}

#[test]
fn kinds_of_joints() {
    let mimic = "<mimic joint=\"j\" multiplier=\"-2\" offset=\"0.5\"/>";
    let model = clean(&format!(
        "{LINKS}<link name=\"d\"/>{}{}{}",
        joint("j", "continuous", "a", "b", ""),
        joint("k", "prismatic", "b", "c", &format!("<axis xyz=\"0 1 0\"/>{mimic}")),
        joint("l", "fixed", "c", "d", "<axis xyz=\"0 0 0\"/>"),
    ));
    let joints: Vec<JointMotion> = model.joints().iter().map(|j| j.motion).collect();
    assert_eq!(joints, [JointMotion::Revolute, JointMotion::Prismatic, JointMotion::Fixed]);
    assert_eq!(model.joints().as_slice()[0].axis, [1.0, 0.0, 0.0], "the default axis is x");
    let dof = model.dof_named("j").unwrap();
    assert!(model.dofs()[dof].continuous && model.dofs().len() == 1);
    assert_eq!(model.joints().as_slice()[1].drive, Drive::Mimic { dof, multiplier: -2.0, offset: 0.5 });
}

#[test]
fn joints_inside_of_other_elements_are_none() {
    let extras = "<transmission name=\"t\"><joint name=\"j\"/></transmission><ros2_control><joint name=\"x\"/></ros2_control>\
                  <gazebo><joint name=\"y\" type=\"z\"/></gazebo>";
    let model = clean(&format!("<link name=\"a\"/>{extras}"));
    assert!(model.joints().is_empty());
}

#[test]
fn limits_are_mended() {
    let table = [
        ("revolute", "", -PI, PI, "R0224"),
        ("prismatic", "", -10.0, 10.0, "R0224"),
        ("revolute", "<limit velocity=\"1\"/>", -PI, PI, "R0224"),
        ("revolute", "<limit upper=\"1.5\" velocity=\"1\"/>", 0.0, 1.5, "R0224"),
        ("revolute", "<limit lower=\"2\" upper=\"-1\" velocity=\"1\"/>", -1.0, 2.0, "R0225"),
        ("revolute", "<limit lower=\"1\" upper=\"1\" velocity=\"1\"/>", 1.0, 1.0, "R0225"),
        (
            "revolute",
            "<safety_controller soft_lower_limit=\"-0.5\" soft_upper_limit=\"0.5\"/>",
            -0.5,
            0.5,
            "R0224",
        ),
        ("revolute", "<limit lower=\"-1\" upper=\"1\" velocity=\"0\"/>", -1.0, 1.0, "R0227"),
    ];
    for (kind, more, lower, upper, code) in table {
        let (model, text) =
            read(&format!("<link name=\"a\"/><link name=\"b\"/>{}", joint("j", kind, "a", "b", more)));
        let model = model.unwrap();
        let dof = model.dofs().iter().next().unwrap();
        assert_eq!((dof.lower, dof.upper), (lower, upper), "{more}");
        assert!(text.lines().count() == 1 && text.contains(&format!("warning[{code}]")), "{more}: {text}");
    }
}

#[test]
fn faults_of_structure() {
    let table = [
        (joint("j", "fixed", "a", "b", "") + &joint("k", "fixed", "a", "cc", ""), "R0212", "4:61", false),
        (joint("j", "fixed", "a", "b", "") + &joint("k", "fixed", "c", "b", ""), "R0214", "4:61", false),
        (joint("j", "fixed", "a", "b", "") + &joint("j", "fixed", "b", "c", ""), "R0213", "4:14", false),
        (joint("j", "fixed", "a", "b", "") + &joint("k", "fixed", "b", "a", ""), "R0216", "", false),
        (joint("j", "fixed", "a", "b", ""), "R0217", "2:45", true),
        (joint("j", "floating", "a", "b", "") + &joint("k", "fixed", "b", "c", ""), "R0221", "3:14", true),
        (joint("j", "fixed", "a", "b", "") + &joint("k", "planar", "b", "c", ""), "R0221", "4:14", false),
        (joint("j", "rotary", "a", "b", "") + &joint("k", "fixed", "b", "c", ""), "R0220", "3:23", false),
        (
            joint("j", "revolute", "a", "b", &format!("<axis xyz=\"0 0 0\"/>{LIMIT}"))
                + &joint("k", "fixed", "b", "c", ""),
            "R0222",
            "3:79",
            false,
        ),
        (
            joint("j", "continuous", "a", "b", "<mimic joint=\"x\"/>") + &joint("k", "fixed", "b", "c", ""),
            "R0226",
            "3:84",
            false,
        ),
        (
            joint("j", "continuous", "a", "b", "<mimic joint=\"j\"/>") + &joint("k", "fixed", "b", "c", ""),
            "R0226",
            "3:84",
            false,
        ),
        (
            joint("j", "fixed", "a", "b", "<origin xyz=\"0 0\"/>") + &joint("k", "fixed", "b", "c", ""),
            "R0209",
            "3:78",
            false,
        ),
        (
            joint("j", "fixed", "a", "b", "<origin rpy=\"0 nan 0\"/>") + &joint("k", "fixed", "b", "c", ""),
            "R0209",
            "3:78",
            false,
        ),
        (
            joint("j", "fixed", "a", "b", "<origin rpy=\"0 ${p} 0\"/>") + &joint("k", "fixed", "b", "c", ""),
            "R0209",
            "3:78",
            false,
        ),
        (
            "<jiont/>".to_owned() + &joint("j", "fixed", "a", "b", "") + &joint("k", "fixed", "b", "c", ""),
            "R0210",
            "",
            true,
        ),
        (
            "<link name=\"a\"/>".to_owned()
                + &joint("j", "fixed", "a", "b", "")
                + &joint("k", "fixed", "b", "c", ""),
            "R0213",
            "2:61",
            true,
        ),
        (
            "<link/>".to_owned() + &joint("j", "fixed", "a", "b", "") + &joint("k", "fixed", "b", "c", ""),
            "R0208",
            "2:49",
            false,
        ),
    ];
    for (joints, code, place, loads) in table {
        let (model, text) = read(&format!("{LINKS}{joints}"));
        assert_eq!(model.is_some(), loads, "{joints}: {text}");
        let found = text.lines().find(|l| l.contains(code)).unwrap_or_else(|| panic!("{joints}: {text}"));
        assert!(found.contains(place), "{joints}: {found}");
    }
}

#[test]
fn several_pieces_are_refused_and_a_missing_root_is_added() {
    let (model, text) = read(&format!(
        "{LINKS}<link name=\"d\"/>{}{}",
        joint("j", "fixed", "a", "b", ""),
        joint("k", "fixed", "c", "d", "")
    ));
    assert!(
        model.is_none() && text.contains("error[R0215]: the robot is in 2 pieces, with the roots `a`, `c`"),
        "{text}"
    );
    let (model, text) = read(&format!("<link name=\"a\"/>{}", joint("j", "fixed", "world", "a", "")));
    let model = model.unwrap();
    assert_eq!(model.links()[model.root()].name, "world");
    assert!(text.contains("warning[R0212]"), "{text}");
}

#[test]
fn shapes_and_colours() {
    let body = "<material name=\"red\"><color rgba=\"1 0 0 1\"/></material><link name=\"a\">
        <inertial><mass value=\"2\"/><inertia ixx=\"1\" iyy=\"2\" izz=\"3\"/></inertial>
        <visual><geometry><box size=\"1 2 3\"/></geometry><material name=\"red\"/></visual>
        <visual><geometry><cylinder radius=\"1\" length=\"2\"/></geometry><material name=\"x\"><color rgba=\"0 0.5 0 1\"/></material></visual>
        <collision><origin xyz=\"1 0 0\"/><geometry><sphere radius=\"0.5\"/></geometry></collision>
        <collision><geometry><capsule radius=\"1\" length=\"2\"/></geometry></collision></link>";
    let model = clean(body);
    let link = &model.links()[model.root()];
    assert_eq!(link.visuals[0].colour, Some([1.0, 0.0, 0.0, 1.0]));
    assert_eq!(link.visuals[1].colour, Some([0.0, 0.5, 0.0, 1.0]));
    assert_eq!(link.visuals[0].shape, Shape::Box { size: [1.0, 2.0, 3.0] });
    assert_eq!(
        (&link.collisions[0].shape, link.collisions[0].origin.xyz),
        (&Shape::Sphere { radius: 0.5 }, [1.0, 0.0, 0.0])
    );
    let inertial = link.inertial.unwrap();
    assert_eq!((inertial.mass, inertial.inertia), (2.0, [1.0, 0.0, 0.0, 2.0, 0.0, 3.0]));
}

const OBJ: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

fn with_mesh(kind: &str, uri: &str) -> String {
    format!(
        "<link name=\"a\"><{kind}><geometry><mesh filename=\"{uri}\" scale=\"2 2 2\"/></geometry></{kind}></link>"
    )
}

#[test]
fn mesh_references_of_all_kinds_are_found() {
    let options = LoadOptions {
        packages: [("far".to_owned(), "elsewhere/far".into())].into(),
        ..LoadOptions::default()
    };
    let files = [
        ("package.xml", "<package><name>called</name></package>"),
        ("d/m.obj", OBJ),
        ("pkg/meshes/m.obj", OBJ),
        ("elsewhere/far/m.obj", OBJ),
        ("d/n.OBJ", OBJ),
    ];
    let table = [
        ("m.obj", ""),
        ("./x/../m.obj", ""),
        ("package://pkg/meshes/m.obj", ""),
        ("model://pkg/meshes/m.obj", ""),
        ("package://d/m.obj", ""),
        ("package://far/m.obj", ""),
        ("$(find far)/m.obj", ""),
        ("package://called/pkg/meshes/m.obj", ""),
        ("package://renamed/pkg/meshes/m.obj", "R0305"),
        ("meshes\\..\\m.obj", ""),
        ("file:///home/me/ws/pkg/meshes/m.obj", "R0305"),
        ("/opt/pkg/meshes/m.obj", "R0305"),
        ("n.stl", "R0305"),
        ("package://pkg/meshes/m.dae", "R0305"),
    ];
    for (uri, code) in table {
        let (model, text) = read_with(&with_mesh("collision", uri), &files, &options);
        let model = model.unwrap_or_else(|| panic!("{uri}: {text}"));
        assert_eq!(text.is_empty(), code.is_empty(), "{uri}: {text}");
        assert!(text.contains(code), "{uri}: {text}");
        let Shape::Mesh { mesh, .. } = &model.links()[model.root()].collisions[0].shape else {
            panic!("no mesh")
        };
        assert_eq!(mesh.bounds().unwrap().1.x, 2.0, "{uri}");
    }
}

#[test]
fn policies_for_missing_meshes() {
    let away = "package://gone/m.stl";
    let table = [
        (MeshPolicy::Load, "collision", away, false, "error[R0302]"),
        (MeshPolicy::Load, "visual", away, true, "warning[R0301]"),
        (MeshPolicy::SkipAway, "collision", away, true, "warning[R0302]"),
        (MeshPolicy::SkipAway, "collision", "meshes/m.stl", true, "warning[R0302]"),
        (MeshPolicy::SkipAway, "collision", "m.stl", false, "error[R0302]"),
        (MeshPolicy::SkipAway, "collision", "package://d/m.stl", false, "error[R0302]"),
        (MeshPolicy::SkipMissing, "collision", "m.stl", true, "warning[R0302]"),
        (MeshPolicy::SkipMissing, "visual", away, true, "warning[R0301]"),
        (MeshPolicy::Ignore, "collision", away, true, ""),
    ];
    for (meshes, kind, uri, loads, finding) in table {
        let options = LoadOptions { meshes, ..LoadOptions::default() };
        let (model, text) = read_with(&with_mesh(kind, uri), &[], &options);
        assert_eq!(model.is_some(), loads, "{meshes:?} {kind}: {text}");
        assert!(text.contains(finding) && text.is_empty() == finding.is_empty(), "{meshes:?} {kind}: {text}");
    }
}
