//! Passes over solution programs. Each keeps the meaning of a program, and takes and gives a valid one.

mod cost;
mod dead;
mod flip;
mod fold;
mod hoist;
mod prepare;
mod round;
mod share;

pub use dead::dead;
pub use flip::flip;
pub use fold::fold;
pub use hoist::hoist;
pub use prepare::prepare;
pub use round::round;
pub use share::share;

use crate::ir::{Block, Expr, Exprs, Program, Stmt};

/// All passes, in the order that makes each useful to the next.
pub fn optimise(program: &Program) -> Program {
    let program = dead(&hoist(&share(&fold(&flip(program)))));
    debug_assert_eq!(program.validate(), Ok(()));
    program
}

/// The same program with another body and arena.
fn with_body(program: &Program, exprs: Exprs, names: Vec<String>, body: Block) -> Program {
    Program { exprs, names, body, class: program.class.clone(), free: program.free.clone(), ..*program }
}

/// Rebuilds an expression bottom-up with `leaf` deciding what each old node becomes, or `None` to keep its operation.
fn rewrite(
    from: &Exprs,
    to: &mut Exprs,
    e: Expr,
    memo: &mut std::collections::HashMap<Expr, Expr>,
    replace: &dyn Fn(Expr, &mut Exprs) -> Option<Expr>,
) -> Expr {
    if let Some(done) = memo.get(&e) {
        return *done;
    }
    let new = match replace(e, to) {
        Some(new) => new,
        None => {
            let node = from.node(e);
            to.rebuild(node, |to, operand| rewrite(from, to, operand, memo, replace))
        }
    };
    memo.insert(e, new);
    new
}

/// Whether a block holds anything but notes.
fn does_nothing(block: &Block) -> bool {
    block.iter().all(|s| matches!(s, Stmt::Note(_)))
}
