//! Meshes as Wavefront OBJ text, hundredths of a millimetre.

use std::fmt::Write;

use robotc_core::model::TriMesh;

/// The text of a mesh.
pub(crate) fn text(mesh: &TriMesh) -> String {
    let mut out = String::from("# Written by `cargo xtask assets`; metres.\n");
    for v in &mesh.vertices {
        let [x, y, z] = [v.x, v.y, v.z].map(number);
        writeln!(out, "v {x} {y} {z}").expect("writing to a string");
    }
    for [a, b, c] in mesh.faces.iter().map(|f| f.map(|v| v + 1)) {
        writeln!(out, "f {a} {b} {c}").expect("writing to a string");
    }
    out
}

/// A coordinate in metres with five decimals at most.
fn number(value: f64) -> String {
    let text = format!("{value:.5}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::number;

    #[test]
    fn numbers_are_short() {
        let cases =
            [(0.0, "0"), (-0.000001, "0"), (0.1, "0.1"), (-1.0, "-1"), (0.123456, "0.12346"), (10.0, "10")];
        for (value, expect) in cases {
            assert_eq!(number(value), expect);
        }
    }
}
