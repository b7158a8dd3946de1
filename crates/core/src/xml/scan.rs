//! The characters of an XML text: a cursor, names, entities.

use crate::diag::{FileId, Span};

/// A place in a text, moving forward only.
pub(super) struct Scanner<'a> {
    text: &'a str,
    file: FileId,
    at: usize,
}

impl<'a> Scanner<'a> {
    pub(super) fn new(text: &'a str, file: FileId) -> Self {
        Self { text, file, at: 0 }
    }

    pub(super) fn position(&self) -> usize {
        self.at
    }

    pub(super) fn rest(&self) -> &'a str {
        &self.text[self.at..]
    }

    pub(super) fn is_at_end(&self) -> bool {
        self.at == self.text.len()
    }

    pub(super) fn span_from(&self, start: usize) -> Span {
        Span { file: self.file, start, end: self.at }
    }

    /// A span of one character, here.
    pub(super) fn here(&self) -> Span {
        let end = self.at + self.rest().chars().next().map_or(0, char::len_utf8);
        Span { file: self.file, start: self.at, end }
    }

    pub(super) fn advance(&mut self, bytes: usize) {
        self.at += bytes;
    }

    /// Moves past `token` if it comes next.
    pub(super) fn eat(&mut self, token: &str) -> bool {
        let found = self.rest().starts_with(token);
        if found {
            self.at += token.len();
        }
        found
    }

    /// The text up to the first character that satisfies `stop`, or to the end.
    pub(super) fn take_until(&mut self, stop: impl Fn(char) -> bool) -> &'a str {
        let rest = self.rest();
        let taken = &rest[..rest.find(stop).unwrap_or(rest.len())];
        self.at += taken.len();
        taken
    }

    /// The text before `token`, moving past both; `None` (and no move) when the token never comes.
    pub(super) fn take_past(&mut self, token: &str) -> Option<&'a str> {
        let rest = self.rest();
        let length = rest.find(token)?;
        self.at += length + token.len();
        Some(&rest[..length])
    }

    pub(super) fn skip_space(&mut self) {
        self.take_until(|c| !c.is_ascii_whitespace());
    }

    pub(super) fn name(&mut self) -> &'a str {
        self.take_until(|c| c.is_ascii_whitespace() || "/><=\"'&?".contains(c))
    }
}

/// Whether a tag may start with this character.
pub(super) fn starts_name(c: char) -> bool {
    c.is_alphabetic() || c == '_' || c == ':'
}

/// Whether XML 1.0 allows this character at all.
pub(super) fn is_xml_char(c: char) -> bool {
    matches!(c, '\t' | '\n' | '\r' | '\u{20}'..='\u{d7ff}' | '\u{e000}'..='\u{fffd}' | '\u{10000}'..)
}

/// `raw` with its entities resolved, and the byte offset of each `&` that names none.
pub(super) fn resolve_entities(raw: &str) -> (String, Vec<usize>) {
    let mut resolved = String::with_capacity(raw.len());
    let mut bad = Vec::new();
    let mut at = 0;
    while let Some(offset) = raw[at..].find('&') {
        resolved.push_str(&raw[at..at + offset]);
        at += offset;
        match entity(&raw[at + 1..]) {
            Some((c, length)) => {
                resolved.push(c);
                at += 1 + length;
            }
            None => {
                bad.push(at);
                resolved.push('&');
                at += 1;
            }
        }
    }
    resolved.push_str(&raw[at..]);
    (resolved, bad)
}

/// The character named by an entity without its `&`, and the length of the name with its semicolon.
fn entity(after: &str) -> Option<(char, usize)> {
    let length = after.bytes().take(12).position(|b| b == b';')?;
    let name = &after[..length];
    let c = match name {
        "lt" => '<',
        "gt" => '>',
        "amp" => '&',
        "quot" => '"',
        "apos" => '\'',
        _ => {
            let digits = name.strip_prefix('#')?;
            let code = match digits.strip_prefix(['x', 'X']) {
                Some(hex) => u32::from_str_radix(hex, 16).ok()?,
                None => digits.parse().ok()?,
            };
            char::from_u32(code).filter(|&c| is_xml_char(c))?
        }
    };
    Some((c, length + 1))
}
