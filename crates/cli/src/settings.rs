//! Parameters that are set on the command line.

use std::str::FromStr;

use clap::Args;
use robotc_core::spec::{ParameterValue, Parameters};

/// Parameters of artefacts, set over what the specifications say.
#[derive(Args, Clone, Default)]
pub(crate) struct Settings {
    /// Set a parameter of artefacts, such as grasp_set.rolls=16; may be given several times
    #[arg(long = "set", value_name = "KIND.NAME=VALUE")]
    all: Vec<Setting>,
}

impl Settings {
    /// Sets them. What is unknown or out of range is found when artefacts are planned.
    pub(crate) fn apply(&self, parameters: &mut Parameters) {
        for Setting { kind, name, value, text: _ } in &self.all {
            parameters.set(kind, name, value.clone());
        }
    }

    /// The same on another command line.
    pub(crate) fn words(&self) -> impl Iterator<Item = String> + '_ {
        self.all.iter().map(|setting| setting.text.clone())
    }
}

#[derive(Debug, Clone, PartialEq)]
struct Setting {
    /// As it was given.
    text: String,
    kind: String,
    name: String,
    value: ParameterValue,
}

/// From `kind.name=value`; the value is read as in TOML, and is a text when it is nothing else.
impl FromStr for Setting {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        const EXPECTED: &str = "expected KIND.NAME=VALUE, such as grasp_set.rolls=16";
        let (place, value) = text.split_once('=').ok_or(EXPECTED)?;
        let (kind, name) = place.split_once('.').ok_or(EXPECTED)?;
        let [kind, name, value] = [kind, name, value].map(str::trim);
        if [kind, name, value].contains(&"") {
            return Err(EXPECTED);
        }
        let value = match (value.parse::<bool>(), value.parse::<i64>(), value.parse::<f64>()) {
            (Ok(yes), _, _) => ParameterValue::Bool(yes),
            (_, Ok(whole), _) => ParameterValue::Integer(whole),
            (_, _, Ok(number)) => ParameterValue::Number(number),
            _ => ParameterValue::Text(value.to_owned()),
        };
        let text = text.to_owned();
        Ok(Self { text, kind: kind.to_owned(), name: name.to_owned(), value })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_are_read() {
        for (text, value) in [
            ("grasp_set.rolls=16", ParameterValue::Integer(16)),
            ("grasp_set.rolls = 0.5", ParameterValue::Number(0.5)),
            ("grasp_set.rolls=true", ParameterValue::Bool(true)),
            ("grasp_set.rolls=many", ParameterValue::Text("many".into())),
        ] {
            let setting: Setting = text.parse().unwrap();
            assert_eq!((setting.kind.as_str(), setting.name.as_str()), ("grasp_set", "rolls"));
            assert_eq!(setting.value, value);
        }
        for wrong in ["", "rolls=16", "grasp_set.rolls", "grasp_set.=3", ".rolls=3", "grasp_set.rolls="] {
            assert!(wrong.parse::<Setting>().is_err(), "{wrong}");
        }
    }
}
