//! Recordings to look at: an offline page with its own viewer, and binary glTF.

mod base64;
mod block;
mod camera;
mod glb;
mod page;

pub use camera::Camera;
pub use glb::glb;
pub use page::html;
