//! What specifications say arrives as values.

use std::path::Path;

use robotc_core::Pose;
use robotc_core::diag::Sources;
use robotc_core::model::Shape;
use robotc_core::robot::{Base, Robot};
use robotc_core::spec::{ParameterValue, TaskSpec, load_task};
use robotc_core::task::{Destination, Goal};

use super::disk::{Disk, parameters};

fn wedge() -> TaskSpec {
    let disk = Disk::of_checkout("tests/specs");
    let mut sources = Sources::new();
    let (spec, found) = load_task(&disk, &mut sources, Path::new("files/wedge.task.toml"), &parameters());
    assert!(found.is_empty(), "{}", found.to_plain_text(&sources));
    spec.unwrap()
}

fn names(robot: &Robot) -> Vec<(&str, &str)> {
    let name = |link| robot.model.links()[link].name.as_str();
    robot.ignored_pairs.iter().map(|&(a, b)| (name(a), name(b))).collect()
}

#[test]
fn arms_and_pairs_come_from_the_srdf() {
    let spec = wedge();
    let robot = &spec.task.robot;
    let [arm] = &robot.arms[..] else { panic!("one arm: {:?}", robot.arms) };
    assert_eq!((arm.name.as_str(), arm.gripper, arm.dofs.len()), ("upper", Some(0), 3));
    assert_eq!(arm.home, Some(vec![0.1, 0.2, 0.3]));
    assert_eq!(names(robot), [("base_link", "forearm"), ("base_link", "palm"), ("forearm", "wrist")]);
}

#[test]
fn limits_follow_their_precedence() {
    let spec = wedge();
    let model = &spec.task.robot.model;
    let [shoulder, elbow] = ["shoulder", "elbow"].map(|name| &model.dofs()[model.dof_named(name).unwrap()]);
    let values = |d: &robotc_core::model::DynamicLimits| [d.velocity, d.acceleration, d.jerk];
    assert_eq!(values(&shoulder.dynamics), [1.0, 3.0, 50.0], "specification, joint_limits, default");
    assert_eq!(values(&elbow.dynamics), [2.0, 5.0, 40.0], "description, default, joint_limits");
    assert_eq!((shoulder.lower, shoulder.upper), (-3.1, 3.0));
    assert!(model.dofs().iter().all(|d| d.dynamics.given == [true; 3]));
}

#[test]
fn annotations_arrive() {
    let spec = wedge();
    let robot = &spec.robot.robot;
    let Base::Planar { footprint, holonomic, joints: None } = &robot.base else { panic!("planar") };
    // Written clockwise, kept counter-clockwise.
    assert_eq!((footprint[0], footprint[1], *holonomic), ([-0.2, 0.2], [-0.2, -0.2], false));
    let weights: Vec<(&str, f64)> =
        robot.weights.iter().map(|&(dof, w)| (robot.model.dofs()[dof].name.as_str(), w)).collect();
    assert_eq!(weights, [("shoulder", 3.0), ("elbow", 2.0)]);
    let gripper = &robot.grippers[0];
    assert_eq!((gripper.preshapes.len(), &gripper.preshapes[0].values), (1, &vec![0.04]));
    assert_eq!(spec.robot.tools[0].xyz, [0.0, 0.0, 0.07]);
}

#[test]
fn parameters_of_the_task_override_those_of_the_robot() {
    let spec = wedge();
    assert_eq!(spec.robot.parameters.get("grasp_set", "rolls"), Some(&ParameterValue::Integer(4)));
    assert_eq!(spec.parameters.get("grasp_set", "rolls"), Some(&ParameterValue::Integer(16)));
    assert_eq!(spec.parameters.get("grasp_set", "standoff"), Some(&ParameterValue::Number(0.01)));
}

#[test]
fn the_start_is_home_preshape_and_what_is_said() {
    let task = wedge().task;
    let value = |name| task.start[task.robot.model.dof_named(name).unwrap()];
    assert_eq!(["shoulder", "elbow", "roll", "left_jaw"].map(value), [0.1, -1.0, 0.3, 0.04]);
    assert_eq!((task.seed, task.world_from_robot.translation.z), (7, 0.5));
}

#[test]
fn meshes_stand_up_and_lie_on_surfaces() {
    let task = wedge().task;
    let wedge = &task.objects[0].geometry[0];
    assert_eq!(wedge.colour, Some([1.0, 0.0, 0.2, 1.0]));
    let Shape::Mesh { mesh, .. } = &wedge.shape else { panic!("a mesh") };
    let (low, high) = mesh.bounds().unwrap();
    // Centimetres by ten: a tenth of what the file says; its y is up.
    let expected = [-0.002, -0.003, -0.001, 0.002, 0.003, 0.005];
    let found = [low.x, low.y, low.z, high.x, high.y, high.z];
    assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{found:?}");
    let Goal::Place { targets, keep_upright } = &task.goals[0] else { panic!("an object") };
    let Destination::Region { origin_height, .. } = &targets[0].destination else { panic!("a region") };
    assert!((origin_height - 0.001).abs() < 1e-12);
    assert_eq!(*keep_upright, Some(0.2));
    let [target] = task.goals[1].targets() else { panic!("an object") };
    assert_eq!(target.object, 1);
    assert!(matches!(target.destination, Destination::Pose { any_yaw: true, .. }));
}

#[test]
fn measurements_become_solids() {
    let disk = Disk::of_checkout("tests/specs");
    let mut sources = Sources::new();
    let (spec, found) = load_task(&disk, &mut sources, Path::new("files/seen.task.toml"), &parameters());
    assert!(found.is_empty(), "{}", found.to_plain_text(&sources));
    let obstacles = spec.unwrap().task.obstacles.clone();
    let Shape::Cloud { cloud, uri } = &obstacles[0].geometry[0].shape else { panic!("a cloud") };
    assert_eq!((cloud.points().len(), cloud.radius(), uri.as_str()), (2, 0.02, "scan.xyz"));
    assert!((cloud.points()[0].x - 0.005).abs() < 1e-12 && obstacles[0].without_robot == Some(0.05));
    let Shape::HeightField { field, .. } = &obstacles[1].geometry[0].shape else { panic!("a height field") };
    let expected = [0.0, 100.0, 200.0, 50.0, 65535.0, 250.0].map(|v| 1.0 - v / 65535.0);
    assert!(field.heights().iter().zip(expected).all(|(h, e)| (h - e).abs() < 1e-12));
    assert_eq!((field.rows(), field.columns(), field.floor()), (2, 3, -0.5));
    let Shape::HeightField { field, .. } = &obstacles[2].geometry[0].shape else { panic!("a height field") };
    let known: Vec<bool> = field.heights().iter().map(|h| !h.is_nan()).collect();
    assert_eq!((known, field.floor()), (vec![true, true, true, true, true, false], -0.5));
}

#[test]
fn a_destination_admits_what_stands_there() {
    use nalgebra::{Translation3, UnitQuaternion};
    let turned = |yaw: f64, tilt: f64| UnitQuaternion::from_euler_angles(tilt, 0.0, yaw);
    let at = |x: f64, z: f64, yaw, tilt| Pose::from_parts(Translation3::new(x, 0.2, z), turned(yaw, tilt));
    for (any_yaw, yaw, admitted) in [(false, 0.0, true), (false, 0.3, false), (true, 0.3, true)] {
        let destination = Destination::Pose { world_from_object: at(0.5, 0.1, 0.0, 0.4), any_yaw };
        let world_from_object =
            Pose::from_parts(Translation3::new(0.5, 0.2, 0.1), turned(yaw, 0.0) * turned(0.0, 0.4));
        assert_eq!(destination.admits(&world_from_object), admitted, "{any_yaw} {yaw}");
        assert!(!destination.admits(&at(0.51, 0.1, 0.0, 0.4)));
        assert!(!destination.admits(&at(0.5, 0.1, 0.0, 0.5)));
    }
    let world_from_region = at(0.5, 0.1, 1.0, 0.0);
    let region = Destination::Region { world_from_region, size: [0.2, 0.1], origin_height: 0.05 };
    let there = |x: f64, z: f64, tilt: f64| {
        world_from_region * Pose::from_parts(Translation3::new(x, 0.049, z), turned(2.0, tilt))
    };
    assert!(region.admits(&there(0.099, 0.05, 0.0)) && region.admits(&there(-0.1, 0.05, 0.0)));
    assert!(!region.admits(&there(0.11, 0.05, 0.0)), "beside it");
    assert!(!region.admits(&there(0.0, 0.06, 0.0)) && !region.admits(&there(0.0, 0.05, 0.1)), "not on it");
}
