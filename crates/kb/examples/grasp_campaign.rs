//! Grasp sets of every hand for every object, as a table: `cargo run --release -p robotc-kb --example grasp_campaign --
//! DATA ROBOT...`, where DATA is a folder with `objects/` and each ROBOT a `*.robot.toml`.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

use robotc_core::Sources;
use robotc_core::spec::{ParameterValue, load_task};
use robotc_kb::kind::{AnyKind, Entry};
use robotc_kb::kinds::{ConvexParts, GraspSet, parameter_table};
use robotc_kb::os::OsSystem;
use robotc_kb::project::OfGripperAndObject;
use robotc_kb::{Graph, Project, Store, compile};

/// Name, file below `objects/`, and how to read it.
const OBJECTS: &[(&str, &str, &str)] = &[
    ("mug", "household/mug.obj", ""),
    ("mug 2", "household/openrave_mug1.dae", ""),
    ("duck", "household/duck.obj", "scale = 0.05\nup = \"y\""),
    ("bowl", "household/bowl.dae", ""),
    ("can", "household/coke_can.dae", ""),
    ("brick", "household/lego.obj", "scale = 0.1"),
    ("tray", "household/tray_textured.obj", "scale = 0.2"),
    ("sugar box", "ycb/004_sugar_box.obj", ""),
    ("banana", "ycb/011_banana.obj", ""),
    ("screwdriver", "ycb/044_flat_screwdriver.obj", ""),
    ("hammer", "tools/hammer.dae", ""),
    ("drill", "tools/cordless_drill.stl", ""),
    ("gear", "industrial/gear_part.dae", ""),
    ("pump", "industrial/ariac_pump_base.stl", ""),
    ("regulator", "industrial/ariac_regulator_collision.stl", ""),
    ("battery", "industrial/ariac_battery_collision.stl", ""),
    ("angle block", "industrial/angle_block.stl", "units = \"inch\""),
    ("feature part", "industrial/featuretype.stl", "units = \"inch\""),
    ("plate", "industrial/plate_holes.stl", "units = \"mm\""),
    ("pinion", "industrial/diff_pinion.stl", "units = \"mm\""),
];

/// Approaches for each grasp set; the defaults try more.
const APPROACHES: i64 = 2000;
/// Grasps kept of each.
const GRASPS: i64 = 100;

#[expect(clippy::print_stdout, reason = "a program")]
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut args = std::env::args().skip(1);
    let data = PathBuf::from(args.next().ok_or("usage: DATA ROBOT...")?).canonicalize()?;
    let robots: Vec<PathBuf> = args.map(PathBuf::from).collect();
    let folder = tempfile::tempdir()?;
    let store = Arc::new(Store::open(&folder.path().join("store"))?);
    let mut head = "| object |".to_owned();
    for robot in &robots {
        let name = robot.file_name().and_then(|n| n.to_str()).unwrap_or_default();
        write!(head, " {} |", name.trim_end_matches(".robot.toml"))?;
    }
    println!("{head}\n|---|{}", "---|".repeat(robots.len()));
    for (name, file, reading) in OBJECTS {
        let mut row = format!("| {name} |");
        for robot in &robots {
            let path = folder.path().join("object.task.toml");
            let robot = robot.canonicalize()?;
            let text = format!(
                "format = 1\nname = \"t\"\nrobot = \"{}\"\n[[object]]\nname = \"o\"\nmesh = \"{}\"\n{reading}\nmass = 0.3\n\
                 [[goal]]\nplace = \"o\"\nat = {{ xyz = [0.5, 0.0, 0.0] }}\n",
                robot.display(),
                data.join("objects").join(file).display(),
            );
            std::fs::write(&path, text)?;
            write!(row, " {} |", cell(&path, &store)?)?;
        }
        println!("{row}");
    }
    Ok(())
}

/// Grasps, sides of approach, best epsilon and median share of disturbed grasps that hold; seconds for the set.
fn cell(task: &Path, store: &Arc<Store>) -> Result<String, Box<dyn std::error::Error>> {
    static PARTS: Entry<ConvexParts> = Entry::new();
    static GRASPS_OF: Entry<GraspSet> = Entry::new();
    let mut sources = Sources::new();
    let (spec, found) = load_task(&OsSystem, &mut sources, task, &parameter_table());
    let Some(mut spec) = spec else {
        let error = found.iter().find(|d| d.severity == robotc_core::diag::Severity::Error);
        return Ok(error.map_or_else(String::new, |d| format!("{}: {}", d.code, d.message)));
    };
    let warned = found.iter().any(|d| d.code.starts_with("R05"));
    spec.parameters.set("grasp_set", "approaches", ParameterValue::Integer(APPROACHES));
    spec.parameters.set("grasp_set", "most_grasps", ParameterValue::Integer(GRASPS));
    let project = Project::of_task(&spec);
    compile(&Arc::new(Graph::plan_kinds(&project, &[&PARTS as &'static dyn AnyKind])?), store, &())?;
    let graph = Arc::new(Graph::plan_kinds(&project, &[&GRASPS_OF as &'static dyn AnyKind])?);
    let start = Instant::now();
    let report = compile(&graph, store, &())?;
    let seconds = start.elapsed().as_secs_f64();
    if let Some((_, error)) = report.failed().next() {
        return Ok(error.to_string());
    }
    let gripper = spec.task.robot.arms[spec.task.arm].gripper.ok_or("the arm carries a gripper")?;
    let grasps = report.knowledge.load::<GraspSet>(&OfGripperAndObject { gripper, object: 0 })?;
    let mark = if warned { " (!)" } else { "" };
    let Some(best) = grasps.first() else { return Ok(format!("none{mark}, {seconds:.1} s")) };
    let mut held: Vec<f64> = grasps.iter().filter_map(|g| Some(g.steadiness?.held)).collect();
    held.sort_by(f64::total_cmp);
    let median = held.get(held.len() / 2).copied().unwrap_or(0.0);
    Ok(format!("{}, {:.2}, {:.0} %{mark}, {seconds:.1} s", grasps.len(), best.epsilon, 100.0 * median))
}
