//! Binary glTF 2.0 (Khronos Group, ISO/IEC 12113:2022).

use nalgebra::UnitQuaternion;
use robotc_core::Pose;
use robotc_core::ids::TypedVec;
use serde_json::{Value, json};

use super::block::{Block, Span};
use crate::record::{LineSet, Material, Node, NodeIdx, Recording, Surface, SurfaceIdx, Track};

const FLOAT: u32 = 5126;
const UNSIGNED_INT: u32 = 5125;
const VERTICES: u32 = 34962;
const INDICES: u32 = 34963;
const LINES: u32 = 1;

/// The recording as one binary glTF file, for any viewer or modelling program.
///
/// Each node of the recording is a node of the file with its name, under one root that turns z up into glTF's y up;
/// what moves has translation and rotation channels of one animation. Surfaces have physically based materials, lines
/// are unlit. What a page hides at first (grasps, search trees, frames) is left out, because viewers of glTF have no
/// switches. The same recording gives the same bytes.
pub fn glb(recording: &Recording) -> Vec<u8> {
    let mut document = Document::default();
    document.write(recording);
    container(&document.contents(&recording.title), document.block.as_bytes())
}

/// A file of a JSON chunk and a binary chunk.
fn container(contents: &Value, block: &[u8]) -> Vec<u8> {
    let mut text = contents.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let length = 12 + 8 + text.len() + 8 + block.len();
    let mut file = Vec::with_capacity(length);
    let word = |file: &mut Vec<u8>, n: usize| {
        let n = u32::try_from(n).expect("a glTF file is smaller than 4 GiB");
        file.extend_from_slice(&n.to_le_bytes());
    };
    file.extend_from_slice(b"glTF");
    word(&mut file, 2);
    word(&mut file, length);
    word(&mut file, text.len());
    file.extend_from_slice(b"JSON");
    file.extend_from_slice(&text);
    word(&mut file, block.len());
    file.extend_from_slice(b"BIN\0");
    file.extend_from_slice(block);
    file
}

/// The tables of a glTF file as they grow.
#[derive(Default)]
struct Document {
    block: Block,
    views: Vec<Value>,
    accessors: Vec<Value>,
    materials: Vec<Value>,
    meshes: Vec<Value>,
    nodes: Vec<Value>,
    channels: Vec<Value>,
    samplers: Vec<Value>,
    known_materials: Vec<Material>,
    /// Accessors of positions, normals and indices of each surface written so far.
    known_surfaces: Vec<(SurfaceIdx, [usize; 3])>,
    known_meshes: Vec<((SurfaceIdx, usize), usize)>,
}

fn push(table: &mut Vec<Value>, item: Value) -> usize {
    table.push(item);
    table.len() - 1
}

impl Document {
    fn write(&mut self, recording: &Recording) {
        // The root is node 0; its children are known last.
        self.nodes.push(Value::Null);
        let mut written: TypedVec<NodeIdx, Option<usize>> = TypedVec::new();
        let mut children: Vec<Vec<usize>> = vec![Vec::new()];
        for node in recording.nodes() {
            let parent = node.parent.map_or(Some(0), |parent| written[parent]);
            let Some(parent) = parent.filter(|_| node.group.shown_at_first()) else {
                written.push(None);
                continue;
            };
            let index = push(&mut self.nodes, named_pose(&node.name, &node.track.at(0.0)));
            let own = self.write_contents(recording, node);
            children.resize(self.nodes.len(), Vec::new());
            children[index] = own;
            children[parent].push(index);
            self.write_track(index, &node.track);
            written.push(Some(index));
        }
        let up = Pose::from_parts(
            nalgebra::Translation3::identity(),
            UnitQuaternion::from_axis_angle(&nalgebra::Vector3::x_axis(), -std::f64::consts::FRAC_PI_2),
        );
        self.nodes[0] = named_pose(&recording.title, &up);
        for (node, children) in self.nodes.iter_mut().zip(children) {
            if !children.is_empty() {
                node["children"] = json!(children);
            }
        }
    }

    /// Nodes for the parts and lines of a node.
    fn write_contents(&mut self, recording: &Recording, node: &Node) -> Vec<usize> {
        let mut own = Vec::new();
        for part in &node.parts {
            let surface = &recording.surfaces()[part.surface];
            if surface.triangles.is_empty() {
                continue;
            }
            let mesh = self.surface_mesh(part.surface, surface, &part.material);
            let mut child = named_pose(&node.name, &part.node_from_part);
            child["mesh"] = json!(mesh);
            own.push(push(&mut self.nodes, child));
        }
        for lines in node.lines.iter().filter(|lines| !lines.segments.is_empty()) {
            let mesh = self.line_mesh(lines);
            own.push(push(&mut self.nodes, json!({ "name": node.name, "mesh": mesh })));
        }
        own
    }

    fn write_track(&mut self, node: usize, track: &Track) {
        if !track.moves() {
            return;
        }
        let samples = track.samples();
        let times: Vec<f32> = samples.iter().map(|s| s.time as f32).collect();
        let (first, last) = (times[0], times[times.len() - 1]);
        let span = self.block.put_f32(times);
        let input = self.accessor(span, 1, FLOAT, None, Some((vec![first], vec![last])));
        let translations = samples.iter().flat_map(|s| translation(&s.pose));
        let rotations = samples.iter().flat_map(|s| rotation(&s.pose));
        let translations = self.block.put_f32(translations);
        let rotations = self.block.put_f32(rotations);
        for (path, span, width) in [("translation", translations, 3), ("rotation", rotations, 4)] {
            let output = self.accessor(span, width, FLOAT, None, None);
            let sampler = json!({ "input": input, "output": output, "interpolation": "LINEAR" });
            let sampler = push(&mut self.samplers, sampler);
            self.channels.push(json!({ "sampler": sampler, "target": { "node": node, "path": path } }));
        }
    }

    fn surface_mesh(&mut self, index: SurfaceIdx, surface: &Surface, material: &Material) -> usize {
        let material = self.material(material);
        let key = (index, material);
        if let Some((_, known)) = self.known_meshes.iter().find(|(k, _)| *k == key) {
            return *known;
        }
        let [positions, normals, indices] = self.surface_accessors(index, surface);
        let mesh = push(
            &mut self.meshes,
            json!({ "primitives": [{
                "attributes": { "POSITION": positions, "NORMAL": normals },
                "indices": indices,
                "material": material,
            }]}),
        );
        self.known_meshes.push((key, mesh));
        mesh
    }

    fn surface_accessors(&mut self, index: SurfaceIdx, surface: &Surface) -> [usize; 3] {
        if let Some((_, known)) = self.known_surfaces.iter().find(|(k, _)| *k == index) {
            return *known;
        }
        let accessors = [
            self.positions(&surface.positions),
            self.vectors(&surface.normals),
            self.indices(surface.triangles.as_flattened()),
        ];
        self.known_surfaces.push((index, accessors));
        accessors
    }

    fn line_mesh(&mut self, lines: &LineSet) -> usize {
        let positions = self.positions(&lines.points);
        let colours: Vec<f32> = (0..lines.points.len())
            .flat_map(|i| {
                let [r, g, b, opacity] = lines.colour(i);
                [linear(r), linear(g), linear(b), opacity]
            })
            .collect();
        let span = self.block.put_f32(colours);
        let colours = self.accessor(span, 4, FLOAT, Some(VERTICES), None);
        let indices = self.indices(lines.segments.as_flattened());
        let material = json!({
            "name": "line",
            "pbrMetallicRoughness": { "baseColorFactor": [1, 1, 1, 1], "metallicFactor": 0, "roughnessFactor": 1 },
            "alphaMode": "BLEND",
            "extensions": { "KHR_materials_unlit": {} },
        });
        let material = match self.materials.iter().position(|known| *known == material) {
            Some(known) => known,
            None => {
                // Keeps both tables in step; no surface can ask for a material that is not a number.
                self.known_materials.push(Material { colour: [f32::NAN; 4], roughness: 0.0, metallic: 0.0 });
                push(&mut self.materials, material)
            }
        };
        let primitive = json!({
            "attributes": { "POSITION": positions, "COLOR_0": colours },
            "indices": indices,
            "material": material,
            "mode": LINES,
        });
        push(&mut self.meshes, json!({ "primitives": [primitive] }))
    }

    fn material(&mut self, material: &Material) -> usize {
        if let Some(known) = self.known_materials.iter().position(|known| known == material) {
            return known;
        }
        let [r, g, b, opacity] = material.colour;
        self.known_materials.push(*material);
        push(
            &mut self.materials,
            json!({
                "pbrMetallicRoughness": {
                    "baseColorFactor": [linear(r), linear(g), linear(b), opacity],
                    "metallicFactor": material.metallic,
                    "roughnessFactor": material.roughness,
                },
                "alphaMode": if opacity < 1.0 { "BLEND" } else { "OPAQUE" },
                "doubleSided": true,
            }),
        )
    }

    fn positions(&mut self, points: &[[f32; 3]]) -> usize {
        let bound = |pick: fn(f32, f32) -> f32| {
            (0..3).map(|k| points.iter().map(|p| p[k]).reduce(pick).unwrap_or(0.0)).collect::<Vec<f32>>()
        };
        let bounds = (bound(f32::min), bound(f32::max));
        let span = self.block.put_f32(points.as_flattened().iter().copied());
        self.accessor(span, 3, FLOAT, Some(VERTICES), Some(bounds))
    }

    fn vectors(&mut self, vectors: &[[f32; 3]]) -> usize {
        let span = self.block.put_f32(vectors.as_flattened().iter().copied());
        self.accessor(span, 3, FLOAT, Some(VERTICES), None)
    }

    fn indices(&mut self, indices: &[u32]) -> usize {
        let span = self.block.put(indices.iter().map(|i| i.to_le_bytes()));
        self.accessor(span, 1, UNSIGNED_INT, Some(INDICES), None)
    }

    /// An accessor of elements of `width` components, with a buffer view of its own.
    fn accessor(
        &mut self,
        span: Span,
        width: usize,
        component: u32,
        target: Option<u32>,
        bounds: Option<(Vec<f32>, Vec<f32>)>,
    ) -> usize {
        // Components of all accessors here are four bytes wide.
        let mut view = json!({ "buffer": 0, "byteOffset": span.offset, "byteLength": 4 * span.count });
        if let Some(target) = target {
            view["target"] = json!(target);
        }
        let kind = ["SCALAR", "VEC2", "VEC3", "VEC4"][width - 1];
        let mut accessor = json!({
            "bufferView": push(&mut self.views, view),
            "componentType": component,
            "count": span.count / width,
            "type": kind,
        });
        if let Some((min, max)) = bounds {
            accessor["min"] = json!(min);
            accessor["max"] = json!(max);
        }
        push(&mut self.accessors, accessor)
    }

    /// The JSON part. Tables without entries are left out, as the format wants.
    fn contents(&self, title: &str) -> Value {
        let mut contents = json!({
            "asset": { "version": "2.0", "generator": "robotc" },
            "scene": 0,
            "scenes": [{ "name": title, "nodes": [0] }],
            "nodes": self.nodes,
        });
        let tables = [
            ("bufferViews", &self.views),
            ("accessors", &self.accessors),
            ("materials", &self.materials),
            ("meshes", &self.meshes),
        ];
        for (name, table) in tables {
            if !table.is_empty() {
                contents[name] = json!(table);
            }
        }
        if !self.block.as_bytes().is_empty() {
            contents["buffers"] = json!([{ "byteLength": self.block.as_bytes().len() }]);
        }
        if !self.channels.is_empty() {
            contents["animations"] =
                json!([{ "name": title, "channels": self.channels, "samplers": self.samplers }]);
        }
        if self.materials.iter().any(|m| m.get("extensions").is_some()) {
            contents["extensionsUsed"] = json!(["KHR_materials_unlit"]);
        }
        contents
    }
}

fn named_pose(name: &str, pose: &Pose) -> Value {
    let mut node = json!({ "name": name });
    if pose.translation.vector.norm() > 0.0 {
        node["translation"] = json!(translation(pose));
    }
    if pose.rotation.angle() > 0.0 {
        node["rotation"] = json!(rotation(pose));
    }
    node
}

fn translation(pose: &Pose) -> [f32; 3] {
    pose.translation.vector.map(|x| x as f32).into()
}

/// Quaternion x y z w.
fn rotation(pose: &Pose) -> [f32; 4] {
    pose.rotation.coords.normalize().map(|x| x as f32).into()
}

/// Linear light of an sRGB component (IEC 61966-2-1).
fn linear(c: f32) -> f32 {
    if c <= 0.04045 { c / 12.92 } else { libm::powf((c + 0.055) / 1.055, 2.4) }
}
