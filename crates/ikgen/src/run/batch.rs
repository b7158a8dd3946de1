//! Many poses in one call.

use std::cell::RefCell;

use robotc_core::Pose;
use robotc_core::ik::IkSolutions;

use super::frame;
use super::lanes::{self, LANES, Offer, Wide};
use super::solver::{Engine, Solver};
use crate::kernel::candidate::MOST_MISSES;
use crate::kernel::chain::Frame;

/// The solutions of many poses, in the order of the poses.
#[derive(Debug, Clone, Default)]
pub struct Batch {
    width: usize,
    values: Vec<f64>,
    /// Where the solutions of each pose end.
    ends: Vec<usize>,
    /// Room for the next call.
    registers: Vec<Wide>,
}

impl Batch {
    /// Number of poses.
    pub fn len(&self) -> usize {
        self.ends.len()
    }

    /// Whether there is no pose.
    pub fn is_empty(&self) -> bool {
        self.ends.is_empty()
    }

    /// The solutions of a pose: joint vectors as [`InverseKinematics::solve`](robotc_core::ik::InverseKinematics::solve) gives them,
    /// in the same order.
    pub fn solutions(&self, pose: usize) -> impl ExactSizeIterator<Item = &[f64]> {
        let start = pose.checked_sub(1).map_or(0, |before| self.ends[before]);
        self.values[start..self.ends[pose]].chunks_exact(self.width.max(1))
    }

    fn push(&mut self, solutions: &IkSolutions) {
        self.values.extend(solutions.iter().flatten());
        self.ends.push(self.values.len());
    }
}

/// What is known of the pose of a lane.
#[derive(Default)]
struct Lane {
    found: IkSolutions,
    misses: usize,
}

impl Solver {
    /// All solutions of many poses: the same as one [`solve`](robotc_core::ik::InverseKinematics::solve) each, faster.
    ///
    /// `free` holds the values of the free variables of one pose after the other.
    pub fn solve_batch(&self, base_from_tip: &[Pose], free: &[f64], out: &mut Batch) {
        self.batch(base_from_tip, free, out, false);
    }

    /// As [`solve_batch`](Self::solve_batch), but what has no solution at first sight is not looked at again with wider
    /// slack: a pose at which several axes line up may come out empty. Fast where most poses are out of reach, and they were
    /// drawn, or the free values were, so that singular ones do not matter.
    pub fn solve_batch_once(&self, base_from_tip: &[Pose], free: &[f64], out: &mut Batch) {
        self.batch(base_from_tip, free, out, true);
    }

    fn batch(&self, base_from_tip: &[Pose], free: &[f64], out: &mut Batch, once: bool) {
        let (n, all, given) = (self.ranges.len(), self.program.variables, self.program.free.len());
        assert_eq!(free.len(), given * base_from_tip.len(), "one value for each free variable of each pose");
        out.width = n;
        out.values.clear();
        out.ends.clear();
        let mut registers = std::mem::take(&mut out.registers);
        let arm = self.chain.arm(&self.held[..all]);
        let lanes: RefCell<[Lane; LANES]> = RefCell::default();
        // As one pose keeps its candidates.
        let keep = |lane: usize, pose: &Frame, offer: Offer<'_>| {
            let Lane { found, misses } = &mut lanes.borrow_mut()[lane];
            let Offer { values, steps } = offer;
            let right = *misses < MOST_MISSES
                && steps.is_none_or(|steps| arm.settle(pose, steps, values))
                && self.is_in_front(values);
            if !right {
                *misses += 1;
            } else if !found.iter().any(|other| arm.same(&values[..n], other)) {
                found.push(&values[..n]);
            }
            right
        };
        let mut run = lanes::Run::new(&self.code, &mut registers, self.program.slack, keep);
        let mut alone = IkSolutions::new();
        for (group, poses) in base_from_tip.chunks(LANES).enumerate() {
            let first = group * LANES;
            let given_of = |i: usize| &free[(first + i) * given..][..given];
            for lane in lanes.borrow_mut().iter_mut() {
                lane.found.reset(n);
                lane.misses = 0;
            }
            let frames: Vec<(Frame, &[f64])> =
                poses.iter().enumerate().map(|(i, pose)| (frame(pose), given_of(i))).collect();
            let outcome = match self.engine {
                Engine::Bytecode if self.general.is_none() => run.run(&frames),
                _ => lanes::Outcome { unfinished: u8::MAX, empty: 0 },
            };
            for (i, (frame, given)) in frames.iter().enumerate() {
                let (unfinished, empty) = (outcome.unfinished >> i & 1 == 1, outcome.empty >> i & 1 == 1);
                alone.reset(n);
                if unfinished {
                    self.attempt(frame, given, self.program.slack, &mut alone, &mut |_| false);
                } else if !empty {
                    out.push(&lanes.borrow()[i].found);
                    continue;
                }
                if !once && alone.is_empty() {
                    self.look_wider(frame, given, &mut alone, &mut |_| false);
                }
                out.push(&alone);
            }
        }
        out.registers = registers;
    }
}
