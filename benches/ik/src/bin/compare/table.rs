//! The result as a page.

use std::fmt::Write as _;

use crate::trial::Row;

/// One table for each arm.
pub fn markdown(rows: &[Row], count: usize) -> String {
    let mut out = format!(
        "# Inverse kinematics beside published solvers\n\n\
         All solvers of an arm ran on the same poses, interleaved in one process; {count} poses a set at most. Times are the median over\n\
         poses of the fastest of five calls, the clock's own time subtracted. *Ratio* is to the published solver of the arm on the same\n\
         set; the time of a batch is its mean. *Solved*: an answer reaches the pose to 1e-6. *Wrong*: an answer, not marked as least-squares,\n\
         does not. All were built with opt-level 3, one codegen unit, thin link-time optimisation and the default target features. *std*\n\
         and *core* are generated Rust files, the latter without the square root of the platform. Of seven joints one is given; they are\n\
         measured by what `ik-geo` takes for the six of the KR 6.\n"
    );
    let mut arm = "";
    for row in rows {
        if row.arm != arm {
            arm = row.arm;
            let _ = writeln!(
                out,
                "\n## {arm}\n\n| set | solver | median ns | ratio | solved | recovered | wrong | mean solutions |\n|---|---|---:|---:|---:|---:|---:|---:|"
            );
        }
        let peer =
            rows.iter().find(|r| r.arm == row.arm && r.set == row.set && !r.solver.starts_with("robotc"));
        let ratio = peer.map_or(String::new(), |peer| format!("{:.2}", row.median_ns / peer.median_ns));
        let _ = write!(out, "| {} | {} | {:.0} | {ratio} |", row.set, row.solver, row.median_ns);
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
