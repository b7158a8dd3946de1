//! A TOML text as a tree of values that know where they stand.

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use crate::diag::{Diagnostic, Diagnostics, FileId, Sources, Span};

/// A value and its place.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Node {
    pub(super) span: Span,
    pub(super) value: Value,
}

/// What a node holds.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Value {
    Bool(bool),
    Integer(i64),
    /// Any float, `nan` and `inf` included: the schema refuses those.
    Float(f64),
    Text(String),
    /// A date, which no specification uses.
    Date,
    /// A number that does not fit; reported already.
    Unreadable,
    List(Vec<Node>),
    Table(Table),
}

/// Keys and values in the order of the text.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Table {
    pub(super) entries: Vec<Entry>,
}

/// One key of a table.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Entry {
    pub(super) key: String,
    pub(super) key_span: Span,
    pub(super) node: Node,
}

impl Node {
    /// The kind of value, with its article, for messages.
    pub(super) fn kind(&self) -> &'static str {
        match &self.value {
            Value::Bool(_) => "a boolean",
            Value::Integer(_) => "an integer",
            Value::Float(_) => "a number",
            Value::Text(_) => "a text",
            Value::Date => "a date",
            Value::Unreadable => "a number",
            Value::List(_) => "a list",
            Value::Table(_) => "a table",
        }
    }

    /// The number, if it is a finite one; negative zero becomes zero, so that equal numbers hash equally.
    pub(super) fn number(&self) -> Option<f64> {
        match self.value {
            Value::Integer(i) => Some(i as f64),
            Value::Float(x) if x.is_finite() => Some(x + 0.0),
            _ => None,
        }
    }

    pub(super) fn integer(&self) -> Option<i64> {
        match self.value {
            Value::Integer(i) => Some(i),
            _ => None,
        }
    }

    pub(super) fn boolean(&self) -> Option<bool> {
        match self.value {
            Value::Bool(b) => Some(b),
            _ => None,
        }
    }

    pub(super) fn text(&self) -> Option<&str> {
        match &self.value {
            Value::Text(text) => Some(text),
            _ => None,
        }
    }

    pub(super) fn list(&self) -> Option<&[Node]> {
        match &self.value {
            Value::List(items) => Some(items),
            _ => None,
        }
    }

    pub(super) fn table(&self) -> Option<&Table> {
        match &self.value {
            Value::Table(table) => Some(table),
            _ => None,
        }
    }

    /// All items as finite numbers, or `None` if any is something else.
    pub(super) fn numbers(&self) -> Option<Vec<f64>> {
        self.list()?.iter().map(Node::number).collect()
    }

    /// Exactly `N` finite numbers.
    pub(super) fn array<const N: usize>(&self) -> Option<[f64; N]> {
        self.numbers()?.try_into().ok()
    }
}

impl Table {
    pub(super) fn get(&self, key: &str) -> Option<&Node> {
        self.entries.iter().find(|e| e.key == key).map(|e| &e.node)
    }

    pub(super) fn entry(&self, key: &str) -> Option<&Entry> {
        self.entries.iter().find(|e| e.key == key)
    }

    /// The text at `key` with its place.
    pub(super) fn text(&self, key: &str) -> Option<(&str, Span)> {
        let node = self.get(key)?;
        Some((node.text()?, node.span))
    }

    pub(super) fn number(&self, key: &str) -> Option<f64> {
        self.get(key)?.number()
    }

    pub(super) fn table(&self, key: &str) -> Option<&Table> {
        self.get(key)?.table()
    }

    /// The items of the list at `key`; none if the key is absent or no list.
    pub(super) fn list(&self, key: &str) -> &[Node] {
        self.get(key).and_then(Node::list).unwrap_or_default()
    }

    /// The tables of the array of tables at `key`, each with its place.
    pub(super) fn tables(&self, key: &str) -> impl Iterator<Item = (&Table, Span)> {
        self.list(key).iter().filter_map(|node| Some((node.table()?, node.span)))
    }

    /// The entries of the table at `key`; none if the key is absent or no table.
    pub(super) fn entries(&self, key: &str) -> &[Entry] {
        self.table(key).map(|t| t.entries.as_slice()).unwrap_or_default()
    }
}

/// The tree of a text already in `sources`; syntax errors go to `diagnostics`, and what could be read is returned.
pub(super) fn parse(sources: &Sources, file: FileId, diagnostics: &mut Diagnostics) -> Table {
    let text = sources.text(file);
    let (document, errors) = DeTable::parse_recoverable(text);
    let mut errors: Vec<(Span, &str)> =
        errors.iter().map(|e| (span(file, e.span().unwrap_or(0..0)), e.message())).collect();
    errors.sort_by_key(|(place, _)| place.start);
    // One finding a line: what follows on a broken line is confusion of the parser.
    errors.dedup_by_key(|(place, _)| sources.line_column(*place).line);
    // A list that is not closed swallows the lines below it, one fault each.
    errors.dedup_by_key(|(_, message)| *message);
    for (place, message) in errors {
        diagnostics.push(syntax_error(text, place, message));
    }
    table(file, document.get_ref(), diagnostics)
}

fn syntax_error(text: &str, place: Span, message: &str) -> Diagnostic {
    let found = text.get(place.start..place.end).unwrap_or_default();
    if message.starts_with("string values must be quoted") && found.trim().is_empty() {
        return Diagnostic::error("R0101", "a key has no value")
            .at(place, "nothing here")
            .expected("a value");
    }
    let message = message.lines().next().unwrap_or_default();
    if message.starts_with("missing comma between array elements") {
        return Diagnostic::error("R0101", "a list is not closed, or its values are not separated")
            .at(place, "not a value of the list")
            .expected("`]` or `,` before this");
    }
    match message.split_once(", expected ") {
        Some((what, "nothing")) => Diagnostic::error("R0101", what).at(place, "not TOML"),
        Some((what, expected)) => Diagnostic::error("R0101", what).at(place, "not TOML").expected(expected),
        None => Diagnostic::error("R0101", message).at(place, "not TOML"),
    }
}

fn span(file: FileId, range: std::ops::Range<usize>) -> Span {
    Span { file, start: range.start, end: range.end }
}

fn table(file: FileId, source: &DeTable<'_>, diagnostics: &mut Diagnostics) -> Table {
    let mut entries: Vec<Entry> = source
        .iter()
        .map(|(key, value)| Entry {
            key: key.get_ref().to_string(),
            key_span: span(file, key.span()),
            node: node(file, value, diagnostics),
        })
        .collect();
    entries.sort_by_key(|e| e.key_span.start);
    Table { entries }
}

fn node(file: FileId, source: &Spanned<DeValue<'_>>, diagnostics: &mut Diagnostics) -> Node {
    let place = span(file, source.span());
    let mut unreadable = |what: &str, expected: &str| {
        diagnostics.push(
            Diagnostic::error("R0105", format!("{what} cannot be read"))
                .at(place, "too large")
                .expected(expected),
        );
    };
    let value = match source.get_ref() {
        DeValue::Boolean(b) => Value::Bool(*b),
        DeValue::Integer(i) => match i64::from_str_radix(i.as_str(), i.radix()) {
            Ok(value) => Value::Integer(value),
            Err(_) => {
                unreadable("this integer", "an integer of 64 bits");
                Value::Unreadable
            }
        },
        DeValue::Float(x) => match x.as_str().parse::<f64>() {
            Ok(value) if value.is_finite() || x.as_str().contains(['i', 'n']) => Value::Float(value),
            _ => {
                unreadable("this number", "a number that fits double precision");
                Value::Unreadable
            }
        },
        DeValue::String(text) => Value::Text(text.to_string()),
        DeValue::Datetime(_) => Value::Date,
        DeValue::Array(items) => {
            Value::List(items.iter().map(|item| node(file, item, diagnostics)).collect())
        }
        DeValue::Table(entries) => Value::Table(table(file, entries, diagnostics)),
    };
    Node { span: place, value }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tree(text: &str) -> (Table, String) {
        let mut sources = Sources::new();
        let file = sources.add("a.toml", text);
        let mut diagnostics = Diagnostics::new();
        let table = parse(&sources, file, &mut diagnostics);
        (table, diagnostics.to_plain_text(&sources))
    }

    #[test]
    fn values_keep_their_places_and_order() {
        let text = "z = -0.0\na = [1, 2.5]\n[t]\nx = \"y\"\n[[l]]\n[[l]]\nk = 0x10\n";
        let (table, findings) = tree(text);
        assert_eq!(findings, "");
        let keys: Vec<&str> = table.entries.iter().map(|e| e.key.as_str()).collect();
        assert_eq!(keys, ["z", "a", "t", "l"]);
        assert!(table.number("z").unwrap().is_sign_positive());
        assert_eq!(table.get("a").unwrap().numbers(), Some(vec![1.0, 2.5]));
        let (y, place) = table.table("t").unwrap().text("x").unwrap();
        assert_eq!((y, &text[place.start..place.end]), ("y", "\"y\""));
        let places: Vec<&str> = table.tables("l").map(|(_, s)| &text[s.start..s.end]).collect();
        assert_eq!(places, ["[[l]]", "[[l]]"]);
        assert_eq!(table.list("l")[1].table().unwrap().get("k").unwrap().integer(), Some(16));
    }

    #[test]
    fn all_syntax_errors_are_found() {
        let (table, findings) = tree("a = \nb = 1\nc = = 2\nb = 3\nd = 99999999999999999999\n");
        assert_eq!(findings.lines().count(), 4, "{findings}");
        assert_eq!(table.get("b").unwrap().integer(), Some(1));
    }
}
