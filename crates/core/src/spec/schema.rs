//! The description of a specification format: one table of keys, from which come validation, JSON Schema and the
//! reference in the documentation.

use std::f64::consts::PI;

/// A table of keys.
#[derive(Debug)]
pub struct TableSchema {
    /// A sentence or two.
    pub doc: &'static str,
    /// The keys, in the order in which people would write them.
    pub keys: &'static [Key],
    /// What must hold between keys.
    pub rules: &'static [Rule],
}

/// A key of a table.
#[derive(Debug)]
pub struct Key {
    /// As written.
    pub name: &'static str,
    /// What may stand behind it.
    pub kind: Kind,
    /// Whether it must be there, and what holds if it is not.
    pub presence: Presence,
    /// Unit of its numbers, or empty.
    pub unit: &'static str,
    /// A sentence or two.
    pub doc: &'static str,
}

/// Whether a key must be there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Presence {
    /// It must.
    Required,
    /// It may; its doc says what its absence means.
    Optional,
    /// It may, and this TOML value holds otherwise.
    Default(&'static str),
}

/// What may stand behind a key.
#[derive(Debug, Clone, Copy)]
pub enum Kind {
    /// `true` or `false`.
    Bool,
    /// A whole number, bounds included.
    Integer(i64, i64),
    /// A finite number.
    Number(Range),
    /// A text.
    Text(Text),
    /// One of these words.
    Choice(&'static [&'static str]),
    /// A list of values of one kind.
    List(&'static Kind, Length),
    /// `[key]` or `{ ... }`.
    Table(&'static TableSchema),
    /// `[[key]]`, any number of times; the named key (if any) differs between them.
    Tables(&'static TableSchema, Option<&'static str>),
    /// A table whose keys the user chooses: what a key names, and the kind of the values.
    Map(Text, &'static Kind),
    /// `[parameters.KIND]` tables, as the artefact kinds declare them.
    Parameters,
}

/// What a text stands for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Text {
    /// A new name: letters, digits, `_`, `-`, `.`; it turns up in commands, files and reports.
    Name,
    /// A file, relative to the folder of the specification.
    Path,
    /// A colour as `#rrggbb`.
    Colour,
    /// A link of the robot.
    Link,
    /// A joint of the robot.
    Joint,
    /// An arm of the robot.
    Arm,
    /// A gripper of the robot.
    Gripper,
    /// An object of the task.
    Object,
    /// A ROS package.
    Package,
    /// An argument of a xacro file.
    Argument,
    /// Any text.
    Any,
}

impl Text {
    /// What is expected, for messages and documentation.
    pub fn describe(self) -> &'static str {
        match self {
            Self::Name => "a name",
            Self::Path => "a path",
            Self::Colour => "a colour \"#rrggbb\"",
            Self::Link => "a link name",
            Self::Joint => "a joint name",
            Self::Arm => "an arm name",
            Self::Gripper => "a gripper name",
            Self::Object => "an object name",
            Self::Package => "a package name",
            Self::Argument => "the name of a xacro argument",
            Self::Any => "a text",
        }
    }

    /// A regular expression that every such text matches (ECMA dialect, as in JSON Schema).
    pub fn pattern(self) -> &'static str {
        match self {
            Self::Name => "^[A-Za-z0-9_][A-Za-z0-9_.-]*$",
            Self::Colour => "^#[0-9A-Fa-f]{6}$",
            _ => "^.",
        }
    }

    /// Whether `text` matches [`Text::pattern`].
    pub fn accepts(self, text: &str) -> bool {
        match self {
            Self::Name => {
                let allowed = |c: char| c.is_ascii_alphanumeric() || "_.-".contains(c);
                text.chars().all(allowed) && text.starts_with(|c: char| c.is_ascii_alphanumeric() || c == '_')
            }
            Self::Colour => {
                text.len() == 7 && text.starts_with('#') && text[1..].chars().all(|c| c.is_ascii_hexdigit())
            }
            _ => !text.is_empty() && !text.starts_with(['\n', '\r']),
        }
    }
}

/// A range of numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range {
    /// Smallest number, or minus infinity.
    pub min: f64,
    /// Largest number, or infinity.
    pub max: f64,
    /// Whether `min` itself is excluded.
    pub above_min: bool,
}

impl Range {
    /// Any finite number.
    pub const ANY: Self = Self { min: f64::NEG_INFINITY, max: f64::INFINITY, above_min: false };
    /// Above zero.
    pub const POSITIVE: Self = Self { min: 0.0, max: f64::INFINITY, above_min: true };
    /// Zero or above.
    pub const NON_NEGATIVE: Self = Self { min: 0.0, max: f64::INFINITY, above_min: false };
    /// An angle between no and half a turn.
    pub const HALF_TURN: Self = Self { min: 0.0, max: PI, above_min: false };

    /// From `min` to `max`, both included.
    pub const fn between(min: f64, max: f64) -> Self {
        Self { min, max, above_min: false }
    }

    /// Whether `x` is a finite number of the range.
    pub fn contains(self, x: f64) -> bool {
        x.is_finite() && x >= self.min && x <= self.max && !(self.above_min && x == self.min)
    }

    /// The range in words, or `None` for [`Range::ANY`].
    pub fn describe(self) -> Option<String> {
        if self == Self::HALF_TURN {
            return Some("from 0 to pi".to_owned());
        }
        match (self.min.is_finite(), self.max.is_finite()) {
            (false, false) => None,
            (true, false) if self.above_min => Some(format!("above {}", self.min)),
            (true, false) => Some(format!("{} or more", self.min)),
            (false, true) => Some(format!("{} or less", self.max)),
            (true, true) if self.above_min => Some(format!("above {}, up to {}", self.min, self.max)),
            (true, true) => Some(format!("from {} to {}", self.min, self.max)),
        }
    }
}

/// How many items a list has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Length {
    /// Any number of items.
    Any,
    /// So many.
    Exactly(usize),
    /// So many or more.
    AtLeast(usize),
}

impl Length {
    /// Whether a list may have `n` items.
    pub fn contains(self, n: usize) -> bool {
        match self {
            Self::Any => true,
            Self::Exactly(m) => n == m,
            Self::AtLeast(m) => n >= m,
        }
    }
}

/// What must hold between the keys of a table.
#[derive(Debug, Clone, Copy)]
pub enum Rule {
    /// One of these keys is there, and no other.
    ExactlyOne(&'static [&'static str]),
    /// Beside `with` one of these keys is there, and no other; elsewhere none has a meaning.
    OneWith {
        /// The dependent keys.
        keys: &'static [&'static str],
        /// The key they belong to.
        with: &'static str,
    },
    /// These keys have a meaning only beside `with`.
    OnlyWith {
        /// The dependent keys.
        keys: &'static [&'static str],
        /// The key they belong to.
        with: &'static str,
    },
    /// Where `key` has the value `value`, the key `then` is required; elsewhere it has no meaning.
    Goes {
        /// The deciding key.
        key: &'static str,
        /// Its deciding value.
        value: &'static str,
        /// What is required then.
        then: &'static str,
    },
    /// Where `key` has the value `value`, other keys have no meaning, some of which are required elsewhere.
    Unless {
        /// The deciding key.
        key: &'static str,
        /// Its deciding value.
        value: &'static str,
        /// What is required otherwise.
        needed: &'static [&'static str],
        /// What may be there otherwise.
        allowed: &'static [&'static str],
    },
}

impl Key {
    /// A key that must be there.
    pub const fn required(name: &'static str, kind: Kind, doc: &'static str) -> Self {
        Self { name, kind, presence: Presence::Required, unit: "", doc }
    }

    /// A key that may be absent.
    pub const fn optional(name: &'static str, kind: Kind, doc: &'static str) -> Self {
        Self { name, kind, presence: Presence::Optional, unit: "", doc }
    }

    /// The TOML value that holds when the key is absent.
    pub const fn default(mut self, value: &'static str) -> Self {
        self.presence = Presence::Default(value);
        self
    }

    /// The unit of its numbers.
    pub const fn unit(mut self, unit: &'static str) -> Self {
        self.unit = unit;
        self
    }
}

impl TableSchema {
    /// The key of this name.
    pub fn key(&self, name: &str) -> Option<&'static Key> {
        self.keys.iter().find(|k| k.name == name)
    }
}

/// Three finite numbers.
pub(super) const VECTOR: Kind = Kind::List(&Kind::Number(Range::ANY), Length::Exactly(3));

/// Translation, then roll, pitch, yaw about fixed axes, as in URDF.
pub(super) static POSE: TableSchema = TableSchema {
    doc: "A rigid transform, as in URDF: turn about fixed x, then y, then z, then move.",
    keys: &[
        Key::optional("xyz", VECTOR, "Translation.").default("[0.0, 0.0, 0.0]").unit("m"),
        Key::optional("rpy", VECTOR, "Roll, pitch and yaw about fixed x, y, z.")
            .default("[0.0, 0.0, 0.0]")
            .unit("rad"),
    ],
    rules: &[],
};
