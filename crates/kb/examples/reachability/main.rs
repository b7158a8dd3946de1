//! Measures reachability maps: `cargo run --release -p robotc-kb --example reachability [THREADS] [LEVEL] [ROBOT...]`.
//!
//! For each robot specification, its first arm: the time to compute the map, its size, what it says of held-out random
//! configurations and of uniform poses compared with exhaustive inverse kinematics, and the time of a query. Prints rows of
//! a Markdown table; to the error stream base placements, alone and in [`scenes`].

#![allow(clippy::print_stdout, clippy::print_stderr)]

mod scenes;

use std::error::Error;
use std::f64::consts::PI;
use std::hint::black_box;
use std::path::PathBuf;
use std::sync::Arc;

use robotc_core::rng::Rng;
use robotc_core::spec::{ParameterValue, load_robot};
use robotc_core::{Pose, Seed, Sources};
use robotc_kb::kinds::reachability::{ArmAlone, FreeValues, Placements, Scratch, Target, Trust, Verdict};
use robotc_kb::kinds::{self, Reachability, ReachabilityMap};
use robotc_kb::os::OsSystem;
use robotc_kb::project::OfArm;
use robotc_kb::{Graph, Project, Store, compile};

/// Edge of a cell, metres.
const STEP: f64 = 0.04;

/// Held-out configurations, and uniform poses.
const TRIALS: usize = 100_000;

/// Values of the free joints that count as exhaustive, and those with which mixed cells are asked.
const EXHAUSTIVE: usize = 64;
const EXACT: usize = 16;

fn main() -> Result<(), Box<dyn Error>> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let number = |i: usize, default: i64| args.get(i).map_or(Ok(default), |text| text.parse());
    let (threads, level) = (number(0, 2)?, number(1, 1)?);
    let mut files: Vec<PathBuf> = args.iter().skip(2).map(PathBuf::from).collect();
    if files.is_empty() {
        let specs = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../specs/robots");
        files = ["wam", "panda", "ur5e"].map(|name| specs.join(format!("{name}.robot.toml"))).into();
    }
    rayon::ThreadPoolBuilder::new().num_threads(threads as usize).build_global()?;
    println!(
        "| robot | rotations | cells | processor time | bytes | whole | in part | recall | recall, mixed solved | false share of \
         positives | mixed poses | missed of uniform | query | mixed query |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|---|---|---|");
    for file in files {
        println!("{}", row(&file, level)?);
    }
    Ok(())
}

/// Processor time of this process, all threads, in seconds: what counts on a machine that others use too. The wall clock
/// where the system does not tell.
pub(crate) fn processor_seconds() -> f64 {
    let ticks = |text: String| -> Option<f64> {
        let mut fields = text.rsplit(')').next()?.split_whitespace().skip(11);
        let (user, system): (f64, f64) = (fields.next()?.parse().ok()?, fields.next()?.parse().ok()?);
        Some((user + system) / 100.0)
    };
    std::fs::read_to_string("/proc/self/stat").ok().and_then(ticks).unwrap_or_else(|| {
        let since = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH);
        since.map_or(0.0, |since| since.as_secs_f64())
    })
}

fn row(file: &std::path::Path, level: i64) -> Result<String, Box<dyn Error>> {
    let (spec, _) = load_robot(&OsSystem, &mut Sources::new(), file, &kinds::parameter_table());
    let mut spec = spec.ok_or_else(|| format!("{} has errors; `robotc check` shows them", file.display()))?;
    let folder = tempfile::tempdir()?;
    let store = Arc::new(Store::open(folder.path())?);
    // Everything that the map is computed from is compiled first, so that the map is timed alone.
    let coarse = [("step", ParameterValue::Number(1.0)), ("level", ParameterValue::Integer(0))];
    for (name, value) in coarse {
        spec.parameters.set("reachability", name, value);
    }
    compile(&Arc::new(Graph::plan(&Project::of_robot(&spec))?), &store, &())?;
    spec.parameters.set("reachability", "step", ParameterValue::Number(STEP));
    spec.parameters.set("reachability", "level", ParameterValue::Integer(level));
    spec.parameters.set("reachability", "configurations", ParameterValue::Integer(16_000_000));
    let graph = Arc::new(Graph::plan(&Project::of_robot(&spec))?);
    let start = processor_seconds();
    let report = compile(&graph, &store, &())?;
    let seconds = processor_seconds() - start;
    if let Some((_, error)) = report.failed().next() {
        return Err(error.to_string().into());
    }
    let known = report.knowledge;
    let map = known.load::<Reachability>(&OfArm(0))?;
    let dep = graph.find::<Reachability>(&OfArm(0)).ok_or("no map")?;
    let content = known.known(dep.node()).ok_or("not computed")?.content;
    let bytes = store.read(&content)?.len();
    let arm = ArmAlone::load(&known, 0)?;
    let mut scratch = Scratch::default();

    // Held out: the seed is not that of any artefact.
    let mut rng = Seed::new(2024).split("held out").rng();
    let (mut held_out, mut lost, mut unsolved, mut poses) = (0, 0, 0, Vec::new());
    while held_out < TRIALS {
        let draw = |v: &robotc_core::model::ChainVariable| match v.lower.is_finite() && v.upper.is_finite() {
            true => (v.lower, v.upper),
            false => (-std::f64::consts::PI, std::f64::consts::PI),
        };
        let joints: Vec<f64> = arm.chain().variables.iter().map(draw).map(|(a, b)| rng.range(a, b)).collect();
        if arm.collides(&joints, &mut scratch) {
            continue;
        }
        held_out += 1;
        let pose = arm.chain().forward(&joints);
        match map.verdict(&pose) {
            Verdict::No => lost += 1,
            Verdict::Mixed => unsolved += usize::from(map.reach(&arm, &pose, EXACT, &mut scratch).is_none()),
            Verdict::Yes => {}
        }
        poses.push(pose);
    }

    // Uniform over the ball that holds every tip.
    let reach = known.load::<kinds::ChainReach>(&OfArm(0))?;
    let mut counts = [[0_usize; 2]; 3];
    let mut mixed = Vec::new();
    let free = arm.free_values(EXHAUSTIVE);
    for _ in 0..TRIALS {
        let direction = rng.direction().into_inner();
        let offset = direction * (reach.radius * rng.unit().cbrt());
        let position = reach.centre_in_base + offset;
        let pose = Pose::from_parts(position.coords.into(), rng.rotation());
        let verdict = map.verdict(&pose);
        let reached = arm.reach_with(&pose, &free, &mut scratch).is_some();
        counts[verdict as usize][usize::from(reached)] += 1;
        if verdict == Verdict::Mixed {
            mixed.push(pose);
        }
        poses.push(pose);
    }
    let [no, yes, part] = counts;
    let positives = yes[0] + yes[1] + part[1];
    let share = |count: usize, of: usize| 100.0 * count as f64 / of.max(1) as f64;

    let query = query_time(&map, &poses, &mut rng);
    let start = processor_seconds();
    let solved = mixed.iter().filter(|pose| black_box(map.reach(&arm, pose, EXACT, &mut scratch)).is_some());
    let solved = solved.count();
    let mixed_query = (processor_seconds() - start) * 1e6 / mixed.len().max(1) as f64;
    eprintln!("mixed poses: {solved} of {} solved", mixed.len());
    eprintln!("{}", solutions(&arm, &map, &mut scratch));
    eprintln!("{}", placements(&arm, &map, &free));
    let wheels = scenes::OnWheels::load(&known, &arm)?;
    scenes::rows(&spec.name, &arm, &wheels, &map, reach.radius).iter().for_each(|row| eprintln!("{row}"));

    let [some, whole, _] = map.counts();
    let cells = map.grid.len();
    Ok(format!(
        "| {} | {} | {cells} | {seconds:.0} s | {bytes} | {:.1} % | {:.1} % | {:.2} % | {:.2} % | {:.2} % | {:.1} % | {:.2} % | {query:.0} \
         ns | {mixed_query:.1} us |",
        spec.name,
        map.grid.rotations().len(),
        share(whole, cells),
        share(some - whole, cells),
        100.0 - share(lost, TRIALS),
        100.0 - share(lost + unsolved, TRIALS),
        share(yes[0], positives),
        share(part[0] + part[1], TRIALS),
        share(no[1], no[1] + positives),
    ))
}

/// Nanoseconds of a point query: the fastest of many rounds over the same poses, shuffled anew for each.
/// How many solutions the cells have that are reached at their centre, and what it takes to find all of one.
fn solutions(arm: &ArmAlone, map: &ReachabilityMap, scratch: &mut Scratch) -> String {
    let reached: Vec<usize> = (0..map.grid.len()).filter(|&cell| map.cell(cell).density > 0).collect();
    let asked: Vec<Pose> =
        reached.iter().step_by((reached.len() / 2000).max(1)).map(|&cell| map.grid.centre(cell)).collect();
    let start = processor_seconds();
    let found: usize = asked.iter().map(|pose| arm.solutions(pose, EXACT, scratch).len()).sum();
    let micros = (processor_seconds() - start) * 1e6 / asked.len() as f64;
    format!(
        "solutions of a cell that is reached at its centre: {:.1} on average, all found in {micros:.0} us",
        found as f64 / asked.len() as f64
    )
}

fn query_time(map: &ReachabilityMap, poses: &[Pose], rng: &mut Rng) -> f64 {
    const ROUNDS: usize = 20;
    const POSES: usize = 20_000;
    let mut poses = poses.to_vec();
    let mut fastest = f64::INFINITY;
    for _ in 0..ROUNDS {
        rng.shuffle(&mut poses);
        let start = std::time::Instant::now();
        for pose in &poses[..POSES] {
            black_box(map.verdict(black_box(pose)));
        }
        fastest = fastest.min(start.elapsed().as_secs_f64());
    }
    fastest * 1e9 / POSES as f64
}

/// Base placements for poses on a table: time, and how many samples have collision-free inverse kinematics, compared with
/// bases drawn uniformly from the disc of the arm's reach.
fn placements(arm: &ArmAlone, map: &ReachabilityMap, free: &FreeValues) -> String {
    const SAMPLES: usize = 5000;
    const POSES: usize = 1000;
    let mut rng = Seed::new(2024).split("placements").rng();
    let mut scratch = Scratch::default();
    let middle = map.grid.base_from_axis.translation.vector.z;
    // Poses that are reached from somewhere.
    let mut targets = Vec::new();
    while targets.len() < POSES {
        let p = [rng.range(-0.3, 0.3), rng.range(-0.3, 0.3), middle + rng.range(-0.3, 0.3)];
        let world_from_tip = Pose::from_parts(p.into(), rng.rotation());
        let target = Target { world_from_tip, weight: 1.0 };
        if !Placements::new(map, &[target], &[Pose::identity()], Trust::Whole).is_empty() {
            targets.push(target);
        }
    }
    let mount = [Pose::identity()];
    let start = processor_seconds();
    for target in &targets {
        black_box(Placements::new(map, std::slice::from_ref(target), &mount, Trust::Whole));
    }
    let one = (processor_seconds() - start) * 1e3 / POSES as f64;
    let start = processor_seconds();
    let placements = Placements::new(map, &targets, &mount, Trust::Whole);
    let all = (processor_seconds() - start) * 1e3;
    let mut reached = |position: [f64; 2], yaw: f64, target: usize| {
        let turn = nalgebra::UnitQuaternion::from_axis_angle(&nalgebra::Vector3::z_axis(), yaw);
        let world_from_base = Pose::from_parts([position[0], position[1], 0.0].into(), turn);
        arm.reach_with(&world_from_base.inv_mul(&targets[target].world_from_tip), free, &mut scratch)
            .is_some()
    };
    let (mut good, mut uniform) = (0, 0);
    let radius = map.grid.radial as f64 * map.grid.step;
    for _ in 0..SAMPLES {
        let Some(placement) = placements.sample(&mut rng) else { break };
        good += usize::from(reached(placement.position, placement.yaw, placement.target));
        let (angle, distance) = (rng.range(-PI, PI), radius * rng.unit().sqrt());
        let target = rng.below(POSES);
        let p = targets[target].world_from_tip.translation.vector;
        let position = [p.x + distance * angle.cos(), p.y + distance * angle.sin()];
        uniform += usize::from(reached(position, rng.range(-PI, PI), target));
    }
    let share = |count: usize| 100.0 * count as f64 / SAMPLES as f64;
    format!(
        "base placements: {one:.2} ms for 1 pose, {all:.0} ms for {POSES}; {:.1} % of samples reached, {:.1} % of uniform \
         ones, {:.1} times as many",
        share(good),
        share(uniform),
        good as f64 / uniform.max(1) as f64,
    )
}
