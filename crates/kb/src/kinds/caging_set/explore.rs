//! More loose grips from those that are known: each moved a little, again and again (thesis section 4.2.2).

use nalgebra::{Translation3, UnitQuaternion};
use robotc_core::rng::Rng;
use robotc_core::{Pose, Seed};
use robotc_planning::caging::CageGrasp;

use super::cage::{Caged, Seedling};
use super::{Cage, CageHold};
use crate::kinds::grip::strategy::close_fingers;

/// How grips are explored.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct ExploreOptions {
    /// Moved grips that are tried.
    pub(super) tries: u32,
    /// Farthest that one is shifted, metres.
    pub(super) shift: f64,
    /// Farthest that one is turned, radians.
    pub(super) turn: f64,
}

/// Grips that are tried at once: none of them starts from another.
const ROUND: u32 = 128;
/// Grips nearer to each other than this count as the same, as a share of the farthest that one is moved.
const SAME: f64 = 0.6;

impl ExploreOptions {
    /// Adds to `known` what its grips lead to: no new one is near to another, and each is near to the one it came from.
    ///
    /// `each` makes so many values from numbers, in parallel or not.
    pub(super) fn explore<E>(
        &self,
        caged: &Caged<'_>,
        known: &mut Vec<Cage>,
        seed: Seed,
        each: impl Fn(u32, &(dyn Fn(usize) -> Option<Cage> + Sync)) -> Result<Vec<Option<Cage>>, E>,
    ) -> Result<(), E> {
        let mut tried = 0;
        while tried < self.tries && !known.is_empty() {
            let count = ROUND.min(self.tries - tried);
            let moved = |number: usize| {
                let seed = seed.at(u64::from(tried)).at(number as u64);
                let mut rng = seed.rng();
                let from = &known[rng.below(known.len())];
                self.moved(caged, from, &mut rng, seed.split("jitter"))
            };
            for cage in each(count, &moved)?.into_iter().flatten() {
                if !known
                    .iter()
                    .any(|other| self.same(&other.grasp.part_from_tool, &cage.grasp.part_from_tool))
                {
                    known.push(cage);
                }
            }
            tried += count;
        }
        Ok(())
    }

    fn same(&self, a: &Pose, b: &Pose) -> bool {
        let shift = (a.translation.vector - b.translation.vector).norm();
        (shift / self.shift).max(a.rotation.angle_to(&b.rotation) / self.turn) < SAME
    }

    /// A grip moved a little, with fingers as loose as they were; `None` when it holds no longer.
    fn moved(&self, caged: &Caged<'_>, from: &Cage, rng: &mut Rng, jitter: Seed) -> Option<Cage> {
        let shift = rng.direction().into_inner() * (rng.unit() * self.shift);
        let turn = UnitQuaternion::from_axis_angle(&rng.direction(), rng.unit() * self.turn);
        let own = &from.grasp.part_from_tool;
        let part_from_tool =
            Pose::from_parts(Translation3::from(own.translation.vector + shift), turn * own.rotation);
        let hold = caged.hold(&Seedling { part_from_tool, values: &from.loose }, jitter)?;
        let mut cage = Cage {
            grasp: CageGrasp { part_from_tool, contact: false },
            hold,
            closed: from.loose.clone(),
            ..from.clone()
        };
        if hold == CageHold::Both
            && let Ok(closed) = close_fingers(caged.hand, caged.parts, part_from_tool, &from.loose)
        {
            // The hand gives way no farther than the article could move.
            let given = closed.object_from_tool.translation.vector - part_from_tool.translation.vector;
            let tight = Seedling { part_from_tool: closed.object_from_tool, values: &closed.closed };
            if given.norm() <= caged.options.play && caged.is_tight(&tight) {
                (cage.grasp.contact, cage.closed) = (true, closed.closed);
            }
        }
        Some(cage)
    }
}

#[cfg(test)]
mod tests {
    use std::convert::Infallible;

    use nalgebra::Vector3;
    use robotc_planning::mechanism::MechanismMotion;

    use super::super::cage::tests::{drawer, grip, with_jaws};
    use super::*;

    #[test]
    fn grips_spread_from_one_in_small_motions() {
        let start = grip(-Vector3::x(), [0.0, 0.0, 0.16], Vector3::z());
        let options = ExploreOptions { tries: 600, shift: 0.015, turn: 0.25 };
        with_jaws(&drawer(), MechanismMotion::Slide, |caged| {
            let first = caged.attempt(&start, Seed::new(1)).expect("a grip");
            let mut known = vec![first];
            let each = |count: u32, make: &(dyn Fn(usize) -> Option<Cage> + Sync)| {
                Ok::<_, Infallible>((0..count as usize).map(make).collect())
            };
            options.explore(caged, &mut known, Seed::new(2), each).expect("it cannot fail");
            assert!(known.len() > 20, "{}", known.len());
            assert!(
                known.iter().any(|cage| cage.grasp.contact) && known.iter().any(|cage| !cage.grasp.contact)
            );
            let pose = |cage: &Cage| cage.grasp.part_from_tool;
            let near = |a: &Pose, b: &Pose, share: f64| {
                let shift = (a.translation.vector - b.translation.vector).norm();
                shift <= share * options.shift + 1e-9
                    && a.rotation.angle_to(&b.rotation) <= share * options.turn + 1e-9
            };
            for (k, cage) in known.iter().enumerate().skip(1) {
                let before = &known[..k];
                assert!(before.iter().any(|other| near(&pose(cage), &pose(other), 1.0)), "{k}");
                assert!(!before.iter().any(|other| near(&pose(cage), &pose(other), 0.99 * SAME)), "{k}");
                let seedling = Seedling { part_from_tool: pose(cage), values: &cage.loose };
                assert!(!caged.touches(&seedling, 0.0));
            }
            // Far from the first one, by nothing but small turns.
            let farthest = known.iter().map(|c| pose(c).rotation.angle_to(&pose(&known[0]).rotation));
            assert!(farthest.fold(0.0, f64::max) > 0.5);
        });
    }
}
