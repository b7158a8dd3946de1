//! Specifications of robots and tasks, down to the graph of artefacts that they ask for.

use std::path::Path;

use robotc_core::diag::Sources;
use robotc_core::spec;
use robotc_kb::{Graph, Project};

use crate::surroundings::{shown, surroundings};

/// Any bytes as a robot and as a task specification: findings, or a value and the graph of its artefacts.
pub(crate) fn spec(bytes: &[u8]) {
    let parameters = robotc_kb::kinds::parameter_table();
    let mut system = surroundings();
    // Some of the seeds stand beside `files/`, others in it.
    for folder in ["", "files/"] {
        let (robot, task) = (format!("{folder}a.robot.toml"), format!("{folder}a.task.toml"));
        system.insert(&robot, bytes);
        system.insert(&task, bytes);

        let mut sources = Sources::new();
        let (spec, found) = spec::load_robot(&system, &mut sources, Path::new(&robot), &parameters);
        shown(&found, &sources);
        assert_eq!(spec.is_none(), found.has_errors());
        if let Some(spec) = spec {
            planned(&Project::of_robot(&spec));
        }

        let mut sources = Sources::new();
        let (spec, found) = spec::load_task(&system, &mut sources, Path::new(&task), &parameters);
        shown(&found, &sources);
        assert_eq!(spec.is_none(), found.has_errors());
        if let Some(spec) = spec {
            planned(&Project::of_task(&spec));
        }
    }
}

/// A checked specification asks for artefacts, or is told why it cannot.
fn planned(project: &Project) {
    match Graph::plan(project) {
        Ok(graph) => assert!(!graph.to_dot().is_empty()),
        Err(error) => assert!(!error.to_string().is_empty()),
    }
}
