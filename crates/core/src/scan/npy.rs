//! NPY, the arrays of numpy (NEP 1): versions 1 to 3, numbers of any size and order.

use super::{Number, ScanError};

const MAGIC: &[u8] = b"\x93NUMPY";

pub(super) fn is_npy(bytes: &[u8]) -> bool {
    bytes.starts_with(MAGIC)
}

/// An array of numbers.
pub(super) struct Array<'b> {
    pub(super) shape: Vec<usize>,
    number: Number,
    big_endian: bool,
    /// The first dimension runs fastest.
    columns_first: bool,
    data: &'b [u8],
}

impl Array<'_> {
    /// The number at an index, which is within the shape.
    pub(super) fn at(&self, index: &[usize]) -> f64 {
        let step = |sum: usize, (i, n): (&usize, &usize)| sum * n + i;
        let each = index.iter().zip(&self.shape);
        let flat = if self.columns_first { each.rev().fold(0, step) } else { each.fold(0, step) };
        self.number.read(&self.data[flat * self.number.size()..], self.big_endian)
    }
}

fn malformed<T>(what: impl Into<String>) -> Result<T, ScanError> {
    Err(ScanError::Malformed(what.into()))
}

pub(super) fn read(bytes: &[u8]) -> Result<Array<'_>, ScanError> {
    let header_and_data = match bytes.get(6) {
        Some(1) => bytes.get(8..10).map(|b| (usize::from(u16::from_le_bytes([b[0], b[1]])), 10)),
        Some(2 | 3) => bytes.get(8..12).map(|b| (u32::from_le_bytes([b[0], b[1], b[2], b[3]]) as usize, 12)),
        _ => None,
    };
    let header =
        header_and_data.and_then(|(length, at)| Some((bytes.get(at..)?.get(..length)?, at + length)));
    let Some((header, data)) = header else { return malformed("the header of the NPY file is cut off") };
    let header = String::from_utf8_lossy(header);
    let Some((number, big_endian)) = value(&header, "descr").and_then(number) else {
        return malformed("the NPY file holds something else than plain numbers");
    };
    let columns_first = value(&header, "fortran_order").is_some_and(|word| word.starts_with("True"));
    let Some(shape) = value(&header, "shape").and_then(shape) else {
        return malformed("the NPY file does not say its shape");
    };
    let data = &bytes[data..];
    let size = shape.iter().try_fold(number.size(), |product, n| product.checked_mul(*n));
    if size.is_none_or(|size| size > data.len()) {
        return malformed(format!("says an array of shape {shape:?}, but ends early"));
    }
    Ok(Array { shape, number, big_endian, columns_first, data })
}

/// What stands behind a key of the header, a Python dictionary.
fn value<'h>(header: &'h str, key: &str) -> Option<&'h str> {
    let at = header.find(&format!("'{key}'"))?;
    Some(header[at + key.len() + 2..].trim_start().strip_prefix(':')?.trim_start())
}

fn number(word: &str) -> Option<(Number, bool)> {
    let word = word.strip_prefix('\'')?.split('\'').next()?;
    let (order, kind) = match word.chars().next()? {
        order @ ('<' | '>' | '|' | '=') => (order, &word[1..]),
        _ => ('=', word),
    };
    let number = match kind {
        "u1" => Number::Unsigned(1),
        "u2" => Number::Unsigned(2),
        "u4" => Number::Unsigned(4),
        "u8" => Number::Unsigned(8),
        "i1" => Number::Signed(1),
        "i2" => Number::Signed(2),
        "i4" => Number::Signed(4),
        "i8" => Number::Signed(8),
        "f4" => Number::Float(4),
        "f8" => Number::Float(8),
        _ => return None,
    };
    Some((number, order == '>'))
}

fn shape(text: &str) -> Option<Vec<usize>> {
    let (inside, _) = text.strip_prefix('(')?.split_once(')')?;
    let sizes = inside.split(',').map(str::trim).filter(|word| !word.is_empty());
    let shape: Vec<usize> =
        sizes.map(|word| word.trim_end_matches('L').parse().ok()).collect::<Option<_>>()?;
    (shape.len() <= 8).then_some(shape)
}
