//! Common subexpressions: what is used more than once gets a name, in the innermost block around its uses.

use std::collections::HashMap;

use super::{rewrite, with_body};
use crate::ir::{Block, Expr, Exprs, Node, Program, Stmt, Var, blocks_of, exprs_of, map_stmt};

/// Names every operation that occurs in more than one place.
pub fn share(program: &Program) -> Program {
    let mut homes = Homes { program, blocks: Vec::new(), uses: vec![None; program.exprs.len()] };
    homes.direct(&program.body, None);
    homes.indirect();
    let mut named = Named {
        from: &program.exprs,
        out: with_body(program, program.exprs.clone(), program.names.clone(), Vec::new()),
        here: homes.of_shared(),
        blocks: 0,
        names: HashMap::new(),
        memo: HashMap::new(),
        number: 0,
    };
    let body = named.block(&program.body);
    named.out.body = body;
    named.out
}

/// A statement: the number of its block in the order in which blocks begin, and its place in the block.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
struct Place {
    block: usize,
    stmt: usize,
}

/// Where an expression is used.
#[derive(Clone, Copy)]
struct Use {
    /// The first statement, in the innermost block around all uses, that has one.
    home: Place,
    /// Statements and expressions that name it.
    parents: usize,
}

struct Homes<'p> {
    program: &'p Program,
    /// The statement that each block belongs to, and how deep it is nested.
    blocks: Vec<(Option<Place>, usize)>,
    uses: Vec<Option<Use>>,
}

impl Homes<'_> {
    /// Numbers the blocks; notes what their statements use themselves.
    fn direct(&mut self, block: &Block, owner: Option<Place>) {
        let number = self.blocks.len();
        self.blocks.push((owner, owner.map_or(0, |o| self.blocks[o.block].1 + 1)));
        for (i, stmt) in block.iter().enumerate() {
            let place = Place { block: number, stmt: i };
            exprs_of(stmt, |e| self.used(e, place));
            for inner in blocks_of(stmt) {
                self.direct(inner, Some(place));
            }
        }
    }

    /// Operands are used where the expressions are that they are part of; these are younger.
    fn indirect(&mut self) {
        for i in (0..self.uses.len()).rev() {
            if let Some(Use { home, .. }) = self.uses[i] {
                for operand in self.program.exprs.node(Expr(i as u32)).operands() {
                    self.used(operand, home);
                }
            }
        }
    }

    fn used(&mut self, e: Expr, place: Place) {
        let found = match self.uses[e.0 as usize] {
            None => Use { home: place, parents: 1 },
            Some(Use { home, parents }) => Use { home: self.around(home, place), parents: parents + 1 },
        };
        self.uses[e.0 as usize] = Some(found);
    }

    /// The earlier of two statements, each taken for the one around it until both are of the same block.
    fn around(&self, mut a: Place, mut b: Place) -> Place {
        while a.block != b.block {
            let deeper = if self.blocks[a.block].1 >= self.blocks[b.block].1 { &mut a } else { &mut b };
            *deeper = self.blocks[deeper.block].0.expect("the outermost block is around all");
        }
        if a.stmt < b.stmt { a } else { b }
    }

    /// The expressions that get a name before each statement, older ones first.
    fn of_shared(self) -> HashMap<Place, Vec<Expr>> {
        let mut here: HashMap<Place, Vec<Expr>> = HashMap::new();
        for (i, found) in self.uses.iter().enumerate() {
            let e = Expr(i as u32);
            if let Some(Use { home, parents: 2.. }) = found
                && !self.program.exprs.node(e).is_leaf()
            {
                here.entry(*home).or_default().push(e);
            }
        }
        here
    }
}

/// The program written anew with names.
struct Named<'p> {
    from: &'p Exprs,
    out: Program,
    here: HashMap<Place, Vec<Expr>>,
    /// Blocks begun so far.
    blocks: usize,
    names: HashMap<Expr, Expr>,
    memo: HashMap<Expr, Expr>,
    number: usize,
}

impl Named<'_> {
    fn block(&mut self, block: &Block) -> Block {
        let number = self.blocks;
        self.blocks += 1;
        let mut result = Vec::new();
        for (i, stmt) in block.iter().enumerate() {
            for e in self.here.remove(&Place { block: number, stmt: i }).unwrap_or_default() {
                let let_ = self.named(e);
                result.push(let_);
            }
            let mut stmt = map_stmt(stmt, &mut |e| self.renamed(e));
            match &mut stmt {
                Stmt::ForEach { body, .. } | Stmt::Rest(body) => *body = self.block(body),
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

    /// The statement that gives an expression its name.
    fn named(&mut self, e: Expr) -> Stmt {
        let operands: HashMap<Expr, Expr> =
            self.from.node(e).operands().map(|x| (x, self.renamed(x))).collect();
        let value = self.out.exprs.rebuild(self.from.node(e), |_, x| operands[&x]);
        self.number += 1;
        let var: Var = self.out.bind(&format!("t{}", self.number));
        let name = self.out.exprs.intern(Node::Var(var));
        self.names.insert(e, name);
        Stmt::Let { var, value }
    }

    /// `e` with the names of what has one. A name is given before its first use, so what is known of an expression stays true.
    fn renamed(&mut self, e: Expr) -> Expr {
        let names = &self.names;
        let replace = |x: Expr, _: &mut Exprs| names.get(&x).copied();
        rewrite(self.from, &mut self.out.exprs, e, &mut self.memo, &replace)
    }
}
