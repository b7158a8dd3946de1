//! A planner of one's own: it is registered beside those of `robotc`, named in a problem, and compared with them.
//!
//! `robotc-own-planner PROBLEM.json` solves the problem for a point among boxes with every planner that the registry knows,
//! the problem's own one marked. Nothing here is known to the library: the world ([`plane`]) is an edge checker, the planner
//! ([`grid`]) implements one trait.

mod grid;
mod plane;

use std::process::ExitCode;
use std::time::Instant;

use robotc_planning::problem::{PlanningProblem, Registry, solve, unknown_keys};
use robotc_planning::{Budget, EdgeChecker};

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [file] = arguments.as_slice() else {
        eprintln!("usage: robotc-own-planner PROBLEM.json");
        return ExitCode::FAILURE;
    };
    match compare(file) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn compare(file: &str) -> Result<(), Box<dyn std::error::Error>> {
    let text = std::fs::read_to_string(file)?;
    let problem = PlanningProblem::read(&text)?;
    for key in unknown_keys(&text, &problem) {
        eprintln!("warning: {key}");
    }
    let mut registry = Registry::standard();
    registry.register(Box::new(grid::Grid))?;
    registry.get(&problem.planner)?;

    for planner in registry.iter() {
        let mut world = plane::Plane::new(&problem);
        let start = Instant::now();
        let interrupt = || problem.interrupt(start.elapsed().as_secs_f64());
        let same_but_planner = PlanningProblem { planner: planner.name().into(), ..problem.clone() };
        let outcome = solve(&registry, &same_but_planner, &mut world, None, None, &Budget::new(&interrupt));
        let mark = if planner.name() == problem.planner { '*' } else { ' ' };
        match outcome {
            Ok(solved) => println!(
                "{mark} {:12} goal {}, length {:6.3} found, {:6.3} smoothed, {:5} states looked at",
                planner.name(),
                solved.goal,
                solved.length_found,
                solved.length,
                world.looked
            ),
            Err(failure) => {
                println!("{mark} {:12} {failure}", planner.name());
                if let robotc_planning::problem::SolveFailure::Search { failure, .. } = &failure {
                    for (&by, count) in &failure.blocked {
                        println!("  {:12} {count} motions: {}", "", world.describe(by));
                    }
                }
            }
        }
    }
    Ok(())
}
