//! Macro calls.

use std::collections::BTreeSet;
use std::rc::Rc;

use super::expand::Expander;
use super::scope::{Macro, Parameter, Property, Scope};
use super::value::Value;
use crate::diag::{Severity, nearest};
use crate::xml::{Element, Node};

impl Expander<'_> {
    /// Expands a call of the macro `name` by `element`.
    pub(super) fn call(&mut self, element: &Element, name: &str, out: &mut Vec<Node>) {
        let Some(called) = self.macros.get(name).cloned() else {
            let mut message = format!("there is no macro `{name}`");
            if let Some(meant) = nearest(name, self.macros.keys().map(String::as_str)) {
                message += &format!("; did you mean `{meant}`?");
            }
            return self.error("R0252", element.span, message);
        };
        let Some(scope) = self.bound(element, name, &called) else { return };
        self.scopes.push(scope);
        let made = self.within(&called.file, |e| e.children(&called.body.children));
        self.scopes.pop();
        out.extend(made);
    }

    /// The scope of a call: parameters bound to what the caller gives, seen from the caller.
    fn bound(&mut self, element: &Element, name: &str, called: &Macro) -> Option<Scope> {
        let mut scope = Scope::default();
        let errors_before = self.found.count(Severity::Error);
        let given = self.children(&element.children);
        let mut blocks = given.iter().filter_map(|node| match node {
            Node::Element(block) => Some(block),
            Node::Text(..) => None,
        });
        for parameter in &called.parameters {
            let bound = match parameter {
                Parameter::Value { name, inherits, default } => {
                    self.argument_of(element, name, *inherits, default.as_deref()).map(|value| {
                        scope.properties.insert(name.clone(), Property::Value(value));
                    })
                }
                Parameter::Element(name) => blocks.next().map(|block| {
                    scope.blocks.insert(name.clone(), Rc::new(vec![Node::Element(block.clone())]));
                }),
                Parameter::Content(name) => blocks.next().map(|block| {
                    scope.blocks.insert(name.clone(), Rc::new(block.children.clone()));
                }),
            };
            if bound.is_none() {
                let what = match parameter {
                    Parameter::Value { name, .. } => format!("a value for `{name}`"),
                    Parameter::Element(name) | Parameter::Content(name) => format!("the block `{name}`"),
                };
                self.error("R0250", element.span, format!("macro `{name}` is called without {what}"));
            }
        }
        let known: BTreeSet<&str> = called
            .parameters
            .iter()
            .filter_map(|p| match p {
                Parameter::Value { name, .. } => Some(name.as_str()),
                _ => None,
            })
            .collect();
        for attribute in &element.attributes {
            let is_name_of_call = element.name == "xacro:call" && attribute.name == "macro";
            if !known.contains(attribute.name.as_str()) && !is_name_of_call {
                let mut message = format!("macro `{name}` has no parameter `{}`", attribute.name);
                if let Some(meant) = nearest(&attribute.name, known.iter().copied()) {
                    message += &format!("; did you mean `{meant}`?");
                }
                self.error("R0250", attribute.span, message);
            }
        }
        (self.found.count(Severity::Error) == errors_before).then_some(scope)
    }

    /// The value of a parameter, or `None` when nothing gives it one.
    fn argument_of(
        &mut self,
        element: &Element,
        name: &str,
        inherits: bool,
        default: Option<&str>,
    ) -> Option<Value> {
        let (text, span) = match element.attribute(name) {
            Some(attribute) => (attribute.value.clone(), attribute.span),
            None => {
                let outer = inherits && self.scopes.iter().any(|s| s.properties.contains_key(name));
                let text = if outer { format!("${{{name}}}") } else { default?.to_owned() };
                (text, element.span)
            }
        };
        match self.value_of(&text) {
            Ok(Value::Text(text)) => Some(Value::from_text(&text)),
            Ok(value) => Some(value),
            Err(message) => {
                self.error("R0251", span, message);
                // Told already; the call does not take place.
                Some(Value::None)
            }
        }
    }
}
