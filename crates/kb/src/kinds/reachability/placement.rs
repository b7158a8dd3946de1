//! Where a base has to stand so that an arm reaches: inverse reachability and grasp reachability (thesis, sections 4.4 and
//! 4.5), from the same cells as forward questions.
//!
//! A base moves in a plane: x, y, and a turn about the plane's normal. When the arm's first axis is parallel to that normal,
//! all bases from which a target is seen at one distance from one direction see it in one cell of the map, whatever their
//! turn; the turn chooses the azimuth. So the cells of all distances and directions are a distribution over bases, without any
//! search. What the thesis clusters (poses that differ by a motion in the plane) are the same cells here.

use std::f64::consts::TAU;

use nalgebra::{UnitQuaternion, Vector3};
use robotc_core::Pose;
use robotc_core::rng::Rng;
use thiserror::Error;

use super::azimuth::{SECTORS, Sectors};
use super::map::{ReachabilityMap, Verdict, weight};

/// Directions from which a target is looked at.
const DIRECTIONS: usize = 96;

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

/// Why there is no distribution of placements.
#[derive(Debug, Clone, Copy, Error, PartialEq, Eq)]
pub enum PlacementError {
    /// A mount tilts the first axis of the arm, or the map is not symmetric about it.
    #[error("the arm's first axis does not turn about the normal of the base's plane with mount {0}")]
    Tilted(usize),
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

/// A distribution over places for a base from which an arm reaches at least one target.
pub struct Placements {
    cells: Vec<BaseCell>,
    /// Sum of the weights up to and with each cell.
    sums: Vec<f64>,
    targets: Vec<Target>,
    mounts: Vec<Mount>,
    step: f64,
}

/// All bases from which a target is seen in one cell.
struct BaseCell {
    target: u32,
    mount: u32,
    direction: u32,
    radial: u32,
    azimuths: Sectors,
}

/// Where an arm sits on its base.
#[derive(Debug, Clone, Copy)]
struct Mount {
    /// Of the first axis, in the base's frame.
    position: Vector3<f64>,
    /// Turn of the axis frame against the base.
    turn: f64,
}

impl Mount {
    fn of(map: &ReachabilityMap, mobile_from_base: &Pose) -> Option<Self> {
        let mobile_from_axis = mobile_from_base * map.grid.base_from_axis;
        let x = mobile_from_axis.rotation * Vector3::x();
        let upright = (mobile_from_axis.rotation * Vector3::z() - Vector3::z()).norm() < 1e-9;
        let position = mobile_from_axis.translation.vector;
        (map.grid.symmetric && upright).then(|| Self { position, turn: libm::atan2(x.y, x.x) })
    }
}

impl Placements {
    /// The places from which `map`'s arm reaches any of `targets`. `mounts` holds `mobile_from_base`, the pose of the arm's
    /// base in the frame of what moves: one, or one for each value of a torso.
    pub fn new(
        map: &ReachabilityMap,
        targets: &[Target],
        mounts: &[Pose],
        trust: Trust,
    ) -> Result<Self, PlacementError> {
        let mount = |(i, mount): (usize, &Pose)| Mount::of(map, mount).ok_or(PlacementError::Tilted(i));
        let mounts: Vec<Mount> = mounts.iter().enumerate().map(mount).collect::<Result<_, _>>()?;
        let (mut cells, mut sums, mut sum) = (Vec::new(), Vec::new(), 0.0);
        let rotations = map.grid.rotations();
        let backs: Vec<_> = (0..DIRECTIONS)
            .map(|d| UnitQuaternion::from_axis_angle(&Vector3::z_axis(), -direction(d as f64 + 0.5)))
            .collect();
        for (t, target) in targets.iter().enumerate() {
            for (d, back) in backs.iter().enumerate() {
                let rotation = rotations.cell(&(back * target.world_from_tip.rotation));
                for (m, mount) in mounts.iter().enumerate() {
                    let height = target.world_from_tip.translation.vector.z - mount.position.z;
                    for radial in 0..map.grid.radial {
                        let distance = (radial as f64 + 0.5) * map.grid.step;
                        let Some(place) = map.grid.place(distance, height) else { break };
                        let cell = map.cell(place * rotations.len() + rotation);
                        let azimuths = match trust {
                            Trust::Whole => cell.whole,
                            Trust::Part => cell.part,
                        };
                        if azimuths.is_empty() {
                            continue;
                        }
                        // Places count by their area and by the turns that are left to them.
                        let share = f64::from(azimuths.count()) / f64::from(SECTORS);
                        sum += target.weight * weight(&cell) * share * distance;
                        sums.push(sum);
                        let (target, mount, direction) = (t as u32, m as u32, d as u32);
                        cells.push(BaseCell { target, mount, direction, radial: radial as u32, azimuths });
                    }
                }
            }
        }
        Ok(Self { cells, sums, targets: targets.to_vec(), mounts, step: map.grid.step })
    }

    /// Whether no place is known.
    pub fn is_empty(&self) -> bool {
        self.sums.last().is_none_or(|sum| *sum <= 0.0)
    }

    /// A place, drawn by weight: that of the target, of the arm's freedom there, and of the area; `None` when none is known.
    pub fn sample(&self, rng: &mut Rng) -> Option<Placement> {
        let total = *self.sums.last().filter(|sum| **sum > 0.0)?;
        let wanted = total * rng.unit();
        let cell = &self.cells[self.sums.partition_point(|sum| *sum <= wanted).min(self.cells.len() - 1)];
        let towards = direction(f64::from(cell.direction) + rng.unit());
        let inner = f64::from(cell.radial);
        // Uniform over the area of the ring's piece.
        let distance = self.step * (inner * inner + (2.0 * inner + 1.0) * rng.unit()).sqrt();
        let sectors: Vec<f64> = cell.azimuths.centres().map(|(_, centre)| centre).collect();
        let azimuth = sectors[rng.below(sectors.len())] + (rng.unit() - 0.5) * TAU / f64::from(SECTORS);
        Some(self.place(cell, towards, distance, azimuth))
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
        let total = self.sums.last().copied().unwrap_or(0.0);
        let mut before = 0.0;
        for (cell, sum) in self.cells.iter().zip(&self.sums) {
            let weight = (sum - before) / total / f64::from(cell.azimuths.count());
            before = *sum;
            let towards = direction(f64::from(cell.direction) + 0.5);
            let distance = (f64::from(cell.radial) + 0.5) * self.step;
            for (_, azimuth) in cell.azimuths.centres() {
                let [x, y] = self.place(cell, towards, distance, azimuth).position;
                let (column, row) = (((x - corner[0]) / step).floor(), ((y - corner[1]) / step).floor());
                if column >= 0.0 && row >= 0.0 && column < columns as f64 && row < rows as f64 {
                    squares[row as usize * columns + column as usize] += weight;
                }
            }
        }
        squares
    }

    /// The base from which the target is seen at this azimuth, when the first axis is so far from it and looks so.
    fn place(&self, cell: &BaseCell, towards: f64, distance: f64, azimuth: f64) -> Placement {
        let (target, mount) = (cell.target as usize, cell.mount as usize);
        let at = &self.mounts[mount];
        let yaw = towards - azimuth - at.turn;
        let p = self.targets[target].world_from_tip.translation.vector;
        let (sine, cosine) = (libm::sin(yaw), libm::cos(yaw));
        let axis = [p.x - distance * libm::cos(towards), p.y - distance * libm::sin(towards)];
        let arm =
            [cosine * at.position.x - sine * at.position.y, sine * at.position.x + cosine * at.position.y];
        let yaw = libm::atan2(sine, cosine);
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

fn direction(index: f64) -> f64 {
    index * TAU / DIRECTIONS as f64
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use robotc_core::Seed;

    use super::super::grid::Grid;
    use super::super::map::{Cell, FULL};
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
                true => Cell { whole: Sectors(0xff), part: Sectors(0x1ff), density: FULL / 2 },
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
        let placements = Placements::new(&map, &targets, &mounts, Trust::Whole).expect("upright");
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

    #[test]
    fn places_are_those_of_brute_force() {
        let map = map();
        let mount = Pose::translation(0.1, 0.2, 0.3);
        let world_from_tip = Pose::from_parts([0.4, -0.3, 0.75].into(), Seed::new(5).rng().rotation());
        let targets = [Target { world_from_tip, weight: 1.0 }];
        let placements = Placements::new(&map, &targets, &[mount], Trust::Whole).expect("upright");
        let (side, step) = (30, 0.1);
        let corner = [-1.1, -1.8];
        let squares = placements.distribution(corner, step, side, side);
        // Uniform bases, as many in each square; of those that reach, the share in each square.
        let mut rng = Seed::new(6).rng();
        let mut expected = vec![0.0; side * side];
        for square in 0..side * side {
            for _ in 0..400 {
                let x = corner[0] + step * ((square % side) as f64 + rng.unit());
                let y = corner[1] + step * ((square / side) as f64 + rng.unit());
                let yaw = rng.range(-PI, PI);
                let placement = Placement { position: [x, y], yaw, target: 0, mount: 0 };
                let found = verdicts(&map, &placement, &mount, &targets);
                expected[square] += f64::from(u8::from(found[0] == Verdict::Yes));
            }
        }
        let total: f64 = expected.iter().sum();
        let off: f64 = expected.iter().zip(&squares).map(|(e, s)| (e / total - s).abs()).sum();
        assert!(off < 0.25, "the distributions differ by {off}");
    }

    #[test]
    fn a_tilted_axis_is_refused() {
        let tilted = Pose::from_parts(Default::default(), UnitQuaternion::from_euler_angles(0.1, 0.0, 0.0));
        let error = Placements::new(&map(), &[], &[Pose::identity(), tilted], Trust::Whole).err();
        assert_eq!(error, Some(PlacementError::Tilted(1)));
        assert!(Placements::new(&map(), &[], &[Pose::identity()], Trust::Part).expect("upright").is_empty());
    }
}
