//! A recording as a still picture: shaded triangles and lines, projected as the page first shows them.
//!
//! An item buffer of the size of the picture finds the triangles of which anything is seen; only those are written, far ones
//! first. So files stay small, and what is hidden needs no care.

use std::fmt::Write;

use nalgebra::{Point3, Vector3};

use super::camera::Camera;
use crate::record::{Group, Recording};

/// Height of the title, and its distance from the edges, pixels.
const TITLE: f64 = 18.0;
const MARGIN: f64 = 16.0;
/// Opacity of lines behind surfaces.
const BEHIND: f32 = 0.2;
/// Pieces of a line that are looked at one by one are no longer than this, pixels.
const PIECE: f64 = 12.0;
/// How far behind a surface, as a share of its distance, a line still counts as on it.
const ON_SURFACE: f64 = 4e-3;

/// The picture of a recording at a time, `size` pixels wide and high, as the text of an SVG file. The moment is that of the
/// timeline, seconds.
pub fn svg(recording: &Recording, time: f64, size: [u32; 2]) -> String {
    let eye = Camera::still(recording, size.map(f64::from));
    let mut buffer = Buffer::new(size);
    let mut triangles = Vec::new();
    let mut lines = String::new();
    for (index, node) in recording.nodes().enumerate().filter(|(_, node)| shown(node.group)) {
        let world_from_node = recording.world_from_node(index, time);
        for part in &node.parts {
            let world_from_part = world_from_node * part.node_from_part;
            let surface = &recording.surfaces()[part.surface];
            let place = |v: u32| world_from_part * Point3::from(surface.positions[v as usize].map(f64::from));
            let normal = |v: u32| world_from_part * Vector3::from(surface.normals[v as usize].map(f64::from));
            for corners in &surface.triangles {
                let Some(seen) = all(corners.map(|v| eye.see(&place(v)))) else { continue };
                buffer.add(&seen, triangles.len() as u32);
                let normal: Vector3<f64> = corners.iter().map(|&v| normal(v)).sum();
                triangles.push(Triangle { seen, fill: shaded(part.material.colour, &normal, &eye.back()) });
            }
        }
    }
    for (index, node) in recording.nodes().enumerate().filter(|(_, node)| shown(node.group)) {
        let world_from_node = recording.world_from_node(index, time);
        for set in &node.lines {
            for segment in &set.segments {
                let early = |&v: &u32| set.times.get(v as usize).is_some_and(|&t| f64::from(t) > time);
                let place = |v: u32| world_from_node * Point3::from(set.points[v as usize].map(f64::from));
                if let Some(ends) =
                    all(segment.map(|v| eye.see(&place(v)))).filter(|_| !segment.iter().any(early))
                {
                    let colour = set.colour(segment[0] as usize);
                    write_line(&mut lines, &ends, colour, set.width, &buffer);
                }
            }
        }
    }
    let [width, height] = size;
    let mut text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\" \
         stroke-linejoin=\"round\" stroke-linecap=\"round\">\n<title>{}</title>\n<rect width=\"100%\" height=\"100%\" fill=\"#f6f7f9\"/>\n",
        escaped(&recording.title)
    );
    write_triangles(&mut text, &triangles, &buffer);
    text += &lines;
    let _ = writeln!(
        text,
        "<text x=\"{MARGIN}\" y=\"{}\" font-family=\"sans-serif\" font-size=\"{TITLE}\" fill=\"#2b2f36\">{}</text>\n</svg>",
        MARGIN + TITLE,
        escaped(&recording.title)
    );
    text
}

/// The moment that a still picture shows best: when the first stage ends.
pub fn telling_moment(recording: &Recording) -> f64 {
    recording.stages.first().map_or(0.0, |stage| stage.start + 0.98 * (stage.end - stage.start))
}

fn shown(group: Group) -> bool {
    !matches!(group, Group::Tree | Group::Frame)
}

/// All three or two points, if all are ahead of the eye.
fn all<const N: usize>(points: [Option<[f64; 3]>; N]) -> Option<[[f64; 3]; N]> {
    points.iter().all(Option::is_some).then(|| points.map(Option::unwrap_or_default))
}

/// Corners as seen: pixels from left and top, and distance from the eye.
struct Triangle {
    seen: [[f64; 3]; 3],
    fill: [u8; 3],
}

/// Which triangle is nearest in each pixel, and how far away.
struct Buffer {
    size: [usize; 2],
    nearest: Vec<f64>,
    item: Vec<u32>,
}

impl Buffer {
    fn new(size: [u32; 2]) -> Self {
        let size = size.map(|n| n as usize);
        let count = size[0] * size[1];
        Self { size, nearest: vec![f64::INFINITY; count], item: vec![u32::MAX; count] }
    }

    /// Enters a triangle into all pixels whose middle it covers; one smaller than a pixel into that of its middle.
    fn add(&mut self, [a, b, c]: &[[f64; 3]; 3], item: u32) {
        let area = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
        let span = |axis: usize| {
            let low = a[axis].min(b[axis]).min(c[axis]).clamp(0.0, self.size[axis] as f64) as usize;
            let high = a[axis].max(b[axis]).max(c[axis]).clamp(0.0, self.size[axis] as f64).ceil() as usize;
            low..high
        };
        let (columns, rows) = (span(0), span(1));
        if area.abs() < 0.5 {
            let middle = [0, 1, 2].map(|k| (a[k] + b[k] + c[k]) / 3.0);
            self.enter(middle[0] as usize, middle[1] as usize, middle[2], item);
            return;
        }
        for row in rows {
            for column in columns.clone() {
                let (x, y) = (column as f64 + 0.5, row as f64 + 0.5);
                let share = |p: &[f64; 3], q: &[f64; 3]| {
                    ((q[0] - p[0]) * (y - p[1]) - (x - p[0]) * (q[1] - p[1])) / area
                };
                let [u, v, w] = [share(b, c), share(c, a), share(a, b)];
                if u >= 0.0 && v >= 0.0 && w >= 0.0 {
                    // Distances are not linear on the screen; their inverses are.
                    let depth = 1.0 / (u / a[2] + v / b[2] + w / c[2]);
                    self.enter(column, row, depth, item);
                }
            }
        }
    }

    fn enter(&mut self, column: usize, row: usize, depth: f64, item: u32) {
        if column < self.size[0] && row < self.size[1] {
            let pixel = row * self.size[0] + column;
            if depth < self.nearest[pixel] {
                (self.nearest[pixel], self.item[pixel]) = (depth, item);
            }
        }
    }

    /// Whether something is in front of a point.
    fn hides(&self, [x, y, depth]: &[f64; 3]) -> bool {
        let (column, row) = (*x as usize, *y as usize);
        let inside = *x >= 0.0 && *y >= 0.0 && column < self.size[0] && row < self.size[1];
        inside && self.nearest[row * self.size[0] + column] < depth * (1.0 - ON_SURFACE)
    }
}

/// The triangles that are seen, far ones first; neighbours in this order of one colour share a path.
fn write_triangles(text: &mut String, triangles: &[Triangle], buffer: &Buffer) {
    let mut seen: Vec<u32> = buffer.item.iter().copied().filter(|&item| item != u32::MAX).collect();
    seen.sort_unstable();
    seen.dedup();
    let depth = |&item: &u32| triangles[item as usize].seen.iter().map(|p| p[2]).sum::<f64>();
    seen.sort_by(|a, b| depth(b).total_cmp(&depth(a)));
    let mut fill = None;
    for item in seen {
        let Triangle { seen: [a, b, c], fill: own } = &triangles[item as usize];
        if fill != Some(own) {
            let [red, green, blue] = own;
            let colour = format!("#{red:02x}{green:02x}{blue:02x}");
            let close = if fill.is_some() { "\"/>\n" } else { "" };
            // A thin edge of the same colour closes the seams between triangles.
            let _ =
                write!(text, "{close}<path fill=\"{colour}\" stroke=\"{colour}\" stroke-width=\"0.6\" d=\"");
            fill = Some(own);
        }
        let _ = write!(text, "M{:.1} {:.1}L{:.1} {:.1}L{:.1} {:.1}Z", a[0], a[1], b[0], b[1], c[0], c[1]);
    }
    if fill.is_some() {
        *text += "\"/>\n";
    }
}

/// A line in pieces, faint where it is hidden.
fn write_line(text: &mut String, [from, to]: &[[f64; 3]; 2], colour: [f32; 4], width: f32, buffer: &Buffer) {
    let length = ((to[0] - from[0]).powi(2) + (to[1] - from[1]).powi(2)).sqrt();
    let pieces = (length / PIECE).ceil().clamp(1.0, 100.0) as usize;
    let at = |i: f64| [0, 1, 2].map(|k| from[k] + (to[k] - from[k]) * i / pieces as f64);
    let hidden: Vec<bool> = (0..pieces).map(|i| buffer.hides(&at(i as f64 + 0.5))).collect();
    let [red, green, blue, opacity] = colour;
    let hex = [red, green, blue].map(|c| (c.clamp(0.0, 1.0) * 255.0).round() as u8);
    let mut first = 0;
    for run in hidden.chunk_by(|a, b| a == b) {
        let (a, b) = (at(first as f64), at((first + run.len()) as f64));
        let opacity = if run[0] { BEHIND * opacity } else { opacity };
        let _ = writeln!(
            text,
            "<path d=\"M{:.1} {:.1}L{:.1} {:.1}\" stroke=\"#{:02x}{:02x}{:02x}\" stroke-width=\"{width}\" stroke-opacity=\"{opacity:.2}\"/>",
            a[0], a[1], b[0], b[1], hex[0], hex[1], hex[2]
        );
        first += run.len();
    }
}

/// A colour in the light of a sky and of a lamp behind the eye; few steps, so that neighbours share theirs.
fn shaded([r, g, b, _]: [f32; 4], normal: &Vector3<f64>, towards_eye: &Vector3<f64>) -> [u8; 3] {
    let normal = normal.try_normalize(1e-12).unwrap_or(*towards_eye);
    // Surfaces of thin sheets are seen from both sides.
    let normal = if normal.dot(towards_eye) < 0.0 { -normal } else { normal };
    let lamp = (towards_eye + Vector3::new(0.2, -0.3, 0.6)).normalize();
    let light = 0.42 + 0.12 * normal.z + 0.5 * normal.dot(&lamp).max(0.0);
    [r, g, b].map(|c| {
        let value = (f64::from(c) * light).clamp(0.0, 1.0);
        ((value * 63.0).round() * 255.0 / 63.0) as u8
    })
}

/// Text as markup has it.
pub fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use robotc_core::Pose;
    use robotc_core::model::{Geometry, Origin, Shape};

    use super::*;

    fn block(recording: &mut Recording, name: &str, size: [f64; 3], at: [f64; 3]) {
        let shape = Geometry { origin: Origin::default(), shape: Shape::Box { size }, colour: None };
        recording.add_body(name, Group::Object, &[shape], Pose::translation(at[0], at[1], at[2]));
    }

    fn triangles(svg: &str) -> usize {
        svg.lines()
            .filter(|line| line.contains("fill=\"#") && line.contains('Z'))
            .map(|l| l.matches('Z').count())
            .sum()
    }

    #[test]
    fn what_is_hidden_is_not_written() {
        let mut recording = Recording::new("a <block>");
        block(&mut recording, "outer", [1.0; 3], [0.0; 3]);
        let alone = svg(&recording, 0.0, [640, 480]);
        block(&mut recording, "inner", [0.5; 3], [0.0; 3]);
        let both = svg(&recording, 0.0, [640, 480]);
        assert!(triangles(&alone) >= 6 && alone.contains("a &lt;block&gt;"));
        assert_eq!(alone, both);
        block(&mut recording, "beside", [0.5; 3], [2.0, 0.0, 0.0]);
        assert!(triangles(&svg(&recording, 0.0, [640, 480])) > triangles(&alone));
    }

    #[test]
    fn lines_behind_a_block_are_faint() {
        let mut recording = Recording::new("t");
        block(&mut recording, "block", [1.0; 3], [0.0; 3]);
        let line = |z: f64| {
            let line = crate::record::LineSet::polyline(
                [Point3::new(0.0, -0.1, z), Point3::new(0.0, 0.1, z)],
                [1.0, 0.0, 0.0, 1.0],
                2.0,
            );
            crate::record::Node::new("line", Group::Contact, Pose::identity()).with_lines(line)
        };
        recording.add_node(line(0.0));
        assert!(svg(&recording, 0.0, [640, 480]).contains("stroke-opacity=\"0.20\""));
        recording.add_node(line(0.52));
        assert!(svg(&recording, 0.0, [640, 480]).contains("stroke-opacity=\"1.00\""));
    }
}
