//! Which format a file has.

use super::stl;

/// A mesh file format.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MeshFormat {
    /// Stereolithography, binary or text.
    Stl,
    /// Wavefront OBJ.
    Obj,
    /// COLLADA 1.4 or 1.5.
    Dae,
}

impl MeshFormat {
    /// The format of `bytes`, by content where that tells, else by `extension` (without its dot, any case).
    ///
    /// Content comes first because real files carry the wrong ending.
    pub fn of(bytes: &[u8], extension: &str) -> Option<Self> {
        if stl::is_binary(bytes) {
            return Some(Self::Stl);
        }
        let start = &bytes[..bytes.len().min(4096)];
        let text = String::from_utf8_lossy(start);
        if text.contains("<COLLADA") {
            return Some(Self::Dae);
        }
        if text.trim_start().get(..5).is_some_and(|s| s.eq_ignore_ascii_case("solid"))
            && text.contains("facet")
        {
            return Some(Self::Stl);
        }
        match extension.to_ascii_lowercase().as_str() {
            "stl" | "stla" | "stlb" => Some(Self::Stl),
            "obj" => Some(Self::Obj),
            "dae" => Some(Self::Dae),
            _ => None,
        }
    }
}
