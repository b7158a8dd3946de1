//! Canonical hashing: the same value gives the same 32 bytes on every platform.
//!
//! Every value is written to BLAKE3 with a type byte and, where its size varies, its length, so that no two different
//! sequences of values share an encoding. Numbers are hashed by their bits as they were parsed: infinities and NaN are
//! refused and -0 counts as 0. Never feed a number that went through trigonometry or a matrix product: such numbers
//! are functions of what was already hashed, and they may differ in the last bit between compilers.

use std::fmt;
use std::str::FromStr;

use robotc_core::model::{JointMotion, Origin};
use thiserror::Error;

/// A text is not the hexadecimal form of a 32-byte hash.
#[derive(Debug, Clone, Copy, Error, PartialEq, Eq)]
#[error("not 64 hexadecimal digits")]
pub struct NotAHash;

macro_rules! hash_type {
    ($(#[$doc:meta])* $name:ident) => {
        $(#[$doc])*
        #[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub struct $name([u8; 32]);

        impl $name {
            /// The hash with these bytes.
            pub fn from_bytes(bytes: [u8; 32]) -> Self {
                Self(bytes)
            }

            /// The bytes.
            pub fn as_bytes(&self) -> &[u8; 32] {
                &self.0
            }

            /// The first twelve hexadecimal digits: enough for people.
            pub fn short(&self) -> String {
                self.to_string()[..12].to_owned()
            }
        }

        impl fmt::Display for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                self.0.iter().try_for_each(|byte| write!(f, "{byte:02x}"))
            }
        }

        impl fmt::Debug for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str(&self.short())
            }
        }

        impl FromStr for $name {
            type Err = NotAHash;
            fn from_str(text: &str) -> Result<Self, NotAHash> {
                parse_hex(text).map(Self).ok_or(NotAHash)
            }
        }
    };
}

hash_type!(
    /// Names a computation with the contents of its inputs: equal keys mean equal artefacts.
    Key);
hash_type!(
    /// Names a computation by how its inputs are made: known before anything is built.
    RecipeId);
hash_type!(
    /// Names bytes: plain BLAKE3, as `b3sum` prints it.
    ContentHash);

impl ContentHash {
    /// The name of these bytes.
    pub fn of(bytes: &[u8]) -> Self {
        Self(*blake3::hash(bytes).as_bytes())
    }
}

fn parse_hex(text: &str) -> Option<[u8; 32]> {
    let digits = text.as_bytes();
    if digits.len() != 64 || !digits.iter().all(u8::is_ascii_hexdigit) {
        return None;
    }
    let mut bytes = [0; 32];
    for (byte, pair) in bytes.iter_mut().zip(text.as_bytes().chunks_exact(2)) {
        *byte = u8::from_str_radix(std::str::from_utf8(pair).ok()?, 16).ok()?;
    }
    Some(bytes)
}

/// A number that a key cannot hold: NaN or infinite.
#[derive(Debug, Clone, Copy, Error, PartialEq, Eq)]
#[error("not a finite number")]
pub struct NotFinite;

/// Collects values into a hash. The first NaN or infinity makes [`finish`](Self::finish) fail.
pub struct KeyHasher {
    hasher: blake3::Hasher,
    finite: bool,
}

impl KeyHasher {
    /// A hash of its own for each `domain`: equal values in two domains give different hashes.
    pub fn new(domain: &'static str) -> Self {
        Self { hasher: blake3::Hasher::new_derive_key(domain), finite: true }
    }

    /// Adds a value.
    pub fn add<T: Canonical + ?Sized>(&mut self, value: &T) -> &mut Self {
        value.write(self);
        self
    }

    /// Adds bytes with their length.
    pub fn bytes(&mut self, bytes: &[u8]) -> &mut Self {
        self.tagged(b's', &(bytes.len() as u64).to_le_bytes());
        self.hasher.update(bytes);
        self
    }

    /// Adds many numbers at once, such as the vertices of a mesh.
    pub fn numbers(&mut self, numbers: impl Iterator<Item = f64>) -> &mut Self {
        let mut packed = Vec::new();
        for number in numbers {
            self.finite &= number.is_finite();
            packed.extend_from_slice(&canonical_bits(number).to_le_bytes());
        }
        self.bytes(&packed)
    }

    /// Starts a sequence of `length` values.
    pub fn sequence(&mut self, length: usize) -> &mut Self {
        self.tagged(b'[', &(length as u64).to_le_bytes());
        self
    }

    /// The hash of everything added.
    pub fn finish(&self) -> Result<[u8; 32], NotFinite> {
        if self.finite { Ok(*self.hasher.finalize().as_bytes()) } else { Err(NotFinite) }
    }

    fn tagged(&mut self, tag: u8, bytes: &[u8; 8]) {
        let mut word = [tag; 9];
        word[1..].copy_from_slice(bytes);
        self.hasher.update(&word);
    }
}

/// The bits of a number, with one zero.
fn canonical_bits(number: f64) -> u64 {
    if number == 0.0 { 0 } else { number.to_bits() }
}

/// A value with one canonical encoding.
pub trait Canonical {
    /// Writes the value.
    fn write(&self, out: &mut KeyHasher);
}

impl Canonical for f64 {
    fn write(&self, out: &mut KeyHasher) {
        out.finite &= self.is_finite();
        out.tagged(b'f', &canonical_bits(*self).to_le_bytes());
    }
}

impl Canonical for u64 {
    fn write(&self, out: &mut KeyHasher) {
        out.tagged(b'u', &self.to_le_bytes());
    }
}

impl Canonical for u32 {
    fn write(&self, out: &mut KeyHasher) {
        u64::from(*self).write(out);
    }
}

impl Canonical for usize {
    fn write(&self, out: &mut KeyHasher) {
        (*self as u64).write(out);
    }
}

impl Canonical for bool {
    fn write(&self, out: &mut KeyHasher) {
        out.tagged(b'b', &u64::from(*self).to_le_bytes());
    }
}

impl Canonical for str {
    fn write(&self, out: &mut KeyHasher) {
        out.bytes(self.as_bytes());
    }
}

impl Canonical for String {
    fn write(&self, out: &mut KeyHasher) {
        self.as_str().write(out);
    }
}

impl<T: Canonical + ?Sized> Canonical for &T {
    fn write(&self, out: &mut KeyHasher) {
        (**self).write(out);
    }
}

impl<T: Canonical> Canonical for Option<T> {
    fn write(&self, out: &mut KeyHasher) {
        self.as_slice().write(out);
    }
}

impl<T: Canonical> Canonical for [T] {
    fn write(&self, out: &mut KeyHasher) {
        out.sequence(self.len());
        self.iter().for_each(|item| item.write(out));
    }
}

impl<T: Canonical> Canonical for Vec<T> {
    fn write(&self, out: &mut KeyHasher) {
        self.as_slice().write(out);
    }
}

impl<T: Canonical, const N: usize> Canonical for [T; N] {
    fn write(&self, out: &mut KeyHasher) {
        self.as_slice().write(out);
    }
}

macro_rules! canonical_tuple {
    ($($name:ident $field:tt),+) => {
        impl<$($name: Canonical),+> Canonical for ($($name,)+) {
            fn write(&self, out: &mut KeyHasher) {
                $(self.$field.write(out);)+
            }
        }
    };
}

canonical_tuple!(A 0, B 1);
canonical_tuple!(A 0, B 1, C 2);
canonical_tuple!(A 0, B 1, C 2, D 3);
canonical_tuple!(A 0, B 1, C 2, D 3, E 4);
canonical_tuple!(A 0, B 1, C 2, D 3, E 4, F 5);

impl Canonical for Origin {
    fn write(&self, out: &mut KeyHasher) {
        (self.xyz, self.rpy).write(out);
    }
}

impl Canonical for JointMotion {
    fn write(&self, out: &mut KeyHasher) {
        let name = match self {
            JointMotion::Fixed => "fixed",
            JointMotion::Revolute => "revolute",
            JointMotion::Prismatic => "prismatic",
        };
        name.write(out);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hash<T: Canonical>(value: T) -> Result<[u8; 32], NotFinite> {
        KeyHasher::new("robotc test").add(&value).finish()
    }

    #[test]
    fn equal_values_hash_equally_and_lengths_separate_them() {
        assert_eq!(hash(-0.0), hash(0.0));
        assert_ne!(hash(0.0), hash(f64::MIN_POSITIVE));
        assert_ne!(hash(("ab", "c")), hash(("a", "bc")));
        assert_ne!(hash(vec![vec![1_u64], vec![]]), hash(vec![vec![], vec![1_u64]]));
        assert_ne!(hash(1_u64), hash(f64::from_bits(1)));
        assert_ne!(hash(Some(0.0)), hash(None::<f64>));
        assert_ne!(
            KeyHasher::new("robotc test").add(&1_u64).finish(),
            KeyHasher::new("robotc other").add(&1_u64).finish()
        );
    }

    #[test]
    fn numbers_that_are_not_finite_are_refused() {
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            assert_eq!(hash(vec![1.0, bad, 2.0]), Err(NotFinite));
        }
    }

    #[test]
    fn the_encoding_is_pinned() {
        // A change here renames every artefact of every user: it must be meant.
        let value = (("joint", 3_u64), [0.1, -0.0, 1e-300], true, Some("x"));
        let digest = Key::from_bytes(hash(value).expect("finite"));
        assert_eq!(digest.to_string(), PINNED);
    }

    const PINNED: &str = "da8958ce357e0132185bc225fb7888cdbc060c4a7cb0f755c589581937f4a475";

    #[test]
    fn hexadecimal_form_round_trips() {
        let hash = ContentHash::of(b"abc");
        assert_eq!(hash.to_string().parse(), Ok(hash));
        // The published BLAKE3 hash of "abc".
        assert_eq!(hash.short(), "6437b3ac3846");
        for bad in ["", "64", &"g".repeat(64), &"é".repeat(32)] {
            assert_eq!(bad.parse::<Key>(), Err(NotAHash), "{bad}");
        }
    }
}
