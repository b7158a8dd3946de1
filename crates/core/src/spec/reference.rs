//! The reference of all keys, as Markdown.

use super::SpecKind;
use super::describe::describe;
use super::schema::{Key, Kind, Presence, TableSchema};

/// A Markdown section for each table of the format, with one row for each key.
pub fn reference(kind: SpecKind) -> String {
    let mut text = String::new();
    section("", kind.schema(), &mut text);
    text
}

fn section(heading: &str, schema: &TableSchema, text: &mut String) {
    if !heading.is_empty() {
        *text += &format!("\n### `{heading}`\n\n");
    }
    *text += schema.doc;
    *text += "\n\n| key | value | default | meaning |\n|---|---|---|---|\n";
    for key in schema.keys {
        *text += &row(key);
    }
    let path = heading.trim_matches(['[', ']']);
    for key in schema.keys {
        let below = if path.is_empty() { key.name.to_owned() } else { format!("{path}.{}", key.name) };
        match key.kind {
            // Poses are explained once, in the text of the guide.
            Kind::Table(table) if !std::ptr::eq(table, &super::schema::POSE) => {
                section(&format!("[{below}]"), table, text);
            }
            Kind::Tables(table, _) => section(&format!("[[{below}]]"), table, text),
            Kind::Map(_, Kind::Table(table)) => section(&format!("[{below}.NAME]"), table, text),
            _ => {}
        }
    }
}

fn row(key: &Key) -> String {
    let value = match key.kind {
        Kind::Table(table) if std::ptr::eq(table, &super::schema::POSE) => "a pose".to_owned(),
        kind => describe(kind),
    };
    let unit = if key.unit.is_empty() { String::new() } else { format!(", {}", key.unit) };
    let default = match key.presence {
        Presence::Required => "required".to_owned(),
        Presence::Optional => String::new(),
        Presence::Default(value) => format!("`{value}`"),
    };
    format!("| `{}` | {value}{unit} | {default} | {} |\n", key.name, key.doc)
}
