//! PLY, text and binary (Turk, "The PLY polygon file format", 1994): the vertices.

use super::{ScanError, bounded};
use crate::npy::Number;

pub(super) fn is_ply(bytes: &[u8]) -> bool {
    bytes.starts_with(b"ply\n") || bytes.starts_with(b"ply\r")
}

#[derive(Debug)]
struct Element {
    name: String,
    count: usize,
    properties: Vec<Property>,
}

#[derive(Debug)]
struct Property {
    name: String,
    /// The type of the count, of a list.
    list: Option<Number>,
    number: Number,
}

#[derive(Clone, Copy, PartialEq)]
enum Form {
    Text,
    Binary { big_endian: bool },
}

pub(super) fn read(bytes: &[u8]) -> Result<Vec<[f64; 3]>, ScanError> {
    let (form, elements, body) = header(bytes)?;
    match form {
        Form::Text => read_text(&elements, body),
        Form::Binary { big_endian } => read_binary(&elements, body, big_endian),
    }
}

fn malformed<T>(what: impl Into<String>) -> Result<T, ScanError> {
    Err(ScanError::Malformed(what.into()))
}

fn header(bytes: &[u8]) -> Result<(Form, Vec<Element>, &[u8]), ScanError> {
    let mut form = None;
    let mut elements: Vec<Element> = Vec::new();
    let mut rest = bytes;
    for number in 1.. {
        let Some(end) = rest.iter().position(|b| *b == b'\n').filter(|_| number < 10_000) else {
            return malformed("the header of the PLY file has no end");
        };
        let (line, below) = (&rest[..end], &rest[end + 1..]);
        rest = below;
        let line = String::from_utf8_lossy(line);
        let words: Vec<&str> = line.split_whitespace().collect();
        match words.as_slice() {
            ["end_header"] => break,
            ["format", word, ..] => {
                form = Some(match *word {
                    "ascii" => Form::Text,
                    "binary_little_endian" => Form::Binary { big_endian: false },
                    "binary_big_endian" => Form::Binary { big_endian: true },
                    other => return malformed(format!("line {number}: `{other}` is no PLY format")),
                });
            }
            ["element", name, count] => {
                let Ok(count) = count.parse() else {
                    return malformed(format!("line {number}: `{count}` is no number of elements"));
                };
                elements.push(Element { name: (*name).to_owned(), count, properties: Vec::new() });
            }
            ["property", kind @ .., name] if (1..=3).contains(&kind.len()) => {
                let number_of = |word: &str| match number_named(word) {
                    Some(found) => Ok(found),
                    None => malformed(format!("line {number}: `{word}` is no type of a PLY property")),
                };
                let (list, kind) = match kind {
                    ["list", count, kind] => (Some(number_of(count)?), number_of(kind)?),
                    [kind] => (None, number_of(kind)?),
                    _ => return malformed(format!("line {number}: a property needs a type and a name")),
                };
                let Some(element) = elements.last_mut() else {
                    return malformed(format!("line {number}: a property without an element"));
                };
                element.properties.push(Property { name: (*name).to_owned(), list, number: kind });
            }
            _ => {}
        }
    }
    let Some(form) = form else { return malformed("the PLY file does not say its format") };
    Ok((form, elements, rest))
}

fn number_named(word: &str) -> Option<Number> {
    Some(match word {
        "char" | "int8" => Number::Signed(1),
        "uchar" | "uint8" => Number::Unsigned(1),
        "short" | "int16" => Number::Signed(2),
        "ushort" | "uint16" => Number::Unsigned(2),
        "int" | "int32" => Number::Signed(4),
        "uint" | "uint32" => Number::Unsigned(4),
        "float" | "float32" => Number::Float(4),
        "double" | "float64" => Number::Float(8),
        _ => return None,
    })
}

/// Where x, y and z are among the properties of the vertices.
fn coordinates(element: &Element) -> Result<[usize; 3], ScanError> {
    let of = |name: &str| {
        let found = element.properties.iter().position(|p| p.name == name && p.list.is_none());
        found.ok_or_else(|| ScanError::Malformed(format!("the vertices of the PLY file have no `{name}`")))
    };
    Ok([of("x")?, of("y")?, of("z")?])
}

fn ends_early<T>(element: &Element, read: usize) -> Result<T, ScanError> {
    malformed(format!("says {} of `{}`, but ends after {read}", element.count, element.name))
}

fn read_text(elements: &[Element], body: &[u8]) -> Result<Vec<[f64; 3]>, ScanError> {
    let text = String::from_utf8_lossy(body);
    let mut lines = text.lines().filter(|line| !line.trim().is_empty());
    for element in elements {
        if element.name != "vertex" {
            if element.count > 0 && lines.nth(element.count - 1).is_none() {
                return ends_early(element, 0);
            }
            continue;
        }
        bounded(element.count)?;
        let at = coordinates(element)?;
        let mut points = Vec::new();
        while points.len() < element.count {
            let Some(line) = lines.next() else { return ends_early(element, points.len()) };
            let numbers = scalars(element, line);
            let Some(numbers) = numbers else {
                return malformed(format!("vertex {} of the PLY file: `{}`", points.len(), line.trim()));
            };
            points.push(at.map(|i| numbers[i]));
        }
        return Ok(points);
    }
    malformed("the PLY file has no vertices")
}

/// The value of each property in a line of text; that of a list is no number.
fn scalars(element: &Element, line: &str) -> Option<Vec<f64>> {
    let mut words = line.split_whitespace();
    let mut next = || words.next()?.parse::<f64>().ok();
    let mut values = Vec::with_capacity(element.properties.len());
    for property in &element.properties {
        let value = next()?;
        values.push(value);
        if property.list.is_some() {
            for _ in 0..value as usize {
                next()?;
            }
        }
    }
    Some(values)
}

fn read_binary(elements: &[Element], body: &[u8], big_endian: bool) -> Result<Vec<[f64; 3]>, ScanError> {
    let mut rest = body;
    for element in elements {
        let is_vertex = element.name == "vertex";
        if is_vertex {
            bounded(element.count)?;
        }
        let at = if is_vertex { coordinates(element)? } else { [0; 3] };
        if element.properties.is_empty() {
            continue;
        }
        let mut points = Vec::new();
        let mut values = vec![0.0; element.properties.len()];
        // Every element takes at least a byte, so that this ends with the file.
        for done in 0..element.count {
            for (value, property) in values.iter_mut().zip(&element.properties) {
                let number = property.list.unwrap_or(property.number);
                let Some((first, after)) = rest.split_at_checked(number.size()) else {
                    return ends_early(element, done);
                };
                *value = number.read(first, big_endian);
                rest = after;
                if property.list.is_some() {
                    let skipped = (*value as usize).checked_mul(property.number.size());
                    let Some(after) = skipped.and_then(|n| rest.get(n..)) else {
                        return ends_early(element, done);
                    };
                    rest = after;
                }
            }
            if is_vertex {
                points.push(at.map(|i| values[i]));
            }
        }
        if is_vertex {
            return Ok(points);
        }
    }
    malformed("the PLY file has no vertices")
}
