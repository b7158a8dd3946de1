//! Artefacts as scenes to look at: one file for each kind that can be drawn, and one line in [`KINDS`].
//!
//! A picture holds what the artefact is about (the links, the object) and what the artefact says of it. Some are read
//! along the timeline: a grasp set shows one grasp after the other. What lies in a plane also has a [`plot()`].

mod base_placement;
mod caging_set;
mod camera_view;
mod convex_parts;
mod grasp_set;
mod hand;
mod ik_solutions;
mod link_statistics;
mod palette;
pub mod plot;
mod reachability;
mod sphere_cover;

use robotc_core::model::LinkPoses;
use robotc_core::{Configuration, Kinematics};
use robotc_kb::project::{Project, Subject};
use robotc_kb::{Knowledge, LoadError};
use thiserror::Error;

use crate::record::Recording;

pub use ik_solutions::IkPicture;

/// Draws the artefacts of a kind; says how many of them.
type Draw = fn(&Knowledge, &Wanted<'_>, &mut Recording) -> Result<usize, LoadError>;

/// What can be drawn, by name: kinds of artefacts, and what follows from several of them.
pub const KINDS: &[(&str, Draw)] = &[
    ("base_placement", base_placement::draw),
    ("caging_set", caging_set::draw),
    ("camera_view", camera_view::draw),
    ("convex_parts", convex_parts::draw),
    ("grasp_set", grasp_set::draw),
    ("link_statistics", link_statistics::draw),
    ("reachability", reachability::draw),
    ("sphere_cover", sphere_cover::draw),
];

/// Plots the artefacts of a kind, each as one or more panels.
type Plot = fn(&Knowledge, &Wanted<'_>) -> Result<Vec<plot::Panel>, LoadError>;

/// What can be plotted, by name.
pub const PLOTS: &[(&str, Plot)] = &[
    ("base_placement", base_placement::plot),
    ("link_statistics", link_statistics::plot),
    ("reachability", reachability::plot),
];

/// Which subjects of a kind are drawn: those whose label contains a text; all of them when it is empty.
pub struct Wanted<'a> {
    text: &'a str,
}

impl Wanted<'_> {
    /// The wanted subjects of a project, in its order.
    fn of<S: Subject>(&self, project: &Project) -> Vec<S> {
        S::all(project).into_iter().filter(|subject| subject.label(project).contains(self.text)).collect()
    }
}

/// Why there is no picture.
#[derive(Debug, Error)]
pub enum NoPicture {
    /// Artefacts of this kind have no looks.
    #[error("there is no picture of {0}; there are pictures of {known}", known = kind_names().join(", "))]
    Kind(String),
    /// No subject of the kind is called so.
    #[error("no {kind} has `{subject}` in its subject")]
    Subject {
        /// The kind.
        kind: String,
        /// What was asked for.
        subject: String,
    },
    /// An artefact is missing or damaged.
    #[error(transparent)]
    Load(#[from] LoadError),
}

/// Names of the kinds that can be drawn, in the order of [`KINDS`].
pub fn kind_names() -> Vec<&'static str> {
    KINDS.iter().map(|(name, _)| *name).collect()
}

/// The artefacts of a kind whose subjects contain `subject`, in one scene.
pub fn picture(knowledge: &Knowledge, kind: &str, subject: &str) -> Result<Recording, NoPicture> {
    let (_, draw) =
        KINDS.iter().find(|(name, _)| *name == kind).ok_or_else(|| NoPicture::Kind(kind.to_owned()))?;
    let project = knowledge.graph().project();
    let mut recording = Recording::new(format!("{kind} of {}", project.robot_name()));
    match draw(knowledge, &Wanted { text: subject }, &mut recording)? {
        0 => Err(NoPicture::Subject { kind: kind.to_owned(), subject: subject.to_owned() }),
        _ => Ok(recording),
    }
}

/// The artefacts of a kind whose subjects contain `subject`, as values over a plane; `None` when the kind has no such form.
pub fn plot(knowledge: &Knowledge, kind: &str, subject: &str) -> Result<Option<Vec<plot::Panel>>, NoPicture> {
    let Some((_, plot)) = PLOTS.iter().find(|(name, _)| *name == kind) else { return Ok(None) };
    let panels = plot(knowledge, &Wanted { text: subject })?;
    match panels.is_empty() {
        true => Err(NoPicture::Subject { kind: kind.to_owned(), subject: subject.to_owned() }),
        false => Ok(Some(panels)),
    }
}

/// Where the links of a project's robot are at rest, in the frame of its root.
fn resting_links(project: &Project) -> LinkPoses {
    let mut poses = LinkPoses::default();
    Kinematics::new(project.robot().model.clone()).link_poses(&resting(project), &mut poses);
    poses
}

/// The configuration at the start of the task if there is one, else with each arm at home.
fn resting(project: &Project) -> Configuration {
    let robot = project.robot();
    match project.task() {
        Some(task) => task.start.clone(),
        None => {
            let mut q = Configuration::neutral(&robot.model);
            for arm in &robot.arms {
                if let Some(home) = &arm.home {
                    q.set(&arm.dofs, home);
                }
            }
            q
        }
    }
}
