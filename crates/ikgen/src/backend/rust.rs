//! Rust: one file without dependencies or allocation, for `core` alone or with the square root of `std`.

use std::fmt::Write as _;

use super::{capacity, measured, prune};
use crate::GoalType;
use crate::ir::{Block, Expr, Program, RootKind, Stmt, Value};
use crate::kernel::chain::Frame;
use crate::kernel::six::Order;
use crate::kernel::{CORE_SQRT, PLATFORM_SQRT, SOURCES};
use crate::run::TrueChain;

/// Choices of the Rust back end.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct RustOptions {
    /// Use the square root of `std` instead of the file's own: faster, but then the file needs `std`.
    pub std: bool,
    /// Let `solve_on` ask the general solver of six joints besides, which finds all branches of a calibrated arm; the file is larger by
    /// some 50 KB. Without it branches are tracked from those of the described arm, and some near its folds are lost. Nothing changes for
    /// arms without six turning joints whose values are not given.
    pub calibrated: bool,
}

/// The source file. It may be a module of any crate, or a crate of its own.
pub fn rust_source(program: &Program, chain: &TrueChain, options: &RustOptions) -> String {
    let program = &crate::passes::prepare(program, chain);
    let mut code = String::new();
    constants(program, chain, &mut code);
    code += &api(program);
    solve(program, &measured(options.calibrated, program, chain), &mut code);
    let mut out = String::new();
    header(program, &mut out);
    out += &prune::imports(USES, &code);
    out.push('\n');
    out += &code;
    kernel(options, &mut out);
    out += &tests(program);
    tabbed(&out)
}

/// Indented by tabs: in nested loops blanks would be a sixth of the file.
fn tabbed(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for line in text.lines() {
        let code = line.trim_start_matches(' ');
        let blanks = line.len() - code.len();
        out.extend(std::iter::repeat_n('\t', blanks / 4).chain(std::iter::repeat_n(' ', blanks % 4)));
        out += code;
        out.push('\n');
    }
    out
}

/// The tests that a file carries. Of a goal that is not the whole pose only the joint vector can be compared.
fn tests(program: &Program) -> String {
    if program.goal == GoalType::default() {
        return TESTS.into();
    }
    let check = "            assert!(found.as_slice().iter().all(|values| forward(values).distance(&pose) < 1e-9));\n";
    TESTS
        .replace(check, "")
        .replace(", all answers reach their pose, and", ", and")
        .replace("let values: [f64; VARIABLES] = core::array", "let values: [f64; ALL] = core::array")
        .replace("(2.0 * unit - 1.0) * if", "if LEAST[v] == 0.0 {\n                    return 0.1 + unit;\n                }\n                (2.0 * unit - 1.0) * if")
        .replace("forward(&values)", "arm(&DESCRIBED).forward_values(&values)")
}

/// What the file offers, and how candidates become solutions.
fn api(program: &Program) -> String {
    if program.goal == GoalType::default() {
        return API.replace("FAMILIES", FAMILIES);
    }
    let rest: Vec<String> = program.goal.at_rest().iter().map(|x| format!("{x:?}")).collect();
    let forward = format!(
        "    let mut all = [0.0; ALL];\n    all[..VARIABLES].copy_from_slice(values);\n    \
         // Where the added joints turn nothing.\n    all[VARIABLES..].copy_from_slice(&[{}]);\n    arm(&DESCRIBED).forward_values(&all)",
        rest.join(", ")
    );
    let keep = "        self.accepted += 1;
        let new = !self.out.as_slice().iter().any(|other| self.arm.same(&values, other));
        if new && self.out.len < CAPACITY {
            self.out.values[self.out.len] = values;
";
    let keep_part = "        if (VARIABLES..ALL).any(|v| values[v] < LEAST[v] - 1e-9) {
            self.misses += 1;
            return;
        }
        self.accepted += 1;
        let values = &values[..VARIABLES];
        let new = !self.out.as_slice().iter().any(|other| self.arm.same(values, other));
        if new && self.out.len < CAPACITY {
            self.out.values[self.out.len].copy_from_slice(values);
";
    assert!(API.contains(keep), "the text above is part of the other");
    API.replace("FAMILIES", "")
        .replace("    arm(&DESCRIBED).forward_values(values)", &forward)
        .replace(keep, keep_part)
        .replace(
            "steps: [[f64; 2]; VARIABLES], mut values: [f64; VARIABLES]",
            "steps: [[f64; 2]; ALL], mut values: [f64; ALL]",
        )
}

/// The tests that a file carries.
const TESTS: &str = "
#[cfg(test)]
mod tests {
    use super::*;

    /// Every pose of a joint vector is solved, all answers reach their pose, and the joint vector is among them: of a hundred at most
    /// one, near a singular pose, may be found by other answers alone.
    #[test]
    fn solves_the_poses_of_joint_vectors() {
        let mut bits = 88172645463325252u64;
        let mut found = Solutions::new();
        let mut again = 0;
        for _ in 0..300 {
            let values: [f64; VARIABLES] = core::array::from_fn(|v| {
                bits ^= bits << 13;
                bits ^= bits >> 7;
                bits ^= bits << 17;
                let unit = (bits >> 11) as f64 / (1u64 << 53) as f64;
                (2.0 * unit - 1.0) * if SLIDES[v] { 1.0 } else { 3.1 }
            });
            let pose = forward(&values);
            solve(&pose, &FREE.map(|v| values[v]), &mut found);
            let near = |other: &[f64; VARIABLES]| {
                (0..VARIABLES).all(|v| {
                    let gap = (values[v] - other[v]).abs();
                    gap < 1e-6 || (!SLIDES[v] && (gap - core::f64::consts::TAU).abs() < 1e-6)
                })
            };
            assert!(!found.as_slice().is_empty());
            again += usize::from(found.as_slice().iter().any(near));
            assert!(found.as_slice().iter().all(|values| forward(values).distance(&pose) < 1e-9));
        }
        assert!(again >= 297);
    }
}
";

fn header(program: &Program, out: &mut String) {
    let _ = writeln!(
        out,
        "//! Inverse kinematics: {}.\n\
         //!\n\
         //! Generated by robotc. [`solve`] finds all joint vectors that reach a pose; each returned one was checked against the chain\n\
         //! to 1e-9 (metres, and Frobenius norm of the rotation difference). Angles are radians in (-pi, pi], lengths metres;\n\
         //! joint limits are not applied. Nothing allocates, and nothing panics.",
        program.class
    );
    if program.goal != GoalType::default() {
        let _ = writeln!(
            out,
            "//!\n//! Of a pose only a part is asked for, {}: {}.\n//! The rest of the pose may be anything.",
            program.goal.name(),
            program.goal.meaning()
        );
    }
    if program.snap > 0.0 {
        let _ = writeln!(
            out,
            "//!\n//! The equations are those of an ideal chain that differs from the described one by up to {:.1e} (radians, metres);\n\
             //! solutions are polished on the described one.",
            program.snap
        );
    }
    out.push_str("\n#![allow(dead_code, unused_variables, clippy::all)]\n\n");
}

/// What the file's own code may call.
const USES: &str = "\
pub use chain::{Frame, Link};
pub use family::{Families, Family};
use as_given::{as_given, with_given};
use candidate::{Arm, MOST_MISSES, WIDER, is_exact};
use conic::conic;
use family::{families_of, member_of};
use math::{angle_of, cos_sin, mirrored, opposite, sqrt};
use octic::octic;
use roots::{align, circle, half, mirror, quadratic};
use six::{Order, six_of};
use sweep::sweep_of;
";

fn constants(program: &Program, chain: &TrueChain, out: &mut String) {
    let n = program.variables;
    let own = program.chain_variables();
    let held: Vec<bool> = (0..n).map(|v| program.free.contains(&v)).collect();
    let _ = writeln!(out, "/// Number of variables.\npub const VARIABLES: usize = {own};\n");
    if program.goal != GoalType::default() {
        let least: Vec<String> = (0..own)
            .map(|_| f64::NEG_INFINITY)
            .chain(program.goal.least())
            .map(|x| if x.is_finite() { format!("{x:?}") } else { "f64::NEG_INFINITY".into() })
            .collect();
        let _ = writeln!(
            out,
            "/// The same with the joints that stand for what the goal leaves open.\nconst ALL: usize = {n};\n\n\
             /// Smallest values of a solution.\nconst LEAST: [f64; ALL] = [{}];\n",
            least.join(", ")
        );
    }
    let _ = writeln!(
        out,
        "/// Variables whose value the caller gives.\npub const FREE: [usize; {}] = {:?};\n",
        program.free.len(),
        program.free
    );
    let capacity = capacity(program);
    let _ = writeln!(out, "/// Most solutions of one pose.\npub const CAPACITY: usize = {capacity};\n");
    let _ =
        writeln!(out, "const SLIDES: [bool; {n}] = {:?};\nconst HELD: [bool; {n}] = {held:?};", chain.slides);
    let _ = writeln!(out, "const SLACK: f64 = {:?};\n", program.slack);
    let _ = writeln!(out, "/// The chain as described. Give [`solve_on`] a calibrated one in its place.");
    let _ = writeln!(out, "pub const DESCRIBED: Chain = Chain {{\n    links: [");
    for link in &chain.links {
        let _ = writeln!(
            out,
            "        Link {{\n            previous_from_joint: {},\n            slides: {}, variable: {}, ratio: {:?},\n        }},",
            frame(&link.previous_from_joint),
            link.slides,
            link.variable,
            link.ratio
        );
    }
    let _ = writeln!(out, "    ],\n    last_from_tip: {},\n}};\n", frame(&chain.last_from_tip));
    let _ = writeln!(
        out,
        "/// Constants of a chain: every joint axis is the z axis of its frame.\npub struct Chain {{\n    /// Moving joints, base to tip.\n    \
         pub links: [Link; {}],\n    /// Pose of the tip in the frame after the last joint.\n    pub last_from_tip: Frame,\n}}\n",
        chain.links.len()
    );
}

fn frame(f: &Frame) -> String {
    format!("Frame {{ rotation: {:?}, position: {:?} }}", f.rotation, f.position)
}

/// Continua of solutions, known of whole poses.
const FAMILIES: &str = "\
/// How joints can move together and leave the tip where it is, through a solution of a pose: where axes have lined up. None at a
/// regular pose.
pub fn families(base_from_tip: &Frame, solution: &[f64; VARIABLES]) -> Families {
    families_of(&arm(&DESCRIBED), base_from_tip, solution)
}

/// The member of a family through a solution at `t`, angles not brought back to (-pi, pi]; nothing outside of its interval.
pub fn family_member(
    base_from_tip: &Frame,
    solution: &[f64; VARIABLES],
    family: &Family,
    t: f64,
) -> Option<[f64; VARIABLES]> {
    let mut member = *solution;
    member_of(&arm(&DESCRIBED), base_from_tip, family, &mut member, t).then_some(member)
}

";

const API: &str = "\
/// The solutions of one pose, in the order in which they were found.
#[derive(Clone, Debug)]
pub struct Solutions {
    values: [[f64; VARIABLES]; CAPACITY],
    len: usize,
}

impl Solutions {
    /// No solutions.
    pub const fn new() -> Self {
        Self { values: [[0.0; VARIABLES]; CAPACITY], len: 0 }
    }

    /// The solutions, each one value for each variable.
    pub fn as_slice(&self) -> &[[f64; VARIABLES]] {
        &self.values[..self.len]
    }
}

/// Pose of the tip at these variable values.
pub fn forward(values: &[f64; VARIABLES]) -> Frame {
    arm(&DESCRIBED).forward_values(values)
}

/// All solutions for a pose of the chain as described, given the values of the variables in [`FREE`].
pub fn solve(base_from_tip: &Frame, free: &[f64; FREE.len()], out: &mut Solutions) {
    solve_with(&DESCRIBED, true, base_from_tip, free, out);
}

FAMILIESfn arm(chain: &Chain) -> Arm<'_> {
    Arm { links: &chain.links, last_from_tip: &chain.last_from_tip, slides: &SLIDES, held: &HELD }
}

/// Where candidates go.
struct Sink<'a> {
    arm: Arm<'a>,
    base_from_tip: &'a Frame,
    out: &'a mut Solutions,
    accepted: usize,
    misses: usize,
    /// An equation was near to losing roots.
    doubt: bool,
    /// The chain is the described one, for which candidates come with their misses.
    described: bool,
}

impl Sink<'_> {
    /// Keeps a candidate if it is right and new: the step of each variable, its value, and the squares of how far the
    /// described chain is from the pose, rotation and position.
    fn offer(&mut self, steps: [[f64; 2]; VARIABLES], mut values: [f64; VARIABLES], misses: [f64; 2]) {
        if self.misses >= MOST_MISSES {
            return;
        }
        if !(self.described && is_exact(misses)) && !self.arm.settle(self.base_from_tip, &steps, &mut values) {
            self.misses += 1;
            return;
        }
        self.accepted += 1;
        let new = !self.out.as_slice().iter().any(|other| self.arm.same(&values, other));
        if new && self.out.len < CAPACITY {
            self.out.values[self.out.len] = values;
            self.out.len += 1;
        }
    }
}

fn sin(x: f64) -> f64 {
    cos_sin(x)[1]
}

fn cos(x: f64) -> f64 {
    cos_sin(x)[0]
}

fn min(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

fn max(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

";

/// Candidates of the general solver on the chain as it is.
const MEASURED: &str = "\
/// Offers candidates of the general solver of six joints, on the chain as it is.
fn attempt_on(base_from_tip: &Frame, free: &[f64; FREE.len()], sink: &mut Sink<'_>) {
    let mut values = [0.0; VARIABLES];
    for (v, value) in FREE.into_iter().zip(free) {
        values[v] = *value;
    }
    sink.misses = 0;
    let found = as_given(&sink.arm, base_from_tip, &values, &ORDERS);
    for i in 0..found.count() {
        let all = with_given(&sink.arm, found.get(i), &values);
        sink.offer(core::array::from_fn(|v| all[v]), values, [f64::INFINITY; 2]);
    }
}

";

fn solve(program: &Program, measured: &[Order], out: &mut String) {
    if !measured.is_empty() {
        let list: Vec<String> = measured
            .iter()
            .map(|o| format!("Order {{ code: {}, degree: {}, squared: {} }}", o.code, o.degree, o.squared))
            .collect();
        let _ = writeln!(
            out,
            "/// Orders of elimination for a calibrated chain.\nconst ORDERS: [Order; {}] = [{}];\n",
            list.len(),
            list.join(", ")
        );
        out.push_str(MEASURED);
    }
    let on = "    if !described {\n        attempt_on(base_from_tip, free, &mut sink);\n    }\n";
    let text = "/// As [`solve`], for a chain whose constants are near those of the described one.\n\
         pub fn solve_on(chain: &Chain, base_from_tip: &Frame, free: &[f64; FREE.len()], out: &mut Solutions) {\n    \
         solve_with(chain, false, base_from_tip, free, out);\n}\n\n\
         fn solve_with(chain: &Chain, described: bool, base_from_tip: &Frame, free: &[f64; FREE.len()], out: &mut Solutions) {\n    \
         out.len = 0;\n    \
         let mut sink = Sink { arm: arm(chain), base_from_tip, out, accepted: 0, misses: 0, doubt: false, described };\n    \
         attempt(base_from_tip, free, SLACK, &mut sink);\nMEASURED    \
         for slack in WIDER {\n        \
         if sink.accepted == 0 && slack > SLACK {\n            sink.misses = 0;\n            sink.doubt = false;\n            \
         attempt(base_from_tip, free, slack, &mut sink);\n        }\n    }\n}\n\n\
         /// Offers candidates; the equations may miss their roots by `slack`.\n\
         fn attempt(base_from_tip: &Frame, free: &[f64; FREE.len()], slack: f64, sink: &mut Sink<'_>) {\n    \
         let [[r00, r01, r02], [r10, r11, r12], [r20, r21, r22]] = base_from_tip.rotation;\n    \
         let [px, py, pz] = base_from_tip.position;\n";
    *out += &text.replace("MEASURED", if measured.is_empty() { "" } else { on });
    let free: Vec<String> = (0..program.free.len()).map(|k| format!("free{k}")).collect();
    let _ = writeln!(out, "    let [{}] = *free;", free.join(", "));
    let mut loops = 0;
    block(program, &program.body, 1, &mut loops, out);
    out.push_str("}\n\n");
}

fn block(p: &Program, stmts: &Block, depth: usize, loops: &mut usize, out: &mut String) {
    let pad = "    ".repeat(depth);
    for stmt in stmts {
        match stmt {
            Stmt::Note(text) => {
                let _ = writeln!(out, "{pad}// {text}");
            }
            Stmt::Let { var, value } => {
                let _ = writeln!(out, "{pad}let {} = {};", p.names[var.0 as usize], p.expr_text(*value));
            }
            Stmt::ForEach { kind, args, out: names, body } => {
                *loops += 1;
                let k = *loops;
                let args: Vec<String> = match kind {
                    RootKind::Conic | RootKind::Octic | RootKind::Six | RootKind::Sweep => {
                        let all: Vec<String> = args.iter().map(|e| p.expr_text(*e)).collect();
                        let by = if kind.is_joint() { "&" } else { "" };
                        vec![format!("{by}[{}]", all.join(", "))]
                    }
                    _ => args.iter().map(|e| p.expr_text(*e)).collect(),
                };
                let mut names: Vec<&str> = names.iter().map(|v| p.names[v.0 as usize].as_str()).collect();
                if names.len() < 2 {
                    names.push("_");
                }
                let args = args.join(", ");
                if kind.is_joint() {
                    let pairs: Vec<String> = names.chunks(2).map(|p| format!("[{}]", p.join(", "))).collect();
                    // Six joints in general are solved as they are described.
                    let _ = writeln!(out, "{pad}let roots{k} = {}_of({args}, slack - SLACK);", kind.word());
                    let _ = writeln!(out, "{pad}for i in 0..roots{k}.count() {{");
                    let _ = writeln!(out, "{pad}    let [{}] = roots{k}.get(i);", pairs.join(", "));
                } else {
                    let (word, names) = (kind.word(), names.join(", "));
                    let _ =
                        writeln!(out, "{pad}let mut roots{k} = {word}({args}, slack).tries(sink.accepted);");
                    let _ = writeln!(out, "{pad}while let Some([{names}]) = roots{k}.next(sink.accepted) {{");
                }
                block(p, body, depth + 1, loops, out);
                let _ = writeln!(out, "{pad}}}");
            }
            Stmt::IfZero { value, tolerance, then, otherwise } => {
                let test = format!("({}).abs() < {tolerance:?}", p.expr_text(*value));
                if then.is_empty() {
                    let _ = writeln!(out, "{pad}if !({test}) {{");
                    block(p, otherwise, depth + 1, loops, out);
                } else {
                    let _ = writeln!(out, "{pad}if {test} {{");
                    block(p, then, depth + 1, loops, out);
                    if !otherwise.is_empty() {
                        let _ = writeln!(out, "{pad}}} else {{");
                        block(p, otherwise, depth + 1, loops, out);
                    }
                }
                let _ = writeln!(out, "{pad}}}");
            }
            Stmt::Fallback { first, otherwise } => {
                *loops += 1;
                let k = *loops;
                let _ = writeln!(out, "{pad}let before{k} = sink.accepted;");
                let _ = writeln!(out, "{pad}{{");
                block(p, first, depth + 1, loops, out);
                let _ = writeln!(out, "{pad}}}\n{pad}if sink.accepted == before{k} {{");
                block(p, otherwise, depth + 1, loops, out);
                let _ = writeln!(out, "{pad}}}");
            }
            Stmt::Doubt { value, tolerance } => {
                let _ = writeln!(out, "{pad}sink.doubt |= ({}).abs() < {tolerance:?};", p.expr_text(*value));
            }
            Stmt::Rest(body) => {
                let _ = writeln!(out, "{pad}if sink.doubt || sink.accepted == 0 {{");
                block(p, body, depth + 1, loops, out);
                let _ = writeln!(out, "{pad}}}");
            }
            Stmt::Offer { values, angles, misses } => {
                let step = |value: &Value| match *value {
                    Value::Angle(c, s) => format!("[{}, {}]", p.expr_text(c), p.expr_text(s)),
                    Value::Length(x) => format!("[{}, 0.0]", p.expr_text(x)),
                };
                let text = |e: &Expr| p.expr_text(*e);
                let _ = writeln!(
                    out,
                    "{pad}sink.offer(\n{pad}    {},\n{pad}    {},\n{pad}    {},\n{pad});",
                    list(values.iter().map(step).collect()),
                    list(angles.iter().map(text).collect()),
                    list(misses.iter().map(text).collect()),
                );
            }
            Stmt::Emit(_) => unreachable!("a prepared program offers"),
        }
    }
}

/// An array; of equal items one is written.
fn list(items: Vec<String>) -> String {
    match &items[..] {
        [first, .., _] if items.iter().all(|item| item == first) => format!("[{first}; {}]", items.len()),
        _ => format!("[{}]", items.join(", ")),
    }
}

/// What the code before calls of the kernel's files, as modules.
fn kernel(options: &RustOptions, out: &mut String) {
    let sqrt = ("sqrt", if options.std { PLATFORM_SQRT } else { CORE_SQRT });
    let files: Vec<(&str, &str)> = std::iter::once(sqrt)
        .chain(SOURCES)
        .map(|(name, source)| (name, source.split("#[cfg(test)]").next().unwrap_or(source)))
        .collect();
    for (name, source) in prune::needed(&files, USES, &format!("{out}{TESTS}")) {
        // Not indented: the lines are as long as where they come from.
        let _ = write!(out, "mod {name} {{\n\n{}\n}}\n\n", source.trim());
    }
    out.truncate(out.trim_end().len() + 1);
}
