//! The edge checker of a robot in a scene.

use robotc_core::geom::Otherwise;
use robotc_core::{Configuration, DofIdx, LinkPoses};

use super::pairs::Pairs;
use super::{Movers, MovingArticle, Rules, Scene};
use crate::constraint::Constraint;
use crate::edge::{Blocked, EdgeChecker, Obstruction};
use crate::space::Space;
use crate::travel::TravelBounds;

/// Checks motions of some degrees of freedom of a robot; the others stay as they are.
pub struct RobotChecker<'a> {
    pub(super) scene: &'a Scene,
    pub(super) space: &'a Space,
    dofs: &'a [DofIdx],
    pub(super) pairs: Pairs,
    bounds: TravelBounds,
    pub(super) resolution: f64,
    pub(super) rules: Rules,
    constraint: Option<&'a dyn Constraint>,
    article: Option<MovingArticle<'a>>,
    /// Clearance beyond this is not looked for.
    room: f64,
    /// For each row of the pairs, its pace; found when a clearance is asked for.
    paces: Option<Vec<f64>>,
    q: Configuration,
    pub(super) poses: LinkPoses,
    states: u64,
    work: Work,
}

/// Memory of edge checks.
#[derive(Debug, Default)]
struct Work {
    difference: Vec<f64>,
    travels: Vec<f64>,
    at: Vec<f64>,
    /// Pieces of an edge with the pairs that are open in them, as ranges of `open`.
    pieces: Vec<Piece>,
    open: Vec<u32>,
}

/// A piece of an edge: what is within `half` of `middle`, as fractions of the edge.
#[derive(Debug, Clone)]
struct Piece {
    middle: f64,
    half: f64,
    pairs: std::ops::Range<usize>,
}

/// Clearance beyond this many times the resolution is not looked for: looking would cost more than it saves.
pub(super) const ROOM: f64 = 10.0;

impl<'a> RobotChecker<'a> {
    /// Motions of `dofs`, the coordinates of `space`, from configuration `q` on; bodies travel no more than
    /// `resolution` metres between two checked states.
    pub fn new(
        scene: &'a Scene,
        space: &'a Space,
        dofs: &'a [DofIdx],
        q: &Configuration,
        rules: Rules,
        resolution: f64,
    ) -> Self {
        Self::of(scene, space, (dofs, None), q, rules, resolution)
    }

    /// The same beside an article whose joint is the last coordinate, if there is one.
    pub(super) fn of(
        scene: &'a Scene,
        space: &'a Space,
        (dofs, article): (&'a [DofIdx], Option<MovingArticle<'a>>),
        q: &Configuration,
        rules: Rules,
        resolution: f64,
    ) -> Self {
        let (pairs, bounds) = Pairs::new(scene, dofs, article.as_ref(), &rules);
        Self {
            pairs,
            bounds,
            scene,
            space,
            dofs,
            resolution,
            rules,
            constraint: None,
            article,
            room: ROOM * resolution,
            paces: None,
            q: q.clone(),
            poses: LinkPoses::default(),
            states: 0,
            work: Work::default(),
        }
    }

    /// The same checker that also refuses states that violate `constraint`.
    pub fn with_constraint(mut self, constraint: Option<&'a dyn Constraint>) -> Self {
        // A constraint says nothing about the states around, so their clearance is not worth finding.
        if constraint.is_some() {
            self.room = 0.0;
        }
        self.constraint = constraint;
        self
    }

    /// The same checker that looks at every state and reports no clearance.
    pub fn without_clearance(mut self) -> Self {
        self.room = 0.0;
        self
    }

    /// The same checker that lets links go through each other, and through what is held.
    pub fn without_self_collisions(mut self) -> Self {
        self.pairs.without_self();
        self
    }

    /// The robot and the bodies around it.
    pub fn scene(&self) -> &'a Scene {
        self.scene
    }

    /// Number of states looked at so far, at least in part.
    pub fn states(&self) -> u64 {
        self.states
    }

    /// Puts the robot where it is a fraction of the way along an edge.
    fn place_along(&mut self, from: &[f64], fraction: f64, work: &mut Work) {
        work.at.clear();
        work.at.extend(from.iter().zip(&work.difference).map(|(a, d)| a + fraction * d));
        self.place(&work.at);
    }

    pub(super) fn place(&mut self, q: &[f64]) {
        self.states += 1;
        let joints = &q[..self.dofs.len()];
        if let (Some(article), Some(&value)) = (&mut self.article, q.get(joints.len())) {
            let robot_from_world = self.scene.world_from_robot.inverse();
            article.at(value).for_each(|(body, pose)| self.pairs.place(body, &(robot_from_world * pose)));
        }
        self.q.set(self.dofs, joints);
        self.scene.kinematics.link_poses(&self.q, &mut self.poses);
        self.pairs.arrange(self.scene, &self.rules, &self.poses);
    }

    /// Whether the states of an edge satisfy the constraint: its end, and as many in between as its size asks for.
    fn keeps_constraint(&self, from: &[f64], work: &mut Work) -> Result<(), Blocked> {
        let Some(constraint) = self.constraint else { return Ok(()) };
        let count = constraint.size(&work.difference).ceil().max(1.0);
        for i in (1..=count as usize).rev() {
            let fraction = i as f64 / count;
            work.at.clear();
            work.at.extend(from.iter().zip(&work.difference).map(|(a, d)| a + fraction * d));
            if !constraint.holds(&work.at) {
                return Err(Blocked { fraction, by: Obstruction::Constraint });
            }
        }
        Ok(())
    }

    /// Whether all pairs stay apart along an edge: each is looked at so often that between the looks it closes by no more than
    /// its room there and half of the resolution.
    fn keeps_apart(&mut self, from: &[f64], work: &mut Work) -> Result<(), Blocked> {
        self.pairs.travels(&work.difference, &mut work.travels);
        let slack = 0.5 * self.resolution;
        let farthest = ROOM * self.resolution;
        work.open.clear();
        work.open.extend(0..self.pairs.len() as u32);
        work.pieces.clear();
        // The end stands for the whole edge where it can.
        work.pieces.push(Piece { middle: 1.0, half: 1.0, pairs: 0..work.open.len() });
        let mut next = 0;
        while let Some(Piece { middle, half, pairs }) = work.pieces.get(next).cloned() {
            next += 1;
            self.place_along(from, middle, work);
            let left = work.open.len();
            for i in pairs {
                let pair = work.open[i];
                let needed = half * work.travels[self.pairs.row(pair as usize)] - slack;
                // Room that would not be enough is not worth finding.
                let far = if needed <= farthest { needed } else { 0.0 };
                let room = self.pairs.room(
                    self.scene,
                    &self.rules,
                    &self.poses,
                    pair as usize,
                    far,
                    Otherwise::Anything,
                );
                let room = room.map_err(|touch| Blocked { fraction: middle, by: touch.into() })?;
                if room < needed {
                    work.open.push(pair);
                }
            }
            let open = left..work.open.len();
            if open.is_empty() {
                continue;
            }
            if middle == 1.0 {
                work.pieces.push(Piece { middle: 0.5, half: 0.5, pairs: open });
            } else {
                let quarter = 0.5 * half;
                for middle in [middle - quarter, middle + quarter] {
                    work.pieces.push(Piece { middle, half: quarter, pairs: open.clone() });
                }
            }
        }
        Ok(())
    }
}

/// What `dofs` move, with bounds on its travel. Pairs that they do not move against each other are left out.
pub(super) fn movers(scene: &Scene, dofs: &[DofIdx], rules: &Rules) -> (TravelBounds, Movers) {
    let rows = scene.rows.of(scene, dofs);
    let mut bounds = rows.bounds.clone();
    let of_held = rules.held.as_ref().map(|grip| rows.of_held(scene, grip, &rules.gripper, &mut bounds));
    let moves = |row: &[f64]| row.iter().any(|r| *r > 0.0);
    let moving = rows.links.enumerate().filter(|(_, row)| moves(row));
    let movers = Movers {
        links: moving.map(|(link, row)| (link, bounds.pace(row))).collect(),
        pairs: rows.pairs.iter().map(|(a, b, row)| (*a, *b, bounds.pace(row))).collect(),
        held: of_held.as_ref().map_or(1.0, |(row, _)| bounds.pace(row)),
        beside_held: of_held.map_or_else(Vec::new, |(_, beside)| {
            beside.iter().map(|(link, row)| (*link, bounds.pace(row))).collect()
        }),
    };
    (bounds, movers)
}

impl EdgeChecker for RobotChecker<'_> {
    fn space(&self) -> &Space {
        self.space
    }

    fn state(&mut self, q: &[f64]) -> Result<f64, Obstruction> {
        if !self.space.contains(q) {
            return Err(Obstruction::Bounds);
        }
        if self.constraint.is_some_and(|c| !c.holds(q)) {
            return Err(Obstruction::Constraint);
        }
        self.place(q);
        if self.room == 0.0 {
            for pair in 0..self.pairs.len() {
                self.pairs.room(self.scene, &self.rules, &self.poses, pair, 0.0, Otherwise::Anything)?;
            }
            return Ok(0.0);
        }
        let paces = self.paces.get_or_insert_with(|| self.pairs.paces(&self.bounds));
        let mut clearance = self.room;
        for pair in 0..self.pairs.len() {
            let pace = paces[self.pairs.row(pair)];
            let room = self.pairs.room(
                self.scene,
                &self.rules,
                &self.poses,
                pair,
                clearance * pace,
                Otherwise::Roughly,
            )?;
            clearance = clearance.min(room / pace);
        }
        Ok(clearance)
    }

    fn is_free(&mut self, q: &[f64]) -> Result<(), Obstruction> {
        let room = std::mem::replace(&mut self.room, 0.0);
        let outcome = self.state(q);
        self.room = room;
        outcome.map(|_| ())
    }

    fn travel(&self, difference: &[f64]) -> f64 {
        let travel = self.bounds.travel(difference);
        self.constraint.map_or(travel, |c| travel.max(self.resolution * c.size(difference)))
    }

    fn resolution(&self) -> f64 {
        self.resolution
    }

    /// Each pair that has to stay apart is looked at as often as its own travel and its own room ask for; the end comes first,
    /// then the middle, then the middles of what is left.
    fn edge(&mut self, from: &[f64], to: &[f64]) -> Result<(), Blocked> {
        if !self.space.contains(to) {
            return Err(Blocked { fraction: 1.0, by: Obstruction::Bounds });
        }
        let mut work = std::mem::take(&mut self.work);
        self.space.difference_into(from, to, &mut work.difference);
        let outcome = self.keeps_constraint(from, &mut work).and_then(|()| self.keeps_apart(from, &mut work));
        self.work = work;
        outcome
    }

    fn describe(&self, obstruction: Obstruction) -> String {
        match obstruction {
            Obstruction::Constraint => "the held object tilts too far".into(),
            Obstruction::Bounds | Obstruction::Contact(_) => self.scene.explain(obstruction, "a joint limit"),
        }
    }
}
