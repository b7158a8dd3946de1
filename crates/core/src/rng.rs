//! Seeds and random streams. A seed is always an argument; a stream is a function of its seed alone.

use rand_chacha::ChaCha8Rng;
use rand_core::{RngCore, SeedableRng};

/// The root of a tree of independent random streams.
///
/// `seed.split("rrt").rng()` is the same stream on every platform and with any number of threads; two different
/// labels give streams that have nothing to do with each other.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Seed([u8; 32]);

impl Seed {
    /// The seed named by a number, as users give it.
    pub fn new(number: u64) -> Self {
        Self(blake3::derive_key("robotc seed", &number.to_le_bytes()))
    }

    /// The seed named by 32 bytes, such as an artefact key.
    pub fn from_bytes(bytes: [u8; 32]) -> Self {
        Self(bytes)
    }

    /// The child seed with this label.
    pub fn split(&self, label: &str) -> Self {
        let mut hasher = blake3::Hasher::new_keyed(&self.0);
        hasher.update(label.as_bytes());
        Self(*hasher.finalize().as_bytes())
    }

    /// The `index`-th child seed: one for each item of a parallel loop.
    pub fn at(&self, index: u64) -> Self {
        let mut hasher = blake3::Hasher::new_keyed(&self.0);
        hasher.update(&index.to_le_bytes());
        hasher.update(&[0xff]);
        Self(*hasher.finalize().as_bytes())
    }

    /// The stream of this seed.
    pub fn rng(&self) -> Rng {
        Rng { inner: ChaCha8Rng::from_seed(self.0), spare_normal: None }
    }
}

/// A random stream: uniform, normal, directions and rotations, the same on every platform.
#[derive(Debug, Clone)]
pub struct Rng {
    inner: ChaCha8Rng,
    spare_normal: Option<f64>,
}

impl Rng {
    /// Uniform 64 random bits.
    pub fn bits(&mut self) -> u64 {
        self.inner.next_u64()
    }

    /// Uniform in [0, 1), 53 bits.
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 * (1.0 / (1u64 << 53) as f64)
    }

    /// Uniform in [`low`, `high`); `low` when the interval is empty.
    pub fn range(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// Uniform in 0..`count`; `count` must be positive.
    pub fn below(&mut self, count: usize) -> usize {
        assert!(count > 0, "a draw needs at least one outcome");
        ((u128::from(self.bits()) * count as u128) >> 64) as usize
    }

    /// Standard normal (Marsaglia's polar method).
    pub fn normal(&mut self) -> f64 {
        if let Some(spare) = self.spare_normal.take() {
            return spare;
        }
        loop {
            let (u, v) = (self.range(-1.0, 1.0), self.range(-1.0, 1.0));
            let s = u * u + v * v;
            if s > 0.0 && s < 1.0 {
                let factor = (-2.0 * libm::log(s) / s).sqrt();
                self.spare_normal = Some(v * factor);
                return u * factor;
            }
        }
    }

    /// Uniform on the unit sphere.
    pub fn direction(&mut self) -> nalgebra::Unit<nalgebra::Vector3<f64>> {
        loop {
            let v = nalgebra::Vector3::new(self.normal(), self.normal(), self.normal());
            if let Some(unit) = nalgebra::Unit::try_new(v, 1e-9) {
                return unit;
            }
        }
    }

    /// Uniform over SO(3).
    pub fn rotation(&mut self) -> nalgebra::UnitQuaternion<f64> {
        loop {
            let q = nalgebra::Quaternion::new(self.normal(), self.normal(), self.normal(), self.normal());
            if let Some(unit) = nalgebra::Unit::try_new(q, 1e-9) {
                return unit;
            }
        }
    }

    /// Shuffles `items` in place (Fisher-Yates).
    pub fn shuffle<T>(&mut self, items: &mut [T]) {
        for i in (1..items.len()).rev() {
            items.swap(i, self.below(i + 1));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn streams_repeat_and_differ_by_label() {
        let draw = |seed: Seed| seed.rng().bits();
        let root = Seed::new(7);
        assert_eq!(draw(root.split("a")), draw(root.split("a")));
        assert_ne!(draw(root.split("a")), draw(root.split("b")));
        assert_ne!(draw(root.at(0)), draw(root.at(1)));
        // Pinned, so that a change of generator cannot pass unseen: artefact bytes depend on it.
        assert_eq!(draw(Seed::new(0)), PINNED_FIRST_DRAW);
    }

    const PINNED_FIRST_DRAW: u64 = 8_430_596_658_445_201_780;

    #[test]
    fn moments_of_the_normal_stream() {
        let mut rng = Seed::new(1).rng();
        let n = 20_000;
        let draws: Vec<f64> = (0..n).map(|_| rng.normal()).collect();
        let mean = draws.iter().sum::<f64>() / n as f64;
        let variance = draws.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / n as f64;
        assert!(mean.abs() < 0.03 && (variance - 1.0).abs() < 0.05, "{mean} {variance}");
    }
}
