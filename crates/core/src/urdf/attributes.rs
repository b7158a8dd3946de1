//! Attributes of URDF elements: names and numbers, with a finding for each that is not as it should be.

use crate::diag::{Diagnostic, Diagnostics};
use crate::xml::{Attribute, Element};

/// The attribute, or an error that it is missing.
pub(super) fn required<'a>(
    element: &'a Element,
    name: &str,
    context: &str,
    found: &mut Diagnostics,
) -> Option<&'a Attribute> {
    let attribute = element.attribute(name).filter(|a| !a.value.trim().is_empty());
    if attribute.is_none() {
        let message = format!("`<{}>` of {context} has no attribute `{name}`", element.name);
        found.push(Diagnostic::error("R0208", message).at(element.span, format!("`{name}` is missing")));
    }
    attribute
}

/// The numbers of an attribute: `default` when absent, an error and `default` when they are not `N` finite numbers.
pub(super) fn numbers<const N: usize>(
    element: &Element,
    name: &str,
    default: [f64; N],
    found: &mut Diagnostics,
) -> [f64; N] {
    element.attribute(name).and_then(|a| parse_numbers(a, found)).unwrap_or(default)
}

/// The number of an attribute, if it is there and is one.
pub(super) fn number(element: &Element, name: &str, found: &mut Diagnostics) -> Option<f64> {
    element.attribute(name).and_then(|a| parse_numbers::<1>(a, found)).map(|[x]| x)
}

/// The `N` finite numbers that `attribute` holds, or an error in `found`.
pub(super) fn parse_numbers<const N: usize>(
    attribute: &Attribute,
    found: &mut Diagnostics,
) -> Option<[f64; N]> {
    let expected = if N == 1 { "a number".to_owned() } else { format!("{N} numbers separated by spaces") };
    let mut fail = |message: String, label: &str, hint: Option<&str>| {
        let mut d = Diagnostic::error("R0209", message).at(attribute.span, label).expected(expected.clone());
        d.hint = hint.map(str::to_owned);
        found.push(d);
        None
    };
    let value = attribute.value.trim();
    if value.contains("${") || value.contains("$(") {
        let message = format!("`{}` holds an unexpanded xacro expression", attribute.name);
        return fail(
            message,
            "not a number yet",
            Some("expand the file with xacro, or give it the ending .xacro"),
        );
    }
    let words: Vec<&str> = value.split_whitespace().collect();
    if words.len() != N {
        let hint = value.contains(',').then_some("numbers are separated by spaces, not by commas");
        return fail(format!("`{}` holds {} values, not {N}", attribute.name, words.len()), "here", hint);
    }
    let mut numbers = [0.0; N];
    for (number, word) in numbers.iter_mut().zip(&words) {
        match word.parse::<f64>() {
            // Adding zero turns -0 into 0: one number, one spelling.
            Ok(x) if x.is_finite() => *number = x + 0.0,
            Ok(_) => return fail(format!("`{word}` is not a finite number"), "not finite", None),
            Err(_) => return fail(format!("`{word}` is not a number"), "not a number", None),
        }
    }
    Some(numbers)
}
