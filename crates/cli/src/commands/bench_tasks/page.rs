//! Pages that show the figures of a bench: one HTML file that asks nothing of the network.

use std::fmt::Write as _;

use robotc_runtime::view::escaped;

use super::table::Table;

/// A page, from top to bottom.
pub(super) struct Page {
    title: String,
    body: String,
}

/// A place on a map.
pub(super) struct Spot {
    /// Metres.
    pub(super) at: [f64; 2],
    /// Radians.
    pub(super) yaw: f64,
    /// Position in the legend.
    pub(super) class: usize,
}

/// The first class of a map's legend: places where nothing works.
const GREY: &str = "#a9aeb3";

/// Colours of the other classes of a legend and of the bars of a group; told apart by readers who see few colours.
const COLOURS: [&str; 6] = ["#0072b2", "#e69f00", "#009e73", "#cc79a7", "#56b4e9", "#d55e00"];

/// Pixels along each side of a map.
const MAP: f64 = 420.0;

/// Pixels of the longest bar.
const BAR: f64 = 380.0;

impl Page {
    pub(super) fn new(title: &str, about: &str) -> Self {
        let mut page = Self { title: escaped(title), body: String::new() };
        page.add(&format!("<h1>{}</h1>\n<p>{}</p>\n", escaped(title), escaped(about)));
        page
    }

    fn add(&mut self, html: &str) -> &mut Self {
        self.body += html;
        self
    }

    /// Bars of what is measured, in groups; each bar of a group has its name from `names`.
    pub(super) fn bars(
        mut self,
        title: &str,
        unit: &str,
        names: &[&str],
        groups: &[(String, Vec<f64>)],
    ) -> Self {
        let most = groups.iter().flat_map(|(_, values)| values).fold(f64::MIN_POSITIVE, |a, &b| a.max(b));
        let height = groups.iter().map(|(_, values)| 16 * values.len() + 26).sum::<usize>();
        let mut svg = format!("<svg width=\"{}\" height=\"{height}\" role=\"img\">\n", BAR + 240.0);
        let mut y = 14;
        for (group, values) in groups {
            let _ = writeln!(svg, "<text x=\"0\" y=\"{y}\" class=\"group\">{}</text>", escaped(group));
            y += 6;
            for (k, (&value, name)) in values.iter().zip(names).enumerate() {
                let (width, colour) = ((BAR * value / most).max(1.0), COLOURS[k % COLOURS.len()]);
                let _ = writeln!(
                    svg,
                    "<rect x=\"0\" y=\"{y}\" width=\"{width:.1}\" height=\"12\" fill=\"{colour}\"/>\
                     <text x=\"{:.1}\" y=\"{}\">{} {unit}, {}</text>",
                    width + 6.0,
                    y + 10,
                    number(value),
                    escaped(name)
                );
                y += 16;
            }
            y += 20;
        }
        self.add(&format!("<figure><figcaption>{}</figcaption>\n{svg}</svg></figure>\n", escaped(title)));
        self
    }

    /// Places around the robot, which is in the middle and looks to the right; each with a mark that points along its heading.
    pub(super) fn map(mut self, title: &str, legend: &[&str], spots: &[Spot]) -> Self {
        let reach = spots.iter().flat_map(|s| s.at).fold(0.1, |a: f64, b| a.max(b.abs())) * 1.15;
        let (middle, scale) = (0.5 * MAP, 0.5 * MAP / reach);
        let mut svg = format!("<svg width=\"{MAP}\" height=\"{MAP}\" role=\"img\" class=\"map\">\n");
        let ring = scale * (reach * 2.0).floor() / 2.0;
        let _ = writeln!(
            svg,
            "<circle cx=\"{middle}\" cy=\"{middle}\" r=\"{ring:.1}\" class=\"ring\"/><text x=\"{:.1}\" y=\"{middle}\">{} m</text>\n\
             <path d=\"M {} {} l 18 7 l -18 7 z\" class=\"robot\"/>",
            middle + ring - 34.0,
            number((reach * 2.0).floor() / 2.0),
            middle - 6.0,
            middle - 7.0
        );
        for spot in spots {
            let (x, y) = (middle + scale * spot.at[0], middle - scale * spot.at[1]);
            // Several headings of one place stand side by side.
            let (dx, dy) = (9.0 * spot.yaw.cos(), -9.0 * spot.yaw.sin());
            let colour = of_class(spot.class);
            let _ = writeln!(
                svg,
                "<circle cx=\"{:.1}\" cy=\"{:.1}\" r=\"4\" fill=\"{colour}\"/>\
                 <path d=\"M {x:.1} {y:.1} l {dx:.1} {dy:.1}\" stroke=\"{colour}\"/>",
                x + dx,
                y + dy
            );
        }
        let mut keys = String::new();
        for (class, name) in legend.iter().enumerate() {
            let count = spots.iter().filter(|s| s.class == class).count();
            let colour = of_class(class);
            let _ = writeln!(
                keys,
                "<li><span style=\"background:{colour}\"></span>{}: {count}</li>",
                escaped(name)
            );
        }
        self.add(&format!(
            "<figure><figcaption>{}</figcaption>\n{svg}</svg>\n<ul class=\"legend\">{keys}</ul></figure>\n",
            escaped(title)
        ));
        self
    }

    /// All figures.
    pub(super) fn with_table(mut self, table: &Table) -> Self {
        let cells = |tag: &str, row: &mut dyn Iterator<Item = &str>| {
            row.fold(String::new(), |line, cell| line + &format!("<{tag}>{}</{tag}>", escaped(cell)))
        };
        let mut rows = format!("<tr>{}</tr>\n", cells("th", &mut table.header.iter().copied()));
        for row in &table.rows {
            let _ = writeln!(rows, "<tr>{}</tr>", cells("td", &mut row.iter().map(String::as_str)));
        }
        self.add(&format!("<table>\n{rows}</table>\n"));
        self
    }

    /// A page of its own in a frame: a replay.
    pub(super) fn replay(mut self, title: &str, html: &str) -> Self {
        let page = html.replace('&', "&amp;").replace('"', "&quot;");
        self.add(&format!(
            "<figure><figcaption>{}</figcaption>\n<iframe title=\"replay\" srcdoc=\"{page}\"></iframe></figure>\n",
            escaped(title)
        ));
        self
    }

    pub(super) fn html(&self) -> String {
        let Self { title, body } = self;
        format!(
            "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" content=\"width=device-width\">\n\
             <title>{title}</title>\n<style>{STYLE}</style>\n</head>\n<body>\n{body}</body>\n</html>\n"
        )
    }
}

const STYLE: &str = "
body { font: 15px/1.5 system-ui, sans-serif; max-width: 960px; margin: 2em auto; padding: 0 1em; color: #222; background: #fff }
h1 { font-size: 1.4em } figure { margin: 1.5em 0 } figcaption { font-weight: 600; margin-bottom: .5em }
svg text { font-size: 12px; fill: #333 } svg .group { font-weight: 600 } .map { background: #f5f6f7; vertical-align: top }
.ring { fill: none; stroke: #ccc } .robot { fill: #444 }
.legend { display: inline-block; list-style: none; margin: 0 1em; padding: 0 }
.legend span { display: inline-block; width: 12px; height: 12px; border-radius: 6px; margin-right: .5em }
table { border-collapse: collapse; display: block; overflow-x: auto; font-variant-numeric: tabular-nums }
th, td { padding: .25em .8em; border-bottom: 1px solid #ddd; text-align: right } th:first-child, td:first-child { text-align: left }
iframe { width: 100%; height: 600px; border: 1px solid #ddd }
";

/// The colour of a class on a map.
fn of_class(class: usize) -> &'static str {
    class.checked_sub(1).map_or(GREY, |k| COLOURS[(k + 1) % COLOURS.len()])
}

/// Three digits that count.
fn number(value: f64) -> String {
    let digits = match value.abs() {
        v if v >= 100.0 => 0,
        v if v >= 10.0 => 1,
        v if v >= 1.0 => 2,
        _ => 3,
    };
    let text = format!("{value:.digits$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_three_digits() {
        assert_eq!([0.1234, 1.5, 12.34, 1234.5].map(number), ["0.123", "1.5", "12.3", "1234"]);
    }

    #[test]
    fn a_page_shows_what_it_was_given() {
        let mut table = Table::new(&["search", "ms"]);
        table.row(["a < b".into(), "1.5".into()]);
        let spots = [Spot { at: [0.5, 0.2], yaw: 0.0, class: 1 }];
        let html = Page::new("doors", "From everywhere.")
            .bars("times", "ms", &["one", "two"], &[("scene".into(), vec![1.0, 2.0])])
            .map("places", &["none", "some"], &spots)
            .replay("one door", "<p class=\"x\">&amp;</p>")
            .with_table(&table)
            .html();
        for part in ["1 ms, one", "2 ms, two", "some: 1", "none: 0", "a &lt; b", "&quot;x&quot;>&amp;amp;"] {
            assert!(html.contains(part), "{part}\n{html}");
        }
        // The longest bar is twice as long as the other one.
        assert!(html.contains("width=\"380.0\"") && html.contains("width=\"190.0\""));
        assert!(!html.contains("http"), "nothing comes from the network");
    }
}
