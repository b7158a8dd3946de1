//! Loop-invariant code: whatever a loop does not change is computed before it. Branches are not left, since most are
//! rarely taken.

use std::collections::HashMap;

use super::{rewrite, with_body};
use crate::ir::{Block, Expr, Exprs, Node, Program, Stmt, Var, exprs_of, map_stmt};

/// Moves names and parts of expressions out of the loops they do not depend on.
pub fn hoist(program: &Program) -> Program {
    let out = with_body(program, program.exprs.clone(), program.names.clone(), Vec::new());
    let mut h =
        Hoist { out, from: &program.exprs, levels: vec![Level::default()], home: HashMap::new(), number: 0 };
    h.out.body = h.block(&program.body);
    h.out
}

#[derive(Default)]
struct Level {
    /// Names for expressions moved to this level.
    known: HashMap<Expr, Expr>,
    /// Their statements, not yet written.
    pending: Vec<Stmt>,
    /// Nothing moves from here to outer levels.
    barrier: bool,
}

struct Hoist<'p> {
    out: Program,
    from: &'p Exprs,
    levels: Vec<Level>,
    /// Level that binds each name.
    home: HashMap<Var, usize>,
    number: usize,
}

impl Hoist<'_> {
    fn block(&mut self, block: &Block) -> Block {
        let level = self.levels.len() - 1;
        let mut result = Vec::new();
        for stmt in block {
            if let Stmt::Let { var, value } = stmt {
                let target = self.level_of(*value);
                self.home.insert(*var, target);
                let value = self.renamed(*value, target);
                self.levels[target].pending.push(Stmt::Let { var: *var, value });
                result.append(&mut self.levels[level].pending);
                continue;
            }
            let mut roots = Vec::new();
            exprs_of(stmt, |e| roots.push(e));
            let mut stmt = map_stmt(stmt, &mut |e| self.renamed(e, level));
            match &mut stmt {
                Stmt::ForEach { out, body, .. } => {
                    for var in out.iter() {
                        self.home.insert(*var, level + 1);
                    }
                    *body = self.nested(body, false);
                }
                Stmt::Fallback { first, otherwise } => {
                    *first = self.nested(first, false);
                    *otherwise = self.nested(otherwise, true);
                }
                Stmt::Rest(body) => *body = self.nested(body, true),
                Stmt::IfZero { then, otherwise, .. } => {
                    *then = self.nested(then, true);
                    *otherwise = self.nested(otherwise, true);
                }
                _ => {}
            }
            result.append(&mut self.levels[level].pending);
            result.push(stmt);
        }
        result
    }

    fn nested(&mut self, block: &Block, barrier: bool) -> Block {
        self.levels.push(Level { barrier, ..Level::default() });
        let block = self.block(block);
        self.levels.pop();
        block
    }

    /// The outermost level, down to the nearest barrier, where all names of `e` are bound.
    fn level_of(&self, e: Expr) -> usize {
        let floor = self.levels.iter().rposition(|l| l.barrier).unwrap_or(0);
        let mut level = floor;
        let mut pending = vec![e];
        let mut seen = std::collections::BTreeSet::new();
        while let Some(e) = pending.pop() {
            if !seen.insert(e) {
                continue;
            }
            match self.from.node(e) {
                Node::Var(v) => level = level.max(self.home[&v]),
                node => pending.extend(node.operands()),
            }
        }
        level
    }

    /// `e` for use at `level`, with its largest parts that belong further out named there.
    fn renamed(&mut self, e: Expr, level: usize) -> Expr {
        let mut parts = Vec::new();
        self.parts(e, level, &mut parts);
        let mut named = HashMap::new();
        for (part, target) in parts {
            let name = match self.levels[target].known.get(&part) {
                Some(name) => *name,
                None => {
                    // Its own parts may belong further out still.
                    let value = self.renamed(part, target);
                    self.number += 1;
                    let var = self.out.bind(&format!("h{}", self.number));
                    let name = self.out.exprs.intern(Node::Var(var));
                    self.levels[target].pending.push(Stmt::Let { var, value });
                    self.levels[target].known.insert(part, name);
                    name
                }
            };
            named.insert(part, name);
        }
        rewrite(self.from, &mut self.out.exprs, e, &mut HashMap::new(), &|x, _| named.get(&x).copied())
    }

    /// The largest operations in `e` that belong to a level further out than `level`.
    fn parts(&self, e: Expr, level: usize, out: &mut Vec<(Expr, usize)>) {
        let node = self.from.node(e);
        if node.is_leaf() {
            return;
        }
        let own = self.level_of(e);
        if own < level {
            out.push((e, own));
        } else {
            for operand in node.operands() {
                self.parts(operand, level, out);
            }
        }
    }
}
