//! Where a base has to stand so that an arm reaches: inverse reachability and grasp reachability (thesis, sections 4.4 and
//! 4.5), from the same cells as forward questions.
//!
//! A base moves in a plane: x, y, and a turn about the plane's normal. When the arm's first axis is parallel to that normal,
//! all bases from which a target is seen at one distance from one direction see it in one cell of the map, whatever their
//! turn; the turn chooses the azimuth. So the cells of all distances and directions are a distribution over bases, without any
//! search. What the thesis clusters (poses that differ by a motion in the plane) are the same cells here.

use std::f64::consts::{PI, TAU};

use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use robotc_core::Pose;
use robotc_core::rng::Rng;

use super::azimuth::{SECTORS, Sectors};
use super::map::{Cell, ReachabilityMap, Verdict, weight};

/// Directions from which a target is looked at.
const DIRECTIONS: u32 = 96;

/// Headings of a base that is not turned about the arm's first axis.
const HEADINGS: u32 = 48;

/// Something to reach.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Target {
    /// Where the tip shall be. The base's plane is z = 0 of the world.
    pub world_from_tip: Pose,
    /// How much it is wanted, such as the score of a grasp; 0 or more.
    pub weight: f64,
}

/// A place for the base.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placement {
    /// Position in the plane, metres.
    pub position: [f64; 2],
    /// Turn about the plane's normal, radians in (-pi, pi].
    pub yaw: f64,
    /// Position of the target that is reached from there.
    pub target: usize,
    /// Position of the mount, such as a height of a torso, with which it is reached.
    pub mount: usize,
}

impl Placement {
    /// `world_from_mobile`: the pose of the base.
    pub fn world_from_mobile(&self) -> Pose {
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), self.yaw);
        Pose::from_parts([self.position[0], self.position[1], 0.0].into(), turn)
    }
}

/// What of a cell counts.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Trust {
    /// Only azimuths at which all of it is reached.
    #[default]
    Whole,
    /// Also azimuths at which some of it is; samples have to be checked by inverse kinematics.
    Part,
}

impl Trust {
    fn azimuths(self, cell: &Cell) -> Sectors {
        match self {
            Self::Whole => cell.whole,
            Self::Part => cell.part,
        }
    }
}

/// A distribution over places for a base from which an arm reaches at least one target.
pub struct Placements {
    cells: Vec<BaseCell>,
    /// Sum of the weights up to and with each cell.
    sums: Vec<f64>,
    targets: Vec<Target>,
    mounts: Vec<Mount>,
    step: f64,
}

/// Bases from which a target is seen alike.
#[derive(Clone, Copy)]
struct BaseCell {
    target: u32,
    mount: u32,
    spot: Spot,
}

/// Where the bases of a cell are, about their target.
#[derive(Clone, Copy)]
enum Spot {
    /// In a piece of a ring, turned so that the target is at one of these azimuths: all that see it in one cell of the map.
    Ring { direction: u32, radial: u32, azimuths: Sectors },
    /// In a square, in a small range of headings. Where the first axis is tilted, bases that see a target in one cell are
    /// not simply put.
    Square { x: i32, y: i32, heading: u32 },
}

/// Where an arm sits on its base.
#[derive(Debug, Clone, Copy)]
struct Mount {
    mobile_from_axis: Pose,
    /// Turn of the axis frame against the base.
    turn: f64,
    /// Whether a turn of the base turns the first joint.
    upright: bool,
}

impl Mount {
    fn of(map: &ReachabilityMap, mobile_from_base: &Pose) -> Self {
        let mobile_from_axis = mobile_from_base * map.grid.base_from_axis;
        let x = mobile_from_axis.rotation * Vector3::x();
        let up = mobile_from_axis.rotation * Vector3::z();
        let upright = map.grid.symmetric && (up - Vector3::z()).norm() < 1e-9;
        Self { mobile_from_axis, turn: libm::atan2(x.y, x.x), upright }
    }

    fn position(&self) -> Vector3<f64> {
        self.mobile_from_axis.translation.vector
    }
}

impl Placements {
    /// The places from which `map`'s arm reaches any of `targets`. `mounts` holds `mobile_from_base`, the pose of the arm's
    /// base in the frame of what moves: one, or one for each value of a torso.
    ///
    /// An arm whose first axis is not parallel to the normal of the plane, or does not turn, takes a hundred times as long: all
    /// places about each target are looked at.
    pub fn new(map: &ReachabilityMap, targets: &[Target], mounts: &[Pose], trust: Trust) -> Self {
        let mounts: Vec<Mount> = mounts.iter().map(|mount| Mount::of(map, mount)).collect();
        let (targets, step) = (targets.to_vec(), map.grid.step);
        let mut placements = Self { cells: Vec::new(), sums: Vec::new(), targets, mounts, step };
        for target in 0..placements.targets.len() {
            placements.add_rings(map, target, trust);
            placements.add_squares(map, target, trust);
        }
        placements
    }

    /// The bases of the upright mounts.
    fn add_rings(&mut self, map: &ReachabilityMap, t: usize, trust: Trust) {
        let rotations = map.grid.rotations();
        let target = self.targets[t].world_from_tip;
        for m in (0..self.mounts.len()).filter(|m| self.mounts[*m].upright).collect::<Vec<_>>() {
            let height = target.translation.vector.z - self.mounts[m].position().z;
            for direction in 0..DIRECTIONS {
                let half = -0.5 * towards(f64::from(direction) + 0.5);
                let back = Quaternion::new(libm::cos(half), 0.0, 0.0, libm::sin(half));
                let rotation = rotations.cell(&(UnitQuaternion::new_unchecked(back) * target.rotation));
                for radial in 0..map.grid.radial {
                    let distance = (radial as f64 + 0.5) * map.grid.step;
                    let Some(place) = map.grid.place(distance, height) else { break };
                    let cell = map.cell(place * rotations.len() + rotation);
                    let azimuths = trust.azimuths(&cell);
                    if azimuths.is_empty() {
                        continue;
                    }
                    // Places count by their area and by the turns that are left to them.
                    let share = f64::from(azimuths.count()) / f64::from(SECTORS);
                    let area = distance * map.grid.step * TAU / f64::from(DIRECTIONS);
                    let spot = Spot::Ring { direction, radial: radial as u32, azimuths };
                    self.add(t, m, spot, weight(&cell) * share * area);
                }
            }
        }
    }

    /// The bases of all other mounts.
    fn add_squares(&mut self, map: &ReachabilityMap, t: usize, trust: Trust) {
        let target = self.targets[t].world_from_tip;
        for m in (0..self.mounts.len()).filter(|m| !self.mounts[*m].upright).collect::<Vec<_>>() {
            let mount = self.mounts[m];
            let reach = map.grid.radial as f64 * map.grid.step + mount.position().xy().norm();
            let side = (reach / map.grid.step).ceil() as i32;
            let area = map.grid.step * map.grid.step / f64::from(HEADINGS);
            for heading in 0..HEADINGS {
                for (x, y) in (-side..side).flat_map(|x| (-side..side).map(move |y| (x, y))) {
                    let spot = Spot::Square { x, y, heading };
                    let base = self.place(&BaseCell { target: t as u32, mount: m as u32, spot }, [0.5; 3]);
                    let world_from_axis = base.world_from_mobile() * mount.mobile_from_axis;
                    let Some(seen) = map.grid.see_from_axis(&world_from_axis.inv_mul(&target)) else {
                        continue;
                    };
                    let cell = map.cell(seen.cell);
                    if trust.azimuths(&cell).contains(seen.sector()) {
                        self.add(t, m, spot, weight(&cell) * area);
                    }
                }
            }
        }
    }

    fn add(&mut self, target: usize, mount: usize, spot: Spot, mass: f64) {
        self.sums.push(self.mass() + self.targets[target].weight * mass);
        self.cells.push(BaseCell { target: target as u32, mount: mount as u32, spot });
    }

    /// How much room there is: the area of all places times the share of turns that reach from there and the arm's freedom,
    /// times the weights of the targets; square metres.
    pub fn mass(&self) -> f64 {
        self.sums.last().copied().unwrap_or(0.0)
    }

    /// Whether no place is known.
    pub fn is_empty(&self) -> bool {
        self.mass() <= 0.0
    }

    /// Takes out what is not clear, for example because the base's footprint would be in an obstacle. Up to eight places of
    /// each cell are asked for: a cell without a clear one goes, others count by the share of clear ones. Samples can
    /// still lie beside clear places: [`sample_where`](Self::sample_where) rejects them.
    pub fn prune(&mut self, mut is_clear: impl FnMut(&Placement) -> bool) {
        let (cells, sums) = (std::mem::take(&mut self.cells), std::mem::take(&mut self.sums));
        let (mut before, mut sum) = (0.0, 0.0);
        for (cell, up_to) in cells.into_iter().zip(sums) {
            let asked = match cell.spot {
                Spot::Ring { azimuths, .. } => azimuths.count().min(8),
                Spot::Square { .. } => 1,
            };
            let at = |k: u32| [0.5, 0.5, (f64::from(k) + 0.5) / f64::from(asked)];
            let clear = (0..asked).filter(|&k| is_clear(&self.place(&cell, at(k)))).count();
            if clear > 0 {
                sum += (up_to - before) * clear as f64 / f64::from(asked);
                self.cells.push(cell);
                self.sums.push(sum);
            }
            before = up_to;
        }
    }

    /// A place, drawn by weight: that of the target, of the arm's freedom there, and of the area; `None` when none is known.
    pub fn sample(&self, rng: &mut Rng) -> Option<Placement> {
        if self.is_empty() {
            return None;
        }
        let wanted = self.mass() * rng.unit();
        let cell = &self.cells[self.sums.partition_point(|sum| *sum <= wanted).min(self.cells.len() - 1)];
        Some(self.place(cell, [rng.unit(), rng.unit(), rng.unit()]))
    }

    /// The first of up to `tries` samples that is accepted, for example because its footprint is clear of obstacles.
    pub fn sample_where(
        &self,
        rng: &mut Rng,
        tries: usize,
        mut accept: impl FnMut(&Placement) -> bool,
    ) -> Option<Placement> {
        (0..tries).find_map(|_| self.sample(rng).filter(|placement| accept(placement)))
    }

    /// The distribution over positions: the share of the weight in each square of `step` metres. Rows go along y, the first
    /// square begins at `corner`; what is outside of the `columns` x `rows` squares is left out.
    pub fn distribution(&self, corner: [f64; 2], step: f64, columns: usize, rows: usize) -> Vec<f64> {
        let mut squares = vec![0.0; columns * rows];
        let mut before = 0.0;
        for (cell, sum) in self.cells.iter().zip(&self.sums) {
            let places = match cell.spot {
                Spot::Ring { azimuths, .. } => azimuths.count(),
                Spot::Square { .. } => 1,
            };
            let weight = (sum - before) / self.mass() / f64::from(places);
            before = *sum;
            for k in 0..places {
                let third = (f64::from(k) + 0.5) / f64::from(places);
                let [x, y] = self.place(cell, [0.5, 0.5, third]).position;
                let (column, row) = (((x - corner[0]) / step).floor(), ((y - corner[1]) / step).floor());
                if column >= 0.0 && row >= 0.0 && column < columns as f64 && row < rows as f64 {
                    squares[row as usize * columns + column as usize] += weight;
                }
            }
        }
        squares
    }

    /// A base of a cell; the shares say where in it, each from 0 to 1: uniform ones give uniform bases.
    fn place(&self, cell: &BaseCell, [a, b, c]: [f64; 3]) -> Placement {
        let (target, mount) = (cell.target as usize, cell.mount as usize);
        let p = self.targets[target].world_from_tip.translation.vector;
        let (angle, radial, azimuths) = match cell.spot {
            Spot::Ring { direction, radial, azimuths } => {
                (towards(f64::from(direction) + a), radial, azimuths)
            }
            Spot::Square { x, y, heading } => {
                let yaw = (f64::from(heading) + c) * TAU / f64::from(HEADINGS) - PI;
                let position = [p.x + (f64::from(x) + a) * self.step, p.y + (f64::from(y) + b) * self.step];
                return Placement { position, yaw, target, mount };
            }
        };
        let inner = f64::from(radial);
        // Uniform over the area of the ring's piece.
        let distance = self.step * (inner * inner + (2.0 * inner + 1.0) * b).sqrt();
        // The base from which the target is seen at this azimuth, when the first axis is so far from it and looks so.
        let within = c * f64::from(azimuths.count());
        let azimuth = azimuths.nth(within as u32) + (within.fract() - 0.5) * TAU / f64::from(SECTORS);
        let yaw = angle - azimuth - self.mounts[mount].turn;
        let (sine, cosine) = (libm::sin(yaw), libm::cos(yaw));
        let axis = [p.x - distance * libm::cos(angle), p.y - distance * libm::sin(angle)];
        let at = self.mounts[mount].position();
        let arm = [cosine * at.x - sine * at.y, sine * at.x + cosine * at.y];
        let yaw = yaw - TAU * libm::round(yaw / TAU);
        Placement { position: [axis[0] - arm[0], axis[1] - arm[1]], yaw, target, mount }
    }
}

/// What the map says of each target when the base stands there, with one of the mounts.
pub fn verdicts(
    map: &ReachabilityMap,
    placement: &Placement,
    mobile_from_base: &Pose,
    targets: &[Target],
) -> Vec<Verdict> {
    let base_from_world = (placement.world_from_mobile() * mobile_from_base).inverse();
    targets.iter().map(|target| map.verdict(&(base_from_world * target.world_from_tip))).collect()
}

/// The angle of a direction.
fn towards(index: f64) -> f64 {
    index * TAU / f64::from(DIRECTIONS)
}

#[cfg(test)]
mod tests {
    use robotc_core::Seed;

    use super::super::grid::Grid;
    use super::super::map::FULL;
    use super::*;

    /// A map with a third of the directions: reached between 0.3 and 0.6 m from the axis, between 0.1 and 0.4 m above its origin, at
    /// azimuths within a quarter turn.
    fn map() -> ReachabilityMap {
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), 0.7);
        let base_from_axis = Pose::from_parts([0.0, 0.1, 0.2].into(), turn);
        let grid = Grid { base_from_axis, step: 0.05, radial: 16, level: 0, symmetric: true };
        let (count, rotations) = (grid.len(), grid.rotations().len());
        let cells = (0..count).map(|cell| {
            let (r, z) = grid.corner(cell / rotations);
            let inside = (0.299..0.599).contains(&r) && (0.099..0.399).contains(&z) && cell / 6 % 3 == 0;
            match inside {
                true => Cell { whole: Sectors(0xff), part: Sectors(0x1ff), density: FULL / 2, witness: 0 },
                false => Cell::default(),
            }
        });
        ReachabilityMap::new(grid.clone(), 1, cells).expect("all cells")
    }

    #[test]
    fn samples_are_reached_and_cover_all_targets_and_mounts() {
        let map = map();
        let mounts = [Pose::translation(0.1, 0.2, 0.3), Pose::translation(0.1, 0.2, 0.35)];
        let mut rng = Seed::new(1).rng();
        let targets: Vec<Target> = (0..8)
            .map(|k| {
                let p = [rng.range(-2.0, 2.0), rng.range(-2.0, 2.0), 0.75];
                Target {
                    world_from_tip: Pose::from_parts(p.into(), rng.rotation()),
                    weight: f64::from(k % 2),
                }
            })
            .collect();
        let placements = Placements::new(&map, &targets, &mounts, Trust::Whole);
        let (mut seen, mut reached) = ([[0; 2]; 8], 0);
        const COUNT: usize = 4000;
        for _ in 0..COUNT {
            let placement = placements.sample(&mut rng).expect("there are places");
            seen[placement.target][placement.mount] += 1;
            let found = verdicts(&map, &placement, &mounts[placement.mount], &targets);
            reached += usize::from(found[placement.target] == Verdict::Yes);
        }
        // A direction stands for a small range of rotations, some of which fall into a neighbouring cell.
        assert!(reached > COUNT * 9 / 10, "{reached}");
        for (target, seen) in targets.iter().zip(&seen) {
            assert_eq!(seen[0] > 0 && seen[1] > 0, target.weight > 0.0, "{seen:?}");
        }
        let squares = placements.distribution([-3.0, -3.0], 0.1, 60, 60);
        assert!((squares.iter().sum::<f64>() - 1.0).abs() < 1e-9);
    }

    /// Uniform bases, as many in each square; of those that reach, the share in each square.
    fn brute_force(map: &ReachabilityMap, mount: &Pose, targets: &[Target; 1], corner: [f64; 2]) -> Vec<f64> {
        let mut rng = Seed::new(6).rng();
        let mut found = vec![0.0; SIDE * SIDE];
        for (square, found) in found.iter_mut().enumerate() {
            for _ in 0..400 {
                let x = corner[0] + STEP * ((square % SIDE) as f64 + rng.unit());
                let y = corner[1] + STEP * ((square / SIDE) as f64 + rng.unit());
                let yaw = rng.range(-PI, PI);
                let placement = Placement { position: [x, y], yaw, target: 0, mount: 0 };
                *found += f64::from(u8::from(verdicts(map, &placement, mount, targets)[0] == Verdict::Yes));
            }
        }
        let total: f64 = found.iter().sum();
        found.into_iter().map(|share| share / total).collect()
    }

    const SIDE: usize = 30;
    const STEP: f64 = 0.1;

    #[test]
    fn places_are_those_of_brute_force_also_for_a_tilted_axis() {
        let map = map();
        for tilt in [0.0, 0.3] {
            let turn = UnitQuaternion::from_euler_angles(tilt, 0.5 * tilt, 0.0);
            let mount = Pose::from_parts([0.1, 0.2, 0.3].into(), turn);
            let world_from_tip = Pose::from_parts([0.4, -0.3, 0.75].into(), Seed::new(5).rng().rotation());
            let targets = [Target { world_from_tip, weight: 1.0 }];
            let placements = Placements::new(&map, &targets, &[mount], Trust::Whole);
            let corner = [-1.1, -1.8];
            let squares = placements.distribution(corner, STEP, SIDE, SIDE);
            let expected = brute_force(&map, &mount, &targets, corner);
            let off: f64 = expected.iter().zip(&squares).map(|(e, s)| (e - s).abs()).sum();
            assert!(off < 0.25, "the distributions differ by {off} with tilt {tilt}");
        }
    }

    #[test]
    fn pruned_places_are_clear() {
        let map = map();
        let world_from_tip = Pose::from_parts([0.4, -0.3, 0.75].into(), Seed::new(5).rng().rotation());
        let targets = [Target { world_from_tip, weight: 1.0 }];
        let all = Placements::new(&map, &targets, &[Pose::translation(0.1, 0.2, 0.3)], Trust::Whole);
        let mut pruned = Placements::new(&map, &targets, &[Pose::translation(0.1, 0.2, 0.3)], Trust::Whole);
        let is_clear = |placement: &Placement| placement.position[0] > 0.3;
        pruned.prune(is_clear);
        let mut rng = Seed::new(8).rng();
        let mut share = |placements: &Placements| {
            let clear = |_: &u32| placements.sample(&mut rng).as_ref().is_some_and(is_clear);
            (0..2000).filter(clear).count() as f64 / 2000.0
        };
        let (before, after) = (share(&all), share(&pruned));
        assert!((pruned.mass() / all.mass() - before).abs() < 0.05, "{before}");
        assert!(before < 0.8 && after > 0.9, "{before} {after}");
        pruned.prune(|_| false);
        assert!(pruned.is_empty() && pruned.sample(&mut rng).is_none());
    }
}
