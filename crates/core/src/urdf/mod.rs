//! Robot descriptions (URDF, xacro) to [`RobotModel`].
//!
//! Two passes. The first is ours: it knows places, repairs what has one meaning, and reports everything else at once.
//! What it leaves is written as canonical URDF and read by `urdf_rs`, so that the model rests on a second, independent
//! reading of the format. Numbers survive both as written.

mod attributes;
mod canonical;
mod draft;
mod grouped;
mod limits;
mod lower;
mod meshes;
mod read;
mod resolve;
mod structure;

pub(crate) use resolve::{normal, package_folder};

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use crate::diag::{Diagnostics, Sources};
use crate::model::RobotModel;
use crate::system::System;
use crate::xacro;
use crate::xml::{self, Element};

/// What to do about meshes.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum MeshPolicy {
    /// A missing visual mesh is left out with a warning; a missing collision mesh is an error.
    #[default]
    Load,
    /// As `Load`, but meshes that are somewhere else altogether are left out with a warning: those of a package whose folder
    /// is not known, and those in a folder that does not exist. For a description looked at on its own.
    SkipAway,
    /// A missing mesh of either kind is left out with a warning.
    SkipMissing,
    /// Mesh files are not looked at and no link has mesh shapes: enough for kinematics.
    Ignore,
}

/// How to load a description.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct LoadOptions {
    /// Folders of packages, for `package://NAME/...` and `$(find NAME)`. Packages that are not listed are looked for in
    /// the folders above the description.
    pub packages: BTreeMap<String, PathBuf>,
    /// What to do about meshes.
    pub meshes: MeshPolicy,
    /// Links whose missing or damaged collision meshes are left out, whatever the policy.
    pub shapeless: BTreeSet<String>,
    /// Values of xacro arguments; they override the defaults of the file.
    pub arguments: BTreeMap<String, String>,
}

/// Loads the URDF or xacro file at `path`.
///
/// Texts go to `sources`, which all places in the diagnostics point into. The model is `None` exactly when the
/// diagnostics hold an error. Links and joints are in file order.
pub fn load(
    system: &dyn System,
    sources: &mut Sources,
    path: &Path,
    options: &LoadOptions,
) -> (Option<RobotModel>, Diagnostics) {
    let (mut root, mut found) = xml::load(system, sources, path);
    if path.extension().is_some_and(|e| e.eq_ignore_ascii_case("xacro")) {
        root = root.and_then(|root| expanded(system, sources, path, &root, options, &mut found));
    }
    let model = root.and_then(|root| lower(system, path, &root, options, &mut found));
    let model = model.filter(|_| !found.has_errors());
    (model, found)
}

/// The expansion of a xacro file; `None` when it failed, since what is missing then would be found again and again.
fn expanded(
    system: &dyn System,
    sources: &mut Sources,
    path: &Path,
    root: &Element,
    options: &LoadOptions,
    found: &mut Diagnostics,
) -> Option<Element> {
    let given = xacro::Given { packages: &options.packages, arguments: &options.arguments };
    let (expanded, from_xacro) = xacro::expand(system, sources, path, root, given);
    let failed = from_xacro.has_errors();
    found.extend(from_xacro);
    (!failed).then_some(expanded)
}

/// The model of a `<robot>` element.
fn lower(
    system: &dyn System,
    path: &Path,
    root: &Element,
    options: &LoadOptions,
    found: &mut Diagnostics,
) -> Option<RobotModel> {
    let mut draft = read::read(root, found)?;
    structure::check(&mut draft, found);
    limits::check(&mut draft, found);
    if found.has_errors() {
        return None;
    }
    let robot = match urdf_rs::read_from_string(&canonical::text(&draft)) {
        Ok(robot) => robot,
        Err(error) => {
            found.push(lower::internal(&error.to_string()));
            return None;
        }
    };
    let mut meshes = meshes::MeshSource::new(system, options, path, &draft);
    let model = lower::lower(&draft, &robot, &mut meshes, found);
    meshes.finish(found);
    model
}

#[cfg(test)]
mod tests;
