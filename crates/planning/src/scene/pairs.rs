//! Pairs of things that have to stay apart, each with its own pace.
//!
//! Most pairs are far from each other and close slowly; what is known of one of them at one state lasts for most of a motion.
//! So each pair is looked at as often as it needs, and no more (Schwarzer, Saha and Latombe, "Exact collision checking of
//! robot paths", 2002).

use nalgebra::Point3;
use robotc_core::geom::Otherwise;
use robotc_core::ids::Idx;
use robotc_core::{BodyIdx, DofIdx, LinkIdx, LinkPoses, Pose, TypedVec};

use super::between::{Hint, Keeps, between};
use super::{Grip, MovingArticle, Rules, Scene, Touch};
use crate::travel::TravelBounds;

/// What has to stay apart in motions of some degrees of freedom.
#[derive(Debug, Clone)]
pub(super) struct Pairs {
    /// By row.
    list: Vec<Pair>,
    /// For each thing that moves, or moves against another, metres for each unit of each coordinate; flat.
    rows: Vec<f64>,
    /// The same by coordinate.
    columns: Vec<f64>,
    /// Coordinates of a state: degrees of freedom of the robot, and the joint of an article if one moves as well.
    width: usize,
    body_from_robot: TypedVec<BodyIdx, Pose>,
    /// For each pair.
    hints: Vec<Hint>,
    /// Middles of the links and then of what is held, in the robot's frame.
    middles: Vec<Point3<f64>>,
}

#[derive(Debug, Clone, Copy)]
struct Pair {
    one: Mover,
    other: Other,
    row: u32,
    keeps: Keeps,
}

#[derive(Debug, Clone, Copy)]
enum Mover {
    Link(LinkIdx),
    Held,
    /// Of an article.
    Body(BodyIdx),
}

#[derive(Debug, Clone, Copy)]
enum Other {
    Body(BodyIdx),
    Link(LinkIdx),
}

impl Pairs {
    /// Under `rules`, with the bodies where they are in the scene; and bounds on how far everything travels.
    pub(super) fn new(
        scene: &Scene,
        dofs: &[DofIdx],
        article: Option<&MovingArticle<'_>>,
        rules: &Rules,
    ) -> (Self, TravelBounds) {
        let known = scene.rows.of(scene, dofs);
        let mut bounds = known.bounds.clone();
        let width = dofs.len() + usize::from(article.is_some());
        // Links and what is held against bodies, and links against links and what is held.
        let most_rows = 2 * known.links.len() + 1 + known.pairs.len();
        let mut pairs = Self {
            list: Vec::with_capacity((known.links.len() + 1) * (scene.bodies.len() + 1) + known.pairs.len()),
            rows: Vec::with_capacity(most_rows * width),
            columns: Vec::new(),
            width,
            body_from_robot: scene
                .bodies
                .iter()
                .map(|b| b.body_from_world * scene.world_from_robot)
                .collect(),
            hints: Vec::new(),
            middles: vec![Point3::origin(); scene.links.len() + 1],
        };
        let moving = article.map_or(&[][..], |article| &article.moving);
        let stands = |body: &BodyIdx| moving.iter().all(|(moves, _, _)| moves != body);
        let solid = scene.bodies.enumerate().filter(|(_, body)| !body.shape.is_empty()).map(|(b, _)| b);
        let standing: Vec<BodyIdx> = solid.filter(stands).collect();
        // One thing that moves against everything that stands, and then against each body that moves.
        let against_bodies =
            |pairs: &mut Self, one, row: &[f64], keeps: &dyn Fn(BodyIdx) -> Option<Keeps>| {
                let pair = |body| Some((Other::Body(body), keeps(body)?));
                if row.iter().any(|r| *r > 0.0) {
                    pairs.add(one, row, 0.0, standing.iter().filter_map(|&body| pair(body)));
                }
                moving.iter().for_each(|&(body, _, travel)| pairs.add(one, row, travel, pair(body)));
            };
        for (link, row) in known.links.enumerate().filter(|(link, _)| !scene.links[*link].is_empty()) {
            let of_gripper = rules.gripper.binary_search(&link).is_ok();
            let stands = row.iter().all(|r| *r == 0.0);
            let keeps = |body: BodyIdx| {
                if rules.held.as_ref().is_some_and(|grip| grip.body == body) {
                    return None;
                }
                match of_gripper && rules.target == Some(body) {
                    true => rules.give.map(Keeps::Depth),
                    false => Some(Keeps::Margin(if stands { 0.0 } else { rules.margin })),
                }
            };
            against_bodies(&mut pairs, Mover::Link(link), row, &keeps);
        }
        let of_held = rules
            .held
            .as_ref()
            .map(|grip| (grip.body, known.of_held(scene, grip, &rules.gripper, &mut bounds)));
        if let Some((held, (row, _))) = &of_held {
            let keeps = rules.sink.map_or(Keeps::Margin(rules.margin), Keeps::Depth);
            against_bodies(&mut pairs, Mover::Held, row, &|body| (body != *held).then_some(keeps));
        }
        for &(one, _, travel) in moving {
            let beside = |body: &BodyIdx| {
                article.is_some_and(|article| article.has(*body))
                    || of_held.as_ref().is_some_and(|(held, _)| held == body)
            };
            let others = standing.iter().filter(|body| !beside(body));
            let others = others.map(|&body| (Other::Body(body), Keeps::Margin(rules.margin)));
            pairs.add(Mover::Body(one), &vec![0.0; dofs.len()], travel, others);
        }
        for (a, b, row) in &known.pairs {
            pairs.add(Mover::Link(*a), row, 0.0, [(Other::Link(*b), Keeps::Margin(0.0))]);
        }
        for (link, row) in of_held.iter().flat_map(|(_, (_, beside))| beside) {
            pairs.add(Mover::Held, row, 0.0, [(Other::Link(*link), Keeps::Margin(0.0))]);
        }
        if let Some(article) = article {
            bounds.add_coordinate(article.travel);
        }
        pairs.hints = vec![None; pairs.list.len()];
        let column = |coordinate: usize| pairs.rows.iter().skip(coordinate).step_by(width).copied();
        pairs.columns = Vec::with_capacity(pairs.rows.len());
        (0..width).for_each(|coordinate| pairs.columns.extend(column(coordinate)));
        (pairs, bounds)
    }

    /// Pairs of one thing, which the degrees of freedom move by `row`, with others, which an article moves by `travel`.
    fn add(
        &mut self,
        one: Mover,
        row: &[f64],
        travel: f64,
        others: impl IntoIterator<Item = (Other, Keeps)>,
    ) {
        let number = (self.rows.len() / self.width.max(1)) as u32;
        self.rows.extend_from_slice(row);
        self.rows.extend((row.len() < self.width).then_some(travel));
        self.list.extend(others.into_iter().map(|(other, keeps)| Pair { one, other, row: number, keeps }));
    }

    /// Puts a body somewhere else.
    pub(super) fn place(&mut self, body: BodyIdx, robot_from_body: &Pose) {
        self.body_from_robot[body] = robot_from_body.inverse();
    }

    /// Takes note of where the links of the robot are.
    pub(super) fn arrange(&mut self, scene: &Scene, rules: &Rules, poses: &LinkPoses) {
        for (link, shape) in scene.links.enumerate() {
            self.middles[link.index()] = poses.root_from(link) * shape.centre;
        }
        if let Some(grip) = &rules.held {
            let centre = grip.link_from_body * scene.bodies[grip.body].shape.centre;
            self.middles[scene.links.len()] = poses.root_from(grip.link) * centre;
        }
    }

    /// No more than the distance of the two of a pair, at little cost: that of balls around them, or of a ball and a box.
    fn bound(&self, scene: &Scene, rules: &Rules, one: Mover, other: Other) -> f64 {
        let (middle, radius) = match one {
            Mover::Link(link) => (&self.middles[link.index()], scene.links[link].radius),
            Mover::Held => (&self.middles[scene.links.len()], scene.bodies[held(rules).body].shape.radius),
            Mover::Body(_) => return 0.0,
        };
        match other {
            Other::Body(body) => {
                let bounds = &scene.bodies[body].shape.bounds;
                bounds.distance_to(&(self.body_from_robot[body] * middle)) - radius
            }
            Other::Link(link) => {
                (middle - self.middles[link.index()]).norm() - radius - scene.links[link].radius
            }
        }
    }

    /// Forgets pairs of links, and of links and what is held.
    pub(super) fn without_self(&mut self) {
        self.list.retain(|pair| matches!(pair.other, Other::Body(_)));
    }

    pub(super) fn len(&self) -> usize {
        self.list.len()
    }

    /// For each row, how fast it is against the fastest: see [`TravelBounds::pace`].
    pub(super) fn paces(&self, bounds: &TravelBounds) -> Vec<f64> {
        self.rows.chunks_exact(self.width.max(1)).map(|row| bounds.pace(row)).collect()
    }

    /// The row of a pair.
    pub(super) fn row(&self, pair: usize) -> usize {
        self.list[pair].row as usize
    }

    /// For each row, how far the motion by `difference` brings things together at most, metres.
    pub(super) fn travels(&self, difference: &[f64], travels: &mut Vec<f64>) {
        let rows = self.columns.len() / self.width.max(1);
        travels.clear();
        travels.resize(rows, 0.0);
        for (column, d) in self.columns.chunks_exact(rows.max(1)).zip(difference) {
            travels.iter_mut().zip(column).for_each(|(travel, each)| *travel += each * d.abs());
        }
    }

    /// How much nearer the two of a pair may come to each other from where they are: at least this. More than `far` is not
    /// looked for. An error when they are too near already.
    pub(super) fn room(
        &mut self,
        scene: &Scene,
        rules: &Rules,
        poses: &LinkPoses,
        pair: usize,
        far: f64,
        otherwise: Otherwise,
    ) -> Result<f64, Touch> {
        let Pair { one, other, keeps, .. } = self.list[pair];
        let bound = self.bound(scene, rules, one, other);
        if bound > 0.0 && bound - keeps.least() > far.max(0.0) {
            return Ok(bound - keeps.least());
        }
        let (shape, robot_from_one) = match one {
            Mover::Link(link) => (&scene.links[link], *poses.root_from(link)),
            Mover::Held => {
                let grip = held(rules);
                (&*scene.bodies[grip.body].shape, poses.root_from(grip.link) * grip.link_from_body)
            }
            Mover::Body(body) => (&*scene.bodies[body].shape, self.body_from_robot[body].inverse()),
        };
        let (against, other_from_one) = match other {
            Other::Body(body) => (&*scene.bodies[body].shape, self.body_from_robot[body] * robot_from_one),
            Other::Link(link) => (&scene.links[link], poses.root_from(link).inv_mul(&robot_from_one)),
        };
        between(shape, against, &other_from_one, keeps, far, otherwise, &mut self.hints[pair])
            .ok_or_else(|| self.touch(scene, rules, pair))
    }

    /// The two of a pair: links count first, then bodies.
    fn touch(&self, scene: &Scene, rules: &Rules, pair: usize) -> Touch {
        let body = |body: BodyIdx| (scene.links.len() + body.index()) as u16;
        let Pair { one, other, .. } = self.list[pair];
        let one = match one {
            Mover::Link(link) => link.index() as u16,
            Mover::Held => body(held(rules).body),
            Mover::Body(one) => body(one),
        };
        match other {
            Other::Body(other) => Touch(one, body(other)),
            // As in a state: the link first.
            Other::Link(link) if usize::from(one) >= scene.links.len() => Touch(link.index() as u16, one),
            Other::Link(link) => Touch(one, link.index() as u16),
        }
    }
}

fn held(rules: &Rules) -> &Grip {
    rules.held.as_ref().expect("pairs of a held body are made for rules that name one")
}
