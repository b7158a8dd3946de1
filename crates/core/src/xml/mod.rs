//! An XML tree with positions, read leniently.
//!
//! Robot descriptions in the wild are not always XML. A strict parser stops at the first fault; this one repairs what
//! has one meaning (a late declaration, an undeclared prefix), reports all faults with their places, and gives the
//! tree it could make of the rest. Names keep their prefix: `xacro:macro` is a name like any other.

mod file;
mod parse;
mod scan;

use crate::diag::Span;

pub(crate) use file::{decode, load};
pub(crate) use parse::{Limits, parse};

/// An attribute, entities resolved.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Attribute {
    /// Name with its prefix.
    pub(crate) name: String,
    /// Value with entities resolved.
    pub(crate) value: String,
    /// The value between its quotes.
    pub(crate) span: Span,
}

/// What an element holds. Comments and processing instructions are left out.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Node {
    /// A child element.
    Element(Element),
    /// Character data, entities resolved.
    Text(String, Span),
}

/// An element with everything in it.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Element {
    /// Name with its prefix.
    pub(crate) name: String,
    /// In file order; names are unique.
    pub(crate) attributes: Vec<Attribute>,
    /// In file order.
    pub(crate) children: Vec<Node>,
    /// The opening bracket and the name.
    pub(crate) span: Span,
}

impl Element {
    /// The attribute of this name.
    pub(crate) fn attribute(&self, name: &str) -> Option<&Attribute> {
        self.attributes.iter().find(|a| a.name == name)
    }

    /// The value of the attribute of this name.
    pub(crate) fn value(&self, name: &str) -> Option<&str> {
        self.attribute(name).map(|a| a.value.as_str())
    }

    /// Child elements, in file order.
    pub(crate) fn elements(&self) -> impl Iterator<Item = &Element> {
        self.children.iter().filter_map(|node| match node {
            Node::Element(element) => Some(element),
            Node::Text(..) => None,
        })
    }

    /// Child elements of this name, in file order.
    pub(crate) fn named<'a>(&'a self, name: &'a str) -> impl Iterator<Item = &'a Element> {
        self.elements().filter(move |e| e.name == name)
    }

    /// The first child element of this name.
    pub(crate) fn child(&self, name: &str) -> Option<&Element> {
        self.elements().find(|e| e.name == name)
    }

    /// The character data directly in this element, joined.
    pub(crate) fn text(&self) -> String {
        let texts = self.children.iter().filter_map(|node| match node {
            Node::Text(text, _) => Some(text.as_str()),
            Node::Element(_) => None,
        });
        texts.collect()
    }
}

#[cfg(test)]
mod tests;
