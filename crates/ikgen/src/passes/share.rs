//! Common subexpressions: what is used more than once gets a name, in the innermost block around its uses.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use super::{rewrite, with_body};
use crate::ir::{Block, Expr, Exprs, Node, Program, Stmt, blocks_of, exprs_of, map_stmt};

/// Names every operation that occurs in more than one place.
pub fn share(program: &Program) -> Program {
    let shared = shared_nodes(program);
    let mut out = with_body(program, program.exprs.clone(), program.names.clone(), Vec::new());
    let mut number = 0;
    let body = place(program, &mut out, &program.body, &shared, &mut number, &HashMap::new());
    out.body = body;
    out
}

/// Operations with more than one parent: statement or expression.
fn shared_nodes(program: &Program) -> BTreeSet<Expr> {
    let mut parents: BTreeMap<Expr, usize> = BTreeMap::new();
    let mut pending = Vec::new();
    fn roots(block: &Block, pending: &mut Vec<Expr>) {
        for stmt in block {
            exprs_of(stmt, |e| pending.push(e));
            for inner in blocks_of(stmt) {
                roots(inner, pending);
            }
        }
    }
    roots(&program.body, &mut pending);
    while let Some(e) = pending.pop() {
        let count = parents.entry(e).or_insert(0);
        *count += 1;
        if *count == 1 {
            pending.extend(program.exprs.node(e).operands());
        }
    }
    parents
        .into_iter()
        .filter(|(e, count)| *count > 1 && !program.exprs.node(*e).is_leaf())
        .map(|(e, _)| e)
        .collect()
}

/// Shared nodes used by a statement or inside of it.
fn uses(program: &Program, stmt: &Stmt, shared: &BTreeSet<Expr>, direct_only: bool) -> BTreeSet<Expr> {
    let mut pending = Vec::new();
    let mut blocks = vec![];
    exprs_of(stmt, |e| pending.push(e));
    if !direct_only {
        blocks.extend(blocks_of(stmt));
    }
    while let Some(block) = blocks.pop() {
        for inner in block {
            exprs_of(inner, |e| pending.push(e));
            blocks.extend(blocks_of(inner));
        }
    }
    let mut seen = BTreeSet::new();
    while let Some(e) = pending.pop() {
        if seen.insert(e) {
            pending.extend(program.exprs.node(e).operands());
        }
    }
    seen.intersection(shared).copied().collect()
}

fn place(
    program: &Program,
    out: &mut Program,
    block: &Block,
    wanted: &BTreeSet<Expr>,
    number: &mut usize,
    outer: &HashMap<Expr, Expr>,
) -> Block {
    let used: Vec<BTreeSet<Expr>> = block.iter().map(|s| uses(program, s, wanted, false)).collect();
    // A node stays for an inner block only if that block alone uses it.
    let mut here: BTreeMap<usize, Vec<Expr>> = BTreeMap::new();
    let mut inner: Vec<BTreeSet<Expr>> = vec![BTreeSet::new(); block.len()];
    for e in wanted {
        let users: Vec<usize> = (0..block.len()).filter(|i| used[*i].contains(e)).collect();
        match users[..] {
            [] => {}
            [only] => {
                let direct = uses(program, &block[only], wanted, true).contains(e);
                let nested: Vec<_> = blocks_of(&block[only])
                    .into_iter()
                    .filter(|b| block_uses(program, b, *e, wanted))
                    .collect();
                if !direct && nested.len() == 1 {
                    inner[only].insert(*e);
                } else {
                    here.entry(only).or_default().push(*e);
                }
            }
            [first, ..] => here.entry(first).or_default().push(*e),
        }
    }
    let mut named = outer.clone();
    let mut result = Vec::new();
    for (i, stmt) in block.iter().enumerate() {
        // Older nodes first: an operand is named before what uses it.
        for e in here.remove(&i).unwrap_or_default() {
            let value = renamed(program, &mut out.exprs, e, &named, true);
            *number += 1;
            let var = out.bind(&format!("t{number}"));
            named.insert(e, out.exprs.intern(Node::Var(var)));
            result.push(Stmt::Let { var, value });
        }
        let mut stmt = map_stmt(stmt, &mut |e| renamed(program, &mut out.exprs, e, &named, false));
        match &mut stmt {
            Stmt::ForEach { body, .. } => *body = place(program, out, body, &inner[i], number, &named),
            Stmt::IfZero { then, otherwise, .. } | Stmt::Fallback { first: then, otherwise } => {
                *then = place(program, out, then, &inner[i], number, &named);
                *otherwise = place(program, out, otherwise, &inner[i], number, &named);
            }
            _ => {}
        }
        result.push(stmt);
    }
    result
}

fn block_uses(program: &Program, block: &Block, e: Expr, wanted: &BTreeSet<Expr>) -> bool {
    block.iter().any(|s| uses(program, s, wanted, false).contains(&e))
}

/// `e` with named nodes replaced by their names; `own` keeps the operation of `e` itself.
fn renamed(program: &Program, to: &mut Exprs, e: Expr, named: &HashMap<Expr, Expr>, own: bool) -> Expr {
    let replace = |x: Expr, _: &mut Exprs| if own && x == e { None } else { named.get(&x).copied() };
    rewrite(&program.exprs, to, e, &mut HashMap::new(), &replace)
}
