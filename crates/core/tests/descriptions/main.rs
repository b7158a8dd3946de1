//! Robot descriptions and meshes over real files, and over files made worse on purpose.
// Tests tell what they skipped and what they measured.
#![allow(clippy::print_stdout, clippy::print_stderr)]

mod arms;
mod broken;
mod data;
mod kinematics;
mod meshes;
mod mutations;
mod robots;
