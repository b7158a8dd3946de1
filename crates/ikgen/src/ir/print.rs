//! The text form of a program.

use std::fmt::Write as _;

use super::{Binary, Block, Expr, Node, Program, Stmt, Unary, Value, Var};

pub(super) fn program(p: &Program) -> String {
    let mut out = String::new();
    let free: Vec<String> = p.free.iter().map(usize::to_string).collect();
    let _ = writeln!(out, "ikgen 1");
    let _ = writeln!(out, "class \"{}\"", p.class);
    if p.goal != crate::GoalType::default() {
        let _ = writeln!(out, "goal {}", p.goal.name());
    }
    let _ = writeln!(out, "variables {}", p.variables);
    let _ = writeln!(out, "free [{}]", free.join(" "));
    let _ = writeln!(out, "snap {:?}", p.snap);
    let _ = writeln!(out, "slack {:?}", p.slack);
    let _ = writeln!(out, "{{");
    block(p, &p.body, 1, &mut out);
    let _ = writeln!(out, "}}");
    out
}

fn block(p: &Program, stmts: &Block, depth: usize, out: &mut String) {
    let pad = "  ".repeat(depth);
    for stmt in stmts {
        match stmt {
            Stmt::Note(text) => {
                let _ = writeln!(out, "{pad}# {text}");
            }
            Stmt::Let { var, value } => {
                let _ = writeln!(out, "{pad}let {} = {}", name(p, *var), expr(p, *value));
            }
            Stmt::ForEach { kind, args, out: names, body } => {
                let args: Vec<String> = args.iter().map(|e| expr(p, *e)).collect();
                let names: Vec<&str> = names.iter().map(|v| name(p, *v)).collect();
                let _ = writeln!(out, "{pad}{}({}) -> {} {{", kind.word(), args.join(", "), names.join(" "));
                block(p, body, depth + 1, out);
                let _ = writeln!(out, "{pad}}}");
            }
            Stmt::IfZero { value, tolerance, then, otherwise } => {
                let _ = writeln!(out, "{pad}zero({}, {tolerance:?}) {{", expr(p, *value));
                block(p, then, depth + 1, out);
                let _ = writeln!(out, "{pad}}} else {{");
                block(p, otherwise, depth + 1, out);
                let _ = writeln!(out, "{pad}}}");
            }
            Stmt::Fallback { first, otherwise } => {
                let _ = writeln!(out, "{pad}first {{");
                block(p, first, depth + 1, out);
                let _ = writeln!(out, "{pad}}} else {{");
                block(p, otherwise, depth + 1, out);
                let _ = writeln!(out, "{pad}}}");
            }
            Stmt::Doubt { value, tolerance } => {
                let _ = writeln!(out, "{pad}doubt({}, {tolerance:?})", expr(p, *value));
            }
            Stmt::Rest(body) => {
                let _ = writeln!(out, "{pad}rest {{");
                block(p, body, depth + 1, out);
                let _ = writeln!(out, "{pad}}}");
            }
            Stmt::Emit(values) | Stmt::Offer { values, .. } => {
                let values: Vec<String> = values
                    .iter()
                    .map(|v| match *v {
                        Value::Angle(c, s) => format!("angle({}, {})", expr(p, c), expr(p, s)),
                        Value::Length(x) => format!("length({})", expr(p, x)),
                    })
                    .collect();
                let _ = writeln!(out, "{pad}emit {}", values.join(" "));
            }
        }
    }
}

fn name(p: &Program, var: Var) -> &str {
    &p.names[var.0 as usize]
}

pub(super) fn expr(p: &Program, e: Expr) -> String {
    let mut out = String::new();
    write_expr(p, e, 0, &mut out);
    out
}

/// Writes `e`, in parentheses if it binds looser than `level` (0 sum, 1 product, 2 factor).
fn write_expr(p: &Program, e: Expr, level: u8, out: &mut String) {
    let call = |f: &str, args: &[Expr], out: &mut String| {
        let _ = write!(out, "{f}(");
        for (i, a) in args.iter().enumerate() {
            if i > 0 {
                out.push_str(", ");
            }
            write_expr(p, *a, 0, out);
        }
        out.push(')');
    };
    match p.exprs.node(e) {
        Node::Const(bits) => {
            let _ = write!(out, "{:?}", f64::from_bits(bits));
        }
        Node::Rotation(i, j) => {
            let _ = write!(out, "r{i}{j}");
        }
        Node::Position(i) => {
            let _ = write!(out, "p{}", ["x", "y", "z"][usize::from(i)]);
        }
        Node::Free(k) => {
            let _ = write!(out, "free{k}");
        }
        Node::Var(v) => out.push_str(name(p, v)),
        Node::Unary(Unary::Neg, a) => {
            let constant = matches!(p.exprs.node(a), Node::Const(_));
            out.push('-');
            if constant {
                call("", &[a], out);
            } else {
                write_expr(p, a, 2, out);
            }
        }
        Node::Unary(Unary::Opposite, a) => call("opposite", &[a], out),
        Node::Unary(Unary::Mirrored, a) => call("mirrored", &[a], out),
        Node::Unary(Unary::Sqrt, a) => call("sqrt", &[a], out),
        Node::Unary(Unary::Sin, a) => call("sin", &[a], out),
        Node::Unary(Unary::Cos, a) => call("cos", &[a], out),
        Node::Binary(Binary::Min, a, b) => call("min", &[a, b], out),
        Node::Binary(Binary::Max, a, b) => call("max", &[a, b], out),
        Node::Binary(Binary::AngleOf, a, b) => call("angle_of", &[a, b], out),
        Node::Binary(f, a, b) => {
            let (word, own, right) = match f {
                Binary::Add => (" + ", 0, 1),
                Binary::Sub => (" - ", 0, 1),
                Binary::Mul => (" * ", 1, 2),
                _ => (" / ", 1, 2),
            };
            if own < level {
                out.push('(');
            }
            write_expr(p, a, own, out);
            out.push_str(word);
            write_expr(p, b, right, out);
            if own < level {
                out.push(')');
            }
        }
    }
}
