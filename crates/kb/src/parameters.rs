//! Parameters of artefact kinds: a typed struct together with the table that specifications are checked against.

use robotc_core::spec::{Parameter, ParameterKind, ParameterValue};
use thiserror::Error;

use crate::key::{Canonical, KeyHasher};

pub use robotc_core::spec::Parameters as Given;

impl Canonical for ParameterValue {
    fn write(&self, out: &mut KeyHasher) {
        match self {
            Self::Number(x) => x.write(out),
            Self::Integer(x) => (x.unsigned_abs(), *x < 0).write(out),
            Self::Bool(x) => x.write(out),
            Self::Text(x) => x.write(out),
        }
    }
}

/// A parameter value in words.
pub fn show(value: &ParameterValue) -> String {
    match value {
        ParameterValue::Number(x) => x.to_string(),
        ParameterValue::Integer(x) => x.to_string(),
        ParameterValue::Bool(x) => x.to_string(),
        ParameterValue::Text(x) => x.clone(),
    }
}

/// Why a parameter was refused. Specifications are checked against the same tables, with places; this is for values
/// that come another way.
#[derive(Debug, Clone, Error, PartialEq)]
pub enum ParameterError {
    /// No kind has this name.
    #[error("there is no artefact kind `{0}`")]
    UnknownKind(String),
    /// The kind has no such parameter.
    #[error("`{kind}` has no parameter `{name}`")]
    Unknown {
        /// The kind.
        kind: String,
        /// The name given.
        name: String,
    },
    /// The value has another type or is out of range.
    #[error("parameter `{name}` of `{kind}` cannot be {value}: {expected}")]
    Refused {
        /// The kind.
        kind: String,
        /// The parameter.
        name: String,
        /// The value given.
        value: String,
        /// What would have been right.
        expected: String,
    },
}

/// The largest of ... 0.1, 0.2, 0.5, 1, 2, 5 ... that is not above `x`: steps for defaults that follow from a measure, so
/// that they look familiar and small edits of the measure change nothing. Zero for what is not positive.
pub fn round_step(x: f64) -> f64 {
    if !(x.is_finite() && x > 0.0) {
        return 0.0;
    }
    let exponent = libm::floor(libm::log10(x)) as i32;
    // Decimal fractions as the parser reads them: the same everywhere, and what people type.
    let step = |digit: u32, exponent: i32| format!("{digit}e{exponent}").parse().unwrap_or(0.0);
    let steps = [(5, exponent), (2, exponent), (1, exponent), (5, exponent - 1)];
    steps.into_iter().map(|(digit, exponent)| step(digit, exponent)).find(|s| *s <= x).unwrap_or(0.0)
}

/// A type that a parameter can have.
pub trait ParameterType: Sized {
    /// The value as specifications write it.
    fn to_value(&self) -> ParameterValue;
    /// The value as specifications write it; `None` when it has another type.
    fn from_value(value: &ParameterValue) -> Option<Self>;
}

impl ParameterType for f64 {
    fn to_value(&self) -> ParameterValue {
        ParameterValue::Number(*self)
    }
    fn from_value(value: &ParameterValue) -> Option<Self> {
        match *value {
            ParameterValue::Number(x) => Some(x),
            ParameterValue::Integer(x) => Some(x as f64),
            _ => None,
        }
    }
}

impl ParameterType for u32 {
    fn to_value(&self) -> ParameterValue {
        ParameterValue::Integer(i64::from(*self))
    }
    fn from_value(value: &ParameterValue) -> Option<Self> {
        match *value {
            ParameterValue::Integer(x) => x.try_into().ok(),
            _ => None,
        }
    }
}

impl ParameterType for bool {
    fn to_value(&self) -> ParameterValue {
        ParameterValue::Bool(*self)
    }
    fn from_value(value: &ParameterValue) -> Option<Self> {
        match *value {
            ParameterValue::Bool(x) => Some(x),
            _ => None,
        }
    }
}

/// The parameters of a kind; implemented by the [`parameters!`](crate::parameters!) macro.
pub trait Parameters: Clone + Send + Sync + 'static {
    /// Names, units, ranges, defaults and docs, in the order of the fields.
    const TABLE: &'static [Parameter];

    /// All values, in the order of the table.
    fn values(&self) -> Vec<ParameterValue>;

    /// Sets one value; `kind` is for the message.
    fn set(&mut self, kind: &str, name: &str, value: &ParameterValue) -> Result<(), ParameterError>;
}

/// The parameters of a kind that has none.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct NoParameters;

impl Parameters for NoParameters {
    const TABLE: &'static [Parameter] = &[];

    fn values(&self) -> Vec<ParameterValue> {
        Vec::new()
    }

    fn set(&mut self, kind: &str, name: &str, _value: &ParameterValue) -> Result<(), ParameterError> {
        Err(ParameterError::Unknown { kind: kind.to_owned(), name: name.to_owned() })
    }
}

/// Checks a value against a table; for `set`.
pub fn check(
    table: &'static [Parameter],
    kind: &str,
    name: &str,
    value: &ParameterValue,
) -> Result<(), ParameterError> {
    let (kind, name) = (kind.to_owned(), name.to_owned());
    let Some(info) = table.iter().find(|info| info.name == name) else {
        return Err(ParameterError::Unknown { kind, name });
    };
    let number = match *value {
        ParameterValue::Number(x) => Some(x),
        ParameterValue::Integer(x) => Some(x as f64),
        _ => None,
    };
    let (accepted, expected) = match info.kind {
        ParameterKind::Number(range) => (
            number.is_some_and(|x| range.contains(x)),
            format!("a number {}", range.describe().unwrap_or_default()),
        ),
        ParameterKind::Integer(low, high) => (
            matches!(value, ParameterValue::Integer(x) if (low..=high).contains(x)),
            format!("a whole number from {low} to {high}"),
        ),
        ParameterKind::Bool => (matches!(value, ParameterValue::Bool(_)), "true or false".to_owned()),
        ParameterKind::Text(words) => (
            matches!(value, ParameterValue::Text(x) if words.contains(&x.as_str())),
            format!("one of {}", words.join(", ")),
        ),
    };
    if accepted { Ok(()) } else { Err(ParameterError::Refused { kind, name, value: show(value), expected }) }
}

/// Declares the parameters of a kind: struct, table and constant defaults in one place.
///
/// A field is `name: type ["unit"] in low..=high = default`, with type `f64` or `u32`, or `name: bool = default`.
/// The default `auto "how"` says that the kind works it out; in `constants()` such a field is zero.
///
/// ```
/// robotc_kb::parameters! {
///     /// Parameters of an example.
///     pub struct Example {
///         /// Coulomb friction between finger and object.
///         friction: f64 [""] in 0.0..=10.0 = auto "that of the object";
///         /// Rolls about the approach direction.
///         rolls: u32 [""] in 1..=360 = 8;
///     }
/// }
/// use robotc_kb::parameters::Parameters;
/// assert_eq!(Example::TABLE[1].name, "rolls");
/// assert_eq!(Example { friction: 0.5, ..Example::constants() }.rolls, 8);
/// ```
#[macro_export]
macro_rules! parameters {
    (
        $(#[$meta:meta])*
        $vis:vis struct $name:ident {
            $(
                $(#[doc = $doc:literal])+
                $field:ident: $type:ident $([$unit:literal] in $low:literal..=$high:literal)? = $default:tt $($how:literal)?;
            )*
        }
    ) => {
        $(#[$meta])*
        #[derive(Debug, Clone, PartialEq)]
        $vis struct $name {
            $($(#[doc = $doc])+ $vis $field: $type,)*
        }

        impl $name {
            /// The defaults that do not depend on a model; zero where they do.
            $vis fn constants() -> Self {
                Self { $($field: $crate::parameters!(@constant $type $default),)* }
            }
        }

        impl $crate::parameters::Parameters for $name {
            const TABLE: &'static [robotc_core::spec::Parameter] = &[
                $(robotc_core::spec::Parameter {
                    name: stringify!($field),
                    kind: $crate::parameters!(@kind $type $($low $high)?),
                    default: $crate::parameters!(@default $type $default $($how)?),
                    unit: concat!("", $($unit)?),
                    doc: concat!($($doc),+),
                },)*
            ];

            fn values(&self) -> Vec<robotc_core::spec::ParameterValue> {
                vec![$($crate::parameters::ParameterType::to_value(&self.$field),)*]
            }

            fn set(
                &mut self,
                kind: &str,
                name: &str,
                value: &robotc_core::spec::ParameterValue,
            ) -> Result<(), $crate::parameters::ParameterError> {
                $crate::parameters::check(Self::TABLE, kind, name, value)?;
                $(if name == stringify!($field) {
                    self.$field = $crate::parameters::ParameterType::from_value(value)
                        .expect("a value that was checked has the type of its parameter");
                })*
                Ok(())
            }
        }
    };
    (@constant bool auto) => { false };
    (@constant f64 auto) => { 0.0 };
    (@constant u32 auto) => { 0 };
    (@constant $type:ident $default:tt) => { $default };
    (@kind f64 $low:literal $high:literal) => {
        robotc_core::spec::ParameterKind::Number(robotc_core::spec::Range::between($low, $high))
    };
    (@kind u32 $low:literal $high:literal) => { robotc_core::spec::ParameterKind::Integer($low, $high) };
    (@kind bool) => { robotc_core::spec::ParameterKind::Bool };
    (@default $type:ident auto $how:literal) => { robotc_core::spec::ParameterDefault::Automatic($how) };
    (@default f64 $default:tt) => { robotc_core::spec::ParameterDefault::Number($default) };
    (@default u32 $default:tt) => { robotc_core::spec::ParameterDefault::Integer($default) };
    (@default bool $default:tt) => { robotc_core::spec::ParameterDefault::Bool($default) };
}

#[cfg(test)]
mod tests {
    use robotc_core::spec::ParameterDefault;

    use super::*;

    crate::parameters! {
        /// For the tests.
        struct Example {
            /// Coulomb friction.
            friction: f64 [""] in 0.0..=2.0 = auto "that of the object";
            /// How many.
            rolls: u32 [""] in 1..=8 = 4;
            /// Whether.
            both: bool = true;
        }
    }

    #[test]
    fn steps_are_familiar_numbers() {
        for (x, expected) in
            [(0.0242, 0.02), (0.05, 0.05), (0.1, 0.1), (0.0999, 0.05), (7.0, 5.0), (1e-7, 1e-7)]
        {
            assert_eq!(round_step(x), expected, "{x}");
        }
        for x in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert_eq!(round_step(x), 0.0, "{x}");
        }
    }

    #[test]
    fn values_are_typed_and_bounded() {
        let mut example = Example::constants();
        let set: [(&str, ParameterValue); 3] = [
            ("friction", ParameterValue::Integer(1)),
            ("rolls", ParameterValue::Integer(8)),
            ("both", ParameterValue::Bool(false)),
        ];
        for (name, value) in set {
            assert_eq!(example.set("k", name, &value), Ok(()));
        }
        assert_eq!(example, Example { friction: 1.0, rolls: 8, both: false });
        for (name, value) in [
            ("friction", ParameterValue::Number(f64::NAN)),
            ("friction", ParameterValue::Number(2.5)),
            ("friction", ParameterValue::Bool(true)),
            ("rolls", ParameterValue::Integer(0)),
            ("rolls", ParameterValue::Number(2.0)),
            ("both", ParameterValue::Integer(1)),
            ("roll", ParameterValue::Integer(2)),
        ] {
            assert!(example.set("k", name, &value).is_err(), "{name} {value:?}");
        }
        assert_eq!(example, Example { friction: 1.0, rolls: 8, both: false });
        assert_eq!(Example::TABLE[0].default, ParameterDefault::Automatic("that of the object"));
        assert_eq!(Example::TABLE[0].doc, " Coulomb friction.");
    }
}
