//! Bridges over narrow passages: the middle of two blocked states, when it is free, is in one (Hsu, Jiang, Reif and Sun, "The
//! bridge test for sampling narrow passages with probabilistic roadmap planners", 2003).

use robotc_core::rng::Rng;

use super::{Growth, Sampler, Sampling, step_from};

pub(super) const BRIDGE: Sampling = Sampling {
    name: "bridge",
    summary: "One state in four is the middle of two blocked ones where that is free, the others are anywhere.",
    make: |_, _| Box::new(Bridge { pier: Vec::new() }),
};

/// Draws that try to be a bridge, of all.
const SHARE: f64 = 0.25;

/// Pairs of blocked states that are looked for at most, for one bridge.
const ATTEMPTS: u32 = 4;

/// Typical length of a bridge, in steps of the search.
const LENGTH: f64 = 1.0;

struct Bridge {
    pier: Vec<f64>,
}

impl Sampler for Bridge {
    fn draw(&mut self, growth: &mut Growth<'_>, rng: &mut Rng, sample: &mut [f64]) {
        if rng.unit() < SHARE {
            for _ in 0..ATTEMPTS {
                if self.bridge(growth, rng, sample) {
                    return;
                }
            }
        }
        growth.space.sample_into(sample, rng);
    }
}

impl Bridge {
    /// Whether `sample` is the free middle of two blocked states.
    fn bridge(&mut self, growth: &mut Growth<'_>, rng: &mut Rng, sample: &mut [f64]) -> bool {
        let space = growth.space;
        space.sample_into(sample, rng);
        if (growth.free)(sample) {
            return false;
        }
        self.pier.clear();
        self.pier.extend_from_slice(sample);
        let length = growth.step * LENGTH * rng.normal().abs();
        step_from(space, &self.pier, length, rng, sample);
        if (growth.free)(sample) {
            return false;
        }
        for ((x, pier), axis) in sample.iter_mut().zip(&self.pier).zip(space.axes()) {
            *x = 0.5 * (*x + pier);
            debug_assert!(axis.wraps || (axis.lower <= *x && *x <= axis.upper));
        }
        (growth.free)(sample)
    }
}
