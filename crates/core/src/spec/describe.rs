//! What is expected, in words.

use super::parameters::{Parameter, ParameterKind};
use super::schema::{Kind, Length};

/// The kind of value that a parameter takes.
pub(super) fn value_kind(parameter: &Parameter) -> Kind {
    match parameter.kind {
        ParameterKind::Number(range) => Kind::Number(range),
        ParameterKind::Integer(min, max) => Kind::Integer(min, max),
        ParameterKind::Text(words) => Kind::Choice(words),
        ParameterKind::Bool => Kind::Bool,
    }
}

/// What is expected, in words.
pub(super) fn describe(kind: Kind) -> String {
    match kind {
        Kind::Bool => "true or false".to_owned(),
        Kind::Integer(min, max) => integers(min, max),
        Kind::Number(range) => match range.describe() {
            None => "a finite number".to_owned(),
            Some(words) => format!("a number {words}"),
        },
        Kind::Text(text) => text.describe().to_owned(),
        Kind::Choice(words) => format!("one of {}", quoted(words)),
        Kind::List(item, length) => describe_list(*item, length),
        Kind::Table(_) => "a table".to_owned(),
        Kind::Tables(..) => "tables".to_owned(),
        Kind::Map(key, value) => format!("a table from {} to {}", key.describe(), describe(*value)),
        Kind::Parameters => "a table for each artefact kind".to_owned(),
    }
}

pub(super) fn describe_list(item: Kind, length: Length) -> String {
    let items = match item {
        Kind::Number(range) => match range.describe() {
            None => "finite numbers".to_owned(),
            Some(words) => format!("numbers {words}"),
        },
        Kind::Integer(..) => format!("values, each {}", describe(item)),
        Kind::Text(text) => {
            format!("{}s", text.describe().trim_start_matches("a ").trim_start_matches("an "))
        }
        _ => format!("values, each {}", describe(item)),
    };
    match length {
        Length::Any => format!("a list of {items}"),
        Length::Exactly(n) => format!("a list of {n} {items}"),
        Length::AtLeast(n) => format!("a list of {n} or more {items}"),
    }
}

pub(super) fn integers(min: i64, max: i64) -> String {
    match (min, max) {
        _ if min == max => format!("the integer {min}"),
        (min, i64::MAX) => format!("an integer from {min}"),
        _ => format!("an integer from {min} to {max}"),
    }
}

/// `n` things, in the singular or plural.
pub(super) fn count(n: usize, thing: &str) -> String {
    format!("{n} {thing}{}", if n == 1 { "" } else { "s" })
}

/// Words in back quotes, separated by commas.
pub(super) fn listed<'a>(words: impl IntoIterator<Item = &'a str>) -> String {
    words.into_iter().map(|word| format!("`{word}`")).collect::<Vec<_>>().join(", ")
}

pub(super) fn quoted(words: &[&str]) -> String {
    words.iter().map(|word| format!("{word:?}")).collect::<Vec<_>>().join(", ")
}

/// The first sentence of a doc, as a hint.
pub(super) fn first_sentence(doc: &str) -> String {
    let end = doc.find(". ").or_else(|| doc.rfind('.')).unwrap_or(doc.len());
    let mut letters = doc[..end].chars();
    // Hints begin in lower case, unless the first word is an abbreviation.
    match letters.next() {
        Some(first) if letters.clone().next().is_some_and(char::is_lowercase) => {
            first.to_lowercase().chain(letters).collect()
        }
        _ => doc[..end].to_owned(),
    }
}
