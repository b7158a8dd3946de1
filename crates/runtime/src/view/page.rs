//! The page: one HTML file that holds viewer and scene, and needs nothing else.

use robotc_core::Pose;
use robotc_core::ids::Idx;
use serde::Serialize;

use super::block::{Block, Span};
use super::{base64, camera};
use crate::record::{Bounds, Group, Label, LineSet, Node, Recording, Stage, Surface};

const TEMPLATE: &str = include_str!("page/page.html");
const STYLE: &str = include_str!("page/page.css");

macro_rules! sources {
    ($folder:literal: $($name:literal),* $(,)?) => {
        [$(($name, include_str!(concat!("page/", $folder, "/", $name)))),*]
    };
}

/// Modules of the viewer, each after those it imports.
const MODULES: [(&str, &str); 11] = sources!("js":
    "math.js", "gl.js", "scene.js", "timeline.js", "camera.js", "pick.js", "surfaces.js", "lines.js", "labels.js",
    "panel.js", "renderer.js");
const MAIN: &str = include_str!("page/js/main.js");

const SHADERS: [(&str, &str); 12] = sources!("shaders":
    "background.frag", "blur.frag", "depth.frag", "floor.frag", "floor.vert", "light.glsl", "line.frag", "line.vert",
    "openness.frag", "screen.vert", "surface.frag", "surface.vert");

/// The recording as one HTML file, to be opened in any browser with WebGL 2, without a network.
///
/// The address takes wishes: `#t=2.5` stops at a time in seconds, `#t=end` at the last, `#theme=dark` chooses the
/// colours; join them with `&`. The same recording gives the same bytes.
pub fn html(recording: &Recording) -> String {
    let mut block = Block::default();
    let scene =
        serde_json::to_string(&scene_of(recording, &mut block)).expect("the scene has string keys only");
    let shaders: String = SHADERS
        .iter()
        .map(|(name, source)| format!("<script type=\"x-shader\" id=\"{name}\">\n{source}</script>\n"))
        .collect();
    let script: String = MODULES.iter().map(|(_, source)| *source).chain([MAIN]).map(joined).collect();
    let values = [
        ("title", escaped(&recording.title)),
        ("style", STYLE.to_owned()),
        // Within a script element only `<` can end it.
        ("scene", scene.replace('<', "\\u003c")),
        ("data", base64::encode(block.as_bytes())),
        ("shaders", shaders),
        ("script", script),
    ];
    fill(TEMPLATE, &values)
}

/// The template with `{{name}}` replaced by values; what a value holds is not looked at again.
fn fill(template: &str, values: &[(&str, String)]) -> String {
    let mut page = String::new();
    let mut rest = template;
    while let Some((before, after)) = rest.split_once("{{") {
        let (name, after) = after.split_once("}}").expect("the template closes its braces");
        let (_, value) =
            values.iter().find(|(known, _)| *known == name).expect("the template names known values");
        page.push_str(before);
        page.push_str(value);
        rest = after;
    }
    page.push_str(rest);
    page
}

/// A module's source in a scope that all modules share: imports fall away, exports become plain declarations.
fn joined(module: &str) -> String {
    let kept = module.lines().filter(|line| !line.starts_with("import "));
    kept.map(|line| format!("{}\n", line.strip_prefix("export ").unwrap_or(line))).collect()
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;")
}

/// The table of contents that `js/scene.js` reads.
#[derive(Serialize)]
struct Scene<'a> {
    title: &'a str,
    duration: f64,
    facts: Vec<(&'a str, &'a str)>,
    stages: Vec<SceneStage<'a>>,
    groups: Vec<SceneGroup>,
    camera: SceneCamera,
    /// What is framed.
    focus: Vec<SceneBounds>,
    /// What casts shadows.
    reach: SceneBounds,
    /// Height of the floor.
    floor: f64,
    surfaces: Vec<SceneSurface>,
    nodes: Vec<SceneNode<'a>>,
    labels: Vec<SceneLabel<'a>>,
}

#[derive(Serialize)]
struct SceneStage<'a> {
    name: &'a str,
    start: f64,
    end: f64,
}

#[derive(Serialize)]
struct SceneGroup {
    id: usize,
    title: &'static str,
    shown: bool,
}

#[derive(Serialize)]
struct SceneCamera {
    azimuth: f64,
    elevation: f64,
    fov_y: f64,
}

#[derive(Serialize)]
struct SceneBounds {
    low: [f64; 3],
    high: [f64; 3],
}

/// Vertices are ten bytes: position as three 16-bit shares of the box, normal as two octahedral 16-bit numbers.
#[derive(Serialize)]
struct SceneSurface {
    low: [f32; 3],
    size: [f32; 3],
    vertices: Span,
    indices: Span,
    wide: bool,
}

#[derive(Serialize)]
struct SceneNode<'a> {
    name: &'a str,
    group: usize,
    parent: Option<usize>,
    pose: [f32; 7],
    #[serde(skip_serializing_if = "Option::is_none")]
    track: Option<SceneTrack>,
    parts: Vec<ScenePart>,
    lines: Vec<SceneLines>,
}

#[derive(Serialize)]
struct SceneTrack {
    times: Span,
    poses: Span,
}

#[derive(Serialize)]
struct ScenePart {
    surface: usize,
    colour: [f32; 4],
    roughness: f32,
    metallic: f32,
    pose: [f32; 7],
}

/// For each segment, both ends: point and time; and both colours.
#[derive(Serialize)]
struct SceneLines {
    width: f32,
    /// Whether it takes the colours of stages instead of its own.
    staged: bool,
    ends: Span,
    colours: Span,
}

#[derive(Serialize)]
struct SceneLabel<'a> {
    text: &'a str,
    node: Option<usize>,
    point: [f64; 3],
}

fn scene_of<'a>(recording: &'a Recording, block: &mut Block) -> Scene<'a> {
    let camera = camera::Camera::opening(recording, [1.0, 1.0]);
    let focus = camera::focus(recording);
    let solid = recording.bounds(&[Group::Robot, Group::Object, Group::Obstacle, Group::Reach]);
    let reach = solid.unwrap_or(focus[0]);
    // What is within reach may be below the floor that a robot stands on.
    let standing = recording.bounds(&[Group::Robot, Group::Object, Group::Obstacle]).unwrap_or(reach);
    Scene {
        title: &recording.title,
        duration: recording.duration(),
        facts: recording.facts.iter().map(|f| (f.name.as_str(), f.value.as_str())).collect(),
        stages: recording.stages.iter().map(scene_stage).collect(),
        groups: groups_of(recording),
        camera: SceneCamera { azimuth: camera.azimuth, elevation: camera.elevation, fov_y: camera.fov_y },
        focus: focus.iter().map(scene_bounds).collect(),
        floor: standing.low.z.min(0.0),
        reach: scene_bounds(&reach),
        surfaces: recording.surfaces().iter().map(|s| scene_surface(s, block)).collect(),
        nodes: recording.nodes().iter().map(|n| scene_node(n, block)).collect(),
        labels: recording.labels.iter().map(scene_label).collect(),
    }
}

fn scene_stage(stage: &Stage) -> SceneStage<'_> {
    SceneStage { name: &stage.name, start: stage.start, end: stage.end }
}

/// The groups that something belongs to.
fn groups_of(recording: &Recording) -> Vec<SceneGroup> {
    let used = Group::ALL.into_iter().filter(|g| recording.nodes().iter().any(|n| n.group == *g));
    used.map(|g| SceneGroup { id: g as usize, title: g.title(), shown: g.shown_at_first() }).collect()
}

fn scene_bounds(bounds: &Bounds) -> SceneBounds {
    SceneBounds { low: bounds.low.into(), high: bounds.high.into() }
}

fn scene_label(label: &Label) -> SceneLabel<'_> {
    SceneLabel { text: &label.text, node: label.node.map(Idx::index), point: label.p_in_node.into() }
}

fn scene_surface(surface: &Surface, block: &mut Block) -> SceneSurface {
    let (low, high) = surface.bounds().unwrap_or_default();
    let size: [f32; 3] = std::array::from_fn(|k| high[k] - low[k]);
    let share = |p: &[f32; 3], k: usize| {
        let share = if size[k] > 0.0 { (p[k] - low[k]) / size[k] } else { 0.0 };
        ((share * 65535.0).round() as u16).to_le_bytes()
    };
    let vertices = surface.positions.iter().zip(&surface.normals).flat_map(|(p, n)| {
        let [u, v] = octahedral(n).map(|x| ((x * 32767.0).round() as i16).to_le_bytes());
        [share(p, 0), share(p, 1), share(p, 2), u, v]
    });
    let vertices = block.put(vertices.collect::<Vec<_>>());
    let wide = surface.positions.len() > usize::from(u16::MAX);
    let indices = surface.triangles.iter().flatten();
    let indices = if wide {
        block.put(indices.map(|i| i.to_le_bytes()))
    } else {
        block.put(indices.map(|&i| (i as u16).to_le_bytes()))
    };
    SceneSurface { low, size, vertices, indices, wide }
}

/// A unit vector as a point of the square -1..1: the octahedron unfolded (Meyer et al., "On floating-point normal
/// vectors", 2010).
fn octahedral([x, y, z]: &[f32; 3]) -> [f32; 2] {
    let sum = x.abs() + y.abs() + z.abs();
    let (u, v) = (x / sum, y / sum);
    let side = |a: f32| if a >= 0.0 { 1.0 } else { -1.0 };
    if *z >= 0.0 { [u, v] } else { [(1.0 - v.abs()) * side(u), (1.0 - u.abs()) * side(v)] }
}

fn scene_node<'a>(node: &'a Node, block: &mut Block) -> SceneNode<'a> {
    let samples = node.track.samples();
    let track = node.track.moves().then(|| SceneTrack {
        times: block.put_f32(samples.iter().map(|s| s.time as f32)),
        poses: block.put_f32(samples.iter().flat_map(|s| numbers(&s.pose))),
    });
    let parts = node.parts.iter().map(|part| ScenePart {
        surface: part.surface.index(),
        colour: part.material.colour,
        roughness: part.material.roughness,
        metallic: part.material.metallic,
        pose: numbers(&part.node_from_part),
    });
    SceneNode {
        name: &node.name,
        group: node.group as usize,
        parent: node.parent.map(Idx::index),
        pose: numbers(&node.track.at(0.0)),
        track,
        parts: parts.collect(),
        lines: node.lines.iter().map(|l| scene_lines(l, node.group, block)).collect(),
    }
}

fn scene_lines(lines: &LineSet, group: Group, block: &mut Block) -> SceneLines {
    let ends = || lines.segments.iter().flatten().map(|&i| i as usize);
    // Points without a time were always there.
    let time = |point: usize| lines.times.get(point).copied().unwrap_or(f32::MIN);
    let places = ends().flat_map(|i| {
        let [x, y, z] = lines.points[i];
        [x, y, z, time(i)]
    });
    let colours = ends().flat_map(|i| lines.colour(i)).map(|c| [(c.clamp(0.0, 1.0) * 255.0).round() as u8]);
    SceneLines {
        width: lines.width,
        staged: group == Group::Path && !lines.times.is_empty(),
        ends: block.put_f32(places),
        colours: block.put(colours),
    }
}

/// Translation, then quaternion x y z w.
fn numbers(pose: &Pose) -> [f32; 7] {
    let (t, q) = (pose.translation.vector, pose.rotation.coords);
    [t.x, t.y, t.z, q.x, q.y, q.z, q.w].map(|x| x as f32)
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;
    use std::path::Path;

    use nalgebra::Vector3;

    use super::*;

    fn names_in(folder: &str) -> BTreeSet<String> {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/view/page").join(folder);
        let entries = std::fs::read_dir(folder).expect("the folder is there");
        entries.map(|e| e.expect("an entry").file_name().to_string_lossy().into_owned()).collect()
    }

    #[test]
    fn every_source_is_part_of_the_page() {
        let listed = |sources: &[(&str, &str)]| sources.iter().map(|(n, _)| (*n).to_owned()).collect();
        let mut modules: BTreeSet<String> = listed(&MODULES);
        modules.insert("main.js".to_owned());
        assert_eq!(names_in("js"), modules);
        assert_eq!(names_in("shaders"), listed(&SHADERS));
    }

    #[test]
    fn modules_import_what_came_before_and_share_no_name() {
        let (mut before, mut declared) = (BTreeSet::new(), BTreeSet::new());
        for (name, source) in MODULES.into_iter().chain([("main.js", MAIN)]) {
            for line in source.lines() {
                if let Some((_, from)) = line.split_once("} from './").filter(|_| line.starts_with("import "))
                {
                    let from = from.trim_end_matches("';");
                    assert!(before.contains(from), "{name} imports {from}, which comes later");
                }
                let line = line.strip_prefix("export ").unwrap_or(line);
                let mut words = line.split([' ', '(', '=', ';']);
                if let (Some("const" | "function" | "class" | "let"), Some(word)) =
                    (words.next(), words.next())
                {
                    assert!(declared.insert(word), "{word} of {name} is declared twice");
                }
            }
            before.insert(name);
        }
    }

    #[test]
    fn octahedral_normals_come_back() {
        let unfolded = |[u, v]: [f32; 2]| {
            let z = 1.0 - u.abs() - v.abs();
            let back = (-z).max(0.0);
            let shift = |a: f32| if a >= 0.0 { a - back } else { a + back };
            Vector3::new(shift(u), shift(v), z).normalize()
        };
        for i in 0..400u16 {
            let (height, turn) = (f32::from(i) / 199.5 - 1.0, f32::from(i) * 2.4);
            let across = (1.0 - height * height).max(0.0).sqrt();
            let n = [across * libm::cosf(turn), across * libm::sinf(turn), height];
            assert!((unfolded(octahedral(&n)) - Vector3::from(n)).norm() < 1e-5, "{n:?}");
        }
    }

    #[test]
    fn vertices_lie_within_half_a_step_of_where_they_are() {
        let surface = Surface {
            positions: vec![[0.0, -1.0, 5.0], [0.3, 2.0, 5.0], [1.0, 0.5, 5.0]],
            normals: vec![[0.0, 0.0, 1.0]; 3],
            triangles: vec![[0, 1, 2]],
        };
        let mut block = Block::default();
        let scene = scene_surface(&surface, &mut block);
        let words: Vec<u16> =
            block.as_bytes().chunks_exact(2).map(|b| u16::from_le_bytes([b[0], b[1]])).collect();
        for (vertex, position) in surface.positions.iter().enumerate() {
            for k in 0..3 {
                let share = f32::from(words[5 * vertex + k]) / 65535.0;
                let error = (scene.low[k] + share * scene.size[k] - position[k]).abs();
                assert!(error <= scene.size[k] / 65535.0, "vertex {vertex}: {error}");
            }
        }
        assert_eq!((scene.vertices.count, scene.indices.count, scene.wide), (15, 3, false));
    }
}
