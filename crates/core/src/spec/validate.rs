//! Checks a tree of values against a schema and finds everything that is wrong with it.

use std::f64::consts::PI;

use super::describe::{count, describe, describe_list, first_sentence, integers, listed, quoted, value_kind};
use super::document::{Entry, Node, Table, Value};
use super::parameters::{KindParameters, ParameterTable};
use super::schema::{Key, Kind, Length, Presence, Range, Rule, TableSchema, Text};
use crate::diag::{Diagnostic, Diagnostics, Span, nearest};

/// All findings about `table`, in no particular order. `place` is where missing keys are reported.
pub(super) fn validate(
    table: &Table,
    place: Span,
    schema: &TableSchema,
    parameters: &ParameterTable,
    diagnostics: &mut Diagnostics,
) {
    Checker { root: schema, parameters, diagnostics }.table(table, place, schema, "");
}

struct Checker<'a> {
    /// The schema of the whole file.
    root: &'a TableSchema,
    parameters: &'a ParameterTable,
    diagnostics: &'a mut Diagnostics,
}

impl Checker<'_> {
    /// `path` names the table in messages; empty for the whole file.
    fn table(&mut self, table: &Table, place: Span, schema: &TableSchema, path: &str) {
        // Keys that an unknown key probably stands for.
        let mut meant = Vec::new();
        for entry in &table.entries {
            match schema.key(&entry.key) {
                Some(key) => self.node(&entry.node, key.kind, &join(path, &entry.key)),
                None => meant.extend(self.unknown_key(entry, schema)),
            }
        }
        for key in schema.keys {
            let absent = table.get(key.name).is_none() && !meant.contains(&key.name);
            if absent && key.presence == Presence::Required {
                self.missing(key, place, path);
            }
        }
        for rule in schema.rules {
            self.rule(table, place, schema, rule, &meant, path);
        }
    }

    /// Reports an unknown key; returns the key it probably stands for.
    fn unknown_key(&mut self, entry: &Entry, schema: &TableSchema) -> Option<&'static str> {
        let known = || schema.keys.iter().map(|k| k.name);
        let near = nearest(&entry.key, known());
        let elsewhere = if near.is_none() { heading_of(self.root, &entry.key, "") } else { None };
        let mut diagnostic = Diagnostic::error("R0102", format!("there is no key `{}` here", entry.key))
            .at(entry.key_span, "unknown key")
            .expected(format!("one of {}", listed(known())));
        if let Some(near) = near {
            diagnostic = diagnostic.hint(format!("did you mean `{near}`?"));
        } else if self.root.key(&entry.key).is_some() {
            diagnostic = diagnostic.hint(format!(
                "`{}` is a key of the file itself: it goes above the first line in square brackets",
                entry.key
            ));
        } else if let Some(heading) = elsewhere {
            diagnostic = diagnostic.hint(format!("`{}` is a key of {heading}", entry.key));
        }
        self.diagnostics.push(diagnostic);
        near
    }

    fn missing(&mut self, key: &Key, place: Span, path: &str) {
        let what = if path.is_empty() { "this file".to_owned() } else { format!("`{path}`") };
        let expected = match key.kind {
            Kind::Tables(..) => format!("a table `[[{}]]`", key.name),
            kind => format!("`{}`: {}", key.name, describe(kind)),
        };
        self.diagnostics.push(
            Diagnostic::error("R0103", format!("{what} lacks the key `{}`", key.name))
                .at(place, format!("`{}` is missing", key.name))
                .expected(expected)
                .hint(first_sentence(key.doc)),
        );
    }

    /// `meant`: what unknown keys probably stand for.
    fn rule(
        &mut self,
        table: &Table,
        place: Span,
        schema: &TableSchema,
        rule: &Rule,
        meant: &[&str],
        path: &str,
    ) {
        match *rule {
            Rule::ExactlyOne(keys) => self.exactly_one(table, place, keys, path),
            Rule::OneWith { keys, with } => match table.get(with) {
                Some(_) => self.exactly_one(table, place, keys, path),
                None => self.only_with(table, keys, with),
            },
            Rule::OnlyWith { keys, with } => {
                if table.get(with).is_none() {
                    self.only_with(table, keys, with);
                }
            }
            Rule::Goes { key, value, then } => {
                let applies = table.get(key).and_then(Node::text) == Some(value);
                match (applies, table.entry(then), schema.key(then)) {
                    (true, None, Some(needed)) => self.missing(needed, place, path),
                    (false, Some(entry), _) => {
                        self.without_effect(entry, format!("with `{key} = \"{value}\"`"))
                    }
                    _ => {}
                }
            }
            Rule::Unless { key, value, needed, allowed } => {
                if table.get(key).and_then(Node::text) == Some(value) {
                    let barred = needed.iter().chain(allowed);
                    for entry in barred.filter_map(|barred| table.entry(barred)) {
                        self.without_effect(entry, format!("without `{key} = \"{value}\"`"));
                    }
                } else {
                    let absent = |name: &&str| table.get(name).is_none() && !meant.contains(name);
                    for key in needed.iter().copied().filter(absent).filter_map(|name| schema.key(name)) {
                        self.missing(key, place, path);
                    }
                }
            }
        }
    }

    fn exactly_one(&mut self, table: &Table, place: Span, keys: &[&'static str], path: &str) {
        let present: Vec<&Entry> = keys.iter().filter_map(|key| table.entry(key)).collect();
        let expected = format!("exactly one of {}", listed(keys.iter().copied()));
        match present[..] {
            [_] => {}
            [] => self.diagnostics.push(
                Diagnostic::error("R0109", format!("`{path}` says none of {}", listed(keys.iter().copied())))
                    .at(place, "one is needed here")
                    .expected(expected),
            ),
            [first, ref rest @ ..] => {
                for entry in rest {
                    self.diagnostics.push(
                        Diagnostic::error(
                            "R0109",
                            format!("`{path}` says both `{}` and `{}`", first.key, entry.key),
                        )
                        .at(entry.key_span, "one too many")
                        .expected(expected.clone()),
                    );
                }
            }
        }
    }

    fn only_with(&mut self, table: &Table, keys: &[&'static str], with: &str) {
        for entry in keys.iter().filter_map(|key| table.entry(key)) {
            self.without_effect(entry, format!("beside `{with}`"));
        }
    }

    fn without_effect(&mut self, entry: &Entry, when: String) {
        self.diagnostics.push(
            Diagnostic::error("R0110", format!("`{}` has no meaning here", entry.key))
                .at(entry.key_span, "nothing would read this")
                .expected(format!("`{}` only {when}", entry.key)),
        );
    }

    fn node(&mut self, node: &Node, kind: Kind, path: &str) {
        match (kind, &node.value) {
            (Kind::Bool, Value::Bool(_)) | (_, Value::Unreadable) => {}
            (Kind::Integer(min, max), Value::Integer(i)) => {
                if !(min..=max).contains(i) {
                    self.out_of_range(node, path, i, &integers(min, max), None);
                }
            }
            (Kind::Number(range), Value::Integer(_) | Value::Float(_)) => self.number(node, range, path),
            (Kind::Text(format), Value::Text(text)) => self.text(node, format, text, path),
            (Kind::Choice(words), Value::Text(text)) => self.word(node, words, text, path),
            (Kind::List(item, length), Value::List(items)) => self.list(node, items, *item, length, path),
            (Kind::Table(schema), Value::Table(table)) => self.table(table, node.span, schema, path),
            (Kind::Tables(schema, unique), Value::List(items)) => {
                for item in items {
                    match &item.value {
                        Value::Table(table) => self.table(table, item.span, schema, path),
                        _ => self.wrong_kind(item, "a table", path),
                    }
                }
                if let Some(key) = unique {
                    self.unique(items, key, path);
                }
            }
            (Kind::Map(_, value), Value::Table(table)) => {
                for entry in &table.entries {
                    self.node(&entry.node, *value, &join(path, &entry.key));
                }
            }
            (Kind::Parameters, Value::Table(table)) => self.parameter_kinds(table),
            (Kind::Tables(..), _) => {
                self.wrong_kind(node, &format!("tables with the heading `[[{path}]]`"), path)
            }
            _ => self.wrong_kind(node, &describe(kind), path),
        }
    }

    fn number(&mut self, node: &Node, range: Range, path: &str) {
        let Some(x) = node.number() else {
            self.diagnostics.push(
                Diagnostic::error("R0105", format!("`{path}` is not a finite number"))
                    .at(node.span, "not finite")
                    .expected(describe(Kind::Number(range))),
            );
            return;
        };
        if !range.contains(x) {
            let degrees = range.max == PI && range.contains(x.to_radians());
            let hint = degrees.then(|| format!("angles are radians: {x} degrees are {:.4}", x.to_radians()));
            self.out_of_range(node, path, x, &describe(Kind::Number(range)), hint);
        }
    }

    fn text(&mut self, node: &Node, format: Text, text: &str, path: &str) {
        if format.accepts(text) {
            return;
        }
        let hint = match format {
            Text::Name => "letters, digits, `_`, `-` and `.`, and no space",
            Text::Colour => "six hexadecimal digits, such as \"#c94f3d\"",
            _ => "the text must not be empty",
        };
        self.diagnostics.push(
            Diagnostic::error("R0111", format!("`{path}` is {text:?}"))
                .at(node.span, format!("not {}", format.describe()))
                .expected(format.describe())
                .hint(hint),
        );
    }

    fn word(&mut self, node: &Node, words: &[&'static str], text: &str, path: &str) {
        if words.contains(&text) {
            return;
        }
        let mut diagnostic = Diagnostic::error("R0108", format!("`{path}` is {text:?}"))
            .at(node.span, "not one of the words")
            .expected(format!("one of {}", quoted(words)));
        if let Some(near) = nearest(text, words.iter().copied()) {
            diagnostic = diagnostic.hint(format!("did you mean \"{near}\"?"));
        }
        self.diagnostics.push(diagnostic);
    }

    fn list(&mut self, node: &Node, items: &[Node], item: Kind, length: Length, path: &str) {
        if !length.contains(items.len()) {
            let found = count(items.len(), "value");
            self.diagnostics.push(
                Diagnostic::error("R0106", format!("`{path}` has {found}"))
                    .at(node.span, found)
                    .expected(describe_list(item, length)),
            );
        }
        for (i, value) in items.iter().enumerate() {
            self.node(value, item, &format!("{path}[{i}]"));
        }
    }

    fn unique(&mut self, items: &[Node], key: &str, path: &str) {
        let named: Vec<(&str, Span)> =
            items.iter().filter_map(Node::table).filter_map(|table| table.text(key)).collect();
        for (i, (name, place)) in named.iter().enumerate() {
            if named[..i].iter().any(|(earlier, _)| earlier == name) {
                self.diagnostics.push(
                    Diagnostic::error("R0107", format!("two `{path}` are called \"{name}\""))
                        .at(*place, "used before")
                        .expected(format!("a `{key}` of its own for each `{path}`")),
                );
            }
        }
    }

    fn parameter_kinds(&mut self, table: &Table) {
        for entry in &table.entries {
            let Some(kind) = self.parameters.kind(&entry.key).copied() else {
                let names: Vec<&str> = self.parameters.kinds.iter().map(|k| k.kind).collect();
                let expected = listed(names.iter().copied());
                self.unknown("R0113", "artefact kind", entry, names, &expected);
                continue;
            };
            let path = format!("parameters.{}", entry.key);
            match &entry.node.value {
                Value::Table(values) => self.parameters_of(values, &kind, &path),
                _ => self.wrong_kind(&entry.node, "a table", &path),
            }
        }
    }

    fn parameters_of(&mut self, values: &Table, kind: &KindParameters, path: &str) {
        for entry in &values.entries {
            match kind.parameter(&entry.key) {
                Some(parameter) => {
                    self.node(&entry.node, value_kind(parameter), &join(path, &entry.key));
                }
                None => {
                    let names: Vec<&str> = kind.parameters.iter().map(|p| p.name).collect();
                    let expected = listed(names.iter().copied());
                    self.unknown("R0114", "parameter", entry, names, &expected);
                }
            }
        }
    }

    fn unknown<'k>(
        &mut self,
        code: &'static str,
        what: &str,
        entry: &Entry,
        known: impl IntoIterator<Item = &'k str>,
        all: &str,
    ) {
        let mut diagnostic = Diagnostic::error(code, format!("there is no {what} `{}` here", entry.key))
            .at(entry.key_span, format!("unknown {what}"))
            .expected(if all.is_empty() { "none".to_owned() } else { format!("one of {all}") });
        if let Some(near) = nearest(&entry.key, known) {
            diagnostic = diagnostic.hint(format!("did you mean `{near}`?"));
        }
        self.diagnostics.push(diagnostic);
    }

    fn wrong_kind(&mut self, node: &Node, expected: &str, path: &str) {
        self.diagnostics.push(
            Diagnostic::error("R0104", format!("`{path}` is {}", node.kind()))
                .at(node.span, format!("this is {}", node.kind()))
                .expected(expected),
        );
    }

    fn out_of_range(
        &mut self,
        node: &Node,
        path: &str,
        value: impl std::fmt::Display,
        expected: &str,
        hint: Option<String>,
    ) {
        let mut diagnostic = Diagnostic::error("R0105", format!("`{path}` is {value}"))
            .at(node.span, "out of range")
            .expected(expected);
        diagnostic.hint = hint;
        self.diagnostics.push(diagnostic);
    }
}

/// Where in `schema` there is a key of this name, as a heading; `path` is that of `schema`.
fn heading_of(schema: &TableSchema, name: &str, path: &str) -> Option<String> {
    schema.keys.iter().find_map(|key| {
        let (below, heading) = match key.kind {
            Kind::Table(below) => (below, format!("`[{}]`", join(path, key.name))),
            Kind::Tables(below, _) => (below, format!("`[[{}]]`", join(path, key.name))),
            Kind::Map(_, Kind::Table(below)) => (*below, format!("`[{}.NAME]`", join(path, key.name))),
            _ => return None,
        };
        let here = below.key(name).is_some().then_some(heading);
        here.or_else(|| heading_of(below, name, &join(path, key.name)))
    })
}

fn join(path: &str, key: &str) -> String {
    if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") }
}

#[cfg(test)]
mod tests {
    use super::super::SpecKind;
    use super::super::file::open;
    use super::super::parameters::{Parameter, ParameterDefault, ParameterKind};
    use super::*;
    use crate::diag::Sources;
    use crate::system::MemorySystem;
    use std::path::Path;

    const GRASP: &[Parameter] = &[
        Parameter {
            name: "rolls",
            kind: ParameterKind::Integer(1, 64),
            default: ParameterDefault::Integer(8),
            unit: "",
            doc: "Turns about the approach.",
        },
        Parameter {
            name: "standoff",
            kind: ParameterKind::Number(Range::NON_NEGATIVE),
            default: ParameterDefault::Automatic("a tenth of the finger length"),
            unit: "m",
            doc: "Distance kept.",
        },
    ];

    fn table() -> ParameterTable {
        let kind = KindParameters { kind: "grasp_set", doc: "Grasps.", parameters: GRASP };
        ParameterTable { kinds: vec![kind] }
    }

    fn findings(kind: SpecKind, text: &str) -> String {
        let mut system = MemorySystem::new();
        system.insert("a.toml", text);
        let (mut sources, mut diagnostics) = (Sources::new(), Diagnostics::new());
        open(&system, &mut sources, Path::new("a.toml"), None, kind, &table(), &mut diagnostics);
        diagnostics.to_plain_text(&sources)
    }

    #[test]
    fn all_findings_of_a_file_come_at_once() {
        let text = "format = 1\nname = \"a b\"\ndescripton = \"a.urdf\"\n[base]\nkind = \"planer\"\n";
        let found = findings(SpecKind::Robot, text);
        let codes: Vec<&str> = found.lines().map(|l| &l[l.find('[').unwrap() + 1..][..5]).collect();
        assert_eq!(codes, ["R0111", "R0102", "R0108"], "{found}");
        assert!(found.contains("a.toml:3:1: error[R0102]: there is no key `descripton` here"), "{found}");
        assert!(found.contains("did you mean `description`?"), "{found}");
        assert!(found.contains("did you mean \"planar\"?"), "{found}");
    }

    #[test]
    fn parameters_are_checked_against_their_declaration() {
        let head = "format = 1\nname = \"t\"\nrobot = \"r\"\n[[goal]]\nplace = \"o\"\nat = {}\n[parameters.";
        assert_eq!(findings(SpecKind::Task, &format!("{head}grasp_set]\nrolls = 4\nstandoff = 0\n")), "");
        let wrong =
            findings(SpecKind::Task, &format!("{head}grasp_set]\nroll = 4\nstandoff = -1\nrolls = 4.0\n"));
        assert!(wrong.contains("8:1: error[R0114]") && wrong.contains("did you mean `rolls`?"), "{wrong}");
        assert!(wrong.contains("9:12: error[R0105]: `parameters.grasp_set.standoff` is -1"), "{wrong}");
        assert!(wrong.contains("10:9: error[R0104]: `parameters.grasp_set.rolls` is a number"), "{wrong}");
        let wrong = findings(SpecKind::Task, &format!("{head}grasp]\n"));
        assert!(wrong.contains("7:13: error[R0113]"), "{wrong}");
    }

    #[test]
    fn a_syntax_error_hides_only_what_it_made_up() {
        let found = findings(SpecKind::Task, "format = \nnam = \"t\"\n");
        assert_eq!(found.lines().count(), 2, "{found}");
        assert!(found.contains("1:10: error[R0101]") && found.contains("2:1: error[R0102]"), "{found}");
    }

    #[test]
    fn defaults_of_the_schemas_satisfy_them() {
        fn visit(schema: &'static TableSchema, visited: &mut usize) {
            for key in schema.keys {
                if let Presence::Default(text) = key.presence {
                    let mut sources = Sources::new();
                    let file = sources.add("default", format!("value = {text}"));
                    let mut diagnostics = Diagnostics::new();
                    let tree = super::super::document::parse(&sources, file, &mut diagnostics);
                    let parameters = table();
                    let mut checker =
                        Checker { root: schema, parameters: &parameters, diagnostics: &mut diagnostics };
                    checker.node(&tree.entries[0].node, key.kind, key.name);
                    assert_eq!(diagnostics.to_plain_text(&sources), "");
                    *visited += 1;
                }
                match key.kind {
                    Kind::Table(below) | Kind::Tables(below, _) => visit(below, visited),
                    _ => {}
                }
            }
        }
        let mut visited = 0;
        visit(SpecKind::Robot.schema(), &mut visited);
        visit(SpecKind::Task.schema(), &mut visited);
        assert!(visited > 10);
    }
}
