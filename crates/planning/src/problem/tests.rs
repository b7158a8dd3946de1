//! Documents, names and the whole way on a plane.

use std::path::Path;

use super::*;
use crate::arm::ArmModel;
use crate::budget::{Budget, Interrupt};
use crate::edge::{EdgeChecker, Obstruction, walk_path};
use crate::goal::{FixedGoals, GoalDraw, GoalSampler};
use crate::jitter::JitterOptions;
use crate::motion::{Race, race};
use crate::testbed::{self, REST};
use crate::toy::Toy;
use robotc_core::{Pose, Seed};

fn toy() -> Toy {
    let mut toy = Toy::wall(0.05);
    toy.padding = 0.025;
    toy
}

fn problem() -> PlanningProblem {
    PlanningProblem::new(toy().space(), &[1.0, 1.0], vec![vec![9.0, 1.0]])
}

#[test]
fn documents_come_back_as_they_were_written() {
    let mut all = problem();
    all.constraint = Some(ConstraintDocument::Region {
        world_from_region: PoseDocument::of(&Pose::translation(0.5, 0.0, 0.4)),
        tool_from_frame: PoseDocument::of(&Pose::identity()),
        low: [None, Some(-0.2), Some(-0.1), Some(-0.1), Some(-0.1), None],
        high: [None, Some(0.2), Some(0.1), Some(0.1), Some(0.1), None],
        tolerance: Default::default(),
    });
    all.jitter = Some(JitterOptions::default());
    all.time_limit = Some(2.0);
    all.options.insert("cells".into(), 40.into());
    let text = all.write();
    assert_eq!(PlanningProblem::read(&text).unwrap(), all);
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden/problem.json");
    if std::env::var_os("BLESS").is_some() {
        std::fs::write(&file, format!("{text}\n")).expect("the golden file can be written");
    }
    assert_eq!(std::fs::read_to_string(&file).expect("the golden file is there"), format!("{text}\n"));
    // What has a default may be left out.
    let short = r#"{"version": 1, "axes": [{"bounds": [0, 10]}, {"bounds": [0, 10]}], "start": [1, 1], "goals": [[9, 1]]}"#;
    assert_eq!(PlanningProblem::read(short).unwrap(), problem());
    assert_eq!((all.interrupt(1.9), all.interrupt(2.0)), (None, Some(Interrupt::TimeUp)));
}

#[test]
fn wrong_documents_are_refused_with_the_place() {
    let with = |from: &str, to: &str| {
        let text = problem().write();
        assert!(text.contains(from), "{text}");
        PlanningProblem::read(&text.replacen(from, to, 1)).unwrap_err().to_string()
    };
    for (from, to, message) in [
        ("\"version\": 1", "\"version\": 7", "the problem has version 7; this library reads version 1"),
        ("\"step\": 0.1", "\"step\": 0.0", "search.step is 0, expected more than 0"),
        ("\"weight\": 1.0", "\"weight\": -1.0", "axes[0].weight is -1, expected more than 0"),
        ("\"local\": 0.3", "\"local\": 1.5", "search.local is 1.5, expected from 0 to 1"),
        ("\"resolution\": 0.01", "\"resolution\": -0.01", "resolution is -0.01, expected more than 0"),
        ("\"race\": 1", "\"race\": 0", "race is 0, expected from 1 to 64"),
        ("\"time_limit\": null", "\"time_limit\": -1", "time_limit is -1, expected at least 0"),
    ] {
        let found = with(from, to);
        assert!(found.contains(message), "{found}");
    }
    let mut short = problem();
    short.goals[0].pop();
    assert_eq!(short.check().unwrap_err().to_string(), "goals[0] has 1 coordinates, there are 2 axes");
    assert!(PlanningProblem::read("{").unwrap_err().to_string().contains("line 1"));
}

#[test]
fn unknown_keys_are_ignored_but_not_unseen() {
    let text = problem().write();
    let problem = PlanningProblem::read(&text).unwrap();
    assert_eq!(unknown_keys(&text, &problem), []);
    let newer = text
        .replacen("\"planner\"", "\"planer\"", 1)
        .replacen("\"step\": 0.1", "\"steps\": 0.1, \"heuristic\": {\"name\": \"manhattan\"}", 1)
        .replacen("\"weight\": 1.0", "\"wait\": 2, \"weight\": 1.0", 1);
    let read = PlanningProblem::read(&newer).unwrap();
    assert_eq!(
        (read.planner.as_str(), read.search.step),
        ("rrt_connect", crate::rrt::RrtOptions::default().step)
    );
    let found: Vec<String> = unknown_keys(&newer, &read).iter().map(ToString::to_string).collect();
    assert_eq!(
        found,
        [
            "`axes.0.wait` is not known, and ignored",
            "`planer` is not known, and ignored; did you mean `planner`?",
            "`search.heuristic` is not known, and ignored",
            "`search.steps` is not known, and ignored; did you mean `step`?",
        ]
    );
}

#[test]
fn all_planners_of_the_registry_solve_the_plane() {
    let registry = Registry::standard();
    for planner in registry.iter() {
        for seed in 0..5 {
            let mut problem = problem();
            problem.planner = planner.name().into();
            problem.seed = seed;
            let solved = solve(&registry, &problem, &mut toy(), None, None, &Budget::unlimited());
            if planner.name() == "straight" {
                let SolveFailure::Search { failure, .. } = solved.unwrap_err() else { panic!("a wall") };
                assert_eq!(failure.reason, PathFailureReason::Exhausted);
                assert_eq!(failure.blocked[&Obstruction::Contact(0)], 1);
                continue;
            }
            let solved = solved.unwrap_or_else(|e| panic!("{}: {e}", planner.name()));
            walk_path(&mut Toy::wall(0.0005), &solved.path).unwrap();
            assert_eq!((&solved.path[0], solved.path.last()), (&problem.start, problem.goals.last()));
            assert!(solved.length <= solved.length_found && solved.length > 8.0);
        }
    }
    let mut straight = problem();
    straight.planner = "straight".into();
    straight.goals = vec![vec![9.0, 1.0], vec![4.5, 1.0], vec![1.0, 9.0]];
    let solved = solve(&registry, &straight, &mut toy(), None, None, &Budget::unlimited()).unwrap();
    assert_eq!((solved.goal, solved.bad_goals), (2, vec![(1, Obstruction::Contact(0))]));
}

#[test]
fn racing_searches_give_the_same_path_with_any_number_of_threads() {
    let registry = Registry::standard();
    let search = |toy: &mut Toy, racer: u32, budget: &Budget<'_>| {
        solve_racer(&registry, &problem(), toy, None, None, budget, racer)
    };
    let raced = |racers: u32, head_start: u32, threads: usize| {
        let mut toys: Vec<Toy> = (0..threads).map(|_| toy()).collect();
        let (first, others) = toys.split_first_mut().unwrap();
        race(first, others, Race { racers, head_start }, &search, &|| None).unwrap()
    };
    let alone = solve(&registry, &problem(), &mut toy(), None, None, &Budget::unlimited()).unwrap();
    assert_eq!(raced(1, 0, 1), alone);
    assert_eq!(raced(8, 100_000, 2), alone, "it arrives within its head start");
    let first = raced(8, 0, 1);
    assert!(first.iterations < alone.iterations, "one of eight is quicker");
    for threads in 2..5 {
        assert_eq!(raced(8, 0, threads), first);
    }
}

#[test]
fn starts_are_jittered_and_goals_sampled_when_asked() {
    let registry = Registry::standard();
    let mut problem = problem();
    problem.start = vec![4.02, 1.0];
    let grazing = solve(&registry, &problem, &mut toy(), None, None, &Budget::unlimited()).unwrap_err();
    assert_eq!(grazing.to_string(), "the start is not free");
    problem.jitter = Some(JitterOptions { limit: 0.3, ..JitterOptions::default() });
    let mut late = FixedGoals::new(vec![vec![1.0, 9.0]]);
    let goals: Option<&mut dyn GoalSampler> = Some(&mut late);
    let solved = solve(&registry, &problem, &mut toy(), goals, None, &Budget::unlimited()).unwrap();
    assert!(solved.jittered > 0.04 && solved.path[0] == [4.02, 1.0] && solved.path[1][0] < 4.0);
    assert_eq!(late.draw(&Budget::unlimited()), Ok(GoalDraw::Exhausted));
    walk_path(&mut Toy::wall(0.0005), &solved.path[1..]).unwrap();
}

#[test]
fn failures_name_their_reason() {
    let registry = Registry::standard();
    let fails = |change: &dyn Fn(&mut PlanningProblem)| {
        let mut problem = problem();
        change(&mut problem);
        solve(&registry, &problem, &mut toy(), None, None, &Budget::unlimited()).unwrap_err().to_string()
    };
    assert_eq!(
        fails(&|p| p.planner = "prm".into()),
        "there is no planner prm; there are rrt_connect, rrt_lazy, rrt, straight"
    );
    assert_eq!(fails(&|p| p.axes[0].weight = 2.0), "the limits of the problem are not those of the checker");
    assert_eq!(fails(&|p| p.goals[0][0] = 4.5), "no goal configuration was found (1 goals are not free)");
    assert_eq!(fails(&|p| p.search.max_iterations = 3), "no path after 3 iterations");
    assert_eq!(fails(&|p| p.start = vec![4.5, 1.0]), "the start is not free");
    let spent = || Some(Interrupt::TimeUp);
    for name in ["rrt_connect", "rrt", "straight"] {
        let mut problem = problem();
        problem.planner = name.into();
        let failure = solve(&registry, &problem, &mut toy(), None, None, &Budget::new(&spent)).unwrap_err();
        assert_eq!(failure.to_string(), "the time limit was reached after 0 iterations", "{name}");
    }
}

/// A planner that only knows its name.
struct Named(&'static str);

impl PathPlanner for Named {
    fn name(&self) -> &str {
        self.0
    }
    fn summary(&self) -> &str {
        "Nothing."
    }
    fn plan(
        &self,
        _: &mut dyn EdgeChecker,
        _: Query<'_>,
        _: &Budget<'_>,
        _: Seed,
    ) -> Result<PathSolution, PathFailure> {
        let reason = PathFailureReason::Unsupported("anything".into());
        Err(PathFailure { reason, iterations: 0, blocked: Default::default() })
    }
}

#[test]
fn planners_from_outside_are_registered_once_and_with_good_names() {
    let mut registry = Registry::standard();
    registry.register(Box::new(Named("mine"))).unwrap();
    assert_eq!(registry.register(Box::new(Named("mine"))), Err(RegistryError::Taken("mine".into())));
    assert_eq!(registry.register(Box::new(Named("rrt"))), Err(RegistryError::Taken("rrt".into())));
    for bad in ["", "My", "a b", "rrt-connect"] {
        assert_eq!(registry.register(Box::new(Named(bad))), Err(RegistryError::BadName(bad.into())));
    }
    let mut problem = problem();
    problem.planner = "mine".into();
    let failure = solve(&registry, &problem, &mut toy(), None, None, &Budget::unlimited()).unwrap_err();
    assert_eq!(failure.to_string(), "the planner cannot do this: anything");
}

#[test]
fn constraints_are_built_for_an_arm() {
    let arm: ArmModel = testbed::arm(false);
    let pose = PoseDocument::of(&arm.world_from_tool(&REST).inverse());
    let text = r#"{"kind": "upright", "tool_from_object": POSE, "tilt": 0.2}"#
        .replace("POSE", &serde_json::to_string(&pose).unwrap());
    let upright: ConstraintDocument = serde_json::from_str(&text).unwrap();
    assert!(upright.build(&arm).unwrap().holds(&REST));
    let door =
        r#"{"kind": "mechanism", "tool_from_part": POSE, "mechanism": {"motion": "hinge", "range": [0, 1],
        "world_from_axis": {"position": [0, 0, 0]}}}"#
            .replace("POSE", &serde_json::to_string(&pose).unwrap());
    let door: ConstraintDocument = serde_json::from_str(&door).unwrap();
    assert!(door.build(&arm).unwrap().holds(&REST));
    let region = |yaw: f64, pitch: f64| ConstraintDocument::Region {
        world_from_region: pose,
        tool_from_frame: PoseDocument { position: [0.0; 3], orientation: [0.0, 0.0, 0.0, yaw] },
        low: [None, None, None, Some(-0.1), Some(-pitch), None],
        high: [None, None, None, Some(0.1), Some(pitch), None],
        tolerance: Default::default(),
    };
    let error = |document: ConstraintDocument| document.build(&arm).err().map(|e| e.to_string());
    assert_eq!(error(region(1.0, 0.1)), None);
    assert_eq!(error(region(0.0, 0.1)).unwrap(), "constraint.tool_from_frame is not a pose");
    assert!(error(region(1.0, 1.5)).unwrap().contains("quarter turn"));
}
