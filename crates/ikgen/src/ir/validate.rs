//! What every program must satisfy, whoever wrote it.

use super::{Block, Expr, Node, Program, Stmt, exprs_of};

/// The first rule that a program breaks.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Invalid {
    /// A name is used outside of its scope.
    #[error("{0} is used where it is not bound")]
    Unbound(String),
    /// A name is bound twice.
    #[error("{0} is bound twice")]
    Rebound(String),
    /// An equation has a wrong number of arguments or results.
    #[error("{0} has a wrong number of arguments or names")]
    Arity(&'static str),
    /// An emitted solution has a wrong number of values.
    #[error("a solution has {found} values, the chain {expected} variables")]
    Emit {
        /// Values emitted.
        found: usize,
        /// Variables of the chain.
        expected: usize,
    },
    /// A free value that the program does not have.
    #[error("free{0} is not a free value of this program")]
    Free(u8),
    /// A `rest` inside of another statement.
    #[error("a rest stands in another statement")]
    NestedRest,
    /// A header or branch number out of range.
    #[error("{0} is out of range")]
    Range(&'static str),
}

pub(super) fn program(p: &Program) -> Result<(), Invalid> {
    let in_order = p.free.windows(2).all(|w| w[0] < w[1]) && p.free.iter().all(|v| *v < p.variables);
    for (ok, what) in [
        (
            p.chain_variables() > 0 && p.variables <= crate::kernel::chain::MAX_JOINTS,
            "the number of variables",
        ),
        (in_order && p.free.len() < 10, "the list of free variables"),
        (p.snap.is_finite() && p.snap >= 0.0, "snap"),
        (p.slack.is_finite() && p.slack >= 0.0, "slack"),
    ] {
        if !ok {
            return Err(Invalid::Range(what));
        }
    }
    let mut v = Validator {
        program: p,
        bound: vec![false; p.names.len()],
        seen: vec![false; p.names.len()],
        depth: 0,
    };
    v.block(&p.body)
}

struct Validator<'p> {
    program: &'p Program,
    /// In scope now.
    bound: Vec<bool>,
    /// Ever bound.
    seen: Vec<bool>,
    /// Blocks around the statement.
    depth: usize,
}

impl Validator<'_> {
    fn block(&mut self, block: &Block) -> Result<(), Invalid> {
        let outer = self.bound.clone();
        self.depth += 1;
        for stmt in block {
            let mut used = Vec::new();
            exprs_of(stmt, |e| used.push(e));
            self.exprs(used)?;
            match stmt {
                Stmt::Let { var, .. } => self.bind(var.0)?,
                Stmt::ForEach { kind, args, out, body } => {
                    if args.len() != kind.arguments() || out.len() != kind.outputs() {
                        return Err(Invalid::Arity(kind.word()));
                    }
                    let before = self.bound.clone();
                    for var in out {
                        self.bind(var.0)?;
                    }
                    self.block(body)?;
                    self.bound = before;
                }
                Stmt::IfZero { tolerance, then, otherwise, .. } => {
                    if !(tolerance.is_finite() && *tolerance >= 0.0) {
                        return Err(Invalid::Range("the tolerance of a branch"));
                    }
                    self.block(then)?;
                    self.block(otherwise)?;
                }
                Stmt::Fallback { first, otherwise } => {
                    self.block(first)?;
                    self.block(otherwise)?;
                }
                Stmt::Doubt { tolerance, .. } => {
                    if !(tolerance.is_finite() && *tolerance >= 0.0) {
                        return Err(Invalid::Range("the tolerance of a doubt"));
                    }
                }
                Stmt::Rest(body) => {
                    if self.depth > 1 {
                        return Err(Invalid::NestedRest);
                    }
                    self.block(body)?;
                }
                Stmt::Emit(values) | Stmt::Offer { values, .. } => {
                    let expected = self.program.variables;
                    if values.len() != expected {
                        return Err(Invalid::Emit { found: values.len(), expected });
                    }
                }
                Stmt::Note(_) => {}
            }
        }
        self.bound = outer;
        self.depth -= 1;
        Ok(())
    }

    fn bind(&mut self, var: u32) -> Result<(), Invalid> {
        let i = var as usize;
        if std::mem::replace(&mut self.seen[i], true) {
            return Err(Invalid::Rebound(self.program.names[i].clone()));
        }
        self.bound[i] = true;
        Ok(())
    }

    fn exprs(&self, mut pending: Vec<Expr>) -> Result<(), Invalid> {
        let mut seen = std::collections::BTreeSet::new();
        while let Some(e) = pending.pop() {
            if !seen.insert(e) {
                continue;
            }
            let node = self.program.exprs.node(e);
            match node {
                Node::Var(v) if !self.bound[v.0 as usize] => {
                    return Err(Invalid::Unbound(self.program.names[v.0 as usize].clone()));
                }
                Node::Free(k) if usize::from(k) >= self.program.free.len() => return Err(Invalid::Free(k)),
                Node::Const(bits) if !f64::from_bits(bits).is_finite() => {
                    return Err(Invalid::Range("a constant"));
                }
                _ => pending.extend(node.operands()),
            }
        }
        Ok(())
    }
}
