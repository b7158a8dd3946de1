//! Convex parts, boxes, distances and rays: the geometry that collision checks, grasps and link statistics share.
//!
//! A shape is a list of convex polytopes ([`ConvexParts`]) that together cover it; what sensors see, point clouds and height fields, is a
//! [`Pile`]. Queries take poses as
//! `a_from_b` or `world_from_part`, in metres. This is the only module that names the geometry library it is built
//! with; public signatures use nalgebra's types and our own.

mod aabb;
mod bvh;
mod climb;
mod cloud;
mod decompose;
mod gjk;
mod height_field;
mod hull;
mod lump;
mod mesh_index;
mod padding;
mod part;
mod parts;
mod penetration;
mod pile;
mod polygon;
mod primitive;
mod query;
mod quick_hull;
mod reduce;
mod shape;
mod sphere_cover;
mod surface;

pub use aabb::Aabb;
pub use cloud::{CloudError, NodeBox, PointCloud};
pub use decompose::{DecomposeOptions, decompose};
pub use height_field::{Block, HeightField, HeightFieldError};
pub use hull::HullError;
pub use lump::Lump;
pub use mesh_index::{MeshIndex, NearestPoint, RayHit};
pub use padding::{PaddedPart, PaddedParts, outside_of_bodies};
pub use part::{ConvexPart, PartError, Plane};
pub use parts::ConvexParts;
pub use pile::{Pile, PileRoom};
pub use polygon::{ConvexPolygon, HalfPlane};
pub use primitive::{box_part, capsule_part, cylinder_part, sphere_part};
pub use query::{
    Contact, Distance, Otherwise, RoomAsked, Separation, any_within, contact, distance, intersects, room,
    separation, within,
};
pub use shape::{parts_of, parts_of_shape};
pub use sphere_cover::{CoverOptions, SphereCover, SphereNode};
pub use surface::{MOST_SHOWN, surface};
