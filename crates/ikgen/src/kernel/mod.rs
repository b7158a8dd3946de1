//! The numeric kernel: elementary functions, root finders, and the check and polish of solutions.
//!
//! These files are plain `core` Rust over `f64` and fixed arrays, with no allocation and no dependency, for one
//! reason: the Rust back end copies them verbatim into generated sources. What a generated file runs is what
//! the interpreter and the bytecode run.

// `!(x < y)` is meant: a NaN must count as too large.
#![allow(clippy::neg_cmp_op_on_partial_ord)]

pub mod as_given;
pub mod candidate;
pub mod chain;
pub mod conic;
pub mod eigen;
pub mod elimination;
pub mod family;
pub mod math;
pub mod null;
pub mod octic;
pub mod piece;
pub mod roots;
pub mod six;
pub mod sqrt;
pub mod sqrt_core;
pub mod sweep;
pub mod vector;
pub mod waves;

/// Source text of the kernel files, as generated files carry what they call of it; the square root comes in two kinds.
#[cfg(feature = "generate")]
pub(crate) const SOURCES: [(&str, &str); 16] = [
    ("math", include_str!("math.rs")),
    ("roots", include_str!("roots.rs")),
    ("chain", include_str!("chain.rs")),
    ("candidate", include_str!("candidate.rs")),
    ("family", include_str!("family.rs")),
    ("conic", include_str!("conic.rs")),
    ("eigen", include_str!("eigen.rs")),
    ("waves", include_str!("waves.rs")),
    ("octic", include_str!("octic.rs")),
    ("vector", include_str!("vector.rs")),
    ("elimination", include_str!("elimination.rs")),
    ("null", include_str!("null.rs")),
    ("six", include_str!("six.rs")),
    ("piece", include_str!("piece.rs")),
    ("sweep", include_str!("sweep.rs")),
    ("as_given", include_str!("as_given.rs")),
];

/// The square root of the platform.
#[cfg(feature = "generate")]
pub(crate) const PLATFORM_SQRT: &str = include_str!("sqrt.rs");

/// The square root that needs nothing but `core`.
#[cfg(feature = "generate")]
pub(crate) const CORE_SQRT: &str = include_str!("sqrt_core.rs");
