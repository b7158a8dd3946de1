//! Constant folding and algebraic simplification; names for leaves are replaced by the leaves.

use std::collections::HashMap;

use super::{rewrite, with_body};
use crate::ir::{Block, Expr, Exprs, Node, Program, Stmt, Var, map_stmt};

/// Simplifies every expression, and branches whose test is a number.
pub fn fold(program: &Program) -> Program {
    let mut fold =
        Fold { from: &program.exprs, to: Exprs::default(), memo: HashMap::new(), leaves: HashMap::new() };
    let body = fold.block(&program.body);
    with_body(program, fold.to, program.names.clone(), body)
}

struct Fold<'p> {
    from: &'p Exprs,
    to: Exprs,
    memo: HashMap<Expr, Expr>,
    /// Names whose value turned out to be a leaf.
    leaves: HashMap<Var, Expr>,
}

impl Fold<'_> {
    fn block(&mut self, block: &Block) -> Block {
        let mut out = Vec::new();
        for stmt in block {
            let stmt = map_stmt(stmt, &mut |e| self.expr(e));
            match stmt {
                Stmt::Let { var, value } if self.to.node(value).is_leaf() => {
                    self.leaves.insert(var, value);
                    // Expressions that name it may have been rebuilt in an inner scope only; none has been yet.
                    self.memo.clear();
                }
                Stmt::ForEach { kind, args, out: names, body } => {
                    let body = self.block(&body);
                    out.push(Stmt::ForEach { kind, args, out: names, body });
                }
                Stmt::IfZero { value, tolerance, then, otherwise } => match self.to.as_constant(value) {
                    Some(x) => {
                        let taken = if x.abs() < tolerance { then } else { otherwise };
                        out.extend(self.block(&taken));
                    }
                    None => {
                        let (then, otherwise) = (self.block(&then), self.block(&otherwise));
                        out.push(Stmt::IfZero { value, tolerance, then, otherwise });
                    }
                },
                Stmt::Fallback { first, otherwise } => {
                    let (first, otherwise) = (self.block(&first), self.block(&otherwise));
                    out.push(Stmt::Fallback { first, otherwise });
                }
                Stmt::Rest(body) => {
                    let body = self.block(&body);
                    out.push(Stmt::Rest(body));
                }
                other => out.push(other),
            }
        }
        out
    }

    fn expr(&mut self, e: Expr) -> Expr {
        let (from, leaves) = (self.from, &self.leaves);
        let replace = |e: Expr, _: &mut Exprs| match from.node(e) {
            Node::Var(v) => leaves.get(&v).copied(),
            _ => None,
        };
        rewrite(from, &mut self.to, e, &mut self.memo, &replace)
    }
}
