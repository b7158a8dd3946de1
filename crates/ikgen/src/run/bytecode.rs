//! Programs as straight runs of three-address instructions over a small register file.

use super::{MOST_ROOTS, SIX_ROOTS, Verdict, take};
use crate::ir::{Binary, Block, Expr, Node, Program, RootKind, Stmt, Unary, Value, Var};
use crate::kernel::chain::{Frame, MAX_JOINTS};
use crate::kernel::conic::conic;
use crate::kernel::octic::octic;
use crate::kernel::roots::{self, Roots};
use crate::kernel::six::Candidates;
use crate::kernel::{six, sweep};
use crate::run::TrueChain;

/// A program that needs more registers than the machine has.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("the program needs {0} registers, the bytecode has {MAX_REGISTERS}")]
pub struct TooLarge(usize);

/// A candidate with all that its check needs; the first entries are those of the chain's variables.
#[derive(Debug, Clone, Copy)]
pub struct Candidate {
    /// `[cos, sin]` or `[length, 0]`.
    pub steps: [[f64; 2]; MAX_JOINTS],
    /// Angles in (-pi, pi], or lengths.
    pub values: [f64; MAX_JOINTS],
    /// Squares of how far it is from the pose: rotation, position; infinite where that is not known, as the values are not.
    pub misses: [f64; 2],
}

/// Registers of the largest machine.
const MAX_REGISTERS: usize = 4096;

/// Twelve pose entries come first, then free values, then constants, then names, then temporaries.
const POSE_REGISTERS: usize = 12;

#[derive(Debug, Clone, Copy)]
pub(super) enum Op {
    Add,
    Sub,
    Mul,
    Div,
    Min,
    Max,
    AngleOf,
    Neg,
    Opposite,
    Mirrored,
    Sqrt,
    Sin,
    Cos,
    Copy,
}

#[derive(Debug, Clone, Copy)]
pub(super) struct Step {
    pub(super) op: Op,
    pub(super) to: u16,
    pub(super) a: u16,
    pub(super) b: u16,
}

#[derive(Debug, Clone)]
pub(super) enum Item {
    Steps { from: u32, to: u32 },
    ForEach { kind: RootKind, args: [u16; 6], out: [u16; 2], outputs: u8, body: Vec<Item> },
    Octic { args: Box<[u16; 9]>, out: [u16; 2], body: Vec<Item> },
    Six { args: Box<[u16; six::NUMBERS]>, out: [u16; 12], body: Vec<Item> },
    Sweep { args: Box<[u16; sweep::NUMBERS]>, out: [u16; 12], body: Vec<Item> },
    IfZero { value: u16, tolerance: f64, then: Vec<Item>, otherwise: Vec<Item> },
    Fallback { first: Vec<Item>, otherwise: Vec<Item> },
    Doubt { value: u16, tolerance: f64 },
    Rest(Vec<Item>),
    Offer { from: u32, to: u32, misses: [u16; 2] },
}

/// What a run keeps beside its registers.
struct State {
    /// Roots that are left to be followed.
    left: u32,
    /// Whether an equation was in doubt.
    doubt: bool,
}

/// A program made ready to run: no lookup, no allocation.
#[derive(Debug, Clone)]
pub struct Bytecode {
    pub(super) steps: Vec<Step>,
    /// Registers of the steps of offered candidates, and of the value of each variable.
    pub(super) offered: Vec<[u16; 3]>,
    pub(super) body: Vec<Item>,
    pub(super) first_constant: usize,
    pub(super) constants: Vec<f64>,
    pub(super) registers: usize,
    /// Of the program: six joints in general are solved as they are described, without it.
    pub(super) slack: f64,
}

impl Bytecode {
    /// Translates a valid program [prepared](crate::passes::prepare) for a chain with as many variables: of its candidates is known
    /// how far they are from the pose.
    pub fn for_chain(program: &Program, chain: &TrueChain) -> Result<Self, TooLarge> {
        Self::new(&crate::passes::prepare(program, chain))
    }

    /// Translates a valid program. Of its candidates only the steps are known, unless it is a prepared one.
    pub fn new(program: &Program) -> Result<Self, TooLarge> {
        let first_constant = POSE_REGISTERS + program.free.len();
        let mut constants: Vec<u64> = Vec::new();
        for i in 0..program.exprs.len() {
            if let Node::Const(bits) = program.exprs.node(Expr(i as u32)) {
                constants.push(bits);
            }
        }
        constants.extend([0, f64::INFINITY.to_bits()]);
        constants.sort_unstable();
        constants.dedup();
        let first_name = first_constant + constants.len();
        let mut t = Translator {
            program,
            steps: Vec::new(),
            offered: Vec::new(),
            constants,
            first_constant,
            first_name,
            first_temporary: first_name + program.names.len(),
            high_water: 0,
        };
        t.high_water = t.first_temporary;
        let body = t.block(&program.body);
        if t.high_water > MAX_REGISTERS {
            return Err(TooLarge(t.high_water));
        }
        Ok(Self {
            steps: t.steps,
            offered: t.offered,
            body,
            first_constant,
            constants: t.constants.iter().map(|b| f64::from_bits(*b)).collect(),
            registers: t.high_water,
            slack: program.slack,
        })
    }

    /// Number of arithmetic instructions.
    pub fn instructions(&self) -> usize {
        self.steps.len()
    }

    /// Runs the program and offers each candidate. `offer` says what it makes of it; returns how many were accepted.
    pub fn run(
        &self,
        base_from_tip: &Frame,
        free: &[f64],
        slack: f64,
        offer: &mut impl FnMut(&Candidate) -> Verdict,
    ) -> usize {
        // The smallest file that fits, since clearing it is part of the cost of a call.
        match self.registers {
            0..=256 => self.run_in(&mut [0.0; 256], base_from_tip, free, slack, offer),
            257..=512 => self.run_in(&mut [0.0; 512], base_from_tip, free, slack, offer),
            513..=1024 => self.run_in(&mut [0.0; 1024], base_from_tip, free, slack, offer),
            _ => self.run_in(&mut [0.0; MAX_REGISTERS], base_from_tip, free, slack, offer),
        }
    }

    fn run_in<const N: usize>(
        &self,
        registers: &mut [f64; N],
        base_from_tip: &Frame,
        free: &[f64],
        slack: f64,
        offer: &mut impl FnMut(&Candidate) -> Verdict,
    ) -> usize {
        for i in 0..3 {
            registers[3 * i..3 * i + 3].copy_from_slice(&base_from_tip.rotation[i]);
        }
        registers[9..12].copy_from_slice(&base_from_tip.position);
        registers[POSE_REGISTERS..self.first_constant].copy_from_slice(free);
        registers[self.first_constant..][..self.constants.len()].copy_from_slice(&self.constants);
        let mut state = State { left: MOST_ROOTS, doubt: false };
        self.block(&self.body, registers, slack, &mut state, offer)
    }

    fn block<const N: usize>(
        &self,
        items: &[Item],
        x: &mut [f64; N],
        slack: f64,
        state: &mut State,
        offer: &mut impl FnMut(&Candidate) -> Verdict,
    ) -> usize {
        // N is a power of two: the mask replaces the bounds check.
        let at = |i: u16| usize::from(i) & (N - 1);
        let mut accepted = 0;
        for item in items {
            match item {
                Item::Steps { from, to } => {
                    for step in &self.steps[*from as usize..*to as usize] {
                        let (a, b) = (x[at(step.a)], x[at(step.b)]);
                        x[at(step.to)] = match step.op {
                            Op::Add => a + b,
                            Op::Sub => a - b,
                            Op::Mul => a * b,
                            Op::Div => a / b,
                            Op::Neg => -a,
                            Op::Copy => a,
                            Op::Min => Binary::Min.apply(a, b),
                            Op::Max => Binary::Max.apply(a, b),
                            Op::AngleOf => Binary::AngleOf.apply(a, b),
                            Op::Opposite => Unary::Opposite.apply(a),
                            Op::Mirrored => Unary::Mirrored.apply(a),
                            Op::Sqrt => Unary::Sqrt.apply(a),
                            Op::Sin => Unary::Sin.apply(a),
                            Op::Cos => Unary::Cos.apply(a),
                        };
                    }
                }
                Item::ForEach { kind, args, out, outputs, body } => {
                    let [a, b, c, d, e, f] = args.map(|i| x[at(i)]);
                    let each = (&body[..], *out, *outputs);
                    accepted += match kind {
                        RootKind::Align => self.each(roots::align(a, b, slack), each, x, slack, state, offer),
                        RootKind::Mirror => {
                            self.each(roots::mirror(a, b, slack), each, x, slack, state, offer)
                        }
                        RootKind::Half => self.each(roots::half(a, b, slack), each, x, slack, state, offer),
                        RootKind::Circle => {
                            self.each(roots::circle(a, b, c, slack), each, x, slack, state, offer)
                        }
                        RootKind::Quadratic => {
                            self.each(roots::quadratic(a, b, c, slack), each, x, slack, state, offer)
                        }
                        RootKind::Conic => {
                            self.each(conic([a, b, c, d, e, f], slack), each, x, slack, state, offer)
                        }
                        RootKind::Octic | RootKind::Six | RootKind::Sweep => {
                            unreachable!("these have items of their own")
                        }
                    };
                }
                Item::Octic { args, out, body } => {
                    let roots = octic(args.map(|i| x[at(i)]), slack);
                    accepted += self.each(roots, (body, *out, 2), x, slack, state, offer);
                }
                Item::Six { args, out, body } => {
                    if !take(&mut state.left, SIX_ROOTS) {
                        continue;
                    }
                    let found = six::six_of(&args.map(|i| x[at(i)]), slack - self.slack);
                    accepted += self.jointly(&found, (body, out), x, slack, state, offer);
                }
                Item::Sweep { args, out, body } => {
                    if !take(&mut state.left, SIX_ROOTS) {
                        continue;
                    }
                    let found = sweep::sweep_of(&args.map(|i| x[at(i)]), slack - self.slack);
                    accepted += self.jointly(&found, (body, out), x, slack, state, offer);
                }
                Item::IfZero { value, tolerance, then, otherwise } => {
                    let zero = x[at(*value)].abs() < *tolerance;
                    accepted += self.block(if zero { then } else { otherwise }, x, slack, state, offer);
                }
                Item::Fallback { first, otherwise } => {
                    let found = self.block(first, x, slack, state, offer);
                    accepted += if found > 0 { found } else { self.block(otherwise, x, slack, state, offer) };
                }
                Item::Doubt { value, tolerance } => state.doubt |= x[at(*value)].abs() < *tolerance,
                // Only in the outermost block: what that has accepted is all.
                Item::Rest(body) => {
                    if state.doubt || accepted == 0 {
                        accepted += self.block(body, x, slack, state, offer);
                    }
                }
                Item::Offer { from, to, misses } => {
                    let registers = &self.offered[*from as usize..*to as usize];
                    let mut candidate = Candidate {
                        steps: [[0.0; 2]; MAX_JOINTS],
                        values: [0.0; MAX_JOINTS],
                        misses: misses.map(|i| x[at(i)]),
                    };
                    for (variable, [a, b, value]) in registers.iter().enumerate() {
                        candidate.steps[variable] = [x[at(*a)], x[at(*b)]];
                        candidate.values[variable] = x[at(*value)];
                    }
                    let verdict = offer(&candidate);
                    accepted += usize::from(verdict != Verdict::Wrong);
                    if verdict == Verdict::Last {
                        // Without roots to follow the run is over.
                        state.left = 0;
                    }
                }
            }
        }
        accepted
    }
}

impl Bytecode {
    /// The body of a loop for each root.
    fn each<const N: usize, const R: usize>(
        &self,
        roots: Roots<R>,
        (body, out, outputs): (&[Item], [u16; 2], u8),
        x: &mut [f64; N],
        slack: f64,
        state: &mut State,
        offer: &mut impl FnMut(&Candidate) -> Verdict,
    ) -> usize {
        let mut accepted = 0;
        let mut tries = roots.tries(0);
        while let Some(root) = tries.next(accepted) {
            if !take(&mut state.left, 1) {
                break;
            }
            x[usize::from(out[0]) & (N - 1)] = root[0];
            if outputs > 1 {
                x[usize::from(out[1]) & (N - 1)] = root[1];
            }
            accepted += self.block(body, x, slack, state, offer);
        }
        accepted
    }
}

impl Bytecode {
    /// The body of a loop for each candidate of six unknowns.
    fn jointly<const N: usize>(
        &self,
        found: &Candidates,
        (body, out): (&[Item], &[u16; 12]),
        x: &mut [f64; N],
        slack: f64,
        state: &mut State,
        offer: &mut impl FnMut(&Candidate) -> Verdict,
    ) -> usize {
        let mut accepted = 0;
        for i in 0..found.count() {
            for (to, value) in out.iter().zip(found.get(i).into_iter().flatten()) {
                x[usize::from(*to) & (N - 1)] = value;
            }
            accepted += self.block(body, x, slack, state, offer);
        }
        accepted
    }
}

struct Translator<'p> {
    program: &'p Program,
    steps: Vec<Step>,
    offered: Vec<[u16; 3]>,
    constants: Vec<u64>,
    first_constant: usize,
    first_name: usize,
    first_temporary: usize,
    high_water: usize,
}

/// Temporaries of one statement: expressions already computed, and the next free register.
struct Temporaries {
    known: Vec<(Expr, u16)>,
    next: usize,
}

impl Translator<'_> {
    fn block(&mut self, block: &Block) -> Vec<Item> {
        let mut items = Vec::new();
        for stmt in block {
            let from = self.steps.len() as u32;
            let mut t = Temporaries { known: Vec::new(), next: self.first_temporary };
            let item = match stmt {
                Stmt::Note(_) => None,
                Stmt::Let { var, value } => {
                    self.assign(*var, *value, &mut t);
                    None
                }
                Stmt::ForEach { kind, args, out, body } if kind.is_joint() => {
                    let args: Vec<u16> = args.iter().map(|e| self.value(*e, &mut t)).collect();
                    self.flush(from, &mut items);
                    let mut names = [0; 12];
                    for (name, v) in names.iter_mut().zip(out) {
                        *name = self.name(*v);
                    }
                    let body = self.block(body);
                    Some(match kind {
                        RootKind::Six => {
                            Item::Six { args: Box::new(std::array::from_fn(|i| args[i])), out: names, body }
                        }
                        _ => {
                            Item::Sweep { args: Box::new(std::array::from_fn(|i| args[i])), out: names, body }
                        }
                    })
                }
                Stmt::ForEach { kind: RootKind::Octic, args, out, body } => {
                    let mut registers = Box::new([0; 9]);
                    for (r, e) in registers.iter_mut().zip(args) {
                        *r = self.value(*e, &mut t);
                    }
                    self.flush(from, &mut items);
                    let out = [self.name(out[0]), self.name(out[1])];
                    Some(Item::Octic { args: registers, out, body: self.block(body) })
                }
                Stmt::ForEach { kind, args, out, body } => {
                    let mut registers = [self.constant(0); 6];
                    for (r, e) in registers.iter_mut().zip(args) {
                        *r = self.value(*e, &mut t);
                    }
                    self.flush(from, &mut items);
                    let names = out.iter().map(|v| self.name(*v)).collect::<Vec<_>>();
                    let out = [names[0], *names.last().unwrap_or(&names[0])];
                    let outputs = names.len() as u8;
                    Some(Item::ForEach { kind: *kind, args: registers, out, outputs, body: self.block(body) })
                }
                Stmt::IfZero { value, tolerance, then, otherwise } => {
                    let value = self.value(*value, &mut t);
                    self.flush(from, &mut items);
                    let (then, otherwise) = (self.block(then), self.block(otherwise));
                    Some(Item::IfZero { value, tolerance: *tolerance, then, otherwise })
                }
                Stmt::Fallback { first, otherwise } => {
                    Some(Item::Fallback { first: self.block(first), otherwise: self.block(otherwise) })
                }
                Stmt::Doubt { value, tolerance } => {
                    let value = self.value(*value, &mut t);
                    self.flush(from, &mut items);
                    Some(Item::Doubt { value, tolerance: *tolerance })
                }
                Stmt::Rest(body) => Some(Item::Rest(self.block(body))),
                Stmt::Emit(values) => {
                    let (zero, far) = (self.constant(0), self.constant(f64::INFINITY.to_bits()));
                    let registers = values.iter().map(|v| self.steps_of(*v, zero, &mut t)).collect();
                    self.flush(from, &mut items);
                    Some(self.offer(registers, [far; 2]))
                }
                Stmt::Offer { values, angles, misses } => {
                    let mut registers = Vec::new();
                    for (value, angle) in values.iter().zip(angles) {
                        let angle = self.value(*angle, &mut t);
                        registers.push(self.steps_of(*value, angle, &mut t));
                    }
                    let misses = misses.map(|e| self.value(e, &mut t));
                    self.flush(from, &mut items);
                    Some(self.offer(registers, misses))
                }
            };
            if item.is_none() {
                self.flush(from, &mut items);
            }
            items.extend(item);
        }
        items
    }

    /// Registers of the step of a variable and of its value.
    fn steps_of(&mut self, value: Value, angle: u16, t: &mut Temporaries) -> [u16; 3] {
        match value {
            Value::Angle(c, s) => [self.value(c, t), self.value(s, t), angle],
            Value::Length(x) => [self.value(x, t), self.constant(0), angle],
        }
    }

    fn offer(&mut self, registers: Vec<[u16; 3]>, misses: [u16; 2]) -> Item {
        let from = self.offered.len() as u32;
        self.offered.extend(registers);
        Item::Offer { from, to: self.offered.len() as u32, misses }
    }

    /// Makes the steps since `from` part of the item list, joined to a run that they continue.
    fn flush(&self, from: u32, items: &mut Vec<Item>) {
        let end = self.steps.len() as u32;
        match items.last_mut() {
            _ if from == end => {}
            Some(Item::Steps { to, .. }) if *to == from => *to = end,
            _ => items.push(Item::Steps { from, to: end }),
        }
    }

    fn assign(&mut self, var: Var, value: Expr, t: &mut Temporaries) {
        let to = self.name(var);
        let start = self.steps.len();
        let from = self.value(value, t);
        // The last step can write the name itself.
        let last = self.steps.len().wrapping_sub(1);
        if self.steps.len() > start && self.steps[last].to == from {
            self.steps[last].to = to;
        } else {
            self.steps.push(Step { op: Op::Copy, to, a: from, b: from });
        }
    }

    fn value(&mut self, e: Expr, t: &mut Temporaries) -> u16 {
        if let Some((_, register)) = t.known.iter().find(|(known, _)| *known == e) {
            return *register;
        }
        let (op, a, b) = match self.program.exprs.node(e) {
            Node::Const(bits) => return self.constant(bits),
            Node::Rotation(i, j) => return u16::from(3 * i + j),
            Node::Position(i) => return u16::from(9 + i),
            Node::Free(k) => return POSE_REGISTERS as u16 + u16::from(k),
            Node::Var(v) => return self.name(v),
            Node::Unary(f, a) => {
                let a = self.value(a, t);
                let op = match f {
                    Unary::Neg => Op::Neg,
                    Unary::Opposite => Op::Opposite,
                    Unary::Mirrored => Op::Mirrored,
                    Unary::Sqrt => Op::Sqrt,
                    Unary::Sin => Op::Sin,
                    Unary::Cos => Op::Cos,
                };
                (op, a, a)
            }
            Node::Binary(f, a, b) => {
                let (a, b) = (self.value(a, t), self.value(b, t));
                let op = match f {
                    Binary::Add => Op::Add,
                    Binary::Sub => Op::Sub,
                    Binary::Mul => Op::Mul,
                    Binary::Div => Op::Div,
                    Binary::Min => Op::Min,
                    Binary::Max => Op::Max,
                    Binary::AngleOf => Op::AngleOf,
                };
                (op, a, b)
            }
        };
        let to = t.next.min(usize::from(u16::MAX)) as u16;
        t.next += 1;
        self.high_water = self.high_water.max(t.next);
        self.steps.push(Step { op, to, a, b });
        t.known.push((e, to));
        to
    }

    fn constant(&self, bits: u64) -> u16 {
        let index = self.constants.binary_search(&bits).expect("all constants were collected");
        (self.first_constant + index) as u16
    }

    fn name(&self, var: Var) -> u16 {
        (self.first_name + var.0 as usize) as u16
    }
}
