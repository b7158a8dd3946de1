//! Robot descriptions and meshes over real files, and over files made worse on purpose.

mod arms;
mod broken;
mod data;
mod kinematics;
mod meshes;
mod mutations;
mod robots;
