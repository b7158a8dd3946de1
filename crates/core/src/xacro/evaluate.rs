//! The value of an expression.

use super::functions;
use super::syntax::{Comparison, Expression, Operator};
use super::value::Value;

/// What names and files an expression can see.
pub(super) trait Names {
    /// The property of this name; `None` if there is none.
    fn property(&mut self, name: &str) -> Result<Option<Value>, String>;
    /// Counts what is made of values; fails when it is too much.
    fn spend(&mut self, size: usize) -> Result<(), String>;
    /// The argument of this name, for `xacro.arg`.
    fn argument(&mut self, name: &str) -> Result<Value, String>;
    /// The document of a YAML file, for `xacro.load_yaml`.
    fn load_yaml(&mut self, path: &str) -> Result<Value, String>;
}

/// The value of `expression`.
pub(super) fn evaluate(expression: &Expression, names: &mut dyn Names) -> Result<Value, String> {
    Ok(match expression {
        Expression::Literal(value) => value.clone(),
        Expression::Name(name) => match names.property(name)? {
            Some(value) => value,
            None => functions::constant(name).ok_or_else(|| format!("`{name}` is not defined"))?,
        },
        Expression::List(items) => {
            let items = items.iter().map(|item| evaluate(item, names)).collect::<Result<_, _>>()?;
            sized(Value::List(items), names)?
        }
        Expression::Dict(entries) => {
            let entries = entries.iter().map(|(key, value)| {
                let key = evaluate(key, names)?.to_string();
                Ok::<_, String>((key, evaluate(value, names)?))
            });
            let entries = entries.collect::<Result<_, _>>()?;
            sized(Value::Dict(entries), names)?
        }
        Expression::Negate(value) => match evaluate(value, names)? {
            Value::Int(i) => i.checked_neg().map_or(Value::Float(-(i as f64)), Value::Int),
            value => Value::Float(-value.number()?),
        },
        Expression::Not(value) => Value::Bool(!evaluate(value, names)?.is_true()),
        Expression::Binary(operator, left, right) => {
            let (left, right) = (evaluate(left, names)?, evaluate(right, names)?);
            sized(binary(*operator, &left, &right)?, names)?
        }
        Expression::Compare(first, rest) => {
            let mut left = evaluate(first, names)?;
            for (comparison, right) in rest {
                let right = evaluate(right, names)?;
                if !compare(*comparison, &left, &right)? {
                    return Ok(Value::Bool(false));
                }
                left = right;
            }
            Value::Bool(true)
        }
        Expression::And(left, right) => {
            let left = evaluate(left, names)?;
            if left.is_true() { evaluate(right, names)? } else { left }
        }
        Expression::Or(left, right) => {
            let left = evaluate(left, names)?;
            if left.is_true() { left } else { evaluate(right, names)? }
        }
        Expression::Choice(yes, condition, no) => {
            let chosen = if evaluate(condition, names)?.is_true() { yes } else { no };
            evaluate(chosen, names)?
        }
        Expression::Call(function, arguments) => call(function, arguments, names)?,
        Expression::Member(owner, name) => member(owner, name, names)?,
        Expression::Index(owner, index) => {
            let (owner, index) = (evaluate(owner, names)?, evaluate(index, names)?);
            indexed(&owner, &index)?
        }
    })
}

/// The value, once it is counted.
fn sized(value: Value, names: &mut dyn Names) -> Result<Value, String> {
    names.spend(value.size())?;
    Ok(value)
}

/// Modules whose members are reached by a dot.
fn is_module(expression: &Expression) -> bool {
    matches!(expression, Expression::Name(name) if ["math", "python", "xacro"].contains(&name.as_str()))
}

fn call(function: &Expression, arguments: &[Expression], names: &mut dyn Names) -> Result<Value, String> {
    let mut values = Vec::with_capacity(arguments.len());
    for argument in arguments {
        values.push(evaluate(argument, names)?);
    }
    let name = match function {
        Expression::Name(name) => name,
        Expression::Member(owner, name) if is_module(owner) => name,
        Expression::Member(owner, name) => return functions::method(&evaluate(owner, names)?, name, &values),
        _ => return Err("only functions can be called".to_owned()),
    };
    match (name.as_str(), values.as_slice()) {
        ("load_yaml", [path]) => names.load_yaml(&path.to_string()),
        ("arg", [name]) => names.argument(&name.to_string()),
        _ => functions::call(name, &values),
    }
}

fn member(owner: &Expression, name: &str, names: &mut dyn Names) -> Result<Value, String> {
    if is_module(owner) {
        return functions::constant(name).ok_or_else(|| format!("`{name}` is not defined"));
    }
    indexed(&evaluate(owner, names)?, &Value::Text(name.to_owned()))
}

fn indexed(owner: &Value, index: &Value) -> Result<Value, String> {
    let missing = || format!("there is no `{index}` in {}", owner.kind());
    match (owner, index) {
        (Value::Dict(entries), key) => entries.get(&key.to_string()).cloned().ok_or_else(missing),
        (Value::List(items), Value::Int(at)) => {
            let at = if *at < 0 { *at + items.len() as i64 } else { *at };
            usize::try_from(at).ok().and_then(|at| items.get(at)).cloned().ok_or_else(missing)
        }
        (Value::Text(text), Value::Int(at)) => {
            let count = text.chars().count() as i64;
            let at = if *at < 0 { *at + count } else { *at };
            let c = usize::try_from(at).ok().and_then(|at| text.chars().nth(at));
            c.map(|c| Value::Text(c.to_string())).ok_or_else(missing)
        }
        _ => Err(missing()),
    }
}

fn binary(operator: Operator, left: &Value, right: &Value) -> Result<Value, String> {
    match (operator, left, right) {
        (Operator::Add, Value::Text(a), Value::Text(b)) => return Ok(Value::Text(format!("{a}{b}"))),
        (Operator::Add, Value::List(a), Value::List(b)) => {
            return Ok(Value::List([a.as_slice(), b].concat()));
        }
        _ => {}
    }
    if let (Value::Int(a), Value::Int(b)) = (left, right) {
        let whole = match operator {
            Operator::Add => a.checked_add(*b),
            Operator::Subtract => a.checked_sub(*b),
            Operator::Multiply => a.checked_mul(*b),
            Operator::FloorDivide => {
                a.checked_div(*b).map(|d| if a % b != 0 && (*a < 0) != (*b < 0) { d - 1 } else { d })
            }
            Operator::Remainder => {
                a.checked_rem(*b).map(|r| if r != 0 && (r < 0) != (*b < 0) { r + b } else { r })
            }
            Operator::Power => u32::try_from(*b).ok().and_then(|b| a.checked_pow(b)),
            Operator::Divide => None,
        };
        if let Some(whole) = whole {
            return Ok(Value::Int(whole));
        }
    }
    let (a, b) = (left.number()?, right.number()?);
    if b == 0.0 && matches!(operator, Operator::Divide | Operator::FloorDivide | Operator::Remainder) {
        return Err("division by zero".to_owned());
    }
    Ok(Value::Float(match operator {
        Operator::Add => a + b,
        Operator::Subtract => a - b,
        Operator::Multiply => a * b,
        Operator::Divide => a / b,
        Operator::FloorDivide => (a / b).floor(),
        Operator::Remainder => a - b * (a / b).floor(),
        Operator::Power => libm::pow(a, b),
    }))
}

fn compare(comparison: Comparison, left: &Value, right: &Value) -> Result<bool, String> {
    let ordered = || -> Result<std::cmp::Ordering, String> {
        if let (Value::Text(a), Value::Text(b)) = (left, right) {
            return Ok(a.cmp(b));
        }
        left.number()?.partial_cmp(&right.number()?).ok_or_else(|| "not comparable".to_owned())
    };
    Ok(match comparison {
        Comparison::Equal => same(left, right),
        Comparison::NotEqual => !same(left, right),
        Comparison::Less => ordered()?.is_lt(),
        Comparison::LessEqual => ordered()?.is_le(),
        Comparison::Greater => ordered()?.is_gt(),
        Comparison::GreaterEqual => ordered()?.is_ge(),
        Comparison::In => contains(right, left)?,
        Comparison::NotIn => !contains(right, left)?,
    })
}

/// Equal as Python has it: numbers and truth values by value, everything else by kind and content.
fn same(left: &Value, right: &Value) -> bool {
    match (left.number(), right.number()) {
        (Ok(a), Ok(b)) => a == b,
        _ => left == right,
    }
}

fn contains(owner: &Value, item: &Value) -> Result<bool, String> {
    match owner {
        Value::List(items) => Ok(items.iter().any(|i| same(i, item))),
        Value::Dict(entries) => Ok(entries.contains_key(&item.to_string())),
        Value::Text(text) => Ok(text.contains(&item.to_string())),
        other => Err(format!("{} holds nothing", other.kind())),
    }
}
