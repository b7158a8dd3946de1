//! The square root from sums and products alone, for generated files that may not use `std`.

use super::math::product_rest;

/// Square root, correctly rounded; 0 for arguments that are negative or below 1e-300.
pub fn sqrt(x: f64) -> f64 {
    if !(x > 1e-300) {
        return 0.0;
    }
    if x == f64::INFINITY {
        return x;
    }
    // Halving the exponent gives the inverse root within 4 %; each Newton step doubles the digits.
    let mut inverse = f64::from_bits(0x5fe6_eb50_c7b5_37a9 - (x.to_bits() >> 1));
    let half = 0.5 * x;
    for _ in 0..4 {
        inverse *= 1.5 - half * inverse * inverse;
    }
    let root = x * inverse;
    // What is missing, with squares taken exactly.
    let rest = |root: f64| (x - root * root) - product_rest(root, root);
    let root = root + 0.5 * inverse * rest(root);
    // Just below powers of four the sum is half way between two numbers: the lower one is nearer.
    let below = f64::from_bits(root.to_bits() - 1);
    if rest(root) <= -root * (root - below) { below } else { root }
}

#[cfg(test)]
mod tests {
    use super::*;
    use robotc_core::Seed;

    #[test]
    fn gives_the_bits_of_the_platform() {
        let mut rng = Seed::new(23).rng();
        for _ in 0..200_000 {
            let x = rng.range(0.5, 2.0) * 10f64.powf(rng.range(-290.0, 290.0));
            assert_eq!(sqrt(x).to_bits(), x.sqrt().to_bits(), "{x:?}");
        }
        for k in 1..2000u32 {
            let x = f64::from(k * k);
            assert_eq!(sqrt(x), f64::from(k));
            let (above, below) = (f64::from_bits(x.to_bits() + 1), f64::from_bits(x.to_bits() - 1));
            assert_eq!([sqrt(above), sqrt(below)], [above.sqrt(), below.sqrt()]);
        }
        assert_eq!([sqrt(0.0), sqrt(-1.0), sqrt(f64::NAN)], [0.0; 3]);
    }
}
