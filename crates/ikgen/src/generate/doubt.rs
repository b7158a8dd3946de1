//! Where the ideal chain may have lost roots that the described one has.
//!
//! Two roots of an equation that have nearly fallen together, or have just missed each other, may be there on one of the chains and
//! not on the other, and no polish leads from nothing to a solution. After such a doubt the general solver is asked too, once: it takes
//! the chain as it is described.

use crate::ir::{Binary, Block, Expr, Exprs, Program, RootKind, Stmt, Unary};

/// Doubt begins where an equation is nearer to losing its roots than this many times the slack: what comes before it may have magnified
/// the difference of the chains.
const REACH: f64 = 16.0;

/// The same for equations behind others, times the slopes of these.
const BEHIND: f64 = 1.0;

/// In a program that ends in the general solver, notes a doubt before each equation of the ideal chain that may lack roots.
pub(super) fn note_doubts(program: &mut Program) {
    let reach = REACH * program.slack;
    let mut body = std::mem::take(&mut program.body);
    note(&mut body, &mut program.exprs, reach, None);
    program.body = body;
}

/// Notes doubts in a block; `before` is what is left of the tolerance after the equations whose roots the block follows. A root that is
/// near to another is off by the difference of the chains over a slope: by so much more are the equations after it.
fn note(block: &mut Block, exprs: &mut Exprs, reach: f64, before: Option<Expr>) {
    let mut noted = Vec::new();
    for mut stmt in std::mem::take(block) {
        match &mut stmt {
            Stmt::ForEach { kind, args, body, .. } => {
                let mut within = before;
                if let Some((value, tolerance)) = edge(*kind, args, exprs, reach) {
                    noted.push(Stmt::Doubt { value, tolerance });
                    if let Some(before) = before {
                        let value = exprs.binary(Binary::Mul, before, value);
                        noted.push(Stmt::Doubt { value, tolerance: tolerance / REACH * BEHIND });
                    }
                    let slope = slope(value, exprs);
                    within = Some(before.map_or(slope, |before| exprs.binary(Binary::Mul, before, slope)));
                }
                note(body, exprs, reach, within);
            }
            // What an ideal chain can do where it lines up, the described one can hardly: that is for the general solver.
            Stmt::Fallback { first, otherwise }
                if let [Stmt::IfZero { value, tolerance, otherwise: none, .. }] = &otherwise[..]
                    && none.is_empty() =>
            {
                noted.push(Stmt::Doubt { value: *value, tolerance: *tolerance });
                note(first, exprs, reach, before);
                noted.append(first);
                continue;
            }
            Stmt::IfZero { then, otherwise, .. } | Stmt::Fallback { first: then, otherwise } => {
                note(then, exprs, reach, before);
                note(otherwise, exprs, reach, before);
            }
            // The general solver has no doubts.
            _ => {}
        }
        noted.push(stmt);
    }
    *block = noted;
}

/// The slope of an equation at its roots, one at most, by how near it is to losing them.
fn slope(value: Expr, exprs: &mut Exprs) -> Expr {
    let minus = exprs.unary(Unary::Neg, value);
    let distance = exprs.binary(Binary::Max, value, minus);
    let root = exprs.unary(Unary::Sqrt, distance);
    let one = exprs.constant(1.0);
    exprs.binary(Binary::Min, root, one)
}

/// What is small where the roots of an equation are about to fall together, and how small.
fn edge(kind: RootKind, args: &[Expr], exprs: &mut Exprs, reach: f64) -> Option<(Expr, f64)> {
    match (kind, args) {
        (RootKind::Circle, [a, b, d]) => {
            let (aa, bb) = (exprs.binary(Binary::Mul, *a, *a), exprs.binary(Binary::Mul, *b, *b));
            let square = exprs.binary(Binary::Add, aa, bb);
            let size = exprs.unary(Unary::Sqrt, square);
            let minus = exprs.unary(Unary::Neg, *d);
            let distance = exprs.binary(Binary::Max, *d, minus);
            Some((exprs.binary(Binary::Sub, distance, size), reach))
        }
        // A cosine is off by half of the square of the sine.
        (RootKind::Mirror | RootKind::Half, [_, y]) => Some((exprs.binary(Binary::Mul, *y, *y), 2.0 * reach)),
        _ => None,
    }
}
