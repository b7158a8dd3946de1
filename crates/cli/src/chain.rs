//! The chain of a description that a command is about: between two links, or that of its arm.

use std::path::Path;
use std::sync::Arc;

use robotc_core::spec::{ArmGuess, guess_arms};
use robotc_core::urdf::{self, LoadOptions};
use robotc_core::{Kinematics, LinkIdx, RobotModel, SerialChain, Sources, diag};
use robotc_kb::os::OsSystem;

use crate::output::{Failure, Outcome, say};

/// The chain, and what it is part of.
pub(crate) struct Arm {
    pub(crate) kinematics: Kinematics,
    pub(crate) base: LinkIdx,
    pub(crate) chain: SerialChain,
}

/// The links between which it is, where they are named.
#[derive(Clone, Copy)]
pub(crate) struct Ends<'a> {
    pub(crate) base: Option<&'a str>,
    pub(crate) tip: Option<&'a str>,
}

/// Reads a description and takes the chain between two links. Where one is not named, it is that of the arm with most joints; says which it
/// took.
pub(crate) fn load(path: &Path, options: &LoadOptions, ends: Ends<'_>) -> Outcome<Arm> {
    let mut sources = Sources::new();
    let (model, found) = urdf::load(&OsSystem, &mut sources, path, options);
    let model: Arc<RobotModel> = crate::input::accept(model, &found, &sources)?.into();
    let named = |name: Option<&str>| name.map(|name| link(&model, name)).transpose();
    let (base, tip) = match (named(ends.base)?, named(ends.tip)?) {
        (Some(base), Some(tip)) => (base, tip),
        (base, tip) => {
            let arm = guessed(&model, base, tip)?;
            let name = |link: LinkIdx| &model.links()[link].name;
            say(&format!("taken: --base {} --tip {}", name(arm.base), name(arm.tip)));
            (arm.base, arm.tip)
        }
    };
    let kinematics = Kinematics::new(model);
    let chain = SerialChain::between(&kinematics, base, tip).map_err(|e| Failure::Input(e.to_string()))?;
    Ok(Arm { kinematics, base, chain })
}

/// The arm with most joints, of those that start and end where they should.
fn guessed(model: &Arc<RobotModel>, base: Option<LinkIdx>, tip: Option<LinkIdx>) -> Outcome<ArmGuess> {
    let mut arms = guess_arms(model);
    arms.retain(|arm| base.is_none_or(|base| base == arm.base) && tip.is_none_or(|tip| tip == arm.tip));
    let most = arms.first().map_or(0, |arm| arm.dofs.len());
    arms.retain(|arm| arm.dofs.len() == most);
    match &arms[..] {
        [arm] => Ok(arm.clone()),
        [] => Err(Failure::Input("no arm was found there; name both --base and --tip".into())),
        several => {
            let name = |link: LinkIdx| &model.links()[link].name;
            let lines = several
                .iter()
                .map(|arm| format!("\n  --base {} --tip {} ({most} joints)", name(arm.base), name(arm.tip)));
            Err(Failure::Input(format!("there are several arms; choose one:{}", lines.collect::<String>())))
        }
    }
}

fn link(model: &RobotModel, name: &str) -> Outcome<LinkIdx> {
    let names = model.links().iter().map(|link| link.name.as_str());
    model.link_named(name).ok_or_else(|| unknown("link", name, names))
}

/// Refuses a name that is not there, with the nearest one or all that are.
pub(crate) fn unknown<'a>(what: &str, name: &str, known: impl Iterator<Item = &'a str> + Clone) -> Failure {
    let hint = match diag::nearest(name, known.clone()) {
        Some(near) => format!("did you mean {near}?"),
        None => format!("there are {}", known.collect::<Vec<_>>().join(", ")),
    };
    Failure::Input(format!("there is no {what} {name}; {hint}"))
}
