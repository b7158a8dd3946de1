//! The words of an expression.

/// A word.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Token {
    Int(i64),
    Float(f64),
    Text(String),
    Name(String),
    /// An operator or bracket.
    Sign(&'static str),
}

/// Longest first, so that `**` is not read as two stars.
const SIGNS: [&str; 23] = [
    "**", "//", "==", "!=", "<=", ">=", "+", "-", "*", "/", "%", "<", ">", "(", ")", "[", "]", "{", "}", ",",
    ":", ".", "=",
];

/// The words of `text`.
pub(super) fn tokens(text: &str) -> Result<Vec<Token>, String> {
    let mut tokens = Vec::new();
    let mut rest = text.trim_start();
    while let Some(first) = rest.chars().next() {
        let length = if first.is_ascii_digit()
            || (first == '.' && rest[1..].starts_with(|c: char| c.is_ascii_digit()))
        {
            let (token, length) = number(rest)?;
            tokens.push(token);
            length
        } else if first == '\'' || first == '"' {
            let length = rest[1..].find(first).ok_or_else(|| format!("text without closing {first}"))?;
            tokens.push(Token::Text(rest[1..=length].to_owned()));
            length + 2
        } else if first.is_alphabetic() || first == '_' {
            let length = rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(rest.len());
            tokens.push(Token::Name(rest[..length].to_owned()));
            length
        } else {
            let sign = SIGNS.iter().find(|sign| rest.starts_with(**sign));
            let sign = sign.ok_or_else(|| format!("unexpected character `{first}`"))?;
            tokens.push(Token::Sign(sign));
            sign.len()
        };
        rest = rest[length..].trim_start();
    }
    Ok(tokens)
}

fn number(text: &str) -> Result<(Token, usize), String> {
    let bytes = text.as_bytes();
    let mut length = 0;
    let mut whole = true;
    while let Some(&b) = bytes.get(length) {
        match b {
            b'0'..=b'9' => {}
            b'.' => whole = false,
            b'e' | b'E' => {
                whole = false;
                if matches!(bytes.get(length + 1), Some(b'+' | b'-')) {
                    length += 1;
                }
            }
            _ => break,
        }
        length += 1;
    }
    let word = &text[..length];
    let token = match whole {
        true => word.parse().ok().map(Token::Int),
        false => None,
    };
    match token.or_else(|| word.parse().ok().map(Token::Float)) {
        Some(token) => Ok((token, length)),
        None => Err(format!("`{word}` is not a number")),
    }
}
