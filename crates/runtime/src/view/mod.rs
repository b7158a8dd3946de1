//! Recordings to look at: an offline page with its own viewer, binary glTF, and still pictures.

mod base64;
mod block;
mod camera;
mod glb;
mod page;
mod svg;

pub use camera::Camera;
pub use glb::glb;
pub use page::html;
pub use svg::{escaped, svg, telling_moment};
