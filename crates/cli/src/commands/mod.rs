//! One file per command; one line each in [`Command`] and [`run`].

mod bench;
mod bench_tasks;
mod build;
mod check;
mod compile;
mod explain;
mod graph;
mod grasps;
mod ik;
mod init;
mod kb;
mod plan;
mod plan_build;
mod run;
mod schema;
mod view;

use clap::Subcommand;

use crate::output::Outcome;

#[derive(Subcommand)]
pub(crate) enum Command {
    Bench(bench::Bench),
    Build(build::Build),
    Check(check::Check),
    Compile(compile::Compile),
    Explain(explain::Explain),
    Graph(graph::Graph),
    Grasps(grasps::Grasps),
    Ik(ik::Ik),
    Init(init::Init),
    Kb(kb::Kb),
    Plan(plan::Plan),
    PlanBuild(plan_build::PlanBuild),
    Run(run::Run),
    Schema(schema::Schema),
    View(view::View),
}

/// Does what the command line asks for.
pub(crate) fn run(command: Command) -> Outcome {
    match command {
        Command::Bench(args) => bench::run(&args),
        Command::Build(args) => build::run(&args),
        Command::Check(args) => check::run(&args),
        Command::Compile(args) => compile::run(&args),
        Command::Explain(args) => explain::run(&args),
        Command::Graph(args) => graph::run(&args),
        Command::Grasps(args) => grasps::run(&args),
        Command::Ik(args) => ik::run(&args),
        Command::Init(args) => init::run(&args),
        Command::Kb(args) => kb::run(&args),
        Command::Plan(args) => plan::run(&args),
        Command::PlanBuild(args) => plan_build::run(&args),
        Command::Run(args) => run::run(&args),
        Command::Schema(args) => schema::run(&args),
        Command::View(args) => view::run(&args),
    }
}
