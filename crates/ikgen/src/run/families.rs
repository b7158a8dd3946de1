//! Continua of solutions, found at a solution (`kernel::family`), and the members of them that keep limits.

use std::f64::consts::PI;

use robotc_core::Pose;
use robotc_core::ik::{
    FamilyPath, IkFamily, IkSolutions, InverseKinematics as _, Preferences, VariableRange,
};

use super::{Solver, frame};
use crate::GoalType;
use crate::kernel::chain::MAX_JOINTS;
use crate::kernel::family::{Family, families_of, is_singular, member_of};

impl Solver {
    /// As [`solve`](robotc_core::ik::InverseKinematics::solve), with the [families](IkSolutions::families) of the solutions.
    ///
    /// Known for solvers of whole poses.
    pub fn solve_with_families(&self, base_from_tip: &Pose, free: &[f64], out: &mut IkSolutions) {
        self.solve(base_from_tip, free, out);
        let mut found = Vec::new();
        for (index, solution) in out.iter().enumerate() {
            found.extend(self.families_at(base_from_tip, index, solution));
        }
        found.into_iter().for_each(|family| out.push_family(family));
    }

    /// The member of a family at `t`, angles not brought back to (-pi, pi]; `None` outside of its interval.
    pub fn family_member(
        &self,
        base_from_tip: &Pose,
        solution: &[f64],
        family: &IkFamily,
        t: f64,
    ) -> Option<Vec<f64>> {
        let mut own = Family {
            direction: [0.0; MAX_JOINTS],
            leader: family.leader(),
            line: family.path == FamilyPath::Line,
            interval: family.interval,
        };
        own.direction[..solution.len()].copy_from_slice(&family.direction);
        let arm = self.chain.arm(&self.held[..solution.len()]);
        let mut member = solution.to_vec();
        member_of(&arm, &frame(base_from_tip), &own, &mut member, t).then_some(member)
    }

    /// The families through one solution.
    pub(super) fn families_at(&self, base_from_tip: &Pose, index: usize, solution: &[f64]) -> Vec<IkFamily> {
        if self.program().goal != GoalType::Transform6D {
            return Vec::new();
        }
        let arm = self.chain.arm(&self.held[..solution.len()]);
        let found = families_of(&arm, &frame(base_from_tip), solution);
        let family = |family: &Family| IkFamily {
            solution: index,
            direction: family.direction[..solution.len()].to_vec(),
            path: if family.line { FamilyPath::Line } else { FamilyPath::Curve },
            interval: family.interval,
        };
        found.as_slice().iter().map(family).collect()
    }

    /// The member of a solution's families that keeps the limits: the one nearest to what is preferred, or without that the one farthest
    /// from all limits.
    pub(super) fn member_within(
        &self,
        base_from_tip: &Pose,
        solution: &[f64],
        ranges: &[VariableRange],
        preferences: &Preferences,
    ) -> Option<Vec<f64>> {
        const PLACES: usize = 128;
        let mut best: Option<(f64, Vec<f64>)> = None;
        for family in self.families_at(base_from_tip, 0, solution) {
            let near = preferences.near.as_deref();
            let mut take = |t: f64| {
                let member = self.family_member(base_from_tip, solution, &family, t)?;
                let nearest = |(v, q): (usize, &f64)| ranges[v].nearest(*q, near.map_or(0.0, |near| near[v]));
                let member: Vec<f64> = member.iter().enumerate().map(nearest).collect::<Option<_>>()?;
                let cost = match near {
                    Some(near) => preferences.squared_distance(ranges, &member, near),
                    None => -margin(ranges, &family, &member),
                };
                let better = best.as_ref().is_none_or(|(least, _)| cost < *least);
                if better {
                    best = Some((cost, member));
                }
                better.then_some(t)
            };
            let [low, high] = family.interval;
            let mut places: Vec<f64> =
                (0..=PLACES).map(|k| low + (high - low) * k as f64 / PLACES as f64).collect();
            if family.path == FamilyPath::Line {
                places.extend(crossings(ranges, &family, solution, near));
            }
            // Then ever finer around the best.
            let mut around = places.into_iter().filter_map(&mut take).last();
            let mut step = (high - low) / PLACES as f64;
            while let Some(centre) = around.filter(|_| step > 1e-6) {
                step *= 0.5;
                for t in [centre - step, centre + step] {
                    around = take(t).or(around);
                }
            }
        }
        best.map(|(_, member)| member)
    }

    /// Whether the Jacobian has lost rank at a solution.
    pub(super) fn is_singular(&self, base_from_tip: &Pose, solution: &[f64]) -> bool {
        let arm = self.chain.arm(&self.held[..solution.len()]);
        self.program().goal == GoalType::Transform6D && is_singular(&arm, &frame(base_from_tip), solution)
    }
}

/// How far the joints that move in a family are from their limits, at most 1.
fn margin(ranges: &[VariableRange], family: &IkFamily, member: &[f64]) -> f64 {
    let moving = family.direction.iter().enumerate().filter(|(_, d)| **d != 0.0);
    moving.map(|(v, _)| (member[v] - ranges[v].lower).min(ranges[v].upper - member[v])).fold(1.0, f64::min)
}

/// Where joints of a line come to their limits, halfway between these places, and where they come to the preferred values.
fn crossings(
    ranges: &[VariableRange],
    family: &IkFamily,
    solution: &[f64],
    near: Option<&[f64]>,
) -> Vec<f64> {
    let moving = || family.direction.iter().enumerate().filter(|(_, d)| **d != 0.0);
    let at = |v: usize, d: f64, target: f64| {
        let t = (target - solution[v]) / d;
        [-2.0, -1.0, 0.0, 1.0, 2.0].map(|turns| t + turns * 2.0 * PI / d.abs())
    };
    let limits = moving().flat_map(|(v, d)| [at(v, *d, ranges[v].lower), at(v, *d, ranges[v].upper)]);
    let mut places: Vec<f64> = limits.flatten().filter(|t| t.is_finite()).collect();
    places.sort_by(f64::total_cmp);
    let halfway: Vec<f64> = places.windows(2).map(|pair| 0.5 * (pair[0] + pair[1])).collect();
    places.extend(halfway);
    places.extend(near.into_iter().flat_map(|near| moving().flat_map(|(v, d)| at(v, *d, near[v]))));
    places
}
