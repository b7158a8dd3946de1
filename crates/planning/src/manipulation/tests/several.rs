//! Goals for which any of several objects does.

use super::*;

/// Any of the boxes, anywhere in a square about `[x, y]`.
fn any_of(objects: &[usize], [x, y]: [f64; 2]) -> Goal {
    let world_from_region = Pose::translation(x, y, TABLE + 1e-4);
    let destination = Destination::Region { world_from_region, size: [0.3; 2], origin_height: 0.06 };
    let target = |&object: &usize| Target { object, destination: destination.clone() };
    Goal::Place { targets: objects.iter().map(target).collect(), keep_upright: None }
}

/// Three boxes side by side with these goals; the first `covered` ones have a lid close above.
fn boxes(goals: Vec<Goal>, covered: usize) -> Bench {
    let places = [[0.6, -0.5], [0.6, -0.3], [0.6, -0.1]];
    let single = place(0, [0.6, 0.3], true, None);
    let moves = places.map(|at| (at, single.clone()));
    let walls = places[..covered].iter().flat_map(|[x, y]| {
        let lid = ([0.14, 0.14, 0.02], [*x, *y, TABLE + 0.14]);
        let post = |dx: f64, dy: f64| {
            let size = [if dx == 0.0 { 0.14 } else { 0.01 }, if dy == 0.0 { 0.14 } else { 0.01 }, 0.13];
            (size, [x + dx, y + dy, TABLE + 0.065])
        };
        [lid, post(0.065, 0.0), post(-0.065, 0.0), post(0.0, 0.065), post(0.0, -0.065)]
    });
    let mut bench = bench(false, &moves, &walls.collect::<Vec<_>>());
    bench.task.goals = goals;
    bench
}

fn taken(plan: &Plan) -> Vec<usize> {
    let object = |choice: &Choice| match choice {
        Choice::Place(choice) => choice.object,
        Choice::Open(_) => panic!("an object is put down"),
    };
    plan.choices.iter().map(object).collect()
}

#[test]
fn the_object_that_can_be_grasped_is_taken_and_the_others_are_accounted_for() {
    let bench = boxes(vec![any_of(&[0, 1, 2], [0.6, 0.3])], 2);
    for seed in 0..3 {
        let plan = run(&bench, seed, &Budget::unlimited()).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(taken(&plan), [2]);
        assert_eq!(plan.name_of(&bench.task, 0), "box2");
        let others = plan.choices[0].passed_over();
        assert_eq!(others.iter().map(|o| o.object).collect::<Vec<_>>(), [0, 1]);
        for other in others {
            assert!(other.tried.usable == 0 && other.tried.known == 12, "{other}");
            // Those that were looked at were in the way of the lid.
            let rejected: u32 = other.rejections.counts.values().sum();
            assert_eq!(rejected as usize, other.tried.looked_at, "{other}");
        }
        assert!(plan.segments.iter().all(|s| s.held.as_ref().is_none_or(|held| held.object == 2)));
    }
}

#[test]
fn grasps_of_all_objects_are_tried_in_one_order() {
    // A wall beside two of the boxes leaves their grasps less room.
    let bench = boxes(vec![any_of(&[0, 1, 2], [0.6, 0.3])], 2);
    let sets = [&bench.grasps; 3];
    let problem = problem(&bench, &sets);
    let objects = [0, 1, 2].map(|k| (robotc_core::BodyIdx::new(k), &bench.grasps));
    let order = ranking::ranking(&problem, &bench.task.robot.grippers[0], &bench.scene, &objects);
    assert_eq!(order.len(), 36);
    assert_eq!(order[0].0, 2, "the one that stands free comes first");
    let first_of_covered = order.iter().position(|(object, _)| *object != 2).unwrap();
    assert!(
        order[first_of_covered..].iter().any(|(object, _)| *object == 2),
        "not object by object: {order:?}"
    );
    // The search for usable grasps goes through the same set.
    let options = options(&bench);
    let usable =
        usable_grasps(&problem, &options, 0, 3, &Budget::unlimited(), Seed::new(1)).unwrap().unwrap();
    assert_eq!(usable.tried.known, 36);
    assert!(usable.found.len() == 3 && usable.found.iter().all(|grasp| grasp.object == 2));
}

#[test]
fn several_goals_take_different_objects() {
    let any = || any_of(&[0, 1, 2], [0.6, 0.3]);
    let plan = run(&boxes(vec![any(), any(), any()], 0), 1, &Budget::unlimited()).unwrap();
    let mut objects = taken(&plan);
    objects.sort();
    assert_eq!(objects, [0, 1, 2]);
    // One that is asked for by name is left to the goal that does.
    let named = place(2, [0.45, 0.3], true, None);
    let plan = run(&boxes(vec![any_of(&[1, 2], [0.6, 0.3]), named], 0), 1, &Budget::unlimited()).unwrap();
    assert_eq!(taken(&plan), [1, 2]);
    // More goals than objects.
    let two = || any_of(&[0, 1], [0.6, 0.3]);
    let plan = run(&boxes(vec![two(), two(), two()], 0), 1, &Budget::unlimited()).unwrap();
    assert_eq!(plan.choices.len(), 2);
    assert!(
        plan.skipped[0].reason.to_string().contains("put down for other goals"),
        "{}",
        plan.skipped[0].reason
    );
}

#[test]
fn a_failure_tells_what_came_of_each_object() {
    let bench = boxes(vec![any_of(&[0, 1], [0.6, 0.3])], 2);
    let failure = run(&bench, 1, &Budget::unlimited()).unwrap_err();
    let PlanFailure::NoGoal(skipped) = &failure else { panic!("{failure}") };
    let reason = &skipped[0].reason;
    assert_eq!((reason.stage, reason.tried.known, reason.passed_over.len()), (Stage::Grasps, 24, 2));
    let said = failure.to_string();
    assert!(said.contains("; box0: 0 usable of 12 looked at of 12 (gripper not free at the grasp"), "{said}");
    assert!(said.contains("; box1: 0 usable"), "{said}");
}

#[test]
fn the_certificate_notices_another_object() {
    // A plan that claims to put another object down than it does.
    let bench = boxes(vec![any_of(&[1, 2], [0.6, 0.3])], 0);
    let mut plan = run(&bench, 1, &Budget::unlimited()).unwrap();
    let Choice::Place(choice) = &mut plan.choices[0] else { panic!("an object is put down") };
    choice.object = 0;
    let sets = [&bench.grasps; 3];
    assert!(certify(&problem(&bench, &sets), &options(&bench), &plan).is_err());
}
