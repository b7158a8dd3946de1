//! NPY, the arrays of numpy (NEP 1): versions 1 to 3.

use thiserror::Error;

const MAGIC: &[u8] = b"\x93NUMPY";

/// Whether a file says that it is NPY.
pub fn is_npy(bytes: &[u8]) -> bool {
    bytes.starts_with(MAGIC)
}

/// Why a file gives no array. Messages go on from the name of the file.
#[derive(Debug, Clone, Error, PartialEq, Eq)]
pub enum NpyError {
    /// It does not begin as NPY does.
    #[error("is not an NPY file")]
    NotNpy,
    /// The header, or what it says, is longer than the file.
    #[error("ends early")]
    EndsEarly,
    /// The header says neither numbers nor texts, or nothing.
    #[error("holds something else than plain numbers and texts")]
    UnknownType,
    /// The header has no shape that can be read, or one of more than eight dimensions.
    #[error("does not say its shape")]
    NoShape,
    /// More data than the file has.
    #[error("says an array of shape {0:?}, but ends early")]
    DataEndsEarly(Vec<usize>),
}

/// An array whose data is as long as its shape says.
#[derive(Debug)]
pub enum Array<'b> {
    /// Numbers.
    Numbers(Numbers<'b>),
    /// Texts, in the order in which they stand in the file.
    Texts(Vec<String>),
}

/// An array of numbers.
#[derive(Debug)]
pub struct Numbers<'b> {
    number: Number,
    big_endian: bool,
    /// The first dimension runs fastest.
    columns_first: bool,
    shape: Vec<usize>,
    data: &'b [u8],
}

impl Numbers<'_> {
    /// Sizes of the dimensions, eight at most; none for a number alone.
    pub fn shape(&self) -> &[usize] {
        &self.shape
    }

    /// The number at an index, which is within the shape.
    fn at(&self, index: &[usize]) -> f64 {
        let step = |sum: usize, (i, n): (&usize, &usize)| sum * n + i;
        let each = index.iter().zip(&self.shape);
        let flat = if self.columns_first { each.rev().fold(0, step) } else { each.fold(0, step) };
        self.number.read(&self.data[flat * self.number.size()..], self.big_endian)
    }

    /// All of them; the last index runs fastest.
    pub fn in_rows(&self) -> Vec<f64> {
        let mut index = vec![0; self.shape.len()];
        let one = |mut i: usize| {
            for (k, &n) in self.shape.iter().enumerate().rev() {
                (index[k], i) = (i % n, i / n);
            }
            self.at(&index)
        };
        (0..self.shape.iter().product()).map(one).collect()
    }
}

/// Reads an array.
///
/// Takes no more memory than a few times the size of the file.
///
/// # Errors
///
/// When the file is no array of numbers of 1 to 8 bytes or of texts, or ends early.
pub fn read(bytes: &[u8]) -> Result<Array<'_>, NpyError> {
    if !is_npy(bytes) {
        return Err(NpyError::NotNpy);
    }
    let (length, start) = match bytes.get(6) {
        Some(1) => bytes.get(8..10).map(|b| (usize::from(u16::from_le_bytes([b[0], b[1]])), 10)),
        Some(2 | 3) => bytes.get(8..12).map(|b| (u32::from_le_bytes([b[0], b[1], b[2], b[3]]) as usize, 12)),
        Some(_) => return Err(NpyError::NotNpy),
        None => None,
    }
    .ok_or(NpyError::EndsEarly)?;
    let header = bytes[start..].get(..length).ok_or(NpyError::EndsEarly)?;
    let data = &bytes[start + length..];
    let header = String::from_utf8_lossy(header);
    let (big_endian, kind) = value(&header, "descr").and_then(kind).ok_or(NpyError::UnknownType)?;
    let columns_first = value(&header, "fortran_order").is_some_and(|word| word.starts_with("True"));
    let shape = value(&header, "shape").and_then(shape).ok_or(NpyError::NoShape)?;
    let size = shape.iter().try_fold(kind.size(), |product, n| product.checked_mul(*n));
    let Some(data) = size.and_then(|size| data.get(..size)) else {
        return Err(NpyError::DataEndsEarly(shape));
    };
    Ok(match kind {
        Kind::Number(number) => Array::Numbers(Numbers { number, big_endian, columns_first, shape, data }),
        Kind::Text(_) => Array::Texts(data.chunks_exact(kind.size()).map(|b| text(b, big_endian)).collect()),
    })
}

/// A type of values.
enum Kind {
    Number(Number),
    /// A text of so many characters at most, one at least.
    Text(usize),
}

impl Kind {
    /// Bytes of one.
    fn size(&self) -> usize {
        match self {
            Self::Number(number) => number.size(),
            Self::Text(longest) => 4 * longest,
        }
    }
}

/// What stands behind a key of the header, a Python dictionary.
fn value<'h>(header: &'h str, key: &str) -> Option<&'h str> {
    let at = header.find(&format!("'{key}'"))?;
    Some(header[at + key.len() + 2..].trim_start().strip_prefix(':')?.trim_start())
}

/// Whether the first byte is the highest, and the type.
fn kind(word: &str) -> Option<(bool, Kind)> {
    let word = word.strip_prefix('\'')?.split('\'').next()?;
    let (order, kind) = match word.chars().next()? {
        order @ ('<' | '>' | '|' | '=') => (order, &word[1..]),
        _ => ('=', word),
    };
    let kind = match kind {
        "u1" => Kind::Number(Number::Unsigned(1)),
        "u2" => Kind::Number(Number::Unsigned(2)),
        "u4" => Kind::Number(Number::Unsigned(4)),
        "u8" => Kind::Number(Number::Unsigned(8)),
        "i1" => Kind::Number(Number::Signed(1)),
        "i2" => Kind::Number(Number::Signed(2)),
        "i4" => Kind::Number(Number::Signed(4)),
        "i8" => Kind::Number(Number::Signed(8)),
        "f4" => Kind::Number(Number::Float(4)),
        "f8" => Kind::Number(Number::Float(8)),
        _ => {
            let longest: usize = kind.strip_prefix('U')?.parse().ok()?;
            Kind::Text((1..=usize::MAX / 4).contains(&longest).then_some(longest)?)
        }
    };
    Some((order == '>', kind))
}

fn shape(text: &str) -> Option<Vec<usize>> {
    let (inside, _) = text.strip_prefix('(')?.split_once(')')?;
    let sizes = inside.split(',').map(str::trim).filter(|word| !word.is_empty());
    // Python 2 wrote long numbers with an L.
    let shape: Vec<usize> =
        sizes.map(|word| word.trim_end_matches('L').parse().ok()).collect::<Option<_>>()?;
    (shape.len() <= 8).then_some(shape)
}

/// A text of four bytes a character, padded by zeros.
fn text(bytes: &[u8], big_endian: bool) -> String {
    let code = |b: &[u8]| {
        let b: [u8; 4] = b.try_into().expect("chunks of 4");
        if big_endian { u32::from_be_bytes(b) } else { u32::from_le_bytes(b) }
    };
    let codes = bytes.chunks_exact(4).map(code).take_while(|&code| code != 0);
    codes.map(|code| char::from_u32(code).unwrap_or(char::REPLACEMENT_CHARACTER)).collect()
}

/// A type of numbers in binary files, with its size of 1, 2, 4 or 8 bytes; floating point of 4 or 8.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Number {
    Unsigned(usize),
    Signed(usize),
    Float(usize),
}

impl Number {
    /// Bytes of one.
    pub(crate) fn size(self) -> usize {
        match self {
            Self::Unsigned(size) | Self::Signed(size) | Self::Float(size) => size,
        }
    }

    /// The number at the start of `bytes`, of which there are enough.
    pub(crate) fn read(self, bytes: &[u8], big_endian: bool) -> f64 {
        let mut raw = [0; 8];
        let size = self.size();
        raw[..size].copy_from_slice(&bytes[..size]);
        if big_endian {
            raw[..size].reverse();
        }
        let bits = u64::from_le_bytes(raw);
        match self {
            Self::Unsigned(_) => bits as f64,
            Self::Signed(_) => {
                (bits.wrapping_shl(64 - 8 * size as u32) as i64 >> (64 - 8 * size as u32)) as f64
            }
            Self::Float(4) => f64::from(f32::from_bits(bits as u32)),
            Self::Float(_) => f64::from_bits(bits),
        }
    }
}
