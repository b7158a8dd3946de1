//! Parameters of a pick-and-place planner; lengths follow from the measures of arm and hand.

use robotc_core::{Configuration, LinkIdx};
use serde::{Deserialize, Serialize};

use crate::arm::ArmModel;
use crate::caging::{CagedObjectOptions, RandomizedOptions};
use crate::cartesian::LineOptions;
use crate::rrt::RrtOptions;
use crate::scene::Scene;
use crate::smooth::{DEFAULT_SMOOTHERS, Smoother};
use crate::timing::TimingOptions;

/// Sizes of an arm and its hand, metres, from which default lengths follow.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measures {
    /// See [`ArmModel::reach`].
    pub reach: f64,
    /// Distance from the tool frame to the farthest point of the gripper.
    pub hand: f64,
}

impl Measures {
    /// Of an arm with the links of its gripper, fingers as in `q`.
    pub fn of(arm: &ArmModel, scene: &Scene, q: &Configuration, gripper_links: &[LinkIdx]) -> Self {
        let tool_in_world = arm.world_from_tool(&q.select(arm.dofs())).translation.vector.into();
        let hand = scene.farthest(q, gripper_links, &tool_in_world);
        Self { reach: arm.reach().max(hand), hand }
    }
}

/// Parameters of a pick-and-place planner. Lengths are metres.
///
/// As a document it is JSON; see [`ManipulationOptions::with_document`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ManipulationOptions {
    /// The searches for free motions.
    pub rrt: RrtOptions,
    /// What is done to their paths, in order.
    pub smoothers: Vec<Smoother>,
    /// Straight motions of the tool.
    pub line: LineOptions,
    /// Times along paths.
    pub timing: TimingOptions,
    /// Distance that free motions keep from everything, object included. Default: a 280th of the reach.
    pub margin: f64,
    /// Largest travel of any point between two checked states of a free motion. No more than twice the margin, so that
    /// the states in between are free too. Default: twice the margin.
    pub resolution: f64,
    /// The same for straight motions and for the fingers, which go near and touch; they keep half of it from everything
    /// that they need not touch. Default: a 480th of the reach.
    pub fine_resolution: f64,
    /// Largest travel of any point between two looks of the [certificate](super::certify). Default: a 700th of the reach.
    pub certified_step: f64,
    /// Length of the straight approach and of the retreat. Default: 0.55 of the hand.
    pub approach: f64,
    /// Last part of the approach, in which the open gripper may touch the object. Default: 0.07 of the hand.
    pub contact: f64,
    /// Longest straight lift and lowering; shorter ones, halved twice, are tried where it does not fit. Default: as long
    /// as the approach.
    pub lift: f64,
    /// How deep a held object may seem to be in what it stands on, as a fraction of its diagonal: the convex parts that
    /// cover it stand off its surface a little.
    pub sink: f64,
    /// Changes of grip while an article is moved. Default of its shift: a fifth of the hand.
    pub caging: CagedObjectOptions,
    /// The searches for ways of an article.
    pub caging_search: RandomizedOptions,
    /// How deep the gripper may seem to be in a handle that it holds loosely: arm and fingers yield. Default: a fiftieth of
    /// the hand.
    pub give: f64,
    /// Destinations tried for each goal.
    pub destinations: usize,
    /// Candidate placings looked at for each grasp before it counts as hopeless.
    pub placings: u32,
    /// For a redundant arm, values of the free joints tried for each grasp and each placing.
    pub free_samples: u32,
    /// Branches of inverse kinematics tried for each grasp and free value, nearest first.
    pub branches: usize,
    /// Grasps for which a free motion to the destination is searched before the goal counts as unreachable.
    pub attempts: u32,
}

impl ManipulationOptions {
    /// The default for an arm and hand of these sizes.
    pub fn new(measures: &Measures) -> Self {
        let Measures { reach, hand } = *measures;
        let margin = reach / 280.0;
        Self {
            rrt: RrtOptions { max_iterations: 4000, ..RrtOptions::default() },
            smoothers: DEFAULT_SMOOTHERS.to_vec(),
            line: LineOptions::for_reach(reach),
            timing: TimingOptions::default(),
            margin,
            resolution: 2.0 * margin,
            fine_resolution: reach / 480.0,
            certified_step: reach / 700.0,
            approach: 0.55 * hand,
            contact: 0.07 * hand,
            lift: 0.55 * hand,
            sink: 0.04,
            caging: CagedObjectOptions { shift: 0.2 * hand, ..CagedObjectOptions::default() },
            caging_search: RandomizedOptions::default(),
            give: 0.02 * hand,
            destinations: 64,
            placings: 40,
            free_samples: 8,
            branches: 4,
            attempts: 8,
        }
    }

    /// These options with what a document says otherwise: a JSON object of some of the fields, in which nested objects may be partial
    /// too. Unknown fields are errors.
    pub fn with_document(&self, text: &str) -> Result<Self, serde_json::Error> {
        let mut all = serde_json::to_value(self)?;
        overlay(&mut all, serde_json::from_str(text)?);
        serde_json::from_value(all)
    }

    /// All options as a document.
    pub fn document(&self) -> String {
        serde_json::to_string_pretty(self).expect("numbers and names can be written")
    }

    /// Distance that straight motions and fingers keep from everything that they need not touch: it makes the states
    /// between those looked at free too.
    pub fn fine_margin(&self) -> f64 {
        0.5 * self.fine_resolution
    }
}

/// Puts the values of `above` in place of those of `below`, object by object.
fn overlay(below: &mut serde_json::Value, above: serde_json::Value) {
    match (below, above) {
        (serde_json::Value::Object(below), serde_json::Value::Object(above)) => {
            for (key, value) in above {
                match below.get_mut(&key) {
                    Some(old) => overlay(old, value),
                    None => drop(below.insert(key, value)),
                }
            }
        }
        (below, above) => *below = above,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn documents_change_what_they_name() {
        let own = ManipulationOptions::new(&Measures { reach: 1.4, hand: 0.15 });
        assert_eq!(own.with_document(&own.document()).unwrap(), own);
        let changed = own.with_document(r#"{"margin": 0.01, "rrt": {"max_iterations": 7}}"#).unwrap();
        assert_eq!((changed.margin, changed.rrt.max_iterations), (0.01, 7));
        assert_eq!(ManipulationOptions { margin: own.margin, rrt: own.rrt, ..changed }, own);
        for wrong in ["{", r#"{"margin": "wide"}"#, "7"] {
            assert!(own.with_document(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn lengths_scale_with_the_robot() {
        let arm = ManipulationOptions::new(&Measures { reach: 1.4, hand: 0.15 });
        let toy = ManipulationOptions::new(&Measures { reach: 0.14, hand: 0.015 });
        let lengths = |o: &ManipulationOptions| {
            let ManipulationOptions { margin, resolution, fine_resolution, certified_step, .. } = *o;
            let motions =
                [o.approach, o.contact, o.lift, o.line.step, o.line.tolerance, o.caging.shift, o.give];
            [&[margin, resolution, fine_resolution, certified_step], &motions[..]].concat()
        };
        for (large, small) in lengths(&arm).iter().zip(lengths(&toy)) {
            assert!((large - 10.0 * small).abs() < 1e-12, "{large} {small}");
        }
        assert!((arm.margin - 0.005).abs() < 1e-12 && arm.resolution <= 2.0 * arm.margin);
    }
}
