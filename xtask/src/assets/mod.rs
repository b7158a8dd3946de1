//! The geometry that ships in `specs/`: written by code, so that it can be read, measured and changed.
//!
//! `cargo xtask assets` writes the files, `cargo xtask assets --check` says which differ.

mod barrett_hand;
mod obj;
mod objects;
mod panda;
mod part;
mod shape;
mod ur5e;
mod wam;

use std::path::{Path, PathBuf};

use anyhow::{Context, bail};

/// Writes the geometry files, or compares them with `--check`.
pub(crate) fn run(args: &[String]) -> anyhow::Result<()> {
    match args {
        [] => write(),
        [flag] if flag == "--check" => check(),
        _ => bail!("usage: cargo xtask assets [--check]"),
    }
}

fn specs() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../specs")
}

fn write() -> anyhow::Result<()> {
    for (path, text) in files() {
        let full = specs().join(path);
        let folder = full.parent().expect("a file lies in a folder");
        std::fs::create_dir_all(folder).with_context(|| folder.display().to_string())?;
        std::fs::write(&full, text).with_context(|| full.display().to_string())?;
    }
    Ok(())
}

/// Fails when a file differs from what would be written, or when there is one that nothing writes.
fn check() -> anyhow::Result<()> {
    let files = files();
    let mut findings = Vec::new();
    for (path, text) in &files {
        if std::fs::read_to_string(specs().join(path)).ok().as_ref() != Some(text) {
            findings.push(format!("{} differs", path.display()));
        }
    }
    for path in meshes(&specs())? {
        if !files.iter().any(|(known, _)| specs().join(known) == path) {
            findings.push(format!("{} is written by nothing", path.display()));
        }
    }
    if !findings.is_empty() {
        bail!("geometry is not what `cargo xtask assets` writes:\n  {}", findings.join("\n  "));
    }
    Ok(())
}

/// The meshes below a folder.
fn meshes(folder: &Path) -> anyhow::Result<Vec<PathBuf>> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).with_context(|| folder.display().to_string())? {
        let path = entry?.path();
        if path.is_dir() {
            found.extend(meshes(&path)?);
        } else if path.extension().is_some_and(|extension| extension == "obj") {
            found.push(path);
        }
    }
    Ok(found)
}

/// All files: path below `specs/` and text.
fn files() -> Vec<(PathBuf, String)> {
    let mut all = Vec::new();
    for (robot, parts) in [
        ("panda", panda::parts()),
        ("ur5e", ur5e::parts()),
        ("wam", wam::parts()),
        ("wam", barrett_hand::parts()),
    ] {
        let folder = PathBuf::from("robots").join(robot).join("meshes");
        for part in parts {
            all.extend(part.files().map(|(name, mesh)| (folder.join(name + ".obj"), obj::text(mesh))));
        }
    }
    for (name, mesh) in objects::all() {
        all.push((PathBuf::from("objects").join(format!("{name}.obj")), obj::text(&mesh)));
    }
    all
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;

    #[test]
    fn geometry_is_up_to_date() {
        check().unwrap();
    }

    #[test]
    fn files_are_light() {
        let sizes: Vec<usize> = files().iter().map(|(_, text)| text.len()).collect();
        assert!(sizes.iter().all(|size| *size < 48 * 1024), "{sizes:?}");
        assert!(sizes.iter().sum::<usize>() < 1024 * 1024);
    }

    #[test]
    fn bodies_are_closed_and_face_outwards() {
        let parts = [panda::parts(), ur5e::parts(), wam::parts(), barrett_hand::parts()];
        let links =
            parts.iter().flatten().flat_map(|part| part.files()).map(|(name, mesh)| (name, mesh.clone()));
        let objects = objects::all().into_iter().map(|(name, mesh)| (name.to_owned(), mesh));
        for (name, mesh) in links.chain(objects) {
            let mut edges = BTreeMap::new();
            for [a, b, c] in &mesh.faces {
                for (from, to) in [(a, b), (b, c), (c, a)] {
                    *edges.entry((from.min(to), from.max(to))).or_insert(0) += if from < to { 1 } else { -1 };
                }
            }
            assert!(edges.values().all(|sum| *sum == 0), "{name} is open");
            let volume: f64 = (0..mesh.faces.len())
                .map(|face| {
                    let [a, b, c] = mesh.triangle(face);
                    a.coords.dot(&b.coords.cross(&c.coords)) / 6.0
                })
                .sum();
            assert!(volume > 1e-8, "{name}: {volume}");
        }
    }
}
