//! The solution language: see the crate's documentation for what its words mean.

pub mod expr;
mod parse;
mod print;
mod validate;

pub use expr::{Binary, Expr, Exprs, Node, Unary, Var};
pub use parse::TextError;
pub use validate::Invalid;

/// What a `for-each-root` statement solves.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum RootKind {
    /// `align x y -> c s`: the angle along (x, y); any angle when both vanish.
    Align,
    /// `mirror x y -> c s`: the two angles along (x, y) and (x, -y).
    Mirror,
    /// `half x y -> c s`: the angle along (x, |y|): of two mirrored ones that with a positive sine.
    Half,
    /// `circle a b d -> c s`: `a cos + b sin = d`.
    Circle,
    /// `conic a b c d e f -> c s`: `a cos^2 + b cos sin + c sin^2 + d cos + e sin + f = 0`.
    Conic,
    /// `octic a0 a1 b1 ... a4 b4 -> c s`: `a0 + a1 cos q + b1 sin q + ... + a4 cos 4q + b4 sin 4q = 0`.
    Octic,
    /// `quadratic a b c -> t`: `a t^2 + b t + c = 0`.
    Quadratic,
    /// `six ... -> c s c s c s c s c s c s`: six revolute joints that close a loop; arguments as [`six_of`](crate::kernel::six::six_of)
    /// takes them.
    Six,
    /// `sweep ... -> c s c s c s c s c s c s`: five turning joints and one unknown that slides or moves several joints, which close a
    /// loop; arguments as [`sweep_of`](crate::kernel::sweep::sweep_of) takes them.
    Sweep,
}

impl RootKind {
    /// All kinds.
    pub const ALL: [RootKind; 9] = [
        Self::Align,
        Self::Mirror,
        Self::Half,
        Self::Circle,
        Self::Conic,
        Self::Octic,
        Self::Quadratic,
        Self::Six,
        Self::Sweep,
    ];

    /// Its word in the text form.
    pub fn word(self) -> &'static str {
        match self {
            Self::Align => "align",
            Self::Mirror => "mirror",
            Self::Half => "half",
            Self::Circle => "circle",
            Self::Conic => "conic",
            Self::Octic => "octic",
            Self::Quadratic => "quadratic",
            Self::Six => "six",
            Self::Sweep => "sweep",
        }
    }

    /// Number of arguments.
    pub fn arguments(self) -> usize {
        match self {
            Self::Align | Self::Mirror | Self::Half => 2,
            Self::Circle | Self::Quadratic => 3,
            Self::Conic => 6,
            Self::Octic => 9,
            Self::Six => crate::kernel::six::NUMBERS,
            Self::Sweep => crate::kernel::sweep::NUMBERS,
        }
    }

    /// Number of names bound: cosine and sine of each angle, or one length.
    pub fn outputs(self) -> usize {
        match self {
            Self::Quadratic => 1,
            Self::Six | Self::Sweep => 12,
            _ => 2,
        }
    }

    /// Whether it gives six unknowns at once.
    pub fn is_joint(self) -> bool {
        matches!(self, Self::Six | Self::Sweep)
    }

    /// Candidates for six unknowns at once; none for kinds that have one.
    pub fn solve_jointly(self, x: &[f64], slack: f64) -> crate::kernel::six::Candidates {
        use crate::kernel::{six, sweep};
        match self {
            Self::Six => six::six_of(&core::array::from_fn(|i| x[i]), slack),
            Self::Sweep => sweep::sweep_of(&core::array::from_fn(|i| x[i]), slack),
            _ => six::Candidates::NONE,
        }
    }

    /// The roots of one unknown for these argument values; none for kinds that give six at once.
    pub fn solve(self, x: &[f64], slack: f64) -> crate::kernel::roots::Roots<8> {
        use crate::kernel::roots;
        match self {
            Self::Align => roots::align(x[0], x[1], slack).widened(),
            Self::Mirror => roots::mirror(x[0], x[1], slack).widened(),
            Self::Half => roots::half(x[0], x[1], slack).widened(),
            Self::Circle => roots::circle(x[0], x[1], x[2], slack).widened(),
            Self::Conic => crate::kernel::conic::conic([x[0], x[1], x[2], x[3], x[4], x[5]], slack).widened(),
            Self::Octic => crate::kernel::octic::octic(core::array::from_fn(|i| x[i]), slack),
            Self::Quadratic => roots::quadratic(x[0], x[1], x[2], slack).widened(),
            Self::Six | Self::Sweep => roots::Roots::NONE,
        }
    }
}

/// How an emitted solution gives one variable.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Value {
    /// An angle by cosine and sine.
    Angle(Expr, Expr),
    /// A length.
    Length(Expr),
}

impl Value {
    /// The same with other expressions.
    fn map(&self, expr: &mut dyn FnMut(Expr) -> Expr) -> Self {
        match *self {
            Value::Angle(c, s) => Value::Angle(expr(c), expr(s)),
            Value::Length(x) => Value::Length(expr(x)),
        }
    }

    /// The expressions in it.
    pub fn exprs(&self) -> impl Iterator<Item = Expr> {
        let (a, b) = match *self {
            Value::Angle(c, s) => (c, Some(s)),
            Value::Length(x) => (x, None),
        };
        std::iter::once(a).chain(b)
    }
}

/// A structured statement.
#[derive(Debug, Clone, PartialEq)]
pub enum Stmt {
    /// A name for a value.
    Let {
        /// The name.
        var: Var,
        /// The value.
        value: Expr,
    },
    /// Runs the body once for each root.
    ForEach {
        /// The equation.
        kind: RootKind,
        /// Its arguments.
        args: Vec<Expr>,
        /// The names bound in the body.
        out: Vec<Var>,
        /// What is done for each root.
        body: Block,
    },
    /// Runs one of two blocks.
    IfZero {
        /// Compared in magnitude.
        value: Expr,
        /// With this.
        tolerance: f64,
        /// Where it is smaller.
        then: Block,
        /// Where it is not.
        otherwise: Block,
    },
    /// Runs the second block only if no candidate emitted by the first was accepted.
    Fallback {
        /// Run first.
        first: Block,
        /// Run if that gave nothing.
        otherwise: Block,
    },
    /// Notes that an equation is near to losing roots: a [`Rest`](Self::Rest) that follows is run.
    Doubt {
        /// Compared in magnitude.
        value: Expr,
        /// With this: there is a doubt where it is smaller.
        tolerance: f64,
    },
    /// Runs the block if no candidate at all was accepted before it, or if there was a doubt. Not in other statements.
    Rest(Block),
    /// A candidate solution: one value for each variable.
    Emit(Vec<Value>),
    /// A candidate with all that its check needs; only in programs that are [prepared](crate::passes::prepare) for a chain.
    Offer {
        /// As emitted.
        values: Vec<Value>,
        /// The value of each variable: angles in (-pi, pi].
        angles: Vec<Expr>,
        /// Squares of how far the candidate is from the pose: rotation (Frobenius norm, times its lever), position.
        misses: [Expr; 2],
    },
    /// Why the following statements hold; for readers and for the comments of generated sources.
    Note(String),
}

/// Statements in order.
pub type Block = Vec<Stmt>;

/// A solution program: from a pose and the free values to candidate solutions.
#[derive(Debug, Clone)]
pub struct Program {
    /// What kind of chain this is and how it is solved, in words.
    pub class: String,
    /// What is asked for.
    pub goal: crate::GoalType,
    /// Number of variables: those of the chain, then those of the joints that the goal type adds.
    pub variables: usize,
    /// Variables whose value the caller gives, ascending.
    pub free: Vec<usize>,
    /// How far the ideal chain of the program is from the described one (metres, radians; the larger).
    pub snap: f64,
    /// How far the equations of the ideal chain may be from those of the described one: an equation that misses its
    /// roots by less is tried where it comes nearest.
    pub slack: f64,
    /// Expressions.
    pub exprs: Exprs,
    /// The name of each [`Var`].
    pub names: Vec<String>,
    /// Statements.
    pub body: Block,
}

impl Program {
    /// A new name: `wanted`, or `wanted_2`, `wanted_3` … when taken.
    pub fn bind(&mut self, wanted: &str) -> Var {
        let mut name = wanted.to_owned();
        let mut number = 1;
        while self.names.contains(&name) {
            number += 1;
            name = format!("{wanted}_{number}");
        }
        self.names.push(name);
        Var(self.names.len() as u32 - 1)
    }

    /// The text form; [`from_text`](Self::from_text) reads it back.
    pub fn text(&self) -> String {
        print::program(self)
    }

    /// Reads the text form and validates it.
    pub fn from_text(text: &str) -> Result<Self, TextError> {
        let program = parse::program(text)?;
        program.validate().map_err(|invalid| TextError { line: 0, message: invalid.to_string() })?;
        Ok(program)
    }

    /// Checks that every name is bound before use, counts agree and numbers are finite.
    pub fn validate(&self) -> Result<(), Invalid> {
        validate::program(self)
    }

    /// Number of variables of the chain itself: the length of a solution.
    pub fn chain_variables(&self) -> usize {
        self.variables.saturating_sub(self.goal.added_joints())
    }

    /// The name of a variable.
    pub fn name(&self, var: Var) -> &str {
        &self.names[var.0 as usize]
    }

    /// Whether an equation of this kind is solved anywhere.
    pub fn uses(&self, kind: RootKind) -> bool {
        fn in_block(block: &Block, wanted: RootKind) -> bool {
            block.iter().any(|stmt| {
                matches!(stmt, Stmt::ForEach { kind, .. } if *kind == wanted)
                    || blocks_of(stmt).into_iter().any(|inner| in_block(inner, wanted))
            })
        }
        in_block(&self.body, kind)
    }

    /// Its remarks in the order of the text, each once: which equations it solves.
    pub fn remarks(&self) -> Vec<&str> {
        fn in_block<'a>(block: &'a Block, found: &mut Vec<&'a str>) {
            for stmt in block {
                match stmt {
                    Stmt::Note(words) if !found.contains(&words.as_str()) => found.push(words),
                    _ => blocks_of(stmt).into_iter().for_each(|inner| in_block(inner, found)),
                }
            }
        }
        let mut found = Vec::new();
        in_block(&self.body, &mut found);
        found
    }

    /// The text of one expression.
    pub fn expr_text(&self, e: Expr) -> String {
        print::expr(self, e)
    }
}

/// Calls `f` on each expression directly used by a statement, not by the statements nested in it.
pub fn exprs_of(stmt: &Stmt, mut f: impl FnMut(Expr)) {
    match stmt {
        Stmt::Let { value, .. } | Stmt::IfZero { value, .. } | Stmt::Doubt { value, .. } => f(*value),
        Stmt::ForEach { args, .. } => args.iter().for_each(|e| f(*e)),
        Stmt::Emit(values) => values.iter().flat_map(Value::exprs).for_each(f),
        Stmt::Offer { values, angles, misses } => {
            values.iter().flat_map(Value::exprs).chain(angles.iter().chain(misses).copied()).for_each(f);
        }
        Stmt::Note(_) | Stmt::Fallback { .. } | Stmt::Rest(_) => {}
    }
}

/// The blocks nested in a statement.
pub fn blocks_of(stmt: &Stmt) -> Vec<&Block> {
    match stmt {
        Stmt::ForEach { body, .. } => vec![body],
        Stmt::IfZero { then, otherwise, .. } => vec![then, otherwise],
        Stmt::Fallback { first, otherwise } => vec![first, otherwise],
        Stmt::Rest(body) => vec![body],
        _ => Vec::new(),
    }
}

/// The same statement with its direct expressions and nested blocks replaced.
pub fn map_stmt(stmt: &Stmt, expr: &mut dyn FnMut(Expr) -> Expr) -> Stmt {
    match stmt {
        Stmt::Let { var, value } => Stmt::Let { var: *var, value: expr(*value) },
        Stmt::ForEach { kind, args, out, body } => Stmt::ForEach {
            kind: *kind,
            args: args.iter().map(|e| expr(*e)).collect(),
            out: out.clone(),
            body: body.clone(),
        },
        Stmt::IfZero { value, tolerance, then, otherwise } => Stmt::IfZero {
            value: expr(*value),
            tolerance: *tolerance,
            then: then.clone(),
            otherwise: otherwise.clone(),
        },
        Stmt::Doubt { value, tolerance } => Stmt::Doubt { value: expr(*value), tolerance: *tolerance },
        Stmt::Emit(values) => Stmt::Emit(values.iter().map(|v| v.map(expr)).collect()),
        Stmt::Offer { values, angles, misses } => Stmt::Offer {
            values: values.iter().map(|v| v.map(expr)).collect(),
            angles: angles.iter().map(|e| expr(*e)).collect(),
            misses: misses.map(expr),
        },
        Stmt::Note(_) | Stmt::Fallback { .. } | Stmt::Rest(_) => stmt.clone(),
    }
}
