//! The pipeline: chain, facts, strategies, program.

use robotc_core::Seed;
use robotc_core::ik::{IkSolutions, InverseKinematics as _};
use robotc_core::model::{ChainMotion, SerialChain};

use super::builder::Builder;
use super::complete::completions;
use super::facts::Facts;
use super::problem::Problem;
use super::strategies::{self, Strategy};
use crate::GoalType;
use crate::check;
use crate::ir::{Program, RootKind};
use crate::passes;
use crate::report::poses::{sets, slides};
use crate::run::Solver;

/// Snaps below this come from the digits of the description: they need a polish, but hide no roots.
const ROUNDING: f64 = 1e-8;

/// Constants of an ideal chain are written to this part of the snap.
const UNSEEN: f64 = 1e-3;

/// Tolerance within which a chain counts as solved just as it is described.
const EXACT: f64 = 1e-9;

/// A joint vector is lost when no answer is this near to it: a branch is missing. By chance some random poses are so near to a singular
/// one that rounding of the pose moves the answer by more than proofs allow.
const BRANCH: f64 = 1e-3;

/// How many times as many trial poses a program has to solve that is for a snapped chain, or solves six joints in general: what these
/// lose they lose rarely.
const RARELY: usize = 8;

/// Choices of a compilation.
#[derive(Debug, Clone, PartialEq)]
pub struct Options {
    /// What the solver will be asked for.
    pub goal: GoalType,
    /// Largest difference between the described chain and the ideal one that is solved: radians and metres. Smaller
    /// differences are tried first. Zero forbids snapping.
    pub tolerance: f64,
    /// Variables whose values the caller will give; `None` chooses: none for up to six variables, and of seven the one
    /// farthest from the base that leaves a chain that can be solved and moves well.
    pub free: Option<Vec<usize>>,
    /// Poses of each set on which a program is tried before it is returned.
    pub trial_poses: usize,
}

impl Default for Options {
    fn default() -> Self {
        Self { goal: GoalType::default(), tolerance: 2e-3, free: None, trial_poses: 60 }
    }
}

/// Why a chain was not solved.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{reason}")]
pub struct Refusal {
    /// In one line.
    pub reason: String,
    /// Everything that was tried, in order.
    pub trace: Vec<String>,
}

/// Everything that was tried, told while it happens.
struct Trace<'a> {
    lines: Vec<String>,
    watch: &'a dyn Fn(&str),
}

impl Trace<'_> {
    fn push(&mut self, line: String) {
        (self.watch)(&line);
        self.lines.push(line);
    }
}

/// A solved chain.
#[derive(Debug, Clone)]
pub struct Compiled {
    /// The solution program.
    pub program: Program,
    /// Class of the chain and how it is solved.
    pub class: String,
    /// Difference between the described chain and the ideal one that the program solves: radians and metres, the larger.
    pub snap: f64,
    /// Variables whose values the caller gives.
    pub free: Vec<usize>,
    /// Everything that was tried, in order.
    pub trace: Vec<String>,
    chain: SerialChain,
    /// With the joints that the goal type adds.
    longer: SerialChain,
}

impl Compiled {
    /// The program as text: what [`Solver::from_text`] loads.
    pub fn text(&self) -> String {
        self.program.text()
    }

    /// A solver for the chain that was compiled.
    pub fn solver(&self) -> Solver {
        Solver::of_longer(self.program.clone(), &self.longer).expect("the program ran during compilation")
    }

    /// The program as one Rust source file.
    pub fn rust_source(&self, options: &crate::backend::RustOptions) -> String {
        let chain = crate::run::TrueChain::new(&self.longer).expect("the chain was small enough to compile");
        crate::backend::rust_source(&self.program, &chain, options)
    }

    /// The program as C header and source; `name` is the prefix of what they export and the stem of the files.
    pub fn c_source(
        &self,
        name: &str,
        options: &crate::backend::COptions,
    ) -> Result<crate::backend::CSource, crate::backend::CError> {
        let chain = crate::run::TrueChain::new(&self.longer).expect("the chain was small enough to compile");
        crate::backend::c_source(&self.program, &chain, name, options)
    }

    /// The chain that was compiled.
    pub fn chain(&self) -> &SerialChain {
        &self.chain
    }

    /// The same with the joints that the goal type adds: its pose at any values of all of them is a goal that its own first values
    /// reach.
    pub fn longer_chain(&self) -> &SerialChain {
        &self.longer
    }
}

/// Finds a solution program for a chain.
///
/// The chain is solved as it is described if a strategy fits it exactly; otherwise relations between its axes that
/// hold within a growing tolerance are taken as meant. A program is returned only when it solves all of its trial poses.
pub fn compile(chain: &SerialChain, options: &Options) -> Result<Compiled, Refusal> {
    compile_watched(chain, options, &|_| {})
}

/// As [`compile`], with each line of the trace given to `watch` as soon as it is known: for callers who may not wait for the end.
pub fn compile_watched(
    chain: &SerialChain,
    options: &Options,
    watch: &dyn Fn(&str),
) -> Result<Compiled, Refusal> {
    let mut trace = Trace { lines: Vec::new(), watch };
    let longer = options.goal.extended(chain);
    let result = search(chain, &longer, options, &mut trace);
    match result {
        Ok((program, class)) => Ok(Compiled {
            class,
            snap: program.snap,
            free: program.free.clone(),
            program,
            trace: trace.lines,
            chain: chain.clone(),
            longer,
        }),
        Err(reason) => Err(Refusal { reason, trace: trace.lines }),
    }
}

fn search(
    own: &SerialChain,
    chain: &SerialChain,
    options: &Options,
    trace: &mut Trace<'_>,
) -> Result<(Program, String), String> {
    if chain.joints.len() > crate::kernel::chain::MAX_JOINTS {
        let most = crate::kernel::chain::MAX_JOINTS;
        return Err(format!(
            "{} joints, with those that the type adds, are more than {most}",
            chain.joints.len()
        ));
    }
    let mut letters = letters(own);
    let given = options.goal.given_variables(own.variables.len());
    if options.goal != GoalType::default() {
        letters += &format!(" {}", options.goal.name());
    }
    let choices = match &options.free {
        Some(free) => vec![[checked(free, own)?, given].concat()],
        None if options.goal == GoalType::default() => super::lock::choices(chain),
        None => super::lock::choices_beside(chain, own.variables.len(), &given),
    };
    let mut failure = None;
    let mut best: Option<Found> = None;
    // Rounding of the file itself is never a snap that matters.
    let ladder = [1e-9, 1e-7, 1e-6, 1e-5, 1e-4, 5e-4, 2e-3, 1e-2];
    let allowed = ladder.into_iter().filter(|t| *t <= options.tolerance.max(1e-9));
    for tolerance in allowed {
        for free in &choices {
            let special = |rest, trace: &mut Trace<'_>| {
                attempt(chain, options, free, tolerance, strategies::SPECIAL, rest, &letters, trace)
            };
            match special(false, trace) {
                Ok(found) => {
                    // Few poses show what a snap hides; a simpler ideal chain might lose less, but not less than the general solver on
                    // the described one leaves.
                    let hides = found.program.slack > 0.0;
                    if options.goal == GoalType::default()
                        && (hides || found.lost > 0)
                        && best.as_ref().is_none_or(|b| found.lost < b.lost)
                        && let Ok(whole) = special(true, trace)
                        && (whole.lost < found.lost || hides && whole.lost == found.lost)
                    {
                        if whole.lost == 0 {
                            return Ok((whole.program, whole.class));
                        }
                        keep_better(&mut best, whole);
                    }
                    if found.lost == 0 {
                        return Ok((found.program, found.class));
                    }
                    keep_better(&mut best, found);
                    // Other free joints would not be better, a simpler ideal chain might.
                    break;
                }
                Err(Some(reason)) => failure = Some(reason),
                Err(None) => {}
            }
        }
    }
    // Six joints that all turn are always solved in general.
    let special = chain.joints.iter().any(|j| j.motion == ChainMotion::Prismatic)
        || chain.joints.len() != chain.variables.len()
        || chain.variables.len() < 6
        || options.goal != GoalType::default();
    let needed = best.is_none() && special;
    let allowed = ladder.into_iter().filter(|t| needed && *t <= options.tolerance.max(1e-9));
    for tolerance in allowed.collect::<Vec<_>>() {
        for free in &choices {
            for steady in [true, false] {
                match one_by_one(chain, options, free, tolerance, steady, &letters, trace) {
                    Ok(found) => keep_better(&mut best, found),
                    Err(Some(reason)) => failure = Some(reason),
                    Err(None) => {}
                }
                if best.as_ref().is_some_and(|b| b.lost == 0) {
                    break;
                }
            }
        }
        if best.is_some() {
            break;
        }
    }
    // As it is described: nothing needs to be ideal.
    let in_general = |free: &[usize], trace: &mut Trace<'_>| {
        attempt(chain, options, free, EXACT, strategies::GENERAL, false, &letters, trace)
    };
    let swept = |free: &[usize], trace: &mut Trace<'_>| swept(chain, options, free, &letters, trace);
    let last: [&dyn Fn(&[usize], &mut Trace<'_>) -> Result<Found, Option<String>>; 2] = [&in_general, &swept];
    for way in last {
        for free in &choices {
            if best.as_ref().is_some_and(|b| b.lost == 0) {
                break;
            }
            match way(free, trace) {
                Ok(found) => keep_better(&mut best, found),
                Err(Some(reason)) => failure = Some(reason),
                Err(None) => {}
            }
        }
    }
    match best {
        Some(found) => Ok((found.program, found.class)),
        None => Err(failure.unwrap_or_else(|| refusal(chain, &letters, &choices))),
    }
}

fn keep_better(best: &mut Option<Found>, found: Found) {
    if best.as_ref().is_none_or(|b| found.lost < b.lost) {
        *best = Some(found);
    }
}

/// A program that solves all random trial poses.
struct Found {
    program: Program,
    class: String,
    /// Singular trial poses without a solution, random ones without the generating one.
    lost: usize,
}

/// One tolerance and one choice of free variables. An error carries the reason why a program that was found is no good.
///
/// With `rest` poses at which the ideal chain gives nothing go to the general solver of six joints, on the chain as it is described.
fn attempt(
    chain: &SerialChain,
    options: &Options,
    free: &[usize],
    tolerance: f64,
    strategies: &[Strategy],
    rest: bool,
    letters: &str,
    trace: &mut Trace<'_>,
) -> Result<Found, Option<String>> {
    let facts = Facts::new(chain, tolerance).ok_or(None)?;
    let described = if rest {
        let described = Facts::new(chain, EXACT).and_then(|facts| Problem::new(&facts, free));
        Some(described.filter(|problem| problem.axes.len() == 6).ok_or(None)?)
    } else {
        None
    };
    let Some(problem) = Problem::new(&facts, free) else {
        trace.push(format!("free {free:?}: no joint is left to find"));
        return Err(None);
    };
    let mut failure = None;
    let whole = problem.axes.len();
    let problems = if whole < 6 { completions(&problem) } else { vec![problem] };
    for (problem, Strategy { name, unknowns, write }) in
        problems.iter().flat_map(|p| strategies.iter().map(move |s| (p, s)))
    {
        if *unknowns != problem.axes.len() {
            continue;
        }
        for reversed in [false, true] {
            let mut problem = if reversed { problem.reversed() } else { problem.clone() };
            let mut line = format!(
                "tolerance {tolerance:e}, free {free:?}, {name}{}: ",
                if reversed { " from the tip" } else { "" }
            );
            let builder = Builder::new(options.goal, chain.variables.len(), free.to_vec());
            let written = match &described {
                None => write(&mut problem, &builder),
                Some(described) => with_rest(*write, &mut problem, &mut described.clone(), &builder),
            };
            match written {
                Err(reason) => line += &reason,
                Ok(how) => {
                    let how = if whole < 6 { format!("{how}, completed to 6R") } else { how };
                    let class = describe(letters, name, reversed, &how, free, chain);
                    match finished(builder, class.clone(), problem.snap(), rest, chain, options) {
                        Ok(found) => {
                            line += &format!("{how}; solved, {} trial poses lost", found.lost);
                            trace.push(line);
                            return Ok(found);
                        }
                        Err(reason) => {
                            line += &format!("{how}; {reason}");
                            failure = Some(format!("{class}: {reason}"));
                        }
                    }
                }
            }
            trace.push(line);
        }
    }
    Err(failure)
}

/// A special strategy, and the general one for where it gives nothing.
fn with_rest(
    write: fn(&mut Problem, &Builder) -> Result<String, String>,
    ideal: &mut Problem,
    described: &mut Problem,
    b: &Builder,
) -> Result<String, String> {
    let (mut how, mut rest) = (Ok(String::new()), Ok(String::new()));
    b.aside(|| how = write(ideal, b));
    b.rest(|| {
        b.note("where that gives nothing or leaves a doubt: six joints in general, as they are described");
        rest =
            strategies::GENERAL.iter().map(|s| (s.write)(described, b)).next().unwrap_or(Ok(String::new()));
    });
    rest?;
    how.map(|how| how + ", the rest in general")
}

/// As [`attempt`], by equations with one unknown each.
fn one_by_one(
    chain: &SerialChain,
    options: &Options,
    free: &[usize],
    tolerance: f64,
    steady: bool,
    letters: &str,
    trace: &mut Trace<'_>,
) -> Result<Found, Option<String>> {
    let facts = Facts::coupled(chain, tolerance).ok_or(None)?;
    let line = format!("tolerance {tolerance:e}, free {free:?}, one by one: ");
    let write = |builder: &Builder| super::one_by_one::write(&facts, free, steady, builder);
    written(chain, options, &facts, free, "one by one", letters, &line, &write, trace)
}

/// As [`attempt`], by sweeping one unknown that slides or moves several joints.
fn swept(
    chain: &SerialChain,
    options: &Options,
    free: &[usize],
    letters: &str,
    trace: &mut Trace<'_>,
) -> Result<Found, Option<String>> {
    let facts = Facts::geared(chain, EXACT);
    let line = format!("free {free:?}, sweep: ");
    let write = |builder: &Builder| super::sweep::write(&facts, free, builder);
    written(chain, options, &facts, free, "general", letters, &line, &write, trace)
}

/// The program that `write` makes of a whole chain, tried. `line` begins what is told of it, `name` its class.
fn written(
    chain: &SerialChain,
    options: &Options,
    facts: &Facts,
    free: &[usize],
    name: &str,
    letters: &str,
    line: &str,
    write: &dyn Fn(&Builder) -> Result<String, String>,
    trace: &mut Trace<'_>,
) -> Result<Found, Option<String>> {
    let builder = Builder::new(options.goal, chain.variables.len(), free.to_vec());
    let how = match write(&builder) {
        Ok(how) => how,
        Err(reason) => {
            trace.push(format!("{line}{reason}"));
            return Err(Some(format!("{letters}: {reason}")));
        }
    };
    let class = describe(letters, name, false, &how, free, chain);
    let snap = super::facts::snap_between(&facts.described, &facts.ideal);
    let result = finished(builder, class.clone(), snap, false, chain, options);
    match &result {
        Ok(found) => trace.push(format!("{line}{how}; solved, {} trial poses lost", found.lost)),
        Err(reason) => trace.push(format!("{line}{how}; {reason}")),
    }
    result.map_err(|reason| Some(format!("{class}: {reason}")))
}

/// The optimised program of a builder, tried. With `rest` it ends in the general solver, which is asked wherever the snap leaves a doubt.
fn finished(
    builder: Builder,
    class: String,
    snap: f64,
    rest: bool,
    chain: &SerialChain,
    options: &Options,
) -> Result<Found, String> {
    let mut program = builder.finish();
    // Below this the difference is rounding of the description, which the check covers.
    program.snap = if snap < 1e-12 { 0.0 } else { snap };
    program.slack = if snap < ROUNDING { 0.0 } else { 4.0 * snap };
    if program.slack > 0.0 {
        program = passes::round(&program, decimals(UNSEEN * snap));
    }
    if rest && program.slack > 0.0 {
        super::doubt::note_doubts(&mut program);
    }
    program.class = class.clone();
    let program = passes::optimise(&program);
    let rarely = program.slack > 0.0 || program.uses(RootKind::Six);
    let poses = if rarely { RARELY * options.trial_poses } else { options.trial_poses };
    let lost = trial(&program, chain, poses)?;
    Ok(Found { program, class, lost })
}

/// Decimals that tell numbers apart which differ by `size`.
fn decimals(size: f64) -> u8 {
    libm::ceil(-libm::log10(size)).clamp(0.0, 16.0) as u8
}

/// Runs a program on random and singular poses: how many joint vectors of the former it did not recover and how many of
/// the latter it did not solve, or why it is no good.
fn trial(program: &Program, chain: &SerialChain, poses: usize) -> Result<usize, String> {
    program.validate().map_err(|e| format!("the program is not valid: {e}"))?;
    let solver = Solver::of_longer(program.clone(), chain).map_err(|e| e.to_string())?;
    let mut out = IkSolutions::new();
    let mut lost = 0;
    let slides = slides(chain);
    let seed = Seed::new(0).split("ikgen trial");
    for set in sets(chain, &program.free, poses, seed) {
        let mut solved = 0;
        for values in &set.vectors {
            let free: Vec<f64> = program.free.iter().map(|v| values[*v]).collect();
            solver.solve(&chain.forward(values), &free, &mut out);
            solved += usize::from(!out.is_empty());
            let found = |other| check::same(other, values, &slides, BRANCH);
            lost += usize::from(set.regular && !out.is_empty() && !out.iter().any(found));
        }
        let missed = set.vectors.len() - solved;
        if set.regular && missed > 0 {
            return Err(format!("solves only {solved} of {} random poses", set.vectors.len()));
        }
        lost += missed;
    }
    Ok(lost)
}

fn checked(free: &[usize], chain: &SerialChain) -> Result<Vec<usize>, String> {
    let mut sorted = free.to_vec();
    sorted.sort_unstable();
    sorted.dedup();
    match sorted.last() {
        Some(last) if *last >= chain.variables.len() => Err(format!("the chain has no variable {last}")),
        _ if sorted.len() >= chain.variables.len() => Err("no variable is left to solve for".into()),
        _ => Ok(sorted),
    }
}

/// `6R`, or the joint types in order when some slide.
fn letters(chain: &SerialChain) -> String {
    let all: String =
        chain.joints.iter().map(|j| if j.motion == ChainMotion::Revolute { 'R' } else { 'P' }).collect();
    if all.contains('P') { all } else { format!("{}R", all.len()) }
}

fn describe(
    letters: &str,
    name: &str,
    reversed: bool,
    how: &str,
    free: &[usize],
    chain: &SerialChain,
) -> String {
    let name = match (name, reversed) {
        ("spherical wrist", true) => "spherical shoulder",
        ("three parallel axes", false) => "three parallel axes 2-3-4",
        ("three parallel axes", true) => "three parallel axes 3-4-5",
        (name, _) => name,
    };
    let mut class = format!("{letters} {name}, {how}");
    if reversed {
        class += " (from the tip)";
    }
    let names: Vec<&str> = free.iter().map(|v| chain.variables[*v].name.as_str()).collect();
    if !names.is_empty() {
        class += &format!(", {} given", names.join(" and "));
    }
    class
}

fn refusal(chain: &SerialChain, letters: &str, choices: &[Vec<usize>]) -> String {
    if choices.is_empty() {
        format!("{letters}: name the free joints, {} of them", chain.variables.len().saturating_sub(6))
    } else {
        format!("{letters}: no strategy for this class yet")
    }
}
