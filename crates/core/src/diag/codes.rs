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
