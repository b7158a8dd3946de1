//! The edge checker of a robot beside a door or a drawer that moves with it.

use robotc_core::ids::Idx;
use robotc_core::task::Article;
use robotc_core::{BodyIdx, Configuration, DofIdx, Kinematics, LinkIdx, LinkPoses};

use super::checker::movers;
use super::{Movers, Rules, Scene};
use crate::edge::{EdgeChecker, Obstruction};
use crate::space::{Axis, Space};
use crate::travel::TravelBounds;

/// Motions of some degrees of freedom of a robot, and of the joint of an article, at once. States are the joints and then the
/// article's value.
///
/// What the article moves keeps the margin from everything but the article itself; the robot keeps it from both.
pub struct ArticleChecker<'a> {
    /// With the article where it was looked at last.
    scene: Scene,
    space: Space,
    dofs: &'a [DofIdx],
    part: Part<'a>,
    movers: Movers,
    /// Links of the robot that stand still: only the article can come to them.
    standing: Vec<LinkIdx>,
    bounds: TravelBounds,
    resolution: f64,
    rules: Rules,
    /// Clearance beyond this is not looked for, metres.
    room: f64,
    q: Configuration,
    poses: LinkPoses,
    states: u64,
}

/// What an article moves.
struct Part<'a> {
    article: &'a Article,
    kinematics: Kinematics,
    configuration: Configuration,
    /// Links that move, with their bodies.
    moving: Vec<(LinkIdx, BodyIdx)>,
    /// Bodies of links that stand still.
    still: Vec<BodyIdx>,
    /// Metres that any point of it travels for each unit of its joint, at most.
    travel: f64,
    /// Its clearance where it is, or what it touches; `None` before it was placed.
    clearance: Option<Result<f64, Obstruction>>,
    poses: LinkPoses,
}

impl<'a> ArticleChecker<'a> {
    /// The joints of `joints` are `dofs`, the others stay as in `q`. The obstacles of the article's task are the bodies from
    /// `first_obstacle` on. Bodies travel no more than `resolution` metres between two checked states.
    ///
    /// In the metric the article's joint counts as much as what it moves travels, metres.
    pub fn new(
        scene: &Scene,
        joints: &Space,
        dofs: &'a [DofIdx],
        (article, first_obstacle): (&'a Article, usize),
        q: &Configuration,
        rules: Rules,
        resolution: f64,
    ) -> Self {
        let (bounds, of_joints) = movers(scene, dofs, &rules);
        // The pace of a link is against that of the joints alone; the article moves as well.
        let links = of_joints.links.iter().map(|&(link, _)| (link, 1.0)).collect();
        let moves = |link: LinkIdx| of_joints.links.iter().any(|(moving, _)| *moving == link);
        let standing = scene.links.enumerate().filter(|(link, shape)| !shape.is_empty() && !moves(*link));
        let standing = standing.map(|(link, _)| link).collect();
        let part = Part::new(scene, article, first_obstacle);
        let dof = &article.model.dofs()[article.dof];
        // Values of limits may be exceeded by rounding.
        let value = Axis {
            lower: dof.lower - 1e-9,
            upper: dof.upper + 1e-9,
            wraps: false,
            weight: part.travel.max(f64::MIN_POSITIVE),
        };
        let axes = joints.axes().iter().copied().chain([value]).collect();
        Self {
            scene: scene.clone(),
            space: Space::new(axes),
            dofs,
            part,
            movers: Movers { links, held: 1.0, ..of_joints },
            standing,
            bounds,
            resolution,
            rules,
            room: super::checker::ROOM * resolution,
            q: q.clone(),
            poses: LinkPoses::default(),
            states: 0,
        }
    }

    /// The same checker that looks at every state and reports no clearance.
    pub fn without_clearance(mut self) -> Self {
        self.room = 0.0;
        self
    }

    /// The robot and the bodies around it, with the article where it was looked at last.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Whether the article, where it is in a state, keeps off the links of the robot that stand still.
    pub fn stands_clear(&mut self, q: &[f64]) -> bool {
        let Some((&value, joints)) = q.split_last() else { return false };
        self.q.set(self.dofs, joints);
        self.scene.kinematics.link_poses(&self.q, &mut self.poses);
        let moving = self.part.moving.iter().map(|&(_, body)| body);
        let all: Vec<BodyIdx> = moving.chain(self.part.still.iter().copied()).collect();
        self.part.place(&mut self.scene, value, self.rules.margin, 0.0).is_ok()
            && self.scene.links_beside(&self.standing, &self.poses, all.into_iter(), 0.0).is_ok()
    }

    /// Number of states looked at so far.
    pub fn states(&self) -> u64 {
        self.states
    }
}

impl<'a> Part<'a> {
    fn new(scene: &Scene, article: &'a Article, first_obstacle: usize) -> Self {
        let body = |obstacle: usize| BodyIdx::new(first_obstacle + obstacle);
        let kinematics = Kinematics::new(article.model.clone());
        let moving: Vec<(LinkIdx, BodyIdx)> =
            article.moving_bodies().map(|(link, obstacle)| (link, body(obstacle))).collect();
        let mut bounds = TravelBounds::new(&[article.dof]);
        let reach = |&(link, body): &(LinkIdx, BodyIdx)| {
            bounds.add(&kinematics, link, scene.bodies[body].shape.radius_about_origin())[0]
        };
        let travel = moving.iter().map(reach).fold(0.0, f64::max);
        let all = article.bodies.iter().map(|&(_, obstacle)| body(obstacle));
        let still = all.filter(|body| moving.iter().all(|(_, moves)| moves != body)).collect();
        let configuration = article.configuration.clone();
        let poses = LinkPoses::default();
        Self { article, kinematics, configuration, moving, still, travel, clearance: None, poses }
    }

    /// Puts the article at `value`, unless it is there; its clearance.
    fn place(&mut self, scene: &mut Scene, value: f64, margin: f64, room: f64) -> Result<f64, Obstruction> {
        let there = self.configuration[self.article.dof] == value;
        if let (Some(clearance), true) = (self.clearance, there) {
            return clearance;
        }
        self.configuration[self.article.dof] = value;
        self.kinematics.link_poses(&self.configuration, &mut self.poses);
        for &(link, body) in &self.moving {
            scene.place(body, self.article.world_from_root * self.poses.root_from(link));
        }
        let beside = |other| self.still.contains(&other) || self.moving.iter().any(|(_, b)| *b == other);
        let of_body = |room: f64, &(_, body): &(LinkIdx, BodyIdx)| {
            scene.body_clear(body, beside, margin, room).map_err(Obstruction::from)
        };
        let clearance = self.moving.iter().try_fold(room, of_body);
        self.clearance = Some(clearance);
        clearance
    }
}

impl EdgeChecker for ArticleChecker<'_> {
    fn space(&self) -> &Space {
        &self.space
    }

    fn state(&mut self, q: &[f64]) -> Result<f64, Obstruction> {
        self.states += 1;
        if !self.space.contains(q) {
            return Err(Obstruction::Bounds);
        }
        let (&value, joints) = q.split_last().expect("the article's value comes last");
        let room = self.part.place(&mut self.scene, value, self.rules.margin, self.room)?;
        self.q.set(self.dofs, joints);
        self.scene.kinematics.link_poses(&self.q, &mut self.poses);
        let robot = &self.scene.world_from_robot;
        let moving = self.part.moving.iter().map(|&(_, body)| body);
        let room = self.scene.links_beside(&self.standing, &self.poses, moving, room)?;
        let room = self.scene.against_bodies(robot, &self.poses, &self.movers, &self.rules, room)?;
        Ok(self.scene.against_self(&self.poses, &self.movers, &self.rules, room)?)
    }

    fn travel(&self, difference: &[f64]) -> f64 {
        let (value, joints) = difference.split_last().expect("the article's value comes last");
        self.bounds.travel(joints) + self.part.travel * value.abs()
    }

    fn resolution(&self) -> f64 {
        self.resolution
    }

    fn describe(&self, obstruction: Obstruction) -> String {
        self.scene.explain(obstruction, "a limit of a joint")
    }
}
