//! Writing programs: scalars, vectors and turns as expressions, and equations that open a loop over their roots.

use std::cell::RefCell;
use std::ops::{Add, Div, Mul, Neg, Sub};

use nalgebra::Vector3;

use crate::ir::{Binary, Block, Expr, Exprs, Node, Program, RootKind, Stmt, Unary, Value, Var};

/// A program being written.
///
/// An equation such as [`circle`](Self::circle) opens a loop: everything that follows, up to the end of the enclosing
/// branch, is done for each of its roots.
pub struct Builder {
    inner: RefCell<Inner>,
}

struct Inner {
    program: Program,
    open: Vec<Open>,
}

/// A block that is still open, and the equation it belongs to.
struct Open {
    head: Option<(RootKind, Vec<Expr>, Vec<Var>)>,
    block: Block,
}

/// A number of the program.
#[derive(Clone, Copy)]
pub struct Scalar<'b> {
    builder: &'b Builder,
    expr: Expr,
}

/// Three numbers.
#[derive(Clone, Copy)]
pub struct Vector<'b>(pub [Scalar<'b>; 3]);

/// An angle by its cosine and sine.
#[derive(Clone, Copy)]
pub struct Turn<'b> {
    /// Cosine.
    pub cos: Scalar<'b>,
    /// Sine.
    pub sin: Scalar<'b>,
}

impl Builder {
    /// An empty program for a chain with this many variables, those that the goal type adds included; `free` are given.
    pub fn new(goal: crate::GoalType, variables: usize, free: Vec<usize>) -> Self {
        let program = Program {
            class: String::new(),
            goal,
            variables,
            free,
            snap: 0.0,
            slack: 0.0,
            exprs: Exprs::default(),
            names: Vec::new(),
            body: Vec::new(),
        };
        let open = vec![Open { head: None, block: Vec::new() }];
        Self { inner: RefCell::new(Inner { program, open }) }
    }

    /// The finished program.
    pub fn finish(self) -> Program {
        self.close_to(1);
        let mut inner = self.inner.into_inner();
        let body = inner.open.pop().expect("the outermost block is open until the end").block;
        inner.program.body = body;
        inner.program
    }

    fn scalar(&self, expr: Expr) -> Scalar<'_> {
        Scalar { builder: self, expr }
    }

    fn leaf(&self, node: Node) -> Scalar<'_> {
        let expr = self.inner.borrow_mut().program.exprs.intern(node);
        self.scalar(expr)
    }

    /// A constant.
    pub fn constant(&self, x: f64) -> Scalar<'_> {
        let expr = self.inner.borrow_mut().program.exprs.constant(x);
        self.scalar(expr)
    }

    /// A constant vector.
    pub fn vector(&self, v: &Vector3<f64>) -> Vector<'_> {
        Vector([v.x, v.y, v.z].map(|x| self.constant(x)))
    }

    /// Position of the wanted pose.
    pub fn position(&self) -> Vector<'_> {
        Vector([0, 1, 2].map(|i| self.leaf(Node::Position(i))))
    }

    /// Rotation matrix of the wanted pose, row by row.
    pub fn rotation(&self) -> [Vector<'_>; 3] {
        [0, 1, 2].map(|i| Vector([0, 1, 2].map(|j| self.leaf(Node::Rotation(i, j)))))
    }

    /// Value of the `k`-th free variable.
    pub fn free(&self, k: u8) -> Scalar<'_> {
        self.leaf(Node::Free(k))
    }

    /// Cosine and sine of a value.
    pub fn turn_of<'b>(&'b self, angle: Scalar<'b>) -> Turn<'b> {
        Turn { cos: angle.unary(Unary::Cos), sin: angle.unary(Unary::Sin) }
    }

    /// A remark at this place.
    pub fn note(&self, text: impl Into<String>) {
        self.push(Stmt::Note(text.into()));
    }

    fn push(&self, stmt: Stmt) {
        self.inner.borrow_mut().open.last_mut().expect("a block is open").block.push(stmt);
    }

    fn roots(&self, kind: RootKind, args: &[Scalar<'_>], names: &[String]) -> Vec<Scalar<'_>> {
        let mut inner = self.inner.borrow_mut();
        let out: Vec<Var> = names.iter().map(|n| inner.program.bind(n)).collect();
        let args = args.iter().map(|s| s.expr).collect();
        inner.open.push(Open { head: Some((kind, args, out.clone())), block: Vec::new() });
        out.into_iter().map(|v| self.scalar(inner.program.exprs.intern(Node::Var(v)))).collect()
    }

    fn turn_roots(&self, kind: RootKind, name: &str, args: &[Scalar<'_>]) -> Turn<'_> {
        let out = self.roots(kind, args, &[format!("c{name}"), format!("s{name}")]);
        Turn { cos: out[0], sin: out[1] }
    }

    /// For the angle along (x, y).
    pub fn align<'b>(&'b self, name: &str, x: Scalar<'b>, y: Scalar<'b>) -> Turn<'b> {
        self.turn_roots(RootKind::Align, name, &[x, y])
    }

    /// For both angles along (x, y) and (x, -y).
    pub fn mirror<'b>(&'b self, name: &str, x: Scalar<'b>, y: Scalar<'b>) -> Turn<'b> {
        self.turn_roots(RootKind::Mirror, name, &[x, y])
    }

    /// For each angle with `a cos + b sin = d`.
    pub fn circle<'b>(&'b self, name: &str, a: Scalar<'b>, b: Scalar<'b>, d: Scalar<'b>) -> Turn<'b> {
        self.turn_roots(RootKind::Circle, name, &[a, b, d])
    }

    /// For each angle on a conic in its cosine and sine; coefficients in the order of [`RootKind::Conic`].
    pub fn conic<'b>(&'b self, name: &str, q: [Scalar<'b>; 6]) -> Turn<'b> {
        self.turn_roots(RootKind::Conic, name, &q)
    }

    /// For each angle at which four waves cancel; coefficients in the order of [`RootKind::Octic`].
    pub fn octic<'b>(&'b self, name: &str, a: &[Scalar<'b>; 9]) -> Turn<'b> {
        self.turn_roots(RootKind::Octic, name, a)
    }

    /// For each length with `a t^2 + b t + c = 0`.
    pub fn quadratic<'b>(&'b self, name: &str, a: Scalar<'b>, b: Scalar<'b>, c: Scalar<'b>) -> Scalar<'b> {
        self.roots(RootKind::Quadratic, &[a, b, c], &[format!("d{name}")])[0]
    }

    /// For each way in which six revolute joints close a loop; arguments in the order of [`RootKind::Six`].
    pub fn six<'b>(&'b self, names: &[String], args: &[Scalar<'b>]) -> Vec<Turn<'b>> {
        self.jointly(RootKind::Six, names, args)
    }

    /// For each way in which five turning joints and one unknown that moves others close a loop; arguments in the order of
    /// [`RootKind::Sweep`]. Where the last one is a length it takes the place of the cosine.
    pub fn sweep<'b>(&'b self, names: &[String], args: &[Scalar<'b>]) -> Vec<Turn<'b>> {
        self.jointly(RootKind::Sweep, names, args)
    }

    fn jointly<'b>(&'b self, kind: RootKind, names: &[String], args: &[Scalar<'b>]) -> Vec<Turn<'b>> {
        let names: Vec<String> = names.iter().flat_map(|n| [format!("c{n}"), format!("s{n}")]).collect();
        let out = self.roots(kind, args, &names);
        out.chunks(2).map(|pair| Turn { cos: pair[0], sin: pair[1] }).collect()
    }

    /// Branches on whether `value` is smaller than `tolerance` in magnitude. Nothing may follow in the same block.
    pub fn if_zero<'b>(
        &'b self,
        value: Scalar<'b>,
        tolerance: f64,
        then: impl FnOnce(),
        otherwise: impl FnOnce(),
    ) {
        let then = self.nested(then);
        let otherwise = self.nested(otherwise);
        self.push(Stmt::IfZero { value: value.expr, tolerance, then, otherwise });
    }

    /// Does `otherwise` only if nothing that `first` emits is accepted. Nothing may follow in the same block.
    pub fn fallback(&self, first: impl FnOnce(), otherwise: impl FnOnce()) {
        let first = self.nested(first);
        let otherwise = self.nested(otherwise);
        self.push(Stmt::Fallback { first, otherwise });
    }

    /// Does this only if nothing was accepted before it, or an equation was in doubt. Not in another block.
    pub fn rest(&self, write: impl FnOnce()) {
        let body = self.nested(write);
        self.push(Stmt::Rest(body));
    }

    /// Writes to the same block, and closes the loops that this opens.
    pub fn aside(&self, write: impl FnOnce()) {
        for stmt in self.nested(write) {
            self.push(stmt);
        }
    }

    fn nested(&self, write: impl FnOnce()) -> Block {
        let depth = self.inner.borrow().open.len();
        self.inner.borrow_mut().open.push(Open { head: None, block: Vec::new() });
        write();
        self.close_to(depth + 1);
        self.inner.borrow_mut().open.pop().expect("opened above").block
    }

    /// Closes loops until only `depth` blocks are open.
    fn close_to(&self, depth: usize) {
        let mut inner = self.inner.borrow_mut();
        while inner.open.len() > depth {
            let Open { head, block } = inner.open.pop().expect("counted");
            let (kind, args, out) = head.expect("only loops are open above the depth of a branch");
            let outer = inner.open.last_mut().expect("the outermost block is never a loop");
            outer.block.push(Stmt::ForEach { kind, args, out, body: block });
        }
    }

    /// Emits a candidate: the step of each variable.
    pub fn emit(&self, steps: &[Move<'_>]) {
        let values = steps
            .iter()
            .map(|step| match step {
                Move::Turn(t) => Value::Angle(t.cos.expr, t.sin.expr),
                Move::Slide(x) => Value::Length(x.expr),
            })
            .collect();
        self.push(Stmt::Emit(values));
    }
}

/// How far a joint has moved.
#[derive(Clone, Copy)]
pub enum Move<'b> {
    /// By an angle.
    Turn(Turn<'b>),
    /// By a length.
    Slide(Scalar<'b>),
}

impl<'b> Scalar<'b> {
    fn unary(self, f: Unary) -> Self {
        let expr = self.builder.inner.borrow_mut().program.exprs.unary(f, self.expr);
        Self { expr, ..self }
    }

    fn binary(self, f: Binary, other: Self) -> Self {
        let expr = self.builder.inner.borrow_mut().program.exprs.binary(f, self.expr, other.expr);
        Self { expr, ..self }
    }

    /// Square root of the positive part.
    pub fn sqrt(self) -> Self {
        self.unary(Unary::Sqrt)
    }

    /// The smaller.
    pub fn min(self, other: Self) -> Self {
        self.binary(Binary::Min, other)
    }

    /// The larger.
    pub fn max(self, other: Self) -> Self {
        self.binary(Binary::Max, other)
    }

    /// Its value if it is a number.
    pub fn as_constant(self) -> Option<f64> {
        self.builder.inner.borrow().program.exprs.as_constant(self.expr)
    }
}

impl<'b> Add for Scalar<'b> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        self.binary(Binary::Add, other)
    }
}

impl<'b> Sub for Scalar<'b> {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self.binary(Binary::Sub, other)
    }
}

impl<'b> Mul for Scalar<'b> {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        self.binary(Binary::Mul, other)
    }
}

impl<'b> Div for Scalar<'b> {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        self.binary(Binary::Div, other)
    }
}

impl<'b> Mul<f64> for Scalar<'b> {
    type Output = Self;
    fn mul(self, factor: f64) -> Self {
        self * self.builder.constant(factor)
    }
}

impl Neg for Scalar<'_> {
    type Output = Self;
    fn neg(self) -> Self {
        self.unary(Unary::Neg)
    }
}

impl<'b> Vector<'b> {
    /// Inner product.
    pub fn dot(self, other: Self) -> Scalar<'b> {
        let ([a, b, c], [x, y, z]) = (self.0, other.0);
        a * x + b * y + c * z
    }

    /// Cross product.
    pub fn cross(self, other: Self) -> Self {
        let ([a, b, c], [x, y, z]) = (self.0, other.0);
        Self([b * z - c * y, c * x - a * z, a * y - b * x])
    }

    /// Squared length.
    pub fn square(self) -> Scalar<'b> {
        self.dot(self)
    }

    /// The part along a unit `axis`.
    pub fn along(self, axis: Self) -> Self {
        axis * axis.dot(self)
    }

    /// Turned about a unit `axis` through the origin.
    pub fn turned(self, axis: Self, turn: Turn<'b>) -> Self {
        let along = self.along(axis);
        along + ((self - along) * turn.cos + axis.cross(self) * turn.sin)
    }

    /// Turned the other way.
    pub fn turned_back(self, axis: Self, turn: Turn<'b>) -> Self {
        self.turned(axis, turn.back())
    }
}

impl<'b> Turn<'b> {
    /// The opposite angle.
    pub fn back(self) -> Self {
        Self { cos: self.cos, sin: -self.sin }
    }

    /// The sum of two angles.
    pub fn plus(self, other: Self) -> Self {
        Self {
            cos: self.cos * other.cos - self.sin * other.sin,
            sin: self.sin * other.cos + self.cos * other.sin,
        }
    }
}

impl Add for Vector<'_> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let ([a, b, c], [x, y, z]) = (self.0, other.0);
        Self([a + x, b + y, c + z])
    }
}

impl Sub for Vector<'_> {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        let ([a, b, c], [x, y, z]) = (self.0, other.0);
        Self([a - x, b - y, c - z])
    }
}

impl Neg for Vector<'_> {
    type Output = Self;
    fn neg(self) -> Self {
        Self(self.0.map(|x| -x))
    }
}

impl<'b> Mul<Scalar<'b>> for Vector<'b> {
    type Output = Self;
    fn mul(self, factor: Scalar<'b>) -> Self {
        Self(self.0.map(|x| x * factor))
    }
}
