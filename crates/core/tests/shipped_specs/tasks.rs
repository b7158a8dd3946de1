//! Shipped robots and tasks: what stands where, and that nothing touches at the start.

use std::collections::BTreeMap;
use std::sync::Arc;

use robotc_core::Pose;
use robotc_core::diag::Sources;
use robotc_core::geom::{self, ConvexPart};
use robotc_core::model::{Configuration, Geometry, Kinematics, LinkPoses, Shape};
use robotc_core::robot::Robot;
use robotc_core::spec::{self, ParameterTable};
use robotc_core::task::Task;

use crate::{Disk, files, load_task, specs};

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

/// Shapes as convex parts with their poses; a mesh as its hull, a height field as all of its prisms.
type Parts = Vec<(ConvexPart, Pose)>;

/// Everything below the triangles of a height field.
fn prisms(field: &geom::HeightField) -> impl Iterator<Item = ConvexPart> {
    let cells =
        (0..field.rows() - 1).flat_map(|row| (0..field.columns() - 1).map(move |column| (row, column)));
    let triangles = cells.flat_map(|(row, column)| field.triangles(row, column)).flatten();
    triangles.map(|top| {
        let corners = top.iter().flat_map(|p| [*p, nalgebra::Point3::new(p.x, p.y, field.floor())]);
        ConvexPart::hull_of(&corners.collect::<Vec<_>>()).expect("finite")
    })
}

fn parts(shapes: &[Geometry]) -> Parts {
    let parts = |geometry: &Geometry| match &geometry.shape {
        Shape::Box { size } => vec![geom::box_part((*size).into())],
        Shape::Cylinder { radius, length } => vec![geom::cylinder_part(*radius, *length)],
        Shape::Capsule { radius, length } => vec![geom::capsule_part(*radius, *length)],
        Shape::Sphere { radius } => vec![geom::sphere_part(*radius)],
        Shape::Mesh { mesh, uri } => vec![ConvexPart::hull_of(&mesh.vertices).expect(uri)],
        Shape::HeightField { field, .. } => prisms(field).collect(),
        Shape::Cloud { cloud, .. } => {
            let ball = geom::sphere_part(cloud.radius());
            cloud.points().iter().map(|p| ball.transformed(&Pose::from(p.coords))).collect()
        }
    };
    let each =
        shapes.iter().flat_map(|shape| parts(shape).into_iter().map(|part| (part, shape.origin.pose())));
    each.collect()
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
    // What may have points of the robot's own is looked at when a session is opened.
    let complete = task.obstacles.iter().filter(|o| o.without_robot.is_none());
    let obstacles = complete.map(|o| (o.name.as_str(), parts(&o.geometry), o.world_from_obstacle));
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

/// The distance of each object, lifted by `height` metres, from the nearest obstacle.
pub(crate) fn lifted_gaps<'a>(task: &'a Task, height: f64) -> Vec<(&'a str, f64)> {
    let (things, objects) = things(task);
    let (objects, obstacles) = things.split_at(objects);
    let gap = |(name, parts, pose): &(&'a str, Parts, Pose)| {
        let lifted = Pose::translation(0.0, 0.0, height) * pose;
        let gaps = obstacles.iter().map(|(_, other, at)| distance(parts, &lifted, other, at));
        (*name, gaps.fold(f64::INFINITY, f64::min))
    };
    objects.iter().map(gap).collect()
}

#[test]
fn objects_stand_on_something_and_apart() {
    for path in files(&specs(), ".task.toml") {
        let task = load_task(&path).task;
        for (name, gap) in lifted_gaps(&task, 0.0) {
            assert!(gap < 1e-5, "{}: {name} hangs {gap} m in the air", path.display());
        }
        for (name, gap) in lifted_gaps(&task, 0.001) {
            assert!((gap - 0.001).abs() < 1e-5, "{}: {name} sticks in something", path.display());
        }
        let (things, objects) = things(&task);
        for (i, (name, parts, pose)) in things[..objects].iter().enumerate() {
            for (other, other_parts, other_pose) in &things[i + 1..objects] {
                let gap = distance(parts, pose, other_parts, other_pose);
                assert!(gap > 0.03, "{}: {name} and {other}: {gap} m", path.display());
            }
        }
    }
}
