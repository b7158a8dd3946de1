//! The robots and tasks in `specs/`: they load without a finding, what a robot touches with contains what is seen of
//! it, and frames agree with the vendors' descriptions where both have them.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use nalgebra::Point3;
use robotc_core::Pose;
use robotc_core::diag::Sources;
use robotc_core::geom::{self, ConvexPart};
use robotc_core::model::{Configuration, Geometry, Kinematics, LinkPoses, RobotModel, Shape};
use robotc_core::robot::Robot;
use robotc_core::spec::{self, ParameterTable, TaskSpec};
use robotc_core::system::{ReadError, System};
use robotc_core::task::Task;
use robotc_core::urdf::{self, LoadOptions, MeshPolicy};

/// The files of this machine.
struct Disk;

impl System for Disk {
    fn read(&self, path: &Path) -> Result<Vec<u8>, ReadError> {
        std::fs::read(path).map_err(|error| ReadError::Unreadable(error.to_string()))
    }

    fn exists(&self, path: &Path) -> bool {
        path.exists()
    }
}

fn specs() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../specs")
}

/// Files below `folder` whose name ends with `ending`, in order.
fn files(folder: &Path, ending: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).expect("specs are part of the repository") {
        let path = entry.expect("a readable folder").path();
        if path.is_dir() {
            found.extend(files(&path, ending));
        } else if path.to_string_lossy().ends_with(ending) {
            found.push(path);
        }
    }
    found.sort();
    found
}

fn load(path: &Path, meshes: MeshPolicy) -> RobotModel {
    let mut sources = Sources::default();
    let (model, found) =
        urdf::load(&Disk, &mut sources, path, &LoadOptions { meshes, ..LoadOptions::default() });
    model.unwrap_or_else(|| panic!("{}", found.to_plain_text(&sources)))
}

#[test]
fn descriptions_load_without_a_finding() {
    let descriptions = files(&specs(), ".urdf");
    assert!(descriptions.len() >= 3);
    for path in descriptions {
        let mut sources = Sources::default();
        let (model, found) = urdf::load(&Disk, &mut sources, &path, &LoadOptions::default());
        assert!(found.is_empty(), "{}", found.to_plain_text(&sources));
        assert!(model.is_some());
    }
}

/// How far points are outside a shape, or minus how deep inside; metres (a lower bound beside edges).
fn heights(geometry: &Geometry, points: &[Point3<f64>]) -> Vec<f64> {
    let pose = geometry.origin.pose();
    let local = points.iter().map(|p| pose.inverse_transform_point(p));
    match &geometry.shape {
        Shape::Box { size } => local
            .map(|p| (0..3).map(|i| p[i].abs() - size[i] / 2.0).fold(f64::NEG_INFINITY, f64::max))
            .collect(),
        Shape::Cylinder { radius, length } => {
            local.map(|p| (p.x.hypot(p.y) - radius).max(p.z.abs() - length / 2.0)).collect()
        }
        Shape::Capsule { radius, length } => {
            local.map(|p| p.x.hypot(p.y).hypot((p.z.abs() - length / 2.0).max(0.0)) - radius).collect()
        }
        Shape::Sphere { radius } => local.map(|p| p.coords.norm() - radius).collect(),
        Shape::Mesh { mesh, uri } => {
            let part = ConvexPart::hull_of(&mesh.vertices).expect(uri);
            local.map(|p| part.height(&p)).collect()
        }
    }
}

#[test]
fn collision_meshes_are_convex() {
    for path in files(&specs(), ".urdf") {
        let model = load(&path, MeshPolicy::Load);
        for link in model.links().iter() {
            for geometry in &link.collisions {
                let Shape::Mesh { mesh, uri } = &geometry.shape else { continue };
                let volume: f64 = (0..mesh.faces.len())
                    .map(|face| {
                        let [a, b, c] = mesh.triangle(face);
                        a.coords.dot(&b.coords.cross(&c.coords)) / 6.0
                    })
                    .sum();
                let hull = ConvexPart::hull_of(&mesh.vertices).expect(uri);
                assert!((volume / hull.volume() - 1.0).abs() < 1e-3, "{uri}: {volume} of {}", hull.volume());
            }
        }
    }
}

#[test]
fn collision_shapes_contain_what_is_seen() {
    for path in files(&specs(), ".urdf") {
        let model = load(&path, MeshPolicy::Load);
        for link in model.links().iter() {
            for visual in &link.visuals {
                let Shape::Mesh { mesh, uri } = &visual.shape else {
                    panic!("{}: visuals are meshes", link.name)
                };
                let pose = visual.origin.pose();
                let vertices: Vec<Point3<f64>> = mesh.vertices.iter().map(|v| pose * v).collect();
                let by_shape: Vec<Vec<f64>> = link.collisions.iter().map(|c| heights(c, &vertices)).collect();
                for (i, vertex) in vertices.iter().enumerate() {
                    let out = by_shape.iter().map(|heights| heights[i]).fold(f64::INFINITY, f64::min);
                    assert!(out < 1e-3, "{}: {uri} at {vertex} is {out} m outside", link.name);
                }
            }
        }
    }
}

/// Corners of the shapes, enough of them to see how far they reach.
fn corners(geometry: &Geometry) -> Vec<Point3<f64>> {
    let pose = geometry.origin.pose();
    let local: Vec<Point3<f64>> = match &geometry.shape {
        Shape::Mesh { mesh, .. } => mesh.vertices.clone(),
        Shape::Box { size } => {
            let [a, b, c] = size.map(|s| s / 2.0);
            (0..8).map(|i| Point3::new(sign(i, 0) * a, sign(i, 1) * b, sign(i, 2) * c)).collect()
        }
        Shape::Cylinder { radius, length } => (0..32)
            .map(|i| {
                let angle = std::f64::consts::TAU * f64::from(i / 2) / 16.0;
                Point3::new(radius * angle.cos(), radius * angle.sin(), sign(i, 0) * length / 2.0)
            })
            .collect(),
        Shape::Capsule { .. } | Shape::Sphere { .. } => Vec::new(),
    };
    local.iter().map(|p| pose * p).collect()
}

fn sign(bits: i32, bit: i32) -> f64 {
    if bits >> bit & 1 == 1 { 1.0 } else { -1.0 }
}

#[test]
fn collision_shapes_keep_close_to_what_is_seen() {
    for path in files(&specs(), ".urdf") {
        let model = load(&path, MeshPolicy::Load);
        for link in model.links().iter() {
            let seen: Vec<Point3<f64>> = link.visuals.iter().flat_map(corners).collect();
            let touched: Vec<Point3<f64>> = link.collisions.iter().flat_map(corners).collect();
            if touched.is_empty() {
                continue;
            }
            let hull = ConvexPart::hull_of(&seen).expect("a link that is touched is seen");
            for p in &touched {
                let gap = seen.iter().map(|v| (v - p).norm()).fold(f64::INFINITY, f64::min);
                let out = hull.height(p);
                assert!(gap < 0.06 && out < 0.04, "{}: {p} is {gap} m, {out} m off", link.name);
            }
        }
    }
}

fn load_task(path: &Path) -> TaskSpec {
    let mut sources = Sources::default();
    let (task, found) = spec::load_task(&Disk, &mut sources, path, &ParameterTable::default());
    assert!(found.is_empty(), "{}", found.to_plain_text(&sources));
    task.expect("no finding, so a task")
}

#[test]
fn specifications_load_without_a_finding() {
    let robots = files(&specs(), ".robot.toml");
    assert!(robots.len() >= 3);
    for path in &robots {
        let mut sources = Sources::default();
        let (robot, found) = spec::load_robot(&Disk, &mut sources, path, &ParameterTable::default());
        assert!(found.is_empty(), "{}", found.to_plain_text(&sources));
        assert!(robot.is_some());
    }
    let tasks = files(&specs(), ".task.toml");
    assert!(tasks.len() >= 2 * robots.len());
    tasks.iter().for_each(|path| drop(load_task(path)));
}

/// Shapes as convex parts with their poses; a mesh as its hull.
type Parts = Vec<(ConvexPart, Pose)>;

fn parts(shapes: &[Geometry]) -> Parts {
    let part = |geometry: &Geometry| match &geometry.shape {
        Shape::Box { size } => geom::box_part((*size).into()),
        Shape::Cylinder { radius, length } => geom::cylinder_part(*radius, *length),
        Shape::Capsule { radius, length } => geom::capsule_part(*radius, *length),
        Shape::Sphere { radius } => geom::sphere_part(*radius),
        Shape::Mesh { mesh, uri } => ConvexPart::hull_of(&mesh.vertices).expect(uri),
    };
    shapes.iter().map(|shape| (part(shape), shape.origin.pose())).collect()
}

/// The distance of two things, each in its own frame.
fn distance(a: &Parts, world_from_a: &Pose, b: &Parts, world_from_b: &Pose) -> f64 {
    let mut least = f64::INFINITY;
    for (a, a_from_part) in a {
        for (b, b_from_part) in b {
            let gap = geom::distance(a, &(world_from_a * a_from_part), b, &(world_from_b * b_from_part));
            least = least.min(gap.distance);
        }
    }
    least
}

/// The things of a task: name, parts, pose in the world. Objects first, then obstacles; how many objects.
fn things(task: &Task) -> (Vec<(&str, Parts, Pose)>, usize) {
    let objects = task.objects.iter().map(|o| (o.name.as_str(), parts(&o.geometry), o.world_from_object));
    let obstacles =
        task.obstacles.iter().map(|o| (o.name.as_str(), parts(&o.geometry), o.world_from_obstacle));
    (objects.chain(obstacles).collect(), task.objects.len())
}

/// Pairs of links that are tested against each other and are closer than a millimetre.
fn self_contacts(robot: &Robot, q: &Configuration) -> Vec<String> {
    let mut poses = LinkPoses::default();
    Kinematics::new(Arc::clone(&robot.model)).link_poses(q, &mut poses);
    let links: Vec<_> =
        robot.model.links().enumerate().map(|(link, l)| (link, &l.name, parts(&l.collisions))).collect();
    let mut found = Vec::new();
    for (i, (a, name, parts)) in links.iter().enumerate() {
        for (b, other, other_parts) in &links[i + 1..] {
            let is_tested = !robot.ignored_pairs.contains(&(*a, *b));
            if is_tested && distance(parts, poses.root_from(*a), other_parts, poses.root_from(*b)) < 0.001 {
                found.push(format!("{name} and {other}"));
            }
        }
    }
    found
}

#[test]
fn grippers_are_free_at_every_preshape() {
    for path in files(&specs(), ".task.toml") {
        let task = load_task(&path).task;
        for gripper in &task.robot.grippers {
            for preshape in &gripper.preshapes {
                let mut q = task.start.clone();
                q.set(&gripper.dofs, &preshape.values);
                let contacts = self_contacts(&task.robot, &q);
                assert!(contacts.is_empty(), "{}: {}: {contacts:?}", path.display(), preshape.name);
            }
        }
    }
}

#[test]
fn most_positions_are_free() {
    for path in files(&specs(), ".robot.toml") {
        let mut sources = Sources::default();
        let (spec, _) = spec::load_robot(&Disk, &mut sources, &path, &ParameterTable::default());
        let robot = spec.expect("specifications load").robot;
        let mut contacts = BTreeMap::<String, usize>::new();
        let rounds = 60;
        let mut hit = 0;
        for round in 0..rounds {
            // Well spread numbers: multiples of roots of primes, modulo one.
            let primes = [2.0, 3.0, 5.0, 7.0, 11.0, 13.0, 17.0, 19.0, 23.0, 29.0, 31.0, 37.0_f64];
            let values = robot.model.dofs().iter().zip(primes).map(|(dof, prime)| {
                let (low, high) = dof.sampling_range();
                low + (high - low) * (f64::from(round + 1) * prime.sqrt()).fract()
            });
            let found = self_contacts(&robot, &Configuration::from_values(values.collect()));
            hit += usize::from(!found.is_empty());
            found.into_iter().for_each(|pair| *contacts.entry(pair).or_default() += 1);
        }
        assert!(hit * 10 < rounds as usize * 7, "{}", path.display());
        assert!(contacts.values().all(|n| n * 2 < rounds as usize), "{}: {contacts:?}", path.display());
    }
}

#[test]
fn robots_start_free() {
    for path in files(&specs(), ".task.toml") {
        let task = load_task(&path).task;
        let contacts = self_contacts(&task.robot, &task.start);
        assert!(contacts.is_empty(), "{}: {contacts:?}", path.display());
        let mut poses = LinkPoses::default();
        Kinematics::new(Arc::clone(&task.robot.model)).link_poses(&task.start, &mut poses);
        let (things, _) = things(&task);
        for (index, link) in task.robot.model.links().enumerate() {
            let world_from_link = task.world_from_robot * poses.root_from(index);
            let parts = parts(&link.collisions);
            for (thing, thing_parts, world_from_thing) in &things {
                let gap = distance(&parts, &world_from_link, thing_parts, world_from_thing);
                assert!(gap > 0.004, "{}: {} and {thing}: {gap} m", path.display(), link.name);
            }
        }
    }
}

#[test]
fn objects_stand_on_something_and_apart() {
    for path in files(&specs(), ".task.toml") {
        let task = load_task(&path).task;
        let (things, objects) = things(&task);
        for (i, (name, parts, pose)) in things[..objects].iter().enumerate() {
            let gap = |height| {
                let lifted = Pose::translation(0.0, 0.0, height) * pose;
                let to_others =
                    things[objects..].iter().map(|(_, other, at)| distance(parts, &lifted, other, at));
                to_others.fold(f64::INFINITY, f64::min)
            };
            assert!(gap(0.0) < 1e-5, "{}: {name} hangs {} m in the air", path.display(), gap(0.0));
            assert!((gap(0.001) - 0.001).abs() < 1e-5, "{}: {name} sticks in something", path.display());
            for (other, other_parts, other_pose) in &things[i + 1..objects] {
                let gap = distance(parts, pose, other_parts, other_pose);
                assert!(gap > 0.03, "{}: {name} and {other}: {gap} m", path.display());
            }
        }
    }
}

/// A shipped robot, a real description, links and joints of both that are the same.
struct Twin {
    ours: &'static str,
    theirs: &'static str,
    links: &'static [(&'static str, &'static str)],
    joints: &'static [(&'static str, &'static str)],
}

const TWINS: &[Twin] = &[
    Twin {
        ours: "panda/panda.urdf",
        theirs: "robots/franka_panda_hand/panda.urdf",
        links: &[
            ("panda_link0", "panda_link0"),
            ("panda_link1", "panda_link1"),
            ("panda_link2", "panda_link2"),
            ("panda_link3", "panda_link3"),
            ("panda_link4", "panda_link4"),
            ("panda_link5", "panda_link5"),
            ("panda_link6", "panda_link6"),
            ("panda_link7", "panda_link7"),
            ("panda_link8", "panda_link8"),
            ("panda_hand", "panda_hand"),
            ("panda_leftfinger", "panda_leftfinger"),
        ],
        joints: &[
            ("panda_joint1", "panda_joint1"),
            ("panda_joint2", "panda_joint2"),
            ("panda_joint3", "panda_joint3"),
            ("panda_joint4", "panda_joint4"),
            ("panda_joint5", "panda_joint5"),
            ("panda_joint6", "panda_joint6"),
            ("panda_joint7", "panda_joint7"),
            ("panda_finger_joint1", "panda_finger_joint1"),
        ],
    },
    Twin {
        ours: "ur5e/ur5e.urdf",
        theirs: "arms/ur_ur5e.urdf",
        links: &[
            ("base_link", "base_link"),
            ("shoulder_link", "shoulder_link"),
            ("upper_arm_link", "upper_arm_link"),
            ("forearm_link", "forearm_link"),
            ("wrist_1_link", "wrist_1_link"),
            ("wrist_2_link", "wrist_2_link"),
            ("wrist_3_link", "wrist_3_link"),
            ("tool0", "tool0"),
        ],
        joints: &[
            ("shoulder_pan_joint", "shoulder_pan_joint"),
            ("shoulder_lift_joint", "shoulder_lift_joint"),
            ("elbow_joint", "elbow_joint"),
            ("wrist_1_joint", "wrist_1_joint"),
            ("wrist_2_joint", "wrist_2_joint"),
            ("wrist_3_joint", "wrist_3_joint"),
        ],
    },
    Twin {
        ours: "wam/wam.urdf",
        theirs: "robots/barrett_wam7_bhand/wam7_bhand.urdf",
        links: &[
            ("base_link", "wam/base_link"),
            ("shoulder_yaw_link", "wam/shoulder_yaw_link"),
            ("shoulder_pitch_link", "wam/shoulder_pitch_link"),
            ("upper_arm_link", "wam/upper_arm_link"),
            ("forearm_link", "wam/forearm_link"),
            ("wrist_yaw_link", "wam/wrist_yaw_link"),
            ("wrist_pitch_link", "wam/wrist_pitch_link"),
            ("wrist_palm_link", "wam/wrist_palm_link"),
            ("hand_palm", "wam/bhand/bhand_palm_link"),
            ("finger_1_inner_link", "wam/bhand/finger_1/med_link"),
            ("finger_3_inner_link", "wam/bhand/finger_3/med_link"),
        ],
        joints: &[
            ("base_yaw_joint", "wam/base_yaw_joint"),
            ("shoulder_pitch_joint", "wam/shoulder_pitch_joint"),
            ("shoulder_yaw_joint", "wam/shoulder_yaw_joint"),
            ("elbow_pitch_joint", "wam/elbow_pitch_joint"),
            ("wrist_yaw_joint", "wam/wrist_yaw_joint"),
            ("wrist_pitch_joint", "wam/wrist_pitch_joint"),
            ("palm_yaw_joint", "wam/palm_yaw_joint"),
            ("finger_1_spread_joint", "wam/bhand/finger_1/prox_joint"),
            ("finger_1_inner_joint", "wam/bhand/finger_1/med_joint"),
            ("finger_3_inner_joint", "wam/bhand/finger_3/med_joint"),
        ],
    },
];

/// Poses of named links, relative to the first of them, with named joints at given values.
fn poses(model: &Arc<RobotModel>, joints: &[(&str, f64)], links: &[&str]) -> Vec<Pose> {
    let mut q = Configuration::neutral(model);
    for (joint, value) in joints {
        q.set(&[model.dof_named(joint).expect(joint)], &[*value]);
    }
    let mut poses = LinkPoses::default();
    Kinematics::new(Arc::clone(model)).link_poses(&q, &mut poses);
    let of = |name: &str| *poses.root_from(model.link_named(name).expect(name));
    links.iter().map(|link| of(links[0]).inverse() * of(link)).collect()
}

/// The folder of real files, or `None` (told on the terminal) where there is none.
fn shared() -> Option<PathBuf> {
    let given = std::env::var_os("ROBOTC_SHARED_DATA").map(PathBuf::from);
    let folder = given.unwrap_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data"));
    if folder.is_dir() {
        return Some(folder);
    }
    eprintln!("skipped: shared data not present");
    None
}

#[test]
fn frames_agree_with_the_vendors() {
    let Some(shared) = shared() else { return };
    for twin in TWINS {
        let ours = Arc::new(load(&specs().join("robots").join(twin.ours), MeshPolicy::Ignore));
        let theirs = Arc::new(load(&shared.join(twin.theirs), MeshPolicy::Ignore));
        for round in 0..8 {
            let value = |i: usize| 1.4 * ((3 * i + 5 * round) as f64 * 0.7).sin();
            let values = |pick: fn(&(&'static str, &'static str)) -> &'static str| -> Vec<(&str, f64)> {
                twin.joints.iter().enumerate().map(|(i, pair)| (pick(pair), value(i))).collect()
            };
            let names = |pick: fn(&(&'static str, &'static str)) -> &'static str| -> Vec<&str> {
                twin.links.iter().map(pick).collect()
            };
            let a = poses(&ours, &values(|pair| pair.0), &names(|pair| pair.0));
            let b = poses(&theirs, &values(|pair| pair.1), &names(|pair| pair.1));
            for ((a, b), (name, _)) in a.iter().zip(&b).zip(twin.links) {
                let gap = (a.to_homogeneous() - b.to_homogeneous()).abs().max();
                assert!(gap < 1e-8, "{}: {name} is {gap} off", twin.ours);
            }
        }
    }
}

#[test]
fn vendor_specifications_load() {
    // They name the shared folder by a path relative to themselves.
    let beside = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    if shared().is_none() || !beside.is_dir() {
        return;
    }
    let tasks = files(&specs().join("../tests/vendor"), ".task.toml");
    assert_eq!(tasks.len(), 4);
    for path in tasks {
        let mut sources = Sources::default();
        let (task, found) = spec::load_task(&Disk, &mut sources, &path, &ParameterTable::default());
        let task = task.unwrap_or_else(|| panic!("{}", found.to_plain_text(&sources))).task;
        // Only warnings are left, about the vendors' files.
        for finding in found.iter() {
            println!("{}: {}", path.display(), finding.message);
        }
        for object in &task.objects {
            let lowest = object.geometry.iter().flat_map(corners).map(|p| (object.world_from_object * p).z);
            let lowest = lowest.fold(f64::INFINITY, f64::min);
            assert!((lowest - 0.6).abs() < 0.009, "{} starts at height {lowest}", object.name);
        }
    }
}
