//! Pairs of things that have to stay apart, each with its own pace.
//!
//! Most pairs are far from each other and close slowly; what is known of one of them at one state lasts for most of a motion.
//! So each pair is looked at as often as it needs, and no more (Schwarzer, Saha and Latombe, "Exact collision checking of
//! robot paths", 2002).

use robotc_core::geom::{contact, separation, within};
use robotc_core::ids::Idx;
use robotc_core::{BodyIdx, DofIdx, LinkIdx, LinkPoses, Pose, TypedVec};

use super::shape::Shape;
use super::{FARTHER, Grip, Rules, Scene, Touch};
use crate::travel::TravelBounds;

/// What has to stay apart in motions of some degrees of freedom.
#[derive(Debug, Clone)]
pub(super) struct Pairs {
    /// By row.
    list: Vec<Pair>,
    /// For each thing that moves, or moves against another, metres for each unit of each degree of freedom; flat.
    rows: Vec<f64>,
    /// The same by degree of freedom.
    columns: Vec<f64>,
    dofs: usize,
    body_from_robot: TypedVec<BodyIdx, Pose>,
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
}

#[derive(Debug, Clone, Copy)]
enum Other {
    Body(BodyIdx),
    Link(LinkIdx),
}

/// How far apart two things have to be.
#[derive(Debug, Clone, Copy)]
enum Keeps {
    /// Farther than this, metres.
    Margin(f64),
    /// They may be this deep in each other, metres.
    Depth(f64),
}

/// Distances of parts are found to within this fraction: they are only used to tell how long they last.
const RELATIVE: f64 = 0.1;

impl Pairs {
    /// Under `rules`, with the bodies where they are in the scene; and bounds on how far everything travels.
    pub(super) fn new(scene: &Scene, dofs: &[DofIdx], rules: &Rules) -> (Self, TravelBounds) {
        let known = scene.rows.of(scene, dofs);
        let mut bounds = known.bounds.clone();
        // Links and what is held against bodies, and links against links and what is held.
        let most_rows = 2 * known.links.len() + 1 + known.pairs.len();
        let mut pairs = Self {
            list: Vec::with_capacity((known.links.len() + 1) * (scene.bodies.len() + 1) + known.pairs.len()),
            rows: Vec::with_capacity(most_rows * dofs.len()),
            columns: Vec::new(),
            dofs: dofs.len(),
            body_from_robot: scene
                .bodies
                .iter()
                .map(|b| b.body_from_world * scene.world_from_robot)
                .collect(),
        };
        let bodies = || scene.bodies.enumerate().filter(|(_, body)| !body.shape.is_empty()).map(|(b, _)| b);
        let moving = known.links.enumerate().filter(|(_, row)| row.iter().any(|r| *r > 0.0));
        for (link, row) in moving {
            let of_gripper = rules.gripper.binary_search(&link).is_ok();
            let keeps = |body: BodyIdx| {
                if rules.held.as_ref().is_some_and(|grip| grip.body == body) {
                    return None;
                }
                match of_gripper && rules.target == Some(body) {
                    true => rules.give.map(Keeps::Depth),
                    false => Some(Keeps::Margin(rules.margin)),
                }
            };
            let others = bodies().filter_map(|body| Some((Other::Body(body), keeps(body)?)));
            pairs.add(Mover::Link(link), row, others);
        }
        let of_held = rules
            .held
            .as_ref()
            .map(|grip| (grip.body, known.of_held(scene, grip, &rules.gripper, &mut bounds)));
        if let Some((body, (row, _))) = &of_held {
            let keeps = rules.sink.map_or(Keeps::Margin(rules.margin), Keeps::Depth);
            let others = bodies().filter(|other| other != body).map(|other| (Other::Body(other), keeps));
            pairs.add(Mover::Held, row, others);
        }
        for (a, b, row) in &known.pairs {
            pairs.add(Mover::Link(*a), row, [(Other::Link(*b), Keeps::Margin(0.0))]);
        }
        for (link, row) in of_held.iter().flat_map(|(_, (_, beside))| beside) {
            pairs.add(Mover::Held, row, [(Other::Link(*link), Keeps::Margin(0.0))]);
        }
        let column = |dof: usize| pairs.rows.iter().skip(dof).step_by(dofs.len()).copied();
        pairs.columns = Vec::with_capacity(pairs.rows.len());
        (0..dofs.len()).for_each(|dof| pairs.columns.extend(column(dof)));
        (pairs, bounds)
    }

    fn add(&mut self, one: Mover, row: &[f64], others: impl IntoIterator<Item = (Other, Keeps)>) {
        let number = (self.rows.len() / self.dofs.max(1)) as u32;
        self.rows.extend_from_slice(row);
        self.list.extend(others.into_iter().map(|(other, keeps)| Pair { one, other, row: number, keeps }));
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
        self.rows.chunks_exact(self.dofs.max(1)).map(|row| bounds.pace(row)).collect()
    }

    /// The row of a pair.
    pub(super) fn row(&self, pair: usize) -> usize {
        self.list[pair].row as usize
    }

    /// For each row, how far the motion by `difference` brings things together at most, metres.
    pub(super) fn travels(&self, difference: &[f64], travels: &mut Vec<f64>) {
        let rows = self.columns.len() / self.dofs.max(1);
        travels.clear();
        travels.resize(rows, 0.0);
        for (column, d) in self.columns.chunks_exact(rows.max(1)).zip(difference) {
            travels.iter_mut().zip(column).for_each(|(travel, each)| *travel += each * d.abs());
        }
    }

    /// How much nearer the two of a pair may come to each other from where they are: at least this. More than `far` is not
    /// looked for. An error when they are too near already.
    pub(super) fn room(
        &self,
        scene: &Scene,
        rules: &Rules,
        poses: &LinkPoses,
        pair: usize,
        far: f64,
    ) -> Result<f64, Touch> {
        let Pair { one, other, keeps, .. } = self.list[pair];
        let (shape, robot_from_one) = match one {
            Mover::Link(link) => (&scene.links[link], *poses.root_from(link)),
            Mover::Held => {
                let grip = held(rules);
                (&*scene.bodies[grip.body].shape, poses.root_from(grip.link) * grip.link_from_body)
            }
        };
        let (against, other_from_one) = match other {
            Other::Body(body) => (&*scene.bodies[body].shape, self.body_from_robot[body] * robot_from_one),
            Other::Link(link) => (&scene.links[link], poses.root_from(link).inv_mul(&robot_from_one)),
        };
        between(shape, against, &other_from_one, keeps, far).ok_or_else(|| self.touch(scene, rules, pair))
    }

    /// The two of a pair: links count first, then bodies.
    fn touch(&self, scene: &Scene, rules: &Rules, pair: usize) -> Touch {
        let body = |body: BodyIdx| (scene.links.len() + body.index()) as u16;
        let Pair { one, other, .. } = self.list[pair];
        let one = match one {
            Mover::Link(link) => link.index() as u16,
            Mover::Held => body(held(rules).body),
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

/// How much nearer two shapes may come to each other, at least; `None` when they are too near already.
fn between(one: &Shape, other: &Shape, other_from_one: &Pose, keeps: Keeps, far: f64) -> Option<f64> {
    let least = match keeps {
        Keeps::Margin(margin) => margin,
        Keeps::Depth(depth) => -depth,
    };
    let bound = other.bounds.distance_to(&(other_from_one * one.centre)) - one.radius - least;
    // A box and a ball that overlap say nothing.
    if bound > far.max(0.0) && bound + least > 0.0 {
        return Some(bound);
    }
    let mut room = f64::INFINITY;
    let one_from_other = other_from_one.inverse();
    for part in one.cover() {
        let centre = other_from_one * part.centre;
        for against in &other.parts {
            let bound = against.bounds.distance_to(&centre) - part.radius;
            if bound > 0.0 && bound - least > far.max(0.0) {
                room = room.min(bound - least);
                continue;
            }
            if bound - least > room {
                continue;
            }
            let apart = separation(&against.part, &part.part, other_from_one, RELATIVE);
            let nearer = match (apart.map(|s| s.gap), keeps) {
                (Some(gap), Keeps::Margin(margin)) if gap <= margin => {
                    if within(&part.part, other_from_one, &against.part, &Pose::identity(), margin) {
                        return None;
                    }
                    0.0
                }
                (Some(gap), _) => gap - least,
                (None, Keeps::Margin(_)) => return None,
                (None, Keeps::Depth(depth)) => {
                    let found = contact(&part.part, other_from_one, &against.part, &Pose::identity(), 0.0);
                    let deep = found.map_or(0.0, |c| c.depth);
                    if deep > depth {
                        return None;
                    }
                    depth - deep
                }
            };
            room = room.min(nearer);
        }
        for against in &other.piles {
            let bound = against.bounds.distance_to(&centre) - part.radius;
            if bound > 0.0 && bound - least > far.max(0.0) {
                room = room.min(bound - least);
                continue;
            }
            // Nothing that is farther away matters, and a gap of nothing is one.
            let limit = room.min(far.max(0.0)) + least.max(0.0) + FARTHER;
            let seen = against.seen_by(&one_from_other);
            let gap = against.pile.gap(&part.part, &seen, limit);
            let nearer = match keeps {
                Keeps::Margin(margin) if gap <= margin => {
                    if against.pile.is_within(&part.part, &seen, margin) {
                        return None;
                    }
                    0.0
                }
                Keeps::Margin(margin) => gap - margin,
                Keeps::Depth(depth) => {
                    let deep = against.pile.depth(&part.part, &seen);
                    if gap == 0.0 && deep > depth {
                        return None;
                    }
                    gap.max(depth - deep)
                }
            };
            room = room.min(nearer);
        }
    }
    Some(room)
}
