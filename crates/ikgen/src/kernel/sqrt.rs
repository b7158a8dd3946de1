//! The square root of the platform.

/// Square root; 0 for negative arguments.
pub fn sqrt(x: f64) -> f64 {
    if x > 0.0 { x.sqrt() } else { 0.0 }
}
