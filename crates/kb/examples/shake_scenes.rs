//! Scenes for an independent shake test of grasp sets: `cargo run --release -p robotc-kb --example shake_scenes -- OUT TASK...`
//! writes OUT/TASK.OBJECT.json for each object: the hand with its convex parts, the object with its, and the best
//! grasps, ranked by our own shaking too where the task asks for it. `xtask/shake/shake.py` runs them in MuJoCo.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use robotc_core::geom;
use robotc_core::ids::{Idx, LinkIdx};
use robotc_core::model::{Drive, JointMotion};
use robotc_core::spec::load_task;
use robotc_core::{Pose, Sources};
use robotc_kb::kind::{AnyKind, Entry};
use robotc_kb::kinds::{ConvexParts, GraspSet, GraspShake, parameter_table, ranked_grasps};
use robotc_kb::os::OsSystem;
use robotc_kb::project::{OfGripperAndObject, OfShape};
use robotc_kb::{Graph, Knowledge, Project, Store, compile};
use serde_json::{Value, json};

/// Grasps of each set that are shaken.
const BEST: usize = 20;

#[expect(clippy::print_stdout, reason = "a program")]
fn main() -> Result<(), Box<dyn std::error::Error>> {
    static PARTS: Entry<ConvexParts> = Entry::new();
    static GRASPS: Entry<GraspSet> = Entry::new();
    static SHAKEN: Entry<GraspShake> = Entry::new();
    let mut args = std::env::args().skip(1);
    let out = PathBuf::from(args.next().ok_or("usage: OUT TASK...")?);
    std::fs::create_dir_all(&out)?;
    let store = Arc::new(Store::open(&out.join("store"))?);
    for path in args {
        let mut sources = Sources::new();
        let (spec, found) = load_task(&OsSystem, &mut sources, Path::new(&path), &parameter_table());
        let Some(spec) = spec else { return Err(format!("{path}: {found:?}").into()) };
        let project = Project::of_task(&spec);
        let kinds = [&PARTS as &'static dyn AnyKind, &GRASPS, &SHAKEN];
        let report = compile(&Arc::new(Graph::plan_kinds(&project, &kinds)?), &store, &())?;
        let gripper = spec.task.robot.arms[spec.task.arm].gripper.ok_or("the arm carries a gripper")?;
        for (object, thing) in spec.task.objects.iter().enumerate() {
            let grasps = ranked_grasps(&report.knowledge, &OfGripperAndObject { gripper, object })?;
            let parts = report.knowledge.load::<ConvexParts>(&OfShape::Object(object))?;
            let preshapes = &spec.task.robot.grippers[gripper].preshapes;
            let palm_from_tool = spec.task.robot.grippers[gripper].palm_from_tool;
            let grasp = |g: &robotc_planning::Grasp| {
                json!({
                    "object_from_palm": pose(&(g.object_from_tool * palm_from_tool.inverse())),
                    "open": preshapes[g.preshape].values,
                    "closed": g.closed,
                    "epsilon": g.epsilon,
                })
            };
            let scene = json!({
                "object": thing.name,
                "mass": thing.mass,
                "parts": corners(&parts),
                "hand": hand(&project, &report.knowledge, gripper)?,
                "grasps": grasps.iter().take(BEST).map(grasp).collect::<Vec<_>>(),
            });
            let file = out.join(format!("{}.{}.json", spec.task.name, thing.name));
            std::fs::write(&file, scene.to_string())?;
            println!("{}: {} of {} grasps", file.display(), grasps.len().min(BEST), grasps.len());
        }
    }
    Ok(())
}

/// The palm and all links below it, parents first.
fn hand(
    project: &Project,
    knowledge: &Knowledge,
    gripper: usize,
) -> Result<Value, Box<dyn std::error::Error>> {
    let (model, gripper) = (&project.robot().model, &project.robot().grippers[gripper]);
    let subtree = model.subtree(gripper.palm);
    let position = |link: LinkIdx| subtree.iter().position(|&l| l == link);
    let mut links = Vec::new();
    for &link in &subtree {
        let parts = match model.links()[link].collisions.is_empty() {
            true => Vec::new(),
            false => corners(&*knowledge.load::<ConvexParts>(&OfShape::Link(link))?),
        };
        let joint =
            model.links()[link].parent_joint.filter(|_| link != gripper.palm).map(|j| &model.joints()[j]);
        let drive = joint.and_then(|joint| {
            let (dof, multiplier, offset) = match joint.drive {
                Drive::Fixed => return None,
                Drive::Dof(dof) => (dof, 1.0, 0.0),
                Drive::Mimic { dof, multiplier, offset } => (dof, multiplier, offset),
            };
            let (low, high) = model.dofs()[dof].sampling_range();
            let axis: [f64; 3] = joint.unit_axis().into_inner().into();
            Some(json!({
                "slides": joint.motion == JointMotion::Prismatic,
                "axis": axis,
                "dof": gripper.dofs.iter().position(|&d| d == dof),
                "leads": matches!(joint.drive, Drive::Dof(_)),
                "multiplier": multiplier,
                "offset": offset,
                "range": [low, high],
            }))
        });
        links.push(json!({
            "parent": joint.and_then(|joint| position(joint.parent)),
            "pose": pose(&joint.map_or_else(Pose::identity, |joint| *joint.parent_from_joint())),
            "joint": drive,
            "parts": parts,
            "index": link.index(),
        }));
    }
    Ok(json!({ "links": links, "closing": gripper.closing }))
}

fn corners(parts: &geom::ConvexParts) -> Vec<Vec<[f64; 3]>> {
    parts.iter().map(|part| part.points().iter().map(|p| [p.x, p.y, p.z]).collect()).collect()
}

/// Position, and rotation as w, x, y, z.
fn pose(pose: &Pose) -> Value {
    let (t, q) = (pose.translation.vector, pose.rotation.quaternion());
    json!({ "position": [t.x, t.y, t.z], "rotation": [q.w, q.i, q.j, q.k] })
}
