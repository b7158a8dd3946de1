//! What a command is told about a description beside its file.

use std::path::PathBuf;

use clap::Args;
use robotc_core::urdf::{LoadOptions, MeshPolicy};

/// Options of commands that read a URDF or xacro file.
#[derive(Args)]
pub(crate) struct DescriptionArgs {
    /// Folder of a package that the description refers to; may be given several times
    #[arg(long = "package", value_name = "NAME=FOLDER", value_parser = package)]
    packages: Vec<(String, PathBuf)>,
    /// Value of an argument of a xacro file; may be given several times
    #[arg(long = "argument", value_name = "NAME=VALUE", value_parser = argument)]
    arguments: Vec<(String, String)>,
}

impl DescriptionArgs {
    /// What the reader is told.
    pub(crate) fn options(&self, meshes: MeshPolicy) -> LoadOptions {
        LoadOptions {
            packages: self.packages.iter().cloned().collect(),
            arguments: self.arguments.iter().cloned().collect(),
            meshes,
            ..LoadOptions::default()
        }
    }
}

fn package(text: &str) -> Result<(String, PathBuf), String> {
    let (name, folder) = text.split_once('=').ok_or("expected NAME=FOLDER")?;
    Ok((name.to_owned(), PathBuf::from(folder)))
}

/// `NAME=VALUE`, or `NAME:=VALUE` as ROS writes it.
fn argument(text: &str) -> Result<(String, String), String> {
    let (name, value) = text.split_once('=').ok_or("expected NAME=VALUE")?;
    Ok((name.strip_suffix(':').unwrap_or(name).to_owned(), value.to_owned()))
}
