//! From a mesh reference as descriptions write it to a file.

use std::collections::BTreeMap;
use std::path::{Component, Path, PathBuf};

use crate::system::System;

/// Most folders above a description that are searched for a package.
const FOLDERS_ABOVE: usize = 8;

/// A file found for a reference.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Resolved {
    /// The file.
    pub(crate) path: PathBuf,
    /// Whether it is not quite what was asked for: another extension, or a foreign absolute path found by its tail.
    pub(crate) guessed: bool,
}

/// The existing file that `uri`, written in the file `description`, means; or `None`.
///
/// `package://NAME/rest` and `model://NAME/rest` are looked up in `packages`, then as `NAME/rest`, or `rest` in a folder
/// called NAME or with a manifest that says NAME, from the folder of the description upwards; and last as `rest` in any of these folders,
/// which is a guess. Absolute paths of another machine are tried by their tails.
pub(crate) fn resolve(
    system: &dyn System,
    packages: &BTreeMap<String, PathBuf>,
    description: &Path,
    uri: &str,
) -> Option<Resolved> {
    let candidates = candidates(packages, description, uri);
    for (path, exact) in &candidates {
        if system.exists(path) {
            return Some(Resolved { path: path.clone(), guessed: !exact });
        }
    }
    if let Some((name, rest)) = package_reference(uri).and_then(|reference| reference.split_once('/')) {
        let below = |folder: PathBuf| Some(normal(&folder.join(rest))).filter(|path| system.exists(path));
        if let Some(path) = package_folder(system, packages, description, name).and_then(below) {
            return Some(Resolved { path, guessed: false });
        }
        if let Some(path) = folders_above(description).find_map(below) {
            return Some(Resolved { path, guessed: true });
        }
    }
    candidates
        .iter()
        .flat_map(|(path, _)| siblings(path))
        .find(|path| system.exists(path))
        .map(|path| Resolved { path, guessed: true })
}

/// The folder of a package: given, or found above the description.
pub(crate) fn package_folder(
    system: &dyn System,
    packages: &BTreeMap<String, PathBuf>,
    description: &Path,
    name: &str,
) -> Option<PathBuf> {
    if let Some(folder) = packages.get(name) {
        return Some(folder.clone());
    }
    folders_above(description).find_map(|folder| {
        if folder.file_name().is_some_and(|f| f == name) {
            return Some(folder.to_path_buf());
        }
        let inside = folder.join(name);
        if system.exists(&inside) {
            return Some(inside);
        }
        is_package(system, &folder, name).then_some(folder)
    })
}

/// Whether a folder is the package of this name, by its `package.xml`: checkouts are often called otherwise.
fn is_package(system: &dyn System, folder: &Path, name: &str) -> bool {
    let Ok(manifest) = system.read(&folder.join("package.xml")) else { return false };
    let manifest = String::from_utf8_lossy(&manifest);
    let written = manifest.split_once("<name>").and_then(|(_, rest)| rest.split_once("</name>"));
    written.is_some_and(|(written, _)| written.trim() == name)
}

/// What comes after the scheme of a reference into a package: its name and a path.
fn package_reference(uri: &str) -> Option<&str> {
    let reference = uri.trim().strip_prefix("package://").or_else(|| uri.trim().strip_prefix("model://"));
    reference.filter(|r| !r.starts_with('/'))
}

/// Whether the folder that `uri` means does not exist here: the file is not missing, but somewhere else.
pub(crate) fn is_away(
    system: &dyn System,
    packages: &BTreeMap<String, PathBuf>,
    description: &Path,
    uri: &str,
) -> bool {
    if let Some(reference) = package_reference(uri) {
        let name = reference.split('/').next().unwrap_or_default();
        return package_folder(system, packages, description, name).is_none();
    }
    let nearest = candidates(packages, description, uri).into_iter().next();
    nearest
        .and_then(|(path, _)| path.parent().map(Path::to_path_buf))
        .is_some_and(|folder| !folder.as_os_str().is_empty() && !system.exists(&folder))
}

/// Places to look at, best first, and whether each is exactly what was asked for.
fn candidates(packages: &BTreeMap<String, PathBuf>, description: &Path, uri: &str) -> Vec<(PathBuf, bool)> {
    let uri = uri.trim().replace('\\', "/");
    let folder = description.parent().unwrap_or(Path::new(""));
    let in_package = |reference: &str| -> Vec<(PathBuf, bool)> {
        let (name, rest) = reference.split_once('/').unwrap_or((reference, ""));
        let given = packages.get(name).map(|folder| folder.join(rest));
        let found = folders_above(description).flat_map(|folder| {
            let named = folder.file_name().is_some_and(|f| f == name).then(|| folder.join(rest));
            named.into_iter().chain([folder.join(name).join(rest)])
        });
        given.into_iter().chain(found).map(|path| (normal(&path), true)).collect()
    };
    if let Some(reference) = uri.strip_prefix("package://").or_else(|| uri.strip_prefix("model://")) {
        return match reference.strip_prefix('/') {
            Some(_) => absolute(description, reference),
            None => in_package(reference),
        };
    }
    if let Some(reference) = uri.strip_prefix("$(find ") {
        return in_package(&reference.replacen(')', "", 1));
    }
    let path = uri.strip_prefix("file://").unwrap_or(&uri);
    if path.starts_with('/') || path.get(1..3) == Some(":/") {
        return absolute(description, path);
    }
    vec![(normal(&folder.join(path)), true)]
}

/// The path itself, then its tails below the folders above the description: absolute paths seldom travel.
fn absolute(description: &Path, path: &str) -> Vec<(PathBuf, bool)> {
    let mut places = vec![(normal(Path::new(path)), true)];
    let parts: Vec<&str> = path.split('/').filter(|part| !part.is_empty()).collect();
    for start in 1..parts.len() {
        let tail = parts[start..].join("/");
        places.extend(folders_above(description).map(|folder| (normal(&folder.join(&tail)), false)));
    }
    places
}

/// The folders above a description, innermost first. A relative path goes on above the folder that it is relative to.
fn folders_above(description: &Path) -> impl Iterator<Item = PathBuf> {
    let innermost = description.parent().map(normal);
    let above = |folder: &PathBuf| match folder.components().next_back() {
        Some(Component::Normal(_)) => folder.parent().map(Path::to_path_buf),
        Some(Component::RootDir | Component::Prefix(_)) => None,
        Some(Component::ParentDir | Component::CurDir) | None => Some(normal(&Path::new("..").join(folder))),
    };
    std::iter::successors(innermost, above).take(FOLDERS_ABOVE)
}

/// The same stem with the other endings that meshes have.
fn siblings(path: &Path) -> impl Iterator<Item = PathBuf> {
    let path = path.to_path_buf();
    ["stl", "STL", "obj", "OBJ", "dae", "DAE"].into_iter().map(move |ending| path.with_extension(ending))
}

/// `path` without `.` and `..`, by its text alone.
pub(crate) fn normal(path: &Path) -> PathBuf {
    let mut out = PathBuf::new();
    for part in path.components() {
        match part {
            Component::CurDir => {}
            Component::ParentDir if matches!(out.components().next_back(), Some(Component::Normal(_))) => {
                out.pop();
            }
            other => out.push(other),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn above(path: &str) -> Vec<String> {
        folders_above(Path::new(path)).take(4).map(|folder| folder.display().to_string()).collect()
    }

    #[test]
    fn folders_above_a_relative_path_go_on_above_its_start() {
        assert_eq!(above("a/b/c.urdf"), ["a/b", "a", "", ".."]);
        assert_eq!(above("../a/c.urdf"), ["../a", "..", "../..", "../../.."]);
        assert_eq!(above("/a/c.urdf"), ["/a", "/"]);
    }
}
