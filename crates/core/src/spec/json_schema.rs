//! JSON Schema (draft 2020-12) of the specification formats, for editors.

use serde_json::{Map, Value, json};

use super::describe::value_kind;
use super::document;
use super::parameters::{ParameterDefault, ParameterTable};
use super::schema::{Key, Kind, Length, Presence, Range, Rule, TableSchema};
use super::{SpecKind, SpecKind::*};
use crate::diag::{Diagnostics, Sources};

/// JSON Schema of a specification format, with the parameters of all artefact kinds of `parameters`.
pub fn json_schema(kind: SpecKind, parameters: &ParameterTable) -> String {
    let mut root = table(kind.schema(), parameters);
    let title = match kind {
        Robot => "robotc robot specification",
        Task => "robotc task specification",
    };
    root.insert("$schema".to_owned(), json!("https://json-schema.org/draft/2020-12/schema"));
    root.insert("title".to_owned(), json!(title));
    let mut text = serde_json::to_string_pretty(&Value::Object(root)).expect("a JSON value has a text");
    text.push('\n');
    text
}

fn table(schema: &TableSchema, parameters: &ParameterTable) -> Map<String, Value> {
    let mut properties = Map::new();
    for key in schema.keys {
        properties.insert(key.name.to_owned(), property(key, parameters));
    }
    let required: Vec<&str> =
        schema.keys.iter().filter(|k| k.presence == Presence::Required).map(|k| k.name).collect();
    let mut object = closed_object(schema.doc, properties);
    if !required.is_empty() {
        object.insert("required".to_owned(), json!(required));
    }
    let rules: Vec<Value> = schema.rules.iter().map(rule).collect();
    if !rules.is_empty() {
        object.insert("allOf".to_owned(), json!(rules));
    }
    object
}

fn closed_object(doc: &str, properties: Map<String, Value>) -> Map<String, Value> {
    let mut object = Map::new();
    object.insert("type".to_owned(), json!("object"));
    object.insert("description".to_owned(), json!(doc));
    object.insert("properties".to_owned(), Value::Object(properties));
    object.insert("additionalProperties".to_owned(), json!(false));
    object
}

fn rule(rule: &Rule) -> Value {
    match rule {
        Rule::ExactlyOne(keys) => {
            let choices: Vec<Value> = keys.iter().map(|key| json!({ "required": [key] })).collect();
            json!({ "oneOf": choices })
        }
        Rule::OneWith { keys, with } => {
            let choices: Vec<Value> = keys.iter().map(|key| json!({ "required": [key] })).collect();
            let none: Map<String, Value> = keys.iter().map(|key| ((*key).to_owned(), json!(false))).collect();
            json!({ "if": { "required": [with] }, "then": { "oneOf": choices }, "else": { "properties": none } })
        }
        Rule::OnlyWith { keys, with } => {
            let dependent: Map<String, Value> =
                keys.iter().map(|key| ((*key).to_owned(), json!([with]))).collect();
            json!({ "dependentRequired": dependent })
        }
        Rule::Goes { key, value, then } => {
            let applies = json!({ "properties": { *key: { "const": value } }, "required": [key] });
            json!({ "if": applies, "then": { "required": [then] }, "else": { "properties": { *then: false } } })
        }
        Rule::Unless { key, value, needed, allowed } => {
            let applies = json!({ "properties": { *key: { "const": value } }, "required": [key] });
            let none: Map<String, Value> =
                needed.iter().chain(*allowed).map(|key| ((*key).to_owned(), json!(false))).collect();
            json!({ "if": applies, "then": { "properties": none }, "else": { "required": needed } })
        }
    }
}

fn property(key: &Key, parameters: &ParameterTable) -> Value {
    let mut value = kind(key.kind, parameters);
    let unit = if key.unit.is_empty() { String::new() } else { format!(" Unit: {}.", key.unit) };
    value.insert("description".to_owned(), json!(format!("{}{unit}", key.doc)));
    if let Presence::Default(text) = key.presence {
        value.insert("default".to_owned(), default_value(text));
    }
    Value::Object(value)
}

fn kind(of: Kind, parameters: &ParameterTable) -> Map<String, Value> {
    let value = match of {
        Kind::Bool => json!({ "type": "boolean" }),
        Kind::Integer(min, max) => {
            let mut value = json!({ "type": "integer", "minimum": min });
            if max < i64::MAX {
                value["maximum"] = json!(max);
            }
            value
        }
        Kind::Number(range) => number(range),
        Kind::Text(text) => json!({ "type": "string", "pattern": text.pattern() }),
        Kind::Choice(words) => json!({ "enum": words }),
        Kind::List(item, length) => {
            let mut value = json!({ "type": "array", "items": kind(*item, parameters) });
            match length {
                Length::Any => {}
                Length::Exactly(n) => {
                    value["minItems"] = json!(n);
                    value["maxItems"] = json!(n);
                }
                Length::AtLeast(n) => value["minItems"] = json!(n),
            }
            value
        }
        Kind::Table(schema) => return table(schema, parameters),
        Kind::Tables(schema, _) => json!({ "type": "array", "items": table(schema, parameters) }),
        Kind::Map(_, value) => {
            json!({ "type": "object", "additionalProperties": kind(*value, parameters) })
        }
        Kind::Parameters => return kinds(parameters),
    };
    match value {
        Value::Object(map) => map,
        _ => unreachable!("every kind gives an object"),
    }
}

fn number(range: Range) -> Value {
    let mut value = json!({ "type": "number" });
    if range.min.is_finite() {
        value[if range.above_min { "exclusiveMinimum" } else { "minimum" }] = json!(range.min);
    }
    if range.max.is_finite() {
        value["maximum"] = json!(range.max);
    }
    value
}

fn kinds(parameters: &ParameterTable) -> Map<String, Value> {
    let mut properties = Map::new();
    for of_kind in &parameters.kinds {
        let mut values = Map::new();
        for parameter in of_kind.parameters {
            let mut value = kind(value_kind(parameter), parameters);
            let (default, note) = match parameter.default {
                ParameterDefault::Number(x) => (Some(json!(x)), String::new()),
                ParameterDefault::Integer(i) => (Some(json!(i)), String::new()),
                ParameterDefault::Text(word) => (Some(json!(word)), String::new()),
                ParameterDefault::Bool(b) => (Some(json!(b)), String::new()),
                ParameterDefault::Automatic(how) => (None, format!(" Default: {how}.")),
            };
            let unit =
                if parameter.unit.is_empty() { String::new() } else { format!(" Unit: {}.", parameter.unit) };
            value.insert("description".to_owned(), json!(format!("{}{unit}{note}", parameter.doc.trim())));
            if let Some(default) = default {
                value.insert("default".to_owned(), default);
            }
            values.insert(parameter.name.to_owned(), Value::Object(value));
        }
        properties.insert(of_kind.kind.to_owned(), Value::Object(closed_object(of_kind.doc, values)));
    }
    closed_object("Parameters of artefact kinds.", properties)
}

/// A TOML value of a schema as JSON.
fn default_value(text: &str) -> Value {
    let mut sources = Sources::new();
    let file = sources.add("default", format!("value = {text}"));
    let mut diagnostics = Diagnostics::new();
    let table = document::parse(&sources, file, &mut diagnostics);
    assert!(!diagnostics.has_errors(), "a default of a schema is TOML: {text}");
    table.get("value").map(to_json).expect("a default of a schema is a value")
}

fn to_json(node: &document::Node) -> Value {
    match &node.value {
        document::Value::Bool(b) => json!(b),
        document::Value::Integer(i) => json!(i),
        document::Value::Float(x) => json!(x),
        document::Value::Text(text) => json!(text),
        document::Value::Date | document::Value::Unreadable => Value::Null,
        document::Value::List(items) => Value::Array(items.iter().map(to_json).collect()),
        document::Value::Table(table) => {
            Value::Object(table.entries.iter().map(|e| (e.key.clone(), to_json(&e.node))).collect())
        }
    }
}
