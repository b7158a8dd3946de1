//! Straight motions away from a configuration in contact, and back.

use nalgebra::Vector3;
use robotc_core::{Configuration, Pose};

use super::problem::GoalContext;
use super::rejections::Cause;
use crate::cartesian::{LineObstacle, cartesian_line};
use crate::edge::{EdgeChecker, Obstruction};
use crate::scene::{RobotChecker, Rules, Scene};

/// What an obstruction is, by name.
pub(super) fn cause(scene: &Scene, by: Obstruction) -> Cause {
    match by {
        Obstruction::Bounds => Cause::Bounds,
        Obstruction::Constraint => Cause::Constraint,
        Obstruction::Contact(_) => {
            let [one, other] = scene.names(by).unwrap_or_default().map(str::to_owned);
            Cause::Touch { one, other }
        }
    }
}

/// A checker of arm motions with these rules, at the fine resolution.
pub(super) fn fine_checker<'a>(
    cx: &GoalContext<'a>,
    scene: &'a Scene,
    q: &Configuration,
    rules: Rules,
) -> RobotChecker<'a> {
    let arm = cx.problem.arm;
    RobotChecker::new(scene, arm.space(), arm.dofs(), q, rules, cx.options.fine_resolution)
}

/// Whether the arm is free at `q`.
pub(super) fn state_is_free(checker: &mut RobotChecker<'_>, q: &[f64]) -> Result<(), Cause> {
    checker.is_free(q).map_err(|by| cause(checker.scene(), by))
}

/// Moves the tool from the configuration `from` (taken to be valid under `rules`) by `offset`, and checks that the end
/// is also valid for free motion under `free`.
pub(super) fn straight(
    cx: &GoalContext<'_>,
    scene: &Scene,
    q: &Configuration,
    from: &[f64],
    offset: &Vector3<f64>,
    rules: Rules,
    free: Rules,
) -> Result<Vec<Vec<f64>>, Cause> {
    let mut checker = fine_checker(cx, scene, q, rules);
    let mut goal: Pose = cx.problem.arm.world_from_tool(from);
    goal.translation.vector += offset;
    let path =
        cartesian_line(cx.problem.arm, &mut checker, from, &goal, &cx.options.line).map_err(|failure| {
            match failure.obstacle {
                LineObstacle::Blocked(by) => cause(scene, by),
                other => Cause::Line(other),
            }
        })?;
    state_is_free(&mut fine_checker(cx, scene, q, free), &path[path.len() - 1])?;
    Ok(path)
}

/// Backs the open gripper off from the object along `direction` (unit, world): at first it may touch the object, then
/// it may not. Ends where free motion is possible.
pub(super) fn back_off(
    cx: &GoalContext<'_>,
    scene: &Scene,
    q: &Configuration,
    from: &[f64],
    direction: &Vector3<f64>,
) -> Result<Vec<Vec<f64>>, Cause> {
    let (contact, approach) = (cx.options.contact, cx.options.approach);
    let clear = Rules { target: None, ..cx.touching() };
    let mut path = straight(cx, scene, q, from, &(direction * contact), cx.touching(), clear.clone())?;
    let rest = direction * (approach - contact).max(0.0);
    let far = straight(cx, scene, q, &path[path.len() - 1], &rest, clear, cx.free(None))?;
    path.extend(far.into_iter().skip(1));
    Ok(path)
}

/// Raises the object from where it stands; the longest of three heights that works.
pub(super) fn raise(
    cx: &GoalContext<'_>,
    scene: &Scene,
    q: &Configuration,
    from: &[f64],
    rules: &Rules,
) -> Result<Vec<Vec<f64>>, Cause> {
    let free = cx.free(rules.held.clone());
    let up = |factor: f64| {
        let offset = Vector3::z() * (factor * cx.options.lift);
        straight(cx, scene, q, from, &offset, rules.clone(), free.clone())
    };
    up(1.0).or_else(|_| up(0.5)).or_else(|_| up(0.25))
}

/// Whether the fingers can move between these positions with the arm standing at `arm_values`.
pub(super) fn fingers_move(
    cx: &GoalContext<'_>,
    scene: &Scene,
    q: &Configuration,
    arm_values: &[f64],
    from: &[f64],
    to: &[f64],
    rules: Rules,
) -> Result<(), Cause> {
    let mut q = cx.with_fingers(q, from);
    q.set(cx.problem.arm.dofs(), arm_values);
    let dofs = &cx.gripper().dofs;
    let mut checker = RobotChecker::new(scene, cx.finger_space, dofs, &q, rules, cx.options.fine_resolution);
    checker.edge(from, to).map_err(|blocked| cause(scene, blocked.by))
}
