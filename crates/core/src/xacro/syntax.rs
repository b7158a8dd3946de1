//! Expressions as trees, by precedence.

use super::lexer::{Token, tokens};
use super::value::Value;

/// Deepest nesting of an expression.
const MOST_NESTED: usize = 48;

/// Longest expression. It bounds the depth of the tree, and so of the walks over it.
const MOST_TOKENS: usize = 500;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Operator {
    Add,
    Subtract,
    Multiply,
    Divide,
    FloorDivide,
    Remainder,
    Power,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Comparison {
    Equal,
    NotEqual,
    Less,
    LessEqual,
    Greater,
    GreaterEqual,
    In,
    NotIn,
}

#[derive(Debug, Clone, PartialEq)]
pub(super) enum Expression {
    Literal(Value),
    Name(String),
    List(Vec<Expression>),
    Dict(Vec<(Expression, Expression)>),
    Negate(Box<Expression>),
    Not(Box<Expression>),
    Binary(Operator, Box<Expression>, Box<Expression>),
    Compare(Box<Expression>, Vec<(Comparison, Expression)>),
    And(Box<Expression>, Box<Expression>),
    Or(Box<Expression>, Box<Expression>),
    /// Value if true, condition, value if false.
    Choice(Box<Expression>, Box<Expression>, Box<Expression>),
    Call(Box<Expression>, Vec<Expression>),
    Member(Box<Expression>, String),
    Index(Box<Expression>, Box<Expression>),
}

/// The tree of the expression in `text`.
pub(super) fn parse(text: &str) -> Result<Expression, String> {
    let tokens = tokens(text)?;
    if tokens.len() > MOST_TOKENS {
        return Err(format!("the expression is longer than {MOST_TOKENS} words"));
    }
    let mut parser = Parser { tokens, at: 0, depth: 0 };
    let expression = parser.expression()?;
    match parser.tokens.get(parser.at) {
        None => Ok(expression),
        Some(token) => Err(format!("unexpected {}", shown(token))),
    }
}

fn shown(token: &Token) -> String {
    match token {
        Token::Int(i) => format!("`{i}`"),
        Token::Float(x) => format!("`{x}`"),
        Token::Text(text) => format!("text '{text}'"),
        Token::Name(name) => format!("`{name}`"),
        Token::Sign(sign) => format!("`{sign}`"),
    }
}

struct Parser {
    tokens: Vec<Token>,
    at: usize,
    depth: usize,
}

impl Parser {
    fn sign(&mut self, sign: &str) -> bool {
        let found = matches!(self.tokens.get(self.at), Some(Token::Sign(s)) if *s == sign);
        self.at += usize::from(found);
        found
    }

    fn word(&mut self, word: &str) -> bool {
        let found = matches!(self.tokens.get(self.at), Some(Token::Name(n)) if n == word);
        self.at += usize::from(found);
        found
    }

    fn expect(&mut self, sign: &str) -> Result<(), String> {
        if self.sign(sign) { Ok(()) } else { Err(format!("`{sign}` is missing")) }
    }

    /// `a if c else b`, the loosest.
    fn expression(&mut self) -> Result<Expression, String> {
        self.depth += 1;
        if self.depth > MOST_NESTED {
            return Err("the expression is nested too deep".to_owned());
        }
        let value = self.or()?;
        let value = if self.word("if") {
            let condition = self.or()?;
            if !self.word("else") {
                return Err("`if` without `else`".to_owned());
            }
            Expression::Choice(value.into(), condition.into(), self.expression()?.into())
        } else {
            value
        };
        self.depth -= 1;
        Ok(value)
    }

    fn or(&mut self) -> Result<Expression, String> {
        let mut left = self.and()?;
        while self.word("or") {
            left = Expression::Or(left.into(), self.and()?.into());
        }
        Ok(left)
    }

    fn and(&mut self) -> Result<Expression, String> {
        let mut left = self.not()?;
        while self.word("and") {
            left = Expression::And(left.into(), self.not()?.into());
        }
        Ok(left)
    }

    fn not(&mut self) -> Result<Expression, String> {
        // Counted, not recursive: a thousand `not` must not use up the stack.
        let mut times = 0;
        while self.word("not") {
            times += 1;
        }
        let value = self.comparison()?;
        Ok(match times {
            0 => value,
            odd if odd % 2 == 1 => Expression::Not(value.into()),
            _ => Expression::Not(Expression::Not(value.into()).into()),
        })
    }

    fn comparison(&mut self) -> Result<Expression, String> {
        let first = self.sum()?;
        let mut rest = Vec::new();
        while let Some(comparison) = self.comparison_sign() {
            rest.push((comparison, self.sum()?));
        }
        Ok(if rest.is_empty() { first } else { Expression::Compare(first.into(), rest) })
    }

    fn comparison_sign(&mut self) -> Option<Comparison> {
        let signs = [
            ("==", Comparison::Equal),
            ("!=", Comparison::NotEqual),
            ("<=", Comparison::LessEqual),
            (">=", Comparison::GreaterEqual),
            ("<", Comparison::Less),
            (">", Comparison::Greater),
        ];
        for (sign, comparison) in signs {
            if self.sign(sign) {
                return Some(comparison);
            }
        }
        if self.word("in") {
            return Some(Comparison::In);
        }
        let not_in = matches!(self.tokens.get(self.at..self.at + 2),
            Some([Token::Name(a), Token::Name(b)]) if a == "not" && b == "in");
        self.at += if not_in { 2 } else { 0 };
        not_in.then_some(Comparison::NotIn)
    }

    fn sum(&mut self) -> Result<Expression, String> {
        let mut left = self.product()?;
        loop {
            let operator = match () {
                () if self.sign("+") => Operator::Add,
                () if self.sign("-") => Operator::Subtract,
                () => return Ok(left),
            };
            left = Expression::Binary(operator, left.into(), self.product()?.into());
        }
    }

    fn product(&mut self) -> Result<Expression, String> {
        let mut left = self.signed()?;
        loop {
            let operator = match () {
                () if self.sign("*") => Operator::Multiply,
                () if self.sign("//") => Operator::FloorDivide,
                () if self.sign("/") => Operator::Divide,
                () if self.sign("%") => Operator::Remainder,
                () => return Ok(left),
            };
            left = Expression::Binary(operator, left.into(), self.signed()?.into());
        }
    }

    /// Signs bind looser than `**`: -2 ** 2 is -4.
    fn signed(&mut self) -> Result<Expression, String> {
        let mut negative = false;
        loop {
            if self.sign("-") {
                negative = !negative;
            } else if !self.sign("+") {
                break;
            }
        }
        let value = self.power()?;
        Ok(if negative { Expression::Negate(value.into()) } else { value })
    }

    fn power(&mut self) -> Result<Expression, String> {
        let base = self.postfix()?;
        if !self.sign("**") {
            return Ok(base);
        }
        self.depth += 1;
        if self.depth > MOST_NESTED {
            return Err("the expression is nested too deep".to_owned());
        }
        let exponent = self.signed()?;
        self.depth -= 1;
        Ok(Expression::Binary(Operator::Power, base.into(), exponent.into()))
    }

    fn postfix(&mut self) -> Result<Expression, String> {
        let mut value = self.atom()?;
        loop {
            value = if self.sign("(") {
                Expression::Call(value.into(), self.items(")")?)
            } else if self.sign("[") {
                let index = self.expression()?;
                self.expect("]")?;
                Expression::Index(value.into(), index.into())
            } else if self.sign(".") {
                match self.tokens.get(self.at) {
                    Some(Token::Name(name)) => {
                        let name = name.clone();
                        self.at += 1;
                        Expression::Member(value.into(), name)
                    }
                    _ => return Err("a name must follow `.`".to_owned()),
                }
            } else {
                return Ok(value);
            };
        }
    }

    /// Expressions between commas, up to `end`.
    fn items(&mut self, end: &str) -> Result<Vec<Expression>, String> {
        let mut items = Vec::new();
        while !self.sign(end) {
            items.push(self.expression()?);
            if !self.sign(",") {
                self.expect(end)?;
                break;
            }
        }
        Ok(items)
    }

    fn atom(&mut self) -> Result<Expression, String> {
        let Some(token) = self.tokens.get(self.at).cloned() else {
            return Err("the expression ends early".to_owned());
        };
        self.at += 1;
        Ok(match token {
            Token::Int(i) => Expression::Literal(Value::Int(i)),
            Token::Float(x) => Expression::Literal(Value::Float(x)),
            Token::Text(text) => Expression::Literal(Value::Text(text)),
            Token::Name(name) => match name.as_str() {
                "True" | "true" => Expression::Literal(Value::Bool(true)),
                "False" | "false" => Expression::Literal(Value::Bool(false)),
                "None" => Expression::Literal(Value::None),
                _ => Expression::Name(name),
            },
            Token::Sign("(") => {
                let mut items = self.items(")")?;
                match items.len() {
                    1 => items.remove(0),
                    _ => Expression::List(items),
                }
            }
            Token::Sign("[") => Expression::List(self.items("]")?),
            Token::Sign("{") => {
                let mut entries = Vec::new();
                while !self.sign("}") {
                    let key = self.expression()?;
                    self.expect(":")?;
                    entries.push((key, self.expression()?));
                    if !self.sign(",") {
                        self.expect("}")?;
                        break;
                    }
                }
                Expression::Dict(entries)
            }
            token => return Err(format!("unexpected {}", shown(&token))),
        })
    }
}
