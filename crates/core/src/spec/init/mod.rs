//! Writes a robot specification for a description that has none: a guess, with comments, that loads.

mod arms;
mod base;
mod bodies;
mod hands;
mod text;

use std::collections::BTreeMap;
use std::path::{Component, Path, PathBuf};
use std::sync::Arc;

use self::bodies::Bodies;
use self::hands::Hand;
use super::arms::chain_dofs;
use super::groups;
use crate::diag::{Diagnostic, Diagnostics, Sources};
use crate::ids::{DofIdx, LinkIdx};
use crate::model::{Kinematics, RobotModel};
use crate::srdf::Srdf;
use crate::system::System;
use crate::urdf::{self, LoadOptions, MeshPolicy, normal};
use crate::{joint_limits, srdf};

/// What to write a specification for.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct InitOptions {
    /// URDF or xacro file.
    pub description: PathBuf,
    /// SRDF file.
    pub srdf: Option<PathBuf>,
    /// MoveIt's `joint_limits.yaml`.
    pub joint_limits: Option<PathBuf>,
    /// Folders of packages.
    pub packages: BTreeMap<String, PathBuf>,
    /// Values of xacro arguments.
    pub arguments: BTreeMap<String, String>,
    /// The folder that the specification will be written to: paths in it start there. Empty: the current one.
    pub folder: PathBuf,
    /// The current folder, absolute; empty where there is none. Only it tells what is beside a folder outside of it.
    pub here: PathBuf,
}

impl InitOptions {
    /// `path` as the specification has to name it. Absolute paths stay as they are.
    fn seen_from_folder(&self, path: &Path) -> PathBuf {
        let around = |path: &Path| normal(&self.here.join(path));
        relative(&self.folder, path)
            .or_else(
                || if path.is_absolute() { None } else { relative(&around(&self.folder), &around(path)) },
            )
            .unwrap_or_else(|| path.to_owned())
    }
}

/// The text of a robot specification, with comments on what was guessed; `None` when the files cannot be used, or the robot
/// has no moving joint.
///
/// Arms are the chains of the SRDF, else the longest serial chains; grippers are bodies at the end of an arm with short moving
/// branches. Loading the text gives no errors and no warnings of its own, but for collision meshes that are missing: whether a link may do
/// without is not guessed.
pub fn init(
    system: &dyn System,
    sources: &mut Sources,
    options: &InitOptions,
) -> (Option<String>, Diagnostics) {
    let (packages, arguments) = (options.packages.clone(), options.arguments.clone());
    let load = LoadOptions { packages, arguments, meshes: MeshPolicy::SkipAway, ..LoadOptions::default() };
    let (model, mut diagnostics) = urdf::load(system, sources, &options.description, &load);
    let Some(mut model) = model else { return (None, diagnostics) };
    if let Some(path) = &options.joint_limits {
        let (limits, found) = joint_limits::load(system, sources, path);
        diagnostics.extend(found);
        model = joint_limits::apply(&limits, &model, &mut diagnostics);
    }
    let srdf = options.srdf.as_ref().and_then(|path| {
        let (srdf, found) = srdf::load(system, sources, path, Some(&model));
        diagnostics.extend(found);
        srdf
    });
    let guess = guess(&Arc::new(model), srdf.as_ref());
    if guess.arms.is_empty() {
        let name = options.description.display();
        diagnostics.push(
            Diagnostic::error("R0415", format!("no chain of moving joints was found in {name}"))
                .expected("a robot with moving joints"),
        );
    }
    let text = (!diagnostics.has_errors()).then(|| text::write(&guess, options));
    (text, diagnostics)
}

/// A chain that may be an arm.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ArmGuess {
    /// Link where it starts.
    pub base: LinkIdx,
    /// Link where it ends: the last one before a gripper, if it carries one.
    pub tip: LinkIdx,
    /// What moves it, base to tip.
    pub dofs: Vec<DofIdx>,
}

/// The chains of a robot that may be arms, those that [`init`] would write without an SRDF; most joints first.
pub fn guess_arms(model: &Arc<RobotModel>) -> Vec<ArmGuess> {
    let arms = guess(model, None).arms.into_iter();
    let mut found: Vec<ArmGuess> =
        arms.map(|arm| ArmGuess { base: arm.base, tip: arm.tip, dofs: arm.dofs }).collect();
    found.sort_by_key(|arm| std::cmp::Reverse(arm.dofs.len()));
    found
}

/// What was found out about a robot.
struct Guess {
    model: Arc<RobotModel>,
    arms: Vec<GuessedArm>,
    /// Grippers that an arm carries, each with its name.
    hands: Vec<(String, Hand)>,
    base: crate::robot::Base,
}

/// An arm to be written.
struct GuessedArm {
    name: String,
    base: LinkIdx,
    tip: LinkIdx,
    dofs: Vec<DofIdx>,
    /// Position in [`Guess::hands`].
    hand: Option<usize>,
    /// From the SRDF: a resting position.
    home: Option<Vec<f64>>,
    /// Whether an SRDF group says so.
    from_srdf: bool,
}

fn guess(model: &Arc<RobotModel>, srdf: Option<&Srdf>) -> Guess {
    let kinematics = Kinematics::new(model.clone());
    let bodies = Bodies::of(model);
    let hands = hands::find(&bodies, &kinematics);
    let mut arms = srdf.map(|srdf| arms_of_groups(srdf, &kinematics, &hands)).unwrap_or_default();
    if arms.is_empty() {
        let limbs = arms::find(&bodies, &hands, &kinematics);
        let names = names("arm", limbs.iter().map(|limb| model.links()[limb.tip].name.as_str()));
        for (limb, name) in limbs.into_iter().zip(names) {
            let dofs = chain_dofs(&kinematics, limb.base, limb.tip).unwrap_or_default();
            let (base, tip, hand) = (limb.base, limb.tip, limb.hand);
            arms.push(GuessedArm { name, base, tip, dofs, hand, home: None, from_srdf: false });
        }
    }
    // Only grippers that are carried are written; arms refer to them by their new position.
    let mut carried: Vec<usize> = arms.iter().filter_map(|arm| arm.hand).collect();
    carried.sort_unstable();
    carried.dedup();
    for arm in &mut arms {
        arm.hand = arm.hand.and_then(|hand| carried.iter().position(|&c| c == hand));
    }
    let hands: Vec<Hand> = carried.into_iter().map(|hand| hands[hand].clone()).collect();
    let hand_names = names("gripper", hands.iter().map(|hand| model.links()[hand.palm].name.as_str()));
    Guess {
        model: model.clone(),
        arms,
        hands: hand_names.into_iter().zip(hands).collect(),
        base: base::guess(&bodies, &kinematics),
    }
}

/// The chains of an SRDF; short ones (a head, a finger) only if there are no others.
fn arms_of_groups(srdf: &Srdf, kinematics: &Kinematics, hands: &[Hand]) -> Vec<GuessedArm> {
    let model = kinematics.model();
    let chains = groups::chains(srdf, kinematics, &[]);
    let long = chains.iter().any(|arm| arm.dofs.len() >= 4);
    let mut arms: Vec<GuessedArm> = Vec::new();
    for arm in chains.into_iter().filter(|arm| arm.dofs.len() >= 4 || !long) {
        let on_tip = model.rigid_group(arm.tip);
        let hand = hands.iter().position(|hand| on_tip.contains(&hand.palm));
        let mut name = arm.name;
        while arms.iter().any(|a| a.name == name) {
            name.push('_');
        }
        let (base, tip, dofs, home) = (arm.base, arm.tip, arm.dofs, arm.home);
        arms.push(GuessedArm { name, base, tip, dofs, hand, home, from_srdf: true });
    }
    arms
}

/// A name for each of several things of one kind: by side where the links tell, else numbered.
fn names<'a>(kind: &str, links: impl Iterator<Item = &'a str>) -> Vec<String> {
    let links: Vec<&str> = links.collect();
    if links.len() == 1 {
        return vec![kind.to_owned()];
    }
    let sides: Vec<Option<&str>> = links.iter().map(|link| side(link)).collect();
    let once = |s: &Option<&str>| s.is_some() && sides.iter().filter(|other| *other == s).count() == 1;
    let name = |(i, side): (usize, &Option<&str>)| match side {
        Some(word) if once(side) => format!("{word}_{kind}"),
        _ => format!("{kind}_{}", i + 1),
    };
    sides.iter().enumerate().map(name).collect()
}

/// The side that a name tells: `left`, a word `l`, or a capital `L` before another capital.
fn side(link: &str) -> Option<&'static str> {
    let lower = link.to_lowercase();
    let words: Vec<&str> = link.split(|c: char| !c.is_ascii_alphanumeric()).collect();
    let says = |long: &str, short: char| {
        let prefixed = |word: &&str| {
            let mut letters = word.chars();
            letters.next() == Some(short.to_ascii_uppercase())
                && letters.next().is_some_and(|c| c.is_ascii_uppercase())
        };
        let alone = |word: &&str| word.len() == 1 && word.eq_ignore_ascii_case(&short.to_string());
        lower.contains(long) || words.iter().any(|word| alone(word) || prefixed(word))
    };
    match (says("left", 'l'), says("right", 'r')) {
        (true, false) => Some("left"),
        (false, true) => Some("right"),
        _ => None,
    }
}

/// `path` as seen from `folder`, by names alone: there is none from an absolute folder to a relative path, or out of a folder
/// whose own name is not known.
fn relative(folder: &Path, path: &Path) -> Option<PathBuf> {
    let from: Vec<Component> = folder.components().filter(|c| *c != Component::CurDir).collect();
    let to: Vec<Component> = path.components().filter(|c| *c != Component::CurDir).collect();
    let shared = from.iter().zip(&to).take_while(|(a, b)| a == b).count();
    if folder.is_absolute() != path.is_absolute() || from[shared..].contains(&Component::ParentDir) {
        return None;
    }
    let up = std::iter::repeat_n(Component::ParentDir, from.len() - shared);
    Some(up.chain(to[shared..].iter().copied()).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_lead_from_one_folder_to_another() {
        let check = |folder: &str, path: &str, expected: &str| {
            let options =
                InitOptions { folder: folder.into(), here: "/home/me".into(), ..InitOptions::default() };
            assert_eq!(options.seen_from_folder(Path::new(path)), Path::new(expected));
        };
        check("", "robots/a.urdf", "robots/a.urdf");
        check("specs", "specs/a/b.urdf", "a/b.urdf");
        check("specs/robots", "data/a.urdf", "../../data/a.urdf");
        check("../specs", "data/a.urdf", "../me/data/a.urdf");
        check("../specs", "../specs/a.urdf", "a.urdf");
        check("/a/b", "/a/c/d.urdf", "../c/d.urdf");
        check("/home/you", "d.urdf", "../me/d.urdf");
        check("a", "/c/d.urdf", "/c/d.urdf");
    }

    #[test]
    fn names_tell_sides_apart() {
        assert_eq!(names("arm", ["palm"].into_iter()), ["arm"]);
        assert_eq!(names("arm", ["LWristYaw", "RightHand"].into_iter()), ["left_arm", "right_arm"]);
        assert_eq!(names("arm", ["left_1", "left_2", "x"].into_iter()), ["arm_1", "arm_2", "arm_3"]);
    }
}
