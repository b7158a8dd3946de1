//! robotc
fn main() {}
