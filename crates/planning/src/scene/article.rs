//! Doors and drawers that move while the robot does.

use robotc_core::geom::Otherwise;
use robotc_core::ids::Idx;
use robotc_core::task::Article;
use robotc_core::{BodyIdx, Configuration, Kinematics, LinkIdx, LinkPoses, Pose};

use super::between::{Keeps, between};
use super::{RobotChecker, Scene};
use crate::space::{Axis, Space};
use crate::travel::TravelBounds;

/// What an article moves, for checkers of the robot and of the article's joint at once.
#[derive(Debug, Clone)]
pub struct MovingArticle<'a> {
    article: &'a Article,
    kinematics: Kinematics,
    configuration: Configuration,
    /// Bodies that move, each with its link and with the metres that any point of it travels for each unit of the joint, at most.
    pub(super) moving: Vec<(BodyIdx, LinkIdx, f64)>,
    /// Bodies of links that stand still.
    pub(super) still: Vec<BodyIdx>,
    /// The most of these metres.
    pub(super) travel: f64,
    poses: LinkPoses,
}

impl<'a> MovingArticle<'a> {
    /// The obstacles of the article's task are the bodies of `scene` from `first_obstacle` on.
    pub fn new(scene: &Scene, article: &'a Article, first_obstacle: usize) -> Self {
        let body = |obstacle: usize| BodyIdx::new(first_obstacle + obstacle);
        let kinematics = Kinematics::new(article.model.clone());
        let mut bounds = TravelBounds::new(&[article.dof]);
        let mut moves = |(link, obstacle): (LinkIdx, usize)| {
            let radius = scene.bodies[body(obstacle)].shape.radius_about_origin();
            (body(obstacle), link, bounds.add(&kinematics, link, radius)[0])
        };
        let moving: Vec<_> = article.moving_bodies().map(&mut moves).collect();
        let travel = moving.iter().map(|(_, _, travel)| *travel).fold(0.0, f64::max);
        let all = article.bodies.iter().map(|&(_, obstacle)| body(obstacle));
        let still = all.filter(|body| moving.iter().all(|(moves, _, _)| moves != body)).collect();
        let configuration = article.configuration.clone();
        Self { article, kinematics, configuration, moving, still, travel, poses: LinkPoses::default() }
    }

    /// The space of some joints and then the article's value, which counts as much as what it moves travels, metres.
    pub fn space(&self, joints: &Space) -> Space {
        let dof = &self.article.model.dofs()[self.article.dof];
        // Values of limits may be exceeded by rounding.
        let value = Axis {
            lower: dof.lower - 1e-9,
            upper: dof.upper + 1e-9,
            wraps: false,
            weight: self.travel.max(f64::MIN_POSITIVE),
        };
        Space::new(joints.axes().iter().copied().chain([value]).collect())
    }

    /// Where the bodies that move are in the world when the joint has this value, in their order.
    pub(super) fn at(&mut self, value: f64) -> impl Iterator<Item = (BodyIdx, Pose)> + use<'_, 'a> {
        self.configuration[self.article.dof] = value;
        self.kinematics.link_poses(&self.configuration, &mut self.poses);
        let Self { article, moving, poses, .. } = self;
        let place = |&(body, link, _): &(BodyIdx, LinkIdx, f64)| {
            (body, article.world_from_root * poses.root_from(link))
        };
        moving.iter().map(place)
    }

    /// Whether a body belongs to the article.
    pub(super) fn has(&self, body: BodyIdx) -> bool {
        self.still.contains(&body) || self.moving.iter().any(|(moves, _, _)| *moves == body)
    }

    /// Whether the article, with its joint at `value`, keeps off the links of the robot at `q` that `dofs` do not move.
    pub fn stands_clear(
        &mut self,
        scene: &Scene,
        q: &Configuration,
        dofs: &[robotc_core::DofIdx],
        value: f64,
    ) -> bool {
        let still: Vec<_> = self.still.iter().map(|&body| (body, *scene.world_from_body(body))).collect();
        let all: Vec<_> = self.at(value).chain(still).collect();
        let mut poses = LinkPoses::default();
        scene.kinematics.link_poses(q, &mut poses);
        let rows = scene.rows.of(scene, dofs);
        let standing = rows.links.enumerate().filter(|(_, row)| row.iter().all(|r| *r == 0.0));
        let clear = |link: LinkIdx| {
            let world_from_link = scene.world_from_robot * poses.root_from(link);
            all.iter().all(|(body, world_from_body)| {
                let (one, other) = (&scene.links[link], &scene.bodies[*body].shape);
                let body_from_link = world_from_body.inv_mul(&world_from_link);
                let keeps = Keeps::Margin(0.0);
                between(one, other, &body_from_link, keeps, 0.0, Otherwise::Anything, &mut None).is_some()
            })
        };
        standing.filter(|(link, _)| !scene.links[*link].is_empty()).all(|(link, _)| clear(link))
    }
}

impl<'a> RobotChecker<'a> {
    /// Motions of `dofs` and of the joint of an article at once: states are the joints and then the article's value, coordinates of
    /// [`MovingArticle::space`]. Otherwise as [`new`](Self::new).
    ///
    /// What the article moves keeps the margin from everything but the article itself, and the robot keeps it from both; what moves may come
    /// as near as it likes to links that stand still, without touching them.
    pub fn with_article(
        scene: &'a Scene,
        space: &'a Space,
        (dofs, article): (&'a [robotc_core::DofIdx], MovingArticle<'a>),
        q: &Configuration,
        rules: super::Rules,
        resolution: f64,
    ) -> Self {
        Self::of(scene, space, (dofs, Some(article)), q, rules, resolution)
    }
}
