//! Anywhere, all states equally likely.

use robotc_core::rng::Rng;

use super::{Growth, Sampler, Sampling};

pub(super) const UNIFORM: Sampling = Sampling {
    name: "uniform",
    summary: "Anywhere, all states equally likely.",
    make: |_, _| Box::new(Uniform),
};

struct Uniform;

impl Sampler for Uniform {
    fn draw(&mut self, growth: &mut Growth<'_>, rng: &mut Rng, sample: &mut [f64]) {
        growth.space.sample_into(sample, rng);
    }
}
