//! The bytecode over many poses at once.
//!
//! Eight poses go through the program together, a lane of each register for each, so that reading an instruction costs once
//! for all and the arithmetic uses the vector registers of the processor. A lane that is anything but regular (an unknown is free,
//! a candidate needs a polish, there is no solution) is left to the scalar engine. Lanes do not mix: every pose gets the bits
//! that it gets alone.

use super::bytecode::{Bytecode, Item, Op};
use crate::ir::{Binary, RootKind, Unary};
use crate::kernel::candidate::is_exact;
use crate::kernel::chain::{Frame, MAX_JOINTS};
use crate::kernel::conic::conic;
use crate::kernel::roots::{self, Roots};

/// Poses that go together.
pub(super) const LANES: usize = 8;

/// A register of each lane.
pub(super) type Wide = [f64; LANES];

/// A set of lanes, a bit for each.
type Mask = u8;

/// One run of the bytecode over a group of poses.
pub(super) struct Run<'a, F: FnMut(usize, &[f64])> {
    code: &'a Bytecode,
    x: &'a mut Vec<Wide>,
    slack: f64,
    /// Called with the lane and the values of each exact candidate.
    accept: F,
    accepted: [u32; LANES],
    irregular: Mask,
}

impl<'a, F: FnMut(usize, &[f64])> Run<'a, F> {
    /// A machine with these registers, which then hold the constants.
    pub(super) fn new(code: &'a Bytecode, x: &'a mut Vec<Wide>, slack: f64, accept: F) -> Self {
        x.resize(code.registers, [0.0; LANES]);
        for (register, constant) in x[code.first_constant..].iter_mut().zip(&code.constants) {
            *register = [*constant; LANES];
        }
        Self { code, x, slack, accept, accepted: [0; LANES], irregular: 0 }
    }

    /// Runs the program on up to [`LANES`] poses, each with its free values; returns the lanes whose answers are not complete,
    /// and those that have none.
    pub(super) fn run(&mut self, poses: &[(Frame, &[f64])]) -> (Mask, Mask) {
        for (lane, (frame, free)) in poses.iter().enumerate() {
            let numbers = frame.rotation.iter().flatten().chain(&frame.position).chain(*free);
            for (register, number) in self.x.iter_mut().zip(numbers) {
                register[lane] = *number;
            }
        }
        self.accepted = [0; LANES];
        self.irregular = 0;
        let all = ((1u16 << poses.len()) - 1) as Mask;
        self.block(&self.code.body, all);
        (self.irregular, lanes_where(all & !self.irregular, |lane| self.accepted[lane] == 0))
    }

    fn block(&mut self, items: &'a [Item], mask: Mask) {
        for item in items {
            let mask = mask & !self.irregular;
            if mask == 0 {
                return;
            }
            match item {
                Item::Steps { from, to } => self.steps(*from as usize, *to as usize),
                Item::ForEach { kind, args, out, outputs, body } => {
                    let args = args.map(|i| self.x[usize::from(i)]);
                    let slack = self.slack;
                    let roots = |solve: fn([f64; 6], f64) -> Found| {
                        std::array::from_fn::<Found, LANES, _>(|lane| solve(args.map(|a| a[lane]), slack))
                    };
                    let found = match kind {
                        RootKind::Align => roots(|[x, y, ..], s| roots::align(x, y, s).into()),
                        RootKind::Mirror => roots(|[x, y, ..], s| roots::mirror(x, y, s).into()),
                        RootKind::Half => roots(|[x, y, ..], s| roots::half(x, y, s).into()),
                        RootKind::Circle => roots(|[a, b, d, ..], s| roots::circle(a, b, d, s).into()),
                        RootKind::Quadratic => roots(|[a, b, c, ..], s| roots::quadratic(a, b, c, s).into()),
                        RootKind::Conic => roots(|q, s| conic(q, s).into()),
                        RootKind::Octic | RootKind::Six => unreachable!("these have items of their own"),
                    };
                    self.each(&found, (*out, *outputs), body, mask);
                }
                Item::Octic { .. } | Item::Six { .. } => self.irregular |= mask,
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
                Item::Offer { from, to, misses } => {
                    let registers = &self.code.offered[*from as usize..*to as usize];
                    let misses = misses.map(|i| self.x[usize::from(i)]);
                    for lane in (0..LANES).filter(|lane| mask >> lane & 1 == 1) {
                        if !is_exact(misses.map(|m| m[lane])) {
                            self.irregular |= 1 << lane;
                            continue;
                        }
                        let mut values = [0.0; MAX_JOINTS];
                        for (value, [_, _, register]) in values.iter_mut().zip(registers) {
                            *value = self.x[usize::from(*register)][lane];
                        }
                        (self.accept)(lane, &values[..registers.len()]);
                        self.accepted[lane] += 1;
                    }
                }
            }
        }
    }

    /// The body for each root, all lanes that have as many together.
    fn each(&mut self, found: &[Found; LANES], (out, outputs): ([u16; 2], u8), body: &'a [Item], mask: Mask) {
        self.irregular |= lanes_where(mask, |lane| found[lane].free);
        let mask = mask & !self.irregular;
        for i in 0..4 {
            let lanes = lanes_where(mask, |lane| i < found[lane].count);
            if lanes == 0 {
                return;
            }
            for (lane, found) in found.iter().enumerate() {
                self.x[usize::from(out[0])][lane] = found.items[i][0];
                if outputs > 1 {
                    self.x[usize::from(out[1])][lane] = found.items[i][1];
                }
            }
            self.block(body, lanes);
        }
    }

    fn steps(&mut self, from: usize, to: usize) {
        for step in &self.code.steps[from..to] {
            let (a, b) = (self.x[usize::from(step.a)], self.x[usize::from(step.b)]);
            let of_one = |f: fn(f64) -> f64| a.map(f);
            let of_two = |f: fn(f64, f64) -> f64| std::array::from_fn(|lane| f(a[lane], b[lane]));
            let to = &mut self.x[usize::from(step.to)];
            match step.op {
                Op::Add => (0..LANES).for_each(|i| to[i] = a[i] + b[i]),
                Op::Sub => (0..LANES).for_each(|i| to[i] = a[i] - b[i]),
                Op::Mul => (0..LANES).for_each(|i| to[i] = a[i] * b[i]),
                Op::Div => (0..LANES).for_each(|i| to[i] = a[i] / b[i]),
                Op::Neg => (0..LANES).for_each(|i| to[i] = -a[i]),
                Op::Copy => *to = a,
                Op::Min => *to = of_two(|a, b| Binary::Min.apply(a, b)),
                Op::Max => *to = of_two(|a, b| Binary::Max.apply(a, b)),
                Op::AngleOf => *to = of_two(|a, b| Binary::AngleOf.apply(a, b)),
                Op::Opposite => *to = of_one(|a| Unary::Opposite.apply(a)),
                Op::Mirrored => *to = of_one(|a| Unary::Mirrored.apply(a)),
                Op::Sqrt => *to = of_one(|a| Unary::Sqrt.apply(a)),
                Op::Sin => *to = of_one(|a| Unary::Sin.apply(a)),
                Op::Cos => *to = of_one(|a| Unary::Cos.apply(a)),
            }
        }
    }
}

/// The lanes of a set for which something holds.
fn lanes_where(mask: Mask, holds: impl Fn(usize) -> bool) -> Mask {
    let lanes = (0..LANES).filter(|lane| mask >> lane & 1 == 1 && holds(*lane));
    lanes.fold(0, |mask, lane| mask | 1 << lane)
}

/// The roots of one lane.
#[derive(Clone, Copy)]
struct Found {
    items: [[f64; 2]; 4],
    count: usize,
    free: bool,
}

impl<const N: usize> From<Roots<N>> for Found {
    fn from(roots: Roots<N>) -> Self {
        let mut items = [[0.0; 2]; 4];
        if roots.free {
            return Self { items, count: 0, free: true };
        }
        for (i, item) in items.iter_mut().enumerate().take(roots.count()) {
            *item = roots.get(i);
        }
        Self { items, count: roots.count(), free: false }
    }
}
