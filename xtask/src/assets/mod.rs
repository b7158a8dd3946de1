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
    let is_check = match args {
        [] => false,
        [flag] if flag == "--check" => true,
        _ => bail!("usage: cargo xtask assets [--check]"),
    };
    let specs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../specs");
    let mut stale = Vec::new();
    for (path, text) in files() {
        let full = specs.join(&path);
        if is_check {
            if std::fs::read_to_string(&full).ok().as_ref() != Some(&text) {
                stale.push(path.display().to_string());
            }
            continue;
        }
        let folder = full.parent().expect("a file lies in a folder");
        std::fs::create_dir_all(folder).with_context(|| folder.display().to_string())?;
        std::fs::write(&full, text).with_context(|| full.display().to_string())?;
    }
    if !stale.is_empty() {
        bail!("not what `cargo xtask assets` writes:\n  {}", stale.join("\n  "));
    }
    Ok(())
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
