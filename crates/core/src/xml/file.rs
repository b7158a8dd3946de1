//! Files of XML: reading, decoding, merge conflicts.

use std::borrow::Cow;
use std::path::Path;

use super::{Element, Limits, parse};
use crate::diag::{Diagnostic, Diagnostics, FileId, Sources, Span};
use crate::system::System;

/// The root element of the file at `path`, as far as it could be made out.
///
/// The text goes to `sources` as decoded; all spans point into it.
pub(crate) fn load(
    system: &dyn System,
    sources: &mut Sources,
    path: &Path,
) -> (Option<Element>, Diagnostics) {
    let bytes = match system.read(path) {
        Ok(bytes) => bytes,
        Err(error) => {
            let mut found = Diagnostics::new();
            found.push(Diagnostic::unreadable(path, &error));
            return (None, found);
        }
    };
    let mut found = Diagnostics::new();
    let (text, bad_byte) = decode(&bytes);
    let file = sources.add(path.display().to_string(), text);
    let text = sources.text(file);
    if let Some(at) = bad_byte {
        let span = Span { file, start: at, end: at };
        let message = "the file is not UTF-8; bytes that make no character are read as U+FFFD";
        found.push(Diagnostic::warning("R0205", message).at(span, "first such byte"));
    }
    let text = take_first_side(text, file, &mut found);
    let (root, from_parser) = parse(&text, file, Limits::default());
    found.extend(from_parser);
    (root, found)
}

/// Text of UTF-8 or, with a byte order mark, UTF-16 bytes; and where the first undecodable byte is.
pub(crate) fn decode(bytes: &[u8]) -> (String, Option<usize>) {
    let utf16 = |unit: fn([u8; 2]) -> u16| {
        let units: Vec<u16> = bytes[2..].chunks_exact(2).map(|pair| unit([pair[0], pair[1]])).collect();
        match String::from_utf16(&units) {
            Ok(text) => (text, None),
            Err(_) => (String::from_utf16_lossy(&units), Some(0)),
        }
    };
    match bytes {
        [0xff, 0xfe, ..] => utf16(u16::from_le_bytes),
        [0xfe, 0xff, ..] => utf16(u16::from_be_bytes),
        _ => match std::str::from_utf8(bytes) {
            Ok(text) => (text.to_owned(), None),
            Err(error) => (String::from_utf8_lossy(bytes).into_owned(), Some(error.valid_up_to())),
        },
    }
}

/// `text` with merge conflicts blanked out but for their first side, so that what follows can be checked as well.
/// Each conflict is an error. Byte positions stay.
fn take_first_side<'a>(text: &'a str, file: FileId, found: &mut Diagnostics) -> Cow<'a, str> {
    let is_marker = |line: &str, marker: &str| {
        line.strip_prefix(marker).is_some_and(|rest| rest.trim_end().is_empty() || rest.starts_with(' '))
    };
    if !text.lines().any(|line| is_marker(line, "<<<<<<<")) {
        return Cow::Borrowed(text);
    }
    let mut kept = String::with_capacity(text.len());
    let mut in_first_side = false;
    let mut in_other_side = false;
    let mut at = 0;
    for line in text.split_inclusive('\n') {
        let mut blank = in_other_side;
        if is_marker(line, "<<<<<<<") {
            let span = Span { file, start: at, end: at + line.trim_end().len() };
            found.push(
                Diagnostic::error("R0204", "unresolved merge conflict")
                    .at(span, "starts here")
                    .hint("choose one of the two versions and delete the marker lines"),
            );
            (in_first_side, blank) = (true, true);
        } else if in_first_side && (is_marker(line, "=======") || is_marker(line, "|||||||")) {
            (in_first_side, in_other_side, blank) = (false, true, true);
        } else if in_other_side && is_marker(line, ">>>>>>>") {
            in_other_side = false;
        }
        if blank {
            kept.extend(line.bytes().map(|b| if b == b'\n' { '\n' } else { ' ' }));
        } else {
            kept.push_str(line);
        }
        at += line.len();
    }
    Cow::Owned(kept)
}
