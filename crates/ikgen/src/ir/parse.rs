//! Reader of the text form.

use super::{Binary, Block, Expr, Exprs, Node, Program, RootKind, Stmt, Unary, Value, Var};

/// Why a text is not a program.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("line {line}: {message}")]
pub struct TextError {
    /// Line from 1; 0 when the program as a whole is meant.
    pub line: usize,
    /// What was found and expected.
    pub message: String,
}

/// Blocks and parentheses nest at most this deep, so that no text can exhaust the stack.
const MAX_DEPTH: usize = 200;

/// Expressions are at most this deep, a sum of many terms counted one deeper for each: what walks them does so recursively.
const MAX_EXPR_DEPTH: u32 = 1000;

#[derive(Debug, Clone, PartialEq)]
enum Token {
    Word(String),
    Number(f64),
    Text(String),
    Note(String),
    Sign(char),
    Arrow,
    End,
}

struct Reader {
    tokens: Vec<(usize, Token)>,
    at: usize,
    depth: usize,
    program: Program,
    /// Depth of each expression of the program.
    expr_depths: Vec<u32>,
}

pub(super) fn program(text: &str) -> Result<Program, TextError> {
    let program = Program {
        class: String::new(),
        goal: crate::GoalType::default(),
        variables: 0,
        free: Vec::new(),
        snap: 0.0,
        slack: 0.0,
        exprs: Exprs::default(),
        names: Vec::new(),
        body: Vec::new(),
    };
    let mut r = Reader { tokens: tokens(text)?, at: 0, depth: 0, program, expr_depths: Vec::new() };
    r.word("ikgen")?;
    if r.number()? != 1.0 {
        return Err(r.error("this version reads format 1"));
    }
    r.word("class")?;
    r.program.class = match r.next() {
        Token::Text(class) => class,
        _ => return Err(r.error("expected the class in quotes")),
    };
    if *r.peek() == Token::Word("goal".into()) {
        r.next();
        r.program.goal = match r.next() {
            Token::Word(name) => crate::GoalType::from_name(&name),
            _ => None,
        }
        .ok_or_else(|| r.error("expected a type of goal"))?;
    }
    r.word("variables")?;
    r.program.variables = r.count()?;
    r.word("free")?;
    r.sign('[')?;
    while *r.peek() != Token::Sign(']') {
        let variable = r.count()?;
        r.program.free.push(variable);
    }
    r.sign(']')?;
    r.word("snap")?;
    r.program.snap = r.number()?;
    r.word("slack")?;
    r.program.slack = r.number()?;
    r.program.body = r.block()?;
    match r.next() {
        Token::End => Ok(r.program),
        _ => Err(r.error("expected the end of the text")),
    }
}

fn tokens(text: &str) -> Result<Vec<(usize, Token)>, TextError> {
    let mut out = Vec::new();
    let mut line = 1;
    let mut rest = text;
    while let Some(c) = rest.chars().next() {
        let (length, token) = match c {
            '\n' => {
                line += 1;
                rest = &rest[1..];
                continue;
            }
            c if c.is_whitespace() => {
                rest = &rest[c.len_utf8()..];
                continue;
            }
            '#' => {
                let length = rest.find('\n').unwrap_or(rest.len());
                (length, Token::Note(rest[1..length].trim().to_owned()))
            }
            '"' => {
                let Some(end) = rest[1..].find(['"', '\n']).filter(|end| rest[1 + end..].starts_with('"'))
                else {
                    return Err(TextError { line, message: "a quote is not closed".into() });
                };
                (end + 2, Token::Text(rest[1..=end].to_owned()))
            }
            '-' if rest.starts_with("->") => (2, Token::Arrow),
            c if c.is_ascii_digit() => {
                let bytes = rest.as_bytes();
                let mut length = 0;
                while length < bytes.len()
                    && (bytes[length].is_ascii_alphanumeric()
                        || bytes[length] == b'.'
                        || (length > 0
                            && b"+-".contains(&bytes[length])
                            && b"eE".contains(&bytes[length - 1])))
                {
                    length += 1;
                }
                let value = rest[..length].parse::<f64>().ok().filter(|x| x.is_finite());
                let Some(value) = value else {
                    return Err(TextError { line, message: format!("{} is not a number", &rest[..length]) });
                };
                (length, Token::Number(value))
            }
            c if c.is_ascii_alphabetic() || c == '_' => {
                let length =
                    rest.find(|c: char| !c.is_ascii_alphanumeric() && c != '_').unwrap_or(rest.len());
                (length, Token::Word(rest[..length].to_owned()))
            }
            c if "{}()[],=+-*/".contains(c) => (1, Token::Sign(c)),
            c => return Err(TextError { line, message: format!("unexpected character {c:?}") }),
        };
        out.push((line, token));
        rest = &rest[length..];
    }
    out.push((line, Token::End));
    Ok(out)
}

impl Reader {
    fn peek(&self) -> &Token {
        &self.tokens[self.at].1
    }

    fn next(&mut self) -> Token {
        let token = self.tokens[self.at].1.clone();
        if self.at + 1 < self.tokens.len() {
            self.at += 1;
        }
        token
    }

    fn error(&self, message: impl Into<String>) -> TextError {
        let line = self.tokens[self.at.saturating_sub(1)].0;
        TextError { line, message: message.into() }
    }

    fn word(&mut self, expected: &str) -> Result<(), TextError> {
        match self.next() {
            Token::Word(w) if w == expected => Ok(()),
            _ => Err(self.error(format!("expected {expected}"))),
        }
    }

    fn sign(&mut self, expected: char) -> Result<(), TextError> {
        match self.next() {
            Token::Sign(c) if c == expected => Ok(()),
            _ => Err(self.error(format!("expected {expected:?}"))),
        }
    }

    fn number(&mut self) -> Result<f64, TextError> {
        match self.next() {
            Token::Number(x) => Ok(x),
            _ => Err(self.error("expected a number")),
        }
    }

    fn count(&mut self) -> Result<usize, TextError> {
        let x = self.number()?;
        if x.fract() == 0.0 && (0.0..1000.0).contains(&x) {
            Ok(x as usize)
        } else {
            Err(self.error("expected a small count"))
        }
    }

    fn bind(&mut self, token: Token) -> Result<Var, TextError> {
        match token {
            Token::Word(w) if leaf(&w).is_none() && !self.program.names.contains(&w) => {
                self.program.names.push(w);
                Ok(Var(self.program.names.len() as u32 - 1))
            }
            Token::Word(w) => Err(self.error(format!("{w} already means something"))),
            _ => Err(self.error("expected a name")),
        }
    }

    fn deeper(&mut self) -> Result<(), TextError> {
        self.depth += 1;
        if self.depth > MAX_DEPTH { Err(self.error("nested too deeply")) } else { Ok(()) }
    }

    /// A number; minus zero becomes zero.
    fn constant(&mut self, x: f64) -> Result<Expr, TextError> {
        self.node(Node::Const((x + 0.0).to_bits()))
    }

    fn node(&mut self, node: Node) -> Result<Expr, TextError> {
        let depth = node.operands().map(|e| self.expr_depths[e.0 as usize]).max().map_or(0, |d| d + 1);
        if depth > MAX_EXPR_DEPTH {
            return Err(self.error("an expression has too many terms"));
        }
        let e = self.program.exprs.intern(node);
        if e.0 as usize == self.expr_depths.len() {
            self.expr_depths.push(depth);
        }
        Ok(e)
    }

    fn block(&mut self) -> Result<Block, TextError> {
        self.deeper()?;
        self.sign('{')?;
        let mut block = Vec::new();
        loop {
            let stmt = match self.next() {
                Token::Sign('}') => break,
                Token::Note(text) => Stmt::Note(text),
                Token::Word(w) => self.stmt(&w)?,
                _ => return Err(self.error("expected a statement")),
            };
            block.push(stmt);
        }
        self.depth -= 1;
        Ok(block)
    }

    fn stmt(&mut self, word: &str) -> Result<Stmt, TextError> {
        match word {
            "let" => {
                let name = self.next();
                self.sign('=')?;
                let value = self.sum()?;
                // Bound only now: a name cannot be used in its own value.
                let var = self.bind(name)?;
                Ok(Stmt::Let { var, value })
            }
            "zero" => {
                let (value, tolerance) = self.smallness()?;
                let then = self.block()?;
                self.word("else")?;
                let otherwise = self.block()?;
                Ok(Stmt::IfZero { value, tolerance, then, otherwise })
            }
            "first" => {
                let first = self.block()?;
                self.word("else")?;
                let otherwise = self.block()?;
                Ok(Stmt::Fallback { first, otherwise })
            }
            "doubt" => {
                let (value, tolerance) = self.smallness()?;
                Ok(Stmt::Doubt { value, tolerance })
            }
            "rest" => Ok(Stmt::Rest(self.block()?)),
            "emit" => {
                let mut values = Vec::new();
                loop {
                    match self.peek().clone() {
                        Token::Word(w) if w == "angle" => {
                            self.next();
                            self.sign('(')?;
                            let c = self.sum()?;
                            self.sign(',')?;
                            let s = self.sum()?;
                            self.sign(')')?;
                            values.push(Value::Angle(c, s));
                        }
                        Token::Word(w) if w == "length" => {
                            self.next();
                            self.sign('(')?;
                            let x = self.sum()?;
                            self.sign(')')?;
                            values.push(Value::Length(x));
                        }
                        _ => return Ok(Stmt::Emit(values)),
                    }
                }
            }
            _ => {
                let Some(kind) = RootKind::ALL.into_iter().find(|k| k.word() == word) else {
                    return Err(self.error(format!("{word} is not a statement")));
                };
                self.sign('(')?;
                let mut args = vec![self.sum()?];
                while *self.peek() == Token::Sign(',') {
                    self.next();
                    args.push(self.sum()?);
                }
                self.sign(')')?;
                if self.next() != Token::Arrow {
                    return Err(self.error("expected ->"));
                }
                let mut out = Vec::new();
                while *self.peek() != Token::Sign('{') {
                    let name = self.next();
                    out.push(self.bind(name)?);
                }
                let body = self.block()?;
                Ok(Stmt::ForEach { kind, args, out, body })
            }
        }
    }

    /// A value and what it is compared with, in parentheses.
    fn smallness(&mut self) -> Result<(Expr, f64), TextError> {
        self.sign('(')?;
        let value = self.sum()?;
        self.sign(',')?;
        let tolerance = self.number()?;
        self.sign(')')?;
        Ok((value, tolerance))
    }

    fn sum(&mut self) -> Result<Expr, TextError> {
        self.deeper()?;
        let mut left = self.product()?;
        loop {
            let f = match self.peek() {
                Token::Sign('+') => Binary::Add,
                Token::Sign('-') => Binary::Sub,
                _ => break,
            };
            self.next();
            let right = self.product()?;
            left = self.node(Node::Binary(f, left, right))?;
        }
        self.depth -= 1;
        Ok(left)
    }

    fn product(&mut self) -> Result<Expr, TextError> {
        let mut left = self.factor()?;
        loop {
            let f = match self.peek() {
                Token::Sign('*') => Binary::Mul,
                Token::Sign('/') => Binary::Div,
                _ => return Ok(left),
            };
            self.next();
            let right = self.factor()?;
            left = self.node(Node::Binary(f, left, right))?;
        }
    }

    fn factor(&mut self) -> Result<Expr, TextError> {
        self.deeper()?;
        let e = match self.next() {
            Token::Number(x) => self.constant(x)?,
            Token::Sign('-') => {
                if let Token::Number(x) = *self.peek() {
                    self.next();
                    self.constant(-x)?
                } else {
                    let a = self.factor()?;
                    self.node(Node::Unary(Unary::Neg, a))?
                }
            }
            Token::Sign('(') => {
                let e = self.sum()?;
                self.sign(')')?;
                e
            }
            Token::Word(w) => self.call(&w)?,
            _ => return Err(self.error("expected an expression")),
        };
        self.depth -= 1;
        Ok(e)
    }

    fn call(&mut self, word: &str) -> Result<Expr, TextError> {
        let unary = [
            ("sqrt", Unary::Sqrt),
            ("sin", Unary::Sin),
            ("cos", Unary::Cos),
            ("opposite", Unary::Opposite),
            ("mirrored", Unary::Mirrored),
        ];
        let binary = [("min", Binary::Min), ("max", Binary::Max), ("angle_of", Binary::AngleOf)];
        if let Some((_, f)) = unary.into_iter().find(|(w, _)| *w == word) {
            self.sign('(')?;
            let a = self.sum()?;
            self.sign(')')?;
            return self.node(Node::Unary(f, a));
        }
        if let Some((_, f)) = binary.into_iter().find(|(w, _)| *w == word) {
            self.sign('(')?;
            let a = self.sum()?;
            self.sign(',')?;
            let b = self.sum()?;
            self.sign(')')?;
            return self.node(Node::Binary(f, a, b));
        }
        if let Some(node) = leaf(word) {
            return self.node(node);
        }
        match self.program.names.iter().position(|n| n == word) {
            Some(i) => self.node(Node::Var(Var(i as u32))),
            None => Err(self.error(format!("{word} is not bound here"))),
        }
    }
}

/// The input of this name.
fn leaf(word: &str) -> Option<Node> {
    match word.as_bytes() {
        [b'p', axis @ b'x'..=b'z'] => Some(Node::Position(axis - b'x')),
        [b'r', i @ b'0'..=b'2', j @ b'0'..=b'2'] => Some(Node::Rotation(i - b'0', j - b'0')),
        [b'f', b'r', b'e', b'e', k @ b'0'..=b'9'] => Some(Node::Free(k - b'0')),
        _ => None,
    }
}
