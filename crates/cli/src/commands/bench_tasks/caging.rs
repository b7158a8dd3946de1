//! `robotc bench caging`.

use clap::Args;
use robotc_core::Seed;
use robotc_core::task::Goal;
use robotc_planning::Budget;
use robotc_planning::bench::{self, CagingBenchOptions, CagingPlace, CagingReport};
use robotc_runtime::film::{TreeKeeper, film};
use robotc_runtime::{Session, execute, view};

use super::page::{Page, Spot};
use super::table::Table;
use super::{TaskArgs, clock, open, publish};
use crate::output::{Failure, Outcome};
use crate::progress::Progress;

/// Find from where an arm can open the doors and drawers of a task, in firm grasps and in loose ones
#[derive(Args)]
#[command(after_help = "Example:\n  robotc bench caging cabinet.task.toml --places 9 --view caging.html\n\n\
    The article of each goal to open is put all around the robot, with nothing else in the way. Counted is from where it can be \
    opened by the best one firm grip, when any one firm grip is kept, and when loose grips may change within the cage; all end in \
    contact. Times are those of the processor. The page has maps of the places and a replay of the task.")]
pub(in super::super) struct Caging {
    #[command(flatten)]
    task: TaskArgs,
    /// Places along each side of a square around the robot
    #[arg(long, value_name = "N", default_value_t = CagingBenchOptions::default().places)]
    places: usize,
    /// Headings of the article at each place
    #[arg(long, value_name = "N", default_value_t = CagingBenchOptions::default().headings)]
    headings: usize,
    /// Loose grips that are used, at most
    #[arg(long, value_name = "N", default_value_t = CagingBenchOptions::default().grips)]
    grips: usize,
    /// Longest time of each search
    #[arg(long, value_name = "SECONDS", default_value_t = CagingBenchOptions::default().seconds)]
    seconds: f64,
}

pub(in super::super) fn caging(args: &Caging) -> Outcome {
    let session = open(&args.task)?;
    let planner = session.options();
    let options = CagingBenchOptions {
        places: args.places,
        headings: args.headings,
        grips: args.grips,
        seconds: args.seconds,
        ..CagingBenchOptions::default()
    };
    let mut reports = Vec::new();
    for goal in &session.task().goals {
        let Goal::Open { article, to } = *goal else { continue };
        let mut progress = Progress::new();
        let name = session.task().name_of(goal).to_owned();
        let mut done = |n: usize, all: usize| progress.update(&name, n as f64 / all as f64);
        let now = clock::processor();
        let report = session
            .with_problem(|p| bench::measure_caging(p, &planner, (article, to), &options, &now, &mut done));
        drop(progress);
        reports.extend(report);
    }
    if reports.is_empty() {
        return Err(Failure::Input(format!("{} opens nothing", args.task.task.display())));
    }
    let mut table = Table::new(&[
        "article",
        "to",
        "joints",
        "grips",
        "places",
        "one grip",
        "firm",
        "discrete",
        "random",
        "times one",
        "times firm",
        "within 2 s",
        "median s",
        "95 % s",
    ]);
    for report in &reports {
        row(&mut table, report);
    }
    publish(&args.task, &table, &reports, || page(&session, &reports))
}

fn row(table: &mut Table, report: &CagingReport) {
    let [firm, discrete, randomized] = report.opened;
    let relaxed = discrete.max(randomized);
    let times = |n: usize| if n > 0 { format!("{:.2}", relaxed as f64 / n as f64) } else { "-".into() };
    table.row([
        report.article.clone(),
        format!("{:.2}", report.opening[1]),
        report.joints.to_string(),
        report.grips.to_string(),
        report.places.len().to_string(),
        report.opened_by_one.to_string(),
        firm.to_string(),
        if report.places.iter().any(|p| p.discrete.is_some()) { discrete.to_string() } else { "-".into() },
        randomized.to_string(),
        times(report.opened_by_one),
        times(firm),
        format!("{:.0} %", 100.0 * report.within_two_seconds),
        format!("{:.3}", report.seconds[0]),
        format!("{:.3}", report.seconds[1]),
    ]);
}

fn page(session: &Session, reports: &[CagingReport]) -> Page {
    let robot = session.task().robot.model.name();
    let about = "A mark is a place and a heading of the article around the robot, which is in the middle and looks to the right.";
    let mut page = Page::new(&format!("From where {robot} opens {}", session.task().name), about);
    let legend = ["by no means", "in loose grips alone", "in a firm grip"];
    let class = |place: &CagingPlace| match place {
        _ if place.firm.opened => 2,
        _ if place.randomized.opened || place.discrete.is_some_and(|a| a.opened) => 1,
        _ => 0,
    };
    for report in reports {
        let spots: Vec<Spot> =
            report.places.iter().map(|p| Spot { at: [p.x, p.y], yaw: p.yaw, class: class(p) }).collect();
        let title = format!("{}, from {:.2} to {:.2}", report.article, report.opening[0], report.opening[1]);
        page = page.map(&title, &legend, &spots);
    }
    let times: Vec<(String, Vec<f64>)> =
        reports.iter().map(|r| (r.article.clone(), r.seconds.map(|s| 1e3 * s).to_vec())).collect();
    let page = page.bars("The randomised search, where it succeeds", "ms", &["median", "95 %"], &times);
    match replay(session) {
        Some(html) => page.replay("The task where it stands", &html),
        None => page,
    }
}

/// The task itself, planned and run; `None` when it cannot be done.
fn replay(session: &Session) -> Option<String> {
    let mut trees = TreeKeeper::default();
    let seed = Seed::new(session.task().seed);
    let plan = session.plan(&session.options(), &Budget::unlimited(), seed, &mut trees).ok()?;
    let execution = execute(session.world(), session.task(), &plan, 250.0).ok()?;
    Some(view::html(&film(session, &execution, &trees)))
}
