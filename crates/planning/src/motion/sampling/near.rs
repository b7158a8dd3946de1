//! Near the tree now and then: short steps find the way out of cramped places, where long motions are all blocked.

use robotc_core::rng::Rng;

use super::{Growth, Sampler, Sampling, step_from};

pub(super) const NEAR: Sampling = Sampling {
    name: "near",
    summary: "One state in ten within a step of a random node, the others anywhere.",
    make: |_, _| Box::new(Near),
};

/// States near a node, of all.
const SHARE: f64 = 0.1;

struct Near;

impl Sampler for Near {
    fn draw(&mut self, growth: &mut Growth<'_>, rng: &mut Rng, sample: &mut [f64]) {
        if rng.unit() >= SHARE {
            return growth.space.sample_into(sample, rng);
        }
        let centre = growth.tree.state(rng.below(growth.tree.len()));
        let distance = growth.step * rng.unit();
        step_from(growth.space, centre, distance, rng, sample);
    }
}
