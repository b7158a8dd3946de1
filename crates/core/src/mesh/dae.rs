//! COLLADA (1.4, 1.5): the triangles of a scene, every instance in its place, in metres.

use std::collections::HashMap;

use nalgebra::{Matrix4, Point3, Rotation3, Unit, Vector3};

use super::repair::RawMesh;
use super::{MOST_FACES, MeshError, UpAxis};
use crate::diag::{Severity, Sources};
use crate::xml::{self, Element, Node};

/// Deepest nesting of nodes, through references too: they may go round in circles.
const MOST_NESTED: usize = 64;

/// Most nodes of one scene: references to references multiply.
const MOST_NODES: usize = 100_000;

/// Characters that may be read beyond eight times those of the file: every instance of a geometry or node reads it again.
const MOST_READ_AGAIN: usize = 1 << 25;

/// What a reference or an element costs to follow, in characters.
const STEP: usize = 64;

pub(super) fn read(bytes: &[u8]) -> Result<(RawMesh, Option<UpAxis>), MeshError> {
    let (text, _) = xml::decode(bytes);
    let mut sources = Sources::new();
    let file = sources.add("", text.as_str());
    let limits = xml::Limits { bytes: 1 << 30, ..xml::Limits::default() };
    let (root, found) = xml::parse(&text, file, limits);
    if let Some(first) = found.iter().find(|d| d.severity == Severity::Error) {
        let line = first.span.map_or(0, |span| sources.line_column(span).line);
        return Err(MeshError::Malformed(format!("line {line}: {}", first.message)));
    }
    let root =
        root.filter(|r| r.name == "COLLADA").ok_or_else(|| malformed("the root element is not <COLLADA>"))?;
    let asset = root.child("asset");
    let unit = match asset.and_then(|a| a.child("unit")).and_then(|u| u.value("meter")) {
        None => 1.0,
        Some(text) => match text.trim().parse::<f64>() {
            Ok(unit) if unit > 0.0 && unit.is_finite() => unit,
            _ => return Err(malformed("the unit is not a positive number")),
        },
    };
    let up = asset.and_then(|a| a.child("up_axis")).map(Element::text).and_then(|t| match t.trim() {
        "X_UP" => Some(UpAxis::X),
        "Y_UP" => Some(UpAxis::Y),
        "Z_UP" => Some(UpAxis::Z),
        _ => None,
    });
    let left = text.len().saturating_mul(8).saturating_add(MOST_READ_AGAIN);
    let mut scene = Scene { ids: index(&root), mesh: RawMesh::default(), nodes: 0, left };
    let metres = Matrix4::new_scaling(unit);
    match visual_scene(&root, &scene.ids) {
        Some(visual_scene) => scene.node(visual_scene, &metres, 0)?,
        None => {
            for geometry in root.named("library_geometries").flat_map(|l| l.named("geometry")) {
                scene.geometry(geometry, &metres)?;
            }
        }
    }
    Ok((scene.mesh, up))
}

fn malformed(what: &str) -> MeshError {
    MeshError::Malformed(what.to_owned())
}

type Ids<'a> = HashMap<&'a str, &'a Element>;

/// All elements that have an id.
fn index(root: &Element) -> Ids<'_> {
    let mut ids = HashMap::new();
    let mut open = vec![root];
    while let Some(element) = open.pop() {
        if let Some(id) = element.value("id") {
            ids.entry(id).or_insert(element);
        }
        open.extend(element.elements());
    }
    ids
}

fn target<'a>(ids: &Ids<'a>, reference: Option<&str>) -> Option<&'a Element> {
    ids.get(reference?.trim().strip_prefix('#')?).copied()
}

fn visual_scene<'a>(root: &'a Element, ids: &Ids<'a>) -> Option<&'a Element> {
    let named = root.child("scene").and_then(|s| s.child("instance_visual_scene"));
    target(ids, named.and_then(|i| i.value("url")))
        .or_else(|| root.child("library_visual_scenes").and_then(|l| l.child("visual_scene")))
}

struct Scene<'a> {
    ids: Ids<'a>,
    mesh: RawMesh,
    nodes: usize,
    /// Characters that may still be read, each instance anew.
    left: usize,
}

impl<'a> Scene<'a> {
    /// Adds what hangs on a node (or visual scene) whose parent frame is placed by `metres_from_parent`.
    fn node(
        &mut self,
        node: &'a Element,
        metres_from_parent: &Matrix4<f64>,
        depth: usize,
    ) -> Result<(), MeshError> {
        self.nodes += 1;
        if depth > MOST_NESTED || self.nodes > MOST_NODES {
            return Err(malformed("nodes are nested too deep, or refer to each other in a circle"));
        }
        let mut metres_from_node = *metres_from_parent;
        for element in node.elements() {
            self.reads(own_characters(element))?;
            metres_from_node *= transform(element)?;
        }
        for element in node.elements() {
            let url = element.value("url");
            match element.name.as_str() {
                "node" => self.node(element, &metres_from_node, depth + 1)?,
                "instance_node" => {
                    if let Some(node) = target(&self.ids, url) {
                        self.node(node, &metres_from_node, depth + 1)?;
                    }
                }
                "instance_geometry" => {
                    if let Some(geometry) = target(&self.ids, url) {
                        self.geometry(geometry, &metres_from_node)?;
                    }
                }
                "instance_controller" => {
                    let skin = target(&self.ids, url).and_then(|c| c.child("skin"));
                    if let Some(geometry) = target(&self.ids, skin.and_then(|s| s.value("source"))) {
                        self.geometry(geometry, &metres_from_node)?;
                    }
                }
                _ => {}
            }
        }
        Ok(())
    }

    /// Counts characters that are read.
    fn reads(&mut self, characters: usize) -> Result<(), MeshError> {
        let left = self.left.checked_sub(characters + STEP);
        self.left = left.ok_or_else(|| malformed("its instances are too many to be read"))?;
        Ok(())
    }

    fn geometry(&mut self, geometry: &'a Element, metres_from_node: &Matrix4<f64>) -> Result<(), MeshError> {
        let Some(mesh) = geometry.child("mesh") else { return Ok(()) };
        self.reads(characters(mesh))?;
        let mirrors = metres_from_node.fixed_view::<3, 3>(0, 0).determinant() < 0.0;
        // Primitives of one mesh share their vertices: each source is placed once.
        let mut placed: HashMap<*const Element, i64> = HashMap::new();
        for primitive in mesh.elements() {
            let Some((offset, stride, source)) = self.positions(primitive) else { continue };
            let first = match placed.get(&std::ptr::from_ref(source)) {
                Some(&first) => first,
                None => {
                    // It may be that of another mesh.
                    self.reads(characters(source))?;
                    let first = self.mesh.vertices.len() as i64;
                    for p in points(source)? {
                        self.mesh.vertices.push(metres_from_node.transform_point(&p).coords.into());
                    }
                    placed.insert(source, first);
                    first
                }
            };
            let before = self.mesh.faces.len();
            polygons(primitive, offset, stride, |polygon| self.mesh.push_polygon(polygon))?;
            for face in &mut self.mesh.faces[before..] {
                *face = face.map(|i| if i < 0 { i } else { first + i });
                if mirrors {
                    face.swap(1, 2);
                }
            }
            if self.mesh.faces.len() > MOST_FACES {
                return Err(MeshError::TooLarge(MOST_FACES));
            }
        }
        Ok(())
    }

    /// Where vertex indices stand in the `<p>` lists of a primitive, how many indices each corner has, and the source of
    /// positions; `None` if the element is no primitive with vertices.
    fn positions(&self, primitive: &'a Element) -> Option<(usize, usize, &'a Element)> {
        let inputs = || {
            primitive.named("input").map(|i| {
                let offset = i.value("offset").and_then(|o| o.trim().parse::<usize>().ok()).unwrap_or(0);
                (i, offset)
            })
        };
        let stride = inputs().map(|(_, offset)| offset.min(64)).max()? + 1;
        let (input, offset) = inputs().find(|(i, _)| i.value("semantic") == Some("VERTEX"))?;
        let vertices = target(&self.ids, input.value("source"))?;
        let position = vertices.named("input").find(|i| i.value("semantic") == Some("POSITION"))?;
        Some((offset.min(64), stride, target(&self.ids, position.value("source"))?))
    }
}

/// Characters of the text in an element, its children left out.
fn own_characters(element: &Element) -> usize {
    let of = |node: &Node| match node {
        Node::Text(text, _) => text.len(),
        Node::Element(_) => 0,
    };
    element.children.iter().map(of).sum()
}

/// Characters of all number lists in an element.
fn characters(element: &Element) -> usize {
    let of = |node: &Node| match node {
        Node::Text(text, _) => text.len(),
        Node::Element(child) => characters(child),
    };
    element.children.iter().map(of).sum()
}

/// The points of a `<source>`, by its accessor.
fn points(source: &Element) -> Result<Vec<Point3<f64>>, MeshError> {
    let array =
        source.child("float_array").ok_or_else(|| malformed("a source of positions has no numbers"))?;
    let numbers = floats(&array.text())?;
    let accessor = source.child("technique_common").and_then(|t| t.child("accessor"));
    let entry = |name: &str, default: usize| {
        accessor.and_then(|a| a.value(name)).and_then(|v| v.trim().parse().ok()).unwrap_or(default)
    };
    let (stride, offset) = (entry("stride", 3), entry("offset", 0));
    if stride < 3 {
        return Err(malformed("positions need three numbers each"));
    }
    let numbers = numbers.get(offset..).unwrap_or_default();
    Ok(numbers.chunks(stride).filter(|c| c.len() >= 3).map(|c| Point3::new(c[0], c[1], c[2])).collect())
}

/// Calls `emit` with the vertex indices of each polygon of a primitive, counter-clockwise.
fn polygons(
    primitive: &Element,
    offset: usize,
    stride: usize,
    mut emit: impl FnMut(&[i64]),
) -> Result<(), MeshError> {
    let lists = primitive
        .elements()
        .flat_map(|e| match e.name.as_str() {
            "p" => vec![e],
            // A polygon with holes: the outline is taken.
            "ph" => e.child("p").into_iter().collect(),
            _ => Vec::new(),
        })
        .map(|p| {
            let all = integers(&p.text())?;
            Ok(all.chunks_exact(stride).map(|corner| corner[offset]).collect::<Vec<i64>>())
        });
    for list in lists {
        let list: Vec<i64> = list?;
        match primitive.name.as_str() {
            "triangles" => list.chunks_exact(3).for_each(&mut emit),
            "polygons" | "trifans" => emit(&list),
            "polylist" => {
                let counts =
                    primitive.child("vcount").map(|v| integers(&v.text())).transpose()?.unwrap_or_default();
                let mut rest = list.as_slice();
                for count in counts {
                    let Some((polygon, after)) =
                        usize::try_from(count).ok().and_then(|n| rest.split_at_checked(n))
                    else {
                        return Err(malformed("a polylist has fewer corners than it counts"));
                    };
                    emit(polygon);
                    rest = after;
                }
            }
            "tristrips" => {
                for (i, t) in list.windows(3).enumerate() {
                    if i % 2 == 0 { emit(t) } else { emit(&[t[1], t[0], t[2]]) }
                }
            }
            // Lines and points have no area.
            _ => {}
        }
    }
    Ok(())
}

/// The matrix of a transform element of a node; identity for any other element.
fn transform(element: &Element) -> Result<Matrix4<f64>, MeshError> {
    let numbers = |count: usize| -> Result<Vec<f64>, MeshError> {
        let numbers = floats(&element.text())?;
        if numbers.len() < count {
            return Err(malformed(&format!("<{}> needs {count} numbers", element.name)));
        }
        Ok(numbers)
    };
    Ok(match element.name.as_str() {
        "matrix" => Matrix4::from_row_slice(&numbers(16)?[..16]),
        "translate" => {
            let t = numbers(3)?;
            Matrix4::new_translation(&Vector3::new(t[0], t[1], t[2]))
        }
        "scale" => {
            let s = numbers(3)?;
            Matrix4::new_nonuniform_scaling(&Vector3::new(s[0], s[1], s[2]))
        }
        "rotate" => {
            let r = numbers(4)?;
            match Unit::try_new(Vector3::new(r[0], r[1], r[2]), 1e-12) {
                Some(axis) => Rotation3::from_axis_angle(&axis, r[3].to_radians()).to_homogeneous(),
                None => Matrix4::identity(),
            }
        }
        _ => Matrix4::identity(),
    })
}

fn floats(text: &str) -> Result<Vec<f64>, MeshError> {
    text.split_ascii_whitespace()
        .map(|w| w.parse().map_err(|_| malformed(&format!("`{w}` is not a number"))))
        .collect()
}

fn integers(text: &str) -> Result<Vec<i64>, MeshError> {
    text.split_ascii_whitespace()
        .map(|w| w.parse().map_err(|_| malformed(&format!("`{w}` is not an index"))))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::super::{MeshError, UpAxis, read};

    fn scene(nodes: &str, primitive: &str) -> String {
        format!(
            "<?xml version=\"1.0\"?><COLLADA xmlns=\"http://www.collada.org/2005/11/COLLADASchema\" version=\"1.4.1\">
             <asset><unit name=\"inch\" meter=\"0.5\"/><up_axis>Y_UP</up_axis></asset>
             <library_geometries><geometry id=\"g\"><mesh>
             <source id=\"p\"><float_array id=\"pa\" count=\"12\">0 0 0 1 0 0 1 1 0 0 1 0</float_array>
             <technique_common><accessor source=\"#pa\" count=\"4\" stride=\"3\"/></technique_common></source>
             <vertices id=\"v\"><input semantic=\"POSITION\" source=\"#p\"/></vertices>{primitive}
             </mesh></geometry></library_geometries>
             <library_nodes><node id=\"part\"><translate>0 0 4</translate><instance_geometry url=\"#g\"/></node></library_nodes>
             <library_visual_scenes><visual_scene id=\"s\">{nodes}</visual_scene></library_visual_scenes>
             <scene><instance_visual_scene url=\"#s\"/></scene></COLLADA>"
        )
    }

    const TRIANGLE: &str = "<triangles count=\"1\"><input semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/>\
                            <input semantic=\"NORMAL\" source=\"#n\" offset=\"1\"/><p>0 0 1 0 2 0</p></triangles>";

    #[test]
    fn units_and_nested_transforms_place_every_instance() {
        let nodes = "<node><translate>2 0 0</translate><rotate>0 0 1 90</rotate>\
                     <node><scale>2 2 2</scale><instance_geometry url=\"#g\"/></node></node>\
                     <node><instance_node url=\"#part\"/></node>";
        let loaded = read(scene(nodes, TRIANGLE).as_bytes(), "dae").unwrap();
        assert_eq!(loaded.up, Some(UpAxis::Y));
        let corner = |face: usize, i: usize| loaded.mesh.triangle(face)[i];
        // (1, 0, 0) doubled, turned to (0, 2, 0), moved to (2, 2, 0), halved by the unit.
        assert!((corner(0, 1) - nalgebra::Point3::new(1.0, 1.0, 0.0)).norm() < 1e-15);
        assert!((corner(1, 1) - nalgebra::Point3::new(0.5, 0.0, 2.0)).norm() < 1e-15);
        assert_eq!(loaded.mesh.faces.len(), 2);
    }

    /// A few nodes of two references each: the geometry at their end would be read a million times.
    #[test]
    fn references_that_multiply_are_refused() {
        let twice = |i: usize| format!("<instance_node url=\"#n{i}\"/>").repeat(2);
        let nodes: String = (1..14).map(|i| format!("<node id=\"n{i}\">{}</node>", twice(i - 1))).collect();
        let nodes = format!("<node id=\"n0\"><instance_geometry url=\"#g\"/></node>{nodes}");
        let list = format!("<p>{}</p></triangles>", "0 0 1 0 2 0 ".repeat(500));
        let primitive = TRIANGLE.replace("<p>0 0 1 0 2 0</p></triangles>", &list);
        let refused = read(scene(&nodes, &primitive).as_bytes(), "dae");
        assert!(refused.unwrap_err().to_string().contains("too many to be read"));
    }

    #[test]
    fn mirrors_keep_the_outside_outside() {
        let nodes = "<node><scale>-1 1 1</scale><instance_geometry url=\"#g\"/></node>";
        let loaded = read(scene(nodes, TRIANGLE).as_bytes(), "dae").unwrap();
        assert!(loaded.mesh.area_vector(0).z > 0.0);
    }

    #[test]
    fn all_primitives_give_the_same_square() {
        let input = "<input semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/>";
        let primitives = [
            format!("<triangles>{input}<p>0 1 2 0 2 3</p></triangles>"),
            format!("<polylist>{input}<vcount>4</vcount><p>0 1 2 3</p></polylist>"),
            format!("<polygons>{input}<p>0 1 2 3</p></polygons>"),
            format!("<trifans>{input}<p>0 1 2 3</p></trifans>"),
            format!("<tristrips>{input}<p>0 1 3 2</p></tristrips>"),
            format!(
                "<lines>{input}<p>0 1</p></lines><polygons>{input}<ph><p>0 1 2 3</p><h>0 1 2</h></ph></polygons>"
            ),
        ];
        for primitive in primitives {
            let text = scene("<node><instance_geometry url=\"#g\"/></node>", &primitive);
            let mesh = read(text.as_bytes(), "dae").unwrap().mesh;
            let area: f64 = (0..mesh.faces.len()).map(|f| mesh.area_vector(f).z / 2.0).sum();
            assert_eq!((mesh.faces.len(), area), (2, 0.25), "{primitive}");
        }
    }

    #[test]
    fn malformed_files_are_refused() {
        let input = "<input semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/>";
        let node = "<node><instance_geometry url=\"#g\"/></node>";
        let circle = "<node id=\"n\"><instance_node url=\"#n\"/></node>";
        let cases = [
            (scene(node, TRIANGLE).replace("0.5", "-1"), "the unit is not a positive number"),
            (
                scene(node, &format!("<polylist>{input}<vcount>9</vcount><p>0 1</p></polylist>")),
                "a polylist has fewer",
            ),
            (scene(node, TRIANGLE).replace("0 0 1 0 2 0", "0 0 x 0 2 0"), "`x` is not an index"),
            (scene(circle, TRIANGLE), "nodes are nested too deep"),
            (scene(node, TRIANGLE).replace("</COLLADA>", ""), "line 1: `<COLLADA>` is never closed"),
        ];
        for (text, expected) in cases {
            let error = read(text.as_bytes(), "dae").unwrap_err().to_string();
            assert!(error.starts_with(expected), "{error}");
        }
        assert_eq!(read(scene("<node/>", TRIANGLE).as_bytes(), "dae").unwrap_err(), MeshError::Empty);
    }
}
