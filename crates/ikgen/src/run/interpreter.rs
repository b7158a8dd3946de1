//! The reference interpreter: walks the program as it is written, without any preparation.

use super::{MOST_ROOTS, SIX_ROOTS, Verdict, take};
use crate::ir::{Block, Expr, Node, Program, Stmt, Value};
use crate::kernel::chain::{Frame, MAX_JOINTS};

/// Runs `program` and offers each emitted candidate: `[cos, sin]` or `[length, 0]` of each variable.
///
/// `offer` says what it makes of the candidate; returns how many were accepted.
pub fn run(
    program: &Program,
    base_from_tip: &Frame,
    free: &[f64],
    slack: f64,
    offer: &mut dyn FnMut(&[[f64; 2]]) -> Verdict,
) -> usize {
    let mut run = Run {
        program,
        base_from_tip,
        free,
        slack,
        vars: vec![0.0; program.names.len()],
        left: MOST_ROOTS,
        offer,
        accepted: 0,
        doubt: false,
    };
    run.block(&program.body);
    run.accepted
}

struct Run<'a> {
    program: &'a Program,
    base_from_tip: &'a Frame,
    free: &'a [f64],
    slack: f64,
    vars: Vec<f64>,
    left: u32,
    offer: &'a mut dyn FnMut(&[[f64; 2]]) -> Verdict,
    accepted: usize,
    doubt: bool,
}

impl Run<'_> {
    fn block(&mut self, block: &Block) {
        for stmt in block {
            match stmt {
                Stmt::Note(_) => {}
                Stmt::Let { var, value } => self.vars[var.0 as usize] = self.value(*value),
                Stmt::IfZero { value, tolerance, then, otherwise } => {
                    let zero = self.value(*value).abs() < *tolerance;
                    self.block(if zero { then } else { otherwise });
                }
                Stmt::ForEach { kind, args, out, body } if kind.is_joint() => {
                    if !take(&mut self.left, SIX_ROOTS) {
                        continue;
                    }
                    let args: Vec<f64> = args.iter().map(|e| self.value(*e)).collect();
                    let found = kind.solve_jointly(&args, self.slack - self.program.slack);
                    for i in 0..found.count() {
                        for (var, x) in out.iter().zip(found.get(i).into_iter().flatten()) {
                            self.vars[var.0 as usize] = x;
                        }
                        self.block(body);
                    }
                }
                Stmt::ForEach { kind, args, out, body } => {
                    let args: Vec<f64> = args.iter().map(|e| self.value(*e)).collect();
                    let mut tries = kind.solve(&args, self.slack).tries(self.accepted);
                    while let Some(root) = tries.next(self.accepted) {
                        if !take(&mut self.left, 1) {
                            break;
                        }
                        for (var, x) in out.iter().zip(root) {
                            self.vars[var.0 as usize] = x;
                        }
                        self.block(body);
                    }
                }
                Stmt::Fallback { first, otherwise } => {
                    let before = self.accepted;
                    self.block(first);
                    if self.accepted == before {
                        self.block(otherwise);
                    }
                }
                Stmt::Doubt { value, tolerance } => {
                    self.doubt |= self.value(*value).abs() < *tolerance;
                }
                Stmt::Rest(body) => {
                    if self.doubt || self.accepted == 0 {
                        self.block(body);
                    }
                }
                Stmt::Emit(values) | Stmt::Offer { values, .. } => {
                    let mut steps = [[0.0; 2]; MAX_JOINTS];
                    for (step, value) in steps.iter_mut().zip(values) {
                        *step = match *value {
                            Value::Angle(c, s) => [self.value(c), self.value(s)],
                            Value::Length(x) => [self.value(x), 0.0],
                        };
                    }
                    let verdict = (self.offer)(&steps[..values.len()]);
                    self.accepted += usize::from(verdict != Verdict::Wrong);
                    if verdict == Verdict::Last {
                        self.left = 0;
                    }
                }
            }
        }
    }

    fn value(&self, e: Expr) -> f64 {
        let mut memo = std::collections::HashMap::new();
        self.value_with(e, &mut memo)
    }

    fn value_with(&self, e: Expr, memo: &mut std::collections::HashMap<Expr, f64>) -> f64 {
        if let Some(x) = memo.get(&e) {
            return *x;
        }
        let x = match self.program.exprs.node(e) {
            Node::Const(bits) => f64::from_bits(bits),
            Node::Rotation(i, j) => self.base_from_tip.rotation[usize::from(i)][usize::from(j)],
            Node::Position(i) => self.base_from_tip.position[usize::from(i)],
            Node::Free(k) => self.free[usize::from(k)],
            Node::Var(v) => self.vars[v.0 as usize],
            Node::Unary(f, a) => f.apply(self.value_with(a, memo)),
            Node::Binary(f, a, b) => f.apply(self.value_with(a, memo), self.value_with(b, memo)),
        };
        memo.insert(e, x);
        x
    }
}
