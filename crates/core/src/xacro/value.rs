//! Values of xacro expressions: the part of Python's that descriptions use.

use std::collections::BTreeMap;
use std::fmt;

/// A value. Whole and broken numbers are told apart because `${2}` and `${2.0}` print differently.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Value {
    None,
    Bool(bool),
    Int(i64),
    Float(f64),
    Text(String),
    List(Vec<Value>),
    Dict(BTreeMap<String, Value>),
}

impl Value {
    /// What a property or argument written as `text` is: a number or a truth value if it looks like one, else text.
    pub(super) fn from_text(text: &str) -> Self {
        let trimmed = text.trim();
        if let [b'\'', .., b'\''] = trimmed.as_bytes() {
            return Self::Text(trimmed[1..trimmed.len() - 1].to_owned());
        }
        if let Ok(int) = trimmed.parse() {
            return Self::Int(int);
        }
        // Rust reads `inf` and `nan` as numbers; in a description they are names.
        if let Ok(float) = trimmed.parse::<f64>()
            && float.is_finite()
        {
            return Self::Float(float);
        }
        match trimmed {
            "true" | "True" => Self::Bool(true),
            "false" | "False" => Self::Bool(false),
            _ => Self::Text(text.to_owned()),
        }
    }

    /// The value of a YAML document.
    pub(super) fn from_json(json: &serde_json::Value) -> Self {
        match json {
            serde_json::Value::Null => Self::None,
            serde_json::Value::Bool(b) => Self::Bool(*b),
            serde_json::Value::Number(n) => match n.as_i64() {
                Some(int) => Self::Int(int),
                None => Self::Float(n.as_f64().unwrap_or(0.0)),
            },
            serde_json::Value::String(text) => Self::Text(text.clone()),
            serde_json::Value::Array(items) => Self::List(items.iter().map(Self::from_json).collect()),
            serde_json::Value::Object(entries) => {
                Self::Dict(entries.iter().map(|(k, v)| (k.clone(), Self::from_json(v))).collect())
            }
        }
    }

    /// About how many bytes it takes.
    pub(super) fn size(&self) -> usize {
        const OWN: usize = size_of::<Value>();
        match self {
            Self::None | Self::Bool(_) | Self::Int(_) | Self::Float(_) => OWN,
            Self::Text(text) => OWN + text.len(),
            Self::List(items) => OWN + items.iter().map(Self::size).sum::<usize>(),
            Self::Dict(entries) => OWN + entries.iter().map(|(k, v)| OWN + k.len() + v.size()).sum::<usize>(),
        }
    }

    /// What kind of value this is, for messages.
    pub(super) fn kind(&self) -> &'static str {
        match self {
            Self::None => "None",
            Self::Bool(_) => "a truth value",
            Self::Int(_) | Self::Float(_) => "a number",
            Self::Text(_) => "text",
            Self::List(_) => "a list",
            Self::Dict(_) => "a table",
        }
    }

    /// The number this is; truth values count as 1 and 0.
    pub(super) fn number(&self) -> Result<f64, String> {
        match self {
            Self::Bool(b) => Ok(f64::from(u8::from(*b))),
            Self::Int(i) => Ok(*i as f64),
            Self::Float(x) => Ok(*x),
            Self::Text(text) => Err(format!("`{text}` is not a number")),
            other => Err(format!("{} is not a number", other.kind())),
        }
    }

    /// Python's idea of truth: zero and empty things are false.
    pub(super) fn is_true(&self) -> bool {
        match self {
            Self::None => false,
            Self::Bool(b) => *b,
            Self::Int(i) => *i != 0,
            Self::Float(x) => *x != 0.0,
            Self::Text(text) => !text.is_empty(),
            Self::List(items) => !items.is_empty(),
            Self::Dict(entries) => !entries.is_empty(),
        }
    }

    /// xacro's idea of a condition: a truth value, a number, or text that spells one.
    pub(super) fn condition(&self) -> Result<bool, String> {
        match self {
            Self::Text(text) => match Self::from_text(text) {
                Self::Text(_) => Err(format!("`{text}` is neither true nor false")),
                value => value.condition(),
            },
            Self::Bool(_) | Self::Int(_) | Self::Float(_) => Ok(self.is_true()),
            other => Err(format!("{} is neither true nor false", other.kind())),
        }
    }
}

impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::None => f.write_str("None"),
            Self::Bool(true) => f.write_str("True"),
            Self::Bool(false) => f.write_str("False"),
            Self::Int(i) => write!(f, "{i}"),
            // The debug form keeps `.0` on whole numbers, as Python does.
            Self::Float(x) => write!(f, "{x:?}"),
            Self::Text(text) => f.write_str(text),
            Self::List(items) => {
                let words: Vec<String> = items.iter().map(Self::quoted).collect();
                write!(f, "[{}]", words.join(", "))
            }
            Self::Dict(entries) => {
                let words: Vec<String> =
                    entries.iter().map(|(k, v)| format!("'{k}': {}", v.quoted())).collect();
                write!(f, "{{{}}}", words.join(", "))
            }
        }
    }
}

impl Value {
    fn quoted(&self) -> String {
        match self {
            Self::Text(text) => format!("'{text}'"),
            other => other.to_string(),
        }
    }
}
