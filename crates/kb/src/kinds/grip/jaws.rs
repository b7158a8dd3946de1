//! A hand to test with.

use std::sync::Arc;

use nalgebra::Vector3;
use robotc_core::geom::{ConvexParts, box_part};
use robotc_core::ids::Idx;
use robotc_core::model::{DynamicLimits, JointMotion, Kinematics, Origin, RobotBuilder};
use robotc_core::robot::{Gripper, Hold, Preshape};
use robotc_core::{DofIdx, LinkIdx, Pose};

/// A palm with two jaws that open to 80 mm; the second follows the first.
pub(crate) fn jaws() -> (Kinematics, Gripper, Vec<(LinkIdx, ConvexParts)>) {
    jaws_with(false)
}

/// The same, with a knuckle on the outer side of each jaw, as linkages have: a finger too, but far from what is held.
pub(crate) fn jaws_with_knuckles() -> (Kinematics, Gripper, Vec<(LinkIdx, ConvexParts)>) {
    jaws_with(true)
}

/// The left jaw of [`jaws`] alone, and a right one that is part of the palm, where that one is when it is closed.
pub(crate) fn fixed_jaw() -> (Kinematics, Gripper, Vec<(LinkIdx, ConvexParts)>) {
    let mut b = RobotBuilder::new("jaws");
    for link in ["palm", "left", "right"] {
        b.link(link, vec![], vec![], None);
    }
    let limits = (0.0, 0.04, false, DynamicLimits::DEFAULT);
    let slide = JointMotion::Prismatic;
    b.moving("left", slide, "palm", "left", Origin::default(), [0.0, 1.0, 0.0], limits, None);
    b.fixed("right", "palm", "right", Origin::default());
    let (_, gripper, parts) = jaws();
    (Kinematics::new(Arc::new(b.build().unwrap())), gripper, parts)
}

fn jaws_with(knuckles: bool) -> (Kinematics, Gripper, Vec<(LinkIdx, ConvexParts)>) {
    let mut b = RobotBuilder::new("jaws");
    b.link("palm", vec![], vec![], None).link("left", vec![], vec![], None).link(
        "right",
        vec![],
        vec![],
        None,
    );
    let limits = (0.0, 0.04, false, DynamicLimits::DEFAULT);
    let slide = JointMotion::Prismatic;
    b.moving("left", slide, "palm", "left", Origin::default(), [0.0, 1.0, 0.0], limits, None);
    let follow = Some(("left".to_owned(), 1.0, 0.0));
    b.moving("right", slide, "palm", "right", Origin::default(), [0.0, -1.0, 0.0], limits, follow);
    let mut fingers = vec![LinkIdx::new(1), LinkIdx::new(2)];
    if knuckles {
        for jaw in ["left", "right"] {
            let knuckle = format!("{jaw}_knuckle");
            b.link(&knuckle, vec![], vec![], None).fixed(&knuckle, jaw, &knuckle, Origin::default());
        }
        fingers.extend([LinkIdx::new(3), LinkIdx::new(4)]);
    }
    let model = Arc::new(b.build().unwrap());
    let pad =
        |y: f64| box_part(Vector3::new(0.02, 0.01, 0.05)).transformed(&Pose::translation(0.0, y, 0.075));
    let mut parts = vec![
        (LinkIdx::new(0), ConvexParts::new(vec![box_part(Vector3::new(0.06, 0.2, 0.1))])),
        (LinkIdx::new(1), ConvexParts::new(vec![pad(0.005)])),
        (LinkIdx::new(2), ConvexParts::new(vec![pad(-0.005)])),
    ];
    if knuckles {
        let knuckle =
            |y: f64| box_part(Vector3::new(0.02, 0.01, 0.02)).transformed(&Pose::translation(0.0, y, 0.06));
        parts.push((LinkIdx::new(3), ConvexParts::new(vec![knuckle(0.04)])));
        parts.push((LinkIdx::new(4), ConvexParts::new(vec![knuckle(-0.03)])));
    }
    let gripper = Gripper {
        name: "jaws".into(),
        palm: LinkIdx::new(0),
        palm_from_tool: Pose::translation(0.0, 0.0, 0.09),
        approach_in_tool: Vector3::z_axis(),
        hold: Hold::Close,
        dofs: vec![DofIdx::new(0)],
        closing: vec![-1.0],
        fingers,
        preshapes: vec![Preshape { name: "open".into(), values: vec![0.04] }],
    };
    (Kinematics::new(model), gripper, parts)
}
