//! PCD of the Point Cloud Library, version 0.6 and 0.7: text, binary, and binary compressed by LZF.

use super::{ScanError, bounded};
use crate::npy::Number;

pub(super) fn is_pcd(bytes: &[u8]) -> bool {
    let start = &bytes[..bytes.len().min(4096)];
    let text = String::from_utf8_lossy(start);
    let mut lines =
        text.lines().map(str::trim_start).filter(|line| !line.is_empty() && !line.starts_with('#'));
    lines.next().is_some_and(|line| line.starts_with("VERSION") || line.starts_with("FIELDS"))
        && text.lines().any(|line| line.starts_with("FIELDS"))
}

#[derive(Debug, Clone, Copy)]
struct Field {
    number: Number,
    /// Numbers of this field in each point.
    count: usize,
}

#[derive(Default)]
struct Header {
    names: Vec<String>,
    sizes: Vec<String>,
    kinds: Vec<String>,
    counts: Vec<String>,
    points: Option<usize>,
    width: Option<usize>,
    height: Option<usize>,
}

fn malformed<T>(what: impl Into<String>) -> Result<T, ScanError> {
    Err(ScanError::Malformed(what.into()))
}

pub(super) fn read(bytes: &[u8]) -> Result<Vec<[f64; 3]>, ScanError> {
    let mut header = Header::default();
    let mut rest = bytes;
    let form = loop {
        let Some(end) = rest.iter().position(|b| *b == b'\n') else {
            return malformed("the header of the PCD file has no `DATA`");
        };
        let line = String::from_utf8_lossy(&rest[..end]).into_owned();
        rest = &rest[end + 1..];
        let mut words = line.split_whitespace().map(str::to_owned);
        let Some(key) = words.next() else { continue };
        let mut number = |what: &str| match words.next().and_then(|w| w.parse::<usize>().ok()) {
            Some(n) => Ok(Some(n)),
            None => malformed(format!("`{what}` of the PCD file is no number")),
        };
        match key.as_str() {
            "FIELDS" => header.names = words.collect(),
            "SIZE" => header.sizes = words.collect(),
            "TYPE" => header.kinds = words.collect(),
            "COUNT" => header.counts = words.collect(),
            "POINTS" => header.points = number("POINTS")?,
            "WIDTH" => header.width = number("WIDTH")?,
            "HEIGHT" => header.height = number("HEIGHT")?,
            "DATA" => break words.next().unwrap_or_default(),
            _ => {}
        }
    };
    let fields = fields(&header)?;
    let places = [place(&header, "x")?, place(&header, "y")?, place(&header, "z")?];
    let by_size = || header.width?.checked_mul(header.height.unwrap_or(1));
    let Some(count) = header.points.or_else(by_size) else {
        return malformed("the PCD file does not say how many points it has");
    };
    bounded(count)?;
    match form.as_str() {
        "ascii" => read_text(&fields, places, count, rest),
        "binary" => read_binary(&fields, places, count, rest),
        "binary_compressed" => read_compressed(&fields, places, count, rest),
        other => malformed(format!("`{other}` is no form of PCD data")),
    }
}

fn fields(header: &Header) -> Result<Vec<Field>, ScanError> {
    let field = |i: usize| -> Option<Field> {
        let size = header.sizes.get(i)?.parse().ok()?;
        let number = match (header.kinds.get(i)?.as_str(), size) {
            ("U", 1 | 2 | 4 | 8) => Number::Unsigned(size),
            ("I", 1 | 2 | 4 | 8) => Number::Signed(size),
            ("F", 4 | 8) => Number::Float(size),
            _ => return None,
        };
        let count = header.counts.get(i).map_or(Some(1), |count| count.parse().ok())?;
        (count <= 1 << 16).then_some(Field { number, count })
    };
    let each = header.names.iter().enumerate().map(|(i, name)| {
        let bad = || {
            ScanError::Malformed(format!("field `{name}` of the PCD file has no usable size, type and count"))
        };
        field(i).ok_or_else(bad)
    });
    each.collect()
}

/// Which field has a coordinate.
fn place(header: &Header, name: &str) -> Result<usize, ScanError> {
    let found = header.names.iter().position(|n| n == name);
    found.ok_or_else(|| ScanError::Malformed(format!("the points of the PCD file have no `{name}`")))
}

fn ends_early<T>(count: usize, read: usize) -> Result<T, ScanError> {
    malformed(format!("says {count} points, but ends after {read}"))
}

fn read_text(
    fields: &[Field],
    places: [usize; 3],
    count: usize,
    body: &[u8],
) -> Result<Vec<[f64; 3]>, ScanError> {
    let text = String::from_utf8_lossy(body);
    let mut lines = text.lines().filter(|line| !line.trim().is_empty());
    let words = places.map(|place| fields[..place].iter().map(|f| f.count).sum::<usize>());
    let mut points = Vec::new();
    while points.len() < count {
        let Some(line) = lines.next() else { return ends_early(count, points.len()) };
        let values: Vec<&str> = line.split_whitespace().collect();
        let at = |i: usize| values.get(words[i]).and_then(|word| word.parse::<f64>().ok());
        let (Some(x), Some(y), Some(z)) = (at(0), at(1), at(2)) else {
            return malformed(format!("point {} of the PCD file: `{}`", points.len(), line.trim()));
        };
        points.push([x, y, z]);
    }
    Ok(points)
}

fn read_binary(
    fields: &[Field],
    places: [usize; 3],
    count: usize,
    body: &[u8],
) -> Result<Vec<[f64; 3]>, ScanError> {
    let size = |fields: &[Field]| fields.iter().map(|f| f.number.size() * f.count).sum::<usize>();
    let starts = places.map(|place| size(&fields[..place]));
    let whole = size(fields);
    if body.len() / whole.max(1) < count {
        return ends_early(count, body.len() / whole.max(1));
    }
    let point = |row: &[u8]| [0, 1, 2].map(|k| fields[places[k]].number.read(&row[starts[k]..], false));
    if places.iter().any(|&place| fields[place].count == 0) {
        return malformed("a coordinate of the PCD file has no number");
    }
    Ok(body.chunks_exact(whole.max(1)).take(count).map(point).collect())
}

/// Fields one after the other, each for all points.
fn read_compressed(
    fields: &[Field],
    places: [usize; 3],
    count: usize,
    body: &[u8],
) -> Result<Vec<[f64; 3]>, ScanError> {
    let size =
        |at: usize| body.get(at..at + 4).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]) as usize);
    let (Some(packed), Some(unpacked)) = (size(0), size(4)) else {
        return malformed("the compressed data of the PCD file has no sizes");
    };
    let of_all = |fields: &[Field]| fields.iter().map(|f| f.number.size() * f.count * count).sum::<usize>();
    let Some(packed) = body.get(8..8_usize.saturating_add(packed)) else {
        return malformed("the compressed data of the PCD file ends early");
    };
    // No format of this kind packs better than this.
    if unpacked != of_all(fields) || unpacked / 256 > packed.len() {
        return malformed("the compressed data of the PCD file is of another size than its points");
    }
    let Some(data) = unpack(packed, unpacked) else {
        return malformed("the compressed data of the PCD file is damaged");
    };
    let starts = places.map(|place| of_all(&fields[..place]));
    if places.iter().any(|&place| fields[place].count == 0) {
        return malformed("a coordinate of the PCD file has no number");
    }
    let at = |k: usize, i: usize| {
        let Field { number, count } = fields[places[k]];
        number.read(&data[starts[k] + i * count * number.size()..], false)
    };
    Ok((0..count).map(|i| [at(0, i), at(1, i), at(2, i)]).collect())
}

/// LZF: a byte below 32 says how many plain bytes follow, less one; others how far back and how long a repetition is.
fn unpack(packed: &[u8], size: usize) -> Option<Vec<u8>> {
    let mut out = Vec::with_capacity(size);
    let mut bytes = packed.iter().copied();
    while let Some(control) = bytes.next() {
        let control = usize::from(control);
        if control < 32 {
            for _ in 0..=control {
                out.push(bytes.next()?);
            }
        } else {
            let mut length = control >> 5;
            if length == 7 {
                length += usize::from(bytes.next()?);
            }
            let back = ((control & 31) << 8 | usize::from(bytes.next()?)) + 1;
            let from = out.len().checked_sub(back)?;
            for i in 0..length + 2 {
                out.push(out[from + i]);
            }
        }
        if out.len() > size {
            return None;
        }
    }
    (out.len() == size).then_some(out)
}
