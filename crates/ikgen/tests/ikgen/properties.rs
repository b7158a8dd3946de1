//! How property tests draw their cases: the same ones every time.

use proptest::test_runner::{Config, RngSeed};

/// A configuration with so many cases of a fixed stream.
///
/// Campaigns widen it: `PROPTEST_CASES=25600` gives each test a hundred times its cases (256 stands for once),
/// `PROPTEST_RNG_SEED` another stream.
pub(crate) fn cases(count: u32) -> Config {
    let given = Config::default();
    let rng_seed = match given.rng_seed {
        RngSeed::Random => RngSeed::Fixed(1),
        fixed => fixed,
    };
    let cases = (u64::from(count) * u64::from(given.cases)).div_ceil(256);
    let cases = u32::try_from(cases).unwrap_or(u32::MAX);
    Config { cases, rng_seed, failure_persistence: None, ..given }
}
