//! Functions, constants and methods of expressions. Trigonometry is `libm`'s, the same on every platform.

use std::f64::consts::{E, PI, TAU};

use super::value::Value;

/// The constant of this name.
pub(super) fn constant(name: &str) -> Option<Value> {
    match name {
        "pi" | "M_PI" => Some(Value::Float(PI)),
        "tau" => Some(Value::Float(TAU)),
        "e" => Some(Value::Float(E)),
        _ => None,
    }
}

/// The result of a function.
pub(super) fn call(name: &str, arguments: &[Value]) -> Result<Value, String> {
    if let [one] = arguments
        && let Some(function) = of_one_number(name)
    {
        let result = function(one.number()?);
        return if result.is_nan() {
            Err(format!("{name}({one}) has no value"))
        } else {
            Ok(Value::Float(result))
        };
    }
    let wrong = || format!("{name} cannot take {} arguments", arguments.len());
    Ok(match (name, arguments) {
        ("abs", [Value::Int(i)]) => i.checked_abs().map_or(Value::Float((*i as f64).abs()), Value::Int),
        ("abs", [x]) => Value::Float(x.number()?.abs()),
        ("floor", [x]) => whole(x.number()?.floor()),
        ("ceil", [x]) => whole(x.number()?.ceil()),
        // Python rounds halves to even.
        ("round", [x]) => whole(x.number()?.round_ties_even()),
        ("round", [x, Value::Int(digits @ 0..=15)]) => {
            let digits = usize::try_from(*digits).unwrap_or(0);
            Value::Float(
                format!("{:.digits$}", x.number()?).parse().map_err(|_| "not a finite number".to_owned())?,
            )
        }
        ("int", [Value::Text(text)]) => {
            Value::Int(text.trim().parse().map_err(|_| format!("`{text}` is not a whole number"))?)
        }
        ("int", [x]) => whole(x.number()?.trunc()),
        ("float", [Value::Text(text)]) => {
            Value::Float(text.trim().parse().map_err(|_| format!("`{text}` is not a number"))?)
        }
        ("float", [x]) => Value::Float(x.number()?),
        ("str", [x]) => Value::Text(x.to_string()),
        ("bool", [x]) => Value::Bool(x.is_true()),
        ("len", [Value::Text(text)]) => Value::Int(text.chars().count() as i64),
        ("len", [Value::List(items)]) => Value::Int(items.len() as i64),
        ("len", [Value::Dict(entries)]) => Value::Int(entries.len() as i64),
        ("list" | "tuple", [Value::List(items)]) => Value::List(items.clone()),
        ("min", _) => extreme(name, arguments, |a, b| a < b)?,
        ("max", _) => extreme(name, arguments, |a, b| a > b)?,
        ("pow", [a, b]) => Value::Float(libm::pow(a.number()?, b.number()?)),
        ("atan2", [y, x]) => Value::Float(libm::atan2(y.number()?, x.number()?)),
        ("hypot", [x, y]) => Value::Float(libm::hypot(x.number()?, y.number()?)),
        ("fmod", [x, y]) if y.number()? != 0.0 => Value::Float(libm::fmod(x.number()?, y.number()?)),
        _ if of_one_number(name).is_some() => return Err(wrong()),
        (
            "abs" | "floor" | "ceil" | "round" | "int" | "float" | "str" | "bool" | "len" | "pow" | "atan2"
            | "hypot",
            _,
        ) => {
            return Err(wrong());
        }
        _ => return Err(format!("there is no function `{name}`")),
    })
}

fn of_one_number(name: &str) -> Option<fn(f64) -> f64> {
    Some(match name {
        "sin" => libm::sin,
        "cos" => libm::cos,
        "tan" => libm::tan,
        "asin" => libm::asin,
        "acos" => libm::acos,
        "atan" => libm::atan,
        "sqrt" => libm::sqrt,
        "exp" => libm::exp,
        "log" => libm::log,
        "radians" => |degrees| degrees * (PI / 180.0),
        "degrees" => |radians| radians * (180.0 / PI),
        "fabs" => libm::fabs,
        _ => return None,
    })
}

fn whole(x: f64) -> Value {
    if x.abs() < 9e18 { Value::Int(x as i64) } else { Value::Float(x) }
}

fn extreme(name: &str, arguments: &[Value], better: fn(f64, f64) -> bool) -> Result<Value, String> {
    let items = match arguments {
        [Value::List(items)] => items,
        items => items,
    };
    let mut best = items.first().ok_or_else(|| format!("{name} of nothing"))?;
    for item in items {
        if better(item.number()?, best.number()?) {
            best = item;
        }
    }
    Ok(best.clone())
}

/// The result of a method of text, a list or a table.
pub(super) fn method(owner: &Value, name: &str, arguments: &[Value]) -> Result<Value, String> {
    let unknown = || Err(format!("{} has no method `{name}` of {} arguments", owner.kind(), arguments.len()));
    Ok(match (owner, name, arguments) {
        (Value::Text(t), "lower", []) => Value::Text(t.to_lowercase()),
        (Value::Text(t), "upper", []) => Value::Text(t.to_uppercase()),
        (Value::Text(t), "strip", []) => Value::Text(t.trim().to_owned()),
        (Value::Text(t), "startswith", [Value::Text(x)]) => Value::Bool(t.starts_with(x)),
        (Value::Text(t), "endswith", [Value::Text(x)]) => Value::Bool(t.ends_with(x)),
        (Value::Text(t), "replace", [Value::Text(from), Value::Text(to)]) if !from.is_empty() => {
            Value::Text(t.replace(from.as_str(), to))
        }
        (Value::Text(t), "split", []) => {
            Value::List(t.split_whitespace().map(|w| Value::Text(w.to_owned())).collect())
        }
        (Value::Text(t), "split", [Value::Text(by)]) if !by.is_empty() => {
            Value::List(t.split(by.as_str()).map(|w| Value::Text(w.to_owned())).collect())
        }
        (Value::Dict(d), "get", [key]) => d.get(&key.to_string()).cloned().unwrap_or(Value::None),
        (Value::Dict(d), "get", [key, default]) => d.get(&key.to_string()).unwrap_or(default).clone(),
        (Value::Dict(d), "keys", []) => Value::List(d.keys().cloned().map(Value::Text).collect()),
        (Value::Dict(d), "values", []) => Value::List(d.values().cloned().collect()),
        _ => return unknown(),
    })
}
