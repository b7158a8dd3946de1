//! Pure expressions, hash-consed: an expression that is written twice is one node.

use std::collections::HashMap;

/// A node of an [`Exprs`] arena. Operands are always older than the node itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Expr(pub(crate) u32);

/// A name bound by a statement.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Var(pub(crate) u32);

/// Functions of one argument.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Unary {
    /// `-x`
    Neg,
    /// `opposite(x)`: the angle half a turn on, in (-pi, pi]
    Opposite,
    /// `mirrored(x)`: the angle with the other sign, in (-pi, pi]
    Mirrored,
    /// `sqrt(x)`, 0 for negative `x`
    Sqrt,
    /// `sin(x)`
    Sin,
    /// `cos(x)`
    Cos,
}

/// Functions of two arguments.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Binary {
    /// `a + b`
    Add,
    /// `a - b`
    Sub,
    /// `a * b`
    Mul,
    /// `a / b`
    Div,
    /// `min(a, b)`
    Min,
    /// `max(a, b)`
    Max,
    /// `angle_of(s, c)`: the angle with this sine and cosine, in (-pi, pi]
    AngleOf,
}

/// What an expression is made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Node {
    /// A finite number, by its bits.
    Const(u64),
    /// `rIJ`: entry of the rotation of `base_from_tip`, row I, column J.
    Rotation(u8, u8),
    /// `px`, `py`, `pz`: position of `base_from_tip`.
    Position(u8),
    /// `freeK`: value of the K-th free variable.
    Free(u8),
    /// A bound name.
    Var(Var),
    /// A function of one argument.
    Unary(Unary, Expr),
    /// A function of two arguments.
    Binary(Binary, Expr, Expr),
}

impl Node {
    /// Whether evaluating it costs nothing.
    pub fn is_leaf(&self) -> bool {
        !matches!(self, Node::Unary(..) | Node::Binary(..))
    }

    /// Its operands.
    pub fn operands(&self) -> impl Iterator<Item = Expr> {
        let (a, b) = match *self {
            Node::Unary(_, a) => (Some(a), None),
            Node::Binary(_, a, b) => (Some(a), Some(b)),
            _ => (None, None),
        };
        a.into_iter().chain(b)
    }
}

impl Unary {
    /// Its value.
    pub fn apply(self, x: f64) -> f64 {
        use crate::kernel::math;
        match self {
            Unary::Neg => -x,
            Unary::Opposite => math::opposite(x),
            Unary::Mirrored => math::mirrored(x),
            Unary::Sqrt => math::sqrt(x),
            Unary::Sin => math::cos_sin(x)[1],
            Unary::Cos => math::cos_sin(x)[0],
        }
    }
}

impl Binary {
    /// Its value.
    pub fn apply(self, a: f64, b: f64) -> f64 {
        match self {
            Binary::Add => a + b,
            Binary::Sub => a - b,
            Binary::Mul => a * b,
            Binary::Div => a / b,
            Binary::Min => a.min(b),
            Binary::Max => a.max(b),
            Binary::AngleOf => crate::kernel::math::angle_of(a, b),
        }
    }
}

/// The arena of a program's expressions.
#[derive(Debug, Clone, Default)]
pub struct Exprs {
    nodes: Vec<Node>,
    ids: HashMap<Node, Expr>,
}

impl Exprs {
    /// The node of an expression.
    pub fn node(&self, e: Expr) -> Node {
        self.nodes[e.0 as usize]
    }

    /// Number of nodes.
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Whether there is no node.
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// The expression of this node as it stands, without simplification.
    pub fn intern(&mut self, node: Node) -> Expr {
        *self.ids.entry(node).or_insert_with(|| {
            self.nodes.push(node);
            Expr(self.nodes.len() as u32 - 1)
        })
    }

    /// A number; minus zero becomes zero.
    pub fn constant(&mut self, x: f64) -> Expr {
        self.intern(Node::Const((x + 0.0).to_bits()))
    }

    /// The number that an expression is, if it is one.
    pub fn as_constant(&self, e: Expr) -> Option<f64> {
        match self.node(e) {
            Node::Const(bits) => Some(f64::from_bits(bits)),
            _ => None,
        }
    }

    /// `f(a)`, simplified: constants folded, double negation removed.
    pub fn unary(&mut self, f: Unary, a: Expr) -> Expr {
        if let Some(x) = self.as_constant(a) {
            return self.constant(f.apply(x));
        }
        match (f, self.node(a)) {
            (Unary::Neg, Node::Unary(Unary::Neg, b)) => b,
            (Unary::Neg, Node::Binary(Binary::Sub, x, y)) => self.binary(Binary::Sub, y, x),
            _ => self.intern(Node::Unary(f, a)),
        }
    }

    /// `f(a, b)`, simplified: constants folded and gathered, neutral elements removed, signs moved outward, operands of
    /// sums and products ordered by age.
    pub fn binary(&mut self, f: Binary, a: Expr, b: Expr) -> Expr {
        let negated = |e: &Self, x: Expr| match e.node(x) {
            Node::Unary(Unary::Neg, y) => Some(y),
            _ => None,
        };
        let (x, y) = (self.as_constant(a), self.as_constant(b));
        if let (Some(x), Some(y)) = (x, y) {
            let value = f.apply(x, y);
            let sum = matches!(f, Binary::Add | Binary::Sub);
            // What is left of two equal numbers is rounding, not data.
            let dust = sum && value.abs() <= 4.0 * f64::EPSILON * x.abs().max(y.abs());
            if value.is_finite() {
                return self.constant(if dust { 0.0 } else { value });
            }
        }
        match f {
            Binary::Add => {
                if x == Some(0.0) {
                    return b;
                }
                if y == Some(0.0) {
                    return a;
                }
                if let Some(b) = negated(self, b) {
                    return self.binary(Binary::Sub, a, b);
                }
                if let Some(a) = negated(self, a) {
                    return self.binary(Binary::Sub, b, a);
                }
            }
            Binary::Sub => {
                if y == Some(0.0) {
                    return a;
                }
                if x == Some(0.0) {
                    return self.unary(Unary::Neg, b);
                }
                if a == b {
                    return self.constant(0.0);
                }
                if let Some(b) = negated(self, b) {
                    return self.binary(Binary::Add, a, b);
                }
                if let Some(a) = negated(self, a) {
                    let sum = self.binary(Binary::Add, a, b);
                    return self.unary(Unary::Neg, sum);
                }
            }
            Binary::Mul => {
                for (c, other) in [(x, b), (y, a)] {
                    match c {
                        Some(0.0) => return self.constant(0.0),
                        Some(1.0) => return other,
                        Some(-1.0) => return self.unary(Unary::Neg, other),
                        _ => {}
                    }
                }
                if let Some(a) = negated(self, a) {
                    let product = self.binary(Binary::Mul, a, b);
                    return self.unary(Unary::Neg, product);
                }
                if let Some(b) = negated(self, b) {
                    let product = self.binary(Binary::Mul, a, b);
                    return self.unary(Unary::Neg, product);
                }
                // Two constant factors meet: c1 (c2 z) = (c1 c2) z.
                for (c, other) in [(x, b), (y, a)] {
                    if let (Some(c), Node::Binary(Binary::Mul, p, z)) = (c, self.node(other)) {
                        if let Some(inner) = self.as_constant(p) {
                            let c = self.constant(c * inner);
                            return self.binary(Binary::Mul, c, z);
                        }
                        if let Some(inner) = self.as_constant(z) {
                            let c = self.constant(c * inner);
                            return self.binary(Binary::Mul, c, p);
                        }
                    }
                }
            }
            Binary::Div => {
                if y == Some(1.0) {
                    return a;
                }
                if x == Some(0.0) {
                    return a;
                }
            }
            Binary::AngleOf => match (negated(self, a), negated(self, b)) {
                (Some(a), Some(b)) => {
                    let angle = self.binary(f, a, b);
                    return self.unary(Unary::Opposite, angle);
                }
                (Some(a), None) => {
                    let angle = self.binary(f, a, b);
                    return self.unary(Unary::Mirrored, angle);
                }
                _ => {}
            },
            Binary::Min | Binary::Max => {
                if a == b {
                    return a;
                }
            }
        }
        if let Some(sum) = self.gathered(f, a, b) {
            return sum;
        }
        let commutes = !matches!(f, Binary::Sub | Binary::Div | Binary::AngleOf);
        let (a, b) = if commutes && b < a { (b, a) } else { (a, b) };
        self.intern(Node::Binary(f, a, b))
    }

    /// A sum or difference in which two constants meet: `(a + c) + (b + d) = (a + b) + (c + d)`.
    fn gathered(&mut self, f: Binary, a: Expr, b: Expr) -> Option<Expr> {
        if !matches!(f, Binary::Add | Binary::Sub) {
            return None;
        }
        let ((a, c), (b, d)) = (self.split(a)?, self.split(b)?);
        let (c, d) = (self.constant(c), self.constant(d));
        let constant = self.binary(f, c, d);
        let rest = match (a, b) {
            (Some(a), Some(b)) => self.binary(f, a, b),
            (Some(a), None) => a,
            (None, Some(b)) if f == Binary::Sub => self.unary(Unary::Neg, b),
            (None, b) => b?,
        };
        Some(self.binary(Binary::Add, rest, constant))
    }

    /// What a constant is added to, if anything, and the constant; none of an expression without one.
    fn split(&mut self, e: Expr) -> Option<(Option<Expr>, f64)> {
        if let Some(c) = self.as_constant(e) {
            return Some((None, c));
        }
        let Node::Binary(f @ (Binary::Add | Binary::Sub), a, b) = self.node(e) else { return None };
        match (f, self.as_constant(a), self.as_constant(b)) {
            (Binary::Sub, None, Some(c)) => Some((Some(a), -c)),
            (Binary::Sub, Some(c), None) => Some((Some(self.unary(Unary::Neg, b)), c)),
            (_, None, Some(c)) => Some((Some(a), c)),
            (_, Some(c), None) => Some((Some(b), c)),
            _ => None,
        }
    }

    /// The same node with other operands, simplified.
    pub fn rebuild(&mut self, node: Node, mut operand: impl FnMut(&mut Self, Expr) -> Expr) -> Expr {
        match node {
            Node::Unary(f, a) => {
                let a = operand(self, a);
                self.unary(f, a)
            }
            Node::Binary(f, a, b) => {
                let (a, b) = (operand(self, a), operand(self, b));
                self.binary(f, a, b)
            }
            leaf => self.intern(leaf),
        }
    }
}
