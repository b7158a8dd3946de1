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

use std::path::Path;

use crate::diag::{Diagnostics, Sources};
use crate::system::System;
use crate::urdf::LoadOptions;
use crate::xml::Element;

/// `root`, the tree of the xacro file at `path`, expanded; and what is wrong with it.
pub(crate) fn expand(
    system: &dyn System,
    sources: &mut Sources,
    path: &Path,
    root: &Element,
    options: &LoadOptions,
) -> (Element, Diagnostics) {
    expand::Expander::new(system, sources, path, options).run(root)
}

#[cfg(test)]
mod tests;
