//! Numbers in lines of text: XYZ, CSV and their like.

use super::{GRID_FORMATS, Grid, POINT_FORMATS, ScanError, bounded};
use crate::geom::HeightField;

fn separates(c: char) -> bool {
    c.is_whitespace() || matches!(c, ',' | ';')
}

/// Lines that are neither empty nor a comment, with their numbers.
fn lines(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let numbered = text.lines().enumerate().map(|(i, line)| (i + 1, line.trim()));
    numbered.filter(|(_, line)| !line.is_empty() && !line.starts_with('#') && !line.starts_with("//"))
}

fn text<'b>(bytes: &'b [u8], formats: &'static str) -> Result<&'b str, ScanError> {
    let text = std::str::from_utf8(bytes).map_err(|_| ScanError::UnknownFormat(formats))?;
    Ok(text.strip_prefix('\u{feff}').unwrap_or(text))
}

/// The first three numbers of each line. A first line without numbers names columns; one with a lone number counts the points.
pub(super) fn points(bytes: &[u8]) -> Result<Vec<[f64; 3]>, ScanError> {
    let text = text(bytes, POINT_FORMATS)?;
    let mut points = Vec::new();
    for (i, (number, line)) in lines(text).enumerate() {
        let mut words = line.split(separates).filter(|word| !word.is_empty());
        let mut next = || words.next().and_then(|word| word.parse::<f64>().ok());
        let found = [next(), next(), next()];
        match found {
            [Some(x), Some(y), Some(z)] => points.push([x, y, z]),
            [None, ..] | [Some(_), None, _] if i == 0 => {}
            _ if points.is_empty() => return Err(ScanError::UnknownFormat(POINT_FORMATS)),
            _ => return Err(ScanError::Malformed(format!("line {number}: a point needs three numbers"))),
        }
        bounded(points.len())?;
    }
    Ok(points)
}

/// A row in each line. Between commas or semicolons nothing may stand, which is no number, and so is `nan`.
pub(super) fn grid(bytes: &[u8]) -> Result<Grid, ScanError> {
    let text = text(bytes, GRID_FORMATS)?;
    let mut columns = 0;
    let mut values: Vec<f64> = Vec::new();
    for (number, line) in lines(text) {
        let before = values.len();
        let marked = line.contains([',', ';']);
        let words = line.split(|c: char| if marked { matches!(c, ',' | ';') } else { c.is_whitespace() });
        for word in words.map(str::trim).filter(|word| marked || !word.is_empty()) {
            match (word, word.parse::<f64>()) {
                ("", _) => values.push(f64::NAN),
                (_, Ok(value)) => values.push(value),
                _ if before == 0 => return Err(ScanError::UnknownFormat(GRID_FORMATS)),
                _ => return Err(ScanError::Malformed(format!("line {number}: `{word}` is no number"))),
            }
        }
        let width = values.len() - before;
        if columns == 0 {
            columns = width;
        }
        if width != columns {
            let what = format!("line {number} has {width} numbers, those above have {columns}");
            return Err(ScanError::Malformed(what));
        }
        if values.len() > HeightField::MOST_SAMPLES {
            return Err(ScanError::TooLarge(HeightField::MOST_SAMPLES, "samples"));
        }
    }
    if values.is_empty() {
        return Err(ScanError::Empty("heights"));
    }
    Ok(Grid { columns, values, full: None })
}
