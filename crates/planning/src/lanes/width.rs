//! How many lanes there are.

use pulp::{Scalar128b, Simd, WithSimd};

/// Lanes of the vector instructions in use. Results are the same with each of them.
#[derive(Debug, Clone, Copy)]
pub struct Width(Kind);

#[derive(Debug, Clone, Copy)]
enum Kind {
    /// Four lanes, in whatever every processor of the kind has.
    Four,
    #[cfg(target_arch = "x86_64")]
    Eight(pulp::x86::V3),
    #[cfg(target_arch = "x86_64")]
    Sixteen(pulp::x86::V4),
}

impl Width {
    /// The widest of this processor.
    pub fn widest() -> Self {
        Self::all().pop().expect("four lanes are always there")
    }

    /// All of this processor, narrowest first.
    pub fn all() -> Vec<Self> {
        #[allow(unused_mut, reason = "other processors have nothing to add")]
        let mut all = vec![Self(Kind::Four)];
        #[cfg(target_arch = "x86_64")]
        {
            all.extend(pulp::x86::V3::try_new().map(|simd| Self(Kind::Eight(simd))));
            all.extend(pulp::x86::V4::try_new().map(|simd| Self(Kind::Sixteen(simd))));
        }
        all
    }

    /// Number of lanes.
    pub fn lanes(self) -> usize {
        match self.0 {
            Kind::Four => 4,
            #[cfg(target_arch = "x86_64")]
            Kind::Eight(_) => 8,
            #[cfg(target_arch = "x86_64")]
            Kind::Sixteen(_) => 16,
        }
    }

    /// These lanes, but no more than eight.
    pub(super) fn narrow(self) -> Self {
        match self.0 {
            #[cfg(target_arch = "x86_64")]
            Kind::Sixteen(simd) => Self(Kind::Eight(*simd)),
            kind => Self(kind),
        }
    }

    /// Runs code in these lanes.
    pub(super) fn dispatch<W: WithSimd>(self, work: W) -> W::Output {
        match self.0 {
            Kind::Four => Scalar128b.vectorize(work),
            #[cfg(target_arch = "x86_64")]
            Kind::Eight(simd) => Simd::vectorize(simd, work),
            #[cfg(target_arch = "x86_64")]
            Kind::Sixteen(simd) => Simd::vectorize(simd, work),
        }
    }
}
