//! Parameters of artefact kinds: what a kind declares, and what a specification sets.

use std::collections::BTreeMap;

use super::schema::Range;

/// The parameters of all artefact kinds, as the kinds declare them.
#[derive(Debug, Clone, Default)]
pub struct ParameterTable {
    /// Each kind once, in the order in which documentation lists them.
    pub kinds: Vec<KindParameters>,
}

/// The parameters of one artefact kind.
#[derive(Debug, Clone, Copy)]
pub struct KindParameters {
    /// Name of the kind, as in `[parameters.NAME]`.
    pub kind: &'static str,
    /// One line.
    pub doc: &'static str,
    /// Its parameters.
    pub parameters: &'static [Parameter],
}

/// A parameter of an artefact kind.
#[derive(Debug, Clone, Copy)]
pub struct Parameter {
    /// Its key.
    pub name: &'static str,
    /// What values it takes.
    pub kind: ParameterKind,
    /// What holds when it is not set.
    pub default: ParameterDefault,
    /// Unit, or empty.
    pub unit: &'static str,
    /// A sentence or two.
    pub doc: &'static str,
}

/// What values a parameter takes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ParameterKind {
    /// A finite number.
    Number(Range),
    /// A whole number, bounds included.
    Integer(i64, i64),
    /// One of these words.
    Text(&'static [&'static str]),
    /// `true` or `false`.
    Bool,
}

/// What holds when a parameter is not set.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ParameterDefault {
    /// A number.
    Number(f64),
    /// A whole number.
    Integer(i64),
    /// A word.
    Text(&'static str),
    /// `true` or `false`.
    Bool(bool),
    /// The kind works it out from the model; says how.
    Automatic(&'static str),
}

/// A value set in a specification.
#[derive(Debug, Clone, PartialEq)]
pub enum ParameterValue {
    /// A number.
    Number(f64),
    /// A whole number.
    Integer(i64),
    /// A word.
    Text(String),
    /// `true` or `false`.
    Bool(bool),
}

/// What a specification sets: kind, then parameter, then value. Every entry is declared and in range.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Parameters {
    /// Kind name to parameter name to value.
    pub kinds: BTreeMap<String, BTreeMap<String, ParameterValue>>,
}

impl ParameterTable {
    /// The parameters of a kind, or `None` if there is no such kind.
    pub fn kind(&self, name: &str) -> Option<&KindParameters> {
        self.kinds.iter().find(|k| k.kind == name)
    }
}

impl KindParameters {
    /// The parameter of this name.
    pub fn parameter(&self, name: &str) -> Option<&'static Parameter> {
        self.parameters.iter().find(|p| p.name == name)
    }
}

impl Parameters {
    /// The value set for a parameter.
    pub fn get(&self, kind: &str, name: &str) -> Option<&ParameterValue> {
        self.kinds.get(kind)?.get(name)
    }

    /// Sets a value.
    pub fn set(&mut self, kind: &str, name: &str, value: ParameterValue) {
        self.kinds.entry(kind.to_owned()).or_default().insert(name.to_owned(), value);
    }

    /// These parameters, with those of `over` taking precedence one by one.
    pub fn overlaid(&self, over: &Self) -> Self {
        let mut result = self.clone();
        for (kind, values) in &over.kinds {
            let target = result.kinds.entry(kind.clone()).or_default();
            target.extend(values.iter().map(|(name, value)| (name.clone(), value.clone())));
        }
        result
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_overlay_changes_only_what_it_names() {
        let mut robot = Parameters::default();
        robot.set("grasp_set", "rolls", ParameterValue::Integer(8));
        robot.set("grasp_set", "friction", ParameterValue::Number(0.4));
        let mut task = Parameters::default();
        task.set("grasp_set", "rolls", ParameterValue::Integer(4));
        task.set("reachability", "step", ParameterValue::Number(0.04));
        let both = robot.overlaid(&task);
        assert_eq!(both.get("grasp_set", "rolls"), Some(&ParameterValue::Integer(4)));
        assert_eq!(both.get("grasp_set", "friction"), Some(&ParameterValue::Number(0.4)));
        assert_eq!(both.get("reachability", "step"), Some(&ParameterValue::Number(0.04)));
        assert_eq!(both.get("reachability", "rolls"), None);
    }
}
