//! The result as a page.

use std::fmt::Write as _;

use crate::trial::Row;

/// What must be reached, then one table for each arm.
pub fn markdown(rows: &[Row], count: usize) -> String {
    let mut out = format!(
        "# Inverse kinematics beside published solvers\n\n\
         All solvers of an arm ran on the same poses, interleaved in one process; {count} poses a set at most. Times are median and mean\n\
         over poses of the fastest of five calls, the clock's own time subtracted; of a batch of 1000 the mean, in processor time. *Ratio* is the\n\
         median by that of the published solver of the arm on the same set. *Solved*: an answer reaches the pose to 1e-6. *Wrong*: an\n\
         answer, not marked as least-squares, does not. All were built with opt-level 3, one codegen unit, thin link-time optimisation and\n\
         the default target features. *std* and *core* are generated Rust files, the latter without the square root of the platform. Of\n\
         seven joints one is given; they are measured by what `ik-geo` takes for the six of the KR 6.\n\n"
    );
    goals(rows, &mut out);
    let mut arm = "";
    for row in rows {
        if row.arm != arm {
            arm = row.arm;
            let _ = writeln!(
                out,
                "\n## {arm}\n\n| set | solver | median ns | mean ns | ratio | solved | recovered | wrong | mean solutions |\n\
                 |---|---|---:|---:|---:|---:|---:|---:|---:|"
            );
        }
        let ratio =
            peer(rows, row).map_or(String::new(), |peer| format!("{:.2}", row.median_ns / peer.median_ns));
        let median = if is_batch(row) { String::new() } else { format!("{:.0}", row.median_ns) };
        let _ = write!(out, "| {} | {} | {median} | {:.0} | {ratio} |", row.set, row.solver, row.mean_ns);
        if row.mean_solutions == 0.0 && row.solved == 0 && row.wrong == 0 && row.solver.contains(" on ") {
            out.push_str(" | | | |\n");
            continue;
        }
        let recovered = row.recovered.map_or(String::new(), |n| format!("{n}"));
        let _ = writeln!(
            out,
            " {}/{} | {recovered} | {} | {:.2} |",
            row.solved, row.poses, row.wrong, row.mean_solutions
        );
    }
    out
}

fn is_batch(row: &Row) -> bool {
    row.solver.ends_with("batch")
}

/// The published solver of an arm on the same set.
fn peer<'a>(rows: &'a [Row], row: &Row) -> Option<&'a Row> {
    rows.iter().find(|r| r.arm == row.arm && r.set == row.set && !r.solver.starts_with("robotc"))
}

/// A ratio that must be reached on every set of poses of an arm.
struct Goal {
    what: &'static str,
    arm: &'static str,
    must: f64,
    aim: f64,
}

const PEERS: [Goal; 5] = [
    Goal { what: "std by `ik-geo`", arm: "kr6", must: 0.8, aim: 0.4 },
    Goal { what: "std by `ik-geo`", arm: "ur5e", must: 0.8, aim: 0.4 },
    Goal { what: "std by `crx-kinematics`", arm: "crx10ia", must: 1.0, aim: 0.5 },
    Goal { what: "std, a joint given, by `ik-geo` on kr6", arm: "panda", must: 1.0, aim: 0.5 },
    Goal { what: "std, a joint given, by `ik-geo` on kr6", arm: "iiwa", must: 1.0, aim: 0.5 },
];

/// Ratios of what must be reached: on random poses, and where they are worst.
fn goals(rows: &[Row], out: &mut String) {
    out.push_str("| arm | ratio | must | aim | random poses | worst set |\n|---|---|---:|---:|---:|---:|\n");
    let mut line = |arm: &str, what: &str, must: f64, aim: f64, ratios: Vec<(&'static str, f64)>| {
        let random = ratios.iter().find(|(set, _)| *set == "random");
        let worst = ratios.iter().max_by(|a, b| a.1.total_cmp(&b.1));
        if let (Some((_, random)), Some((set, worst))) = (random, worst) {
            let _ = writeln!(out, "| {arm} | {what} | {must} | {aim} | {random:.2} | {worst:.2} ({set}) |");
        }
    };
    let std =
        |arm: &str| rows.iter().filter(|r| r.solver == "robotc std" && r.arm == arm).collect::<Vec<_>>();
    for Goal { what, arm, must, aim } in &PEERS {
        let ratios =
            std(arm).into_iter().filter_map(|r| Some((r.set, r.median_ns / peer(rows, r)?.median_ns)));
        line(arm, what, *must, *aim, ratios.collect());
    }
    let mut arms: Vec<&str> = rows.iter().map(|r| r.arm).collect();
    arms.dedup();
    for arm in arms {
        let batch = |r: &&Row| {
            rows.iter().find(|b| is_batch(b) && b.arm == r.arm && b.set == r.set).map(|b| b.mean_ns)
        };
        let ratios = std(arm).into_iter().filter_map(|r| Some((r.set, batch(&r)? / r.mean_ns)));
        line(arm, "bytecode, batch, by std (means)", 3.0, 1.0, ratios.collect());
    }
}
