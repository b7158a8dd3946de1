//! C99: a header and a source without dependencies or allocation, in the part of the language that C++ shares.

use std::fmt::Write as _;

use super::{capacity, measured};
use crate::GoalType;
use crate::ir::{Block, Expr, Program, RootKind, Stmt, Value};
use crate::kernel::chain::Frame;
use crate::kernel::six::Order;
use crate::run::TrueChain;

/// The numeric kernel by sections, `/* == name == */` before each: what most solvers take, and what eigenvalues are for.
const KERNEL: [&str; 2] = [include_str!("kernel.c"), include_str!("kernel_general.c")];

/// What each section calls, itself in the order of the file.
const SECTIONS: [(&str, &[&str]); 35] = [
    ("sqrt", &[]),
    ("abs", &[]),
    ("finite", &[]),
    ("min", &[]),
    ("max", &[]),
    ("cos_sin", &[]),
    ("sin", &["cos_sin"]),
    ("cos", &["cos_sin"]),
    ("angle_of", &["abs"]),
    ("opposite", &[]),
    ("mirrored", &[]),
    ("roots", &["cos_sin"]),
    ("apart", &["sqrt"]),
    ("align", &["roots", "sqrt", "finite"]),
    ("half", &["roots", "sqrt", "finite", "apart", "abs"]),
    ("mirror", &["half"]),
    ("circle", &["roots", "sqrt", "finite", "apart", "abs"]),
    ("quadratic", &["roots", "sqrt", "abs"]),
    ("conic", &["circle"]),
    ("eigen", &["sqrt", "abs"]),
    ("waves", &["eigen", "angle_of", "cos_sin", "finite"]),
    ("bends", &["waves"]),
    ("octic", &["bends", "roots"]),
    ("vector", &["sqrt", "finite", "cos_sin"]),
    ("elimination", &["vector"]),
    ("null", &["elimination", "circle", "eigen"]),
    ("joint", &["null"]),
    ("whole", &["null", "waves"]),
    ("six", &["joint", "whole", "bends"]),
    ("piece", &["eigen", "cos_sin"]),
    ("sweep", &["joint", "piece"]),
    ("chain", &["sqrt", "abs", "finite", "cos_sin"]),
    ("candidate", &["chain", "angle_of"]),
    ("family", &["chain"]),
    ("as_given", &["six", "candidate"]),
];

/// Choices of the C back end.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct COptions {
    /// As [`RustOptions::calibrated`](super::RustOptions::calibrated).
    pub calibrated: bool,
}

/// What the header says of continua of solutions, known of whole poses.
const FAMILIES: &str = "\
/* Infinitely many solutions through one, where axes have lined up. */
typedef struct {
    /* Which joints move together: 1 for the leading one, 0 for those that stay. */
    double direction[UPPER_VARIABLES];
    int leader;
    /* Whether solution + t direction reaches the pose for every t; otherwise a curve starts in that direction, and t is what the
       leading joint has moved. */
    int is_line;
    /* Smallest and largest t, zero inside; from -pi to pi when the family closes. */
    double interval[2];
} NAME_family;

/* The families through a solution of a pose; returns their number, 0 at a regular pose. */
int NAME_families(const NAME_frame *base_from_tip, const double solution[UPPER_VARIABLES], NAME_family out[UPPER_VARIABLES]);

/* The member of a family through a solution at t, angles not brought back to (-pi, pi]; 0, and nothing meant, outside of its interval. */
int NAME_family_member(const NAME_frame *base_from_tip, const double solution[UPPER_VARIABLES], const NAME_family *family, double t,
                       double member[UPPER_VARIABLES]);

";

/// The same in the source.
const FAMILIES_SOURCE: &str = "
int NAME_families(const NAME_frame *base_from_tip, const double solution[UPPER_VARIABLES], NAME_family out[UPPER_VARIABLES])
{
    return ik_families_of(&NAME_described, base_from_tip, solution, out);
}

int NAME_family_member(const NAME_frame *base_from_tip, const double solution[UPPER_VARIABLES], const NAME_family *family, double t,
                       double member[UPPER_VARIABLES])
{
    int i;
    for (i = 0; i < UPPER_VARIABLES; i++) member[i] = solution[i];
    return ik_member_of(&NAME_described, base_from_tip, family, member, t);
}
";

/// A text about families with the names of a solver; nothing for goals that are not whole poses.
fn families(program: &Program, name: &str, text: &str) -> String {
    match program.goal {
        GoalType::Transform6D => text.replace("NAME", name).replace("UPPER", &name.to_uppercase()),
        _ => String::new(),
    }
}

/// The two files of a solver.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CSource {
    /// `NAME.h`.
    pub header: String,
    /// `NAME.c`.
    pub source: String,
}

/// Why a program has no C form.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum CError {
    /// The name is not one of C.
    #[error("{0:?} cannot name C functions: letters, digits and underscores are possible, a letter first")]
    Name(String),
}

/// Header and source of a program; `name` is the prefix of all that they export, and the stem of the files.
pub fn c_source(
    program: &Program,
    chain: &TrueChain,
    name: &str,
    options: &COptions,
) -> Result<CSource, CError> {
    let starts = name.starts_with(|c: char| c.is_ascii_alphabetic());
    if !starts || !name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_') {
        return Err(CError::Name(name.into()));
    }
    let program = &crate::passes::prepare(program, chain);
    let mut body = String::new();
    block(program, &program.body, 1, &mut 0, &mut body);
    Ok(CSource { header: header(program, chain, name), source: source(program, chain, name, &body, options) })
}

fn about(program: &Program) -> String {
    let snap = if program.snap > 0.0 {
        format!(
            "\n   The equations are those of an ideal chain that differs from the described one by up to {:.1e} (radians, metres);\n   \
             solutions are polished on the described one.",
            program.snap
        )
    } else {
        String::new()
    };
    format!(
        "/* Inverse kinematics: {}.\n\n   Generated by robotc. Each returned joint vector was checked against the chain to 1e-9 (metres, and \
         Frobenius norm of the\n   rotation difference). Angles are radians in (-pi, pi], lengths metres; joint limits are not applied. \
         Nothing allocates.{snap} */\n",
        program.class
    )
}

fn header(program: &Program, chain: &TrueChain, name: &str) -> String {
    let guard = format!("{}_H", name.to_uppercase());
    let upper = name.to_uppercase();
    let capacity = capacity(program);
    let (variables, free, links) = (program.chain_variables(), program.free.len(), chain.links.len());
    let goal = if program.goal == GoalType::default() {
        String::new()
    } else {
        format!(
            "\n   Of a pose only a part is asked for, {}: {}. The rest may be anything.",
            program.goal.name(),
            program.goal.meaning()
        )
    };
    let list: Vec<String> = program.free.iter().map(|v| format!("{v}")).collect();
    let given = match &list[..] {
        [] => "There are none: `given` may be NULL.".to_owned(),
        _ => format!("In this order: variables {} (the first is 0).", list.join(", ")),
    };
    format!(
        "{about}\n#ifndef {guard}\n#define {guard}\n\n#ifdef __cplusplus\nextern \"C\" {{\n#endif\n\n\
         /* Number of variables. */\n#define {upper}_VARIABLES {variables}\n\
         /* Number of variables whose value the caller gives. {given} */\n#define {upper}_GIVEN {free}\n\
         /* Most solutions of one pose. */\n#define {upper}_CAPACITY {capacity}\n\
         /* Moving joints. */\n#define {upper}_LINKS {links}\n\n\
         /* A rigid transform: rotation rows, then position. */\ntypedef struct {{\n    double rotation[3][3];\n    double position[3];\n}} {name}_frame;\n\n\
         /* A moving joint whose axis is the z axis of its own frame. */\ntypedef struct {{\n    {name}_frame previous_from_joint;\n    \
         int slides;\n    int variable;\n    double ratio;\n}} {name}_link;\n\n\
         /* Constants of a chain, base to tip. */\ntypedef struct {{\n    {name}_link links[{upper}_LINKS];\n    {name}_frame last_from_tip;\n}} {name}_chain;\n\n\
         /* The solutions of one pose, in the order in which they were found. */\ntypedef struct {{\n    \
         double values[{upper}_CAPACITY][{upper}_VARIABLES];\n    int count;\n}} {name}_solutions;\n\n\
         /* The chain as described. */\nextern const {name}_chain {name}_described;\n\n\
         /* Pose of the tip at these values. */\nvoid {name}_forward(const double values[{upper}_VARIABLES], {name}_frame *base_from_tip);\n\n\
         /* All solutions for a pose of the chain as described; returns their number.{goal} */\n\
         int {name}_solve(const {name}_frame *base_from_tip, const double *given, {name}_solutions *out);\n\n\
         /* The same for a chain whose constants are near those of the described one: a calibrated arm. */\n\
         int {name}_solve_on(const {name}_chain *chain, const {name}_frame *base_from_tip, const double *given, {name}_solutions *out);\n\n\
         {families}#ifdef __cplusplus\n}}\n#endif\n\n#endif\n",
        about = about(program),
        families = families(program, name, FAMILIES),
    )
}

fn source(program: &Program, chain: &TrueChain, name: &str, body: &str, options: &COptions) -> String {
    let upper = name.to_uppercase();
    let added = program.chain_variables() < program.variables;
    let all = if added { program.variables.to_string() } else { format!("{upper}_VARIABLES") };
    let forward = if added {
        format!(
            "    double all[IK_VARIABLES];\n    int i;\n    \
             for (i = 0; i < IK_VARIABLES; i++) all[i] = i < IK_JOINTS ? values[i] : ik_rest[i - IK_JOINTS];\n    \
             ik_reach(&{name}_described, all, base_from_tip, axes);\n"
        )
    } else {
        format!("    ik_reach(&{name}_described, values, base_from_tip, axes);\n")
    };
    let most_roots = if program.uses(RootKind::Octic) { 8 } else { 4 };
    let mut out = about(program);
    let _ = write!(
        out,
        "\n#include \"{name}.h\"\n\n#include <math.h>\n#include <stdint.h>\n\n\
         /* Compile without contraction of products and sums (gcc and clang: -ffp-contract=off) for the same bits everywhere;\n   \
         with IK_FREESTANDING nothing of the C library is called. */\n\n\
         #define IK_JOINTS {upper}_VARIABLES\n#define IK_VARIABLES {all}\n#define IK_LINKS {upper}_LINKS\n#define IK_CAPACITY {upper}_CAPACITY\n#define IK_MOST_ROOTS {most_roots}\n\
         typedef {name}_frame ik_frame;\ntypedef {name}_link ik_link;\ntypedef {name}_chain ik_chain;\ntypedef {name}_solutions ik_solutions;\n{}\n",
        families(program, name, "typedef NAME_family ik_family;\n")
    );
    let flags = |flags: Vec<bool>| {
        let words: Vec<&str> = flags.into_iter().map(|f| if f { "1" } else { "0" }).collect();
        words.join(", ")
    };
    let mut joints = String::new();
    if added {
        let list = |values: Vec<f64>| {
            values
                .iter()
                .map(|x| if x.is_finite() { format!("{x:?}") } else { "-1e300".into() })
                .collect::<Vec<_>>()
        };
        let _ = write!(
            joints,
            "/* Joints that stand for what the goal leaves open: where they turn nothing, and the smallest values of a solution. */\n\
             static const double ik_rest[IK_VARIABLES - IK_JOINTS] = {{ {} }};\n\
             static const double ik_least[IK_VARIABLES - IK_JOINTS] = {{ {} }};\n\n",
            list(program.goal.at_rest()).join(", "),
            list(program.goal.least()).join(", ")
        );
    }
    let held = (0..program.variables).map(|v| program.free.contains(&v)).collect();
    let _ = write!(
        out,
        "{joints}/* Which variables are lengths, of which a full turn changes nothing, and which are given. */\n\
         static const int ik_slides[IK_VARIABLES] = {{ {} }};\nstatic const int ik_round[IK_VARIABLES] = {{ {} }};\n\
         static const int ik_held[IK_VARIABLES] = {{ {} }};\n\n",
        flags(chain.slides.clone()),
        flags((0..program.variables).map(|v| chain.arm(&[]).is_round(v)).collect()),
        flags(held)
    );
    described(chain, name, &mut out);
    let (mut orders, mut on) = (String::new(), "");
    let measured = measured(options.calibrated, program, chain);
    if !measured.is_empty() {
        let numbers = |o: &Order| format!("{}, {}, {}", o.code, o.degree, i32::from(o.squared));
        let list: Vec<String> = measured.iter().map(numbers).collect();
        orders = format!("    static const double orders[9] = {{ {} }};\n", list.join(", "));
        on = "        if (!described && i == 0) ik_as_given(chain, pose, given, orders, &sink);\n";
    }
    let called = format!("{body}{on}");
    for (section, _) in SECTIONS.iter().filter(|(section, _)| needed(section, program, &called)) {
        let start = format!("/* == {section} == */\n");
        let text =
            KERNEL.iter().find_map(|file| file.split(&start).nth(1)).expect("every section is in a file");
        let text = text.split("/* == ").next().expect("split gives one at least");
        let text = if added { text.to_owned() } else { without_added(text) };
        let _ = write!(out, "{}\n\n", text.trim_end());
    }
    out += "/* Offers candidates; the equations may miss their roots by `slack`. */\n\
            static void ik_attempt(const ik_frame *pose, const double *given, double slack, ik_sink *sink)\n{\n";
    let mut inputs = Vec::new();
    for i in 0..3 {
        inputs.extend((0..3).map(|j| (format!("r{i}{j}"), format!("pose->rotation[{i}][{j}]"))));
        inputs.push((format!("p{}", ["x", "y", "z"][i]), format!("pose->position[{i}]")));
    }
    inputs.extend((0..program.free.len()).map(|k| (format!("free{k}"), format!("given[{k}]"))));
    for (input, from) in inputs.iter().filter(|(input, _)| mentions(body, input)) {
        let _ = writeln!(out, "    const double {input} = {from};");
    }
    let _ = writeln!(out, "    (void)given;\n{body}}}\n");
    let _ = write!(
        out,
        "static int ik_solve_with(const ik_chain *chain, int described, const ik_frame *pose, const double *given, ik_solutions *out)\n{{\n    \
         /* At poses where several axes line up, rounding alone can hide the roots of an equation. */\n    \
         static const double slacks[3] = {{ {:?}, 1e-5, 2e-3 }};\n{orders}    ik_sink sink;\n    int i;\n    \
         sink.chain = chain;\n    sink.pose = pose;\n    sink.out = out;\n    sink.accepted = 0;\n    sink.described = described;\n    out->count = 0;\n    \
         for (i = 0; i < 3; i++) {{\n        if (sink.accepted > 0 || (i > 0 && slacks[i] <= slacks[0])) continue;\n        \
         sink.misses = 0;\n        sink.doubt = 0;\n        ik_attempt(pose, given, slacks[i], &sink);\n{on}    }}\n    return out->count;\n}}\n\n\
         void {name}_forward(const double values[{upper}_VARIABLES], {name}_frame *base_from_tip)\n{{\n    \
         double axes[IK_LINKS][6];\n{forward}}}\n\n\
         int {name}_solve(const {name}_frame *base_from_tip, const double *given, {name}_solutions *out)\n{{\n    \
         return ik_solve_with(&{name}_described, 1, base_from_tip, given, out);\n}}\n\n\
         int {name}_solve_on(const {name}_chain *chain, const {name}_frame *base_from_tip, const double *given, {name}_solutions *out)\n{{\n    \
         return ik_solve_with(chain, 0, base_from_tip, given, out);\n}}\n",
        program.slack
    );
    out += &families(program, name, FAMILIES_SOURCE);
    out
}

/// A section of the kernel less the lines for joints that a goal adds.
fn without_added(text: &str) -> String {
    text.lines().filter(|line| !line.contains("ik_least")).map(|line| format!("{line}\n")).collect()
}

/// Whether a section is called by the body, by the fixed part, or by a section that is.
fn needed(section: &str, program: &Program, body: &str) -> bool {
    let called = |text: &str| text.contains(&format!("ik_{section}("));
    section == "candidate"
        || (section == "family" && program.goal == GoalType::Transform6D)
        || called(body)
        || (section == "roots" && body.contains("ik_roots"))
        || SECTIONS.iter().any(|(other, calls)| calls.contains(&section) && needed(other, program, body))
}

fn mentions(text: &str, word: &str) -> bool {
    let part = |c: char| c.is_ascii_alphanumeric() || c == '_';
    text.match_indices(word)
        .any(|(at, _)| !text[..at].ends_with(part) && !text[at + word.len()..].starts_with(part))
}

fn described(chain: &TrueChain, name: &str, out: &mut String) {
    let _ = write!(out, "const {name}_chain {name}_described = {{\n    {{\n");
    for (i, link) in chain.links.iter().enumerate() {
        let comma = if i + 1 < chain.links.len() { "," } else { "" };
        let _ = writeln!(
            out,
            "        {{ {}, {}, {}, {:?} }}{comma}",
            frame(&link.previous_from_joint),
            i32::from(link.slides),
            link.variable,
            link.ratio
        );
    }
    let _ = write!(out, "    }},\n    {}\n}};\n\n", frame(&chain.last_from_tip));
}

fn frame(frame: &Frame) -> String {
    let list = |x: &[f64; 3]| format!("{{ {:?}, {:?}, {:?} }}", x[0], x[1], x[2]);
    let rows: Vec<String> = frame.rotation.iter().map(list).collect();
    format!("{{ {{ {} }}, {} }}", rows.join(", "), list(&frame.position))
}

/// An expression: the functions of the solution language have a prefix.
fn text(p: &Program, e: Expr) -> String {
    let plain = p.expr_text(e);
    let mut out = String::new();
    let mut rest = &plain[..];
    while let Some(open) = rest.find('(') {
        let (before, after) = rest.split_at(open);
        let word = before.rfind(|c: char| !c.is_ascii_alphanumeric() && c != '_').map_or(0, |k| k + 1);
        let prefix = if word < open { "ik_" } else { "" };
        let _ = write!(out, "{}{prefix}{}(", &before[..word], &before[word..]);
        rest = &after[1..];
    }
    out + rest
}

/// An array of arguments, a few on a line.
fn numbers(p: &Program, args: &[Expr], k: usize, pad: &str, out: &mut String) {
    let list: Vec<String> = args.iter().map(|e| text(p, *e)).collect();
    let lines: Vec<String> = list.chunks(6).map(|line| format!("{pad}    {}", line.join(", "))).collect();
    let _ =
        writeln!(out, "{pad}const double numbers{k}[{}] = {{\n{}\n{pad}}};", list.len(), lines.join(",\n"));
}

fn block(p: &Program, stmts: &Block, depth: usize, loops: &mut usize, out: &mut String) {
    let pad = "    ".repeat(depth);
    for stmt in stmts {
        match stmt {
            Stmt::Note(note) => {
                let _ = writeln!(out, "{pad}/* {} */", note.replace("*/", "* /"));
            }
            Stmt::Let { var, value } => {
                let _ = writeln!(out, "{pad}const double {} = {};", p.name(*var), text(p, *value));
            }
            Stmt::ForEach { kind, args, out: names, body } if kind.is_joint() => {
                *loops += 1;
                let k = *loops;
                numbers(p, args, k, &pad, out);
                let _ = write!(
                    out,
                    "{pad}ik_candidates roots{k};\n{pad}int i{k};\n{pad}ik_{}(numbers{k}, slack - {:?}, &roots{k});\n\
                     {pad}for (i{k} = 0; i{k} < roots{k}.count; i{k}++) {{\n",
                    kind.word(),
                    p.slack
                );
                let mut inner = String::new();
                block(p, body, depth + 1, loops, &mut inner);
                for (i, name) in
                    names.iter().map(|v| p.name(*v)).enumerate().filter(|(_, n)| mentions(&inner, n))
                {
                    let part = if i % 2 == 0 { "c" } else { "s" };
                    let _ = writeln!(
                        out,
                        "{pad}    const double {name} = roots{k}.turns[i{k}][{}].{part};",
                        i / 2
                    );
                }
                let _ = writeln!(out, "{inner}{pad}}}");
            }
            Stmt::ForEach { kind, args, out: names, body } => {
                *loops += 1;
                let k = *loops;
                let mut list: Vec<String> = args.iter().map(|e| text(p, *e)).collect();
                if *kind == RootKind::Octic {
                    numbers(p, args, k, &pad, out);
                    list = vec![format!("numbers{k}")];
                }
                let mut inner = String::new();
                block(p, body, depth + 1, loops, &mut inner);
                let _ = write!(
                    out,
                    "{pad}const ik_roots roots{k} = ik_{}({}, slack);\n{pad}const int before{k} = sink->accepted;\n{pad}int i{k};\n\
                     {pad}for (i{k} = 0; i{k} < ik_count(&roots{k}); i{k}++) {{\n{pad}    double root{k}[2];\n",
                    kind.word(),
                    list.join(", ")
                );
                let take = format!(
                    "{pad}    if (roots{k}.is_free && sink->accepted > before{k}) break;\n{pad}    ik_get(&roots{k}, i{k}, root{k});\n"
                );
                let used = names.iter().enumerate().filter(|(_, v)| mentions(&inner, p.name(**v)));
                let bind: String = used
                    .map(|(i, v)| format!("{pad}    const double {} = root{k}[{i}];\n", p.name(*v)))
                    .collect();
                let _ = writeln!(out, "{take}{bind}{inner}{pad}}}");
            }
            Stmt::IfZero { value, tolerance, then, otherwise } => {
                let test = format!("ik_abs({}) < {tolerance:?}", text(p, *value));
                let (test, then, otherwise) = match then.is_empty() {
                    true => (format!("!({test})"), otherwise, then),
                    false => (test, then, otherwise),
                };
                let _ = writeln!(out, "{pad}if ({test}) {{");
                block(p, then, depth + 1, loops, out);
                if !otherwise.is_empty() {
                    let _ = writeln!(out, "{pad}}} else {{");
                    block(p, otherwise, depth + 1, loops, out);
                }
                let _ = writeln!(out, "{pad}}}");
            }
            Stmt::Fallback { first, otherwise } => {
                *loops += 1;
                let k = *loops;
                let _ = writeln!(out, "{pad}const int before{k} = sink->accepted;\n{pad}{{");
                block(p, first, depth + 1, loops, out);
                let _ = writeln!(out, "{pad}}}\n{pad}if (sink->accepted == before{k}) {{");
                block(p, otherwise, depth + 1, loops, out);
                let _ = writeln!(out, "{pad}}}");
            }
            Stmt::Doubt { value, tolerance } => {
                let _ =
                    writeln!(out, "{pad}if (ik_abs({}) < {tolerance:?}) sink->doubt = 1;", text(p, *value));
            }
            Stmt::Rest(body) => {
                let _ = writeln!(out, "{pad}if (sink->doubt || sink->accepted == 0) {{");
                block(p, body, depth + 1, loops, out);
                let _ = writeln!(out, "{pad}}}");
            }
            Stmt::Offer { values, angles, misses } => {
                let step = |value: &Value| match *value {
                    Value::Angle(c, s) => format!("{{ {}, {} }}", text(p, c), text(p, s)),
                    Value::Length(x) => format!("{{ {}, 0.0 }}", text(p, x)),
                };
                let list = |e: &[Expr]| e.iter().map(|e| text(p, *e)).collect::<Vec<_>>().join(", ");
                let steps: Vec<String> = values.iter().map(step).collect();
                let _ = write!(
                    out,
                    "{pad}{{\n{pad}    double steps[IK_VARIABLES][2] = {{ {} }};\n{pad}    double values[IK_VARIABLES] = {{ {} }};\n\
                     {pad}    const double misses[2] = {{ {} }};\n{pad}    ik_offer(sink, steps, values, misses);\n{pad}}}\n",
                    steps.join(", "),
                    list(angles),
                    list(misses),
                );
            }
            Stmt::Emit(_) => unreachable!("a prepared program offers"),
        }
    }
}
