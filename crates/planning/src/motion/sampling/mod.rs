//! Where trees are asked to grow to: one file for each way of drawing states, and one line in [`SAMPLINGS`].

mod bridge;
mod halton;
mod near;
mod uniform;

use std::fmt;

use robotc_core::Seed;
use robotc_core::rng::Rng;

use super::tree::Tree;
use crate::space::Space;

/// All ways to draw, the default first.
pub static SAMPLINGS: [Sampling; 4] = [uniform::UNIFORM, halton::HALTON, near::NEAR, bridge::BRIDGE];

/// A way to draw states.
pub struct Sampling {
    /// Lower case, digits and underscores.
    pub name: &'static str,
    /// What it does, in one sentence.
    pub summary: &'static str,
    /// A sampler for one run of a search; the seed is for what is drawn once.
    make: fn(&Space, Seed) -> Box<dyn Sampler>,
}

impl Sampling {
    /// The one with this name.
    pub fn named(name: &str) -> Option<&'static Self> {
        SAMPLINGS.iter().find(|sampling| sampling.name == name)
    }

    pub(super) fn sampler(&self, space: &Space, seed: Seed) -> Box<dyn Sampler> {
        (self.make)(space, seed)
    }
}

impl Default for &'static Sampling {
    fn default() -> Self {
        &SAMPLINGS[0]
    }
}

impl PartialEq for Sampling {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

impl fmt::Debug for Sampling {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name)
    }
}

/// Draws one state after the other.
pub(super) trait Sampler {
    /// Writes the next state into `sample`.
    fn draw(&mut self, growth: &mut Growth<'_>, rng: &mut Rng, sample: &mut [f64]);
}

/// What a sampler may know of the search.
pub(super) struct Growth<'g> {
    pub(super) space: &'g Space,
    /// The tree that is grown next.
    pub(super) tree: &'g Tree,
    /// Its longest edge.
    pub(super) step: f64,
    /// Whether a state is valid.
    pub(super) free: &'g mut dyn FnMut(&[f64]) -> bool,
}

/// Moves to a random direction from `centre`, `distance` away, and into the bounds.
fn step_from(space: &Space, centre: &[f64], distance: f64, rng: &mut Rng, sample: &mut [f64]) {
    let mut norm = 0.0;
    for x in sample.iter_mut() {
        *x = rng.normal();
        norm += *x * *x;
    }
    let scale = distance / norm.sqrt().max(f64::MIN_POSITIVE);
    for ((x, c), axis) in sample.iter_mut().zip(centre).zip(space.axes()) {
        *x = c + scale * *x / axis.weight;
    }
    space.clamp(sample);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::edge::EdgeChecker;
    use crate::toy::Toy;

    /// States of the plane with a wall that leaves a gap of a unit at the top.
    fn drawn(name: &str, count: usize, seed: u64) -> Vec<Vec<f64>> {
        let mut toy = Toy::wall(0.05);
        let space = toy.space().clone();
        let mut tree = Tree::new(&space);
        tree.plant(&space, &[1.0, 1.0]);
        let seed = Seed::new(seed);
        let (mut rng, mut sample) = (seed.rng(), vec![0.0; 2]);
        let mut sampler = Sampling::named(name).unwrap().sampler(&space, seed);
        let mut free = |q: &[f64]| toy.state(q).is_ok();
        (0..count)
            .map(|_| {
                let growth = &mut Growth { space: &space, tree: &tree, step: 1.5, free: &mut free };
                sampler.draw(growth, &mut rng, &mut sample);
                sample.clone()
            })
            .collect()
    }

    #[test]
    fn every_sampling_repeats_and_stays_in_bounds() {
        for Sampling { name, summary, .. } in &SAMPLINGS {
            assert!(summary.ends_with('.') && Sampling::named(name).is_some());
            let first = drawn(name, 200, 3);
            assert_eq!(first, drawn(name, 200, 3), "{name}");
            assert_ne!(first, drawn(name, 200, 4), "{name}");
            assert!(first.iter().flatten().all(|x| (0.0..=10.0).contains(x)), "{name}");
        }
    }

    #[test]
    fn halton_states_are_spread_more_evenly() {
        // The emptiest of the 100 squares: 1000 states put ten into each on average.
        let emptiest = |name: &str, seed: u64| {
            let mut counts = [0; 100];
            for q in drawn(name, 1000, seed) {
                counts[q[0] as usize * 10 + q[1] as usize] += 1;
            }
            *counts.iter().min().unwrap()
        };
        for seed in 0..5 {
            let (halton, uniform) = (emptiest("halton", seed), emptiest("uniform", seed));
            assert!(halton > 5 && halton > uniform, "{halton} {uniform}");
        }
    }

    #[test]
    fn bridges_lead_through_the_gap_and_near_states_surround_the_tree() {
        let share = |name: &str, inside: fn(&[f64]) -> bool| {
            drawn(name, 4000, 1).iter().filter(|q| inside(q)).count() as f64 / 4000.0
        };
        // The gap is a hundredth of the square.
        let in_gap = |q: &[f64]| (4.0..=5.0).contains(&q[0]) && q[1] > 9.0;
        assert!(share("uniform", in_gap) < 0.015);
        let near_root = |q: &[f64]| (q[0] - 1.0).hypot(q[1] - 1.0) < 1.5;
        assert!(share("near", near_root) > share("uniform", near_root) + 0.05);
        // Two walls with a slit between them: states in it are free and have blocked ones on both sides.
        let mut toy = Toy::new(vec![([0.0, 0.0], [10.0, 4.9]), ([0.0, 5.1], [10.0, 10.0])], 0.05);
        let space = toy.space().clone();
        let mut tree = Tree::new(&space);
        tree.plant(&space, &[1.0, 5.0]);
        let mut free = |q: &[f64]| toy.state(q).is_ok();
        let (mut rng, mut q) = (Seed::new(1).rng(), vec![0.0; 2]);
        let mut in_slit = |name: &str| {
            let mut sampler = Sampling::named(name).unwrap().sampler(&space, Seed::new(1));
            let hits = (0..4000).filter(|_| {
                let growth = &mut Growth { space: &space, tree: &tree, step: 1.5, free: &mut free };
                sampler.draw(growth, &mut rng, &mut q);
                (4.9..=5.1).contains(&q[1])
            });
            hits.count()
        };
        let (bridge, uniform) = (in_slit("bridge"), in_slit("uniform"));
        assert!(bridge > uniform + uniform / 4, "{bridge} {uniform}");
    }
}
