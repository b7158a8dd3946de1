//! xacro, the macro language that most robot descriptions are written in, expanded to plain URDF.
//!
//! An expander of our own: it reads files through [`System`] only, and what it makes keeps the places of what it was made
//! from, so that a wrong number in a macro is reported where the macro is written.
//!
//! Understood: properties (lazy, scoped, with defaults), arguments, macros with parameters, defaults and blocks, includes,
//! conditions, computed elements and attributes, `$(arg)`, `$(find)`, `$(dirname)`, `$(eval)`, `$(optenv)`, and Python's
//! expressions as far as descriptions use them, `load_yaml` among them. Not understood: namespaces of includes, and
//! `$(env)`, since what a description means must not depend on where it is read.

mod call;
mod evaluate;
mod expand;
mod functions;
mod lexer;
mod scope;
mod syntax;
mod text;
mod value;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crate::diag::{Diagnostics, Sources};
use crate::system::System;
use crate::xml::Element;

/// What an expansion is given beside the file.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Given<'a> {
    /// Folders of packages, by name.
    pub(crate) packages: &'a BTreeMap<String, PathBuf>,
    /// Values of arguments; they override the defaults of the file.
    pub(crate) arguments: &'a BTreeMap<String, String>,
}

/// `root`, the tree of the xacro file at `path`, expanded; and what is wrong with it.
pub(crate) fn expand(
    system: &dyn System,
    sources: &mut Sources,
    path: &Path,
    root: &Element,
    given: Given<'_>,
) -> (Element, Diagnostics) {
    expand::Expander::new(system, sources, path, given).run(root)
}

#[cfg(test)]
mod tests;
