//! Every diagnostic code with its explanation: one entry each, shown by `robotc explain`.
//!
//! R00xx files, R01xx specification syntax and keys, R02xx robot descriptions, R03xx meshes, R04xx robot
//! annotations, R05xx tasks.

/// What `robotc explain CODE` prints.
#[derive(Debug, Clone, Copy)]
pub struct CodeInfo {
    /// The code, such as `R0102`.
    pub code: &'static str,
    /// One line.
    pub title: &'static str,
    /// A paragraph: why this is a finding, and how to mend it.
    pub text: &'static str,
}

/// The entry of a code, or `None` if there is no such code.
pub fn explain(code: &str) -> Option<&'static CodeInfo> {
    CODES.iter().find(|info| info.code.eq_ignore_ascii_case(code))
}

const fn entry(code: &'static str, title: &'static str, text: &'static str) -> CodeInfo {
    CodeInfo { code, title, text }
}

/// All codes, ascending.
pub const CODES: &[CodeInfo] = &[
    entry(
        "R0001",
        "file not found",
        "A file named by a specification or on the command line does not exist. Paths in a specification are relative \
         to the folder of that specification; `package://name/...` is looked up in the folders listed under \
         `packages` and in the folders above the description file.",
    ),
    entry(
        "R0002",
        "file cannot be read",
        "The file exists but the operating system would not read it, or it is not UTF-8 text where text is needed.",
    ),
    entry(
        "R0101",
        "not TOML",
        "The text breaks TOML's syntax at this place: a missing quote or bracket, a key without a value, a key or table \
         defined twice. Other findings of the same file are reported as far as the rest can be read.",
    ),
    entry(
        "R0102",
        "unknown key",
        "No part of robotc reads this key, so it is most likely misspelt or stands in the wrong table. Keys are never \
         ignored. `robotc schema robot` and `robotc schema task` print all keys.",
    ),
    entry(
        "R0103",
        "missing key",
        "A table lacks a key that has no default. The place shown is the table; write the key below its header.",
    ),
    entry(
        "R0104",
        "wrong kind of value",
        "The value is of another kind than the key takes: a text where a number is needed, one value where a list is \
         needed. Numbers are written without quotes, texts with them.",
    ),
    entry(
        "R0105",
        "number out of range",
        "The number is outside of the range that makes sense for this key, or is `nan` or `inf`. Lengths are metres, \
         angles radians, masses kilograms: a value a thousand or 57 times too large is often a matter of units.",
    ),
    entry(
        "R0106",
        "wrong number of values",
        "The list is shorter or longer than this key takes, such as two numbers where x, y and z are needed.",
    ),
    entry(
        "R0107",
        "name used twice",
        "Two things of one kind have the same name, so a reference by name could mean either. Rename one.",
    ),
    entry(
        "R0108",
        "unknown word",
        "The key takes one of a few words, and this is none of them. The words allowed are listed with the finding.",
    ),
    entry(
        "R0109",
        "one of several keys",
        "Of a group of keys exactly one must be written, such as the shape of an object: `mesh`, `box`, `cylinder`, \
         `capsule` or `sphere`. Here there is none, or more than one.",
    ),
    entry(
        "R0110",
        "key without a meaning here",
        "The key is known, but nothing reads it beside what else the table says, such as `units` for an object that is \
         not a mesh. Remove it, or add the key it belongs to.",
    ),
    entry(
        "R0111",
        "malformed text",
        "The text does not have the form that the key asks for. Names consist of letters, digits, `_`, `-` and `.`, because \
         they turn up in commands, file names and reports.",
    ),
    entry(
        "R0113",
        "unknown artefact kind",
        "Tables below `parameters` are named after the kinds of artefacts that the compiler makes; `robotc graph` lists \
         them.",
    ),
    entry(
        "R0114",
        "unknown parameter",
        "The artefact kind has no parameter of this name. `robotc schema robot` prints all parameters of all kinds.",
    ),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_are_unique_ascending_and_explained() {
        for pair in CODES.windows(2) {
            assert!(pair[0].code < pair[1].code, "{} before {}", pair[0].code, pair[1].code);
        }
        for info in CODES {
            assert!(info.text.len() > 40 && !info.title.is_empty(), "{}", info.code);
        }
    }
}
