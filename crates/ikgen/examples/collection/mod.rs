//! The arms of a folder with an `INDEX.tsv`.

use std::path::Path;

use robotc_core::system::{ReadError, System};
use robotc_core::urdf::{LoadOptions, MeshPolicy, load};
use robotc_core::{Kinematics, SerialChain, Sources};

struct Files;

impl System for Files {
    fn read(&self, path: &Path) -> Result<Vec<u8>, ReadError> {
        std::fs::read(path).map_err(|e| ReadError::Unreadable(e.to_string()))
    }

    fn exists(&self, path: &Path) -> bool {
        path.exists()
    }
}

/// Name and chain of each arm whose name contains `filter`, loaded when its turn comes.
pub(crate) fn arms(folder: &Path, filter: &str) -> impl Iterator<Item = (String, SerialChain)> {
    let index = std::fs::read_to_string(folder.join("INDEX.tsv")).expect("the folder has an INDEX.tsv");
    let rows: Vec<Vec<String>> =
        index.lines().skip(1).map(|line| line.split('\t').map(String::from).collect()).collect();
    let (folder, filter) = (folder.to_path_buf(), filter.to_owned());
    rows.into_iter().filter_map(move |field| {
        let name = field[0].trim_end_matches(".urdf");
        if !name.contains(&filter) {
            return None;
        }
        let chain = chain(&folder.join(&field[0]), &field[4], &field[5]);
        let chain = chain.unwrap_or_else(|| panic!("{name} has a chain from {} to {}", field[4], field[5]));
        Some((name.into(), chain))
    })
}

fn chain(path: &Path, base: &str, tip: &str) -> Option<SerialChain> {
    let options = LoadOptions { meshes: MeshPolicy::Ignore, ..LoadOptions::default() };
    let (model, _) = load(&Files, &mut Sources::new(), path, &options);
    let kinematics = Kinematics::new(model?.into());
    let link = |name: &str| kinematics.model().link_named(name);
    SerialChain::between(&kinematics, link(base)?, link(tip)?).ok()
}
