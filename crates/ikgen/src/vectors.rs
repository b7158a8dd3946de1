//! Joint vectors of a chain.

use robotc_core::model::{ChainMotion, SerialChain};
use robotc_core::rng::Rng;

/// Uniform over a full turn of each angle, and over the limits of each length.
pub fn random(chain: &SerialChain, rng: &mut Rng) -> Vec<f64> {
    let slides = slides(chain);
    chain
        .variables
        .iter()
        .zip(slides)
        .map(|(v, slides)| {
            if !slides {
                rng.range(-std::f64::consts::PI, std::f64::consts::PI)
            } else {
                let (low, high) = (v.lower.max(-2.0), v.upper.min(2.0));
                if low < high { rng.range(low, high) } else { rng.range(-1.0, 1.0) }
            }
        })
        .collect()
}

/// Whether each variable is a length.
pub fn slides(chain: &SerialChain) -> Vec<bool> {
    let mut slides = vec![false; chain.variables.len()];
    for joint in &chain.joints {
        slides[joint.variable] = joint.motion == ChainMotion::Prismatic;
    }
    slides
}
