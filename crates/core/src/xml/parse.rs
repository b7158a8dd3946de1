//! Text to tree.

use std::collections::BTreeSet;

use super::scan::{Scanner, is_xml_char, resolve_entities, starts_name};
use super::{Attribute, Element, Node};
use crate::diag::{Diagnostic, Diagnostics, FileId, Severity, Span};

/// Bounds that keep hostile input from using up stack or memory.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Limits {
    /// Deepest nesting of elements.
    pub(crate) depth: usize,
    /// Longest text, bytes.
    pub(crate) bytes: usize,
}

impl Default for Limits {
    fn default() -> Self {
        Self { depth: 200, bytes: 64 << 20 }
    }
}

/// Most attributes of one element.
const MOST_ATTRIBUTES: usize = 1000;

/// Faults after which reading stops: a file with this many is not XML.
const MOST_FAULTS: usize = 60;

/// The root element of `text`, as far as it could be made out, and what is wrong with it.
pub(crate) fn parse(text: &str, file: FileId, limits: Limits) -> (Option<Element>, Diagnostics) {
    let mut parser = Parser {
        scanner: Scanner::new(text, file),
        file,
        first: 0,
        open: Vec::new(),
        root: None,
        prefixes: ["xml".to_owned(), "xmlns".to_owned()].into(),
        found: Diagnostics::new(),
    };
    if text.len() > limits.bytes {
        let message =
            format!("the text is {} MB long; the most is {} MB", text.len() >> 20, limits.bytes >> 20);
        parser.found.push(Diagnostic::error("R0206", message));
        return (None, parser.found);
    }
    parser.run(limits.depth);
    if parser.root.is_none() && !parser.found.has_errors() {
        let start = Span { file, start: 0, end: 0 };
        parser.error(start, "nothing in here", "there is no XML element in this file");
    }
    (parser.root, parser.found)
}

struct Parser<'a> {
    scanner: Scanner<'a>,
    file: FileId,
    /// Where the text starts: behind the byte order mark, if it has one.
    first: usize,
    open: Vec<Element>,
    root: Option<Element>,
    /// Namespace prefixes that were declared, or were complained about already.
    prefixes: BTreeSet<String>,
    found: Diagnostics,
}

impl Parser<'_> {
    fn error(&mut self, span: Span, label: &str, message: impl Into<String>) {
        if self.found.count(Severity::Error) >= MOST_FAULTS {
            return;
        }
        self.found.push(Diagnostic::error("R0201", message).at(span, label));
    }

    fn repaired(&mut self, span: Span, label: &str, message: impl Into<String>) {
        self.found.push(Diagnostic::warning("R0202", message).at(span, label));
    }

    fn run(&mut self, depth: usize) {
        self.scanner.eat("\u{feff}");
        self.first = self.scanner.position();
        while !self.scanner.is_at_end() && self.found.count(Severity::Error) < MOST_FAULTS {
            if self.root.is_some() && self.open.is_empty() {
                self.after_root();
                return;
            }
            if self.open.len() >= depth {
                let message = format!("elements are nested more than {depth} deep");
                self.found.push(Diagnostic::error("R0206", message).at(self.scanner.here(), "here"));
                break;
            }
            self.node();
        }
        self.close_rest();
    }

    /// One tag, comment, instruction or run of text.
    fn node(&mut self) {
        let start = self.scanner.position();
        if !self.scanner.rest().starts_with('<') {
            self.text();
        } else if self.scanner.eat("<!--") {
            self.comment(start);
        } else if self.scanner.eat("<![CDATA[") {
            match self.scanner.take_past("]]>") {
                Some(data) => self.append_text(data.to_owned(), start),
                None => self.unfinished(start, "CDATA section", "]]>"),
            }
        } else if self.scanner.eat("<?") {
            self.instruction(start);
        } else if self.scanner.eat("<!") {
            self.doctype(start);
        } else if self.scanner.eat("</") {
            self.end_tag(start);
        } else if self.scanner.rest()[1..].starts_with(starts_name) {
            self.scanner.advance(1);
            self.start_tag(start);
        } else {
            let span = self.scanner.here();
            self.error(span, "not a tag", "`<` that starts no tag; write `&lt;` for the character");
            self.scanner.advance(1);
        }
    }

    fn text(&mut self) {
        let start = self.scanner.position();
        let raw = self.scanner.take_until(|c| c == '<');
        if let Some((offset, c)) = raw.char_indices().find(|&(_, c)| !is_xml_char(c)) {
            let span = Span { file: self.file, start: start + offset, end: start + offset + c.len_utf8() };
            self.error(span, "not allowed in XML", format!("control character {:?}", c));
        }
        let text = self.resolved(raw, start);
        self.append_text(text, start);
    }

    fn append_text(&mut self, text: String, start: usize) {
        let span = self.scanner.span_from(start);
        match self.open.last_mut() {
            Some(parent) => {
                if !text.is_empty() {
                    parent.children.push(Node::Text(text, span));
                }
            }
            None if text.trim().is_empty() => {}
            None => {
                let lead = text.len() - text.trim_start().len();
                let span = Span { start: start + lead, ..span };
                self.error(span, "outside of any element", "text before the first element");
            }
        }
    }

    fn resolved(&mut self, raw: &str, start: usize) -> String {
        let (text, bad) = resolve_entities(raw);
        for offset in bad {
            let span = Span { file: self.file, start: start + offset, end: start + offset + 1 };
            self.error(
                span,
                "no such entity",
                "`&` that names no character; write `&amp;` for the character",
            );
        }
        text
    }

    fn comment(&mut self, start: usize) {
        match self.scanner.take_past("-->") {
            Some(text) if text.contains("--") || text.ends_with('-') => {
                let span = Span { file: self.file, start, end: start + 4 };
                self.repaired(
                    span,
                    "this comment",
                    "a comment must not contain `--`; it is skipped all the same",
                );
            }
            Some(_) => {}
            None => self.unfinished(start, "comment", "-->"),
        }
    }

    fn unfinished(&mut self, start: usize, what: &str, end: &str) {
        let span = self.scanner.span_from(start);
        self.error(span, "opened here", format!("this {what} never ends with `{end}`"));
        self.scanner.advance(self.scanner.rest().len());
    }

    fn instruction(&mut self, start: usize) {
        let Some(text) = self.scanner.take_past("?>") else {
            return self.unfinished(start, "processing instruction", "?>");
        };
        let Some(declaration) =
            text.strip_prefix("xml").filter(|t| t.starts_with(|c: char| c.is_whitespace()))
        else {
            return;
        };
        let span = self.scanner.span_from(start);
        if start != self.first {
            self.repaired(
                span,
                "not at the start",
                "the XML declaration must be the first thing in a file; it is ignored here",
            );
        } else if !["\"1.0\"", "'1.0'", "\"1.1\"", "'1.1'"].iter().any(|v| declaration.contains(v)) {
            self.repaired(
                span,
                "unknown version",
                "this XML version does not exist; the file is read as XML 1.0",
            );
        }
    }

    fn doctype(&mut self, start: usize) {
        // Internal subsets hold `>` inside brackets; entities they define are reported where they are used.
        let mut brackets = 0_i32;
        loop {
            self.scanner.take_until(|c| "[]>".contains(c));
            if self.scanner.eat("[") {
                brackets += 1;
            } else if self.scanner.eat("]") {
                brackets -= 1;
            } else if self.scanner.eat(">") {
                if brackets <= 0 {
                    return;
                }
            } else {
                return self.unfinished(start, "declaration", ">");
            }
        }
    }

    fn start_tag(&mut self, start: usize) {
        let name = self.scanner.name().to_owned();
        let span = self.scanner.span_from(start);
        let mut element = Element { name, attributes: Vec::new(), children: Vec::new(), span };
        let mut told = false;
        loop {
            self.scanner.skip_space();
            if self.scanner.eat("/>") {
                self.check_prefixes(&element);
                return self.append(element);
            }
            if self.scanner.eat(">") {
                self.check_prefixes(&element);
                return self.open.push(element);
            }
            if element.attributes.len() > MOST_ATTRIBUTES {
                let message = format!("`<{}>` has more than {MOST_ATTRIBUTES} attributes", element.name);
                self.found.push(Diagnostic::error("R0206", message).at(span, "this element"));
                self.scanner.advance(self.scanner.rest().len());
            }
            if self.scanner.is_at_end() || self.scanner.rest().starts_with('<') {
                if !told {
                    self.error(span, "this tag", format!("the tag `<{}` never ends with `>`", element.name));
                }
                return self.open.push(element);
            }
            told = !self.attribute(&mut element);
        }
    }

    /// Reads one attribute; whether its value ended where it should.
    fn attribute(&mut self, element: &mut Element) -> bool {
        let start = self.scanner.position();
        let name = self.scanner.name().to_owned();
        let name_span = self.scanner.span_from(start);
        if name.is_empty() {
            let span = self.scanner.here();
            self.error(
                span,
                "unexpected",
                format!("a character that belongs to no attribute of `<{}>`", element.name),
            );
            self.scanner.advance(span.end - span.start);
            return true;
        }
        self.scanner.skip_space();
        if !self.scanner.eat("=") {
            self.error(name_span, "no value", format!("attribute `{name}` has no value"));
            return true;
        }
        self.scanner.skip_space();
        let quote = match self.scanner.rest().chars().next() {
            Some(c @ ('"' | '\'')) => c,
            _ => {
                self.error(name_span, "not in quotes", format!("the value of `{name}` is not in quotes"));
                self.scanner.take_until(|c| c.is_ascii_whitespace() || c == '>' || c == '/');
                return true;
            }
        };
        self.scanner.advance(1);
        let value_start = self.scanner.position();
        let raw = self.scanner.take_until(|c| c == quote || c == '<');
        let span = self.scanner.span_from(value_start);
        let is_closed = self.scanner.rest().starts_with(quote);
        if is_closed {
            self.scanner.advance(1);
        } else {
            let message = format!("the value of `{name}` has no closing quote before the next `<`");
            self.error(name_span, "opened here", message);
        }
        if raw.chars().any(|c| !is_xml_char(c)) {
            self.error(span, "not allowed in XML", format!("control character in the value of `{name}`"));
        }
        let value = self.resolved(&raw.replace(['\n', '\r', '\t'], " "), value_start);
        if element.attribute(&name).is_some() {
            self.error(name_span, "second time", format!("attribute `{name}` is given twice"));
        } else {
            element.attributes.push(Attribute { name, value, span });
        }
        is_closed
    }

    /// Warns once for each prefix that no ancestor declares. Scopes are not tracked: a prefix counts as declared from
    /// its declaration to the end of the file.
    fn check_prefixes(&mut self, element: &Element) {
        for attribute in &element.attributes {
            if let Some(prefix) = attribute.name.strip_prefix("xmlns:") {
                self.prefixes.insert(prefix.to_owned());
            }
        }
        let names = std::iter::once(&element.name).chain(element.attributes.iter().map(|a| &a.name));
        for name in names {
            let Some((prefix, _)) = name.split_once(':') else { continue };
            if self.prefixes.insert(prefix.to_owned()) {
                self.found.push(
                    Diagnostic::warning("R0203", format!("namespace prefix `{prefix}` is not declared"))
                        .at(element.span, "used here")
                        .hint(format!("declare it on the root element: xmlns:{prefix}=\"...\"")),
                );
            }
        }
    }

    fn append(&mut self, element: Element) {
        match self.open.last_mut() {
            Some(parent) => parent.children.push(Node::Element(element)),
            None => self.root = Some(element),
        }
    }

    fn end_tag(&mut self, start: usize) {
        let name = self.scanner.name().to_owned();
        self.scanner.take_until(|c| c == '>' || c == '<');
        self.scanner.eat(">");
        let span = self.scanner.span_from(start);
        let Some(depth) = self.open.iter().rposition(|e| e.name == name) else {
            let message = match self.open.last() {
                Some(top) => format!("`</{name}>` closes nothing; the open element is `<{}>`", top.name),
                None => format!("`</{name}>` closes nothing"),
            };
            self.error(span, "no such element is open", message);
            // A misspelt end tag is more likely than a stray one.
            if self.open.last().is_some_and(|top| crate::diag::nearest(&name, [top.name.as_str()]).is_some())
            {
                self.close_top();
            }
            return;
        };
        while self.open.len() > depth + 1 {
            let top = &self.open[self.open.len() - 1];
            let message = format!("`<{}>` is not closed before `</{name}>`", top.name);
            let opened = top.span;
            self.error(opened, "opened here", message);
            self.close_top();
        }
        self.close_top();
    }

    fn close_top(&mut self) {
        if let Some(element) = self.open.pop() {
            self.append(element);
        }
    }

    fn close_rest(&mut self) {
        while let Some(top) = self.open.last() {
            let (span, message) = (top.span, format!("`<{}>` is never closed", top.name));
            self.error(span, "opened here", message);
            self.close_top();
        }
    }

    /// Comments and space may follow the root element; anything else is skipped with a warning.
    fn after_root(&mut self) {
        loop {
            self.scanner.skip_space();
            let start = self.scanner.position();
            if self.scanner.is_at_end() {
                return;
            }
            if self.scanner.eat("<!--") {
                self.comment(start);
            } else {
                let span = self.scanner.here();
                self.repaired(
                    span,
                    "from here on",
                    "everything after the end of the root element is ignored",
                );
                return;
            }
        }
    }
}
