//! How many approaches a second the grasp generator tries on one core.
//!
//! `cargo run --release -p robotc-kb --example grasp_speed -- TASK...` compiles the convex parts of each task first, then times
//! its grasp sets alone, on one thread.

use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

use robotc_core::Sources;
use robotc_core::spec::load_task;
use robotc_kb::kind::{AnyKind, Entry};
use robotc_kb::kinds::{ConvexParts, GraspSet, parameter_table};
use robotc_kb::os::OsSystem;
use robotc_kb::parameters::show;
use robotc_kb::{Graph, Project, Store, compile};

#[expect(clippy::print_stdout, reason = "a program")]
fn main() -> Result<(), Box<dyn std::error::Error>> {
    static PARTS: Entry<ConvexParts> = Entry::new();
    static GRASPS: Entry<GraspSet> = Entry::new();
    rayon::ThreadPoolBuilder::new().num_threads(1).build_global()?;
    for task in std::env::args().skip(1) {
        let mut sources = Sources::new();
        let (spec, found) = load_task(&OsSystem, &mut sources, Path::new(&task), &parameter_table());
        let Some(spec) = spec else { return Err(format!("{task}: {found:?}").into()) };
        let project = Project::of_task(&spec);
        let folder = tempfile::tempdir()?;
        let store = Arc::new(Store::open(folder.path())?);
        let parts = Arc::new(Graph::plan_kinds(&project, &[&PARTS as &'static dyn AnyKind])?);
        compile(&parts, &store, &())?;
        let grasps = Arc::new(Graph::plan_kinds(&project, &[&GRASPS as &'static dyn AnyKind])?);
        let start = Instant::now();
        let report = compile(&grasps, &store, &())?;
        let seconds = start.elapsed().as_secs_f64();
        let mut most = 0.0;
        for (node, _) in report.built() {
            let node = grasps.node(node);
            let tried = node.kind.info().parameters.iter().position(|p| p.name == "approaches");
            most += tried.map_or(0.0, |i| show(&node.parameters[i]).parse().unwrap_or(0.0));
            let known = report.knowledge.known(report.knowledge.graph().indices().last().expect("a node"));
            let content = known.map(|k| store.read(&k.content)).transpose()?;
            let summary = content.map(|bytes| node.kind.summary(&bytes)).transpose()?;
            println!("{}: {}", node.title(), summary.unwrap_or_default());
        }
        println!("{task}: {seconds:.2} s, at most {:.0} approaches a second", most / seconds);
    }
    Ok(())
}
