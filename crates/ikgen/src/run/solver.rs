//! The solver that the rest of the project uses: a loaded program, the true chain, and the check between them.

use robotc_core::Pose;
use robotc_core::ik::{IkSolutions, InverseKinematics, PreferenceError, Preferences, VariableRange};
use robotc_core::model::SerialChain;

use super::general::General;
use super::{Bytecode, Candidate, TooLarge, TrueChain, Verdict, frame, interpreter};
use crate::ir::{Program, TextError};
use crate::kernel::candidate::{MOST_MISSES, WIDER, is_exact};
use crate::kernel::chain::{Frame, MAX_JOINTS, TOLERANCE};

/// What runs the program.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Engine {
    /// The bytecode.
    #[default]
    Bytecode,
    /// The reference interpreter: slow, for comparison.
    Interpreter,
}

/// Why a program does not make a solver for a chain.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum LoadError {
    /// The text is not a program.
    #[error("not a solution program: {0}")]
    Text(#[from] TextError),
    /// The program is too large for the bytecode.
    #[error(transparent)]
    Large(#[from] TooLarge),
    /// The chain has another number of variables than the program.
    #[error("the program is for {program} variables, the chain has {chain}")]
    Variables {
        /// Variables of the program.
        program: usize,
        /// Variables of the chain.
        chain: usize,
    },
    /// The chain has too many joints.
    #[error("the chain has {0} joints, at most {MAX_JOINTS} are supported")]
    Joints(usize),
}

/// An inverse-kinematics solver for one chain.
///
/// The program was made for the ideal chain; the described (or calibrated) one is given at load, and every solution
/// is checked against it, after a polish where the two differ.
#[derive(Debug, Clone)]
pub struct Solver {
    pub(super) program: Program,
    pub(super) code: Bytecode,
    pub(super) chain: TrueChain,
    pub(super) engine: Engine,
    pub(super) held: [bool; MAX_JOINTS],
    pub(super) ranges: Vec<VariableRange>,
    /// Smallest values of the joints that the goal type adds.
    least: [f64; MAX_JOINTS],
    /// Asked besides, where the chain is not the one that the program was written for.
    pub(super) general: Option<General>,
}

/// A chain is another than the one that a program was written for where candidates miss it by more than this, and than so many times
/// what the ideal chain of the program is off.
const OTHER: (f64, f64) = (1e-7, 100.0);

impl Solver {
    /// A solver from a program and the chain it is to run on.
    ///
    /// If that is another one than the program was written for, a calibrated one, and six of its joints turn and are not given, the
    /// general solver of six joints is asked too, on the chain as it is.
    pub fn new(program: Program, chain: &SerialChain) -> Result<Self, LoadError> {
        let longer = program.goal.extended(chain);
        let mut solver = Self::of_longer(program, &longer)?;
        if solver.program.goal == crate::GoalType::default() && solver.is_other_chain() {
            solver.general = General::new(&solver.chain, &solver.held);
        }
        Ok(solver)
    }

    /// The program alone, on a chain with the joints that the goal type adds.
    pub(crate) fn of_longer(program: Program, chain: &SerialChain) -> Result<Self, LoadError> {
        let true_chain = TrueChain::new(chain).ok_or(LoadError::Joints(chain.joints.len()))?;
        if true_chain.variables != program.variables {
            let (program, chain) = (program.variables, true_chain.variables);
            return Err(LoadError::Variables { program, chain });
        }
        let mut held = [false; MAX_JOINTS];
        for v in &program.free {
            held[*v] = true;
        }
        let joints = program.chain_variables();
        let mut least = [f64::NEG_INFINITY; MAX_JOINTS];
        least[joints..program.variables].copy_from_slice(&program.goal.least());
        let solver = Self {
            code: Bytecode::for_chain(&program, &true_chain)?,
            program,
            chain: true_chain,
            engine: Engine::Bytecode,
            held,
            ranges: VariableRange::of(chain)[..joints].to_vec(),
            least,
            general: None,
        };
        Ok(solver)
    }

    /// Whether the program was written for another chain than that of this solver: its candidates for some poses all miss.
    fn is_other_chain(&self) -> bool {
        let (all, limit) = (self.program.variables, OTHER.0.max(OTHER.1 * self.program.snap));
        let arm = self.chain.arm(&self.held[..all]);
        let mut rng = robotc_core::Seed::new(0).split("ikgen other chain").rng();
        let mut misses = || {
            let values: [f64; MAX_JOINTS] = std::array::from_fn(|_| rng.range(-1.5, 1.5));
            let pose = arm.forward_values(&values[..all]);
            let free: Vec<f64> = self.program.free.iter().map(|v| values[*v]).collect();
            let mut least = f64::INFINITY;
            self.code.run(&pose, &free, self.program.slack, &mut |candidate: &Candidate| {
                least = least.min(arm.forward_steps(&candidate.steps[..all]).distance(&pose));
                Verdict::Wrong
            });
            least > limit
        };
        (0..4).filter(|_| misses()).count() > 2
    }

    /// A solver from the text form of a program, as the knowledge base stores it.
    pub fn from_text(text: &str, chain: &SerialChain) -> Result<Self, LoadError> {
        Self::new(Program::from_text(text)?, chain)
    }

    /// The same solver run by another engine.
    pub fn with_engine(mut self, engine: Engine) -> Self {
        self.engine = engine;
        self
    }

    /// The program.
    pub fn program(&self) -> &Program {
        &self.program
    }

    /// Number of instructions of the bytecode.
    pub fn instructions(&self) -> usize {
        self.code.instructions()
    }

    /// What values the variables may take, as described.
    pub fn ranges(&self) -> &[VariableRange] {
        &self.ranges
    }

    /// The solutions for a pose that are wanted, in the wanted order: within limits, nearest to a seed first, no more than so many.
    /// Otherwise as [`solve`](InverseKinematics::solve). Where solutions are a continuum whose representative is outside of the limits,
    /// a member inside of them is returned; with a seed also the member nearest to it.
    pub fn solve_preferred(
        &self,
        base_from_tip: &Pose,
        free: &[f64],
        preferences: &Preferences,
        out: &mut IkSolutions,
    ) -> Result<(), PreferenceError> {
        let ranges = preferences.ranges(&self.ranges)?;
        out.reset(self.ranges.len());
        let mut all = IkSolutions::new();
        self.solve_until(base_from_tip, free, &mut all, &mut |solution| {
            let kept = preferences.offer(&ranges, solution, out);
            // Where axes have lined up another member of the family may do what the representative does not.
            if (!kept || preferences.near.is_some())
                && self.is_singular(base_from_tip, solution)
                && let Some(member) = self.member_within(base_from_tip, solution, &ranges, preferences)
            {
                preferences.offer(&ranges, &member, out);
            }
            preferences.is_enough(out)
        });
        preferences.finish(&ranges, out);
        Ok(())
    }

    /// Solutions until `enough` says so of a new one.
    fn solve_until(
        &self,
        base_from_tip: &Pose,
        free: &[f64],
        out: &mut IkSolutions,
        enough: &mut impl FnMut(&[f64]) -> bool,
    ) {
        assert_eq!(free.len(), self.program.free.len(), "one value for each free variable");
        out.reset(self.ranges.len());
        let frame = frame(base_from_tip);
        let mut numbers = frame.position.iter().chain(frame.rotation.iter().flatten()).chain(free);
        if !numbers.all(|x| x.is_finite()) {
            return;
        }
        if self.attempt(&frame, free, self.program.slack, out, enough) == 0 {
            self.look_wider(&frame, free, out, enough);
        }
    }

    /// Solutions of a pose that has none at the program's own slack.
    pub(super) fn look_wider(
        &self,
        base_from_tip: &Frame,
        free: &[f64],
        out: &mut IkSolutions,
        enough: &mut impl FnMut(&[f64]) -> bool,
    ) {
        let wider = WIDER.into_iter().filter(|wider| *wider > self.program.slack);
        for slack in wider {
            if self.attempt(base_from_tip, free, slack, out, enough) > 0 {
                return;
            }
        }
    }

    /// Whether the joints that the goal type adds have values that are meant.
    pub(super) fn is_in_front(&self, values: &[f64]) -> bool {
        (self.ranges.len()..values.len()).all(|v| values[v] >= self.least[v] - TOLERANCE)
    }

    pub(super) fn attempt(
        &self,
        base_from_tip: &Frame,
        free: &[f64],
        slack: f64,
        out: &mut IkSolutions,
        enough: &mut impl FnMut(&[f64]) -> bool,
    ) -> usize {
        let (n, all) = (self.ranges.len(), self.program.variables);
        let arm = self.chain.arm(&self.held[..all]);
        let misses = std::cell::Cell::new(0);
        let looks = || misses.get() < MOST_MISSES;
        // Keeps a candidate if it is right and new.
        let mut keep = |right: bool, values: &[f64]| {
            if !right || !self.is_in_front(values) {
                misses.set(misses.get() + 1);
                return Verdict::Wrong;
            }
            let values = &values[..n];
            if out.iter().any(|other| arm.same(values, other)) {
                return Verdict::Accepted;
            }
            out.push(values);
            if enough(values) { Verdict::Last } else { Verdict::Accepted }
        };
        let mut accepted = match self.engine {
            Engine::Bytecode => self.code.run(base_from_tip, free, slack, &mut |candidate: &Candidate| {
                let mut values = candidate.values;
                let right = looks()
                    && (is_exact(candidate.misses)
                        || arm.settle(base_from_tip, &candidate.steps[..all], &mut values[..all]));
                keep(right, &values[..all])
            }),
            Engine::Interpreter => {
                interpreter::run(&self.program, base_from_tip, free, slack, &mut |steps| {
                    let mut values = [0.0; MAX_JOINTS];
                    for (variable, value) in self.program.free.iter().zip(free) {
                        values[*variable] = *value;
                    }
                    let right = looks() && arm.settle(base_from_tip, steps, &mut values[..all]);
                    keep(right, &values[..all])
                })
            }
        };
        if let Some(general) = self.general.as_ref().filter(|_| slack == self.program.slack) {
            let mut given = [0.0; MAX_JOINTS];
            for (variable, value) in self.program.free.iter().zip(free) {
                given[*variable] = *value;
            }
            general.candidates(&arm, base_from_tip, &given[..all], |steps| {
                let mut values = given;
                let right = arm.settle(base_from_tip, steps, &mut values[..all]);
                let verdict = keep(right, &values[..all]);
                accepted += usize::from(verdict != Verdict::Wrong);
                verdict != Verdict::Last
            });
        }
        accepted
    }
}

impl InverseKinematics for Solver {
    fn variables(&self) -> usize {
        self.ranges.len()
    }

    fn free_variables(&self) -> &[usize] {
        &self.program.free
    }

    fn solve(&self, base_from_tip: &Pose, free: &[f64], out: &mut IkSolutions) {
        self.solve_until(base_from_tip, free, out, &mut |_| false);
    }
}
