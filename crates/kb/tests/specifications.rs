//! What of a specification's files is not part of any key: folders, comments, layout, names of files.

use std::path::{Path, PathBuf};

use robotc_core::Sources;
use robotc_core::spec::load_task;
use robotc_core::system::MemorySystem;
use robotc_kb::{Graph, Project, RecipeId, kinds};

const TASK: &str = "tasks/mug_to_shelf.task.toml";

/// The shipped specifications as if they lay in `root`, each text passed through `edit`.
fn shipped(root: &str, edit: fn(&str) -> String) -> MemorySystem {
    let from = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../specs");
    let mut system = MemorySystem::new();
    let mut open = vec![PathBuf::new()];
    while let Some(at) = open.pop() {
        for entry in std::fs::read_dir(from.join(&at)).expect("a folder") {
            let entry = entry.expect("an entry");
            let name = at.join(entry.file_name());
            if entry.path().is_dir() {
                open.push(name);
                continue;
            }
            let bytes = std::fs::read(entry.path()).expect("a file");
            let bytes = match name.extension().and_then(|e| e.to_str()) {
                Some("toml") => edit(std::str::from_utf8(&bytes).expect("text")).into_bytes(),
                _ => bytes,
            };
            system.insert(Path::new(root).join(&name), bytes);
        }
    }
    system
}

/// Every node by title and recipe.
fn recipes(root: &str, edit: fn(&str) -> String) -> Vec<(String, RecipeId)> {
    let system = shipped(root, edit);
    let mut sources = Sources::new();
    let path = Path::new(root).join(TASK);
    let (spec, found) = load_task(&system, &mut sources, &path, &kinds::parameter_table());
    let spec = spec.unwrap_or_else(|| panic!("{}", found.to_plain_text(&sources)));
    let graph = Graph::plan(&Project::of_task(&spec)).expect("a graph");
    graph.nodes().iter().map(|node| (node.title(), node.recipe)).collect()
}

#[test]
fn folders_comments_and_layout_change_no_key() {
    let here = recipes("/here", str::to_owned);
    assert!(here.len() > 20, "{}", here.len());
    assert_eq!(here, recipes("/some/where else", str::to_owned), "moved to another folder");
    let commented = |text: &str| format!("# A comment.\n\n{}\n# The end.\n", text.replace(" = ", "   =  "));
    assert_eq!(here, recipes("/here", commented), "comments and spaces");
}

#[test]
fn a_task_needs_only_its_own_arm() {
    let with_another = |text: &str| {
        if text.contains("name = \"mug_to_shelf\"") {
            return text.replace("seed = 1", "seed = 1\narm = \"arm\"");
        }
        let another = "\n[[arm]]\nname = \"another\"\nbase = \"panda_link1\"\ntip = \"panda_hand\"\n";
        if text.contains("name = \"panda\"") { format!("{text}{another}") } else { text.to_owned() }
    };
    let titles =
        |nodes: Vec<(String, RecipeId)>| nodes.into_iter().map(|(title, _)| title).collect::<Vec<_>>();
    assert_eq!(titles(recipes("/here", with_another)), titles(recipes("/here", str::to_owned)));
}

#[test]
fn numbers_are_hashed_by_value_and_not_by_spelling() {
    let respelled = |text: &str| {
        let is_the_task = text.contains("name = \"mug_to_shelf\"");
        assert!(!is_the_task || text.contains("friction = 0.5"), "there is a number to spell in another way");
        text.replace("friction = 0.5", "friction = 5.0e-1")
    };
    assert_eq!(recipes("/here", str::to_owned), recipes("/here", respelled));
}
