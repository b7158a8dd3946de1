//! The largest convex polygon of an image that nothing hides.

use nalgebra::{Point2, Vector2};
use robotc_core::Seed;
use robotc_core::geom::{ConvexPolygon, HalfPlane};
use robotc_core::rng::Rng;

/// How long is searched.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FreeViewOptions {
    /// Searches; at least one.
    pub starts: u32,
}

impl Default for FreeViewOptions {
    fn default() -> Self {
        Self { starts: 64 }
    }
}

/// Rounds of a search; each makes the polygon larger, so that only a slow one is cut short.
const ROUNDS: usize = 64;

/// The largest convex polygon found in `image` that shares no area with any of `shadows`. Empty when they hide all.
///
/// A convex polygon avoids a convex shadow when a line separates them: the image is cut by one line for each shadow. One
/// line is best, the others given, along an edge of its shadow or through a corner that halves the line's way through what
/// the others leave: of two neighbouring lines through a corner the one with the shorter way on the side cut off takes
/// less away (Chang and Yap 1986, "A polynomial solution for the potato-peeling problem"). So each line in turn is set
/// to its best until none gets better, from many starts, in most of which one line may cut off several shadows. The thesis (section 5.1.1) samples points of support instead.
pub fn free_view(
    image: &ConvexPolygon,
    shadows: &[ConvexPolygon],
    options: &FreeViewOptions,
    seed: Seed,
) -> ConvexPolygon {
    let mut rng = seed.rng();
    let mut best = ConvexPolygon::default();
    for start in 0..options.starts.max(1) {
        let found = match start {
            0 => search(image, shadows, vec![None; shadows.len()]),
            _ => {
                let groups = grouped(shadows, &mut rng);
                let cuts = groups.iter().map(|group| Some(border(group, &mut rng))).collect();
                search(image, &groups, cuts)
            }
        };
        if found.area() > best.area() {
            best = found;
        }
    }
    best
}

/// The shadows in groups drawn at random, in any order: what one line cuts off together is convex.
fn grouped(shadows: &[ConvexPolygon], rng: &mut Rng) -> Vec<ConvexPolygon> {
    let count = 1 + rng.below(shadows.len().max(1));
    let mut groups = vec![Vec::new(); count];
    for shadow in shadows {
        groups[rng.below(count)].extend_from_slice(shadow.corners());
    }
    groups.into_iter().filter(|group| !group.is_empty()).map(ConvexPolygon::hull_of).collect()
}

/// A line along a shadow, in any direction.
fn border(shadow: &ConvexPolygon, rng: &mut Rng) -> HalfPlane {
    let angle = rng.range(0.0, std::f64::consts::TAU);
    let normal = Vector2::new(libm::cos(angle), libm::sin(angle));
    let heights = shadow.corners().iter().map(|p| normal.dot(&p.coords));
    HalfPlane { normal, offset: heights.fold(f64::INFINITY, f64::min) }
}

/// Sets one line after another to its best.
fn search(
    image: &ConvexPolygon,
    shadows: &[ConvexPolygon],
    mut cuts: Vec<Option<HalfPlane>>,
) -> ConvexPolygon {
    let mut area = 0.0;
    for round in 0..ROUNDS {
        let before = area;
        for i in 0..shadows.len() {
            let others = cuts.iter().enumerate().filter(|(j, _)| *j != i).filter_map(|(_, cut)| cut.as_ref());
            let left = others.fold(image.clone(), |left, cut| left.clipped(cut));
            cuts[i] = best_cut(&left, &shadows[i]);
            area = cuts[i].map_or(left.area(), |cut| left.clipped(&cut).area());
        }
        if round > 0 && area <= before * (1.0 + 1e-12) {
            break;
        }
    }
    let left = cuts.iter().flatten().fold(image.clone(), |left, cut| left.clipped(cut));
    // A shadow that needed no line may have come into view since.
    shadows.iter().fold(left, |left, shadow| match best_cut(&left, shadow) {
        Some(cut) => left.clipped(&cut),
        None => left,
    })
}

/// The line that cuts a shadow off a polygon and leaves most of it; `None` where there is nothing to cut off.
fn best_cut(polygon: &ConvexPolygon, shadow: &ConvexPolygon) -> Option<HalfPlane> {
    if shadow.shared_with(polygon).area() <= 0.0 {
        return None;
    }
    let along_edges = shadow.edges().map(|(a, b)| HalfPlane::right_of(&a, &b));
    let halved = shadow.corners().iter().flat_map(|corner| {
        let edges = polygon.edges();
        let pairs = edges.clone().flat_map(move |first| edges.clone().map(move |second| (first, second)));
        pairs.filter_map(|(first, second)| through(corner, first, second, shadow))
    });
    let kept = |cut: &HalfPlane| polygon.clipped(cut).area();
    along_edges.chain(halved).max_by(|a, b| kept(a).total_cmp(&kept(b)))
}

/// The line through a corner of a shadow that two edges, prolonged, end at equal distances on either side, when all of the
/// shadow is on one side of it: the other side.
fn through(
    corner: &Point2<f64>,
    first: (Point2<f64>, Point2<f64>),
    second: (Point2<f64>, Point2<f64>),
    shadow: &ConvexPolygon,
) -> Option<HalfPlane> {
    // The first edge turned half round about the corner meets the second at the far end.
    let [a, b] = [first.0, first.1].map(|p| corner + (corner - p));
    let (along, other) = (b - a, second.1 - second.0);
    let across = other.perp(&along);
    if across == 0.0 {
        return None;
    }
    let end = second.0 + other * ((a - second.0).perp(&along) / across);
    let way = HalfPlane::right_of(corner, &end);
    if way.normal.norm_squared() == 0.0 {
        return None;
    }
    let heights = shadow.corners().iter().filter(|p| *p != corner).map(|p| way.height(p));
    let (low, high) = heights.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
    if low >= 0.0 {
        Some(way)
    } else if high <= 0.0 {
        Some(HalfPlane { normal: -way.normal, offset: -way.offset })
    } else {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn image() -> ConvexPolygon {
        ConvexPolygon::rectangle(Point2::origin(), Point2::new(640.0, 480.0))
    }

    fn shadow(rng: &mut Rng) -> ConvexPolygon {
        let middle = Vector2::new(rng.range(0.0, 640.0), rng.range(0.0, 480.0));
        let size = rng.range(20.0, 150.0);
        let corners = 3 + rng.below(5);
        let points: Vec<_> = (0..corners)
            .map(|_| Point2::from(middle + Vector2::new(rng.range(-size, size), rng.range(-size, size))))
            .collect();
        ConvexPolygon::hull_of(points).shared_with(&image())
    }

    /// The best of lines in many directions through the corners of two shadows, each of them with each.
    fn by_brute_force(shadows: &[ConvexPolygon]) -> f64 {
        const DIRECTIONS: usize = 360;
        let cuts = |shadow: &ConvexPolygon| -> Vec<HalfPlane> {
            let direction = |i: usize| {
                let angle = i as f64 * std::f64::consts::TAU / DIRECTIONS as f64;
                let normal = Vector2::new(angle.cos(), angle.sin());
                let least =
                    shadow.corners().iter().map(|p| normal.dot(&p.coords)).fold(f64::INFINITY, f64::min);
                HalfPlane { normal, offset: least }
            };
            (0..DIRECTIONS).map(direction).collect()
        };
        let first = cuts(&shadows[0]);
        let second = cuts(&shadows[1]);
        let mut best: f64 = 0.0;
        for a in &first {
            let left = image().clipped(a);
            if left.area() > best {
                best = second.iter().map(|b| left.clipped(b).area()).fold(best, f64::max);
            }
        }
        best
    }

    #[test]
    fn no_pair_of_lines_leaves_more() {
        let mut rng = Seed::new(5).rng();
        let mut compared = 0;
        while compared < 20 {
            let shadows = [shadow(&mut rng), shadow(&mut rng)];
            if shadows.iter().any(|shadow| shadow.area() < 100.0) {
                continue;
            }
            let found = free_view(&image(), &shadows, &FreeViewOptions::default(), Seed::new(1)).area();
            let expected = by_brute_force(&shadows);
            assert!(found >= 0.999 * expected, "{found} of {expected} for {shadows:?}");
            compared += 1;
        }
    }

    #[test]
    fn nothing_of_a_shadow_is_in_view() {
        let mut rng = Seed::new(6).rng();
        for round in 0..50 {
            let shadows: Vec<_> = (0..round % 9).map(|_| shadow(&mut rng)).collect();
            let view = free_view(&image(), &shadows, &FreeViewOptions::default(), Seed::new(round));
            for shadow in &shadows {
                let shared = view.shared_with(shadow).area();
                assert!(shared <= 1e-6, "{shared} square pixels of {shadow:?}");
            }
            assert!(view.area() > 0.0 && view.area() <= image().area());
        }
        let all = [image()];
        assert_eq!(free_view(&image(), &all, &FreeViewOptions::default(), Seed::new(1)).area(), 0.0);
    }
}
