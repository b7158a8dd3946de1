//! Any chain whose unknowns can be found one after the other, each from equations that hold no other.
//!
//! At each step all equations of the loop are tried on random values: one that changes with a single unknown, whatever the
//! others are, gives it. Unknowns that two equations give without a choice come first, then lengths, then angles of which there are
//! two, and last those of which there are four.

use robotc_core::Seed;
use robotc_core::model::ChainMotion;

use super::builder::{Builder, Move, Scalar, Turn};
use super::equations::{Equation, State, Step, all};
use super::facts::{Axis, Facts};
use super::problem::{Motion, goal_of};

/// Random values on which dependence is decided.
const SAMPLES: usize = 4;

/// Larger than rounding, smaller than any change.
const CHANGE: f64 = 1e-9;

/// How an unknown follows from equations.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Solution {
    /// Two equations `a cos + b sin = d`.
    Align(Equation, Equation),
    /// One equation of a length, of degree one or two.
    Length(Equation, bool),
    /// One equation `a cos + b sin = d`.
    Circle(Equation),
    /// One equation of degree two in cosine and sine.
    Conic(Equation),
}

impl Solution {
    fn rank(&self) -> usize {
        match self {
            Solution::Align(..) => 0,
            Solution::Length(..) => 1,
            Solution::Circle(_) => 2,
            Solution::Conic(_) => 3,
        }
    }
}

/// Writes the program; `free` are the variables that are given. With `steady` equations whose coefficients change with other unknowns are
/// only taken where there is no other. Says how the unknowns were found, or which are left.
pub(super) fn write(facts: &Facts, free: &[usize], steady: bool, b: &Builder) -> Result<String, String> {
    let axes = &facts.ideal;
    let variables = axes.iter().map(|a| a.variable + 1).max().unwrap_or(0);
    let motion = |v: usize| axes.iter().find(|a| a.variable == v).map_or(ChainMotion::Revolute, |a| a.motion);
    let still = |v: usize| match motion(v) {
        ChainMotion::Revolute => Move::Turn(Turn { cos: b.constant(1.0), sin: b.constant(0.0) }),
        ChainMotion::Prismatic => Move::Slide(b.constant(0.0)),
    };
    let given = |v: usize, k: usize| match motion(v) {
        ChainMotion::Revolute => Move::Turn(b.turn_of(b.free(k as u8))),
        ChainMotion::Prismatic => Move::Slide(b.free(k as u8)),
    };
    let mut moves: Vec<Move<'_>> = (0..variables)
        .map(|v| free.iter().position(|f| *f == v).map_or_else(|| still(v), |k| given(v, k)))
        .collect();
    let goal = goal_of(facts, b);
    let candidates = all(axes);
    let mut unknown: Vec<usize> = (0..variables).filter(|v| !free.contains(v)).collect();
    let mut order = Vec::new();
    while !unknown.is_empty() {
        let found = [steady, false]
            .into_iter()
            .find_map(|steady| next(axes, &candidates, &unknown, variables, steady));
        let Some((v, solution)) = found else {
            let numbers: Vec<String> = unknown.iter().map(|v| (v + 1).to_string()).collect();
            let left = left(axes, &candidates, &unknown, variables);
            return Err(format!("no equation holds only one of the joints {}; {left}", numbers.join(", ")));
        };
        order.push((v + 1).to_string());
        let problem = Written { b, axes, goal: &goal };
        moves[v] = problem.solve(v, &solution, &moves);
        unknown.retain(|u| *u != v);
    }
    b.emit(&moves);
    Ok(format!("joints in the order {}", order.join(", ")))
}

/// Which equations are left: those with the fewest unknowns.
fn left(axes: &[Axis], candidates: &[Equation], unknown: &[usize], variables: usize) -> String {
    /// Sets of unknowns that are told at most.
    const MOST: usize = 4;
    let mut rng = Seed::new(0).split("ikgen equations left").rng();
    let motion = |v: usize| axes.iter().find(|a| a.variable == v).map_or(ChainMotion::Revolute, |a| a.motion);
    let mut draw = || -> Vec<Step> { (0..variables).map(|v| Step::random(motion(v), &mut rng)).collect() };
    let (here, there) = (draw(), draw());
    let mut sets: Vec<(Vec<usize>, Vec<&str>)> = Vec::new();
    for e in candidates {
        let moves = |v: &usize| {
            let mut steps = here.clone();
            steps[*v] = there[*v];
            State { axes, steps, goal: &here }.gap(e).abs() > CHANGE
        };
        let joints: Vec<usize> = unknown.iter().copied().filter(moves).collect();
        let kind = e.measure.name();
        match sets.iter_mut().find(|(other, _)| *other == joints) {
            Some((_, kinds)) if kinds.contains(&kind) => {}
            Some((_, kinds)) => kinds.push(kind),
            None if !joints.is_empty() => sets.push((joints, vec![kind])),
            None => {}
        }
    }
    sets.sort_by(|a, b| a.0.len().cmp(&b.0.len()).then(a.0.cmp(&b.0)));
    let fewest = sets.first().map_or(0, |(joints, _)| joints.len());
    let told = sets.iter().take_while(|(joints, _)| joints.len() == fewest);
    let told = told.take(MOST).map(|(joints, kinds)| {
        let joints: Vec<String> = joints.iter().map(|v| (v + 1).to_string()).collect();
        format!("{} ({})", joints.join(" and "), kinds.join(", "))
    });
    match told.collect::<Vec<String>>() {
        told if told.is_empty() => "none is left".into(),
        told => format!("left are equations in {}", told.join("; ")),
    }
}

/// The best unknown to find next, and how.
///
/// An equation that holds at the right value of its unknown whatever the others are may still change with them at wrong values. Its
/// coefficients then are those at zero of the others, where it may say nothing: `steady` leaves such equations out.
fn next(
    axes: &[Axis],
    candidates: &[Equation],
    unknown: &[usize],
    variables: usize,
    steady: bool,
) -> Option<(usize, Solution)> {
    let mut rng = Seed::new(0).split("ikgen equations").rng();
    let motion = |v: usize| axes.iter().find(|a| a.variable == v).map_or(ChainMotion::Revolute, |a| a.motion);
    let mut draw = || -> Vec<Step> { (0..variables).map(|v| Step::random(motion(v), &mut rng)).collect() };
    let samples: Vec<(Vec<Step>, Vec<Step>)> = (0..SAMPLES).map(|_| (draw(), draw())).collect();
    // Values with the unknowns for which `changed` holds moved elsewhere.
    let mixed = |sample: usize, changed: &dyn Fn(usize) -> bool| {
        let (here, there) = &samples[sample];
        let steps =
            (0..variables).map(|v| if unknown.contains(&v) && changed(v) { there[v] } else { here[v] });
        State { axes, steps: steps.collect(), goal: here }
    };
    let mut best: Option<(usize, f64, usize, Solution)> = None;
    for v in unknown {
        let others: Vec<State<'_>> = (0..SAMPLES).map(|s| mixed(s, &|u| u != *v)).collect();
        let itself: Vec<State<'_>> = (0..SAMPLES).map(|s| mixed(s, &|u| u == *v)).collect();
        let holds = |e: &&Equation| {
            others.iter().all(|state| state.gap(e).abs() < CHANGE)
                && itself.iter().all(|state| state.gap(e).abs() > CHANGE)
        };
        let mut singles: Vec<(Equation, Vec<[f64; 5]>)> = Vec::new();
        // Of equal equations one with the unknown on the left is simpler: what it moves there is constant.
        let on_left = |e: &&Equation| e.moves(axes, true, *v) && !e.moves(axes, false, *v);
        let simple = candidates.iter().filter(on_left).chain(candidates.iter().filter(|e| !on_left(e)));
        for e in simple.filter(holds) {
            let forms: Vec<[f64; 5]> = (0..SAMPLES).map(|s| form(&mixed(s, &|_| false), *v, e)).collect();
            let elsewhere = || (0..SAMPLES).map(|s| form(&mixed(s, &|u| u != *v), *v, e)).collect::<Vec<_>>();
            if steady && !same_form(&forms, &elsewhere()) {
                continue;
            }
            if singles.iter().all(|(_, other)| !same_form(other, &forms)) {
                singles.push((*e, forms));
            }
        }
        let mut offer = |weight: f64, solution: Solution| {
            let better = best.as_ref().is_none_or(|(rank, most, ..)| {
                solution.rank() < *rank || (solution.rank() == *rank && weight > 1.001 * *most)
            });
            if weight > 1e-6 && better {
                best = Some((solution.rank(), weight, *v, solution));
            }
        };
        let least = |values: &mut dyn Iterator<Item = f64>| values.fold(f64::INFINITY, f64::min);
        for (i, (e, forms)) in singles.iter().enumerate() {
            let curved = forms.iter().any(|f| f[3].abs() + f[4].abs() > CHANGE);
            let slope = least(&mut forms.iter().map(|f| libm::hypot(f[1], f[2])));
            match motion(*v) {
                ChainMotion::Prismatic if curved => offer(0.01 * slope, Solution::Length(*e, true)),
                ChainMotion::Prismatic => offer(slope, Solution::Length(*e, false)),
                ChainMotion::Revolute if curved => offer(1.0, Solution::Conic(*e)),
                ChainMotion::Revolute => {
                    offer(slope, Solution::Circle(*e));
                    for (other, others) in &singles[..i] {
                        if others.iter().all(|f| f[3].abs() + f[4].abs() < CHANGE) {
                            let area = least(
                                &mut forms.iter().zip(others).map(|(f, g)| (f[1] * g[2] - f[2] * g[1]).abs()),
                            );
                            offer(area, Solution::Align(*other, *e));
                        }
                    }
                }
            }
        }
    }
    best.map(|(_, _, v, solution)| (v, solution))
}

/// An equation as `a + b c + d s + e c^2 + f c s` of a turn, or `a + b x + e x^2` of a length.
fn form(state: &State<'_>, v: usize, e: &Equation) -> [f64; 5] {
    let mut state = state.clone();
    let slides = matches!(state.steps[v], Step::Slide(_));
    let mut at = |x: f64, y: f64| {
        state.steps[v] = if slides { Step::Slide(x) } else { Step::Turn(x, y) };
        state.gap(e)
    };
    if slides {
        let [zero, plus, minus] = [at(0.0, 0.0), at(1.0, 0.0), at(-1.0, 0.0)];
        return [zero, 0.5 * (plus - minus), 0.0, 0.5 * (plus + minus) - zero, 0.0];
    }
    fit(PLACES.map(|(x, y)| at(x, y)), |x, y| x + y, |x, k| x * k)
}

const HALF: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// Where an equation is evaluated to learn its coefficients.
const PLACES: [(f64, f64); 5] = [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0), (HALF, HALF)];

/// From values at [`PLACES`] to the coefficients of `1, c, s, c^2, c s`.
fn fit<T: Copy>(f: [T; 5], add: impl Fn(T, T) -> T, scale: impl Fn(T, f64) -> T) -> [T; 5] {
    let sum = |terms: &[(T, f64)]| {
        let mut terms = terms.iter().map(|(x, k)| scale(*x, *k));
        let first = terms.next().expect("not empty");
        terms.fold(first, &add)
    };
    let a = sum(&[(f[2], 0.5), (f[3], 0.5)]);
    let b = sum(&[(f[0], 0.5), (f[1], -0.5)]);
    let d = sum(&[(f[2], 0.5), (f[3], -0.5)]);
    let e = sum(&[(f[0], 0.5), (f[1], 0.5), (a, -1.0)]);
    let c_s = sum(&[(f[4], 2.0), (a, -2.0), (b, -2.0 * HALF), (d, -2.0 * HALF), (e, -1.0)]);
    [a, b, d, e, c_s]
}

fn same_form(a: &[[f64; 5]], b: &[[f64; 5]]) -> bool {
    a.iter().flatten().zip(b.iter().flatten()).all(|(x, y)| (x - y).abs() < CHANGE)
}

/// The loop as the program sees it.
struct Written<'a, 'b> {
    b: &'b Builder,
    axes: &'a [Axis],
    goal: &'a Motion<'b>,
}

impl<'b> Written<'_, 'b> {
    /// Writes the equation that gives an unknown; the other unknowns are not in it.
    fn solve(&self, v: usize, solution: &Solution, moves: &[Move<'b>]) -> Move<'b> {
        let b = self.b;
        let name = (v + 1).to_string();
        let zero = b.constant(0.0);
        // A side that the unknown does not move is its constant term.
        let form = |e: &Equation, left: bool, places: &[(f64, f64)]| -> Vec<Scalar<'b>> {
            let at = |(x, y): (f64, f64)| {
                let mut moves = moves.to_vec();
                moves[v] = match moves[v] {
                    Move::Turn(_) => Move::Turn(Turn { cos: b.constant(x), sin: b.constant(y) }),
                    Move::Slide(_) => Move::Slide(b.constant(x)),
                };
                e.side(left, b, self.axes, &moves, self.goal)
            };
            if e.moves(self.axes, left, v) {
                places.iter().map(|p| at(*p)).collect()
            } else {
                vec![at((1.0, 0.0))]
            }
        };
        let sides = |e: &Equation, places: &[(f64, f64)], fit: &dyn Fn(&[Scalar<'b>]) -> Vec<Scalar<'b>>| {
            let [left, right] = [true, false].map(|left| {
                let values = form(e, left, places);
                if let [only] = values[..] { vec![only] } else { fit(&values) }
            });
            let term = |side: &[Scalar<'b>], k: usize| side.get(k).copied();
            (0..left.len().max(right.len()))
                .map(|k| match (term(&left, k), term(&right, k)) {
                    (Some(l), Some(r)) => l - r,
                    (Some(l), None) => l,
                    (None, Some(r)) => -r,
                    (None, None) => zero,
                })
                .collect::<Vec<_>>()
        };
        let linear = |e: &Equation| {
            let terms = sides(e, &PLACES[..4], &|f| {
                vec![(f[0] + f[1]) * 0.5, (f[0] - f[1]) * 0.5, (f[2] - f[3]) * 0.5]
            });
            [terms[1], terms[2], -terms[0]]
        };
        match solution {
            Solution::Align(first, second) => {
                b.note(format!("joint {name}: two equations in its cosine and sine"));
                let ([a, c, e], [f, g, h]) = (linear(first), linear(second));
                // Cramer's rule. Only the sign of the determinant matters; near zero both sides of it vanish.
                let area = a * g - c * f;
                let size = (a * a + c * c + f * f + g * g).max(b.constant(1e-30));
                let sign = area / size;
                Move::Turn(b.align(&name, (e * g - c * h) * sign, (a * h - e * f) * sign))
            }
            Solution::Circle(e) => {
                b.note(format!("joint {name}: an equation of which it is the only unknown"));
                let [a, c, d] = linear(e);
                Move::Turn(b.circle(&name, a, c, d))
            }
            Solution::Conic(e) => {
                b.note(format!("joint {name}: a conic in its cosine and sine"));
                let terms = sides(e, &PLACES, &|f| {
                    let f = [f[0], f[1], f[2], f[3], f[4]];
                    fit(f, |x, y| x + y, |x: Scalar<'b>, k| x * k).to_vec()
                });
                Move::Turn(b.conic(&name, [terms[3], terms[4], zero, terms[1], terms[2], terms[0]]))
            }
            Solution::Length(e, curved) => {
                b.note(format!("joint {name}: its length"));
                let terms = sides(e, &[(0.0, 0.0), (1.0, 0.0), (-1.0, 0.0)], &|f| {
                    let bend = (f[1] + f[2]) * 0.5 - f[0];
                    vec![f[0], (f[1] - f[2]) * 0.5, if *curved { bend } else { zero }]
                });
                Move::Slide(b.quadratic(&name, terms[2], terms[1], terms[0]))
            }
        }
    }
}
