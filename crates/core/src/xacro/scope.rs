//! What names mean at one point of an expansion.

use std::collections::BTreeMap;
use std::rc::Rc;

use super::value::Value;
use crate::xml::{Element, Node};

/// A property.
#[derive(Debug, Clone)]
pub(super) enum Property {
    /// Text as written; its value is worked out when it is first used.
    Written(String),
    /// Being worked out: met again, it depends on itself.
    Pending,
    /// A value.
    Value(Value),
}

/// A parameter of a macro.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Parameter {
    /// `name`, `name:=default`, `name:=^`, `name:=^|default`.
    Value {
        name: String,
        /// Whether a property of that name outside of the macro comes before the default.
        inherits: bool,
        default: Option<String>,
    },
    /// `*name`: an element.
    Element(String),
    /// `**name`: what is in an element.
    Content(String),
}

/// A macro.
#[derive(Debug)]
pub(super) struct Macro {
    pub(super) parameters: Vec<Parameter>,
    pub(super) body: Element,
    /// Folder and file of the definition: what its relative paths start from.
    pub(super) file: std::path::PathBuf,
}

/// Names of one macro call, or of the file itself.
#[derive(Debug, Default)]
pub(super) struct Scope {
    pub(super) properties: BTreeMap<String, Property>,
    pub(super) blocks: BTreeMap<String, Rc<Vec<Node>>>,
}

/// The parameters that a `params` attribute lists.
pub(super) fn parameters(text: &str) -> Result<Vec<Parameter>, String> {
    let mut found = Vec::new();
    let mut rest = text.trim_start();
    while !rest.is_empty() {
        let length = rest.find(|c: char| c.is_whitespace() || c == ':' || c == '=').unwrap_or(rest.len());
        let name = &rest[..length];
        rest = &rest[length..];
        let default = match rest.strip_prefix(":=").or_else(|| rest.strip_prefix('=')) {
            Some(after) => {
                let (default, after) = default(after)?;
                rest = after;
                Some(default)
            }
            None => None,
        };
        rest = rest.trim_start();
        if name.trim_matches('*').is_empty() {
            return Err(format!("`{text}` is no list of parameters"));
        }
        found.push(match (name.strip_prefix("**"), name.strip_prefix('*')) {
            (Some(name), _) => Parameter::Content(name.to_owned()),
            (None, Some(name)) => Parameter::Element(name.to_owned()),
            (None, None) => {
                let inherits = default.as_ref().is_some_and(|d| d.starts_with('^'));
                let default = match default {
                    Some(d) if inherits => d.strip_prefix("^|").map(unquoted),
                    Some(d) => Some(unquoted(&d)),
                    None => None,
                };
                Parameter::Value { name: name.to_owned(), inherits, default }
            }
        });
    }
    Ok(found)
}

/// The default that starts `text`, with its quotes, and what comes after it. Spaces end it, unless they are in quotes or
/// in `${...}`.
fn default(text: &str) -> Result<(String, &str), String> {
    let mut quote = None;
    let mut braces = 0_usize;
    for (at, c) in text.char_indices() {
        match quote {
            Some(open) if c == open => quote = None,
            Some(_) => {}
            None if c == '\'' || c == '"' => quote = Some(c),
            None if c == '{' => braces += 1,
            None if c == '}' => braces = braces.saturating_sub(1),
            None if c.is_whitespace() && braces == 0 => return Ok((text[..at].to_owned(), &text[at..])),
            None => {}
        }
    }
    if quote.is_some() {
        Err("a default without closing quote".to_owned())
    } else {
        Ok((text.to_owned(), ""))
    }
}

fn unquoted(text: impl AsRef<str>) -> String {
    let text = text.as_ref();
    match text.as_bytes() {
        [b'\'', .., b'\''] | [b'"', .., b'"'] => text[1..text.len() - 1].to_owned(),
        _ => text.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parameter_lists() {
        let value = |name: &str, inherits, default: Option<&str>| Parameter::Value {
            name: name.to_owned(),
            inherits,
            default: default.map(str::to_owned),
        };
        let found = parameters(" a b:=1 c:='x y' d:=^ e:=^|2 f:=${1 + 2} *g **h i=''").unwrap();
        let expected = [
            value("a", false, None),
            value("b", false, Some("1")),
            value("c", false, Some("x y")),
            value("d", true, None),
            value("e", true, Some("2")),
            value("f", false, Some("${1 + 2}")),
            Parameter::Element("g".to_owned()),
            Parameter::Content("h".to_owned()),
            value("i", false, Some("")),
        ];
        assert_eq!(found, expected);
        assert!(parameters("a:='open").is_err() && parameters(":=1").is_err());
    }
}
