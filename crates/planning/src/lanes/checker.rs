//! The edge checker over the lane kernel: whole motions proven free, or shown to be blocked.

use nalgebra::Vector3;
use pulp::{Simd, WithSimd};
use robotc_core::ids::Idx;
use robotc_core::{BodyIdx, Pose};

use super::Width;
use super::glance::{Hit, Look, Meeting, View};
use super::kernel::{Around, Close, Line, MOST_LANES, Motion, Scratch, look};
use super::mechanism::{Body, Group, LaneRobot, Trust, number_of};
use super::obstacle::Obstacle;
use super::suspects::{Inquiry, Suspect, Suspects};
use crate::edge::{Blocked, EdgeChecker, Obstruction, Patience};
use crate::scene::{PlacedPile, Rules, Scene};
use crate::space::Space;

/// Checks motions of a robot among the bodies of a scene, several configurations at a time.
///
/// An edge is cut into stretches, a multiple of sixteen whatever the number of lanes. A stretch is settled when spheres that
/// contain the robot cannot reach anything within it, or when spheres inside of the robot touch something; others are
/// halved. Where that does not help, since a gap is too narrow for spheres, the convex parts themselves decide, by
/// conservative advancement. A free edge is thus free as a whole, at every state between its ends.
pub struct LaneChecker<'a> {
    pub(super) robot: &'a LaneRobot,
    pub(super) scene: &'a Scene,
    pub(super) space: &'a Space,
    pub(super) width: Width,
    pub(super) obstacles: Vec<Obstacle>,
    /// The body of the scene that each obstacle belongs to.
    pub(super) owners: Vec<BodyIdx>,
    /// For each group of bodies, the obstacles that it can come near to, and how far it keeps from them: metres, negative where it
    /// may be in them.
    pub(super) near: Vec<Vec<(u32, f32)>>,
    /// The same one by one: what was hit last comes first, since what is hit once is often hit again.
    meetings: Vec<Meeting>,
    suspects: Suspects,
    patience: Patience,
    pub(super) work: &'a mut LaneMemory,
    pub(super) statistics: LaneStatistics,
}

/// What a checker did.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct LaneStatistics {
    /// Motions asked for.
    pub edges: u64,
    /// Single configurations looked at in lanes.
    pub looks: u64,
    /// Stretches looked at in lanes.
    pub stretches: u64,
    /// Distances of convex parts asked for.
    pub distances: u64,
}

/// Memory of a checker. It grows with use; kept from one checker to the next, nothing is allocated any more.
#[derive(Debug, Default)]
pub struct LaneMemory {
    pub(super) motion: Motion,
    pub(super) scratch: Scratch,
    /// Joint values of unrelated configurations, step by step.
    pub(super) joints: Vec<f32>,
    /// What is close in some of them, a bit for each.
    pub(super) crowded: Vec<(Close, u32)>,
    /// Stretches of the edge still to be looked at: middle and half length.
    queue: Vec<(f32, f32)>,
    /// Stretches that the spheres do not settle, with what is close there.
    gaps: Vec<(f32, f32, Close)>,
    pub(super) difference: Vec<f64>,
    pub(super) values: Vec<f64>,
    /// Where the frames are at `values`.
    pub(super) frames: Vec<Pose>,
    pub(super) pieces: Vec<(f64, f64)>,
    /// For each two parts of the things that are being settled, the direction of the gap between them that was found last, as the
    /// first one sees it.
    pub(super) directions: Vec<Option<Vector3<f64>>>,
    /// Stretches of the edge in which two things were proven apart: first, last, which.
    pub(super) proven: Vec<(f64, f64, Close)>,
}

/// Stretches of an edge are a multiple of this, so that their places do not depend on the number of lanes.
const STRETCHES: usize = MOST_LANES;

/// No stretch is longer than this at first, in the metric of the space.
const LONGEST: f64 = 1.0 / 16.0;

/// Looks at a motion are no farther apart than this, in the metric of the space.
const LOOK: f64 = 1.0 / 20.0;

/// Stretches in which nothing moves farther than this, in metres, are left to the convex parts.
const FINE: f64 = 5e-2;

/// Stretches of one edge after which it counts as blocked.
const MOST_STRETCHES: usize = 8192;

impl<'a> LaneChecker<'a> {
    /// Motions of `robot`, whose degrees of freedom are the coordinates of `space`, among the bodies of `scene`. Robot and
    /// bodies stay `margin` metres apart; links may come closer to each other.
    pub fn new(
        robot: &'a LaneRobot,
        scene: &'a Scene,
        space: &'a Space,
        margin: f64,
        width: Width,
        work: &'a mut LaneMemory,
    ) -> Self {
        Self::with_rules(robot, scene, space, &Rules { margin, ..Rules::default() }, width, work)
    }

    /// Motions under `rules`. What is held is what the robot was made to [hold](LaneRobot::holding), and links of the gripper are
    /// those of its [hand](LaneRobot::with_hand), whatever the rules say of both.
    pub fn with_rules(
        robot: &'a LaneRobot,
        scene: &'a Scene,
        space: &'a Space,
        rules: &Rules,
        width: Width,
        work: &'a mut LaneMemory,
    ) -> Self {
        let mut obstacles = Vec::new();
        let mut owners = Vec::new();
        let root_from_world = scene.world_from_robot().inverse();
        for (body, root_from_body, geometry) in scene.solids() {
            if robot.held == Some(body) {
                continue;
            }
            let root_from_body = root_from_world * root_from_body;
            let primitives: Option<Vec<Obstacle>> = geometry
                .iter()
                .map(|g| Obstacle::of_shape(&g.shape, &(root_from_body * g.origin.pose())))
                .collect();
            let solids = primitives.unwrap_or_else(|| {
                let (parts, piles) = scene.made_of(body);
                let parts = parts.map(|part| Obstacle::of_part(part, &root_from_body));
                let placed =
                    |p: &PlacedPile| Obstacle::of_pile(&p.pile, &(root_from_body * p.body_from_pile));
                parts.chain(piles.iter().map(placed)).collect()
            });
            owners.extend(solids.iter().map(|_| body));
            obstacles.extend(solids);
        }
        let near = near(robot, &obstacles, &owners, rules);
        let statistics = LaneStatistics::default();
        // What is farther out moves more and touches more often. What spheres inside of the robot may be in, they do not tell.
        let each = near.iter().enumerate().rev().flat_map(|(group, near)| {
            near.iter().map(move |&(obstacle, room)| Meeting { group: group as u32, obstacle, room })
        });
        let meetings = each.filter(|meeting| meeting.room >= 0.0).collect();
        Self {
            robot,
            scene,
            space,
            width,
            obstacles,
            owners,
            near,
            meetings,
            suspects: Suspects::new(),
            patience: Patience::Thorough,
            work,
            statistics,
        }
    }

    /// What was done so far.
    pub fn statistics(&self) -> LaneStatistics {
        self.statistics
    }

    /// Whether the motion is free; if not, where and why.
    fn check(&mut self, from: &[f64], stretches: usize) -> Result<(), Blocked> {
        self.statistics.edges += 1;
        self.work.prepare(self.robot, from, stretches);
        let around = Around { obstacles: &self.obstacles, near: &self.near };
        let pass = Pass {
            robot: self.robot,
            around,
            from,
            work: &mut *self.work,
            stretches: &mut self.statistics.stretches,
        };
        if let Some((fraction, close)) = self.width.dispatch(pass) {
            return Err(Blocked { fraction: f64::from(fraction), by: self.obstruction(close) });
        }
        if let (Patience::Hasty, Some(&(middle, _, close))) = (self.patience, self.work.gaps.first()) {
            return Err(Blocked { fraction: f64::from(middle), by: self.obstruction(close) });
        }
        for i in 0..self.work.gaps.len() {
            let (middle, half, close) = self.work.gaps[i];
            self.settle(from, f64::from(middle), f64::from(half), close)?;
        }
        Ok(())
    }

    /// Whether the motion looks free at `count` states.
    fn look(&mut self, from: &[f64], count: usize, trust: Trust) -> Result<(), Blocked> {
        self.statistics.edges += 1;
        self.statistics.looks += count as u64;
        self.work.set_steps(self.robot, from);
        let LaneMemory { motion, scratch, difference, .. } = &mut *self.work;
        let (robot, obstacles, meetings) = (self.robot, &self.obstacles, &self.meetings);
        let view = View { robot, obstacles, meetings, motion, trust, from, difference };
        let inquiry = Inquiry { view, suspects: &self.suspects, count, frames: &mut scratch.frames };
        let hit = self.width.narrow().dispatch(inquiry).map(Hit::Obstacle);
        let close = match hit.or_else(|| self.width.dispatch(Look { view, count, scratch })) {
            None => return Ok(()),
            Some(Hit::Pair(pair)) => Close::Pair(pair),
            Some(Hit::Obstacle(suspect)) => {
                let Suspect { body, obstacle, .. } = suspect;
                if self.suspects.blame(suspect) {
                    let group = self.robot.bodies[body as usize].group as u32;
                    let hit = |m: &Meeting| m.group == group && m.obstacle == obstacle;
                    let at = self.meetings.iter().position(hit).expect("it was looked at");
                    self.meetings[..=at].rotate_right(1);
                }
                Close::Obstacle { body, obstacle }
            }
        };
        Err(Blocked { fraction: 1.0, by: self.obstruction(close) })
    }

    pub(super) fn obstruction(&self, close: Close) -> Obstruction {
        let of_body = |body: BodyIdx| self.scene.links() + body.index();
        let held = self.robot.held.map_or(0, of_body);
        let body = |body: usize| self.robot.bodies[body].link.map_or(held, number_of);
        let (a, b) = match close {
            Close::Obstacle { body: own, obstacle } => {
                (body(own as usize), of_body(self.owners[obstacle as usize]))
            }
            Close::Pair(pair) => {
                let pair = &self.robot.pairs[pair as usize];
                (body(pair.a), body(pair.b))
            }
        };
        Obstruction::Contact((a as u32) << 16 | b as u32)
    }
}

/// For each group of bodies, the obstacles that it can come near to in any configuration, and how far it keeps from them.
fn near(
    robot: &LaneRobot,
    obstacles: &[Obstacle],
    owners: &[BodyIdx],
    rules: &Rules,
) -> Vec<Vec<(u32, f32)>> {
    let within_reach = |body: &Body, obstacle: &Obstacle| {
        let Some(&(first, reach)) = body.chain.first() else { return false };
        // All of the body stays within its reach of the first joint that turns; sliding joints leave no fixed middle.
        let fixed = body.chain.iter().all(|&(step, _)| !robot.steps[step].slides);
        let middle = robot.steps[first].parent_from_joint.translation.vector;
        let (centre, radius) = obstacle.ball;
        let away = Vector3::from(centre) - middle;
        !fixed || body.chain.len() < 2 || away.norm() <= reach + radius + rules.margin + 1e-3
    };
    let keeps = |group: &Group, owner: BodyIdx| -> Option<f64> {
        // Bodies of a group are of one kind.
        let first = group.bodies[0];
        if robot.bodies[first].link.is_none() {
            return Some(rules.sink.map_or(rules.margin, |sink| -sink));
        }
        match robot.is_of_hand(first) && rules.target == Some(owner) {
            true => rules.give.map(|give| -give),
            false => Some(rules.margin),
        }
    };
    let reach_of = |group: &Group| -> Vec<(u32, f32)> {
        let any =
            |obstacle: &Obstacle| group.bodies.iter().any(|&i| within_reach(&robot.bodies[i], obstacle));
        let each = obstacles.iter().zip(owners).enumerate();
        let near = each.filter(|(_, (obstacle, _))| any(obstacle));
        near.filter_map(|(i, (_, owner))| Some((i as u32, keeps(group, *owner)? as f32))).collect()
    };
    robot.groups.iter().map(reach_of).collect()
}

impl LaneMemory {
    /// What the joints do in the motion by `difference` from `from`.
    fn set_steps(&mut self, robot: &LaneRobot, from: &[f64]) {
        let steps = &mut self.motion.steps;
        steps.clear();
        for step in &robot.steps {
            let (start, change) = step.motion(from, &self.difference);
            steps.push((start as f32, change as f32));
        }
    }

    /// Which pairs may touch in the motion by `difference` from `from`.
    fn set_pairs(&mut self, robot: &LaneRobot, from: &[f64]) {
        let pairs = &mut self.motion.pairs;
        pairs.clear();
        for (i, pair) in robot.pairs.iter().enumerate() {
            if !pair.apart.as_ref().is_some_and(|apart| apart.holds(from, &self.difference)) {
                pairs.push((i as u32, 0.0));
            }
        }
    }

    /// Numbers of the motion by `difference` from `from`, and its first stretches.
    fn prepare(&mut self, robot: &LaneRobot, from: &[f64], stretches: usize) {
        self.set_steps(robot, from);
        self.set_pairs(robot, from);
        let Motion { steps, bends, pairs, .. } = &mut self.motion;
        bends.clear();
        let change = |step: usize| f64::from(steps[step].1.abs());
        // A hair more, for rounding.
        let above = |x: f64| (x * (1.0 + 1e-6)) as f32;
        for body in &robot.bodies {
            bends.push(above(robot.bend(&body.chain, change)));
        }
        for (i, closing) in pairs.iter_mut() {
            let pair = &robot.pairs[*i as usize];
            *closing = above(pair.closing.iter().map(|&(step, distance)| change(step) * distance).sum());
        }
        // Nothing moves faster than this, metres per motion.
        let speed = |body: &Body| body.chain.iter().map(|&(step, distance)| change(step) * distance).sum();
        let fastest = robot.bodies.iter().map(speed).fold(0.0_f64, f64::max);
        self.motion.halvable = (FINE / fastest.max(FINE)) as f32;
        self.gaps.clear();
        self.proven.clear();
        // Another robot may have used this memory.
        self.frames.clear();
        self.queue.clear();
        let half = 0.5 / stretches as f32;
        self.queue.extend((0..stretches).map(|i| ((2 * i + 1) as f32 * half, half * (1.0 + 1e-6))));
    }
}

/// All stretches of one edge.
struct Pass<'a> {
    robot: &'a LaneRobot,
    around: Around<'a>,
    from: &'a [f64],
    work: &'a mut LaneMemory,
    stretches: &'a mut u64,
}

impl WithSimd for Pass<'_> {
    /// Where it is blocked, and by what.
    type Output = Option<(f32, Close)>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let LaneMemory { motion, scratch, queue, gaps, difference, .. } = self.work;
        let line = Line { from: self.from, difference };
        let lanes = S::F32_LANES;
        let first = queue.len();
        let mut next = 0;
        while next < queue.len() {
            let count = (queue.len() - next).min(lanes);
            let (mut middles, mut halves) = ([0.0; MOST_LANES], [0.0; MOST_LANES]);
            let picks: [usize; MOST_LANES] = std::array::from_fn(|lane| {
                // The first stretches are taken from all over the edge.
                let blocks = (first / lanes).max(1);
                if next < first && first % lanes == 0 {
                    (lane % lanes) * blocks + next / lanes
                } else {
                    next + lane.min(count - 1)
                }
            });
            for lane in 0..lanes {
                (middles[lane], halves[lane]) = queue[picks[lane]];
            }
            next += count;
            *self.stretches += count as u64;
            let stretches = (&middles[..lanes], &halves[..lanes]);
            let hit = look(simd, self.robot, &self.around, motion, line, stretches, scratch);
            if let Some((lane, close)) = hit {
                return Some((middles[lane], close));
            }
            for lane in 0..count {
                if scratch.open[lane] == 0.0 {
                    continue;
                }
                let (middle, half) = (middles[lane], halves[lane]);
                if half > motion.halvable {
                    let quarter = 0.5 * half;
                    queue.push((middle - quarter, quarter * (1.0 + 1e-6)));
                    queue.push((middle + quarter, quarter * (1.0 + 1e-6)));
                } else {
                    gaps.extend(scratch.close.iter().map(|&close| (middle, half, close)));
                }
            }
            if queue.len() > MOST_STRETCHES {
                return Some((middles[0], scratch.widest));
            }
        }
        None
    }
}

impl EdgeChecker for LaneChecker<'_> {
    fn space(&self) -> &Space {
        self.space
    }

    fn state(&mut self, q: &[f64]) -> Result<f64, Obstruction> {
        if !self.space.contains(q) {
            return Err(Obstruction::Bounds);
        }
        self.work.difference.clear();
        self.work.difference.resize(q.len(), 0.0);
        self.check(q, 1).map(|()| 0.0).map_err(|blocked| blocked.by)
    }

    fn travel(&self, difference: &[f64]) -> f64 {
        difference.iter().map(|d| d * d).sum::<f64>().sqrt()
    }

    fn resolution(&self) -> f64 {
        LONGEST
    }

    fn edge(&mut self, from: &[f64], to: &[f64]) -> Result<(), Blocked> {
        if !self.space.contains(to) {
            return Err(Blocked { fraction: 1.0, by: Obstruction::Bounds });
        }
        let mut difference = std::mem::take(&mut self.work.difference);
        self.space.difference_into(from, to, &mut difference);
        self.work.difference = difference;
        let length = self.space.distance(from, to);
        let trust = match self.patience {
            Patience::Thorough | Patience::Hasty => None,
            Patience::Hopeful => Some(Trust::Certain),
            Patience::Wary => Some(Trust::Wary),
        };
        if let Some(trust) = trust {
            let blocks = (length / (LOOK * MOST_LANES as f64)).ceil().max(1.0);
            return self.look(from, blocks as usize * MOST_LANES, trust);
        }
        let blocks = (length / (LONGEST * STRETCHES as f64)).ceil().max(1.0);
        self.check(from, blocks as usize * STRETCHES)
    }

    fn set_patience(&mut self, patience: Patience) {
        self.patience = patience;
    }

    fn describe(&self, obstruction: Obstruction) -> String {
        match obstruction {
            Obstruction::Bounds => "a joint limit is exceeded".into(),
            Obstruction::Constraint => "the path constraint is violated".into(),
            Obstruction::Contact(n) => {
                self.scene.describe(obstruction).unwrap_or_else(|| format!("contact {n}"))
            }
        }
    }
}
