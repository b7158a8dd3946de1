//! The text form, the validator and the passes.

use proptest::prelude::*;
use robotc_ikgen::kernel::chain::Frame;
use robotc_ikgen::run::{Bytecode, Verdict, interpreter};
use robotc_ikgen::{Options, Program, compile, passes};

use crate::{arms, golden};

/// Each pass on `tests/golden/passes/NAME.in.ik`, compared with `NAME.out.ik`.
#[test]
fn passes_do_what_their_golden_files_show() {
    let passes: [(&str, fn(&Program) -> Program); 4] =
        [("fold", passes::fold), ("share", passes::share), ("hoist", passes::hoist), ("dead", passes::dead)];
    for (name, pass) in passes {
        let input = std::fs::read_to_string(golden::folder().join(format!("passes/{name}.in.ik"))).unwrap();
        let program = Program::from_text(&input).unwrap_or_else(|e| panic!("{name}: {e}"));
        let result = pass(&program);
        assert_eq!(result.validate(), Ok(()));
        golden::check(&format!("passes/{name}.out.ik"), &result.text());
        // Once is enough.
        assert_eq!(pass(&result).text(), result.text(), "{name} is not idempotent");
    }
}

#[test]
fn programs_of_all_classes_are_as_recorded_and_read_back() {
    for chain in arms::all() {
        let compiled = compile(&chain, &Options::default()).unwrap();
        let text = compiled.text();
        golden::check(&format!("programs/{}.ik", chain.name), &text);
        let read = Program::from_text(&text).unwrap();
        assert_eq!(read.text(), text, "{}", chain.name);
        let again = passes::optimise(&read).text();
        assert_eq!(again.lines().count(), text.lines().count(), "{} is not fully optimised", chain.name);
    }
}

#[test]
fn bad_programs_get_a_line_and_a_reason() {
    let program = |body: &str| {
        Program::from_text(&format!(
            "ikgen 1\nclass \"t\"\nvariables 1\nfree []\nsnap 0.0\nslack 0.0\n{{\n{body}\n}}\n"
        ))
        .map_err(|e| e.to_string())
    };
    assert!(program("emit angle(px, py)").is_ok());
    assert!(program("doubt(px, 0.1) rest { emit angle(px, py) }").is_ok());
    for (body, message) in [
        ("emit angle(px, q)", "line 8: q is not bound here"),
        ("let px = 1.0", "line 8: px already means something"),
        ("let a = 1.0 let a = 2.0", "line 8: a already means something"),
        (
            "circle(px, py) -> c s { emit angle(c, s) }",
            "line 0: circle has a wrong number of arguments or names",
        ),
        ("emit angle(px, py) angle(px, py)", "line 0: a solution has 2 values, the chain 1 variables"),
        ("emit angle(px, free0)", "line 0: free0 is not a free value of this program"),
        ("align(px, py) -> c s { } emit angle(c, s)", "line 0: s is used where it is not bound"),
        ("doubt(px, 0.1) zero(px, 0.1) { rest { } } else { }", "line 0: a rest stands in another statement"),
        ("solve(px)", "line 8: solve is not a statement"),
        ("emit angle(px, 1e999)", "line 8: 1e999 is not a number"),
        ("let a = (((px)", "line 9: expected ')'"),
        ("emit angle(px, $)", "line 8: unexpected character '$'"),
    ] {
        assert_eq!(program(body).err().as_deref(), Some(message), "{body}");
    }
    let deep = format!("let a = {}px{}", "(".repeat(5000), ")".repeat(5000));
    assert!(program(&deep).unwrap_err().contains("nested too deeply"));
    let long = format!("let a = px{}", " + px".repeat(100_000));
    assert!(program(&long).unwrap_err().contains("too many terms"));
    assert!(
        program("\n# a line\nlet a = \"two\nlines\"").unwrap_err().contains("line 10: a quote is not closed")
    );
}

/// Equations nested so deeply that their roots could not be followed in a lifetime: both engines give up at the same root.
#[test]
fn programs_that_would_run_forever_end() {
    let depth = 40;
    let open: String = (0..depth).map(|i| format!("align(0.0, 0.0) -> c{i} s{i} {{\n")).collect();
    let text = format!(
        "ikgen 1\nclass \"t\"\nvariables 1\nfree []\nsnap 0.0\nslack 0.0\n{{\n{open}emit angle(c0, s39)\n{}}}\n",
        "}\n".repeat(depth)
    );
    let program = Program::from_text(&text).unwrap();
    let pose = Frame { rotation: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], position: [0.0; 3] };
    let mut offered = [0, 0];
    Bytecode::new(&program).unwrap().run(&pose, &[], 0.0, &mut |_| {
        offered[0] += 1;
        Verdict::Wrong
    });
    interpreter::run(&program, &pose, &[], 0.0, &mut |_| {
        offered[1] += 1;
        Verdict::Wrong
    });
    assert!(offered[0] > 10_000 && offered[0] == offered[1], "{offered:?}");
}

proptest! {
    #![proptest_config(crate::properties::cases(200))]

    /// Whatever happens to a text, reading it ends in a program or an error.
    #[test]
    fn damaged_texts_never_panic(cut in 0usize..4000, insert in "[ -~]{0,6}", length in 0usize..40) {
        let text = std::fs::read_to_string(golden::folder().join("programs/ur5.ik")).unwrap();
        let start = cut.min(text.len());
        let end = (start + length).min(text.len());
        let damaged = format!("{}{insert}{}", &text[..start], &text[end..]);
        if let Ok(program) = Program::from_text(&damaged) {
            prop_assert_eq!(Program::from_text(&program.text()).unwrap().text(), program.text());
        }
    }
}
