//! Solution programs of inverse kinematics: text, passes, interpreter, bytecode and generated source.

use robotc_core::ids::Idx;
use robotc_core::model::{ChainJoint, ChainMotion, ChainVariable, SerialChain};
use robotc_core::{DofIdx, Pose};
use robotc_ikgen::backend::{RustOptions, rust_source};
use robotc_ikgen::ir::Program;
use robotc_ikgen::kernel::chain::Frame;
use robotc_ikgen::passes;
use robotc_ikgen::run::{Bytecode, Candidate, TrueChain, Verdict, interpreter};

/// Candidates that are compared between the engines.
const MOST_CANDIDATES: usize = 1000;

/// Any bytes as the text of a program: an error, or a program that prints as it reads, keeps valid under the passes, and
/// gives the same candidates by bytecode and by interpretation.
pub(crate) fn program(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    let Ok(program) = Program::from_text(text) else { return };
    let printed = program.text();
    let again = Program::from_text(&printed).expect("what was printed is read");
    assert_eq!(again.text(), printed);

    let best = passes::optimise(&program);
    assert_eq!(best.validate(), Ok(()));
    let chain = TrueChain::new(&stack(program.variables)).expect("a short chain");
    for program in [&program, &best] {
        assert!(!rust_source(program, &chain, &RustOptions::default()).is_empty());
        let Ok(code) = Bytecode::new(program) else { continue };
        let free = &FREE[..program.free.len()];
        let by_code = candidates(|offer| {
            let steps = |candidate: &Candidate| offer(&candidate.steps[..program.variables]);
            code.run(&POSE, free, program.slack, &mut { steps })
        });
        let by_text =
            candidates(|mut offer| interpreter::run(program, &POSE, free, program.slack, &mut offer));
        assert_eq!(by_code, by_text, "the engines differ");
    }
}

/// Where the programs are run: nothing special about it.
const POSE: Frame =
    Frame { rotation: [[0.0, -0.6, 0.8], [1.0, 0.0, 0.0], [0.0, 0.8, 0.6]], position: [0.4, -0.3, 0.5] };

const FREE: [f64; 9] = [0.1, -0.2, 0.3, -0.4, 0.5, -0.6, 0.7, -0.8, 0.9];

/// The first candidates that a run offers, as bits; every third is accepted.
fn candidates(run: impl FnOnce(&mut dyn FnMut(&[[f64; 2]]) -> Verdict) -> usize) -> Vec<Vec<[u64; 2]>> {
    let mut seen = Vec::new();
    let mut count = 0;
    run(&mut |steps: &[[f64; 2]]| {
        count += 1;
        if seen.len() < MOST_CANDIDATES {
            // A number that is none has many bit patterns, and which one comes out is left open.
            let bits = |x: f64| if x.is_nan() { u64::MAX } else { x.to_bits() };
            seen.push(steps.iter().map(|step| step.map(bits)).collect());
        }
        if count % 3 == 0 { Verdict::Accepted } else { Verdict::Wrong }
    });
    seen
}

/// A chain of this many turning joints, one above the other.
fn stack(variables: usize) -> SerialChain {
    let name = |i: usize| format!("j{i}");
    let dof = DofIdx::new;
    SerialChain {
        name: "stack".into(),
        joints: (0..variables)
            .map(|i| ChainJoint {
                name: name(i),
                motion: ChainMotion::Revolute,
                previous_from_joint: Pose::translation(0.0, 0.0, 0.1),
                axis: nalgebra::Vector3::z_axis(),
                variable: i,
                multiplier: 1.0,
                offset: 0.0,
            })
            .collect(),
        variables: (0..variables)
            .map(|i| ChainVariable { name: name(i), dof: dof(i), lower: -3.0, upper: 3.0 })
            .collect(),
        last_from_tip: Pose::identity(),
    }
}
