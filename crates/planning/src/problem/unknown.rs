//! Keys of a document that nothing reads.
//!
//! Documents are exchanged between planners and versions, and a planner ignores what it does not know (thesis appendix A). So that a slip of the
//! pen is seen all the same, such keys can be asked for.

use std::fmt;

use robotc_core::diag::nearest;
use serde::Serialize;
use serde_json::Value;

/// A key that is ignored.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct UnknownKey {
    /// Where it is: names and positions from the outside in, joined by dots.
    pub path: String,
    /// The known key at this place that it looks like.
    pub meant: Option<String>,
}

impl fmt::Display for UnknownKey {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "`{}` is not known, and ignored", self.path)?;
        self.meant.as_ref().map_or(Ok(()), |meant| write!(f, "; did you mean `{meant}`?"))
    }
}

/// The keys of the JSON `text` that were lost when `known` was read from it, in the order of the text's keys by name. `known` has to write all
/// its keys out.
pub fn unknown_keys(text: &str, known: &impl Serialize) -> Vec<UnknownKey> {
    let mut found = Vec::new();
    if let (Ok(given), Ok(known)) = (serde_json::from_str(text), serde_json::to_value(known)) {
        compare(&given, &known, "", &mut found);
    }
    found
}

fn compare(given: &Value, known: &Value, path: &str, found: &mut Vec<UnknownKey>) {
    match (given, known) {
        (Value::Object(given), Value::Object(known)) => {
            for (key, value) in given {
                let path = if path.is_empty() { key.clone() } else { format!("{path}.{key}") };
                match known.get(key) {
                    Some(read) => compare(value, read, &path, found),
                    None => {
                        let others = known.keys().filter(|other| !given.contains_key(*other));
                        let meant = nearest(key, others.map(String::as_str)).map(str::to_owned);
                        found.push(UnknownKey { path, meant });
                    }
                }
            }
        }
        (Value::Array(given), Value::Array(known)) => {
            for (i, (value, read)) in given.iter().zip(known).enumerate() {
                compare(value, read, &format!("{path}.{i}"), found);
            }
        }
        _ => {}
    }
}
