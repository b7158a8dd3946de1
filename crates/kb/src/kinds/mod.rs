//! The artefact kinds: one file each, one line each in [`ALL`].

mod arm_pairs;
mod caging_set;
mod camera_view;
mod chain_reach;
mod convex_parts;
mod grasp_set;
mod grasp_shake;
mod grip;
mod ik_solver;
mod link_statistics;
pub mod reachability;
mod self_collision_pairs;
mod sphere_cover;

pub use arm_pairs::{ArmPairs, LinkPairs};
pub use caging_set::{Cage, CageHold, CagingParameters, CagingSet};
pub use camera_view::{CameraView, CameraViewParameters, CameraViews, Mask};
pub use chain_reach::{ChainReach, ReachSphere};
pub use convex_parts::{ConvexParts, ConvexPartsParameters};
pub use grasp_set::{GraspParameters, GraspSet};
pub use grasp_shake::{GraspShake, ShakeParameters, Shaken, ranked_grasps};
pub use ik_solver::{IkParameters, IkSolver};
pub use link_statistics::{JointStatistics, LinkStatistics, SectionRow, StatisticsParameters, SweptSection};
pub use reachability::{Reachability, ReachabilityMap, ReachabilityParameters};
pub use self_collision_pairs::{PairParameters, PairState, PairTable, SelfCollisionPairs};
pub use sphere_cover::{CoverParameters, SphereCover};

use robotc_core::spec::{KindParameters, ParameterTable};

use crate::kind::{AnyKind, Entry};

/// All kinds, in the order in which documentation lists them.
pub const ALL: &[&dyn AnyKind] = &[
    &Entry::<ChainReach>::new(),
    &Entry::<ConvexParts>::new(),
    &Entry::<SphereCover>::new(),
    &Entry::<IkSolver>::new(),
    &Entry::<LinkStatistics>::new(),
    &Entry::<SelfCollisionPairs>::new(),
    &Entry::<ArmPairs>::new(),
    &Entry::<Reachability>::new(),
    &Entry::<GraspSet>::new(),
    &Entry::<GraspShake>::new(),
    &Entry::<CagingSet>::new(),
    &Entry::<CameraView>::new(),
];

/// The kind of this name.
pub fn find(name: &str) -> Option<&'static dyn AnyKind> {
    ALL.iter().copied().find(|kind| kind.info().name == name)
}

/// The parameters of all kinds, for checking specifications.
pub fn parameter_table() -> ParameterTable {
    let row = |kind: &&dyn AnyKind| {
        let info = kind.info();
        KindParameters { kind: info.name, doc: info.doc, parameters: info.parameters }
    };
    ParameterTable { kinds: ALL.iter().map(row).collect() }
}
