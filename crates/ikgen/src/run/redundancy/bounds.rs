//! A solution program run on an interval of one free value.
//!
//! Every expression is bounded, and every equation gives the roots that it has for all values of the interval at once. Where an
//! equation has roots for some of the values only, or an unknown is free, nothing is said: the interval must be cut.

use super::interval::{Interval, Undecided, angle_of_box};
use super::trigonometric;
use crate::ir::{Binary, Block, Expr, Node, Program, RootKind, Stmt, Unary, Value};
use crate::kernel::chain::Frame;
use crate::kernel::roots::VANISHING;

/// What is known of one variable of a solution, for all values of the interval: an angle around some middle, or a length.
pub(super) type Bounds = Vec<Interval>;

/// Bounds of all solutions, one entry for each branch, in no particular order of branches.
pub(super) fn branches(
    program: &Program,
    base_from_tip: &Frame,
    free: &[Interval],
    slack: f64,
) -> Result<Vec<Bounds>, Undecided> {
    let values = vec![None; program.exprs.len()];
    let mut run = Run {
        program,
        base_from_tip,
        free,
        slack,
        vars: vec![Interval::point(0.0); program.names.len()],
        found: Vec::new(),
        doubt: false,
        values,
    };
    run.block(&program.body)?;
    Ok(run.found)
}

struct Run<'a> {
    program: &'a Program,
    base_from_tip: &'a Frame,
    free: &'a [Interval],
    slack: f64,
    vars: Vec<Interval>,
    /// Values of expressions; emptied when a variable changes.
    values: Vec<Option<Interval>>,
    found: Vec<Bounds>,
    doubt: bool,
}

impl Run<'_> {
    fn block(&mut self, block: &Block) -> Result<(), Undecided> {
        for stmt in block {
            match stmt {
                Stmt::Note(_) => {}
                Stmt::Let { var, value } => {
                    let value = self.value(*value);
                    self.bind(var.0, value);
                }
                Stmt::IfZero { value, tolerance, then, otherwise } => {
                    let value = self.value(*value).magnitude();
                    if value.high < *tolerance {
                        self.block(then)?;
                    } else if value.low >= *tolerance {
                        self.block(otherwise)?;
                    } else {
                        return Err(Undecided);
                    }
                }
                Stmt::Fallback { first, otherwise } => {
                    let before = self.found.len();
                    self.block(first)?;
                    if self.found.len() == before {
                        self.block(otherwise)?;
                    }
                }
                Stmt::Doubt { value, tolerance } => {
                    let value = self.value(*value).magnitude();
                    if value.high < *tolerance {
                        self.doubt = true;
                    } else if value.low < *tolerance {
                        return Err(Undecided);
                    }
                }
                Stmt::Rest(body) => {
                    if self.doubt || self.found.is_empty() {
                        self.block(body)?;
                    }
                }
                Stmt::ForEach { kind, args, out, body } => {
                    let args: Vec<Interval> = args.iter().map(|e| self.value(*e)).collect();
                    for root in roots(*kind, &args, self.slack)? {
                        for (var, x) in out.iter().zip(root) {
                            self.bind(var.0, x);
                        }
                        self.block(body)?;
                    }
                }
                Stmt::Emit(values) | Stmt::Offer { values, .. } => {
                    let mut bounds = Vec::new();
                    for value in values {
                        bounds.push(match *value {
                            Value::Length(x) => self.value(x),
                            Value::Angle(c, s) => {
                                angle_of_box(self.value(c), self.value(s)).ok_or(Undecided)?
                            }
                        });
                    }
                    self.found.push(bounds);
                }
            }
        }
        Ok(())
    }

    fn bind(&mut self, var: u32, value: Interval) {
        self.vars[var as usize] = value;
        self.values.fill(None);
    }

    fn value(&mut self, e: Expr) -> Interval {
        if let Some(known) = self.values[e.0 as usize] {
            return known;
        }
        let value = match self.program.exprs.node(e) {
            Node::Const(bits) => Interval::point(f64::from_bits(bits)),
            Node::Rotation(i, j) => {
                Interval::point(self.base_from_tip.rotation[usize::from(i)][usize::from(j)])
            }
            Node::Position(i) => Interval::point(self.base_from_tip.position[usize::from(i)]),
            Node::Free(k) => self.free[usize::from(k)],
            Node::Var(v) => self.vars[v.0 as usize],
            Node::Unary(f, a) => {
                let a = self.value(a);
                match f {
                    Unary::Neg => a.negated(),
                    Unary::Sqrt => a.sqrt(),
                    Unary::Sin => a.sin(),
                    Unary::Cos => a.cos(),
                    Unary::Opposite => a.plus(Interval::point(std::f64::consts::PI)),
                    Unary::Mirrored => a.negated(),
                }
            }
            Node::Binary(f, a, b) if f == Binary::Mul && a == b => self.value(a).square(),
            Node::Binary(f, a, b) => {
                let (a, b) = (self.value(a), self.value(b));
                match f {
                    Binary::Add => a.plus(b),
                    Binary::Sub => a.minus(b),
                    Binary::Mul => a.times(b),
                    Binary::Div => a.over(b),
                    Binary::Min => Interval { low: a.low.min(b.low), high: a.high.min(b.high) },
                    Binary::Max => Interval { low: a.low.max(b.low), high: a.high.max(b.high) },
                    Binary::AngleOf => {
                        angle_of_box(b, a).unwrap_or(Interval { low: f64::NEG_INFINITY, high: f64::INFINITY })
                    }
                }
            }
        };
        self.values[e.0 as usize] = Some(value);
        value
    }
}

/// Roots that an equation has for all values of its arguments, each `[cos, sin]` or `[length, 0]`.
fn roots(kind: RootKind, x: &[Interval], slack: f64) -> Result<Vec<[Interval; 2]>, Undecided> {
    let unit = |angle: Interval| [angle.cos(), angle.sin()];
    let along = |x: Interval, y: Interval| {
        let size = x.square().plus(y.square()).sqrt();
        if size.low > VANISHING + slack {
            angle_of_box(x.wider(slack), y.wider(slack)).ok_or(Undecided)
        } else {
            Err(Undecided)
        }
    };
    match kind {
        RootKind::Align => Ok(vec![unit(along(x[0], x[1])?)]),
        RootKind::Mirror | RootKind::Half => {
            let y = x[1].magnitude();
            if y.low <= VANISHING + slack {
                return Err(Undecided);
            }
            let angle = along(x[0], y)?;
            let both = vec![unit(angle), unit(angle.negated())];
            Ok(if kind == RootKind::Half { both[..1].to_vec() } else { both })
        }
        RootKind::Circle => {
            let size = x[0].square().plus(x[1].square()).sqrt();
            if size.low <= VANISHING + slack {
                return Err(Undecided);
            }
            let ratio = x[2].wider(slack).over(size.wider(slack));
            let least = ratio.magnitude();
            if least.low > 1.0 {
                return Ok(Vec::new());
            }
            if least.high >= 1.0 {
                return Err(Undecided);
            }
            let (middle, half) = (along(x[0], x[1])?, ratio.acos());
            Ok(vec![unit(middle.plus(half)), unit(middle.minus(half))])
        }
        RootKind::Quadratic => {
            let a = x[0].magnitude();
            if a.high < VANISHING {
                if x[1].magnitude().low < VANISHING {
                    return Err(Undecided);
                }
                return Ok(vec![[x[2].negated().over(x[1]), Interval::point(0.0)]]);
            }
            if a.low < VANISHING {
                return Err(Undecided);
            }
            let half = x[1].over(x[0]).times(Interval::point(-0.5));
            let discriminant = half.square().minus(x[2].over(x[0])).wider(slack);
            if discriminant.high < 0.0 {
                return Ok(Vec::new());
            }
            if discriminant.low <= 0.0 {
                return Err(Undecided);
            }
            let root = discriminant.sqrt();
            Ok(vec![[half.plus(root), Interval::point(0.0)], [half.minus(root), Interval::point(0.0)]])
        }
        RootKind::Conic | RootKind::Octic => {
            let mut polynomial = match *x {
                [a, b, c, d, e, f] => trigonometric::of_conic([a, b, c, d, e, f]),
                _ => std::array::from_fn(|i| x[i]),
            };
            polynomial[0] = polynomial[0].wider(slack);
            Ok(trigonometric::roots(&polynomial)?.into_iter().map(unit).collect())
        }
        RootKind::Six | RootKind::Sweep => Err(Undecided),
    }
}
