//! Arrays in an archive, as `numpy.savez` writes and `numpy.load` reads it: a ZIP file of NPY files, nothing compressed.

use std::ops::Range;

use robotc_core::npy::{self, NpyError};

/// An array of an archive.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Array {
    /// Numbers in rows: the last index runs fastest.
    Numbers { shape: Vec<usize>, values: Vec<f64> },
    /// Texts, in the order in which they stand in the file.
    Texts(Vec<String>),
}

const LOCAL: u32 = 0x0403_4b50;
const CENTRAL: u32 = 0x0201_4b50;
const END: u32 = 0x0605_4b50;
/// First of January 1980, the first day that ZIP knows: archives of equal arrays are equal.
const NO_DATE: u16 = 0x0021;

/// An archive of named arrays.
pub(super) fn write(arrays: &[(&str, Array)]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut directory = Vec::new();
    for (name, array) in arrays {
        let (name, content) = (format!("{name}.npy"), to_npy(array));
        let offset = bytes.len() as u32;
        let mut about = Vec::new();
        // Version 2.0, no flags, stored.
        for word in [20, 0, 0, 0, NO_DATE] {
            about.extend(word.to_le_bytes());
        }
        for word in [crc32(&content), content.len() as u32, content.len() as u32] {
            about.extend(word.to_le_bytes());
        }
        about.extend((name.len() as u16).to_le_bytes());
        about.extend(0_u16.to_le_bytes());
        bytes.extend(LOCAL.to_le_bytes());
        bytes.extend(&about);
        bytes.extend(name.as_bytes());
        bytes.extend(content);
        directory.extend(CENTRAL.to_le_bytes());
        directory.extend(20_u16.to_le_bytes());
        directory.extend(&about);
        // No comment, first disk, no attributes.
        directory.extend([0; 10]);
        directory.extend(offset.to_le_bytes());
        directory.extend(name.as_bytes());
    }
    let (start, count) = (bytes.len() as u32, arrays.len() as u16);
    bytes.extend(&directory);
    bytes.extend(END.to_le_bytes());
    bytes.extend([0; 4]);
    bytes.extend(count.to_le_bytes());
    bytes.extend(count.to_le_bytes());
    bytes.extend((directory.len() as u32).to_le_bytes());
    bytes.extend(start.to_le_bytes());
    bytes.extend([0; 2]);
    bytes
}

/// The arrays of an archive with their names; the error says what is wrong with it.
pub(super) fn read(bytes: &[u8]) -> Result<Vec<(String, Array)>, String> {
    let short = || "it ends early".to_owned();
    let is_end = |at: &usize| u32_at(bytes, *at) == Some(END);
    let end = (0..bytes.len().saturating_sub(21)).rev().find(is_end).ok_or("it is not a ZIP file")?;
    let count = u16_at(bytes, end + 10).ok_or_else(short)?;
    let mut at = u32_at(bytes, end + 16).ok_or_else(short)? as usize;
    let mut arrays = Vec::new();
    // Contents lie beside each other: a small file that names the same bytes again and again is refused, not unfolded.
    let mut left = bytes.len();
    for _ in 0..count {
        if u32_at(bytes, at) != Some(CENTRAL) {
            return Err("its directory is damaged".into());
        }
        let word = |offset: usize| u16_at(bytes, at + offset).map(usize::from).ok_or_else(short);
        let double = |offset: usize| u32_at(bytes, at + offset).map(|x| x as usize).ok_or_else(short);
        let (name_length, behind) = (word(28)?, word(30)? + word(32)?);
        let name = slice(bytes, at + 46, name_length).ok_or_else(short)?;
        let name = String::from_utf8_lossy(name).trim_end_matches(".npy").to_owned();
        if word(10)? != 0 {
            return Err(format!("{name} is compressed; write it with numpy.savez"));
        }
        let (local, length) = (double(42)?, double(24)?);
        let skipped = |offset: usize| {
            local.checked_add(offset).and_then(|at| u16_at(bytes, at)).map(usize::from).ok_or_else(short)
        };
        let start = local + 30 + skipped(26)? + skipped(28)?;
        let content = slice(bytes, start, length).ok_or_else(short)?;
        left = left.checked_sub(length).ok_or("its files overlap")?;
        arrays.push((name.clone(), of_npy(content).map_err(|wrong| format!("{name} {wrong}"))?));
        at += 46 + name_length + behind;
    }
    Ok(arrays)
}

fn slice(bytes: &[u8], start: usize, length: usize) -> Option<&[u8]> {
    bytes.get(Range { start, end: start.checked_add(length)? })
}

fn u16_at(bytes: &[u8], at: usize) -> Option<u16> {
    Some(u16::from_le_bytes(slice(bytes, at, 2)?.try_into().ok()?))
}

fn u32_at(bytes: &[u8], at: usize) -> Option<u32> {
    Some(u32::from_le_bytes(slice(bytes, at, 4)?.try_into().ok()?))
}

/// An array as an NPY file.
fn to_npy(array: &Array) -> Vec<u8> {
    let (kind, shape, data): (String, Vec<usize>, Vec<u8>) = match array {
        Array::Numbers { shape, values } => {
            ("f8".into(), shape.clone(), values.iter().flat_map(|x| x.to_le_bytes()).collect())
        }
        Array::Texts(texts) => {
            let longest = texts.iter().map(|text| text.chars().count()).max().unwrap_or(0).max(1);
            let padded = |text: &String| {
                let characters = text.chars().map(u32::from).chain(std::iter::repeat(0));
                characters.take(longest).flat_map(u32::to_le_bytes).collect::<Vec<u8>>()
            };
            (format!("U{longest}"), vec![texts.len()], texts.iter().flat_map(padded).collect())
        }
    };
    let sides: String = shape.iter().map(|side| format!("{side}, ")).collect();
    let head = format!("{{'descr': '<{kind}', 'fortran_order': False, 'shape': ({}), }}", sides.trim_end());
    // Data begins at a multiple of 64.
    let length = (10 + head.len() + 1).next_multiple_of(64) - 10;
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((length as u16).to_le_bytes());
    bytes.extend(format!("{head:<width$}\n", width = length - 1).into_bytes());
    bytes.extend(data);
    bytes
}

/// The array of an NPY file.
fn of_npy(bytes: &[u8]) -> Result<Array, NpyError> {
    Ok(match npy::read(bytes)? {
        npy::Array::Numbers(numbers) => {
            Array::Numbers { shape: numbers.shape().to_vec(), values: numbers.in_rows() }
        }
        npy::Array::Texts(texts) => Array::Texts(texts),
    })
}

/// The check sum of ZIP, bit by bit: archives of grasps are small.
fn crc32(bytes: &[u8]) -> u32 {
    let mut sum = u32::MAX;
    for &byte in bytes {
        sum ^= u32::from(byte);
        for _ in 0..8 {
            sum = if sum & 1 == 1 { sum >> 1 ^ 0xedb8_8320 } else { sum >> 1 };
        }
    }
    !sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_check_sum_is_that_of_zip() {
        assert_eq!(crc32(b"123456789"), 0xcbf4_3926);
    }

    #[test]
    fn archives_come_back_whole_and_damaged_ones_are_refused() {
        let arrays = [
            ("numbers", Array::Numbers { shape: vec![2, 3], values: vec![0.1, -2.0, 3.5, 1e-300, 0.0, 7.0] }),
            ("texts", Array::Texts(vec!["a".into(), "größer".into(), String::new()])),
            ("none", Array::Numbers { shape: vec![0, 4, 4], values: vec![] }),
        ];
        let bytes = write(&arrays);
        let back = read(&bytes).unwrap();
        assert!(
            back.iter().map(|(name, array)| (name.as_str(), array)).eq(arrays.iter().map(|(n, a)| (*n, a)))
        );
        for length in 0..bytes.len() {
            assert!(read(&bytes[..length]).is_err());
        }
        for at in 0..bytes.len() {
            let mut bad = bytes.clone();
            bad[at] ^= 0x40;
            // Any answer will do, but there is one.
            let _ = read(&bad);
        }
    }

    #[test]
    fn the_same_bytes_are_not_unfolded_twice() {
        let mut bytes = write(&[("a", Array::Numbers { shape: vec![1000], values: vec![0.5; 1000] })]);
        let end = bytes.len() - 22;
        let start = u32_at(&bytes, end + 16).unwrap() as usize;
        let entry = bytes[start..end].to_vec();
        let length = entry.len();
        bytes.splice(end..end, entry);
        assert_eq!(read(&bytes).unwrap().len(), 1);
        bytes[end + length + 10] = 2;
        assert_eq!(read(&bytes).unwrap_err(), "its files overlap");
    }
}
