//! What came of a benchmark: one row for each problem, and figures over all.

use serde::Serialize;

/// What came of one problem. Times, costs and checks are the medians of all seeds; the rest holds for every seed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Row {
    /// The family of scenes.
    pub scene: String,
    /// The number of the problem in its family.
    pub index: u64,
    /// Whether start and goal are free on exact geometry.
    pub valid: bool,
    /// Whether a path was found, with every seed.
    pub solved: bool,
    /// Whether every path found was proven free on exact geometry, by code that the planner does not use.
    pub certified: bool,
    /// Microseconds until the first path, everything included but the scene itself.
    pub plan_us: f64,
    /// Microseconds until the simplified path.
    pub total_us: f64,
    /// Euclidean length of the first path, radians and metres.
    pub cost: Option<f64>,
    /// The same of the simplified path.
    pub cost_simplified: Option<f64>,
    /// Stretches of motions looked at in lanes.
    pub checks: u64,
    /// Distances between convex parts asked for, where spheres did not settle it.
    pub distances: u64,
    /// Iterations of the search.
    pub iterations: u64,
    /// Why it is not valid, or not solved.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
}

/// Figures over the rows of one scene, or of all.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Summary {
    /// Problems.
    pub problems: usize,
    /// Those with a free start and goal; all other figures are over these.
    pub valid: usize,
    /// Solved with every seed.
    pub solved: usize,
    /// Solved, and every path proven free.
    pub certified: usize,
    /// Median of the times to the first path of solved problems.
    pub plan_us_median: f64,
    /// The time that 95 % of them stay below.
    pub plan_us_p95: f64,
    /// The longest.
    pub plan_us_max: f64,
    /// Median of the times to the simplified path.
    pub total_us_median: f64,
    /// The time that 95 % of them stay below.
    pub total_us_p95: f64,
    /// Mean length of the first paths.
    pub cost_mean: f64,
    /// Mean length of the simplified paths.
    pub cost_simplified_mean: f64,
    /// Median of the simplified paths.
    pub cost_simplified_median: f64,
}

/// Figures of one family of scenes.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SceneSummary {
    /// The family.
    pub scene: String,
    /// Its figures.
    #[serde(flatten)]
    pub summary: Summary,
}

/// What came of a set of problems.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Report {
    /// The robot, as the problems call it.
    pub robot: String,
    /// Seeds that each problem was planned with.
    pub seeds: u32,
    /// Seconds from the loaded robot to one that is ready to plan.
    pub ready_s: f64,
    /// One row for each problem, in the order of the set.
    pub problems: Vec<Row>,
    /// Figures by scene.
    pub scenes: Vec<SceneSummary>,
    /// Figures over all.
    pub summary: Summary,
}

impl Report {
    /// The report of these rows.
    pub fn new(robot: &str, seeds: u32, ready_s: f64, problems: Vec<Row>) -> Self {
        let mut names: Vec<&str> = problems.iter().map(|row| row.scene.as_str()).collect();
        names.dedup();
        let scene = |name: &str| SceneSummary {
            scene: name.to_owned(),
            summary: Summary::of(problems.iter().filter(|row| row.scene == name)),
        };
        let scenes = names.into_iter().map(scene).collect();
        let summary = Summary::of(problems.iter());
        Self { robot: robot.to_owned(), seeds, ready_s, problems, scenes, summary }
    }
}

impl Summary {
    fn of<'a>(rows: impl Iterator<Item = &'a Row>) -> Self {
        let rows: Vec<&Row> = rows.collect();
        let valid = rows.iter().filter(|row| row.valid).count();
        let solved: Vec<&Row> = rows.iter().copied().filter(|row| row.valid && row.solved).collect();
        let sorted = |of: &dyn Fn(&Row) -> f64| {
            let mut values: Vec<f64> = solved.iter().map(|row| of(row)).collect();
            values.sort_by(f64::total_cmp);
            values
        };
        let plan = sorted(&|row| row.plan_us);
        let total = sorted(&|row| row.total_us);
        let cost = sorted(&|row| row.cost.unwrap_or(0.0));
        let simplified = sorted(&|row| row.cost_simplified.unwrap_or(0.0));
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len().max(1) as f64;
        Self {
            problems: rows.len(),
            valid,
            solved: solved.len(),
            certified: solved.iter().filter(|row| row.certified).count(),
            plan_us_median: quantile(&plan, 0.5),
            plan_us_p95: quantile(&plan, 0.95),
            plan_us_max: quantile(&plan, 1.0),
            total_us_median: quantile(&total, 0.5),
            total_us_p95: quantile(&total, 0.95),
            cost_mean: mean(&cost),
            cost_simplified_mean: mean(&simplified),
            cost_simplified_median: quantile(&simplified, 0.5),
        }
    }
}

/// The value below which this share of the ascending values is; zero when there is none.
pub(super) fn quantile(sorted: &[f64], share: f64) -> f64 {
    match sorted.len() {
        0 => 0.0,
        n => sorted[((n - 1) as f64 * share).round() as usize],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_are_over_valid_and_solved_problems() {
        let row = |index: u64, valid: bool, solved: bool, us: f64| Row {
            scene: if index < 3 { "a" } else { "b" }.into(),
            index,
            valid,
            solved,
            certified: solved && index != 2,
            plan_us: us,
            total_us: 2.0 * us,
            cost: solved.then_some(us),
            cost_simplified: solved.then_some(0.5 * us),
            checks: 1,
            distances: 0,
            iterations: 1,
            reason: None,
        };
        let rows = vec![
            row(1, true, true, 10.0),
            row(2, true, true, 30.0),
            row(3, true, false, 99.0),
            row(4, false, false, 7.0),
            row(5, true, true, 20.0),
        ];
        let report = Report::new("r", 1, 0.1, rows);
        let all = &report.summary;
        assert_eq!((all.problems, all.valid, all.solved, all.certified), (5, 4, 3, 2));
        assert_eq!((all.plan_us_median, all.plan_us_max, all.total_us_median), (20.0, 30.0, 40.0));
        assert_eq!((all.cost_mean, all.cost_simplified_mean), (20.0, 10.0));
        let scenes: Vec<(&str, usize)> =
            report.scenes.iter().map(|s| (s.scene.as_str(), s.summary.problems)).collect();
        assert_eq!(scenes, [("a", 2), ("b", 3)]);
    }
}
