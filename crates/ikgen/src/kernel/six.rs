//! Six revolute joints in general: up to sixteen solutions, by elimination to a univariate equation.
//!
//! The loop is `e1 e2 e3 e4 e5 e6 = G`, each `e` a turn about a line. The image of the last line under `e3 e4 e5` must be what
//! `e2^-1 e1^-1` makes of its image under `G`. Raghavan and Roth (1993) write this as fourteen equations, each linear in
//! the cosine and sine of every angle:
//!
//! 1. Their right sides hold eight monomials of `q1` and `q2`; a reflection for each of them leaves six equations in `q3`, `q4`
//!    and `q5` alone.
//! 2. For a given `q3` those are six forms in `(1, c5, s5)`, quadratic in the tangent of half of `q4`. They and their multiples by
//!    that tangent are a square system of twelve, whose determinant is a trigonometric polynomial of `q3` of degree eight.
//! 3. Seventeen samples give it, the eigenvalues of a companion matrix its roots; the secant method on the determinant itself
//!    restores the digits that the polynomial lost. (Manocha and Canny, 1994, solve one larger eigenproblem instead.)
//! 4. Null vectors of the system give `q4` and `q5`, what remains of the loop `q2`, `q1` and `q6`.
//!
//! Any of the six joints can be first in the loop, and the loop can be run backwards: an *order*. In some the determinant
//! vanishes for all angles, because of how the axes of an arm lie; the compiler finds out which are good.

use super::eigen::MAX_SIZE;
use super::elimination::{Six, View, eliminate};
use super::math::{cos_sin, sqrt};
use super::null::{NOTHING, Pair, is_alone, refined, several, single};
use super::vector::{Line, Motion, Vector, back, cross, dot, minus, plus, times, unit};
use super::waves::{MAX_DEGREE, Root, Waves};

/// A turn of each joint, as `[cos, sin]`.
pub type Turns = [[f64; 2]; 6];

/// Most candidates of one pose.
pub const MOST: usize = 48;

/// Candidates nearer to each other are one, found in two orders.
const EQUAL: f64 = 1e-9;

/// Candidate turns of six joints.
#[derive(Clone, Copy, Debug)]
pub struct Candidates {
    items: [Turns; MOST],
    len: usize,
    /// Never: candidates are not representatives of a continuum.
    pub free: bool,
}

impl Candidates {
    /// None.
    pub const NONE: Candidates = Candidates { items: [[[1.0, 0.0]; 6]; MOST], len: 0, free: false };

    /// How many there are.
    pub fn count(&self) -> usize {
        self.len
    }

    /// One of them.
    pub fn get(&self, i: usize) -> Turns {
        self.items[i]
    }

    /// Adds one, if it is new and there is room.
    pub fn push(&mut self, turns: Turns) {
        let new = self.items[..self.len].iter().all(|other| {
            let mut gap = 0.0f64;
            for (a, b) in other.iter().flatten().zip(turns.iter().flatten()) {
                gap = gap.max((a - b).abs());
            }
            gap > EQUAL
        });
        if new && self.len < MOST {
            self.items[self.len] = turns;
            self.len += 1;
        }
    }
}

/// A way to run round the loop.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Order {
    /// Number from 0 to 23: which joint is first, in which direction, and which of the two angles beside the sampled one is
    /// eliminated by its half tangent.
    pub code: usize,
    /// Degree of the determinant, eight at most.
    pub degree: usize,
    /// Whether the determinant is a square: solutions come in pairs that share the sampled angle.
    pub squared: bool,
}

/// Roots whose imaginary part is smaller may be real: pairs that fall together lose half of their digits.
pub const NEARLY_REAL: f64 = 1e-3;

/// Where the polynomial is smaller than this part of the largest sample, rounding decides where its roots are and which are real.
const FLAT: f64 = 1e-11;

/// Where the polynomial is smaller than this part of the largest sample, it is compared with the determinant: waves that are left out of
/// an order because they are small may not be small there.
const FAINT: f64 = 1e-7;

/// The polynomial is off where it misses the determinant by this part of what it rises to nearby.
const OFF: f64 = 0.1;

/// A determinant of which one pivot is smaller than this everywhere is rounding alone: at some poses an order breaks down.
const BROKEN: f64 = 1e-9;

/// Where one pivot is smaller than this everywhere, solutions may be lost in rounding.
const MURKY: f64 = 1e-5;

/// Rounding of the polynomial, as part of the largest sample, where it is small.
const ROUNDING: f64 = 1e-14;

/// Most views of the polynomial of an order: the whole circle, and places where it is flat.
const MOST_VIEWS: usize = 3;

/// Roots that are nearer to each other may be one.
pub const APART: f64 = 3e-3;

/// As far rounding parts a double root. Roots that are farther apart, but not clearly, ask for another order.
const MERGED: f64 = 1e-5;

/// How far the goals are at which solutions are looked for that fall together, in the first order that is sound and in the second.
const BESIDE: [f64; 2] = [1e-2, -1e-3];

/// Number of orders.
pub const ORDERS: usize = 24;

/// A loop turned and shifted to an order.
pub struct Arranged {
    /// The joints' lines.
    pub lines: [Line; 6],
    /// The motion that they make together.
    pub goal: Motion,
    /// The joint at each place of the order.
    pub joints: [usize; 6],
    /// Whether the half tangent is that of the fifth in place of the fourth.
    pub swapped: bool,
}

/// A loop in the order of a code.
pub fn arrange(lines: &[Line; 6], goal: &Motion, code: usize) -> Arranged {
    let reversed = code >= 12;
    let (shift, swapped) = (code % 12 / 2, code % 2 == 1);
    let goal = if reversed { goal.inverse() } else { *goal };
    let undo = goal.inverse();
    let (mut placed, mut joints) = (*lines, [0; 6]);
    for i in 0..6 {
        let place = (i + shift) % 6;
        joints[i] = if reversed { 5 - place } else { place };
        placed[i] = lines[joints[i]];
        if reversed {
            placed[i].direction = times(placed[i].direction, -1.0);
        }
        if i + shift >= 6 {
            // e1 X = G is X (G^-1 e1 G) = G.
            placed[i] = undo.moved(&placed[i]);
        }
    }
    Arranged { lines: placed, goal, joints, swapped }
}

/// The first two turns and the last, from the middle three.
pub fn close(loop_: &Arranged, middle: [[f64; 2]; 3]) -> Option<[[f64; 2]; 3]> {
    let lines = &loop_.lines;
    let reached =
        lines[2].moved(&lines[3].moved(&lines[4].moved(&lines[5], middle[2]), middle[1]), middle[0]);
    let goal = loop_.goal.moved(&lines[5]);
    let (h1, h2) = (lines[0].direction, lines[1].direction);
    // e1 e2 takes the line (p, l) to (g, m); what e1 leaves alone is linear in the cosine and sine of q2.
    let (p, l) = (minus(reached.point, lines[1].point), reached.direction);
    let (g, m) = (minus(goal.point, lines[0].point), goal.direction);
    let step = minus(lines[1].point, lines[0].point);
    // u . R2 v = right as coefficients of cosine and sine, and what is left.
    let turned = |u: Vector, v: Vector, right: f64| {
        let along = times(h2, dot(h2, v));
        [dot(u, minus(v, along)), dot(u, cross(h2, v)), right - dot(u, along)]
    };
    let moment = turned(h1, cross(p, l), dot(h1, cross(g, m)));
    let lever = turned(cross(h1, step), l, 0.0);
    let equations = [
        turned(h1, l, dot(h1, m)),
        turned(h1, p, dot(h1, g) - dot(h1, step)),
        turned(step, p, 0.5 * (dot(g, g) - dot(p, p) - dot(step, step))),
        turned(step, l, dot(g, m) - dot(p, l)),
        plus(moment, lever),
    ];
    let [mut cc, mut cs, mut ss, mut cr, mut sr] = [0.0; 5];
    for [c, s, r] in equations {
        cc += c * c;
        cs += c * s;
        ss += s * s;
        cr += c * r;
        sr += s * r;
    }
    let q2 = unit(cr * ss - sr * cs, sr * cc - cr * cs, 0.0)?;
    let moved = [plus(lines[1].turned(p, q2), step), lines[1].turned(l, q2)];
    let q1 = align(h1, moved, [g, m])?;
    // Near roots that are no solutions, or of many that fall together, the loop misses by its own size.
    let [at, along] = moved.map(|v| lines[0].turned(v, q1));
    let (gap, lean) = (minus(at, g), minus(along, m));
    let size = dot(g, g) + dot(p, p) + dot(step, step);
    if !(dot(gap, gap) <= size && dot(lean, lean) <= 1.0) {
        return None;
    }
    // A vector that is not along the last axis shows how far that has turned.
    let h6 = lines[5].direction;
    let side = if h6[0].abs() < 0.8 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
    let mut seen = loop_.goal.turned(side);
    for (line, turn) in lines.iter().zip([q1, q2, middle[0], middle[1], middle[2]]) {
        seen = line.turned(seen, back(turn));
    }
    Some([q1, q2, align(h6, [side, [0.0; 3]], [seen, [0.0; 3]])?])
}

/// The turn about `axis` that takes vectors to others as well as it can.
fn align(axis: Vector, from: [Vector; 2], to: [Vector; 2]) -> Option<[f64; 2]> {
    let (mut x, mut y) = (0.0, 0.0);
    for (from, to) in from.into_iter().zip(to) {
        let across = minus(from, times(axis, dot(axis, from)));
        x += dot(across, to);
        y += dot(axis, cross(across, to));
    }
    unit(x, y, 0.0)
}

/// Candidates for `e1 ... e6 = goal`: the joints' lines at zero turn. Orders that break down at this goal are passed over, the others are
/// tried one after the other until one has shown all there is. Where all break down, goals nearby are solved.
///
/// Slack is for poses at which that gave nothing. Solutions are then a continuum, or many fall together. At a goal nearby
/// they are isolated, and near enough for a polish.
pub fn six(lines: &[Line; 6], goal: &Motion, orders: &[Order], slack: f64) -> Candidates {
    let mut found = Candidates::NONE;
    let goal = if slack > 0.0 { nudged(goal, 0.1 * slack) } else { *goal };
    let mut sound = 0;
    for order in orders {
        let shown = solve(lines, &goal, *order, slack, MOST_VIEWS, &mut found);
        if shown == Shown::All && slack == 0.0 {
            return found;
        }
        if shown == Shown::Nothing {
            continue;
        }
        // Solutions that share the angle here do not at a goal nearby; but those that are nearly singular may not reach it.
        if sound < BESIDE.len() && slack == 0.0 {
            let near = nudged(&goal, BESIDE[sound]);
            if solve(lines, &near, *order, slack, 1, &mut found) == Shown::All && shown == Shown::Most {
                return found;
            }
        }
        sound += 1;
    }
    if sound == 0 && !orders.is_empty() {
        for (i, size) in BESIDE.into_iter().enumerate() {
            solve(lines, &nudged(&goal, size), orders[i % orders.len()], slack, 1, &mut found);
        }
    }
    found
}

/// A motion near another, in no special direction.
pub fn nudged(goal: &Motion, size: f64) -> Motion {
    let turn = cos_sin(size);
    let about = Line { direction: [0.48, -0.6, 0.64], point: [0.0; 3] };
    let column = |i: usize| about.turned([goal.rows[0][i], goal.rows[1][i], goal.rows[2][i]], turn);
    let [a, b, c] = [column(0), column(1), column(2)];
    let rows = [[a[0], b[0], c[0]], [a[1], b[1], c[1]], [a[2], b[2], c[2]]];
    Motion { rows, place: plus(goal.place, times([0.64, 0.48, -0.6], size)) }
}

/// How much an order has shown of what there is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd)]
enum Shown {
    /// It breaks down at this goal.
    Nothing,
    /// Not what is in flat places: there were too many.
    Part,
    /// Not all roots that nearly fall together could be told apart.
    Most,
    /// Everything.
    All,
}

/// Adds the candidates of one order; says how much of all that there is they are.
fn solve(
    lines: &[Line; 6],
    goal: &Motion,
    order: Order,
    slack: f64,
    most: usize,
    found: &mut Candidates,
) -> Shown {
    let loop_ = arrange(lines, goal, order.code);
    let six = eliminate(&loop_.lines, &loop_.goal, loop_.swapped);
    // Views that are left to look at, those of wide places before those within them.
    let (mut views, mut next, mut end) = ([View::WHOLE; MOST_VIEWS], 0, 1);
    let mut all = Shown::All;
    let before = found.len;
    while next < end {
        let view = views[next];
        next += 1;
        let (shown, flats) = look(&loop_, &six, order, &view, slack, most - end, found);
        if shown < all {
            all = shown;
        }
        for (u, width) in &flats.places[..flats.count] {
            views[end] = view.zoomed(*u, *width);
            end += 1;
        }
    }
    if all == Shown::All && found.len == before { Shown::Most } else { all }
}

/// Places where a polynomial is all but zero, and how widely.
struct Flats {
    places: [(f64, f64); MOST_VIEWS],
    count: usize,
    /// For each root, whether it is at one of them.
    holds: [bool; MAX_SIZE],
    /// Whether there are more.
    more: bool,
}

impl Flats {
    /// None.
    const NONE: Flats =
        Flats { places: [(0.0, 1.0); MOST_VIEWS], count: 0, holds: [false; MAX_SIZE], more: false };

    /// So many of them, flattest first, as wide as the roots reach that rounding has moved.
    fn new(
        six: &Six,
        order: Order,
        view: &View,
        waves: &Waves,
        roots: &[Root],
        turns: &[[f64; 2]; MAX_SIZE],
        most: usize,
    ) -> Flats {
        let mut rises = [f64::MAX; MAX_SIZE];
        for (i, root) in roots.iter().enumerate() {
            let Root { angle, imaginary } = *root;
            if view.is_beside(turns[i])
                || imaginary.abs() >= 1.0
                || order.squared && imaginary.abs() < NEARLY_REAL
            {
                continue;
            }
            let rise = waves.rise(angle, NEARLY_REAL);
            let mut low = rise < FLAT * waves.largest;
            if !low && rise < FAINT * waves.largest {
                let miss = view.value(six, order.degree, angle).0 - waves.at(angle)[0];
                low = miss.abs() > OFF * rise;
            }
            if low {
                rises[i] = rise;
            }
        }
        let mut flats = Flats::NONE;
        loop {
            let (mut least, mut at) = (f64::MAX, 0);
            for (i, rise) in rises.iter().enumerate() {
                if *rise < least {
                    (least, at) = (*rise, i);
                }
            }
            if least == f64::MAX {
                return flats;
            }
            if flats.count == most {
                flats.more = true;
                return flats;
            }
            let mut width = 1e-3;
            for (i, root) in roots.iter().enumerate() {
                let [c, s] = between(turns[at], turns[i]);
                let gap = s.abs() + root.imaginary.abs();
                if rises[i] < f64::MAX && c > 0.0 && gap < 0.5 {
                    width = if gap > width { gap } else { width };
                    rises[i] = f64::MAX;
                    flats.holds[i] = true;
                }
            }
            rises[at] = f64::MAX;
            flats.holds[at] = true;
            flats.places[flats.count] = (roots[at].angle, width);
            flats.count += 1;
        }
    }
}

/// The turn from one to another.
fn between([a, b]: [f64; 2], [c, s]: [f64; 2]) -> [f64; 2] {
    [a * c + b * s, a * s - b * c]
}

/// Adds the candidates that show in one view; says how much they are of what is there, and where the polynomial is all but zero,
/// if it is, and how widely.
fn look(
    loop_: &Arranged,
    six: &Six,
    order: Order,
    view: &View,
    slack: f64,
    most: usize,
    found: &mut Candidates,
) -> (Shown, Flats) {
    let (samples, clear) = view.samples(six, order.degree);
    if clear < BROKEN {
        return (if view.width < 1.0 { Shown::Most } else { Shown::Nothing }, Flats::NONE);
    }
    let waves = Waves::new(&samples, order.degree);
    let mut roots = [Root { angle: 0.0, imaginary: 0.0 }; MAX_SIZE];
    let count = waves.roots(order.squared, &mut roots);
    let multiplicity = if order.squared { 2 } else { 1 };
    let turns = roots.map(|root| cos_sin(root.angle));
    let mut apart = count * multiplicity == 2 * order.degree;
    let flats = Flats::new(six, order, view, &waves, &roots[..count], &turns, most);
    let mut done = [false; MAX_SIZE];
    apart &= clear > MURKY;
    let mut add = |turn, [tangent, other]: Pair| {
        let middle = if loop_.swapped { [turn, other, tangent] } else { [turn, tangent, other] };
        if let Some([q1, q2, q6]) = close(loop_, middle) {
            let mut turns = [[1.0, 0.0]; 6];
            for (joint, turn) in loop_.joints.into_iter().zip([q1, q2, middle[0], middle[1], middle[2], q6]) {
                turns[joint] = turn;
            }
            found.push(turns);
        }
    };
    for i in 0..count {
        let Root { angle, imaginary } = roots[i];
        if done[i] || view.is_beside(turns[i]) || imaginary.abs() > NEARLY_REAL + 5.0 * sqrt(slack) {
            continue;
        }
        let (mut together, mut shift, mut spread) = (0, 0.0, 0.0f64);
        let mut near = [false; MAX_SIZE];
        for (j, other) in roots[..count].iter().enumerate() {
            let [c, s] = between(turns[i], turns[j]);
            let gap = s.abs() + (other.imaginary - imaginary).abs();
            near[j] = c > 0.0 && gap < APART;
            if near[j] {
                spread = spread.max(gap);
                together += multiplicity;
                shift += s;
            }
        }
        // Roots that nearly fall together: their mean is more exact than each of them.
        let mean = angle + shift * multiplicity as f64 / together as f64;
        if flats.holds[i] {
            // The rest shows in the view of the place.
            for j in 0..count {
                done[j] |= near[j] && flats.holds[j];
            }
            let (turn, _) = view.turn(mean);
            if several(six, turn, NOTHING, |pair| add(turn, pair)) < 2
                && let Some(pair) = single(six, turn)
            {
                add(turn, pair);
            }
            continue;
        }
        // Where null vectors of dimension one are looked for.
        let (mut starts, mut many) = ([angle; MAX_SIZE], 0);
        let [extremum, value, bend] = waves.extremum(mean);
        let fold = together == 2 && !order.squared && slack == 0.0;
        // The determinant itself tells how far its waves are off.
        let exact = if fold { view.value(six, order.degree, extremum).0 } else { value };
        let off = (exact - value).abs() + FLAT * waves.largest;
        if together == 1 || fold && imaginary == 0.0 && exact.abs() > off {
            starts[0] = refined(six, &waves, view, angle);
            many = 1;
        } else {
            done.iter_mut().zip(near).for_each(|(done, near)| *done |= near);
            let merged = spread < MERGED || order.squared;
            let (turn, _) = view.turn(mean);
            let all = several(six, turn, NOTHING, |pair| add(turn, pair)) == together;
            apart &= merged && (all || fold && is_alone(six, turn));
            if all && merged {
                continue;
            }
            if fold {
                // Seen from outside of the two each leads to its own.
                let side = sqrt(2.0 * (exact.abs() + ROUNDING * waves.largest) / bend.abs());
                starts[..2].copy_from_slice(&[extremum - side, extremum + side]);
                many = 2;
            }
            // Real roots may also be of solutions far apart that share the angle by chance.
            if !fold || imaginary == 0.0 {
                for (root, _) in roots.iter().zip(near).filter(|(_, near)| *near) {
                    starts[many] = root.angle;
                    many += 1;
                }
            }
        }
        for u in &starts[..many] {
            let (turn, _) = view.turn(*u);
            match single(six, turn) {
                Some(pair) => add(turn, pair),
                None => apart = false,
            }
        }
    }
    let told = if apart { Shown::All } else { Shown::Most };
    (if flats.more { Shown::Part } else { told }, flats)
}

/// The determinant of an order, from which the compiler learns its degree.
pub fn waves_of(lines: &[Line; 6], goal: &Motion, code: usize) -> Waves {
    let loop_ = arrange(lines, goal, code);
    let six = eliminate(&loop_.lines, &loop_.goal, loop_.swapped);
    Waves::new(&View::WHOLE.samples(&six, MAX_DEGREE).0, MAX_DEGREE)
}

/// Numbers that [`six_of`] takes: six lines as direction and point, the rows of the goal's rotation, its place, and
/// [`MOST_ORDERS`] orders as code, degree (zero for none), and whether the determinant is a square.
pub const NUMBERS: usize = 48 + 3 * MOST_ORDERS;

/// Most orders of a program.
pub const MOST_ORDERS: usize = 3;

/// As [`six`], from plain numbers.
pub fn six_of(x: &[f64; NUMBERS], slack: f64) -> Candidates {
    let vector = |i: usize| [x[i], x[i + 1], x[i + 2]];
    let mut lines = [Line { direction: [0.0; 3], point: [0.0; 3] }; 6];
    for (i, line) in lines.iter_mut().enumerate() {
        *line = Line { direction: vector(6 * i), point: vector(6 * i + 3) };
    }
    let goal = Motion { rows: [vector(36), vector(39), vector(42)], place: vector(45) };
    let mut orders = [Order { code: 0, degree: 0, squared: false }; MOST_ORDERS];
    let mut count = 0;
    for number in x[48..].chunks(3) {
        let degree = number[1] as usize;
        if (1..=MAX_DEGREE).contains(&degree) {
            orders[count] = Order { code: number[0] as usize % ORDERS, degree, squared: number[2] != 0.0 };
            count += 1;
        }
    }
    for number in x {
        if !(number.abs() < f64::INFINITY) {
            return Candidates::NONE;
        }
    }
    six(&lines, &goal, &orders[..count], slack)
}
