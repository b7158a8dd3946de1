//! Six unknowns of a loop of which five turn a joint each, while one slides, or moves several joints at once.
//!
//! For each value of that one the other five close the loop only by chance. With a sixth joint among them that does not turn,
//! Raghavan and Roth's elimination (see [`six`](super::six)) gives a determinant that vanishes there: a smooth function of one variable.
//! It is swept over all values that the variable may have, interval after interval, each so short that a polynomial is as good; its roots
//! and the null vectors there give candidates as in the general case. The joint that does not turn may lie anywhere between the others, which
//! are taken in any [order](super::six::Order).

use super::eigen::MAX_SIZE;
use super::elimination::{Measure, Shadow, Six, determinant, eliminate_still, shadow};
use super::math::{cos_sin, sqrt};
use super::null::{NEARLY_NOTHING, NOTHING, Pair, several, single};
use super::piece::{Cosines, Piece, cosines};
use super::six::{APART, Arranged, Candidates, NEARLY_REAL, ORDERS, arrange, close, nudged};
use super::vector::{Line, Motion, dot, minus, times};

/// Most joints of a loop.
pub const MOST_LINES: usize = 9;

/// Most orders that are tried.
pub const MOST_ORDERS: usize = 3;

/// Numbers that [`sweep_of`] takes: for each joint the direction of its line, a point on it, how it moves (zero for none, one for an
/// unknown turn, two and three for a turn and a slide by the swept variable), and how far for each unit of that; rows of the goal's
/// rotation, its place; each order as its code and one, zero for none, and its [places](MOST_PLACES) with how many roots are at each; and
/// where the variable is looked for (zero for a length, one for an angle of which a full turn changes nothing, two for other angles).
pub const NUMBERS: usize = 8 * MOST_LINES + 12 + MOST_ORDERS * ORDER_NUMBERS + 1;

/// Most places of an order: values where the determinant has several roots, whatever the goal.
pub const MOST_PLACES: usize = 2;

/// Numbers that say what there is to know of an order.
pub const ORDER_NUMBERS: usize = 1 + 2 * MOST_PLACES;

/// Intervals at first.
const INTERVALS: f64 = 16.0;

/// Shortest interval, as part of all values.
const SHORTEST: f64 = 1.0 / 16384.0;

/// Most intervals of one order.
const MOST_INTERVALS: usize = 200;

/// Last coefficients below this part of the largest one: the polynomial is the function.
const RESOLVED: f64 = 1e-9;

/// Half an interval has coefficients of rounding, if they are not smaller than this part of those of the whole one.
const ROUNDING: f64 = 0.1;

/// On an interval with a third on which the function is nowhere larger than this part of the largest value, roots of that third may be
/// lost in rounding.
const EVEN: f64 = 1e-3;

/// Shortest interval for that reason, as part of all values: nearer to a place where many roots are it never ends.
const FINE: f64 = 1.0 / 512.0;

/// Roots that are nearer to each other than this part of half an interval, three or more, are looked at alone. Where the five others lose
/// a freedom at some value, whatever the goal, the determinant has a root of a high order there, which hides others beside it.
const CLUSTER: f64 = 0.05;

/// The interval round their mean, as part of the one before: it holds all of them.
const ZOOM: f64 = 0.125;

/// How many times.
const ZOOMS: usize = 4;

/// Roots farther than this from their mean are looked at one by one too: where little is left of the equations, a null space may seem to
/// have as many vectors as there are roots, and has not.
const ONE: f64 = 3e-4;

/// The circle is cut here: off the multiples of 90 degrees.
const CUT: f64 = 0.2137;

/// A joint of the loop.
#[derive(Clone, Copy)]
struct Joint {
    line: Line,
    kind: u8,
    ratio: f64,
}

/// A loop of joints, base to tip.
struct Loop {
    joints: [Joint; MOST_LINES],
    goal: Motion,
    measure: Measure,
    /// How many of the five come before the swept joints, if none is among these.
    before: Option<usize>,
}

impl Loop {
    /// The other five at a value of the swept variable, and the joint that does not turn, in an order.
    fn arranged(&self, x: f64, code: usize) -> Arranged {
        let mut moved = Motion { rows: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], place: [0.0; 3] };
        let still = still_joint(code);
        let mut lines = [self.joints[0].line; 6];
        let mut count = 0;
        for joint in &self.joints {
            let step = joint.ratio * x;
            match joint.kind {
                1 => {
                    if count == still {
                        count += 1;
                    }
                    lines[count] = moved.moved(&joint.line);
                    count += 1;
                }
                2 => moved = moved.after(&joint.line.motion(cos_sin(step))),
                3 => {
                    moved.place =
                        moved.moved(&Line { point: times(joint.line.direction, step), ..joint.line }).point
                }
                _ => {}
            }
        }
        arrange(&lines, &self.goal.after(&moved.inverse()), code)
    }

    fn shadow(&self, loop_: &Arranged) -> Shadow {
        shadow(&loop_.lines, &loop_.goal, &self.measure)
    }
}

/// A loop in an order.
struct Ordered<'a> {
    loop_: &'a Loop,
    code: usize,
    /// Values where there are roots whatever the goal, and how many, zero for none.
    places: [[f64; 2]; MOST_PLACES],
    /// The right side of the equations, where it does not change: the joint that does not turn is where the swept one is.
    constant: Option<Shadow>,
}

impl<'a> Ordered<'a> {
    /// From the numbers of an order.
    fn new(loop_: &'a Loop, numbers: &[f64]) -> Self {
        let code = (numbers[0] as usize - 1) % ORDERS;
        let mut places = [[0.0; 2]; MOST_PLACES];
        for (i, place) in places.iter_mut().enumerate() {
            *place = [numbers[2 * i + 1], numbers[2 * i + 2]];
        }
        let constant =
            (loop_.before == Some(still_joint(code))).then(|| loop_.shadow(&loop_.arranged(0.0, code)));
        Ordered { loop_, code, places, constant }
    }

    fn eliminated(&self, x: f64) -> (Arranged, Six, f64) {
        let loop_ = self.loop_.arranged(x, self.code);
        let measure = &self.loop_.measure;
        let still = |shadow: &Shadow| eliminate_still(&loop_.lines, loop_.swapped, measure, shadow);
        let (six, volume) = match &self.constant {
            Some(shadow) => (still(shadow), shadow.volume),
            None => {
                let shadow = self.loop_.shadow(&loop_);
                (still(&shadow), shadow.volume)
            }
        };
        (loop_, six, volume)
    }

    fn value(&self, x: f64) -> f64 {
        let (_, six, volume) = self.eliminated(x);
        volume * determinant(&six, [1.0, 0.0]).0
    }
}

/// The number of the joint that does not turn: the third in the order.
pub fn still_joint(code: usize) -> usize {
    let place = (code % 12 / 2 + 2) % 6;
    if code >= 12 { 5 - place } else { place }
}

/// Visits the intervals of an order, one after the other, each with whether the polynomial is the function; says whether these are all.
fn walk(ordered: &Ordered<'_>, table: &Cosines, span: [f64; 2], mut visit: impl FnMut(&Piece, bool)) -> bool {
    let whole = span[1] - span[0];
    let (mut at, mut width) = (span[0], whole / INTERVALS);
    let mut before = f64::MAX;
    for _ in 0..MOST_INTERVALS {
        let piece = Piece::new(table, at, width, |x| ordered.value(x));
        let rest = piece.rest();
        let resolved = rest < RESOLVED * piece.largest;
        let uneven = piece.even < EVEN && width > FINE * whole;
        if uneven || !resolved && rest < ROUNDING * before && width > SHORTEST * whole {
            before = rest;
            width *= 0.5;
            continue;
        }
        visit(&piece, resolved);
        at += width;
        if at > span[1] - SHORTEST * whole {
            return true;
        }
        before = f64::MAX;
        if !resolved {
            width *= 2.0;
        } else if rest < 1e-3 * RESOLVED * piece.largest && piece.even > 30.0 * EVEN {
            width *= 1.5;
        }
        if width > span[1] - at {
            width = span[1] - at;
        }
    }
    false
}

/// Adds the candidates of one interval; says whether its roots lie apart. They may be so far from real ones.
fn look(
    ordered: &Ordered<'_>,
    table: &Cosines,
    piece: &Piece,
    turns: bool,
    unreal: f64,
    zooms: usize,
    found: &mut Candidates,
) -> bool {
    const STILL: [f64; 2] = [1.0, 0.0];
    let tight = CLUSTER * piece.half;
    let reach = ZOOM * piece.half;
    let margin = NEARLY_REAL + unreal;
    // Seen from nearby roots are told apart that were one.
    let together_at = if tight < APART { tight } else { APART };
    let mut roots = [[0.0; 2]; MAX_SIZE];
    let count = piece.roots(margin, if reach > margin { reach } else { margin }, &mut roots);
    let mut done = [false; MAX_SIZE];
    let mut apart = true;
    let zoom = |centre: f64, found: &mut Candidates| {
        let inner = Piece::new(table, centre - reach, 2.0 * reach, |x| ordered.value(x));
        look(ordered, table, &inner, turns, unreal, zooms - 1, found)
    };
    for [place, order] in ordered.places {
        if !(order > 0.0) || zooms == 0 || !piece.reaches(place, reach) {
            continue;
        }
        let mut cluster = 0;
        for (j, [other, height]) in roots[..count].iter().enumerate() {
            if (other - place).abs() + height.abs() < reach {
                cluster += 1;
                done[j] = true;
            }
        }
        // As many as always are none of a solution.
        if cluster != order as usize {
            apart &= zoom(place, found);
        }
    }
    for i in 0..count {
        let [x, imaginary] = roots[i];
        let (mut cluster, mut centre) = (0, 0.0);
        for (j, [other, height]) in roots[..count].iter().enumerate() {
            if !done[j] && (other - x).abs() + (height - imaginary).abs() < tight {
                cluster += 1;
                centre += other;
            }
        }
        if done[i] || imaginary.abs() > tight || cluster < 3 || zooms == 0 {
            continue;
        }
        for (j, [other, height]) in roots[..count].iter().enumerate() {
            done[j] |= (other - x).abs() + (height - imaginary).abs() < tight;
        }
        zoom(centre / cluster as f64, found);
        // What lies so near to others may be clearer in another order.
        apart = false;
    }
    for i in 0..count {
        let [x, imaginary] = roots[i];
        if done[i] || imaginary.abs() > margin {
            continue;
        }
        let (mut together, mut sum) = (0, 0.0);
        let mut near = [false; MAX_SIZE];
        for (j, [other, height]) in roots[..count].iter().enumerate() {
            near[j] = !done[j]
                && height.abs() <= margin
                && (other - x).abs() + (height - imaginary).abs() < together_at;
            if near[j] {
                together += 1;
                sum += other;
            }
        }
        let mut alone = together == 1;
        if together > 1 {
            // Several solutions that share the value, or nearly do.
            let mean = sum / together as f64;
            alone = (x - mean).abs() + imaginary.abs() > ONE;
            let (arranged, six, _) = ordered.eliminated(mean);
            let all =
                several(&six, STILL, NOTHING, |pair| add(&arranged, pair, mean, turns, found)) == together;
            if all && !alone {
                done.iter_mut().zip(near).for_each(|(done, near)| *done |= near);
                continue;
            }
            if !all {
                // The middle of roots that others are near is good to few digits.
                several(&six, STILL, NEARLY_NOTHING, |pair| add(&arranged, pair, mean, turns, found));
                apart = false;
            }
        }
        let x = if alone && imaginary == 0.0 { refined(ordered, piece, x) } else { x };
        let (arranged, six, _) = ordered.eliminated(x);
        match single(&six, STILL) {
            Some(pair) => add(&arranged, pair, x, turns, found),
            None => apart = false,
        }
    }
    apart
}

/// A root of the determinant near that of the polynomial.
fn refined(ordered: &Ordered<'_>, piece: &Piece, start: f64) -> f64 {
    let mut x = start;
    for _ in 0..4 {
        let change = -ordered.value(x) / piece.slope(x);
        if !(change.abs() < NEARLY_REAL) {
            break;
        }
        x += change;
        if change.abs() < 1e-12 {
            break;
        }
    }
    x
}

/// Adds a candidate: the turns of the five in their order, then the swept variable.
fn add(loop_: &Arranged, [tangent, other]: Pair, x: f64, turns: bool, found: &mut Candidates) {
    let still = [1.0, 0.0];
    let middle = if loop_.swapped { [still, other, tangent] } else { [still, tangent, other] };
    let Some([q1, q2, q6]) = close(loop_, middle) else { return };
    let mut all = [still; 6];
    for (joint, turn) in loop_.joints.into_iter().zip([q1, q2, still, middle[1], middle[2], q6]) {
        let number = if joint > loop_.joints[2] { joint - 1 } else { joint };
        if joint != loop_.joints[2] {
            all[number] = turn;
        }
    }
    all[5] = if turns { cos_sin(x) } else { [x, 0.0] };
    found.push(all);
}

/// A loop, where its variable is looked for, and whether that is an angle.
struct Task {
    loop_: Loop,
    span: [f64; 2],
    turns: bool,
}

/// The loop of plain numbers; nothing if they do not make one.
fn task(x: &[f64; NUMBERS], slack: f64) -> Option<Task> {
    let vector = |i: usize| [x[i], x[i + 1], x[i + 2]];
    let mut joints =
        [Joint { line: Line { direction: [0.0; 3], point: [0.0; 3] }, kind: 0, ratio: 0.0 }; MOST_LINES];
    for number in x {
        if !(number.abs() < f64::INFINITY) {
            return None;
        }
    }
    let mut lines = [Line { direction: [0.0; 3], point: vector(3) }; MOST_LINES];
    // How many of the five come before the first swept joint and before the last one.
    let (mut unknown, mut first, mut last) = (0, 6, 0);
    for (i, joint) in joints.iter_mut().enumerate() {
        let line = Line { direction: vector(8 * i), point: vector(8 * i + 3) };
        *joint = Joint { line, kind: x[8 * i + 6] as u8, ratio: x[8 * i + 7] };
        unknown += usize::from(joint.kind == 1);
        if joint.kind > 1 {
            (first, last) = (if first < unknown { first } else { unknown }, unknown);
        }
        lines[i].point = if joint.kind > 0 { line.point } else { lines[0].point };
    }
    if unknown != 5 {
        return None;
    }
    const GOAL: usize = 8 * MOST_LINES;
    let goal = Motion { rows: [vector(GOAL), vector(GOAL + 3), vector(GOAL + 6)], place: vector(GOAL + 9) };
    let goal = if slack > 0.0 { nudged(&goal, 0.1 * slack) } else { goal };
    let turns = x[NUMBERS - 1] > 0.0;
    let span = if x[NUMBERS - 1] == 1.0 {
        [CUT - core::f64::consts::PI, CUT + core::f64::consts::PI]
    } else if turns {
        [-core::f64::consts::PI, core::f64::consts::PI]
    } else {
        let most = longest(&joints, &goal);
        [-most, most]
    };
    let before = (first == last).then_some(first);
    let loop_ = Loop { joints, goal, measure: Measure::of(&lines, lines[0].point), before };
    Some(Task { loop_, span, turns })
}

/// The numbers of the orders.
fn orders(x: &[f64; NUMBERS]) -> impl Iterator<Item = &[f64]> {
    let orders = x[8 * MOST_LINES + 12..NUMBERS - 1].chunks(ORDER_NUMBERS);
    orders.filter(|numbers| numbers[0] >= 1.0)
}

/// Candidates for the joints of a loop, from plain numbers: the five unknown turns in order, then the swept variable as `[cos, sin]`
/// or `[length, 0]`.
///
/// Slack is for poses at which that gave nothing, as in [`six`](super::six::six).
pub fn sweep_of(x: &[f64; NUMBERS], slack: f64) -> Candidates {
    let mut found = Candidates::NONE;
    let table: Cosines = cosines();
    let Some(Task { loop_, span, turns }) = task(x, slack) else { return found };
    for numbers in orders(x) {
        let ordered = Ordered::new(&loop_, numbers);
        let mut all = true;
        let ended = walk(&ordered, &table, span, |piece, resolved| {
            all &= look(&ordered, &table, piece, turns, 5.0 * sqrt(slack), ZOOMS, &mut found) && resolved;
        });
        // Other orders differ in what lies near to what.
        if ended && all && slack == 0.0 && found.count() > 0 {
            break;
        }
    }
    found
}

/// Where roots of the first order may be that come whatever the goal: means of those near each real one, told to `place`.
pub fn clusters_of(x: &[f64; NUMBERS], mut place: impl FnMut(f64)) {
    let table: Cosines = cosines();
    let Some(Task { loop_, span, .. }) = task(x, 0.0) else { return };
    let Some(numbers) = orders(x).next() else { return };
    let ordered = Ordered::new(&loop_, numbers);
    let mut roots = [[0.0; 2]; MAX_SIZE];
    walk(&ordered, &table, span, |piece, _| {
        let tight = CLUSTER * piece.half;
        let count = piece.roots(0.0, tight, &mut roots);
        for [x, y] in &roots[..count] {
            let (mut near, mut sum) = (0, 0.0);
            for [other, height] in &roots[..count] {
                if (other - x).abs() + (height - y).abs() < 2.0 * tight {
                    near += 1;
                    sum += other;
                }
            }
            place(sum / near as f64);
        }
    });
}

/// How fast the determinant of the first order falls towards a value from both sides at once, at a distance: as many powers of that as
/// there are roots, if no others are near.
pub fn fall_of(x: &[f64; NUMBERS], place: f64, distance: f64) -> f64 {
    let Some(Task { loop_, .. }) = task(x, 0.0) else { return 0.0 };
    let Some(numbers) = orders(x).next() else { return 0.0 };
    let ordered = Ordered::new(&loop_, numbers);
    let product = |h: f64| (ordered.value(place - h) * ordered.value(place + h)).abs();
    // Square roots in place of logarithms, which the kernel has not: how often doubling the distance doubles the mean of the two.
    let (mut ratio, mut powers) = (product(2.0 * distance) / product(distance), 0.0);
    while ratio > 2.0 && powers < 16.0 {
        ratio *= 0.25;
        powers += 1.0;
    }
    powers
}

/// How far a slide can go at most: the other joints reach no farther.
fn longest(joints: &[Joint; MOST_LINES], goal: &Motion) -> f64 {
    let length = |a: [f64; 3], b: [f64; 3]| {
        let d = minus(a, b);
        sqrt(dot(d, d))
    };
    let first = joints[0].line.point;
    let (mut last, mut sum, mut ratio) = (first, 0.0, 0.0f64);
    for joint in joints {
        if joint.kind > 0 {
            sum += length(joint.line.point, last);
            last = joint.line.point;
        }
        if joint.kind == 3 {
            ratio = ratio.max(joint.ratio.abs());
        }
    }
    1.01 * (sum + length(goal.moved(&Line { direction: first, point: last }).point, first)) / ratio
}
