//! A scene with known colours at known places.
#![allow(dead_code, reason = "each test uses its share")]

use nalgebra::{Point3, Translation3, UnitQuaternion, Vector3};
use robotc_core::Pose;
use robotc_core::model::{Geometry, Origin, Shape};
use robotc_runtime::record::{Group, LineSet, Node, Recording};

/// End of the recording, seconds.
pub(crate) const END: f64 = 2.0;

fn shape(shape: Shape, colour: [f32; 3]) -> Vec<Geometry> {
    let [r, g, b] = colour;
    vec![Geometry { origin: Origin::default(), shape, colour: Some([r, g, b, 1.0]) }]
}

/// A red box slides and turns, a green ball rises, a blue cylinder stays, on a grey table. A green fork hangs on the
/// red box, an orange tree is hidden at first.
pub(crate) fn sliding_blocks() -> Recording {
    let mut recording = Recording::new("Sliding <blocks> & \"balls\"");
    let red = shape(Shape::Box { size: [0.12; 3] }, [0.85, 0.1, 0.08]);
    let red = recording.add_body("red", Group::Object, &red, Pose::identity());
    let green = shape(Shape::Sphere { radius: 0.07 }, [0.1, 0.7, 0.15]);
    let green = recording.add_body("green", Group::Object, &green, Pose::identity());
    let blue = shape(Shape::Cylinder { radius: 0.06, length: 0.2 }, [0.08, 0.2, 0.85]);
    recording.add_body("blue", Group::Object, &blue, Pose::translation(-0.3, -0.3, 0.1));
    let grey = shape(Shape::Box { size: [1.0, 1.0, 0.04] }, [0.6, 0.6, 0.6]);
    recording.add_body("table", Group::Obstacle, &grey, Pose::translation(0.0, 0.0, -0.02));

    let path = |time: f64| Point3::new(0.3, -0.3 + 0.3 * time, 0.06);
    for step in 0..=20 {
        let time = END * f64::from(step) / 20.0;
        let turned = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), time);
        let world_from_red = Pose::from_parts(Translation3::from(path(time).coords), turned);
        let world_from_green = Pose::translation(-0.3, 0.3, 0.07 + 0.2 * time);
        recording.push_frame(time, [(red, world_from_red), (green, world_from_green)]);
    }
    recording.add_grasps("grasps", red, &[Pose::translation(0.0, 0.0, 0.1)], 0.1, 0.05);
    recording.add_tree("tree", [[Point3::origin(), Point3::new(0.1, 0.1, 0.4)]]);
    let straight = LineSet::polyline([path(0.0), path(END)], [0.9, 0.6, 0.1, 1.0], 2.0);
    recording.add_node(Node::new("plan", Group::Path, Pose::identity()).with_lines(straight));
    recording.add_tool_path("path", [(0.0, path(0.0)), (END, path(END))]);
    recording.add_stage("slide", 0.0, 1.2).add_stage("rise", 1.2, END);
    recording.add_fact("task", "blocks").add_fact("outcome", "success");
    recording
}
