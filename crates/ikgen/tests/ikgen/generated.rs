//! Generated Rust, compiled by the real compiler with warnings denied, against the bytecode.

use std::fmt::Write as _;
use std::path::Path;
use std::process::Command;

use robotc_core::Seed;
use robotc_core::ik::{IkSolutions, InverseKinematics};
use robotc_ikgen::backend::RustOptions;
use robotc_ikgen::report::poses;
use robotc_ikgen::{Compiled, Options, compile};

use crate::{arms, golden};

#[test]
fn generated_rust_gives_the_same_solutions() {
    let folder = tempfile::tempdir().unwrap();
    let compiled: Vec<Compiled> =
        arms::all().iter().map(|c| compile(c, &Options::default()).unwrap()).collect();

    // Without std: a library that must build for `core` alone.
    let mut library = String::from("#![no_std]\n");
    let mut program = String::from(
        "use std::io::Write as _;\n\nfn main() {\n    let mut out = std::io::stdout().lock();\n",
    );
    let mut modules = String::new();
    let mut expected = String::new();
    for c in &compiled {
        let name = &c.chain().name;
        let core = c.rust_source(&RustOptions { std: false });
        let std = c.rust_source(&RustOptions { std: true });
        let most = if c.class.contains("general,") { 100_000 } else { 50_000 };
        assert!(core.len() < most, "{name}: {} bytes", core.len());
        std::fs::write(folder.path().join(format!("{name}.rs")), core).unwrap();
        std::fs::write(folder.path().join(format!("{name}_std.rs")), std).unwrap();
        let _ = writeln!(library, "pub mod {name};");
        let _ = writeln!(modules, "mod {name}_std;");
        trials(c, &mut program, &mut expected);
    }
    program += "}\n\n";
    std::fs::write(folder.path().join("lib.rs"), library).unwrap();
    std::fs::write(folder.path().join("main.rs"), program + &modules).unwrap();
    rustc(folder.path(), &["lib.rs", "--crate-type=lib", "--emit=metadata"]);
    rustc(folder.path(), &["main.rs", "-o", "main", "-Copt-level=1"]);
    let run = Command::new(folder.path().join("main")).output().unwrap();
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    let found = String::from_utf8(run.stdout).unwrap();
    for (i, (found, expected)) in found.lines().zip(expected.lines()).enumerate() {
        assert_eq!(found, expected, "line {i}");
    }
    assert_eq!(found.lines().count(), expected.lines().count());
}

/// Calls on the poses of all sets, and what the bytecode answers.
fn trials(c: &Compiled, program: &mut String, expected: &mut String) {
    let chain = c.chain();
    let solver = c.solver();
    let mut out = IkSolutions::new();
    let name = &chain.name;
    let _ = writeln!(
        program,
        "    let mut s = {name}_std::Solutions::new();\n    for (rotation, position, free) in ["
    );
    for set in poses::sets(chain, &c.free, 12, Seed::new(9)) {
        for vector in &set.vectors {
            let pose = chain.forward(vector);
            let free: Vec<f64> = c.free.iter().map(|v| vector[*v]).collect();
            let m = pose.rotation.to_rotation_matrix();
            let rows: Vec<[f64; 3]> = (0..3).map(|i| [m[(i, 0)], m[(i, 1)], m[(i, 2)]]).collect();
            let position: [f64; 3] = pose.translation.vector.into();
            let _ = writeln!(program, "        ({rows:?}, {position:?}, {free:?} as [f64; {}]),", free.len());
            solver.solve(&pose, &free, &mut out);
            for values in out.iter().take(16) {
                let bits: Vec<String> = values.iter().map(|x| format!("{:016x}", x.to_bits())).collect();
                let _ = writeln!(expected, "{name} {}", bits.join(" "));
            }
            let _ = writeln!(expected, "{name} {}", out.len().min(16));
        }
    }
    let _ = writeln!(
        program,
        "    ] {{\n        {name}_std::solve(&{name}_std::Frame {{ rotation, position }}, &free, &mut s);\n        \
         for v in s.as_slice() {{\n            let bits: Vec<String> = v.iter().map(|x| format!(\"{{:016x}}\", x.to_bits())).collect();\n            \
         writeln!(out, \"{name} {{}}\", bits.join(\" \")).unwrap();\n        }}\n        \
         writeln!(out, \"{name} {{}}\", s.as_slice().len()).unwrap();\n    }}"
    );
}

fn rustc(folder: &Path, arguments: &[&str]) {
    let rustc = std::env::var("RUSTC").unwrap_or_else(|_| "rustc".into());
    let output = Command::new(rustc)
        .current_dir(folder)
        .args(["--edition=2024", "-Dwarnings", "--color=never"])
        .args(arguments)
        .output()
        .expect("rustc runs where the tests were compiled");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

#[test]
fn generated_rust_is_as_recorded() {
    let compiled = compile(&arms::kr6(), &Options::default()).unwrap();
    golden::check("generated/kr6.rs", &compiled.rust_source(&RustOptions::default()));
}
