//! Shapes of objects and obstacles.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use nalgebra::{Point3, Vector3};

use super::document::{Node, Table};
use super::file;
use crate::diag::{Diagnostic, Diagnostics, Span};
use crate::geom::{Aabb, HeightField, PointCloud};
use crate::mesh::{LoadedMesh, MeshFormat, UpAxis};
use crate::model::{Geometry, Origin, Shape, TriMesh};
use crate::scan::{self, ScanError};
use crate::system::{MeshFileError, System};

/// Extents, in metres, outside of which a shape is more likely in another unit than meant so.
const USUAL_EXTENT: (f64, f64) = (0.002, 10.0);

/// Reads shapes; things made from the same file in the same way share their mesh.
pub(super) struct Shapes<'a> {
    system: &'a dyn System,
    folder: &'a Path,
    meshes: BTreeMap<MeshKey, Arc<TriMesh>>,
}

/// File, up axis, factor.
type MeshKey = (PathBuf, Option<String>, u64);

impl<'a> Shapes<'a> {
    /// Reads meshes relative to `folder`.
    pub(super) fn new(system: &'a dyn System, folder: &'a Path) -> Self {
        Self { system, folder, meshes: BTreeMap::new() }
    }

    /// The shape of an `[[object]]` or `[[obstacle]]` table, or `None` with findings.
    pub(super) fn read(
        &mut self,
        table: &Table,
        diagnostics: &mut Diagnostics,
    ) -> Option<Arc<Vec<Geometry>>> {
        let colour = table.text("colour").and_then(|(text, _)| colour(text));
        let shape = match table.text("mesh") {
            Some((uri, place)) => {
                Shape::Mesh { mesh: self.mesh(table, uri, place, diagnostics)?, uri: uri.to_owned() }
            }
            None => match (table.table("cloud"), table.table("heights")) {
                (Some(cloud), _) => self.cloud(cloud, diagnostics)?,
                (_, Some(heights)) => self.heights(heights, diagnostics)?,
                _ => primitive(table)?,
            },
        };
        Some(Arc::new(vec![Geometry { origin: Origin::default(), shape, colour }]))
    }

    fn mesh(
        &mut self,
        table: &Table,
        uri: &str,
        place: Span,
        diagnostics: &mut Diagnostics,
    ) -> Option<Arc<TriMesh>> {
        let path = file::resolve(self.system, self.folder, uri);
        let up = table.text("up").map(|(axis, _)| axis.to_owned());
        let factor = unit(table) * table.number("scale").filter(|x| *x > 0.0).unwrap_or(1.0);
        let key = (path.clone(), up.clone(), factor.to_bits());
        if let Some(known) = self.meshes.get(&key) {
            return Some(known.clone());
        }
        let loaded = self.load(&path, place, diagnostics)?;
        if let Some(entry) = table.entry("units").filter(|_| loaded.format == MeshFormat::Dae) {
            diagnostics.push(
                Diagnostic::error("R0110", "a COLLADA file says its unit itself, and it has been applied")
                    .at(entry.key_span, "would be applied on top")
                    .expected("no `units` for a COLLADA file")
                    .hint("use `scale` if the file is wrong about its unit"),
            );
        }
        if loaded.repairs.are_serious() {
            diagnostics.push(
                Diagnostic::warning(
                    "R0506",
                    format!("mesh {} is damaged: much of it had to be dropped", path.display()),
                )
                .at(place, "this mesh"),
            );
        }
        if !loaded.mesh.is_closed() {
            diagnostics.push(
                Diagnostic::warning("R0509", format!("the surface of mesh {} is not closed", path.display()))
                    .at(place, "this mesh")
                    .hint("what is inside is taken from the convex parts that cover it"),
            );
        }
        let up = match up.as_deref() {
            Some("y") => UpAxis::Y,
            Some(_) => UpAxis::Z,
            None => loaded.up.unwrap_or(UpAxis::Z),
        };
        let mesh = Arc::new(stood_up(&loaded.mesh, up).scaled(Vector3::repeat(factor)));
        self.check_extent(&mesh, place, diagnostics);
        self.meshes.insert(key, mesh.clone());
        Some(mesh)
    }

    fn load(&self, path: &Path, place: Span, diagnostics: &mut Diagnostics) -> Option<Arc<LoadedMesh>> {
        let finding = match self.system.mesh(path) {
            Ok(loaded) => return Some(loaded),
            Err(MeshFileError::Mesh(error)) => {
                Diagnostic::error("R0505", format!("mesh {}: {error}", path.display()))
                    .expected("an STL, OBJ or COLLADA file with triangles")
            }
            Err(MeshFileError::Read(error)) => Diagnostic::unreadable(path, &error),
        };
        diagnostics.push(finding.at(place, "named here"));
        None
    }

    /// A table with a `file` of measurements: what a reader makes of it.
    fn measured<T>(
        &self,
        table: &Table,
        read: impl FnOnce(&[u8]) -> Result<T, ScanError>,
        diagnostics: &mut Diagnostics,
    ) -> Option<T> {
        let (uri, place) = table.text("file")?;
        let path = file::resolve(self.system, self.folder, uri);
        let finding = match self.system.read(&path) {
            Ok(bytes) => match read(&bytes) {
                Ok(found) => return Some(found),
                Err(error) => Diagnostic::error("R0511", format!("{}: {error}", path.display())),
            },
            Err(error) => Diagnostic::unreadable(&path, &error),
        };
        diagnostics.push(finding.at(place, "named here"));
        None
    }

    fn cloud(&self, table: &Table, diagnostics: &mut Diagnostics) -> Option<Shape> {
        let (uri, place) = table.text("file")?;
        let found = self.measured(table, scan::points, diagnostics)?;
        let unit = unit(table);
        let points = found.points.into_iter().map(|p| Point3::from(p.coords * unit)).collect();
        let radius = table.number("radius").filter(|x| *x > 0.0)?;
        match PointCloud::new(points, radius) {
            Ok(cloud) => {
                check_size(&cloud.bounds(), "the cloud", place, diagnostics);
                Some(Shape::Cloud { cloud: Arc::new(cloud), uri: uri.to_owned() })
            }
            Err(error) => {
                diagnostics.push(Diagnostic::error("R0511", error.to_string()).at(place, "this cloud"));
                None
            }
        }
    }

    fn heights(&self, table: &Table, diagnostics: &mut Diagnostics) -> Option<Shape> {
        let (uri, place) = table.text("file")?;
        let grid = self.measured(table, scan::grid, diagnostics)?;
        let range = table.get("range").and_then(Node::array::<2>);
        let (scale, offset) = match (grid.full, range) {
            (Some(full), Some([black, white])) => ((white - black) / full, black),
            (None, None) => (unit(table), 0.0),
            (Some(_), None) => {
                let what = "the heights of black and of white are not known";
                diagnostics.push(Diagnostic::error("R0512", what).at(place, "an image").expected("`range`"));
                return None;
            }
            (None, Some(_)) => {
                let at = table.entry("range").map_or(place, |entry| entry.key_span);
                diagnostics.push(
                    Diagnostic::error("R0512", "the file has heights, not shades of grey")
                        .at(at, "nothing to apply it to")
                        .expected("`range` for images only"),
                );
                return None;
            }
        };
        let missing = table.number("missing");
        let height = |value: f64| if Some(value) == missing { f64::NAN } else { offset + scale * value };
        let heights = grid.values.into_iter().map(height).collect();
        let spacing = table.get("spacing").and_then(Node::array::<2>)?;
        match HeightField::new(grid.columns, heights, spacing, table.number("floor")) {
            Ok(field) => {
                check_size(&field.bounds(), "the height field", place, diagnostics);
                Some(Shape::HeightField { field: Arc::new(field), uri: uri.to_owned() })
            }
            Err(error) => {
                diagnostics
                    .push(Diagnostic::error("R0511", error.to_string()).at(place, "this height field"));
                None
            }
        }
    }

    fn check_extent(&self, mesh: &TriMesh, place: Span, diagnostics: &mut Diagnostics) {
        let Some(bounds) = Aabb::of_points(&mesh.vertices) else { return };
        check_size(&bounds, "the mesh", place, diagnostics);
    }
}

/// Warns of what is of a size that is most often that of another unit.
fn check_size(bounds: &Aabb, what: &str, place: Span, diagnostics: &mut Diagnostics) {
    let largest = bounds.size().max();
    if largest < USUAL_EXTENT.0 || largest > USUAL_EXTENT.1 {
        let size = (largest * 1e4).round() / 1e4;
        diagnostics.push(
            Diagnostic::warning("R0507", format!("{what} is {size} m large"))
                .at(place, what.replacen("the", "this", 1))
                .hint("its `units` are \"m\" unless another unit is written: \"cm\", \"mm\" or \"inch\""),
        );
    }
}

/// The `units` of a table, in metres.
fn unit(table: &Table) -> f64 {
    table.text("units").and_then(|(unit, _)| metres(unit)).unwrap_or(1.0)
}

/// The mesh with its `up` axis turned to z.
fn stood_up(mesh: &TriMesh, up: UpAxis) -> TriMesh {
    let turn = |v: &Point3<f64>| match up {
        UpAxis::X => Point3::new(-v.z, v.y, v.x),
        UpAxis::Y => Point3::new(v.x, -v.z, v.y),
        UpAxis::Z => *v,
    };
    TriMesh { vertices: mesh.vertices.iter().map(turn).collect(), faces: mesh.faces.clone() }
}

fn primitive(table: &Table) -> Option<Shape> {
    if let Some(size) = table.get("box") {
        return Some(Shape::Box { size: size.array::<3>().filter(|s| s.iter().all(|x| *x > 0.0))? });
    }
    if let Some(radius) = table.get("sphere") {
        return Some(Shape::Sphere { radius: positive(radius)? });
    }
    let round = |key: &str| {
        let round = table.table(key)?;
        Some((positive(round.get("radius")?)?, positive(round.get("length")?)?))
    };
    if let Some((radius, length)) = round("cylinder") {
        return Some(Shape::Cylinder { radius, length });
    }
    round("capsule").map(|(radius, length)| Shape::Capsule { radius, length })
}

fn positive(node: &Node) -> Option<f64> {
    node.number().filter(|x| *x > 0.0)
}

fn metres(unit: &str) -> Option<f64> {
    match unit {
        "m" => Some(1.0),
        "cm" => Some(0.01),
        "mm" => Some(0.001),
        "inch" => Some(0.0254),
        _ => None,
    }
}

/// Red, green, blue and opacity of `#rrggbb`.
fn colour(text: &str) -> Option<[f32; 4]> {
    let channel = |i: usize| Some(f32::from(u8::from_str_radix(text.get(i..i + 2)?, 16).ok()?) / 255.0);
    Some([channel(1)?, channel(3)?, channel(5)?, 1.0])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turning_an_axis_up_keeps_orientation() {
        let vertices = vec![Point3::origin(), Point3::new(1.0, 0.0, 0.0), Point3::new(0.0, 1.0, 0.0)];
        let mesh = TriMesh { vertices, faces: vec![[0, 1, 2]] };
        // The face's normal is +z; it must turn with the axis that goes to +z.
        assert_eq!(stood_up(&mesh, UpAxis::Z).area_vector(0), Vector3::new(0.0, 0.0, 1.0));
        assert_eq!(stood_up(&mesh, UpAxis::Y).area_vector(0), Vector3::new(0.0, -1.0, 0.0));
        assert_eq!(stood_up(&mesh, UpAxis::X).area_vector(0), Vector3::new(-1.0, 0.0, 0.0));
        let up = |axis, v: [f64; 3]| {
            stood_up(&TriMesh { vertices: vec![v.into()], faces: vec![] }, axis).vertices[0]
        };
        assert_eq!(up(UpAxis::Y, [0.0, 1.0, 0.0]), Point3::new(0.0, 0.0, 1.0));
        assert_eq!(up(UpAxis::X, [1.0, 0.0, 0.0]), Point3::new(0.0, 0.0, 1.0));
    }

    #[test]
    fn colours_are_hexadecimal() {
        assert_eq!(colour("#ff0033"), Some([1.0, 0.0, 0.2, 1.0]));
        assert_eq!(colour("#ff"), None);
    }
}
