//! Mirrored roots side by side.
//!
//! The two roots of a `mirror` differ in the sign of the sine alone, and so does most of what follows from them: in a wrist the second
//! solution has the other two angles turned by half a turn. Written next to the first, it shares all of that.

use std::collections::HashMap;

use super::with_body;
use crate::ir::{Block, Expr, Exprs, Node, Program, RootKind, Stmt, Unary, Var, blocks_of, map_stmt};
use crate::kernel::roots::VANISHING;

/// Replaces each `mirror` with a simple body by a `half` whose body is done for both signs.
pub fn flip(program: &Program) -> Program {
    let mut out = with_body(program, program.exprs.clone(), program.names.clone(), Vec::new());
    out.body = block(&program.body, &mut out);
    out
}

/// What a name stands for on the other side.
type Other = HashMap<Var, Expr>;

fn block(stmts: &Block, out: &mut Program) -> Block {
    let each = |stmt: &Stmt| match stmt {
        Stmt::ForEach { kind, args, out: names, body } => {
            let mut body = block(body, out);
            let mut kind = *kind;
            if kind == RootKind::Mirror && simple(&body) {
                kind = RootKind::Half;
                let sine = out.exprs.intern(Node::Var(names[1]));
                let other = Other::from([(names[1], out.exprs.unary(Unary::Neg, sine))]);
                body = doubled(&body, other, sine, out);
            }
            Stmt::ForEach { kind, args: args.clone(), out: names.clone(), body }
        }
        Stmt::IfZero { value, tolerance, then, otherwise } => {
            let (then, otherwise) = (block(then, out), block(otherwise, out));
            Stmt::IfZero { value: *value, tolerance: *tolerance, then, otherwise }
        }
        Stmt::Fallback { first, otherwise } => {
            Stmt::Fallback { first: block(first, out), otherwise: block(otherwise, out) }
        }
        Stmt::Rest(body) => Stmt::Rest(block(body, out)),
        other => other.clone(),
    };
    stmts.iter().map(each).collect()
}

/// Whether doubling costs little text: nothing is tried in vain.
fn simple(block: &Block) -> bool {
    block.iter().all(|stmt| !matches!(stmt, Stmt::Fallback { .. }) && blocks_of(stmt).into_iter().all(simple))
}

/// The statements, followed by the same for the other side; an `align` whose angle is the same, opposite or mirrored there is
/// solved once for both. Where the sine vanishes both sides are one.
fn doubled(stmts: &Block, mut other: Other, sine: Expr, out: &mut Program) -> Block {
    let (mut result, mut second) = (Vec::new(), Vec::new());
    for stmt in stmts {
        match stmt {
            Stmt::Note(_) => result.push(stmt.clone()),
            Stmt::Let { var, value } => {
                result.push(stmt.clone());
                let name = out.exprs.intern(Node::Var(*var));
                let there = changed(*value, &other, out);
                if there == out.exprs.unary(Unary::Neg, *value) {
                    other.insert(*var, out.exprs.unary(Unary::Neg, name));
                } else if there != *value {
                    let copy = fresh(*var, &mut other, out);
                    result.push(Stmt::Let { var: copy, value: there });
                }
            }
            Stmt::ForEach { kind: RootKind::Align, args, out: names, body }
                if signs(args, &other, out).is_some() =>
            {
                let signs = signs(args, &other, out).expect("just seen");
                let mut inner = other.clone();
                for (name, negative) in names.iter().zip(signs) {
                    if negative {
                        let here = out.exprs.intern(Node::Var(*name));
                        inner.insert(*name, out.exprs.unary(Unary::Neg, here));
                    }
                }
                let body = doubled(body, inner, sine, out);
                let (args, out) = (args.clone(), names.clone());
                result.push(Stmt::ForEach { kind: RootKind::Align, args, out, body });
            }
            Stmt::Doubt { value, .. } if changed(*value, &other, out) == *value => result.push(stmt.clone()),
            _ => {
                result.push(stmt.clone());
                second.push(copy(stmt, &mut other.clone(), out));
            }
        }
    }
    if !second.is_empty() {
        let otherwise = second;
        result.push(Stmt::IfZero { value: sine, tolerance: VANISHING, then: Vec::new(), otherwise });
    }
    result
}

/// Which of the arguments are negative on the other side, if each is the same up to its sign.
fn signs(args: &[Expr], other: &Other, out: &mut Program) -> Option<Vec<bool>> {
    let sign = |e: &Expr| {
        let there = changed(*e, other, out);
        let negative = there == out.exprs.unary(Unary::Neg, *e);
        (negative || there == *e).then_some(negative)
    };
    args.iter().map(sign).collect()
}

fn changed(e: Expr, other: &Other, out: &mut Program) -> Expr {
    changed_in(&mut out.exprs, e, other, &mut HashMap::new())
}

fn changed_in(exprs: &mut Exprs, e: Expr, other: &Other, memo: &mut HashMap<Expr, Expr>) -> Expr {
    if let Some(done) = memo.get(&e) {
        return *done;
    }
    let there = match exprs.node(e) {
        Node::Var(v) => other.get(&v).copied().unwrap_or(e),
        node => exprs.rebuild(node, |exprs, operand| changed_in(exprs, operand, other, memo)),
    };
    memo.insert(e, there);
    there
}

/// A name for the other side.
fn fresh(var: Var, other: &mut Other, out: &mut Program) -> Var {
    let name = out.names[var.0 as usize].clone();
    let copy = out.bind(&name);
    other.insert(var, out.exprs.intern(Node::Var(copy)));
    copy
}

/// The statement as it is on the other side.
fn copy(stmt: &Stmt, other: &mut Other, out: &mut Program) -> Stmt {
    let mut stmt = map_stmt(stmt, &mut |e| changed(e, other, out));
    let mut nested = |block: &mut Block, other: &Other| {
        let mut other = other.clone();
        *block = block.iter().map(|stmt| copy(stmt, &mut other, out)).collect();
    };
    match &mut stmt {
        Stmt::Let { var, .. } => *var = fresh(*var, other, out),
        Stmt::ForEach { out: names, body, .. } => {
            let mut inner = other.clone();
            for name in names.iter_mut() {
                *name = fresh(*name, &mut inner, out);
            }
            *body = body.iter().map(|stmt| copy(stmt, &mut inner, out)).collect();
        }
        Stmt::IfZero { then, otherwise, .. } | Stmt::Fallback { first: then, otherwise } => {
            nested(then, other);
            nested(otherwise, other);
        }
        _ => {}
    }
    stmt
}
