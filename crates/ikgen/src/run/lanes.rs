//! The bytecode over many poses at once.
//!
//! Eight poses go through the program together, a lane of each register for each, so that reading an instruction costs once
//! for all and the arithmetic uses the vector registers of the processor. Where poses part ways (a guard, another number of roots, an
//! unknown that is free for some) a mask says which lanes are meant. Lanes do not mix: every pose gets the bits that it gets alone.

use super::bytecode::{Bytecode, Item, Op};
use super::{MOST_ROOTS, SIX_ROOTS};
use crate::ir::{Binary, RootKind, Unary};
use crate::kernel::candidate::is_exact;
use crate::kernel::chain::{Frame, MAX_JOINTS};
use crate::kernel::conic::conic;
use crate::kernel::octic::octic;
use crate::kernel::roots::{self, Roots};
use crate::kernel::six::Candidates;

/// Poses that go together.
pub(super) const LANES: usize = 8;

/// A register of each lane.
pub(super) type Wide = [f64; LANES];

/// A set of lanes, a bit for each.
type Mask = u8;

/// A candidate of one lane.
pub(super) struct Offer<'a> {
    /// Values of the chain's variables; where there are steps, those that the caller gave.
    pub(super) values: &'a mut [f64],
    /// The step of each variable, of a candidate that is not exact.
    pub(super) steps: Option<&'a [[f64; 2]]>,
}

/// How a group of poses came out.
pub(super) struct Outcome {
    /// Lanes that had more roots than are followed together: their answers are not complete.
    pub(super) unfinished: Mask,
    /// Of the others, those without an answer.
    pub(super) empty: Mask,
}

/// One run of the bytecode over a group of poses.
pub(super) struct Run<'a, F: FnMut(usize, &Frame, Offer<'_>) -> bool> {
    code: &'a Bytecode,
    x: &'a mut Vec<Wide>,
    slack: f64,
    poses: Vec<Frame>,
    /// Called with lane, pose and candidate; says whether it is an answer.
    accept: F,
    accepted: [u32; LANES],
    /// Roots that are left to be followed, counted for all lanes together.
    left: u32,
    unfinished: Mask,
    /// Lanes in which an equation was in doubt.
    doubt: Mask,
}

impl<'a, F: FnMut(usize, &Frame, Offer<'_>) -> bool> Run<'a, F> {
    /// A machine with these registers, which then hold the constants.
    pub(super) fn new(code: &'a Bytecode, x: &'a mut Vec<Wide>, slack: f64, accept: F) -> Self {
        x.resize(code.registers, [0.0; LANES]);
        for (register, constant) in x[code.first_constant..].iter_mut().zip(&code.constants) {
            *register = [*constant; LANES];
        }
        Self {
            code,
            x,
            slack,
            poses: Vec::new(),
            accept,
            accepted: [0; LANES],
            left: 0,
            unfinished: 0,
            doubt: 0,
        }
    }

    /// Runs the program on up to [`LANES`] poses, each with its free values.
    pub(super) fn run(&mut self, poses: &[(Frame, &[f64])]) -> Outcome {
        self.poses.clear();
        for (lane, (frame, free)) in poses.iter().enumerate() {
            self.poses.push(*frame);
            let numbers = frame.rotation.iter().flatten().chain(&frame.position).chain(*free);
            for (register, number) in self.x.iter_mut().zip(numbers) {
                register[lane] = *number;
            }
        }
        self.accepted = [0; LANES];
        self.left = MOST_ROOTS;
        self.unfinished = 0;
        self.doubt = 0;
        let all = ((1u16 << poses.len()) - 1) as Mask;
        self.block(&self.code.body, all);
        let empty = lanes_where(all & !self.unfinished, |lane| self.accepted[lane] == 0);
        Outcome { unfinished: self.unfinished, empty }
    }

    fn block(&mut self, items: &'a [Item], mask: Mask) {
        for item in items {
            let mask = mask & !self.unfinished;
            if mask == 0 {
                return;
            }
            match item {
                Item::Steps { from, to } => self.steps(*from as usize, *to as usize, mask),
                Item::ForEach { kind, args, out, outputs, body } => {
                    let x = args.map(|i| self.x[usize::from(i)]);
                    let (s, each) = (self.slack, (*out, *outputs, &body[..], mask));
                    match kind {
                        RootKind::Align => self.each(|i| roots::align(x[0][i], x[1][i], s), each),
                        RootKind::Mirror => self.each(|i| roots::mirror(x[0][i], x[1][i], s), each),
                        RootKind::Half => self.each(|i| roots::half(x[0][i], x[1][i], s), each),
                        RootKind::Circle => self.each(|i| roots::circle(x[0][i], x[1][i], x[2][i], s), each),
                        RootKind::Quadratic => {
                            self.each(|i| roots::quadratic(x[0][i], x[1][i], x[2][i], s), each);
                        }
                        RootKind::Conic => self.each(|i| conic(x.map(|x| x[i]), s), each),
                        RootKind::Octic | RootKind::Six | RootKind::Sweep => {
                            unreachable!("these have items of their own")
                        }
                    }
                }
                Item::Octic { args, out, body } => {
                    let (x, s) = (args.map(|i| self.x[usize::from(i)]), self.slack);
                    self.each(|i| octic(x.map(|x| x[i]), s), (*out, 2, body, mask));
                }
                Item::Six { args, out, body } => self.jointly(RootKind::Six, &args[..], out, body, mask),
                Item::Sweep { args, out, body } => self.jointly(RootKind::Sweep, &args[..], out, body, mask),
                Item::IfZero { value, tolerance, then, otherwise } => {
                    let value = self.x[usize::from(*value)];
                    let zero = lanes_where(mask, |lane| value[lane].abs() < *tolerance);
                    self.block(then, zero);
                    self.block(otherwise, mask & !zero);
                }
                Item::Fallback { first, otherwise } => {
                    let before = self.accepted;
                    self.block(first, mask);
                    let none = lanes_where(mask, |lane| self.accepted[lane] == before[lane]);
                    self.block(otherwise, none);
                }
                Item::Doubt { value, tolerance } => {
                    let value = self.x[usize::from(*value)];
                    self.doubt |= lanes_where(mask, |lane| value[lane].abs() < *tolerance);
                }
                Item::Rest(body) => {
                    let wanted = self.doubt | lanes_where(mask, |lane| self.accepted[lane] == 0);
                    self.block(body, mask & wanted);
                }
                Item::Offer { from, to, misses } => {
                    self.offer(*from as usize..*to as usize, misses.map(|i| self.x[usize::from(i)]), mask);
                }
            }
        }
    }

    /// The body for each root, all lanes that have as many together.
    fn each<const N: usize>(
        &mut self,
        roots: impl Fn(usize) -> Roots<N>,
        (out, outputs, body, mask): ([u16; 2], u8, &'a [Item], Mask),
    ) {
        let found: [Roots<N>; LANES] =
            std::array::from_fn(|lane| if mask >> lane & 1 == 1 { roots(lane) } else { Roots::NONE });
        let before = self.accepted;
        for i in 0.. {
            let lanes = lanes_where(mask & !self.unfinished, |lane| {
                let enough = found[lane].free && self.accepted[lane] > before[lane];
                i < found[lane].count() && !enough
            });
            if lanes == 0 {
                return;
            }
            if !super::take(&mut self.left, 1) {
                self.unfinished |= lanes;
                return;
            }
            for (lane, found) in found.iter().enumerate().filter(|(lane, _)| lanes >> lane & 1 == 1) {
                let root = found.get(i);
                self.x[usize::from(out[0])][lane] = root[0];
                if outputs > 1 {
                    self.x[usize::from(out[1])][lane] = root[1];
                }
            }
            self.block(body, lanes);
        }
    }

    /// The body for each way in which six joints close the loop.
    fn jointly(&mut self, kind: RootKind, args: &[u16], out: &[u16; 12], body: &'a [Item], mask: Mask) {
        if !super::take(&mut self.left, SIX_ROOTS) {
            self.unfinished |= mask;
            return;
        }
        let slack = self.slack - self.code.slack;
        let found: [Candidates; LANES] = std::array::from_fn(|lane| {
            if mask >> lane & 1 == 0 {
                return Candidates::NONE;
            }
            let mut numbers = [0.0; crate::kernel::sweep::NUMBERS];
            for (number, register) in numbers.iter_mut().zip(args) {
                *number = self.x[usize::from(*register)][lane];
            }
            kind.solve_jointly(&numbers, slack)
        });
        for i in 0.. {
            let lanes = lanes_where(mask & !self.unfinished, |lane| i < found[lane].count());
            if lanes == 0 {
                return;
            }
            for lane in (0..LANES).filter(|lane| lanes >> lane & 1 == 1) {
                for (to, value) in out.iter().zip(found[lane].get(i).into_iter().flatten()) {
                    self.x[usize::from(*to)][lane] = value;
                }
            }
            self.block(body, lanes);
        }
    }

    fn offer(&mut self, registers: std::ops::Range<usize>, misses: [Wide; 2], mask: Mask) {
        let registers = &self.code.offered[registers];
        for lane in (0..LANES).filter(|lane| mask >> lane & 1 == 1) {
            let mut values = [0.0; MAX_JOINTS];
            for (value, [_, _, register]) in values.iter_mut().zip(registers) {
                *value = self.x[usize::from(*register)][lane];
            }
            let mut steps = [[0.0; 2]; MAX_JOINTS];
            let exact = is_exact(misses.map(|m| m[lane]));
            if !exact {
                for (step, [a, b, _]) in steps.iter_mut().zip(registers) {
                    *step = [a, b].map(|i| self.x[usize::from(*i)][lane]);
                }
            }
            let steps = (!exact).then_some(&steps[..registers.len()]);
            let offer = Offer { values: &mut values[..registers.len()], steps };
            self.accepted[lane] += u32::from((self.accept)(lane, &self.poses[lane], offer));
        }
    }

    fn steps(&mut self, from: usize, to: usize, mask: Mask) {
        for step in &self.code.steps[from..to] {
            let (a, b) = (self.x[usize::from(step.a)], self.x[usize::from(step.b)]);
            let of_one = |f: fn(f64) -> f64| a.map(f);
            let of_two = |f: fn(f64, f64) -> f64| std::array::from_fn(|lane| f(a[lane], b[lane]));
            let to = &mut self.x[usize::from(step.to)];
            // What no vector register helps with is done for the lanes alone that are meant.
            let slow = |to: &mut Wide, f: &dyn Fn(usize) -> f64| {
                (0..LANES).filter(|lane| mask >> lane & 1 == 1).for_each(|lane| to[lane] = f(lane));
            };
            match step.op {
                Op::Add => (0..LANES).for_each(|i| to[i] = a[i] + b[i]),
                Op::Sub => (0..LANES).for_each(|i| to[i] = a[i] - b[i]),
                Op::Mul => (0..LANES).for_each(|i| to[i] = a[i] * b[i]),
                Op::Div => (0..LANES).for_each(|i| to[i] = a[i] / b[i]),
                Op::Neg => (0..LANES).for_each(|i| to[i] = -a[i]),
                Op::Copy => *to = a,
                Op::Min => *to = of_two(|a, b| Binary::Min.apply(a, b)),
                Op::Max => *to = of_two(|a, b| Binary::Max.apply(a, b)),
                Op::AngleOf => slow(to, &|i| Binary::AngleOf.apply(a[i], b[i])),
                Op::Opposite => *to = of_one(|a| Unary::Opposite.apply(a)),
                Op::Mirrored => *to = of_one(|a| Unary::Mirrored.apply(a)),
                Op::Sqrt => *to = of_one(|a| Unary::Sqrt.apply(a)),
                Op::Sin => slow(to, &|i| Unary::Sin.apply(a[i])),
                Op::Cos => slow(to, &|i| Unary::Cos.apply(a[i])),
            }
        }
    }
}

/// The lanes of a set for which something holds.
fn lanes_where(mask: Mask, holds: impl Fn(usize) -> bool) -> Mask {
    let lanes = (0..LANES).filter(|lane| mask >> lane & 1 == 1 && holds(*lane));
    lanes.fold(0, |mask, lane| mask | 1 << lane)
}
