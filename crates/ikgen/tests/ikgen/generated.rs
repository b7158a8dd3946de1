//! One corpus of poses on everything that runs a program: reference interpreter, bytecode, Rust with and without `std`, C.
//!
//! The sources are compiled by the real compilers with warnings denied.

use std::fmt::Write as _;
use std::path::Path;
use std::process::{Command, Stdio};

use robotc_core::Seed;
use robotc_core::ik::{FamilyPath, IkSolutions, InverseKinematics};
use robotc_ikgen::backend::{CError, COptions, RustOptions};
use robotc_ikgen::check;
use robotc_ikgen::report::poses;
use robotc_ikgen::run::{Engine, TrueChain};
use robotc_ikgen::{Compiled, GoalType, Options, Solver, compile};

use crate::{arms, coupled, goals, golden};

/// How far the reference may be from the rest at a regular pose: it takes the angles of a candidate in another way.
const REGULAR: f64 = 1e-9;

/// The same at a singular pose: where solutions fall together a last place of difference moves them by the square root of it.
const SINGULAR: f64 = 1e-6;

/// The answers to one pose, in order.
type Answers = Vec<Vec<f64>>;

#[test]
fn every_back_end_gives_the_same_solutions() {
    let folder = tempfile::tempdir().unwrap();
    let mut compiled: Vec<Compiled> =
        arms::all().iter().map(|c| compile(c, &Options::default()).unwrap()).collect();
    compiled.extend(goals::one_of_each_kind());
    compiled.extend(coupled::two_kinds());
    let (corpus, expected) = corpus(&compiled);
    std::fs::write(folder.path().join("corpus"), &corpus).unwrap();

    for (std, flavour) in [(true, "std"), (false, "core")] {
        rust_programs(folder.path(), &compiled, std, flavour);
        let found = answers(Command::new(folder.path().join(flavour)), folder.path());
        same_bits(flavour, &corpus, &expected, &found);
    }
    if !c_program(folder.path(), &compiled) {
        println!("skipped: no C compiler");
        return;
    }
    let found = answers(Command::new(folder.path().join("main_c")), folder.path());
    same_bits("C", &corpus, &expected, &found);
}

/// A line for each pose: the arm, the twelve numbers of the pose, the given values; what the bytecode answers, followed by the
/// families of each answer: direction and interval.
fn corpus(compiled: &[Compiled]) -> (String, Vec<Answers>) {
    let (mut text, mut expected) = (String::new(), Vec::new());
    let mut families = [0, 0];
    for c in compiled {
        let (chain, solver) = (c.longer_chain(), c.solver());
        // As many as generated solvers have room for.
        let room = if c.class.contains("swept") { 32 } else { 16 };
        let reference = c.solver().with_engine(Engine::Interpreter);
        for set in poses::sets(chain, &c.free, 12, Seed::new(9)) {
            for vector in &set.vectors {
                let pose = chain.forward(vector);
                let free: Vec<f64> = c.free.iter().map(|v| vector[*v]).collect();
                let r = pose.rotation.to_rotation_matrix();
                let rows = (0..9).map(|i| r[(i / 3, i % 3)]);
                let numbers = rows.chain(pose.translation.vector.iter().copied()).chain(free.iter().copied());
                let _ = write!(text, "{}", chain.name);
                text.extend(numbers.map(|x| format!(" {:016x}", x.to_bits())));
                text.push('\n');
                let solve = |solver: &Solver| -> Answers {
                    let mut out = IkSolutions::new();
                    solver.solve(&pose, &free, &mut out);
                    out.iter().take(room).map(<[f64]>::to_vec).collect()
                };
                let mut answers = solve(&solver);
                let what = format!("{} at {} {vector:?}", chain.name, set.name);
                let near = if set.regular { REGULAR } else { SINGULAR };
                compare(&what, near, &solve(&reference), &answers);
                let mut out = IkSolutions::new();
                solver.solve_with_families(&pose, &free, &mut out);
                for family in out.families().iter().filter(|family| family.solution < room) {
                    answers.push([&family.direction[..], &family.interval].concat());
                    families[usize::from(family.path == FamilyPath::Curve)] += 1;
                }
                expected.push(answers);
            }
        }
    }
    assert!(families[0] > 100 && families[1] > 100, "{families:?}");
    (text, expected)
}

/// Runs a program on the corpus: for each pose a line with the number of answers, then one for each.
fn answers(mut program: Command, folder: &Path) -> Vec<Answers> {
    let corpus = std::fs::File::open(folder.join("corpus")).unwrap();
    let run = program.stdin(corpus).stderr(Stdio::inherit()).output().unwrap();
    assert!(run.status.success());
    let text = String::from_utf8(run.stdout).unwrap();
    let mut lines = text.lines();
    let mut all = Vec::new();
    while let Some(count) = lines.next() {
        let number = |word: &str| f64::from_bits(u64::from_str_radix(word, 16).unwrap());
        let answer = |line: &str| line.split_whitespace().map(number).collect();
        all.push(lines.by_ref().take(count.parse().unwrap()).map(answer).collect());
    }
    all
}

/// The reference gives the same answers in the same order, nearly.
fn compare(what: &str, near: f64, expected: &Answers, found: &Answers) {
    assert_eq!(found.len(), expected.len(), "{what}");
    for (a, b) in found.iter().flatten().zip(expected.iter().flatten()) {
        let gap = (a - b).abs();
        assert!(gap.min((gap - std::f64::consts::TAU).abs()) < near, "{what}: {a} is not {b}");
    }
}

/// Generated sources do the arithmetic of the bytecode in its order.
fn same_bits(what: &str, corpus: &str, expected: &[Answers], found: &[Answers]) {
    assert_eq!(found.len(), expected.len(), "{what}");
    let bits = |answers: &Answers| -> Vec<u64> { answers.iter().flatten().map(|x| x.to_bits()).collect() };
    for ((line, expected), found) in corpus.lines().zip(expected).zip(found) {
        assert_eq!(bits(found), bits(expected), "{what}: {found:?} is not {expected:?}: {line}");
    }
}

/// Compiles all solvers of one flavour into a program, and runs the tests that the files carry.
fn rust_programs(folder: &Path, compiled: &[Compiled], std: bool, flavour: &str) {
    let mut modules = String::new();
    let mut arms = String::new();
    for c in compiled {
        let name = &c.chain().name;
        let source = c.rust_source(&RustOptions { std, ..RustOptions::default() });
        let large = ["general", "offset wrist,"].iter().any(|k| c.class.contains(k));
        let most = if large { 100_000 } else { 65_000 };
        assert!(source.len() < most, "{name}: {} bytes", source.len());
        let file = folder.join(format!("{name}_{flavour}.rs"));
        std::fs::write(&file, source).unwrap();
        let _ = writeln!(modules, "#[path = {:?}]\npub mod {name};", file.display().to_string());
        let families = if c.program.goal == GoalType::default() {
            format!(
                "                for v in found.as_slice() {{\n                    for family in {name}::families(&pose, v).as_slice() {{\n                        \
                 rows.push([&family.direction[..v.len()], &family.interval].concat());\n                    }}\n                }}\n"
            )
        } else {
            String::new()
        };
        let _ = writeln!(
            arms,
            "            {name:?} => {{\n                let at = |i: usize| [x[i], x[i + 1], x[i + 2]];\n                \
             let pose = {name}::Frame {{ rotation: [at(0), at(3), at(6)], position: at(9) }};\n                \
             let mut found = {name}::Solutions::new();\n                \
             {name}::solve(&pose, x[12..].try_into().unwrap(), &mut found);\n                \
             #[allow(unused_mut)]\n                \
             let mut rows: Vec<Vec<f64>> = found.as_slice().iter().map(|v| v.to_vec()).collect();\n{families}                \
             rows\n            }}"
        );
    }
    let library = format!("#![cfg_attr(not(test), no_std)]\n{modules}");
    let program = format!(
        "fn main() {{\n    for line in std::io::stdin().lines() {{\n        let line = line.unwrap();\n        \
         let mut words = line.split_whitespace();\n        let name = words.next().unwrap();\n        \
         let x: Vec<f64> = words.map(|w| f64::from_bits(u64::from_str_radix(w, 16).unwrap())).collect();\n        \
         let found = match name {{\n{arms}            _ => panic!(),\n        }};\n        \
         println!(\"{{}}\", found.len());\n        for v in found {{\n            \
         let bits: Vec<String> = v.iter().map(|x| format!(\"{{:016x}}\", x.to_bits())).collect();\n            \
         println!(\"{{}}\", bits.join(\" \"));\n        }}\n    }}\n}}\n{modules}"
    );
    std::fs::write(folder.join("main.rs"), program).unwrap();
    rustc(folder, &["main.rs", "-o", flavour, "-Copt-level=1"]);
    if !std {
        std::fs::write(folder.join("lib.rs"), library).unwrap();
        rustc(folder, &["lib.rs", "--crate-type=lib", "--emit=metadata"]);
        rustc(folder, &["lib.rs", "--test", "-o", "own_tests", "-Copt-level=1"]);
        let tests = Command::new(folder.join("own_tests")).output().unwrap();
        assert!(tests.status.success(), "{}", String::from_utf8_lossy(&tests.stdout));
        for target in bare_metal() {
            rustc(folder, &["lib.rs", "--crate-type=lib", "--emit=obj", "-o", "bare.o", "--target", &target]);
        }
    }
}

/// Installed targets without an operating system.
fn bare_metal() -> Vec<String> {
    let output = Command::new(rustc_path()).args(["--print", "sysroot"]).output().unwrap();
    let sysroot = String::from_utf8(output.stdout).unwrap();
    let targets = std::fs::read_dir(Path::new(sysroot.trim()).join("lib/rustlib"));
    let names = targets.into_iter().flatten().flatten().map(|e| e.file_name().to_string_lossy().into_owned());
    names.filter(|name| name.contains("-none")).collect()
}

fn rustc_path() -> String {
    std::env::var("RUSTC").unwrap_or_else(|_| "rustc".into())
}

fn rustc(folder: &Path, arguments: &[&str]) {
    let output = Command::new(rustc_path())
        .current_dir(folder)
        .args(["--edition=2024", "-Dwarnings", "--color=never"])
        .args(arguments)
        .output()
        .expect("rustc runs where the tests were compiled");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

const C_MAIN: &str = r#"
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

static int numbers(double *out)
{
    int n = 0;
    uint64_t bits;
    while (scanf("%" SCNx64, &bits) == 1) {
        memcpy(&out[n++], &bits, sizeof bits);
        if (getchar() == '\n') break;
    }
    return n;
}

/* Values, and the two ends of an interval, if any. */
static void show(const double *values, int n, const double *interval)
{
    int i;
    uint64_t bits;
    for (i = 0; i < n + (interval ? 2 : 0); i++) {
        memcpy(&bits, i < n ? &values[i] : &interval[i - n], sizeof bits);
        printf("%016" PRIx64 " ", bits);
    }
    printf("\n");
}

int main(void)
{
    char name[64];
    double x[32];
    while (scanf("%63s", name) == 1) {
        numbers(x);
        ARMS
    }
    return 0;
}
"#;

/// Answers, then the families of each.
const C_ARM: &str = r#"
        if (!strcmp(name, "NAME")) {
            NAME_frame pose;
            NAME_solutions found;
            NAME_family families[UPPER_CAPACITY][UPPER_VARIABLES];
            int i, k, counts[UPPER_CAPACITY], count;
            memcpy(pose.rotation, x, sizeof pose.rotation);
            memcpy(pose.position, x + 9, sizeof pose.position);
            count = NAME_solve(&pose, x + 12, &found);
            for (i = 0; i < found.count; i++) count += counts[i] = NAME_families(&pose, found.values[i], families[i]);
            printf("%d\n", count);
            for (i = 0; i < found.count; i++) show(found.values[i], UPPER_VARIABLES, NULL);
            for (i = 0; i < found.count; i++)
                for (k = 0; k < counts[i]; k++) show(families[i][k].direction, UPPER_VARIABLES, families[i][k].interval);
        }"#;

/// Of a part of a pose only answers.
const C_PART: &str = r#"
        if (!strcmp(name, "NAME")) {
            NAME_frame pose;
            NAME_solutions found;
            int i;
            memcpy(pose.rotation, x, sizeof pose.rotation);
            memcpy(pose.position, x + 9, sizeof pose.position);
            NAME_solve(&pose, x + 12, &found);
            printf("%d\n", found.count);
            for (i = 0; i < found.count; i++) show(found.values[i], UPPER_VARIABLES, NULL);
        }"#;

/// Compiles all solvers as C into a program; `false` without a compiler.
fn c_program(folder: &Path, compiled: &[Compiled]) -> bool {
    let compilers = ["cc", "c++"];
    if compilers.iter().any(|c| Command::new(c).arg("--version").output().is_err()) {
        return false;
    }
    let (mut names, mut main, mut arms) = (Vec::new(), String::new(), String::new());
    let strict = ["-Wall", "-Wextra", "-Werror", "-pedantic", "-ffp-contract=off", "-O1"];
    for c in compiled {
        let name = c.chain().name.clone();
        let source = c.c_source(&name, &COptions::default()).unwrap();
        std::fs::write(folder.join(format!("{name}.h")), source.header).unwrap();
        std::fs::write(folder.join(format!("{name}.c")), source.source).unwrap();
        let _ = writeln!(main, "#include \"{name}.h\"");
        let arm = if c.program.goal == GoalType::default() { C_ARM } else { C_PART };
        arms += &arm.replace("NAME", &name).replace("UPPER", &name.to_uppercase());
        let file = format!("{name}.c");
        let object = format!("{name}.o");
        run(folder, "cc", &[&strict[..], &["-std=c99", "-c", &file, "-o", &object]].concat());
        names.push(name);
    }
    // One of each kind without the C library's functions, and as C++.
    for name in ["kr6", "skew", "scara", "xarm6", "crx10"] {
        let file = format!("{name}.c");
        let flags = ["-std=c99", "-DIK_FREESTANDING", "-c", &file, "-o", "freestanding.o"];
        run(folder, "cc", &[&strict[..], &flags].concat());
        let flags = ["-std=c++11", "-x", "c++", "-c", &file, "-o", "cpp.o"];
        run(folder, "c++", &[&strict[..], &flags].concat());
    }
    std::fs::write(folder.join("main.c"), main + &C_MAIN.replace("ARMS", &arms)).unwrap();
    let objects: Vec<String> = names.iter().map(|n| format!("{n}.o")).collect();
    let objects: Vec<&str> = objects.iter().map(String::as_str).collect();
    run(folder, "cc", &[&strict[..], &["-std=c99", "main.c", "-o", "main_c"], &objects, &["-lm"]].concat());
    true
}

fn run(folder: &Path, compiler: &str, arguments: &[&str]) {
    let output = Command::new(compiler).current_dir(folder).args(arguments).output().unwrap();
    assert!(output.status.success(), "{compiler} {arguments:?}\n{}", String::from_utf8_lossy(&output.stderr));
}

#[test]
fn generated_sources_are_as_recorded() {
    let compiled = compile(&arms::kr6(), &Options::default()).unwrap();
    // They are what the example is made of.
    let example = |file: &str| format!("../../../../examples/drop_in_ik/{file}");
    golden::check(&example("src/kr6.rs"), &compiled.rust_source(&RustOptions::default()));
    let c = compiled.c_source("kr6", &COptions::default()).unwrap();
    golden::check(&example("cpp/kr6.h"), &c.header);
    golden::check(&example("cpp/kr6.c"), &c.source);
    assert!(matches!(compiled.c_source("kr-6", &COptions::default()), Err(CError::Name(_))));
}

#[test]
fn generated_c_is_used_from_c_plus_plus() {
    if ["cc", "c++"].iter().any(|c| Command::new(c).arg("--version").output().is_err()) {
        println!("skipped: no C or C++ compiler");
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let example = golden::folder().join("../../../../examples/drop_in_ik/cpp");
    let file = |name: &str| example.join(name).display().to_string();
    let strict = ["-Wall", "-Wextra", "-Werror", "-pedantic", "-O1"];
    let source = file("kr6.c");
    let flags = ["-std=c99", "-ffp-contract=off", "-c", &source, "-o", "kr6.o"];
    run(folder.path(), "cc", &[&strict[..], &flags].concat());
    let source = file("main.cpp");
    let flags = ["-std=c++11", &source, "kr6.o", "-lm", "-o", "reach"];
    run(folder.path(), "c++", &[&strict[..], &flags].concat());
    let output = Command::new(folder.path().join("reach")).output().unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    let last = "8 solutions, all reach the pose\n4 members of families at a singular pose\n";
    assert!(output.status.success() && text.ends_with(last), "{text}");
}

/// Generated sources find every branch of calibrated arms, whose constants they are given, Rust and C the same bits.
#[test]
fn generated_sources_solve_calibrated_arms() {
    let folder = tempfile::tempdir().unwrap();
    for chain in [arms::kr6(), arms::panda(), arms::xarm6()] {
        let compiled = compile(&chain, &Options::default()).unwrap();
        let mut rng = Seed::new(9).rng();
        let mut corpus = String::new();
        let mut vectors = Vec::new();
        for _ in 0..4 {
            let measured = arms::calibrated(chain.clone(), &mut rng);
            let constants = TrueChain::new(&measured).unwrap().constants();
            for _ in 0..50 {
                let vector = poses::random(&measured, &mut rng);
                let pose = measured.forward(&vector);
                let r = pose.rotation.to_rotation_matrix();
                let rows = (0..9).map(|i| r[(i / 3, i % 3)]);
                let numbers =
                    constants.iter().copied().chain(rows).chain(pose.translation.vector.iter().copied());
                let given = compiled.free.iter().map(|v| vector[*v]);
                let words: Vec<String> =
                    numbers.chain(given).map(|x| format!("{:016x}", x.to_bits())).collect();
                corpus += &(words.join(" ") + "\n");
                vectors.push(vector);
            }
        }
        std::fs::write(folder.path().join("corpus"), corpus).unwrap();
        let options = RustOptions { calibrated: true, ..RustOptions::default() };
        let source = compiled.rust_source(&options);
        assert!(source.len() < 100_000, "{}: {} bytes", chain.name, source.len());
        std::fs::write(folder.path().join("solver.rs"), source).unwrap();
        std::fs::write(folder.path().join("measured.rs"), RUST_ON).unwrap();
        rustc(folder.path(), &["measured.rs", "-o", "measured_rust", "-Copt-level=1"]);
        let found = answers(Command::new(folder.path().join("measured_rust")), folder.path());
        for (vector, answers) in vectors.iter().zip(&found) {
            let same = |answer: &Vec<f64>| check::same(answer, vector, &vec![false; vector.len()], 1e-6);
            assert!(answers.iter().any(same), "{}: {vector:?} {answers:?}", chain.name);
        }
        if ["cc", "c++"].iter().any(|c| Command::new(c).arg("--version").output().is_err()) {
            println!("skipped: no C compiler");
            continue;
        }
        let source = compiled.c_source("solver", &COptions { calibrated: true }).unwrap();
        std::fs::write(folder.path().join("solver.h"), source.header).unwrap();
        std::fs::write(folder.path().join("solver.c"), source.source).unwrap();
        std::fs::write(folder.path().join("measured.c"), C_ON).unwrap();
        let strict = ["-Wall", "-Wextra", "-Werror", "-pedantic", "-ffp-contract=off", "-O1", "-std=c99"];
        let files = ["solver.c", "measured.c", "-o", "measured_c", "-lm"];
        run(folder.path(), "cc", &[&strict[..], &files].concat());
        let by_c = answers(Command::new(folder.path().join("measured_c")), folder.path());
        same_bits("C", &std::fs::read_to_string(folder.path().join("corpus")).unwrap(), &found, &by_c);
    }
}

/// Of each joint frame and of the tip rotation and position, then the pose, then what is given.
const RUST_ON: &str = r#"
mod solver;
use solver::*;

fn main() {
    for line in std::io::stdin().lines() {
        let line = line.unwrap();
        let x: Vec<f64> = line.split_whitespace().map(|w| f64::from_bits(u64::from_str_radix(w, 16).unwrap())).collect();
        let frame = |k: usize| {
            let at = |i: usize| [x[12 * k + i], x[12 * k + i + 1], x[12 * k + i + 2]];
            Frame { rotation: [at(0), at(3), at(6)], position: at(9) }
        };
        let mut chain = DESCRIBED;
        let joints = chain.links.len();
        for (k, link) in chain.links.iter_mut().enumerate() {
            link.previous_from_joint = frame(k);
        }
        chain.last_from_tip = frame(joints);
        let mut found = Solutions::new();
        solve_on(&chain, &frame(joints + 1), x[12 * (joints + 2)..].try_into().unwrap(), &mut found);
        println!("{}", found.as_slice().len());
        for values in found.as_slice() {
            let bits: Vec<String> = values.iter().map(|x| format!("{:016x}", x.to_bits())).collect();
            println!("{}", bits.join(" "));
        }
    }
}
"#;

const C_ON: &str = r#"
#include <inttypes.h>
#include <stdio.h>
#include <string.h>
#include "solver.h"

#define NUMBERS (12 * (SOLVER_LINKS + 2) + SOLVER_GIVEN)

int main(void)
{
    uint64_t bits;
    double x[NUMBERS + 1];
    int n = 0, i, k;
    while (scanf("%" SCNx64, &bits) == 1) {
        solver_chain chain = solver_described;
        solver_frame pose;
        solver_solutions found;
        memcpy(&x[n++], &bits, sizeof bits);
        if (n < NUMBERS) continue;
        n = 0;
        for (i = 0; i < SOLVER_LINKS; i++) memcpy(&chain.links[i].previous_from_joint, x + 12 * i, sizeof pose);
        memcpy(&chain.last_from_tip, x + 12 * SOLVER_LINKS, sizeof pose);
        memcpy(&pose, x + 12 * (SOLVER_LINKS + 1), sizeof pose);
        solver_solve_on(&chain, &pose, x + 12 * (SOLVER_LINKS + 2), &found);
        printf("%d\n", found.count);
        for (i = 0; i < found.count; i++) {
            for (k = 0; k < SOLVER_VARIABLES; k++) {
                memcpy(&bits, &found.values[i][k], sizeof bits);
                printf("%016" PRIx64 " ", bits);
            }
            printf("\n");
        }
    }
    return 0;
}
"#;
