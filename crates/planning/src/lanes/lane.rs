//! Numbers in lanes: one 32-bit float for each of several configurations.
//!
//! Sums and products are never fused and every operation is rounded as IEEE 754 asks, so that a lane holds the same bits
//! whatever the number of lanes.

use std::ops::{Add, Mul, Sub};

use pulp::Simd;

/// One value for each lane.
#[derive(Clone, Copy)]
pub(super) struct Lanes<S: Simd> {
    simd: S,
    pub(super) raw: S::f32s,
}

/// A yes or no for each lane.
#[derive(Clone, Copy)]
pub(super) struct Mask<S: Simd> {
    simd: S,
    raw: S::m32s,
}

impl<S: Simd> Lanes<S> {
    #[inline(always)]
    pub(super) fn new(simd: S, raw: S::f32s) -> Self {
        Self { simd, raw }
    }

    #[inline(always)]
    pub(super) fn splat(simd: S, x: f32) -> Self {
        Self { simd, raw: simd.splat_f32s(x) }
    }

    #[inline(always)]
    pub(super) fn max(self, other: Self) -> Self {
        Self::new(self.simd, self.simd.max_f32s(self.raw, other.raw))
    }

    #[inline(always)]
    pub(super) fn min(self, other: Self) -> Self {
        Self::new(self.simd, self.simd.min_f32s(self.raw, other.raw))
    }

    #[inline(always)]
    pub(super) fn abs(self) -> Self {
        Self::new(self.simd, self.simd.abs_f32s(self.raw))
    }

    #[inline(always)]
    pub(super) fn sqrt(self) -> Self {
        Self::new(self.simd, self.simd.sqrt_f32s(self.raw))
    }

    #[inline(always)]
    pub(super) fn less_equal(self, other: Self) -> Mask<S> {
        Mask { simd: self.simd, raw: self.simd.less_than_or_equal_f32s(self.raw, other.raw) }
    }

    #[inline(always)]
    pub(super) fn less_equal_number(self, other: f32) -> Mask<S> {
        self.less_equal(Self::splat(self.simd, other))
    }

    #[inline(always)]
    pub(super) fn less(self, other: Self) -> Mask<S> {
        Mask { simd: self.simd, raw: self.simd.less_than_f32s(self.raw, other.raw) }
    }

    /// Sine and cosine, good to 2e-7 for arguments up to a hundred turns.
    ///
    /// The argument is brought to +-pi/4 by subtracting a multiple of pi/2 in three pieces (Cody and Waite, "Software manual
    /// for the elementary functions", 1980); there the series are minimax polynomials.
    #[inline(always)]
    pub(super) fn sin_cos(self) -> (Self, Self) {
        /// Adding it leaves the nearest integer in the low bits.
        const TO_INTEGER: f32 = 12_582_912.0;
        let simd = self.simd;
        let splat = |x: f32| Self::splat(simd, x);
        let shifted = self * splat(std::f32::consts::FRAC_2_PI) + splat(TO_INTEGER);
        let bits = simd.transmute_u32s_f32s(shifted.raw);
        let quarters = shifted - splat(TO_INTEGER);
        let r = self - quarters * splat(1.570_312_5);
        let r = r - quarters * splat(4.837_513e-4);
        let r = r - quarters * splat(7.549_79e-8);
        let r2 = r * r;
        let odd = splat(-1.666_665_5e-1) + r2 * (splat(8.332_161e-3) - r2 * splat(1.951_529_6e-4));
        let sine = r + r * r2 * odd;
        let even = splat(4.166_664_6e-2) + r2 * (splat(-1.388_731_6e-3) + r2 * splat(2.443_315_7e-5));
        let cosine = splat(1.0) - r2 * splat(0.5) + r2 * r2 * even;
        // An odd number of quarter turns swaps the two; two of them change a sign.
        let one = simd.splat_u32s(1);
        let swap = simd.equal_u32s(simd.and_u32s(bits, one), one);
        let sine_sign = simd.and_u32s(simd.wrapping_dyn_shl_u32s(bits, simd.splat_u32s(30)), top(simd));
        let next = simd.add_u32s(bits, one);
        let cosine_sign = simd.and_u32s(simd.wrapping_dyn_shl_u32s(next, simd.splat_u32s(30)), top(simd));
        let signed = |value: S::f32s, sign: S::u32s| {
            let bits = simd.xor_u32s(simd.transmute_u32s_f32s(value), sign);
            Self::new(simd, simd.transmute_f32s_u32s(bits))
        };
        (
            signed(simd.select_f32s(swap, cosine.raw, sine.raw), sine_sign),
            signed(simd.select_f32s(swap, sine.raw, cosine.raw), cosine_sign),
        )
    }
}

/// The sign bit.
#[inline(always)]
fn top<S: Simd>(simd: S) -> S::u32s {
    simd.splat_u32s(1 << 31)
}

impl<S: Simd> Mask<S> {
    /// No in every lane.
    #[inline(always)]
    pub(super) fn none(simd: S) -> Self {
        let zero = simd.splat_f32s(0.0);
        Self { simd, raw: simd.less_than_f32s(zero, zero) }
    }

    /// Whether some lane says yes.
    #[inline(always)]
    pub(super) fn any(self) -> bool {
        if const { size_of::<S::m32s>() == size_of::<S::f32s>() } {
            self.simd.reduce_max_f32s(self.as_numbers()) > 0.0
        } else {
            // A bit for each lane.
            self.simd.first_true_m32s(self.raw) < S::F32_LANES
        }
    }

    /// The first lane that says yes; the number of lanes when none does.
    #[inline(always)]
    pub(super) fn first(self) -> usize {
        let mut numbers = [0.0; super::kernel::MOST_LANES];
        let lanes = &mut numbers[..S::F32_LANES];
        self.simd.partial_store_f32s(lanes, self.as_numbers());
        lanes.iter().position(|&x| x > 0.0).unwrap_or(S::F32_LANES)
    }

    #[inline(always)]
    pub(super) fn or(self, other: Self) -> Self {
        Self { simd: self.simd, raw: self.simd.or_m32s(self.raw, other.raw) }
    }

    #[inline(always)]
    pub(super) fn and(self, other: Self) -> Self {
        Self { simd: self.simd, raw: self.simd.and_m32s(self.raw, other.raw) }
    }

    /// Yes here and no there.
    #[inline(always)]
    pub(super) fn and_not(self, other: Self) -> Self {
        Self { simd: self.simd, raw: self.simd.and_m32s(self.raw, self.simd.not_m32s(other.raw)) }
    }

    /// One for yes, zero for no.
    #[inline(always)]
    pub(super) fn as_numbers(self) -> S::f32s {
        let (yes, no) = (self.simd.splat_f32s(1.0), self.simd.splat_f32s(0.0));
        self.simd.select_f32s(self.raw, yes, no)
    }
}

impl<S: Simd> Add for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self::new(self.simd, self.simd.add_f32s(self.raw, other.raw))
    }
}

impl<S: Simd> Sub for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self::new(self.simd, self.simd.sub_f32s(self.raw, other.raw))
    }
}

impl<S: Simd> Mul for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self::new(self.simd, self.simd.mul_f32s(self.raw, other.raw))
    }
}

impl<S: Simd> Mul<f32> for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: f32) -> Self {
        self * Self::splat(self.simd, other)
    }
}

/// A vector in lanes.
pub(super) type Vector<S> = [Lanes<S>; 3];

/// Sum of products of the coordinates.
#[inline(always)]
pub(super) fn dot<S: Simd>(a: &Vector<S>, b: &Vector<S>) -> Lanes<S> {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Vector product.
#[inline(always)]
pub(super) fn cross<S: Simd>(a: &Vector<S>, b: &Vector<S>) -> Vector<S> {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Coordinate by coordinate.
#[inline(always)]
pub(super) fn minus<S: Simd>(a: &Vector<S>, b: &Vector<S>) -> Vector<S> {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// Coordinate by coordinate.
#[inline(always)]
pub(super) fn plus<S: Simd>(a: &Vector<S>, b: &Vector<S>) -> Vector<S> {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// Every coordinate times a number of each lane.
#[inline(always)]
pub(super) fn times<S: Simd>(a: &Vector<S>, by: Lanes<S>) -> Vector<S> {
    [a[0] * by, a[1] * by, a[2] * by]
}

/// Every coordinate times the same number.
#[inline(always)]
pub(super) fn scaled<S: Simd>(a: &Vector<S>, by: f32) -> Vector<S> {
    [a[0] * by, a[1] * by, a[2] * by]
}
