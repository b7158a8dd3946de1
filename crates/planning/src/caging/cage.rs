//! A loose grip of a gripper on an article.

use super::object::CageGrasp;

/// In which directions a loose grip moves the article.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum CageHold {
    /// Both: the article follows wherever the hand goes.
    Both,
    /// Towards larger values of the joint: the article cannot stay behind.
    Opening,
    /// Towards smaller values of the joint.
    Closing,
}

impl CageHold {
    /// Whether the article follows when its joint's value grows, or shrinks.
    pub fn moves(self, opening: bool) -> bool {
        match self {
            Self::Both => true,
            Self::Opening => opening,
            Self::Closing => !opening,
        }
    }
}

/// A loose grip of a gripper on an article.
#[derive(Debug, Clone, PartialEq)]
pub struct Cage {
    /// Where the tool is against the moving part: the axis frame of
    /// [`Mechanism::of_article`](crate::Mechanism::of_article), moved with it. In contact when the closed hand holds the article
    /// without play, too.
    pub grasp: CageGrasp,
    /// In which directions it moves the article.
    pub hold: CageHold,
    /// Position in `Gripper::preshapes` of the finger position to approach with.
    pub preshape: usize,
    /// Finger values of the loose grip, in the order of `Gripper::dofs`.
    pub loose: Vec<f64>,
    /// Finger values when closed on the article; those of the loose grip where the fingers need not close.
    pub closed: Vec<f64>,
}
