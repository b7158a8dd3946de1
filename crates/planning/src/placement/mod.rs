//! Where a mobile robot stands when it grasps, and how it folds itself to drive (thesis section 3.6).

mod distribution;
mod posture;
mod sampler;
#[cfg(test)]
mod tests;

pub use distribution::{BaseDistribution, InverseSamples, InverseSamplesOptions, Stand, UniformBases};
pub use posture::{NavigationPosture, PostureOptions, Prism, PrismBodies};
pub use sampler::{
    BasePlacement, Placement, PlacementArm, PlacementOptions, PlacementProblem, PlacementRejections,
};
