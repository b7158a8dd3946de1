//! Programs made ready for one chain: each candidate carries its angles and by how much it misses the pose.
//!
//! As part of the program they take part in the passes: what a loop does not change of the forward kinematics is computed before
//! it, an angle that two candidates share is taken once, and the zeros of the chain's constants cost nothing.

use super::cost::cost;
use super::{flip, optimise, with_body};
use crate::ir::{Binary, Block, Expr, Exprs, Node, Program, Stmt, Unary, Value, Var};
use crate::kernel::chain::{Frame, Link};
use crate::run::TrueChain;

/// The program with every `emit` turned into an [`Offer`](Stmt::Offer) for this chain. Of candidates that cannot be exact the angles and
/// the misses are left open.
///
/// The pose is compared in the middle of the chain, where that is cheapest: what comes after is undone on the wanted pose.
pub fn prepare(program: &Program, chain: &TrueChain) -> Program {
    if program.snap > 0.0 {
        // Candidates of an ideal chain never are exact: a check of theirs would only be in vain.
        let mut out = with_body(program, program.exprs.clone(), program.names.clone(), Vec::new());
        let mut body = program.body.clone();
        unchecked(&mut body, &mut out);
        out.body = body;
        return optimise(&out);
    }
    let factors = 2 * chain.links.len() + 1;
    // At least the tip is undone; what lies beyond a sliding joint has no fixed lever.
    let first = chain.links.iter().rposition(|l| l.slides).map_or(1, |i| 2 * i + 2);
    // What mirrored roots share decides much of what a cut costs.
    let flipped = flip(program);
    let cut = (first..factors).min_by_key(|cut| cost(&with_offers(&flipped, chain, *cut)));
    optimise(&with_offers(program, chain, cut.expect("a chain has at least one joint")))
}

fn with_offers(program: &Program, chain: &TrueChain, cut: usize) -> Program {
    let mut out = with_body(program, program.exprs.clone(), program.names.clone(), Vec::new());
    let mut body = program.body.clone();
    block(&mut body, &mut out, chain, cut, &mut Vec::new());
    out.body = body;
    out
}

/// `pairs` are the names of cosines and sines that roots are bound to around the block.
fn block(stmts: &mut Block, out: &mut Program, chain: &TrueChain, cut: usize, pairs: &mut Vec<[Var; 2]>) {
    let mut i = 0;
    while i < stmts.len() {
        match &mut stmts[i] {
            Stmt::ForEach { kind, body, .. } if kind.is_joint() => unchecked(body, out),
            Stmt::ForEach { out: names, body, .. } => {
                let outer = pairs.len();
                pairs.extend(names.chunks_exact(2).map(|p| [p[0], p[1]]));
                block(body, out, chain, cut, pairs);
                pairs.truncate(outer);
            }
            Stmt::Rest(body) => block(body, out, chain, cut, pairs),
            Stmt::IfZero { then, otherwise, .. } | Stmt::Fallback { first: then, otherwise } => {
                block(then, out, chain, cut, pairs);
                block(otherwise, out, chain, cut, pairs);
            }
            Stmt::Emit(values) => {
                let values = std::mem::take(values);
                let offer = offer(values, out, chain, cut, pairs);
                i += offer.len() - 1;
                stmts.splice(i + 1 - offer.len()..=i + 1 - offer.len(), offer);
            }
            _ => {}
        }
        i += 1;
    }
}

/// Leaves the check of candidates to whoever takes them. Those of six joints at once share nothing that could be computed before.
fn unchecked(stmts: &mut Block, out: &mut Program) {
    let (unknown, wrong) = (out.exprs.constant(0.0), out.exprs.constant(1.0));
    for stmt in stmts {
        match stmt {
            Stmt::Emit(values) => {
                let values = std::mem::take(values);
                let angle = |v: usize| match given(&out.free, v) {
                    Some(k) => out.exprs.intern(Node::Free(k)),
                    None => unknown,
                };
                let angles = (0..values.len()).map(angle).collect();
                *stmt = Stmt::Offer { values, angles, misses: [wrong; 2] };
            }
            Stmt::ForEach { body, .. } | Stmt::Rest(body) => unchecked(body, out),
            Stmt::IfZero { then, otherwise, .. } | Stmt::Fallback { first: then, otherwise } => {
                unchecked(then, out);
                unchecked(otherwise, out);
            }
            _ => {}
        }
    }
}

/// The statements in place of an `emit`.
fn offer(
    values: Vec<Value>,
    out: &mut Program,
    chain: &TrueChain,
    cut: usize,
    pairs: &[[Var; 2]],
) -> Vec<Stmt> {
    let mut stmts = vec![Stmt::Note("the candidate: its angles, and how far it is from the pose".into())];
    let e = &mut out.exprs;
    let angles: Vec<Expr> = (values.iter().enumerate())
        .map(|(variable, value)| match (given(&out.free, variable), *value) {
            (Some(k), _) => e.intern(Node::Free(k)),
            (None, Value::Angle(c, s)) if !chain.slides[variable] => e.binary(Binary::AngleOf, s, c),
            (None, Value::Angle(x, _) | Value::Length(x)) => x,
        })
        .collect();
    let steps: Vec<Step> = chain.links.iter().map(|link| step(e, &values, &angles, link)).collect();
    let (mut left, mut right) = (Rigid::identity(e), Rigid::wanted(e));
    let mut lever = 1.0;
    for factor in 0..cut {
        left = match factor % 2 {
            0 => left.times(e, &chain.links[factor / 2].previous_from_joint),
            _ => left.moved(e, steps[factor / 2]),
        };
    }
    let mut undo = |right: Rigid, e: &mut Exprs, frame: &Frame| {
        lever += frame.position.iter().map(|x| x.abs()).sum::<f64>();
        right.times(e, &inverse(frame))
    };
    right = undo(right, e, &chain.last_from_tip);
    for factor in (cut..2 * chain.links.len()).rev() {
        right = match factor % 2 {
            0 => undo(right, e, &chain.links[factor / 2].previous_from_joint),
            _ => {
                let back = steps[factor / 2].back(e);
                right.moved(e, back)
            }
        };
    }
    let off: Vec<Expr> = steps.iter().filter_map(|step| off_circle(e, pairs, *step)).collect();
    let zero = e.constant(0.0);
    let mut squares = |pairs: Vec<(Expr, Expr)>| {
        let mut sum = e.constant(0.0);
        for (a, b) in pairs {
            let difference = e.binary(Binary::Sub, a, b);
            let square = e.binary(Binary::Mul, difference, difference);
            sum = e.binary(Binary::Add, sum, square);
        }
        sum
    };
    let entries = (0..9).map(|i| (left.rotation[i / 3][i % 3], right.rotation[i / 3][i % 3]));
    let rotation = squares(entries.chain(off.into_iter().map(|x| (x, zero))).collect());
    let position = squares((0..3).map(|i| (left.position[i], right.position[i])).collect());
    // A rotation that is off moves the tip by no more than its lever.
    let weight = e.constant(lever * lever);
    let rotation = e.binary(Binary::Mul, weight, rotation);
    stmts.push(Stmt::Offer { values, angles, misses: [rotation, position] });
    stmts
}

fn given(free: &[usize], variable: usize) -> Option<u8> {
    free.iter().position(|v| *v == variable).map(|k| k as u8)
}

/// How a joint has moved.
#[derive(Clone, Copy)]
enum Step {
    Turn(Expr, Expr),
    Slide(Expr),
}

impl Step {
    fn back(self, e: &mut Exprs) -> Self {
        match self {
            Step::Turn(c, s) => Step::Turn(c, e.unary(Unary::Neg, s)),
            Step::Slide(x) => Step::Slide(e.unary(Unary::Neg, x)),
        }
    }
}

fn step(e: &mut Exprs, values: &[Value], angles: &[Expr], link: &Link) -> Step {
    let ratio = e.constant(link.ratio);
    match values[link.variable] {
        Value::Length(x) | Value::Angle(x, _) if link.slides => Step::Slide(e.binary(Binary::Mul, ratio, x)),
        Value::Length(x) => Step::Turn(x, e.constant(0.0)),
        Value::Angle(c, s) if link.ratio == 1.0 => Step::Turn(c, s),
        Value::Angle(..) => {
            let angle = e.binary(Binary::Mul, ratio, angles[link.variable]);
            Step::Turn(e.unary(Unary::Cos, angle), e.unary(Unary::Sin, angle))
        }
    }
}

/// By how much cosine and sine are off the unit circle; nothing where they are so by construction: a root, up to signs, or the
/// functions of one angle.
fn off_circle(e: &mut Exprs, pairs: &[[Var; 2]], step: Step) -> Option<Expr> {
    let Step::Turn(c, s) = step else { return None };
    let bare = |x: Expr| match e.node(x) {
        Node::Unary(Unary::Neg, y) => e.node(y),
        node => node,
    };
    match (bare(c), bare(s)) {
        (Node::Var(c), Node::Var(s)) if pairs.contains(&[c, s]) => return None,
        (Node::Unary(Unary::Cos, a), Node::Unary(Unary::Sin, b)) if a == b => return None,
        _ => {}
    }
    let (cc, ss) = (e.binary(Binary::Mul, c, c), e.binary(Binary::Mul, s, s));
    let square = e.binary(Binary::Add, cc, ss);
    let one = e.constant(1.0);
    Some(e.binary(Binary::Sub, square, one))
}

/// A transform whose entries are expressions.
#[derive(Clone, Copy)]
struct Rigid {
    rotation: [[Expr; 3]; 3],
    position: [Expr; 3],
}

impl Rigid {
    fn identity(e: &mut Exprs) -> Self {
        let (zero, one) = (e.constant(0.0), e.constant(1.0));
        let rotation = [0, 1, 2].map(|i| [0, 1, 2].map(|j| if i == j { one } else { zero }));
        Self { rotation, position: [zero; 3] }
    }

    /// The pose that the program is given.
    fn wanted(e: &mut Exprs) -> Self {
        let rotation = [0, 1, 2].map(|i| [0, 1, 2].map(|j| e.intern(Node::Rotation(i, j))));
        Self { rotation, position: [0, 1, 2].map(|i| e.intern(Node::Position(i))) }
    }

    fn times(self, e: &mut Exprs, frame: &Frame) -> Self {
        let mut out = self;
        for i in 0..3 {
            let row = self.rotation[i];
            for j in 0..3 {
                let column = [0, 1, 2].map(|k| clean(frame.rotation[k][j]));
                out.rotation[i][j] = dot(e, row, column);
            }
            let shift = dot(e, row, frame.position.map(clean));
            out.position[i] = e.binary(Binary::Add, self.position[i], shift);
        }
        out
    }

    fn moved(self, e: &mut Exprs, step: Step) -> Self {
        let mut out = self;
        for i in 0..3 {
            let [x, y, z] = self.rotation[i];
            match step {
                Step::Slide(length) => {
                    let shift = e.binary(Binary::Mul, length, z);
                    out.position[i] = e.binary(Binary::Add, self.position[i], shift);
                }
                Step::Turn(c, s) => {
                    let mut product = |a, b| e.binary(Binary::Mul, a, b);
                    let (cx, sy, cy, sx) = (product(c, x), product(s, y), product(c, y), product(s, x));
                    out.rotation[i] = [e.binary(Binary::Add, cx, sy), e.binary(Binary::Sub, cy, sx), z];
                }
            }
        }
        out
    }
}

fn dot(e: &mut Exprs, row: [Expr; 3], column: [f64; 3]) -> Expr {
    let mut sum = e.constant(0.0);
    for (a, b) in row.into_iter().zip(column) {
        let b = e.constant(b);
        let product = e.binary(Binary::Mul, a, b);
        sum = e.binary(Binary::Add, sum, product);
    }
    sum
}

/// Constants of a chain come from products of rotations: their zeros and ones are off by rounding, far below what a check can see.
fn clean(x: f64) -> f64 {
    let whole = if x > 0.5 {
        1.0
    } else if x < -0.5 {
        -1.0
    } else {
        0.0
    };
    if (x - whole).abs() < 2e-15 { whole } else { x }
}

fn inverse(frame: &Frame) -> Frame {
    let r = &frame.rotation;
    let rotation = [0, 1, 2].map(|i| [0, 1, 2].map(|j| r[j][i]));
    let p = &frame.position;
    let position = rotation.map(|row| -(row[0] * p[0] + row[1] * p[1] + row[2] * p[2]));
    Frame { rotation, position }
}
