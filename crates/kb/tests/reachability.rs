//! The reachability map against exact inverse kinematics, which for an arm of six joints finds everything.

mod support;

use std::sync::Arc;

use nalgebra::{Matrix6, Vector3};
use robotc_core::geom::{ConvexParts, box_part};
use robotc_core::rng::Rng;
use robotc_core::spec::ParameterValue;
use robotc_core::{Pose, Seed};
use robotc_kb::kinds::reachability::{
    ArmAlone, Floor, MapBases, MountedArm, Placement, Placements, Scratch, Target, Trust, Verdict,
};
use robotc_kb::kinds::{ChainReach, Reachability, ReachabilityMap};
use robotc_kb::project::OfArm;
use robotc_kb::{Graph, Knowledge, Store, compile};
use robotc_planning::placement::{BaseDistribution as _, Prism};

/// The arm of the test robot, compiled with cells of a tenth of its reach.
fn compiled(folder: &std::path::Path) -> Knowledge {
    let mut spec = support::spec();
    spec.given.set("reachability", "step", ParameterValue::Number(0.08));
    let graph = Arc::new(Graph::plan(&spec.project()).expect("a graph"));
    let store = Arc::new(Store::open(folder).expect("a store"));
    let report = compile(&graph, &store, &()).expect("the store works");
    assert!(report.complete());
    report.knowledge
}

fn configuration(arm: &ArmAlone, rng: &mut Rng) -> Vec<f64> {
    arm.chain().variables.iter().map(|v| rng.range(v.lower, v.upper)).collect()
}

/// A pose with its position anywhere in the ball that holds every tip.
fn pose(knowledge: &Knowledge, rng: &mut Rng) -> Pose {
    let ball = knowledge.load::<ChainReach>(&OfArm(0)).expect("compiled");
    let offset = rng.direction().into_inner() * (ball.radius * rng.unit().cbrt());
    Pose::from_parts((ball.centre_in_base + offset).coords.into(), rng.rotation())
}

#[test]
fn maps_agree_with_exact_inverse_kinematics() {
    let folder = tempfile::tempdir().expect("a folder");
    let knowledge = compiled(folder.path());
    let map = knowledge.load::<Reachability>(&OfArm(0)).expect("compiled");
    let arm = ArmAlone::load(&knowledge, 0).expect("compiled");
    misses_little(&map, &arm);
    promises_little_too_much(&map, &arm, &knowledge);
    all_solutions_are_found(&arm);
    bases_reach(&map, &arm, &knowledge);
    bases_among_obstacles_are_clear_and_reach(&map, &arm, &knowledge);
    manipulability_is_the_volume_of_the_jacobian(&arm);
}

/// Where the arm can be, the map does not say no.
fn misses_little(map: &ReachabilityMap, arm: &ArmAlone) {
    const COUNT: usize = 3000;
    let (mut rng, mut scratch) = (Seed::new(1).rng(), Scratch::default());
    let (mut tried, mut missed) = (0, 0);
    while tried < COUNT {
        let joints = configuration(arm, &mut rng);
        if !arm.collides(&joints, &mut scratch) {
            tried += 1;
            missed += usize::from(map.verdict(&arm.chain().forward(&joints)) == Verdict::No);
        }
    }
    assert!(missed * 100 <= COUNT, "{missed} of {COUNT} configurations are missed");
}

/// Where the map says yes, exact inverse kinematics finds a way, which is within limits and gets there.
fn promises_little_too_much(map: &ReachabilityMap, arm: &ArmAlone, knowledge: &Knowledge) {
    const COUNT: usize = 6000;
    let (mut rng, mut scratch) = (Seed::new(2).rng(), Scratch::default());
    let (mut yes, mut wrong) = (0, 0);
    for _ in 0..COUNT {
        let pose = pose(knowledge, &mut rng);
        let found = arm.reach(&pose, 1, &mut scratch);
        if let Some(joints) = &found {
            let off = pose.inv_mul(&arm.chain().forward(joints));
            assert!(off.translation.vector.norm() < 1e-8 && off.rotation.angle() < 1e-8);
            let limits = arm.chain().variables.iter().zip(joints);
            assert!(limits.into_iter().all(|(v, x)| (v.lower..=v.upper).contains(x)));
            assert!(!arm.collides(joints, &mut scratch));
        }
        if map.verdict(&pose) == Verdict::Yes {
            yes += 1;
            wrong += usize::from(found.is_none());
        }
    }
    assert!(yes > 100 && wrong * 20 <= yes, "{wrong} of {yes} promises do not hold");
}

/// All solutions of a pose: each once, each gets there, and the one that the pose was made from is among them.
fn all_solutions_are_found(arm: &ArmAlone) {
    let (mut rng, mut scratch) = (Seed::new(6).rng(), Scratch::default());
    let (mut asked, mut found, mut most) = (0, 0, 0);
    while asked < 200 {
        let joints = configuration(arm, &mut rng);
        if arm.collides(&joints, &mut scratch) {
            continue;
        }
        asked += 1;
        let pose = arm.chain().forward(&joints);
        let solutions = arm.solutions(&pose, 1, &mut scratch);
        most = most.max(solutions.len());
        for solution in &solutions {
            let off = pose.inv_mul(&arm.chain().forward(solution));
            assert!(off.translation.vector.norm() < 1e-8 && off.rotation.angle() < 1e-8);
            assert!(!arm.collides(solution, &mut scratch));
        }
        let turns = |a: f64, b: f64| (a - b).rem_euclid(std::f64::consts::TAU);
        let near = |a: f64, b: f64| turns(a, b).min(turns(b, a)) < 1e-5;
        let same = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| near(*a, *b));
        found += usize::from(solutions.iter().any(|solution| same(solution, &joints)));
        for (i, solution) in solutions.iter().enumerate() {
            assert!(!solutions[..i].iter().any(|other| same(other, solution)), "{solutions:?}");
        }
    }
    assert!(found * 100 >= asked * 98 && most > 1, "{found} of {asked}, {most} at most");
}

/// Sampled bases have collision-free inverse kinematics.
fn bases_reach(map: &ReachabilityMap, arm: &ArmAlone, knowledge: &Knowledge) {
    const COUNT: usize = 500;
    let (mut rng, mut scratch) = (Seed::new(3).rng(), Scratch::default());
    let target = |_| Target { world_from_tip: pose(knowledge, &mut rng), weight: 1.0 };
    let targets: Vec<Target> = (0..200).map(target).collect();
    let mount = Pose::translation(0.2, -0.1, 0.05);
    let placements = Placements::new(map, &targets, &[mount], Trust::Whole);
    let mut reached = 0;
    for _ in 0..COUNT {
        let placement = placements.sample(&mut rng).expect("some target is reached from somewhere");
        let world_from_base = placement.world_from_mobile() * mount;
        let base_from_tip = world_from_base.inv_mul(&targets[placement.target].world_from_tip);
        reached += usize::from(arm.reach(&base_from_tip, 1, &mut scratch).is_some());
    }
    assert!(reached * 100 >= COUNT * 95, "{reached} of {COUNT} bases reach");
}

/// A planner's bases for poses keep their footprint clear.
fn bases_among_obstacles_are_clear_and_reach(map: &ReachabilityMap, arm: &ArmAlone, knowledge: &Knowledge) {
    let base =
        Prism { footprint: vec![[0.2, -0.2], [0.2, 0.2], [-0.2, 0.2], [-0.2, -0.2]], heights: (0.0, 0.3) };
    let wall = ConvexParts::new(vec![box_part(Vector3::new(4.0, 0.2, 2.0))]);
    let floor = Floor::new([(&wall, Pose::translation(0.0, 0.3, 1.0))], &base);
    let mount = Pose::translation(0.1, 0.0, 0.0);
    let mounted = MountedArm { map, mounts: vec![mount], tool_from_tip: Pose::identity() };
    let mut bases = MapBases::new(vec![mounted], Some((&floor, &base)));
    let (mut rng, mut scratch) = (Seed::new(5).rng(), Scratch::default());
    // Poses count by their mass, as planners choose them.
    let (mut drawn, mut reached, mut count) = (0.0, 0.0, 0);
    for _ in 0..300 {
        let world_from_tip = pose(knowledge, &mut rng);
        let mass = bases.mass(0, &world_from_tip);
        let Some(stand) = bases.draw(0, &world_from_tip, &mut rng) else { continue };
        let [x, y, yaw] = stand.base;
        assert!(mass > 0.0);
        count += 1;
        let placement = Placement { position: [x, y], yaw, target: 0, mount: 0 };
        assert!(floor.is_clear(&base, &placement), "{placement:?}");
        drawn += mass;
        let base_from_tip = (placement.world_from_mobile() * mount).inv_mul(&world_from_tip);
        reached += if arm.reach(&base_from_tip, 1, &mut scratch).is_some() { mass } else { 0.0 };
    }
    assert!(count >= 100 && reached >= 0.9 * drawn, "{} of {count} bases reach", reached / drawn);
    let far = Pose::translation(0.0, 0.0, 50.0);
    assert!(bases.mass(0, &far) == 0.0 && bases.draw(0, &far, &mut rng).is_none());
}

fn manipulability_is_the_volume_of_the_jacobian(arm: &ArmAlone) {
    const H: f64 = 1e-6;
    let (mut rng, mut scratch) = (Seed::new(4).rng(), Scratch::default());
    for _ in 0..20 {
        let joints = configuration(arm, &mut rng);
        let middle = arm.chain().forward(&joints);
        let mut jacobian = Matrix6::zeros();
        for i in 0..6 {
            let moved = |by: f64| {
                let mut joints = joints.clone();
                joints[i] += by;
                arm.chain().forward(&joints)
            };
            let (back, forth) = (moved(-H), moved(H));
            let slide = (forth.translation.vector - back.translation.vector) / (2.0 * H);
            let turn = (forth.rotation * back.rotation.inverse()).scaled_axis() / (2.0 * H);
            jacobian.fixed_view_mut::<3, 1>(0, i).copy_from(&slide);
            jacobian.fixed_view_mut::<3, 1>(3, i).copy_from(&turn);
        }
        let best = arm.most_manipulable(&middle, 1, &mut scratch);
        if !arm.collides(&joints, &mut scratch) {
            let (best, most) = best.expect("these joints reach it");
            assert!(most >= arm.manipulability(&joints) * (1.0 - 1e-6) && most == arm.manipulability(&best));
        }
        let (found, expected) = (arm.manipulability(&joints), jacobian.determinant().abs());
        assert!((found - expected).abs() < 1e-5 * (1.0 + expected), "{found} {expected} at {middle:?}");
    }
}
