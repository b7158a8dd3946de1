//! The text of a guessed specification.

use std::path::Path;

use super::hands::Hand;
use super::{Guess, GuessedArm, InitOptions, groups};
use crate::ids::LinkIdx;
use crate::model::{Dof, DynamicLimits, RobotModel};
use crate::robot::Base;
use crate::spec::grippers::open_values;

/// A commented specification. Every line is valid TOML.
pub(super) fn write(guess: &Guess, options: &InitOptions) -> String {
    let model = &guess.model;
    let mut text = format!(
        "# Guessed from {}. Check what is marked, and run `robotc check` on this file.\nformat = 1\nname = {}\n",
        options.description.file_name().map_or_else(String::new, |n| n.to_string_lossy().into_owned()),
        quoted(&groups::name_of(model.name())),
    );
    text += &reference("description", &options.description, options);
    if let Some(path) = &options.srdf {
        text += &reference("srdf", path, options);
    }
    if let Some(path) = &options.joint_limits {
        text += &reference("joint_limits", path, options);
    }
    if !options.packages.is_empty() {
        text += "\n[packages]\n";
        for (name, folder) in &options.packages {
            text += &format!("{} = {}\n", quoted(name), path_text(&options.seen_from_folder(folder)));
        }
    }
    if !options.arguments.is_empty() {
        text += "\n[arguments]\n";
        for (name, value) in &options.arguments {
            text += &format!("{} = {}\n", quoted(name), quoted(value));
        }
    }
    text += &base(&guess.base);
    for arm in &guess.arms {
        text += &arm_text(arm, guess);
    }
    for (name, hand) in &guess.hands {
        text += &hand_text(name, hand, model);
    }
    text + &limits(model)
}

fn reference(key: &str, path: &Path, options: &InitOptions) -> String {
    format!("{key} = {}\n", path_text(&options.seen_from_folder(path)))
}

fn base(base: &Base) -> String {
    match base {
        Base::Fixed => {
            "\n# Bolted down. A base that drives: kind = \"planar\" with footprint = [[x, y], ...].\n\
             [base]\nkind = \"fixed\"\n"
        }
        .to_owned(),
        Base::Planar { footprint, holonomic, .. } => {
            let corners: Vec<String> = footprint.iter().map(|corner| numbers(corner)).collect();
            format!(
                "\n# It has wheels or planar joints. The outline is the box round the base's shapes: check it.\n\
                 [base]\nkind = \"planar\"\nfootprint = [{}]\n\
                 holonomic = {holonomic} # check: whether it can move sideways\n",
                corners.join(", ")
            )
        }
    }
}

fn arm_text(arm: &GuessedArm, guess: &Guess) -> String {
    let model = &guess.model;
    let joints = joined(arm.dofs.iter().map(|&d| model.dofs()[d].name.clone()));
    let source = if arm.from_srdf { "A group of the SRDF" } else { "The chain" };
    let mut text = format!(
        "\n# {source} with the joints\n# {joints}.\n[[arm]]\nname = {}\nbase = {}\ntip = {}\n",
        quoted(&arm.name),
        link(model, arm.base),
        link(model, arm.tip),
    );
    if let Some(hand) = arm.hand {
        text += &format!("gripper = {}\n", quoted(&guess.hands[hand].0));
    }
    let (home, why) = match &arm.home {
        Some(home) => (home.clone(), "the resting state of the SRDF"),
        None => {
            let home = arm.dofs.iter().map(|&dof| resting(&model.dofs()[dof])).collect();
            (home, "zero where far from limits, else half-way; choose a better one")
        }
    };
    text + &format!("home = {} # {why}\n", numbers(&home))
}

/// Zero when it keeps a tenth of the range from either limit, else the middle of the range, to four digits.
fn resting(dof: &Dof) -> f64 {
    let margin = 0.1 * (dof.upper - dof.lower);
    if !margin.is_finite() || (dof.lower + margin <= 0.0 && 0.0 <= dof.upper - margin) {
        return 0.0_f64.clamp(dof.lower, dof.upper);
    }
    let middle = (dof.lower + dof.upper) / 2.0;
    ((middle * 1e4).round() / 1e4).clamp(dof.lower, dof.upper) + 0.0
}

fn hand_text(name: &str, hand: &Hand, model: &RobotModel) -> String {
    let joints = joined(hand.dofs.iter().map(|&d| quoted(&model.dofs()[d].name)));
    let fingers = joined(hand.fingers.iter().map(|&l| link(model, l)));
    let values = open_values(model, &hand.dofs, &hand.closing);
    format!(
        "\n[[gripper]]\nname = {}\npalm = {}\n\
         # Check: between the finger tips, seen from the palm.\n\
         tool = {{ xyz = {}, rpy = [0.0, 0.0, 0.0] }}\n\
         # Check: from the palm towards the finger tips.\napproach = {}\n\
         joints = [{joints}]\n\
         # Check: 1 closes by growing, -1 by shrinking, 0 only shapes the hand.\nclosing = {}\n\
         # The links that may touch what is grasped.\nfingers = [{fingers}]\n\
         \n[[gripper.preshape]]\nname = \"open\"\nvalues = {}\n",
        quoted(name),
        link(model, hand.palm),
        numbers(&hand.tool),
        numbers(&hand.approach),
        numbers(&hand.closing),
        numbers(&values),
    )
}

/// A default for whatever no file gives, labelled as such.
fn limits(model: &RobotModel) -> String {
    let d = DynamicLimits::DEFAULT;
    let all = [("velocity", d.velocity), ("acceleration", d.acceleration), ("jerk", d.jerk)];
    let open = |i: usize| model.dofs().iter().any(|dof| !dof.dynamics.given[i]);
    let missing: Vec<String> =
        (0..3).filter(|&i| open(i)).map(|i| format!("{} = {}", all[i].0, number(all[i].1))).collect();
    if missing.is_empty() {
        return String::new();
    }
    format!(
        "\n# Assumed: no file gives these limits for all joints. Write those of the maker's data sheet, for one joint with\n\
         # joints.NAME = {{ velocity = .., acceleration = .., jerk = .. }}\n\
         [limits]\ndefault = {{ {} }}\n",
        missing.join(", ")
    )
}

fn link(model: &RobotModel, index: LinkIdx) -> String {
    quoted(&model.links()[index].name)
}

fn path_text(path: &Path) -> String {
    quoted(&path.to_string_lossy().replace('\\', "/"))
}

/// A TOML string.
fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}

fn number(x: f64) -> String {
    format!("{x:?}")
}

fn numbers(values: &[f64]) -> String {
    format!("[{}]", joined(values.iter().map(|x| number(*x))))
}

fn joined(items: impl Iterator<Item = String>) -> String {
    items.collect::<Vec<_>>().join(", ")
}
