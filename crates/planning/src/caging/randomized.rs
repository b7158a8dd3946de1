//! Randomized A*: like A*, with actions drawn at random (thesis algorithm 3.8; Diankov and Kuffner, "Randomized statistical
//! path planning", 2007).

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use robotc_core::rng::Rng;
use serde::{Deserialize, Serialize};

use super::task::{
    ArticulatedTask, CagedState, CagingFailure, CagingFailureReason, CagingSolution, CagingStatistics,
};
use crate::budget::Budget;
use crate::space::Space;

/// States that are added one after the other before they are looked at for collisions: most ways end sooner, out of reach.
const AHEAD: usize = 8;
/// Configurations of one grasp and step that are tried from one state, when others turn out to collide.
const TRIES: usize = 3;

/// Parameters of the search.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct RandomizedOptions {
    /// New states drawn from a state before the next best one is looked at.
    pub children: u32,
    /// Cost of one object step that is left, in units of the longest motion of the arm; what is above the truth makes the
    /// search greedy.
    pub heuristic: f64,
    /// Chance that a draw which does not go on is drawn again.
    pub ahead: f64,
    /// Two states of the same step and grasp nearer than this are the same, in units of the longest motion.
    pub same: f64,
    /// Draws after which the search gives up.
    pub max_draws: u32,
}

impl Default for RandomizedOptions {
    fn default() -> Self {
        Self { children: 3, heuristic: 2.0, ahead: 0.7, same: 0.1, max_draws: 50_000 }
    }
}

/// Where the search begins.
#[derive(Debug, Clone, PartialEq)]
pub enum CageStart {
    /// The object at this step, in any grasp.
    Step(usize),
    /// The gripper around the object already.
    State(CagedState),
}

/// Finds a motion of the object to its goal, with grasps that change within the cage on the way.
///
/// From each state pairs of a neighbouring step and an adjacent grasp are drawn without replacement, those at the goal in
/// contact; the arm configuration is the nearest that can be reached. The search fails only when all are used up, or at
/// its limits. States are looked at for collisions some steps after they were drawn: what leads nowhere costs no more than
/// inverse kinematics.
pub fn randomized_search<T: ArticulatedTask + ?Sized>(
    task: &mut T,
    start: &CageStart,
    options: &RandomizedOptions,
    budget: &Budget<'_>,
    rng: &mut Rng,
) -> Result<CagingSolution, CagingFailure> {
    let tree = Tree {
        nodes: Vec::new(),
        by_step: vec![Vec::new(); task.steps()],
        space: task.arm_space().clone(),
        same: options.same * task.longest_motion(),
    };
    let mut search =
        Search { tree, open: BinaryHeap::new(), task, options, statistics: CagingStatistics::default() };
    let outcome = search.run(start, budget, rng);
    match outcome {
        Ok(node) => Ok(CagingSolution { states: search.tree.path_to(node), statistics: search.statistics }),
        Err(reason) => {
            let tree = &search.tree;
            let looked_at = (0..tree.nodes.len()).filter(|&n| tree.nodes[n].sight == Sight::Free);
            let nearest = looked_at.min_by_key(|&n| search.remaining(n));
            let partial = nearest.map(|n| tree.path_to(n)).unwrap_or_default();
            Err(CagingFailure { reason, partial, statistics: search.statistics })
        }
    }
}

struct Node {
    state: CagedState,
    parent: Option<usize>,
    /// Length of the arm's path so far.
    cost: f64,
    /// Pairs of step and grasp not drawn yet.
    pool: Vec<(usize, usize)>,
    /// Whether there was a draw.
    drawn: bool,
    sight: Sight,
}

/// Whether a state can be reached from the one before it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Sight {
    Unseen,
    Free,
    Blocked,
}

/// A place in the queue; smaller totals come first, then older nodes.
#[derive(PartialEq)]
struct Entry {
    total: f64,
    node: usize,
}

impl Eq for Entry {}

impl PartialOrd for Entry {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Entry {
    fn cmp(&self, other: &Self) -> Ordering {
        other.total.total_cmp(&self.total).then(other.node.cmp(&self.node))
    }
}

/// States that were drawn.
struct Tree {
    nodes: Vec<Node>,
    /// Nodes of each object step.
    by_step: Vec<Vec<usize>>,
    /// That of the arm.
    space: Space,
    /// Two states of the same step and grasp nearer than this are the same.
    same: f64,
}

struct Search<'t, T: ?Sized> {
    task: &'t mut T,
    options: &'t RandomizedOptions,
    tree: Tree,
    open: BinaryHeap<Entry>,
    statistics: CagingStatistics,
}

impl Tree {
    /// What became of a state that was drawn before, from anywhere; one that is blocked from elsewhere may do from here.
    fn known(&self, state: &CagedState, parent: usize) -> Option<Sight> {
        let known = self.by_step[state.step].iter().copied().filter(|&n| {
            let known = &self.nodes[n].state;
            known.grasp == state.grasp && self.space.distance(&known.q, &state.q) < self.same
        });
        let mut blocked = None;
        for node in known {
            if self.unseen(node).is_some() {
                return Some(Sight::Free);
            }
            if self.nodes[node].parent == Some(parent) && self.nodes[node].sight == Sight::Blocked {
                blocked = Some(Sight::Blocked);
            }
        }
        blocked
    }

    /// The states on the way to a node that nobody has looked at, the first one last; `None` when the way is blocked.
    fn unseen(&self, node: usize) -> Option<Vec<usize>> {
        let mut unseen = Vec::new();
        let mut at = Some(node);
        while let Some(node) = at {
            match self.nodes[node].sight {
                Sight::Free => break,
                Sight::Blocked => return None,
                Sight::Unseen => unseen.push(node),
            }
            at = self.nodes[node].parent;
        }
        Some(unseen)
    }

    fn path_to(&self, node: usize) -> Vec<CagedState> {
        let mut path = Vec::new();
        let mut at = Some(node);
        while let Some(n) = at {
            path.push(self.nodes[n].state.clone());
            at = self.nodes[n].parent;
        }
        path.reverse();
        path
    }
}

impl<T: ArticulatedTask + ?Sized> Search<'_, T> {
    fn run(
        &mut self,
        start: &CageStart,
        budget: &Budget<'_>,
        rng: &mut Rng,
    ) -> Result<usize, CagingFailureReason> {
        let goal = self.task.steps() - 1;
        // Grasps at the start that are still to be tried, when there is a choice.
        let mut roots: Vec<usize> = Vec::new();
        let first = match start {
            CageStart::Step(step) => {
                roots = (0..self.task.grasps()).filter(|&g| self.task.is_usable(g)).collect();
                *step
            }
            CageStart::State(state) => {
                self.add(state.clone(), None);
                self.tree.nodes[0].sight = Sight::Free;
                state.step
            }
        };
        let mut draws = 0;
        loop {
            // Another root while nothing better is open: it costs as much as a state at the start.
            let best = self.open.peek().map_or(f64::INFINITY, |entry| entry.total);
            if !roots.is_empty() && best > self.heuristic(first) {
                budget.check().map_err(CagingFailureReason::Interrupted)?;
                let grasp = roots.swap_remove(rng.below(roots.len()));
                if first != goal || self.task.is_contact(grasp) {
                    for q in self.roots(first, grasp) {
                        self.add(CagedState { step: first, grasp, q }, None);
                    }
                }
                continue;
            }
            let Some(Entry { total, node }) = self.open.pop() else {
                return Err(match (self.tree.nodes.is_empty(), first == goal) {
                    (false, _) => CagingFailureReason::NoPath,
                    (true, true) => CagingFailureReason::NoContact,
                    (true, false) => CagingFailureReason::OutOfReach { step: first },
                });
            };
            let Some(unseen) = self.tree.unseen(node) else { continue };
            let here = &self.tree.nodes[node].state;
            let arrived = here.step == goal && self.task.is_contact(here.grasp);
            if (arrived || unseen.len() >= AHEAD) && !self.look_at(&unseen, budget)? {
                continue;
            }
            if arrived {
                return Ok(node);
            }
            let mut children = 0;
            while children < self.options.children && !self.tree.nodes[node].pool.is_empty() {
                budget.check().map_err(CagingFailureReason::Interrupted)?;
                draws += 1;
                if draws > self.options.max_draws {
                    return Err(CagingFailureReason::Iterations);
                }
                children += u32::from(self.draw_from(node, rng));
            }
            if !self.tree.nodes[node].pool.is_empty() {
                // Later it may be worth another look.
                let penalty = self.options.heuristic * self.task.longest_motion();
                self.open.push(Entry { total: total + penalty, node });
            }
        }
    }

    /// One draw without replacement; whether it gave a new state (SampleNN).
    ///
    /// The first one goes on with the same grasp, which is what works most often; later ones prefer to go on.
    fn draw_from(&mut self, node: usize, rng: &mut Rng) -> bool {
        let from = self.tree.nodes[node].state.clone();
        let (task, ahead) = (&*self.task, self.task.remaining(from.step));
        let goes_on = |&(step, _): &(usize, usize)| task.remaining(step) < ahead;
        let Node { pool, drawn, .. } = &mut self.tree.nodes[node];
        let same = |entry: &(usize, usize)| goes_on(entry) && entry.1 == from.grasp;
        let first = if *drawn { None } else { pool.iter().position(same) };
        *drawn = true;
        let number = first.unwrap_or_else(|| {
            let number = rng.below(pool.len());
            if goes_on(&pool[number]) || rng.unit() >= self.options.ahead {
                number
            } else {
                rng.below(pool.len())
            }
        });
        let (step, grasp) = pool.swap_remove(number);
        let Self { task, tree, statistics, .. } = self;
        let (longest, mut new) = (task.longest_motion(), None);
        statistics.inverse_calls += 1;
        task.take_candidate(step, grasp, &from.q, &mut |q| {
            statistics.states += 1;
            if tree.space.distance(&from.q, &q) > longest {
                return false;
            }
            let to = CagedState { step, grasp, q };
            match tree.known(&to, node) {
                Some(Sight::Blocked) => false,
                Some(_) => true,
                None => {
                    new = Some(to);
                    true
                }
            }
        });
        let is_new = new.is_some();
        new.into_iter().for_each(|to| self.add(to, Some(node)));
        is_new
    }

    /// Configurations from which the object may be grasped at a step.
    fn roots(&mut self, step: usize, grasp: usize) -> Vec<Vec<f64>> {
        self.statistics.inverse_calls += 1;
        let found = self.task.candidates(step, grasp, None);
        self.statistics.states += found.len() as u32;
        found
    }

    /// Looks at states for collisions, the first one being the last; whether all are free.
    fn look_at(&mut self, unseen: &[usize], budget: &Budget<'_>) -> Result<bool, CagingFailureReason> {
        for &node in unseen.iter().rev() {
            budget.check().map_err(CagingFailureReason::Interrupted)?;
            let (state, parent) = (&self.tree.nodes[node].state, self.tree.nodes[node].parent);
            let outcome = match parent {
                Some(parent) => {
                    self.statistics.motions += 1;
                    self.task.motion(&self.tree.nodes[parent].state, state)
                }
                None => self.task.free(state),
            };
            if !self.statistics.passes(outcome) {
                self.tree.nodes[node].sight = Sight::Blocked;
                if let Some(parent) = parent {
                    self.draw_again(node, parent);
                }
                return Ok(false);
            }
            self.tree.nodes[node].sight = Sight::Free;
        }
        Ok(true)
    }

    /// Another configuration of the grasp and step of a blocked node may do.
    fn draw_again(&mut self, blocked: usize, parent: usize) {
        let drawn = (self.tree.nodes[blocked].state.step, self.tree.nodes[blocked].state.grasp);
        let of_parent = |&&n: &&usize| {
            self.tree.nodes[n].parent == Some(parent) && self.tree.nodes[n].state.grasp == drawn.1
        };
        if self.tree.by_step[drawn.0].iter().filter(of_parent).count() < TRIES {
            self.tree.nodes[parent].pool.push(drawn);
            let total = self.tree.nodes[parent].cost + self.heuristic(self.tree.nodes[parent].state.step);
            self.open.push(Entry { total, node: parent });
        }
    }

    fn add(&mut self, state: CagedState, parent: Option<usize>) {
        let cost = parent.map_or(0.0, |p| {
            let before = &self.tree.nodes[p];
            before.cost + self.task.arm_space().distance(&before.state.q, &state.q)
        });
        let goal = self.task.steps() - 1;
        let mut pool = Vec::new();
        for step in self.task.neighbours(state.step) {
            for &grasp in self.task.adjacent(state.grasp) {
                let useful = step != goal || self.task.is_contact(grasp);
                if useful && (step, grasp) != (state.step, state.grasp) {
                    pool.push((step, grasp));
                }
            }
        }
        let node = self.tree.nodes.len();
        self.tree.by_step[state.step].push(node);
        self.open.push(Entry { total: cost + self.heuristic(state.step), node });
        self.tree.nodes.push(Node { state, parent, cost, pool, drawn: false, sight: Sight::Unseen });
    }

    fn heuristic(&self, step: usize) -> f64 {
        self.options.heuristic * self.task.longest_motion() * self.task.remaining(step) as f64
    }

    fn remaining(&self, node: usize) -> usize {
        self.task.remaining(self.tree.nodes[node].state.step)
    }
}
