//! The lane checker against the scalar one: both are asked about the same motions.

use std::sync::Arc;

use nalgebra::{Point3, Translation3};
use robotc_core::geom::{
    ConvexParts, CoverOptions, DecomposeOptions, HeightField, PointCloud, SphereCover, parts_of,
};
use robotc_core::ids::Idx;
use robotc_core::model::{Geometry, Origin, Shape, TriMesh};
use robotc_core::rng::Rng;
use robotc_core::{BodyIdx, Configuration, Kinematics, LinkIdx, Pose, Robot, Seed, TypedVec, World};

use super::{LaneChecker, LaneMemory, LaneRobot, Sight, Width};
use crate::certify::certify_path;
use crate::edge::{EdgeChecker, Obstruction, Patience, bisect_edge};
use crate::manipulation::gripper_links;
use crate::scene::{Grip, MobileChecker, RobotChecker, Rules, Scene};
use crate::space::{Axis, Space};
use crate::testbed;

struct Bench {
    robot: Robot,
    world: World,
    scene: Scene,
    lanes: LaneRobot,
    space: Space,
}

fn solid(shape: Shape) -> Arc<Vec<Geometry>> {
    Arc::new(vec![Geometry { origin: Origin::default(), shape, colour: None }])
}

fn wedge() -> Shape {
    let vertices = [[0.0, 0.0, 0.0], [0.2, 0.0, 0.0], [0.0, 0.2, 0.0], [0.0, 0.0, 0.3]].map(Point3::from);
    let faces = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
    let mesh = Arc::new(TriMesh { vertices: vertices.to_vec(), faces });
    Shape::Mesh { mesh, uri: "wedge".into() }
}

fn block() -> Arc<Vec<Geometry>> {
    solid(Shape::Box { size: [0.2, 0.06, 0.04] })
}

/// Points on a ball and on a wall.
fn scan(rng: &mut Rng) -> Shape {
    let on_ball = |rng: &mut Rng| Point3::from(rng.direction().into_inner() * 0.1);
    let on_wall = |rng: &mut Rng| Point3::new(rng.range(-0.2, 0.2), 0.25, rng.range(-0.2, 0.2));
    let points = (0..400).map(|i| if i % 2 == 0 { on_ball(rng) } else { on_wall(rng) }).collect();
    Shape::Cloud { cloud: Arc::new(PointCloud::new(points, 0.01).unwrap()), uri: String::new() }
}

/// Hills with holes.
fn ground(rng: &mut Rng) -> Shape {
    let mut height = || if rng.below(20) == 0 { f64::NAN } else { rng.range(0.0, 0.08) };
    let heights = (0..12 * 9).map(|_| height()).collect();
    let field = HeightField::new(12, heights, [0.04, 0.05], Some(-0.05)).unwrap();
    Shape::HeightField { field: Arc::new(field), uri: String::new() }
}

type Covers = TypedVec<LinkIdx, Arc<SphereCover>>;

/// Spheres around the links, the same with and without a rail.
fn covers() -> Covers {
    let model = testbed::model(false);
    let cover = |collisions: &[Geometry]| {
        let parts = parts_of(collisions, &DecomposeOptions::default()).unwrap();
        Arc::new(SphereCover::of(&parts, &CoverOptions { overshoot: 0.1, least: 0.0 }))
    };
    model.links().iter().map(|link| cover(&link.collisions)).collect()
}

/// The test arm among solids of all kinds.
fn bench(rail: bool, covers: &Covers, rng: &mut Rng) -> Bench {
    let robot = testbed::robot(rail);
    let model = robot.model.clone();
    let kinematics = Kinematics::new(model.clone());
    let q = testbed::rest(&robot);
    let mut world = World::new(kinematics.clone(), Pose::translation(0.1, -0.2, 0.05), q);
    let options = DecomposeOptions::default();
    let mut bodies: TypedVec<BodyIdx, Arc<ConvexParts>> = TypedVec::new();
    let shapes = [
        Shape::Box { size: [0.3, 0.2, 0.1] },
        Shape::Sphere { radius: 0.08 },
        Shape::Cylinder { radius: 0.05, length: 0.3 },
        Shape::Capsule { radius: 0.04, length: 0.2 },
        wedge(),
        Shape::Box { size: [0.05, 0.4, 0.4] },
    ];
    for (i, shape) in shapes.into_iter().enumerate() {
        let geometry = solid(shape);
        let at = Translation3::new(rng.range(-0.8, 0.8), rng.range(-0.8, 0.8), rng.range(0.2, 0.9));
        let turn = if i % 2 == 0 { rng.rotation() } else { Pose::identity().rotation };
        world.add(&format!("body {i}"), geometry.clone(), Pose::from_parts(at, turn));
        bodies.push(Arc::new(parts_of(&geometry, &options).unwrap()));
    }
    // Something to hold; where it is put is out of reach.
    let block = block();
    world.add("block", block.clone(), Pose::translation(9.0, 0.0, 0.0));
    bodies.push(Arc::new(parts_of(&block, &options).unwrap()));
    for (name, shape) in [("scan", scan(rng)), ("ground", ground(rng))] {
        let at = Translation3::new(rng.range(-0.9, 0.9), rng.range(-0.9, 0.9), rng.range(0.0, 0.8));
        world.add(name, solid(shape), Pose::from_parts(at, rng.rotation()));
        bodies.push(Arc::new(ConvexParts::default()));
    }
    let parts: TypedVec<LinkIdx, Arc<ConvexParts>> =
        model.links().iter().map(|l| Arc::new(parts_of(&l.collisions, &options).unwrap())).collect();
    let links: Vec<LinkIdx> = model.links().indices().collect();
    let mut pairs = Vec::new();
    for (i, &a) in links.iter().enumerate() {
        let others = links[i + 1..].iter().map(|&b| (a, b));
        pairs.extend(others.filter(|pair| !robot.ignored_pairs.contains(pair)));
    }
    let dofs = robot.arms[0].dofs.clone();
    let lanes = LaneRobot::new(&kinematics, &dofs, world.q(), &parts, covers, &pairs);
    // Some with tables of neighbours, some without.
    let lanes = if rail { lanes } else { lanes.with_tables(&kinematics, &dofs, &parts) };
    let scene = Scene::new(&world, &parts, &bodies, pairs);
    let axis = |&dof| Axis::bounded(model.dofs()[dof].lower, model.dofs()[dof].upper);
    let space = Space::new(dofs.iter().map(axis).collect());
    Bench { robot, world, scene, lanes, space }
}

impl Bench {
    fn exact(&self) -> RobotChecker<'_> {
        let (dofs, q): (_, &Configuration) = (&self.robot.arms[0].dofs, self.world.q());
        RobotChecker::new(&self.scene, &self.space, dofs, q, Rules::default(), 0.01)
    }

    fn lanes<'a>(&'a self, width: Width, memory: &'a mut LaneMemory) -> LaneChecker<'a> {
        LaneChecker::new(&self.lanes, &self.scene, &self.space, 0.0, width, memory)
    }
}

#[test]
fn states_are_as_exact_geometry_says() {
    let (covers, mut rng) = (covers(), Seed::new(21).rng());
    let (mut free, mut touching) = (0, 0);
    for trial in 0..4 {
        let bench = bench(trial % 2 == 0, &covers, &mut rng);
        let mut memory = LaneMemory::default();
        let (mut exact, mut lanes) = (bench.exact(), bench.lanes(Width::widest(), &mut memory));
        for _ in 0..150 {
            let q = bench.space.sample(&mut rng);
            let (expected, found) = (exact.state(&q), lanes.state(&q));
            assert_eq!(expected.is_ok(), found.is_ok(), "{q:?}: {expected:?} {found:?}");
            if found.is_ok() { free += 1 } else { touching += 1 }
        }
    }
    assert!(free > 150 && touching > 150, "{free} {touching}");
}

#[test]
fn states_side_by_side_are_as_one_by_one() {
    let (covers, mut rng) = (covers(), Seed::new(27).rng());
    let (mut free, mut touching, mut seen) = (0, 0, 0);
    for trial in 0..4 {
        let bench = bench(trial % 2 == 0, &covers, &mut rng);
        // Some lanes stay empty, and one state is out of bounds.
        let mut states: Vec<Vec<f64>> = (0..101).map(|_| bench.space.sample(&mut rng)).collect();
        states[40][1] = 9.0;
        let rows = || states.iter().map(Vec::as_slice);
        let mut exact = bench.exact();
        let expected: Vec<bool> = states.iter().map(|q| exact.state(q).is_ok()).collect();
        let mut answers = Vec::new();
        for width in Width::all() {
            let mut memory = LaneMemory::default();
            let mut lanes = bench.lanes(width, &mut memory);
            let found = lanes.states(rows());
            assert!(found.iter().map(Result::is_ok).eq(expected.iter().copied()));
            assert_eq!(found[40], Err(Obstruction::Bounds));
            let glances = lanes.glances(rows());
            let sure = |sight: &Sight| matches!(sight, Sight::Blocked(_));
            assert!(glances.iter().zip(&expected).all(|(sight, free)| !(sure(sight) && *free)));
            seen += glances.iter().filter(|sight| sure(sight)).count();
            let first: Vec<_> =
                states.chunks(20).map(|some| lanes.first_free(some.iter().map(Vec::as_slice))).collect();
            for (some, (first, before)) in expected.chunks(20).zip(&first) {
                assert_eq!(*first, some.iter().position(|free| *free));
                assert_eq!(before.len(), first.unwrap_or(some.len()));
            }
            let apart = lanes.apart(rows());
            assert!(found.iter().zip(&apart).all(|(found, apart)| *apart || found.is_err()));
            answers.push((found, glances, first, apart));
        }
        assert!(answers.windows(2).all(|two| two[0] == two[1]), "lanes do not matter");
        free += expected.iter().filter(|free| **free).count();
        touching += expected.iter().filter(|free| !**free).count();
    }
    assert!(free > 100 && touching > 100 && seen > touching / 3, "{free} {touching} {seen}");
}

#[test]
fn a_robot_on_wheels_is_where_its_base_is() {
    let (covers, mut rng) = (covers(), Seed::new(28).rng());
    let (mut free, mut touching) = (0, 0);
    for trial in 0..3 {
        let bench = bench(trial % 2 == 0, &covers, &mut rng);
        let floor = ([-1.5, -1.2], [1.0, 2.0]);
        let (dofs, rules) = (&bench.robot.arms[0].dofs, Rules { margin: 0.004, ..Rules::default() });
        let q = bench.world.q();
        let mut exact = MobileChecker::new(&bench.scene, floor, &bench.space, dofs, q, rules.clone(), 0.01);
        let space = exact.space().clone();
        let scene = bench.scene.standing_at(Pose::translation(0.0, 0.0, 0.05));
        let robot = bench.lanes.on_wheels(floor);
        let mut memory = LaneMemory::default();
        let mut lanes = LaneChecker::with_rules(&robot, &scene, &space, &rules, Width::widest(), &mut memory);
        let states: Vec<Vec<f64>> = (0..120).map(|_| space.sample(&mut rng)).collect();
        let found = lanes.states(states.iter().map(Vec::as_slice));
        for (q, found) in states.iter().zip(&found) {
            assert_eq!(exact.state(q).is_ok(), found.is_ok(), "{q:?}");
            if found.is_ok() { free += 1 } else { touching += 1 }
        }
        // Motions of the base are seen, too.
        for two in states.windows(2) {
            if lanes.state(&two[0]).is_ok() && lanes.edge(&two[0], &two[1]).is_ok() {
                for i in 0..=20 {
                    let q = space.interpolate(&two[0], &two[1], f64::from(i) / 20.0);
                    assert!(exact.state(&q).is_ok(), "{two:?} {i}");
                }
            }
        }
    }
    assert!(free > 80 && touching > 80, "{free} {touching}");
}

#[test]
fn free_edges_are_free_throughout_and_blocked_ones_are_not() {
    let (covers, mut rng) = (covers(), Seed::new(22).rng());
    let (mut free, mut blocked) = (0, 0);
    for trial in 0..5 {
        let bench = bench(trial % 2 == 0, &covers, &mut rng);
        let mut exact = bench.exact();
        let mut memory = LaneMemory::default();
        let mut lanes = bench.lanes(Width::widest(), &mut memory);
        for _ in 0..40 {
            let from = bench.space.sample(&mut rng);
            if lanes.state(&from).is_err() {
                continue;
            }
            let to = bench.space.sample_near(&from, rng.range(0.05, 2.0), &mut rng);
            match lanes.edge(&from, &to) {
                Ok(()) => {
                    free += 1;
                    for i in 0..=200 {
                        let q = bench.space.interpolate(&from, &to, f64::from(i) / 200.0);
                        assert!(exact.state(&q).is_ok(), "{from:?} {to:?} {i}");
                    }
                }
                Err(found) => {
                    blocked += 1;
                    let q = bench.space.interpolate(&from, &to, found.fraction);
                    // Where it is blocked something touches, or nearly so.
                    let room = exact.state(&q).unwrap_or(0.0);
                    assert!(room < 1e-3, "{from:?} {to:?} {found:?} {room}");
                    let path = [from.clone(), to.clone()];
                    assert!(certify_path(&mut exact, &path, 1e-5).is_err());
                }
            }
        }
    }
    assert!(free > 30 && blocked > 30, "{free} {blocked}");
}

#[test]
fn every_number_of_lanes_gives_the_same_answers() {
    let mut rng = Seed::new(23).rng();
    let bench = bench(true, &covers(), &mut rng);
    let widths = Width::all();
    let mut memories: Vec<LaneMemory> = widths.iter().map(|_| LaneMemory::default()).collect();
    let each = widths.into_iter().zip(&mut memories);
    let mut checkers: Vec<_> = each.map(|(width, memory)| bench.lanes(width, memory)).collect();
    assert!(Width::all().windows(2).all(|w| w[0].lanes() < w[1].lanes()));
    let mut free = 0;
    for _ in 0..200 {
        let from = bench.space.sample(&mut rng);
        let to = bench.space.sample_near(&from, rng.range(0.05, 2.0), &mut rng);
        let answers: Vec<bool> = checkers.iter_mut().map(|c| c.edge(&from, &to).is_ok()).collect();
        assert!(answers.windows(2).all(|w| w[0] == w[1]), "{from:?} {to:?} {answers:?}");
        free += usize::from(answers[0]);
    }
    assert!(free > 20, "{free}");
}

#[test]
fn what_a_first_look_blocks_is_blocked_with_any_number_of_lanes() {
    let mut rng = Seed::new(24).rng();
    let bench = bench(false, &covers(), &mut rng);
    let mut memory = LaneMemory::default();
    let mut thorough = bench.lanes(Width::widest(), &mut memory);
    // These remember what they hit.
    let mut memories: Vec<LaneMemory> = Width::all().iter().map(|_| LaneMemory::default()).collect();
    let each = Width::all().into_iter().zip(&mut memories);
    let mut lasting: Vec<_> = each.map(|(width, memory)| bench.lanes(width, memory)).collect();
    lasting.iter_mut().for_each(|lanes| lanes.set_patience(Patience::Hopeful));
    let (mut passed, mut blocked, mut misled) = (0, 0, 0);
    for _ in 0..300 {
        let from = bench.space.sample(&mut rng);
        let to = bench.space.sample_near(&from, rng.range(0.05, 2.0), &mut rng);
        let free = thorough.edge(&from, &to).is_ok();
        let looks = Width::all().into_iter().map(|width| {
            let mut memory = LaneMemory::default();
            let mut lanes = bench.lanes(width, &mut memory);
            lanes.set_patience(Patience::Hopeful);
            lanes.edge(&from, &to).is_ok()
        });
        let remembering = lasting.iter_mut().map(|lanes| lanes.edge(&from, &to).is_ok());
        let looks: Vec<bool> = looks.chain(remembering).collect();
        assert!(looks.iter().all(|look| *look == looks[0]) && (looks[0] || !free), "{from:?} {to:?}");
        passed += usize::from(looks[0] && free);
        misled += usize::from(looks[0] && !free);
        blocked += usize::from(!looks[0]);
    }
    assert!(passed > 30 && blocked > 100 && misled < blocked / 4, "{passed} {blocked} {misled}");
}

#[test]
fn a_wary_look_blocks_more_with_any_number_of_lanes_and_misleads_less() {
    let mut rng = Seed::new(31).rng();
    let bench = bench(false, &covers(), &mut rng);
    let mut memory = LaneMemory::default();
    let mut thorough = bench.lanes(Width::widest(), &mut memory);
    let mut memories: Vec<LaneMemory> = Width::all().iter().map(|_| LaneMemory::default()).collect();
    let each = Width::all().into_iter().zip(&mut memories);
    let mut checkers: Vec<_> = each.map(|(width, memory)| bench.lanes(width, memory)).collect();
    let (mut passed, mut misled, mut misled_the_wary) = (0, 0, 0);
    for _ in 0..300 {
        let from = bench.space.sample(&mut rng);
        let to = bench.space.sample_near(&from, rng.range(0.05, 2.0), &mut rng);
        let mut looks = |patience: Patience| {
            let look = |lanes: &mut LaneChecker<'_>| {
                lanes.set_patience(patience);
                lanes.edge(&from, &to).is_ok()
            };
            let looks: Vec<bool> = checkers.iter_mut().map(look).collect();
            assert!(looks.iter().all(|look| *look == looks[0]), "{patience:?} {from:?} {to:?}");
            looks[0]
        };
        let (hopeful, wary) = (looks(Patience::Hopeful), looks(Patience::Wary));
        assert!(hopeful || !wary, "{from:?} {to:?}");
        let free = thorough.edge(&from, &to).is_ok();
        passed += usize::from(wary && free);
        misled += usize::from(hopeful && !free);
        misled_the_wary += usize::from(wary && !free);
    }
    assert!(passed > 30 && misled_the_wary < misled, "{passed} {misled} {misled_the_wary}");
}

#[test]
fn what_is_held_and_what_may_be_touched_is_as_exact_geometry_says() {
    let (covers, mut rng) = (covers(), Seed::new(25).rng());
    let parts = parts_of(&block(), &DecomposeOptions::default()).unwrap();
    let cover = SphereCover::of(&parts, &CoverOptions { overshoot: 0.1, least: 0.0 });
    let (mut free, mut touching, mut allowed, mut free_edges) = (0, 0, 0, 0);
    for trial in 0..6 {
        let mut bench = bench(trial % 2 == 0, &covers, &mut rng);
        let hand = gripper_links(&bench.robot, 0);
        // The target is where the fingers are in some state.
        let (target, at_target) = (BodyIdx::new(5), bench.space.sample(&mut rng));
        let mut q = bench.world.q().clone();
        q.set(&bench.robot.arms[0].dofs, &at_target);
        let palm = bench.robot.grippers[0].palm;
        let world_from_palm =
            bench.scene.world_from_robot() * bench.scene.kinematics().root_from_link(&q, palm);
        bench.scene.place(target, world_from_palm * Pose::translation(0.2, 0.0, 0.0));
        let robot = &bench.robot;
        let grip = Grip {
            body: BodyIdx::new(6),
            link: palm,
            link_from_body: Pose::from_parts(Translation3::new(0.15, 0.0, 0.02), rng.rotation()),
        };
        let holds = trial % 3 > 0;
        let rules = Rules {
            margin: [0.0, 0.01][trial % 2],
            held: holds.then(|| grip.clone()),
            gripper: hand.clone(),
            target: Some(target),
            give: (trial > 2).then_some(0.02),
            sink: (trial % 3 == 2).then_some(0.03),
        };
        let strict = Rules { target: None, sink: None, ..rules.clone() };
        let mut lanes = bench.lanes.clone().with_hand(&hand);
        if holds {
            lanes = lanes.holding(&bench.scene, &grip, &cover, |link| hand.binary_search(&link).is_err());
        }
        let (dofs, q) = (&robot.arms[0].dofs, bench.world.q());
        let exact =
            |rules: &Rules| RobotChecker::new(&bench.scene, &bench.space, dofs, q, rules.clone(), 0.01);
        let (mut by_rules, mut strictly) = (exact(&rules), exact(&strict));
        let mut memories: Vec<LaneMemory> = Width::all().iter().map(|_| LaneMemory::default()).collect();
        let each = Width::all().into_iter().zip(&mut memories);
        let mut checkers: Vec<_> = each
            .map(|(width, memory)| {
                LaneChecker::with_rules(&lanes, &bench.scene, &bench.space, &rules, width, memory)
            })
            .collect();
        for draw in 0..200 {
            let from = match draw % 2 {
                0 => bench.space.sample(&mut rng),
                _ => bench.space.sample_near(&at_target, rng.range(0.0, 0.3), &mut rng),
            };
            let expected = by_rules.is_free(&from);
            for checker in &mut checkers {
                let found = checker.state(&from);
                assert_eq!(expected.is_ok(), found.is_ok(), "{trial} {from:?}: {expected:?} {found:?}");
            }
            if expected.is_err() {
                touching += 1;
                continue;
            }
            free += 1;
            allowed += usize::from(strictly.is_free(&from).is_err());
            let to = bench.space.sample_near(&from, rng.range(0.05, 0.6), &mut rng);
            let found: Vec<bool> = checkers.iter_mut().map(|c| c.edge(&from, &to).is_ok()).collect();
            assert!(found.iter().all(|free| *free == found[0]), "{from:?} {to:?} {found:?}");
            if found[0] {
                free_edges += 1;
                for i in 0..=50 {
                    let q = bench.space.interpolate(&from, &to, f64::from(i) / 50.0);
                    assert!(by_rules.is_free(&q).is_ok(), "{trial} {from:?} {to:?} {i}");
                }
            }
        }
    }
    assert!(free > 200 && touching > 200 && allowed > 5, "{free} {touching} {allowed}");
    assert!(free_edges > 100, "{free_edges}");
}

#[test]
fn exact_edges_are_free_between_the_states_that_were_looked_at() {
    let (covers, mut rng) = (covers(), Seed::new(26).rng());
    let (mut free, mut blocked) = (0, 0);
    for trial in 0..3 {
        let bench = bench(trial % 2 == 0, &covers, &mut rng);
        let (dofs, q) = (&bench.robot.arms[0].dofs, bench.world.q());
        let checker = |margin, resolution| {
            let rules = Rules { margin, ..Rules::default() };
            RobotChecker::new(&bench.scene, &bench.space, dofs, q, rules, resolution)
                .without_self_collisions()
        };
        // With a margin of half the resolution, states in between are free without a margin.
        let (mut pairwise, mut every, mut bare) =
            (checker(0.01, 0.02), checker(0.01, 0.001), checker(0.0, 0.02));
        for _ in 0..60 {
            let from = bench.space.sample(&mut rng);
            let to = bench.space.sample_near(&from, rng.range(0.05, 1.0), &mut rng);
            if pairwise.is_free(&from).is_err() {
                continue;
            }
            match pairwise.edge(&from, &to) {
                Ok(()) => {
                    free += 1;
                    for i in 0..=200 {
                        let q = bench.space.interpolate(&from, &to, f64::from(i) / 200.0);
                        assert!(bare.is_free(&q).is_ok(), "{from:?} {to:?} {i}");
                    }
                }
                Err(found) => {
                    blocked += 1;
                    let q = bench.space.interpolate(&from, &to, found.fraction);
                    assert_eq!(pairwise.is_free(&q).is_err(), found.by != Obstruction::Bounds);
                    assert!(bisect_edge(&mut every, &from, &to).is_err());
                }
            }
        }
    }
    assert!(free > 50 && blocked > 10, "{free} {blocked}");
}
