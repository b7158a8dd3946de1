//! Where the ideal chain may have lost roots that the described one has.
//!
//! Two roots of an equation that have nearly fallen together, or have just missed each other, may be there on one of the chains and
//! not on the other, and no polish leads from nothing to a solution. There the general solver is asked too: it takes the chain as it is
//! described.

use crate::ir::{Binary, Block, Expr, Exprs, Program, RootKind, Stmt, Unary};

/// Doubt begins where an equation is nearer to losing its roots than this many times the slack: what comes before it may have magnified
/// the difference of the chains.
const REACH: f64 = 16.0;

/// In a program that asks the general solver where an ideal chain gives nothing, asks it wherever the ideal chain is in doubt.
pub(super) fn ask_where_in_doubt(program: &mut Program) {
    let reach = REACH * program.slack;
    let exprs = &mut program.exprs;
    for stmt in &mut program.body {
        if let Stmt::Fallback { first, otherwise } = stmt {
            guard(first, otherwise, exprs, reach);
        }
    }
}

fn guard(block: &mut Block, general: &Block, exprs: &mut Exprs, reach: f64) {
    let mut guarded = Vec::new();
    for mut stmt in std::mem::take(block) {
        match &mut stmt {
            Stmt::ForEach { kind, args, body, .. } => {
                if let Some((value, tolerance)) = edge(*kind, args, exprs, reach) {
                    let then = general.clone();
                    guarded.push(Stmt::IfZero { value, tolerance, then, otherwise: Vec::new() });
                }
                guard(body, general, exprs, reach);
            }
            Stmt::IfZero { then, otherwise, .. } | Stmt::Fallback { first: then, otherwise } => {
                guard(then, general, exprs, reach);
                guard(otherwise, general, exprs, reach);
            }
            _ => {}
        }
        guarded.push(stmt);
    }
    *block = guarded;
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
