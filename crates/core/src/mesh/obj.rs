//! Wavefront OBJ: vertices and faces; materials, normals and texture coordinates are left out.

use super::repair::RawMesh;
use super::{MOST_FACES, MeshError};

pub(super) fn read(bytes: &[u8]) -> Result<RawMesh, MeshError> {
    let text = String::from_utf8_lossy(bytes);
    // A backslash at the end of a line continues it.
    let joined = text.replace("\\\r\n", " ").replace("\\\n", " ");
    let mut mesh = RawMesh::default();
    let mut polygon: Vec<i64> = Vec::new();
    for (number, line) in joined.lines().enumerate() {
        let malformed = |what: &str| MeshError::Malformed(format!("line {}: {what}", number + 1));
        let line = line.split('#').next().unwrap_or_default();
        let mut words = line.split_whitespace();
        match words.next() {
            Some("v") => {
                let mut vertex = [0.0; 3];
                for x in &mut vertex {
                    let word = words.next().and_then(|w| w.parse().ok());
                    *x = word.ok_or_else(|| malformed("a vertex needs three numbers"))?;
                }
                mesh.vertices.push(vertex);
            }
            Some("f") => {
                polygon.clear();
                for word in words {
                    let first = word.split('/').next().unwrap_or_default();
                    let index: i64 = first.parse().map_err(|_| malformed("a face needs vertex numbers"))?;
                    // Numbers count from 1, or backwards from the last vertex so far.
                    polygon.push(if index < 0 { mesh.vertices.len() as i64 + index } else { index - 1 });
                }
                mesh.push_polygon(&polygon);
                if mesh.faces.len() > MOST_FACES {
                    return Err(MeshError::TooLarge(MOST_FACES));
                }
            }
            _ => {}
        }
    }
    Ok(mesh)
}

#[cfg(test)]
mod tests {
    use super::super::read;

    #[test]
    fn polygons_negative_numbers_and_continued_lines() {
        let text = "# comment\nv 0 0 0\nv 1 0 0\nv 1 1 0 # corner\nv 0 1 0\nvn 0 0 1\nf 1/1/1 2//1 3 \\\n 4\nf -4 -3 -2\n";
        let mesh = read(text.as_bytes(), "obj").unwrap().mesh;
        assert_eq!(mesh.faces, [[0, 1, 2], [0, 2, 3], [0, 1, 2]]);
    }

    #[test]
    fn bad_lines_are_named() {
        let error = read(b"v 0 0 0\nv 1 x 0\n", "obj").unwrap_err();
        assert_eq!(error.to_string(), "line 2: a vertex needs three numbers");
    }

    #[test]
    fn indices_out_of_range_drop_the_face() {
        let loaded = read(b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2 9\nf 0 1 2\n", "obj").unwrap();
        assert_eq!((loaded.mesh.faces.len(), loaded.repairs.bad_indices), (1, 2));
    }
}
