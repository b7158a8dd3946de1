//! From an execution to a recording that can be looked at.

use nalgebra::Point3;
use robotc_core::{Configuration, LinkPoses};
use robotc_planning::manipulation::{Observer, SegmentKind};
use robotc_planning::rrt::{RrtConnect, RrtStatistics};

use crate::execute::Execution;
use crate::record::{NodeIdx, Recording};
use crate::session::Session;

/// Ticks between two frames: the page interpolates, so every controller tick would be waste.
const FRAME_SECONDS: f64 = 1.0 / 30.0;
/// Most grasps shown for an object.
const SHOWN_GRASPS: usize = 60;
/// Most edges shown of a search tree.
const SHOWN_EDGES: usize = 4000;

/// Keeps the search trees of a planner, as edges in the joint space of the arm.
#[derive(Debug, Default)]
pub struct TreeKeeper {
    /// Goal, kind of motion, and the edges of its trees.
    pub searches: Vec<(usize, SegmentKind, Vec<[Vec<f64>; 2]>)>,
}

impl Observer for TreeKeeper {
    fn searched(&mut self, goal: usize, kind: SegmentKind, search: &RrtConnect, _done: &RrtStatistics) {
        let edges = search.edges().map(|(a, b)| [a.to_vec(), b.to_vec()]).collect();
        self.searches.push((goal, kind, edges));
    }
}

/// The whole execution as a recording: robot, bodies, tool path, grasps, and the search trees that were kept.
pub fn film(session: &Session, execution: &Execution, trees: &TreeKeeper) -> Recording {
    let task = session.task();
    let mut recording = Recording::new(&task.name);
    let mut poses = LinkPoses::default();
    session.kinematics().link_poses(&task.start, &mut poses);
    let robot = recording.add_robot(&task.robot.model, &task.world_from_robot, &poses);
    let (objects, obstacles) = recording.add_bodies(task);

    let arm = session.arm();
    // A base that drives takes the arm along.
    let (tip, tip_from_tool) = (task.robot.arms[task.arm].tip, arm.tool_from_tip().inverse());
    let tool = |q: &Configuration| {
        let world_from_tip = task.world_from_robot * session.kinematics().root_from_link(q, tip);
        Point3::from((world_from_tip * tip_from_tool).translation.vector)
    };
    recording.add_tool_path("tool path", execution.ticks.iter().map(|tick| (tick.time, tool(&tick.q))));
    for ((set, &node), object) in session.grasps().iter().zip(&objects).zip(&task.objects) {
        let shown = set.grasps.iter().take(SHOWN_GRASPS).map(|g| &g.object_from_tool);
        recording.add_grasps(format!("grasps of {}", object.name), node, shown, 0.06, 0.05);
    }
    for (_, kind, edges) in &trees.searches {
        let point = |q: &Vec<f64>| Point3::from(arm.world_from_tool(q).translation.vector);
        let lines = edges.iter().take(SHOWN_EDGES).map(|[a, b]| [point(a), point(b)]);
        recording.add_tree(format!("trees of {kind}"), lines);
    }

    let mut due = 0.0;
    for (i, tick) in execution.ticks.iter().enumerate() {
        let ends_segment = execution.segments.iter().any(|s| s.span.contains(&tick.time));
        if tick.time < due && !ends_segment && i + 1 < execution.ticks.len() {
            continue;
        }
        due = tick.time + FRAME_SECONDS;
        session.kinematics().link_poses(&tick.q, &mut poses);
        let bodies = objects.iter().copied().zip(tick.world_from_objects.iter().copied());
        let moved = task.articles.iter().zip(&tick.articles).flat_map(|(a, &value)| a.moved_bodies(value));
        let moved = moved.map(|(obstacle, world_from_body)| (obstacles[obstacle], world_from_body));
        let frame: Vec<(NodeIdx, _)> =
            robot.poses(&task.world_from_robot, &poses).chain(bodies).chain(moved).collect();
        recording.push_frame(tick.time, frame);
    }
    for segment in &execution.segments {
        let name = format!("{} {}", segment.kind, segment.about);
        recording.add_stage(name, segment.span[0], segment.span[1]);
    }
    recording
}
