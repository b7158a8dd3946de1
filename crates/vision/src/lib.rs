//! What cameras on a robot see (thesis, chapter 5).
//!
//! A [`Pinhole`] turns points into pixels. What of its image the robot's own parts hide are [`silhouette`]s; the largest
//! convex polygon between them is a [`free_view`]; and the space behind that polygon is a [`ViewVolume`].
//!
//! Image coordinates are pixels, u to the right and v down, the image from (0, 0) to its size; a pixel's middle is half
//! way. The camera's frame has x along u, y along v, and z looks out.

mod free_view;
mod pinhole;
mod silhouette;
mod view_volume;

pub use free_view::{FreeViewOptions, free_view};
pub use pinhole::Pinhole;
pub use silhouette::silhouette;
pub use view_volume::ViewVolume;
