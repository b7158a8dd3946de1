//! The swivel angles of an arm with spherical shoulder and wrist that have solutions within limits: exactly.
//!
//! Each joint comes to each of its limits at two swivel angles at most, the roots of a [`Sinusoid`](super::sinusoid::Sinusoid) (a quadratic
//! in `tan(psi / 2)`). Between all of these roots nothing changes, so that one point of each stretch tells all of it. The values
//! that a joint takes on a stretch lie between those at its ends and where it turns round, which again are such roots.

use std::f64::consts::{PI, TAU};

use robotc_core::Pose;
use robotc_core::ik::{PreferenceError, Preferences, VariableRange};

use super::sinusoid::principal;
use super::spherical::{Angle, Side, SphericalArm, Spread};
use crate::GoalType;
use crate::run::Solver;

/// Breakpoints nearer to each other than this are one, radians.
const SAME: f64 = 1e-14;

/// As near to where outer axes line up joint values are rounding, radians.
const JUMP: f64 = 1e-9;

/// One way to bend shoulder, elbow and wrist, and the swivel angles at which it keeps the limits.
#[derive(Debug, Clone)]
pub struct SwivelBranch {
    /// Value of the elbow joint, radians.
    pub elbow: f64,
    /// Side of the second joint.
    pub shoulder: Side,
    /// Side of the sixth joint.
    pub wrist: Side,
    /// Lower and upper ends, ascending, apart from each other, in [-pi, pi]; single values where the limits allow no more.
    ///
    /// At zero the axis of the elbow stands at right angles to the first axis; the arm turns about the line from shoulder to wrist.
    pub intervals: Vec<[f64; 2]>,
    joints: [Spread; 2],
    ranges: [VariableRange; 7],
}

impl Solver {
    /// All solutions of a pose that keep the limits of `preferences`, as intervals of the swivel angle: for each branch that has any.
    ///
    /// `None` unless the arm has seven joints, of which the first three and the last three meet and stand at right angles, exactly as
    /// described; and where the wrist is on the shoulder.
    pub fn swivel(
        &self,
        base_from_tip: &Pose,
        preferences: &Preferences,
    ) -> Result<Option<Vec<SwivelBranch>>, PreferenceError> {
        let ranges = preferences.ranges(self.ranges())?;
        Ok(self.swivel_within(base_from_tip, &ranges))
    }

    pub(super) fn swivel_within(
        &self,
        base_from_tip: &Pose,
        ranges: &[VariableRange],
    ) -> Option<Vec<SwivelBranch>> {
        if self.program().goal != GoalType::Transform6D {
            return None;
        }
        let ranges: [VariableRange; 7] = ranges.try_into().ok()?;
        let mut branches = Vec::new();
        for (elbow, shoulders, wrists) in SphericalArm::of(&self.chain)?.elbows(base_from_tip)? {
            for shoulder in &shoulders {
                for wrist in &wrists {
                    let mut branch = SwivelBranch {
                        elbow,
                        shoulder: shoulder.side,
                        wrist: wrist.side,
                        intervals: Vec::new(),
                        joints: [*shoulder, *wrist],
                        ranges,
                    };
                    branch.intervals = branch.within_limits();
                    if !branch.intervals.is_empty() {
                        branches.push(branch);
                    }
                }
            }
        }
        Some(branches)
    }
}

impl SwivelBranch {
    /// The solution at a swivel angle, within limits; `None` outside of the intervals. Where outer axes have lined up, one of them.
    pub fn joints(&self, psi: f64) -> Option<[f64; 7]> {
        let [low, high] = self.intervals.iter().find(|[low, high]| *low <= psi && psi <= *high)?;
        self.values(psi, 0.5 * (low + high))
    }

    /// The joint values at a swivel angle, coming from the side of `towards`, if they are within limits.
    fn values(&self, psi: f64, towards: f64) -> Option<[f64; 7]> {
        let mut all = [0.0; 7];
        all[3] = self.ranges[3].nearest(self.elbow, 0.0)?;
        for (spread, at) in self.joints.iter().zip([0, 4]) {
            all[at + 1] = self.ranges[at + 1].nearest(spread.middle.at(psi), 0.0)?;
            let (first, last) = (self.ranges[at], self.ranges[at + 2]);
            if spread.side == Side::Aligned {
                let rest = spread.last.at(psi);
                let total = together(&first, &last, spread.back).nearest(rest, 0.0)?;
                // total = last + back first
                let [low, high] = firsts(&first, &last, spread.back, [total, total]);
                all[at] = 0.0_f64.clamp(low, high);
                all[at + 2] = last.nearest(total - spread.back * all[at], 0.0)?;
            } else {
                all[at] = first.nearest(spread.first.beside(psi, towards), 0.0)?;
                all[at + 2] = last.nearest(spread.last.beside(psi, towards), 0.0)?;
            }
        }
        Some(all)
    }

    /// What must keep within which range.
    fn constraints(&self) -> Vec<(Angle, VariableRange)> {
        let mut all = Vec::new();
        for (spread, at) in self.joints.iter().zip([0, 4]) {
            let (first, last) = (self.ranges[at], self.ranges[at + 2]);
            all.push((spread.middle, self.ranges[at + 1]));
            if spread.side == Side::Aligned {
                all.push((spread.last, together(&first, &last, spread.back)));
            } else {
                all.push((spread.first, first));
                all.push((spread.last, last));
            }
        }
        all
    }

    fn within_limits(&self) -> Vec<[f64; 2]> {
        if let Some(psi) = self.joints.iter().find_map(|spread| spread.only_at) {
            let here = |x: f64| principal(x - psi).abs() < JUMP;
            let both = self
                .joints
                .iter()
                .all(|s| s.only_at.is_none_or(here) && !s.jumps.into_iter().flatten().any(here));
            let inside = both && self.values(psi, psi).is_some();
            return if inside { vec![[psi, psi]] } else { Vec::new() };
        }
        let jumps: Vec<f64> = self.joints.iter().flat_map(|spread| spread.jumps).flatten().collect();
        let mut ends = vec![-PI, PI];
        ends.extend(&jumps);
        for (angle, range) in self.constraints() {
            for limit in [range.lower, range.upper].into_iter().filter(|x| x.is_finite()) {
                ends.extend(angle.crossings(limit));
            }
        }
        // Every value of an outer joint is crossed where it jumps.
        for end in &mut ends {
            let gaps = jumps.iter().map(|jump| principal(jump - *end));
            *end = (*end + gaps.into_iter().find(|gap| gap.abs() < JUMP).unwrap_or(0.0)).clamp(-PI, PI);
        }
        ends.sort_by(f64::total_cmp);
        ends.dedup_by(|a, b| (*a - *b).abs() < SAME);
        let mut found: Vec<[f64; 2]> = Vec::new();
        let mut add = |low: f64, high: f64| match found.last_mut() {
            Some(last) if last[1] >= low => last[1] = high,
            _ => found.push([low, high]),
        };
        for (i, low) in ends.iter().enumerate() {
            // Alone where a limit is only touched; outer joints have no value where they jump.
            if jumps.iter().all(|jump| principal(jump - low).abs() > JUMP)
                && self.values(*low, *low).is_some()
            {
                add(*low, *low);
            }
            if let Some(high) = ends.get(i + 1)
                && self.values(0.5 * (low + high), *low).is_some()
            {
                add(*low, *high);
            }
        }
        found
    }

    /// The values that a joint takes within limits, as intervals in no order that may overlap; in [-pi, pi] when it turns without end, no
    /// more than a turn from zero otherwise.
    pub fn joint_intervals(&self, joint: usize) -> Vec<[f64; 2]> {
        let range = self.ranges[joint];
        if joint == 3 {
            return within(&range, [self.elbow, self.elbow]);
        }
        let at = if joint < 3 { 0 } else { 4 };
        let spread = &self.joints[usize::from(at == 4)];
        let aligned = spread.side == Side::Aligned && joint != at + 1;
        let angle = match joint - at {
            1 => spread.middle,
            0 if !aligned => spread.first,
            _ => spread.last,
        };
        let mut turns = angle.turning_points();
        turns.extend(spread.jumps.into_iter().flatten());
        // No stretch is a whole turn.
        turns.extend([-0.5 * PI, 0.0, 0.5 * PI]);
        let mut found = Vec::new();
        for [low, high] in &self.intervals {
            let mut ends: Vec<f64> = turns.iter().copied().filter(|x| low < x && x < high).collect();
            ends.extend([*low, *high]);
            ends.sort_by(f64::total_cmp);
            for pair in ends.windows(2) {
                let values = stretch(angle, pair[0], pair[1]);
                if !aligned {
                    found.extend(within(&range, values));
                    continue;
                }
                let (first, last) = (&self.ranges[at], &self.ranges[at + 2]);
                for total in within(&together(first, last, spread.back), values) {
                    let firsts = firsts(first, last, spread.back, total);
                    let values = if joint == at {
                        firsts
                    } else {
                        // Of the last joint as of the first one.
                        let total = total.map(|x| spread.back * x);
                        let ends = if spread.back > 0.0 { total } else { [total[1], total[0]] };
                        self::firsts(last, first, spread.back, ends)
                    };
                    found.extend(within(&range, values));
                }
            }
        }
        found
    }
}

/// The range of `last + back first`.
fn together(first: &VariableRange, last: &VariableRange, back: f64) -> VariableRange {
    let (a, b) = (back * first.lower, back * first.upper);
    VariableRange { lower: last.lower + a.min(b), upper: last.upper + a.max(b), ..*last }
}

/// The values of `first` within limits for which `last = total - back first` keeps its own, for any total of an interval.
fn firsts(first: &VariableRange, last: &VariableRange, back: f64, total: [f64; 2]) -> [f64; 2] {
    let (a, b) = (back * (total[0] - last.upper), back * (total[1] - last.lower));
    let low = first.lower.max(a.min(b));
    [low, first.upper.min(a.max(b)).max(low)]
}

/// The values of an angle on a stretch on which it moves one way, less than a turn: ascending, not brought back to (-pi, pi].
fn stretch(angle: Angle, low: f64, high: f64) -> [f64; 2] {
    let middle = 0.5 * (low + high);
    let (start, end) = (angle.beside(low, high), angle.beside(high, low));
    let gap = end - start;
    let still = |angle: f64| principal(angle - start).abs() < 1e-8;
    if still(end) && still(angle.at(middle)) {
        // Too little for a sense.
        let end = start + principal(gap);
        return [start.min(end), start.max(end)];
    }
    if angle.sense(middle) < 0.0 {
        let fall = if gap > 0.0 { TAU - gap } else { -gap };
        [start - fall, start]
    } else {
        [start, start + if gap < 0.0 { gap + TAU } else { gap }]
    }
}

/// The parts of an interval of angles that are within a range, each alias brought there; in [-pi, pi] when it turns without end.
fn within(range: &VariableRange, [low, high]: [f64; 2]) -> Vec<[f64; 2]> {
    let (least, most) =
        if range.is_continuous() { (-PI, PI) } else { (range.lower.max(-TAU), range.upper.min(TAU)) };
    if high == f64::INFINITY || low == f64::NEG_INFINITY || high - low >= TAU {
        return if least <= most { vec![[low.max(least), high.min(most)]] } else { Vec::new() };
    }
    let mut found = Vec::new();
    for turns in -4..=4 {
        let shift = TAU * f64::from(turns);
        let (a, b) = (low + shift, high + shift);
        // As far beyond a limit as still counts as on it.
        if a <= most + 1e-9 && b >= least - 1e-9 {
            found.push([a.clamp(least, most), b.clamp(least, most)]);
        }
    }
    found
}
