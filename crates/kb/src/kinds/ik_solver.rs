//! The solution program of an arm's inverse kinematics.

use robotc_core::DofIdx;
use robotc_core::model::ChainError;
use robotc_ikgen::Program;

use crate::graph::{PlanError, Planner};
use crate::kind::{DecodeError, Kind, Portability};
use crate::project::OfArm;
use crate::projection::{Limits, Mechanism};
use crate::record::Parts;

/// The kind; its artefact is a [`Program`], stored as its text.
///
/// Only the chain of the arm is read, without limits and without the tool: a longer gripper or a narrower joint rebuilds
/// nothing. The program is for the chain as described; a calibrated one is given when the solver is made.
pub struct IkSolver;

crate::parameters! {
    /// Parameters of [`IkSolver`].
    pub struct IkParameters {
        /// Largest difference between the described chain and an ideal one that may be solved in its place; solutions are
        /// always polished on the described chain. Radians and metres.
        tolerance: f64 ["m"] in 0.0..=0.05 = 0.002;
        /// Random poses on which a program must prove itself.
        trial_poses: u32 [""] in 1..=100000 = 60;
    }
}

/// The chain of an arm.
pub struct Arm {
    chain: Mechanism,
    /// Positions, among the variables of the chain, of those that the caller gives; `None`: the compiler chooses.
    free: Option<Vec<usize>>,
}

impl Kind for IkSolver {
    const NAME: &'static str = "ik_solver";
    const FORMAT: u32 = 1;
    const ALGORITHM: u32 = 7;
    const PORTABILITY: Portability = Portability::Portable;
    const DOC: &'static str = "The program that finds all joint values of an arm for a pose of its tip. Planning and the maps call it.";

    type Subject = OfArm;
    type Inputs = Arm;
    type Parameters = IkParameters;
    type Artefact = Program;

    fn inputs(planner: &mut Planner<'_>, subject: &OfArm) -> Result<Arm, PlanError> {
        let robot = planner.project().robot();
        let arm = &robot.arms[subject.0];
        let chain = Mechanism::chain(&robot.model, arm.base, arm.tip, Limits::Dropped)?;
        let position = |dof: &DofIdx| {
            arm.dofs.iter().position(|d| d == dof).ok_or_else(|| ChainError::NotBelow {
                base: robot.model.dofs()[*dof].name.clone(),
                tip: robot.model.links()[arm.tip].name.clone(),
            })
        };
        let free = arm.free.as_ref().map(|free| free.iter().map(position).collect::<Result<_, _>>());
        Ok(Arm { chain, free: free.transpose()? })
    }

    fn key_parts(inputs: &Arm, parts: &mut Parts) {
        let Arm { chain, free } = inputs;
        chain.key_parts(parts);
        parts.add("free joints", "", free);
    }

    fn defaults(_inputs: &Arm) -> IkParameters {
        IkParameters::constants()
    }

    fn encode(artefact: &Program) -> Vec<u8> {
        artefact.text().into_bytes()
    }

    fn decode(bytes: &[u8]) -> Result<Program, DecodeError> {
        let text = std::str::from_utf8(bytes).map_err(|_| DecodeError::new("not text"))?;
        let program = Program::from_text(text).map_err(|error| DecodeError::new(error.to_string()))?;
        if program.text() != text {
            return Err(DecodeError::new("not in the form that programs are printed in"));
        }
        Ok(program)
    }

    fn summary(artefact: &Program) -> String {
        artefact.class.clone()
    }
}

#[cfg(feature = "build")]
mod build {
    use robotc_core::ik::{IkSolutions, InverseKinematics as _};
    use robotc_core::{Configuration, Kinematics, SerialChain};
    use robotc_ikgen::{Options, Solver};

    use super::*;
    use crate::kind::{Build, BuildError, Context};

    impl Build for IkSolver {
        fn build(
            inputs: &Arm,
            parameters: &IkParameters,
            _context: &Context<'_>,
        ) -> Result<Program, BuildError> {
            let chain = chain(&inputs.chain).map_err(|error| BuildError::Impossible(error.to_string()))?;
            let options = Options {
                tolerance: parameters.tolerance,
                free: inputs.free.clone(),
                trial_poses: parameters.trial_poses as usize,
                ..Options::default()
            };
            let compiled = robotc_ikgen::compile(&chain, &options);
            compiled.map(|c| c.program).map_err(|refusal| BuildError::Impossible(refusal.reason))
        }

        /// Every solution reaches its pose by the forward kinematics of the model, and the configuration that a pose
        /// was made from is found again.
        fn check(
            artefact: &Program,
            inputs: &Arm,
            _parameters: &IkParameters,
            context: &Context<'_>,
        ) -> Result<(), BuildError> {
            const POSES: usize = 100;
            /// Poses that may be found by another branch only: near a singularity two solutions become one.
            const EXCUSED: usize = 2;
            let wrong = |text: String| Err(BuildError::Check(text));
            let chain = chain(&inputs.chain).map_err(|error| BuildError::Impossible(error.to_string()))?;
            let solver =
                Solver::new(artefact.clone(), &chain).map_err(|e| BuildError::Check(e.to_string()))?;
            let kinematics = Kinematics::new(inputs.chain.model().clone());
            let forward = |q: &[f64]| {
                kinematics.root_from_link(&Configuration::from_values(q.to_vec()), inputs.chain.tip())
            };
            let mut rng = context.seed().split("check").rng();
            let mut out = IkSolutions::new();
            let mut recovered = 0;
            for _ in 0..POSES {
                let q: Vec<f64> = (0..solver.variables()).map(|_| rng.range(-1.5, 1.5)).collect();
                let base_from_tip = forward(&q);
                let free: Vec<f64> = solver.free_variables().iter().map(|&v| q[v]).collect();
                solver.solve(&base_from_tip, &free, &mut out);
                for solution in out.iter() {
                    let miss = forward(solution).to_homogeneous() - base_from_tip.to_homogeneous();
                    if miss.norm() > 1e-8 {
                        return wrong(format!(
                            "a solution of the pose at {q:?} misses it by {}",
                            miss.norm()
                        ));
                    }
                }
                let turn = std::f64::consts::TAU;
                let near = |a: f64, b: f64| {
                    let d = (a - b).abs() % turn;
                    d.min(turn - d) < 1e-5
                };
                recovered += usize::from(out.iter().any(|s| s.iter().zip(&q).all(|(a, b)| near(*a, *b))));
            }
            if recovered + EXCUSED < POSES {
                return wrong(format!("only {recovered} of {POSES} configurations are found again"));
            }
            Ok(())
        }
    }

    /// The chain of an arm as its solver is made for.
    fn chain(mechanism: &Mechanism) -> Result<SerialChain, ChainError> {
        let kinematics = Kinematics::new(mechanism.model().clone());
        SerialChain::between(&kinematics, mechanism.model().root(), mechanism.tip())
    }
}
