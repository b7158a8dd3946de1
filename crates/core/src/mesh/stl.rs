//! STL, binary and text.

use super::repair::RawMesh;
use super::{MOST_FACES, MeshError};

const HEADER: usize = 84;
const FACET: usize = 50;

/// Whether the size is exactly that of a binary STL with its stated number of facets. The header says nothing: many
/// binary files begin with `solid`.
pub(super) fn is_binary(bytes: &[u8]) -> bool {
    stated_facets(bytes).is_some_and(|n| n > 0 && bytes.len() == HEADER + FACET * n)
}

fn stated_facets(bytes: &[u8]) -> Option<usize> {
    let count: [u8; 4] = bytes.get(80..HEADER)?.try_into().ok()?;
    Some(u32::from_le_bytes(count) as usize)
}

pub(super) fn read(bytes: &[u8]) -> Result<RawMesh, MeshError> {
    let text_start = bytes.iter().position(|b| !b.is_ascii_whitespace()).unwrap_or(bytes.len());
    let says_solid = bytes[text_start..].get(..5).is_some_and(|s| s.eq_ignore_ascii_case(b"solid"));
    if says_solid && !is_binary(bytes) { read_text(bytes) } else { read_binary(bytes) }
}

fn read_binary(bytes: &[u8]) -> Result<RawMesh, MeshError> {
    let stated =
        stated_facets(bytes).ok_or_else(|| MeshError::Malformed("ends within the header".to_owned()))?;
    let held = (bytes.len() - HEADER) / FACET;
    if stated > held {
        return Err(MeshError::Malformed(format!("says {stated} triangles, but ends after {held}")));
    }
    if stated > MOST_FACES {
        return Err(MeshError::TooLarge(MOST_FACES));
    }
    let mut mesh = RawMesh::default();
    for facet in bytes[HEADER..].chunks_exact(FACET).take(stated) {
        // Twelve bytes of normal come first; it follows from the corners.
        let corner = |i: usize| {
            [0, 1, 2].map(|k| {
                let at = 12 + 12 * i + 4 * k;
                f64::from(f32::from_le_bytes([facet[at], facet[at + 1], facet[at + 2], facet[at + 3]]))
            })
        };
        mesh.push_triangle([corner(0), corner(1), corner(2)]);
    }
    Ok(mesh)
}

fn read_text(bytes: &[u8]) -> Result<RawMesh, MeshError> {
    let text = String::from_utf8_lossy(bytes);
    let mut mesh = RawMesh::default();
    let mut corners: Vec<[f64; 3]> = Vec::new();
    for (number, line) in text.lines().enumerate() {
        let mut words = line.split_whitespace();
        // One line may hold several statements; `vertex` and `endloop` are the ones that matter.
        while let Some(word) = words.next() {
            if word.eq_ignore_ascii_case("vertex") {
                let mut corner = [0.0; 3];
                for x in &mut corner {
                    *x = words.next().and_then(|w| w.parse().ok()).ok_or_else(|| {
                        MeshError::Malformed(format!("line {}: a vertex needs three numbers", number + 1))
                    })?;
                }
                corners.push(corner);
            } else if word.eq_ignore_ascii_case("endloop") {
                for i in 2..corners.len() {
                    mesh.push_triangle([corners[0], corners[i - 1], corners[i]]);
                }
                corners.clear();
            } else if word.eq_ignore_ascii_case("solid") || word.eq_ignore_ascii_case("endsolid") {
                // The rest of the line is a name.
                break;
            }
        }
    }
    if !corners.is_empty() {
        return Err(MeshError::Malformed("ends within a facet".to_owned()));
    }
    Ok(mesh)
}

#[cfg(test)]
mod tests {
    use super::super::read;
    use super::*;

    const TEXT: &str = "solid part\n facet normal 0 0 1\n outer loop\n vertex 0 0 0\n vertex 1 0 0\n vertex 0 1 0\n \
                        endloop\n endfacet\nendsolid part\n";

    fn binary(header: &[u8], facets: &[[[f32; 3]; 3]]) -> Vec<u8> {
        let mut bytes = header.to_vec();
        bytes.resize(80, b' ');
        bytes.extend((facets.len() as u32).to_le_bytes());
        for facet in facets {
            bytes.extend([0; 12]);
            bytes.extend(facet.iter().flatten().flat_map(|x| x.to_le_bytes()));
            bytes.extend([0; 2]);
        }
        bytes
    }

    const FACE: [[f32; 3]; 3] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];

    #[test]
    fn text_and_binary_give_the_same_mesh() {
        let from_text = read(TEXT.as_bytes(), "stl").unwrap();
        let from_binary = read(&binary(b"made by hand", &[FACE]), "stl").unwrap();
        assert_eq!(from_text, from_binary);
        assert_eq!(from_text.mesh.faces, [[0, 1, 2]]);
    }

    #[test]
    fn a_binary_file_may_begin_with_solid() {
        let bytes = binary(b"solid facet that is none", &[FACE, FACE]);
        assert_eq!(read(&bytes, "stl").unwrap().mesh.faces.len(), 2);
    }

    #[test]
    fn truncated_files_are_refused() {
        let whole = binary(b"", &[FACE, FACE]);
        let error = read(&whole[..whole.len() - 1], "stl").unwrap_err();
        assert_eq!(error, MeshError::Malformed("says 2 triangles, but ends after 1".to_owned()));
        assert!(read(&whole[..50], "stl").is_err());
        assert!(read(&TEXT.as_bytes()[..90], "stl").is_err());
    }
}
