//! Reads a specification file: text, tree of values, findings of the schema.

use std::path::{Component, Path, PathBuf};

use super::SpecKind;
use super::describe::value_kind;
use super::document::{self, Table};
use super::parameters::{ParameterTable, ParameterValue, Parameters};
use super::schema::Kind;
use super::validate::validate;
use crate::diag::{Diagnostic, Diagnostics, FileId, Sources, Span};
use crate::system::System;

/// A specification as a tree of values. Values that the schema refused are still in it.
pub(super) struct SpecFile {
    pub(super) table: Table,
    /// The start of the text: where findings about the whole file go.
    pub(super) place: Span,
    /// The folder that paths of this specification start from.
    pub(super) folder: PathBuf,
}

/// Reads and checks the specification at `path`; `None` when there is no text or its syntax is broken. `at` is the reference
/// to the file.
pub(super) fn open(
    system: &dyn System,
    sources: &mut Sources,
    path: &Path,
    at: Option<Span>,
    kind: SpecKind,
    parameters: &ParameterTable,
    diagnostics: &mut Diagnostics,
) -> Option<SpecFile> {
    let file = read_text(system, sources, path, at, diagnostics)?;
    let place = Span { file, start: 0, end: 0 };
    let mut found = Diagnostics::new();
    let table = document::parse(sources, file, &mut found);
    let mut checked = Diagnostics::new();
    validate(&table, place, kind.schema(), parameters, &mut checked);
    let broken_syntax = found.iter().any(|d| d.code == "R0101");
    if broken_syntax {
        // What the parser skipped would be reported as missing, and what it made up as wrong.
        let broken: Vec<usize> = lines(sources, &found);
        for finding in checked {
            let line = finding.span.map_or(0, |span| sources.line_column(span).line);
            if finding.code != "R0103" && !broken.contains(&line) {
                found.push(finding);
            }
        }
    } else {
        found.extend(checked);
    }
    diagnostics.extend(found);
    let folder = path.parent().unwrap_or(Path::new("")).to_owned();
    (!broken_syntax).then_some(SpecFile { table, place, folder })
}

/// Reads a text into `sources`.
pub(super) fn read_text(
    system: &dyn System,
    sources: &mut Sources,
    path: &Path,
    at: Option<Span>,
    diagnostics: &mut Diagnostics,
) -> Option<FileId> {
    let finding = match system.read(path) {
        Ok(bytes) => match String::from_utf8(bytes) {
            Ok(text) => {
                let text = text.strip_prefix('\u{feff}').map(str::to_owned).unwrap_or(text);
                return Some(sources.add(path.display().to_string(), text));
            }
            Err(_) => Diagnostic::error("R0002", format!("{} is not UTF-8 text", path.display())),
        },
        Err(error) => Diagnostic::unreadable(path, &error),
    };
    diagnostics.push(match at {
        Some(span) => finding.at(span, "named here"),
        None => finding,
    });
    None
}

/// Findings in the order of their places in the text; those at one place stay in their order.
pub(super) fn by_place(diagnostics: Diagnostics) -> Diagnostics {
    let mut items: Vec<Diagnostic> = diagnostics.into_iter().collect();
    items.sort_by_key(|d| d.span.map(|span| (span.file, span.start)));
    let mut sorted = Diagnostics::new();
    items.into_iter().for_each(|d| sorted.push(d));
    sorted
}

fn lines(sources: &Sources, diagnostics: &Diagnostics) -> Vec<usize> {
    diagnostics.iter().filter_map(|d| d.span).map(|span| sources.line_column(span).line).collect()
}

/// `path` as seen from `folder`, with `..` taken out where that names the same file.
pub(super) fn resolve(system: &dyn System, folder: &Path, path: &str) -> PathBuf {
    let plain = folder.join(path);
    let mut short = PathBuf::new();
    for part in plain.components() {
        match part {
            Component::CurDir => {}
            Component::ParentDir if matches!(short.components().next_back(), Some(Component::Normal(_))) => {
                short.pop();
            }
            _ => short.push(part),
        }
    }
    // `folder/..` is another folder when `folder` is a symbolic link.
    if system.exists(&short) || !system.exists(&plain) { short } else { plain }
}

/// The values of the `[parameters.KIND]` tables that are declared and of the right kind.
pub(super) fn read_parameters(table: &Table, declared: &ParameterTable) -> Parameters {
    let mut parameters = Parameters::default();
    for kind in table.entries("parameters") {
        let Some((of_kind, values)) = declared.kind(&kind.key).zip(kind.node.table()) else { continue };
        for entry in &values.entries {
            let Some(parameter) = of_kind.parameter(&entry.key) else { continue };
            let node = &entry.node;
            let value = match value_kind(parameter) {
                Kind::Number(_) => node.number().map(ParameterValue::Number),
                Kind::Integer(..) => node.integer().map(ParameterValue::Integer),
                Kind::Choice(_) => node.text().map(|word| ParameterValue::Text(word.to_owned())),
                _ => node.boolean().map(ParameterValue::Bool),
            };
            if let Some(value) = value {
                parameters.set(&kind.key, &entry.key, value);
            }
        }
    }
    parameters
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::system::MemorySystem;

    #[test]
    fn paths_are_shortened() {
        let mut system = MemorySystem::new();
        system.insert("specs/robots/a.toml", "");
        let resolved = |path| resolve(&system, Path::new("specs/tasks"), path);
        assert_eq!(resolved("../robots/./a.toml"), Path::new("specs/robots/a.toml"));
        assert_eq!(resolved("../../../a.toml"), Path::new("../a.toml"));
        assert_eq!(resolved("/a.toml"), Path::new("/a.toml"));
    }
}
