//! A small robot and task, made in code, that tests change one thing of.

use std::sync::Arc;

use nalgebra::Vector3;
use robotc_core::ids::{Idx, LinkIdx};
use robotc_core::model::{
    Configuration, DynamicLimits, Geometry, Inertial, JointMotion, Origin, RobotBuilder, Shape,
};
use robotc_core::robot::{Base, Camera, Hold, Preshape};
use robotc_core::spec::{ParameterValue, RobotSpec, TaskSpec};
use robotc_core::task::{Article, Destination, Goal, Object, Obstacle, Target};
use robotc_core::{Arm, Gripper, Pose, Robot, Task};
use robotc_kb::{Given, Project};

/// Everything an edit can change.
#[derive(Clone)]
pub(crate) struct Spec {
    pub(crate) robot_name: String,
    pub(crate) links: Vec<LinkSpec>,
    pub(crate) tool: Origin,
    /// Of the camera on the hand.
    pub(crate) eye: Origin,
    pub(crate) object: Object,
    pub(crate) obstacle: Obstacle,
    pub(crate) articles: Vec<Article>,
    pub(crate) given: Given,
}

#[derive(Clone)]
pub(crate) struct LinkSpec {
    pub(crate) name: String,
    pub(crate) visual: Geometry,
    pub(crate) collision: Geometry,
    pub(crate) mass: f64,
    /// Name, motion, parent (position), origin, axis, limits, mimic; `None` for the root.
    pub(crate) joint: Option<JointSpec>,
}

#[derive(Clone)]
pub(crate) struct JointSpec {
    pub(crate) name: String,
    pub(crate) motion: JointMotion,
    pub(crate) parent: usize,
    pub(crate) origin: Origin,
    pub(crate) axis: [f64; 3],
    pub(crate) limits: (f64, f64),
    pub(crate) dynamics: DynamicLimits,
    pub(crate) mimic: Option<usize>,
}

pub(crate) fn cuboid(size: [f64; 3], xyz: [f64; 3]) -> Geometry {
    Geometry { origin: Origin { xyz, rpy: [0.0; 3] }, shape: Shape::Box { size }, colour: None }
}

/// An elbow arm with a spherical wrist and two fingers, the second of which follows the first; a mug and a table.
pub(crate) fn spec() -> Spec {
    let links: [(&str, [f64; 3], [f64; 3]); 7] = [
        ("base", [0.2, 0.2, 0.1], [0.0, 0.0, 0.05]),
        ("shoulder", [0.1, 0.1, 0.2], [0.0, 0.0, 0.1]),
        ("upper", [0.08, 0.08, 0.4], [0.0, 0.0, 0.2]),
        ("fore", [0.07, 0.07, 0.2], [0.0, 0.0, 0.1]),
        ("wrist_roll", [0.06, 0.06, 0.15], [0.0, 0.0, 0.1]),
        ("wrist_bend", [0.05, 0.05, 0.05], [0.0, 0.0, 0.0]),
        ("hand", [0.05, 0.12, 0.06], [0.0, 0.0, 0.08]),
    ];
    let joints: [(&str, [f64; 3], [f64; 3], (f64, f64)); 6] = [
        ("turn", [0.0, 0.0, 0.1], [0.0, 0.0, 1.0], (-2.9, 2.9)),
        ("lift", [0.0, 0.0, 0.2], [0.0, 1.0, 0.0], (-1.8, 1.8)),
        ("bend", [0.0, 0.0, 0.4], [0.0, 1.0, 0.0], (-2.5, 2.5)),
        ("roll", [0.0, 0.0, 0.2], [0.0, 0.0, 1.0], (-2.9, 2.9)),
        ("pitch", [0.0, 0.0, 0.2], [0.0, 1.0, 0.0], (-2.0, 2.0)),
        ("spin", [0.0, 0.0, 0.0], [0.0, 0.0, 1.0], (-3.1, 3.1)),
    ];
    let mut specs: Vec<LinkSpec> = links
        .into_iter()
        .enumerate()
        .map(|(i, (name, size, centre))| LinkSpec {
            name: name.into(),
            visual: cuboid(size, centre),
            collision: cuboid(size, centre),
            mass: 1.0,
            joint: (i > 0).then(|| {
                let (name, xyz, axis, limits) = joints[i - 1];
                JointSpec {
                    name: name.into(),
                    motion: JointMotion::Revolute,
                    parent: i - 1,
                    origin: Origin { xyz, rpy: [0.0; 3] },
                    axis,
                    limits,
                    dynamics: DynamicLimits::DEFAULT,
                    mimic: None,
                }
            }),
        })
        .collect();
    for (name, joint, side, mimic) in [("left", "slide", 1.0, None), ("right", "follow", -1.0, Some(7))] {
        specs.push(LinkSpec {
            name: name.into(),
            visual: cuboid([0.02, 0.01, 0.05], [0.0, 0.005 * side, 0.025]),
            collision: cuboid([0.02, 0.01, 0.05], [0.0, 0.005 * side, 0.025]),
            mass: 0.1,
            joint: Some(JointSpec {
                name: joint.into(),
                motion: JointMotion::Prismatic,
                parent: 6,
                origin: Origin { xyz: [0.0, 0.0, 0.11], rpy: [0.0; 3] },
                axis: [0.0, side, 0.0],
                limits: (0.0, 0.05),
                dynamics: DynamicLimits::DEFAULT,
                mimic,
            }),
        });
    }
    Spec {
        robot_name: "arm".into(),
        links: specs,
        tool: Origin { xyz: [0.0, 0.0, 0.14], rpy: [0.0; 3] },
        eye: Origin { xyz: [0.05, 0.0, 0.08], rpy: [0.0; 3] },
        object: Object {
            name: "mug".into(),
            geometry: Arc::new(vec![cuboid([0.06, 0.06, 0.09], [0.0; 3])]),
            mass: 0.3,
            friction: 0.5,
            world_from_object: Pose::translation(0.5, 0.0, 0.3),
        },
        obstacle: Obstacle {
            name: "table".into(),
            geometry: Arc::new(vec![cuboid([1.0, 1.0, 0.04], [0.0; 3])]),
            world_from_obstacle: Pose::translation(0.6, 0.0, 0.2),
            without_robot: None,
        },
        articles: Vec::new(),
        given: coarse(),
    }
}

/// The same with a door that has a bar for a handle.
#[allow(dead_code, reason = "not every test file needs it")]
pub(crate) fn spec_with_door() -> Spec {
    let mut builder = RobotBuilder::new("door");
    let bar = cuboid([0.02, 0.02, 0.2], [0.08, 0.25, 0.1]);
    let shapes = [
        ("frame", cuboid([0.02, 0.02, 0.4], [0.0, -0.03, 0.2])),
        ("leaf", cuboid([0.02, 0.3, 0.4], [0.0, 0.15, 0.2])),
    ];
    for (name, shape) in shapes.into_iter().chain([("bar", bar)]) {
        builder.link(name, vec![], vec![shape], None);
    }
    let limits = (0.0, 1.5, false, DynamicLimits::DEFAULT);
    let z = [0.0, 0.0, 1.0];
    builder.moving("hinge", JointMotion::Revolute, "frame", "leaf", Origin::default(), z, limits, None);
    builder.fixed("on_leaf", "leaf", "bar", Origin::default());
    let model = Arc::new(builder.build().expect("a tree"));
    let link = |name| model.link_named(name).expect("it exists");
    let article = Article {
        name: "door".into(),
        dof: robotc_core::DofIdx::new(0),
        handle: link("bar"),
        friction: 0.5,
        world_from_root: Pose::translation(0.8, 0.0, 0.0),
        configuration: Configuration::neutral(&model),
        // After the table.
        bodies: vec![(link("frame"), 1), (link("leaf"), 2), (link("bar"), 3)],
        model,
    };
    let mut spec = spec();
    spec.articles = vec![article];
    for (name, value) in [("approaches", 400), ("directions", 1), ("rolls", 4), ("needed", 5)] {
        spec.given.set("caging_set", name, ParameterValue::Integer(value));
    }
    spec
}

/// Parameters that make maps and grasp sets small, so that tests are quick.
fn coarse() -> Given {
    let mut given = Given::default();
    given.set("reachability", "step", ParameterValue::Number(0.2));
    given.set("reachability", "free_samples", ParameterValue::Integer(2));
    given.set("grasp_set", "spacing", ParameterValue::Number(0.03));
    given.set("grasp_set", "directions", ParameterValue::Integer(1));
    given.set("self_collision_pairs", "samples", ParameterValue::Integer(200));
    given.set("self_collision_pairs", "boxes", ParameterValue::Integer(200));
    given
}

impl Spec {
    /// The links of the articles as obstacles, all joints at zero and all links at the root.
    fn bodies(&self) -> impl Iterator<Item = Obstacle> {
        self.articles.iter().flat_map(|article| {
            article.bodies.iter().map(|(link, _)| Obstacle {
                name: format!("{}/{}", article.name, article.model.links()[*link].name),
                geometry: Arc::new(article.model.links()[*link].collisions.clone()),
                world_from_obstacle: article.world_from_root,
                without_robot: None,
            })
        })
    }

    /// The checked project.
    pub(crate) fn project(&self) -> Project {
        let mut builder = RobotBuilder::new(&self.robot_name);
        for link in &self.links {
            let inertial = Inertial { origin: Origin::default(), mass: link.mass, inertia: [0.0; 6] };
            let (visuals, collisions) = (vec![link.visual.clone()], vec![link.collision.clone()]);
            builder.link(&link.name, visuals, collisions, Some(inertial));
        }
        for link in &self.links {
            if let Some(j) = &link.joint {
                let limits = (j.limits.0, j.limits.1, false, j.dynamics);
                let joint_of = |i: usize| self.links[i].joint.as_ref().expect("it moves").name.clone();
                let mimic = j.mimic.map(|target| (joint_of(target), 1.0, 0.0));
                let parent = &self.links[j.parent].name;
                builder.moving(&j.name, j.motion, parent, &link.name, j.origin, j.axis, limits, mimic);
            }
        }
        let model = Arc::new(builder.build().expect("a tree"));
        let dof = |i: usize| robotc_core::DofIdx::new(i);
        let robot = Arc::new(Robot {
            arms: vec![Arm {
                name: "main".into(),
                base: LinkIdx::new(0),
                tip: LinkIdx::new(6),
                dofs: (0..6).map(dof).collect(),
                gripper: Some(0),
                free: None,
                home: None,
            }],
            grippers: vec![Gripper {
                name: "jaws".into(),
                palm: LinkIdx::new(6),
                palm_from_tool: self.tool.pose(),
                approach_in_tool: Vector3::z_axis(),
                hold: Hold::Close,
                dofs: vec![dof(6)],
                closing: vec![-1.0],
                fingers: vec![LinkIdx::new(7), LinkIdx::new(8)],
                preshapes: vec![Preshape { name: "open".into(), values: vec![0.05] }],
            }],
            cameras: vec![Camera {
                name: "eye".into(),
                link: LinkIdx::new(6),
                link_from_camera: self.eye.pose(),
                size: [640, 480],
                intrinsics: [600.0, 600.0, 320.0, 240.0],
            }],
            base: Base::Fixed,
            ignored_pairs: Vec::new(),
            weights: Vec::new(),
            model: model.clone(),
        });
        let task = Task {
            name: "tidy".into(),
            robot: robot.clone(),
            arm: 0,
            world_from_robot: Pose::identity(),
            start: Configuration::neutral(&model),
            objects: vec![self.object.clone()],
            obstacles: std::iter::once(self.obstacle.clone()).chain(self.bodies()).collect(),
            articles: self.articles.clone(),
            goals: vec![Goal::Place {
                targets: vec![Target {
                    object: 0,
                    destination: Destination::Pose {
                        world_from_object: Pose::translation(0.4, 0.4, 0.3),
                        any_yaw: true,
                    },
                }],
                keep_upright: None,
            }],
            seed: 1,
        };
        let robot = RobotSpec {
            name: self.robot_name.clone(),
            robot,
            tools: vec![self.tool],
            camera_poses: vec![self.eye],
            parameters: Given::default(),
            path: "arm.robot.toml".into(),
            description: "arm.urdf".into(),
        };
        Project::of_task(&TaskSpec {
            task,
            robot,
            parameters: self.given.clone(),
            path: "tidy.task.toml".into(),
        })
    }
}

/// Compares with the file `tests/golden/NAME`; with `BLESS=1` in the environment, writes it instead.
#[allow(dead_code, reason = "not every test file has golden files")]
pub(crate) fn golden(name: &str, text: &str) {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden").join(name);
    if std::env::var_os("BLESS").is_some() {
        std::fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
        std::fs::write(&path, text).expect("a file");
    }
    let expected = std::fs::read_to_string(&path).unwrap_or_default();
    assert_eq!(
        text,
        expected,
        "artefacts differ from {}: raise ALGORITHM or FORMAT of the kind, then bless with BLESS=1",
        path.display()
    );
}
