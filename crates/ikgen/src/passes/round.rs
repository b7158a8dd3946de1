//! Constants with no more digits than mean something.
//!
//! A description that writes a right angle with six digits leaves its mark in every product of rotations: factors of 1e-11, and of one
//! less 1e-12. In a program for an ideal chain they are far below what that chain is off anyway, and its candidates are polished.

use std::collections::HashMap;

use super::{rewrite, with_body};
use crate::ir::{Block, Expr, Exprs, Program, Stmt, map_stmt};

/// Rounds constants to so many decimals. What is solved for the described chain stays.
pub fn round(program: &Program, decimals: u8) -> Program {
    let mut exprs = program.exprs.clone();
    let scale = libm::exp10(f64::from(decimals));
    let body = block(&program.body, &program.exprs, &mut exprs, scale, &mut HashMap::new());
    with_body(program, exprs, program.names.clone(), body)
}

fn block(stmts: &Block, from: &Exprs, to: &mut Exprs, scale: f64, memo: &mut HashMap<Expr, Expr>) -> Block {
    let rounded =
        |e: Expr, to: &mut Exprs| from.as_constant(e).map(|x| to.constant((x * scale).round() / scale));
    let mut out = Vec::new();
    for stmt in stmts {
        if matches!(stmt, Stmt::Rest(_)) {
            out.push(stmt.clone());
            continue;
        }
        let mut stmt = map_stmt(stmt, &mut |e| rewrite(from, to, e, memo, &rounded));
        match &mut stmt {
            Stmt::ForEach { body, .. } => *body = block(body, from, to, scale, memo),
            Stmt::IfZero { then, otherwise, .. } | Stmt::Fallback { first: then, otherwise } => {
                *then = block(then, from, to, scale, memo);
                *otherwise = block(otherwise, from, to, scale, memo);
            }
            _ => {}
        }
        out.push(stmt);
    }
    out
}
