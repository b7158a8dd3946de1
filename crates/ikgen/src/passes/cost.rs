//! What a program costs to run, told before the passes have made it cheap.

use crate::ir::{Binary, Block, Expr, Node, Program, RootKind, Stmt, Unary, exprs_of};

/// Operations that a regular pose runs when all roots exist, additions being the unit. An operation counts once wherever it is
/// used, as often as the loops run that bind its names: that is where sharing and hoisting will leave it.
pub(super) fn cost(program: &Program) -> usize {
    let nodes = program.exprs.len();
    let mut count =
        Count { program, runs_of_name: vec![1; program.names.len()], runs: vec![0; nodes], total: 0 };
    count.block(&program.body, 1);
    count.total
}

struct Count<'p> {
    program: &'p Program,
    /// How often each name is bound.
    runs_of_name: Vec<usize>,
    /// How often each expression is evaluated; zero where it has not been counted.
    runs: Vec<usize>,
    total: usize,
}

impl Count<'_> {
    /// A block that is run so often. Of two branches the regular one is run.
    fn block(&mut self, block: &Block, times: usize) {
        for stmt in block {
            exprs_of(stmt, |e| {
                self.expr(e);
            });
            match stmt {
                Stmt::Let { var, value } => self.runs_of_name[var.0 as usize] = self.expr(*value),
                Stmt::ForEach { kind, out, body, .. } => {
                    let times = times * typical_roots(*kind);
                    for var in out {
                        self.runs_of_name[var.0 as usize] = times;
                    }
                    self.block(body, times);
                }
                Stmt::IfZero { otherwise: taken, .. } | Stmt::Fallback { first: taken, .. } => {
                    self.block(taken, times);
                }
                _ => {}
            }
        }
    }

    /// Counts an expression; says how often it is evaluated.
    fn expr(&mut self, e: Expr) -> usize {
        let known = self.runs[e.0 as usize];
        if known > 0 {
            return known;
        }
        let node = self.program.exprs.node(e);
        let runs = match node {
            Node::Var(v) => self.runs_of_name[v.0 as usize],
            node => node.operands().map(|x| self.expr(x)).max().unwrap_or(1),
        };
        self.runs[e.0 as usize] = runs;
        self.total += runs * operation(node);
        runs
    }
}

fn typical_roots(kind: RootKind) -> usize {
    match kind {
        RootKind::Align | RootKind::Half => 1,
        RootKind::Conic => 3,
        RootKind::Octic => 4,
        _ => 2,
    }
}

fn operation(node: Node) -> usize {
    match node {
        Node::Binary(Binary::AngleOf, ..) | Node::Unary(Unary::Sin | Unary::Cos, _) => 40,
        Node::Binary(Binary::Div, ..) | Node::Unary(Unary::Sqrt, _) => 10,
        node => usize::from(!node.is_leaf()),
    }
}
