//! Heat maps as SVG: values over a rectangle of a plane, with axes, marks and a scale of colours.

use std::fmt::Write as _;

use super::palette;
use crate::view::escaped;

/// Steps of the colours.
const SHADES: usize = 24;

/// Pixels: the longer side of what is plotted, and the room about it.
const LONG: f64 = 420.0;
const LEFT: f64 = 62.0;
const RIGHT: f64 = 96.0;
const ABOVE: f64 = 40.0;
const BELOW: f64 = 52.0;

/// Values over a rectangle.
#[derive(Debug, Clone)]
pub struct Panel {
    /// What it shows.
    pub title: String,
    /// What lies along the two axes, with the unit.
    pub axes: [&'static str; 2],
    /// The lower left corner.
    pub corner: [f64; 2],
    /// Edge of a square.
    pub step: f64,
    /// Squares in a row.
    pub columns: usize,
    /// 0 or more for each square, row by row from below; nothing is drawn where it is 0.
    pub values: Vec<f64>,
    /// What the values are.
    pub scale: &'static str,
    /// Places with names.
    pub marks: Vec<([f64; 2], String)>,
}

/// Panels side by side before the next row begins.
const ACROSS: usize = 4;

/// A drawing of panels side by side, in rows. Equal panels give equal text.
pub fn svg(panels: &[Panel]) -> String {
    let room = |panel: &Panel| (LEFT + panel.size().0 + RIGHT, ABOVE + panel.size().1 + BELOW);
    let tall = |row: &[Panel]| row.iter().map(|panel| room(panel).1).fold(0.0, f64::max);
    let wide = |row: &[Panel]| row.iter().map(|panel| room(panel).0).sum();
    let height: f64 = panels.chunks(ACROSS).map(tall).sum();
    let width = panels.chunks(ACROSS).map(wide).fold(0.0, f64::max);
    let mut text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width:.0} {height:.0}\" width=\"{width:.0}\" \
         height=\"{height:.0}\" font-family=\"sans-serif\" font-size=\"12\" fill=\"#333\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n"
    );
    let mut above = ABOVE;
    for row in panels.chunks(ACROSS) {
        let mut left = LEFT;
        for panel in row {
            writeln!(text, "<g transform=\"translate({left:.1} {above})\">").expect(WRITES);
            panel.draw(&mut text);
            text += "</g>\n";
            left += room(panel).0;
        }
        above += tall(row);
    }
    text + "</svg>\n"
}

const WRITES: &str = "a string takes everything";

impl Panel {
    fn rows(&self) -> usize {
        self.values.len() / self.columns.max(1)
    }

    /// Pixels of a square.
    fn square(&self) -> f64 {
        LONG / self.columns.max(self.rows()).max(1) as f64
    }

    fn size(&self) -> (f64, f64) {
        (self.columns as f64 * self.square(), self.rows() as f64 * self.square())
    }

    /// Pixels of a point.
    fn at(&self, point: [f64; 2]) -> (f64, f64) {
        let scale = self.square() / self.step;
        ((point[0] - self.corner[0]) * scale, self.size().1 - (point[1] - self.corner[1]) * scale)
    }

    fn draw(&self, text: &mut String) {
        let (w, h) = self.size();
        writeln!(text, "<text y=\"-14\" font-size=\"14\">{}</text>", escaped(&self.title)).expect(WRITES);
        let most = self.values.iter().copied().fold(0.0, f64::max);
        for (shade, path) in self.shades(most).iter().enumerate().filter(|(_, path)| !path.is_empty()) {
            let colour = colour((shade as f32 + 0.5) / SHADES as f32);
            writeln!(text, "<path fill=\"{colour}\" shape-rendering=\"crispEdges\" d=\"{path}\"/>")
                .expect(WRITES);
        }
        let frame = "fill=\"none\" stroke=\"#999\"";
        writeln!(text, "<rect width=\"{w:.1}\" height=\"{h:.1}\" {frame}/>").expect(WRITES);
        self.draw_axes(text);
        for (point, name) in &self.marks {
            let (x, y) = self.at(*point);
            let cross = "stroke=\"#d9304f\" stroke-width=\"2\" fill=\"none\"";
            writeln!(
                text,
                "<path {cross} d=\"M{:.1} {y:.1}h12M{x:.1} {:.1}v12\"/><text x=\"{:.1}\" y=\"{:.1}\" fill=\"#d9304f\" \
                 stroke=\"white\" stroke-width=\"3\" paint-order=\"stroke\">{}</text>",
                x - 6.0,
                y - 6.0,
                x + 8.0,
                y - 6.0,
                escaped(name)
            )
            .expect(WRITES);
        }
        self.draw_scale(text, most);
    }

    /// The squares of each shade, as one path: runs of a row are one rectangle.
    fn shades(&self, most: f64) -> Vec<String> {
        let mut paths = vec![String::new(); SHADES];
        let side = self.square();
        let shade = |value: f64| ((value / most * SHADES as f64) as usize).min(SHADES - 1);
        for (row, values) in self.values.chunks(self.columns.max(1)).enumerate() {
            let y = self.size().1 - (row + 1) as f64 * side;
            let mut column = 0;
            for run in values.chunk_by(|a, b| (*a > 0.0) == (*b > 0.0) && shade(*a) == shade(*b)) {
                if run[0] > 0.0 {
                    let (x, w) = (column as f64 * side, run.len() as f64 * side);
                    write!(paths[shade(run[0])], "M{x:.2} {y:.2}h{w:.2}v{side:.2}h-{w:.2}z").expect(WRITES);
                }
                column += run.len();
            }
        }
        paths
    }

    fn draw_axes(&self, text: &mut String) {
        let (w, h) = self.size();
        let tick = nice(self.step * self.columns.max(self.rows()) as f64 / 6.0);
        let ticks = |low: f64, high: f64| {
            let first = (low / tick - 1e-9).ceil() as i64;
            (first..).map(move |k| k as f64 * tick).take_while(move |v| *v <= high + 1e-9 * tick)
        };
        let [right, top] =
            [self.columns, self.rows()].map(|n| n as f64 * self.step).map(|length| length.max(self.step));
        for value in ticks(self.corner[0], self.corner[0] + right) {
            let (x, _) = self.at([value, self.corner[1]]);
            let label = number(value);
            writeln!(
                text,
                "<path stroke=\"#999\" d=\"M{x:.1} {h:.1}v5\"/><text x=\"{x:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{label}</text>",
                h + 18.0
            )
            .expect(WRITES);
        }
        for value in ticks(self.corner[1], self.corner[1] + top) {
            let (_, y) = self.at([self.corner[0], value]);
            let label = number(value);
            writeln!(
                text,
                "<path stroke=\"#999\" d=\"M0 {y:.1}h-5\"/><text x=\"-8\" y=\"{:.1}\" text-anchor=\"end\">{label}</text>",
                y + 4.0
            )
            .expect(WRITES);
        }
        let [x, y] = self.axes;
        writeln!(
            text,
            "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{x}</text>\
             <text transform=\"translate(-44 {:.1}) rotate(-90)\" text-anchor=\"middle\">{y}</text>",
            0.5 * w,
            h + 38.0,
            0.5 * h
        )
        .expect(WRITES);
    }

    fn draw_scale(&self, text: &mut String, most: f64) {
        let (w, h) = self.size();
        let (x, part) = (w + 16.0, h / SHADES as f64);
        for shade in 0..SHADES {
            let colour = colour((shade as f32 + 0.5) / SHADES as f32);
            let y = h - (shade + 1) as f64 * part;
            writeln!(
                text,
                "<rect x=\"{x:.1}\" y=\"{y:.2}\" width=\"12\" height=\"{:.2}\" fill=\"{colour}\"/>",
                part + 0.5
            )
            .expect(WRITES);
        }
        writeln!(
            text,
            "<text x=\"{0:.1}\" y=\"10\">{1}</text><text x=\"{0:.1}\" y=\"{h:.1}\">0</text>\
             <text transform=\"translate({0:.1} {2:.1}) rotate(-90)\" text-anchor=\"middle\" dy=\"10\">{3}</text>",
            x + 18.0,
            number(most),
            0.5 * h,
            escaped(self.scale)
        )
        .expect(WRITES);
    }
}

fn colour(share: f32) -> String {
    let [r, g, b, _] = palette::ramp(share).map(|c| (255.0 * c).round() as u8);
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// 1, 2 or 5 times a power of ten, not below a length.
fn nice(length: f64) -> f64 {
    let power = libm::pow(10.0, libm::floor(libm::log10(length.max(1e-9))));
    let factors = [1.0, 2.0, 5.0, 10.0];
    factors.into_iter().map(|f| f * power).find(|v| *v >= length * (1.0 - 1e-9)).unwrap_or(10.0 * power)
}

/// A number as people write it: three digits, no needless zeros.
fn number(value: f64) -> String {
    let digits = if value.abs() >= 1.0 || value == 0.0 { 2 } else { 3 };
    let text = format!("{value:.digits$}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text.is_empty() || text == "-0" { "0".to_owned() } else { text.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        for (value, expected) in [
            (0.0, "0"),
            (-0.0, "0"),
            (0.5, "0.5"),
            (-1.25, "-1.25"),
            (10.0, "10"),
            (0.0371, "0.037"),
            (-1e-12, "0"),
        ] {
            assert_eq!(number(value), expected, "{value}");
        }
        for (length, expected) in [(0.3, 0.5), (1.0, 1.0), (1.1, 2.0), (7.0, 10.0), (0.05, 0.05)] {
            assert!((nice(length) - expected).abs() < 1e-9, "{length}");
        }
    }

    #[test]
    fn runs_of_a_row_are_one_rectangle() {
        let panel = Panel {
            title: "a < b".into(),
            axes: ["x (m)", "y (m)"],
            corner: [-1.0, 0.0],
            step: 0.5,
            columns: 4,
            values: vec![1.0, 1.0, 0.0, 0.5, 0.0, 0.0, 0.0, 0.0],
            scale: "share",
            marks: vec![([0.0, 0.5], "here".into())],
        };
        let paths = panel.shades(1.0);
        assert_eq!(paths[SHADES - 1], "M0.00 105.00h210.00v105.00h-210.00z");
        assert_eq!(paths[SHADES / 2], "M315.00 105.00h105.00v105.00h-105.00z");
        assert_eq!(paths.iter().filter(|path| !path.is_empty()).count(), 2);
        // A mark in the middle of the panel.
        assert_eq!(panel.at([0.0, 0.5]), (210.0, 105.0));
        let text = svg(&[panel.clone(), panel]);
        assert!(text.contains("a &lt; b") && text.contains(">here</text>"), "{text}");
        assert_eq!(text.matches("<g ").count(), 2);
        assert_eq!(text.matches("<g ").count(), text.matches("</g>").count());
    }
}
