//! Dead code: names that nothing uses, loops and branches that emit nothing. Names are numbered anew.

use std::collections::BTreeSet;

use super::{does_nothing, rewrite, with_body};
use crate::ir::{Block, Expr, Exprs, Node, Program, Stmt, Var, exprs_of, map_stmt};

/// Removes what no solution depends on, and forgets expressions and names that are left over.
pub fn dead(program: &Program) -> Program {
    let mut live = BTreeSet::new();
    let body = block(program, &program.body, &mut live);
    let empty = with_body(program, Exprs::default(), Vec::new(), Vec::new());
    let mut compact = Compact { from: program, out: empty, vars: std::collections::HashMap::new() };
    let body = compact.block(&body);
    compact.out.body = body;
    compact.out
}

/// The block without dead statements, walked backwards: `live` holds the names used by what follows.
fn block(program: &Program, stmts: &Block, live: &mut BTreeSet<Var>) -> Block {
    let mut kept = Vec::new();
    for stmt in stmts.iter().rev() {
        let kept_stmt = match stmt {
            Stmt::Let { var, .. } if !live.contains(var) => continue,
            Stmt::ForEach { kind, args, out, body } => {
                let body = block(program, body, live);
                if does_nothing(&body) {
                    continue;
                }
                Stmt::ForEach { kind: *kind, args: args.clone(), out: out.clone(), body }
            }
            Stmt::IfZero { value, tolerance, then, otherwise } => {
                let (then, otherwise) = (block(program, then, live), block(program, otherwise, live));
                if does_nothing(&then) && does_nothing(&otherwise) {
                    continue;
                }
                Stmt::IfZero { value: *value, tolerance: *tolerance, then, otherwise }
            }
            Stmt::Fallback { first, otherwise } => {
                let (first, otherwise) = (block(program, first, live), block(program, otherwise, live));
                if does_nothing(&first) && does_nothing(&otherwise) {
                    continue;
                }
                Stmt::Fallback { first, otherwise }
            }
            Stmt::Rest(body) => {
                let body = block(program, body, live);
                if does_nothing(&body) {
                    continue;
                }
                Stmt::Rest(body)
            }
            other => other.clone(),
        };
        exprs_of(&kept_stmt, |e| names_in(program, e, live));
        kept.push(kept_stmt);
    }
    kept.reverse();
    kept
}

fn names_in(program: &Program, e: Expr, live: &mut BTreeSet<Var>) {
    let mut pending = vec![e];
    let mut seen = BTreeSet::new();
    while let Some(e) = pending.pop() {
        if seen.insert(e) {
            match program.exprs.node(e) {
                Node::Var(v) => {
                    live.insert(v);
                }
                node => pending.extend(node.operands()),
            }
        }
    }
}

struct Compact<'p> {
    from: &'p Program,
    out: Program,
    vars: std::collections::HashMap<Var, Var>,
}

impl Compact<'_> {
    fn block(&mut self, stmts: &Block) -> Block {
        let mut result = Vec::new();
        for stmt in stmts {
            let mut stmt = map_stmt(stmt, &mut |e| self.expr(e));
            match &mut stmt {
                Stmt::Let { var, .. } => *var = self.rename(*var),
                Stmt::ForEach { out, body, .. } => {
                    for var in out.iter_mut() {
                        *var = self.rename(*var);
                    }
                    *body = self.block(body);
                }
                Stmt::Rest(body) => *body = self.block(body),
                Stmt::IfZero { then, otherwise, .. } | Stmt::Fallback { first: then, otherwise } => {
                    *then = self.block(then);
                    *otherwise = self.block(otherwise);
                }
                _ => {}
            }
            result.push(stmt);
        }
        result
    }

    fn rename(&mut self, var: Var) -> Var {
        let name = &self.from.names[var.0 as usize];
        // Temporaries are numbered in the order in which they now come.
        let temporary = name.starts_with(['t', 'h']) && name[1..].bytes().all(|b| b.is_ascii_digit());
        let new = if temporary {
            let number = self.vars.len();
            self.out.bind(&format!("t{number}"))
        } else {
            self.out.bind(name)
        };
        self.vars.insert(var, new);
        new
    }

    fn expr(&mut self, e: Expr) -> Expr {
        let (from, vars) = (&self.from.exprs, &self.vars);
        let replace = |x: Expr, to: &mut Exprs| match from.node(x) {
            Node::Var(v) => Some(to.intern(Node::Var(vars[&v]))),
            _ => None,
        };
        rewrite(from, &mut self.out.exprs, e, &mut std::collections::HashMap::new(), &replace)
    }
}
