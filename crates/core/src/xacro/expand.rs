//! The walk over a description that carries out its xacro elements.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::rc::Rc;

use super::Given;
use super::scope::{Macro, Property, Scope, parameters};
use super::value::Value;
use crate::diag::{Diagnostic, Diagnostics, Severity, Sources, Span};
use crate::system::System;
use crate::xml::{self, Attribute, Element, Node};

/// Deepest nesting of elements, macro calls and properties together.
const MOST_NESTED: usize = 150;

/// Most elements of an expanded description.
const MOST_ELEMENTS: usize = 300_000;

/// Most bytes of text and values that an expansion makes, those of in-between results counted: each of a few properties can
/// double what the one before it holds, each of a few blocks insert the one before it twice.
const MOST_MADE: usize = 1 << 25;

/// Errors after which the expansion stops: the rest is likely to follow from them.
const MOST_ERRORS: usize = 40;

/// The state of an expansion.
pub(super) struct Expander<'a> {
    pub(super) system: &'a dyn System,
    pub(super) packages: &'a BTreeMap<String, PathBuf>,
    /// Folders that `$(find)` and `$(dirname)` gave, and of which package: paths that begin with one are not relative to a file.
    pub(super) folders: BTreeMap<PathBuf, Option<String>>,
    sources: &'a mut Sources,
    /// The file being read and those that include it, outermost first.
    files: Vec<PathBuf>,
    pub(super) arguments: BTreeMap<String, String>,
    pub(super) macros: BTreeMap<String, Rc<Macro>>,
    /// The scope of the file, then one for each macro call that is open.
    pub(super) scopes: Vec<Scope>,
    depth: usize,
    /// Elements made.
    made: usize,
    /// Bytes of text and values made.
    spent: usize,
    stopped: bool,
    /// Whether the file writes xacro's own elements without their prefix, as was allowed long ago.
    unprefixed: bool,
    pub(super) found: Diagnostics,
}

impl<'a> Expander<'a> {
    pub(super) fn new(
        system: &'a dyn System,
        sources: &'a mut Sources,
        path: &Path,
        given: Given<'a>,
    ) -> Self {
        Self {
            system,
            packages: given.packages,
            folders: BTreeMap::new(),
            sources,
            files: vec![path.to_owned()],
            arguments: given.arguments.clone(),
            macros: BTreeMap::new(),
            scopes: vec![Scope::default()],
            depth: 0,
            made: 0,
            spent: 0,
            stopped: false,
            unprefixed: false,
            found: Diagnostics::new(),
        }
    }

    pub(super) fn run(mut self, root: &Element) -> (Element, Diagnostics) {
        let copy = self.copied(root);
        let expanded = self.filled(copy, &root.children);
        if self.found.iter().all(|d| d.code != "R0253") {
            return (expanded, self.found);
        }
        // What a missing file would have defined is missing for that reason alone.
        let mut told = Diagnostics::new();
        for finding in self.found {
            if finding.code != "R0252" && !finding.message.ends_with("is not defined") {
                told.push(finding);
            }
        }
        (expanded, told)
    }

    /// The file being read.
    pub(super) fn file(&self) -> &Path {
        self.files.last().map_or(Path::new(""), PathBuf::as_path)
    }

    /// The file that was asked for.
    pub(super) fn main_file(&self) -> &Path {
        &self.files[0]
    }

    /// Runs `step` as if in the file at `path`.
    pub(super) fn within<T>(&mut self, path: &Path, step: impl FnOnce(&mut Self) -> T) -> T {
        self.files.push(path.to_owned());
        let result = step(self);
        self.files.pop();
        result
    }

    pub(super) fn error(&mut self, code: &'static str, span: Span, message: impl Into<String>) {
        self.found.push(Diagnostic::error(code, message).at(span, "here"));
        self.stopped |= self.found.count(Severity::Error) >= MOST_ERRORS;
    }

    /// Counts bytes that are made; fails when there are too many of them.
    pub(super) fn spend(&mut self, size: usize) -> Result<(), String> {
        self.spent = self.spent.saturating_add(size);
        if self.spent <= MOST_MADE { Ok(()) } else { Err("the description grows without end".to_owned()) }
    }

    /// As [`spend`](Self::spend), for what an element holds: the expansion stops when there is too much of it.
    fn spend_on(&mut self, element: &Element, elements: usize, characters: usize) -> bool {
        self.made = self.made.saturating_add(elements);
        let fits = self.spend(characters).is_ok() && self.made <= MOST_ELEMENTS;
        if !fits && !self.stopped {
            self.stopped = true;
            let message = format!("the expansion of `<{}>` does not end", element.name);
            self.error("R0254", element.span, message);
        }
        fits
    }

    /// Runs `step` one level deeper, or fails when that is too deep.
    pub(super) fn deeper<T>(
        &mut self,
        step: impl FnOnce(&mut Self) -> Result<T, String>,
    ) -> Result<T, String> {
        if self.depth >= MOST_NESTED {
            return Err(format!("nested more than {MOST_NESTED} deep: does it use itself?"));
        }
        self.depth += 1;
        let result = step(self);
        self.depth -= 1;
        result
    }

    /// `nodes` expanded.
    pub(super) fn children(&mut self, nodes: &[Node]) -> Vec<Node> {
        let mut out = Vec::new();
        for node in nodes {
            match node {
                Node::Element(element) => self.element(element, &mut out),
                Node::Text(text, span) if text.contains('$') => match self.text_of(text) {
                    Ok(text) => out.push(Node::Text(text, *span)),
                    Err(message) => self.error("R0251", *span, message),
                },
                text => out.push(text.clone()),
            }
        }
        out
    }

    fn element(&mut self, element: &Element, out: &mut Vec<Node>) {
        if self.stopped || !self.spend_on(element, 1, own_size(element)) {
            return;
        }
        if self.depth >= MOST_NESTED {
            self.stopped = true;
            let message = format!("the expansion of `<{}>` does not end", element.name);
            self.error("R0254", element.span, message);
            return;
        }
        self.depth += 1;
        match self.xacro_name(element) {
            None => {
                let copy = self.copied(element);
                out.push(Node::Element(self.filled(copy, &element.children)));
            }
            Some("property") => self.property(element),
            Some("arg") => self.declare_argument(element),
            Some("include") => self.include(element, out),
            Some("macro") => self.define(element),
            Some("if") => self.condition(element, true, out),
            Some("unless") => self.condition(element, false, out),
            Some("insert_block") => self.insert_block(element, out),
            Some("element") => self.computed_element(element, out),
            Some("attribute") => self.computed_attribute(element, out),
            Some("call") => {
                if let Some(name) = self.required_text(element, "macro") {
                    self.call(element, &name, out);
                }
            }
            Some(name) => self.call(element, name, out),
        }
        self.depth -= 1;
    }

    /// The name of a xacro element without its prefix; `None` for an element of the description.
    fn xacro_name<'e>(&mut self, element: &'e Element) -> Option<&'e str> {
        if let Some(name) = element.name.strip_prefix("xacro:") {
            return Some(name);
        }
        let name = element.name.as_str();
        let is_definition = match name {
            "property" | "macro" => element.attribute("name").is_some(),
            "include" => element.attribute("filename").is_some(),
            _ => false,
        };
        if is_definition && self.depth == 1 && !self.unprefixed {
            self.unprefixed = true;
            let message = format!("`<{name}>` is written without the prefix `xacro:`");
            let hint = format!("write <xacro:{name}>; newer programs ignore the old spelling");
            self.found
                .push(Diagnostic::warning("R0250", message).at(element.span, "old spelling").hint(hint));
        }
        let is_known = ["property", "include", "macro", "insert_block", "if", "unless"].contains(&name)
            || self.macros.contains_key(name);
        (self.unprefixed && is_known).then_some(name)
    }

    /// The element with its attributes expanded, without children.
    fn copied(&mut self, element: &Element) -> Element {
        let mut attributes = Vec::with_capacity(element.attributes.len());
        for attribute in &element.attributes {
            if attribute.name == "xmlns:xacro" {
                continue;
            }
            let value = match attribute.value.contains('$') {
                false => attribute.value.clone(),
                true => match self.text_of(&attribute.value) {
                    Ok(value) if attribute.name == "filename" => self.as_reference(value),
                    Ok(value) => value,
                    Err(message) => {
                        self.error("R0251", attribute.span, message);
                        continue;
                    }
                },
            };
            attributes.push(Attribute { value, ..attribute.clone() });
        }
        Element { name: element.name.clone(), attributes, children: Vec::new(), span: element.span }
    }

    /// `element` with `children` expanded in it, computed attributes among them.
    fn filled(&mut self, mut element: Element, children: &[Node]) -> Element {
        for node in self.children(children) {
            match node {
                Node::Element(carrier) if carrier.name == CARRIER => {
                    for attribute in carrier.attributes {
                        element.attributes.retain(|a| a.name != attribute.name);
                        element.attributes.push(attribute);
                    }
                }
                node => element.children.push(node),
            }
        }
        element
    }

    /// The attribute as written, or an error that it is missing.
    pub(super) fn required<'e>(&mut self, element: &'e Element, name: &str) -> Option<&'e Attribute> {
        let attribute = element.attribute(name);
        if attribute.is_none() {
            self.error("R0250", element.span, format!("`<{}>` has no attribute `{name}`", element.name));
        }
        attribute
    }

    /// The attribute expanded, or an error.
    pub(super) fn required_text(&mut self, element: &Element, name: &str) -> Option<String> {
        let attribute = self.required(element, name)?;
        match self.text_of(&attribute.value) {
            Ok(text) => Some(text),
            Err(message) => {
                self.error("R0251", attribute.span, message);
                None
            }
        }
    }

    fn property(&mut self, element: &Element) {
        let Some(name) = self.required_text(element, "name") else { return };
        let innermost = self.scopes.len() - 1;
        let at = match element.value("scope") {
            None => innermost,
            Some("parent") => innermost.saturating_sub(1),
            Some("global") => 0,
            Some(other) => {
                return self.error(
                    "R0250",
                    element.span,
                    format!("scope `{other}` is neither `parent` nor `global`"),
                );
            }
        };
        if let Some(default) = element.attribute("default")
            && element.attribute("value").is_none()
        {
            if !self.scopes.iter().any(|s| s.properties.contains_key(&name)) {
                self.scopes[at].properties.insert(name, Property::Written(default.value.clone()));
            }
            return;
        }
        let Some(value) = element.attribute("value") else {
            let block = Rc::new(self.children(&element.children));
            self.scopes[at].blocks.insert(name, block);
            return;
        };
        // A value for an outer scope, or one that may name what it replaces, is worked out here and now.
        let replaces = self.scopes.iter().any(|s| s.properties.contains_key(&name));
        let property = if at == innermost && !replaces {
            Property::Written(value.value.clone())
        } else {
            match self.value_of(&value.value) {
                Ok(Value::Text(text)) => Property::Value(Value::from_text(&text)),
                Ok(value) => Property::Value(value),
                Err(message) => return self.error("R0251", value.span, message),
            }
        };
        self.scopes[at].properties.insert(name, property);
    }

    fn declare_argument(&mut self, element: &Element) {
        let Some(name) = self.required_text(element, "name") else { return };
        if self.arguments.contains_key(&name) {
            return;
        }
        if let Some(default) = element.attribute("default") {
            match self.text_of(&default.value) {
                Ok(text) => {
                    self.arguments.insert(name, text);
                }
                Err(message) => self.error("R0251", default.span, message),
            }
        }
    }

    fn include(&mut self, element: &Element, out: &mut Vec<Node>) {
        let Some(attribute) = self.required(element, "filename") else { return };
        if element.attribute("ns").is_some() {
            self.error("R0250", element.span, "includes with a namespace (`ns`) are not supported");
            return;
        }
        let path = match self.text_of(&attribute.value) {
            Ok(name) => self.relative(&name),
            Err(message) => return self.error("R0253", attribute.span, message),
        };
        if !self.system.exists(&path) {
            if !matches!(element.value("optional"), Some("true" | "True" | "1")) {
                self.error("R0253", attribute.span, format!("there is no file {}", path.display()));
            }
            return;
        }
        let (root, found) = xml::load(self.system, self.sources, &path);
        self.found.extend(found);
        if let Some(root) = root {
            let included = self.within(&path, |e| e.children(&root.children));
            out.extend(included);
        }
    }

    fn define(&mut self, element: &Element) {
        let Some(name) = self.required_text(element, "name") else { return };
        let list = element.attribute("params");
        match parameters(list.map_or("", |a| a.value.as_str())) {
            Ok(parameters) => {
                let file = self.file().to_owned();
                let name = name.strip_prefix("xacro:").unwrap_or(&name).to_owned();
                self.macros.insert(name, Rc::new(Macro { parameters, body: element.clone(), file }));
            }
            Err(message) => self.error("R0250", list.map_or(element.span, |a| a.span), message),
        }
    }

    fn condition(&mut self, element: &Element, wanted: bool, out: &mut Vec<Node>) {
        let Some(attribute) = self.required(element, "value") else { return };
        match self.value_of(&attribute.value).and_then(|value| value.condition()) {
            Ok(is) if is == wanted => out.extend(self.children(&element.children)),
            Ok(_) => {}
            Err(message) => self.error("R0251", attribute.span, message),
        }
    }

    fn insert_block(&mut self, element: &Element, out: &mut Vec<Node>) {
        let Some(name) = self.required_text(element, "name") else { return };
        match self.scopes.iter().rev().find_map(|s| s.blocks.get(&name)) {
            Some(block) => {
                let block = block.clone();
                let (elements, characters) = size(&block);
                if self.spend_on(element, elements, characters) {
                    out.extend(block.iter().cloned());
                }
            }
            None => self.error("R0252", element.span, format!("there is no block `{name}`")),
        }
    }

    fn computed_element(&mut self, element: &Element, out: &mut Vec<Node>) {
        let Some(name) = self.required_text(element, "xacro:name") else { return };
        let mut copy = self.copied(element);
        copy.attributes.retain(|a| a.name != "xacro:name");
        copy.name = name;
        out.push(Node::Element(self.filled(copy, &element.children)));
    }

    /// An attribute of the element around it. The tree is built from the inside, so it travels as an element of a name
    /// that no file can hold, and `filled` puts it in its place.
    fn computed_attribute(&mut self, element: &Element, out: &mut Vec<Node>) {
        let (Some(name), Some(value)) =
            (self.required_text(element, "name"), self.required_text(element, "value"))
        else {
            return;
        };
        let attribute = Attribute { name, value, span: element.span };
        let carrier = Element {
            name: CARRIER.to_owned(),
            attributes: vec![attribute],
            children: Vec::new(),
            span: element.span,
        };
        out.push(Node::Element(carrier));
    }
}

/// Characters of an element and of the text in it, its children left out.
fn own_size(element: &Element) -> usize {
    let attributes = element.attributes.iter().map(|a| a.name.len() + a.value.len());
    let text = element.children.iter().map(|node| match node {
        Node::Text(text, _) => text.len(),
        Node::Element(_) => 0,
    });
    element.name.len() + attributes.chain(text).sum::<usize>()
}

/// Elements and characters of nodes with all that is in them.
fn size(nodes: &[Node]) -> (usize, usize) {
    let (mut elements, mut characters) = (0, 0);
    let mut open: Vec<&Node> = nodes.iter().collect();
    while let Some(node) = open.pop() {
        if let Node::Element(element) = node {
            elements += 1;
            characters += own_size(element);
            open.extend(&element.children);
        }
    }
    (elements, characters)
}

/// Name of the elements that carry computed attributes.
const CARRIER: &str = "<attribute>";
