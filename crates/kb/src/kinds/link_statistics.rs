//! How much of the robot each joint moves, and how far: weights of the configuration metric.

use robotc_core::LinkIdx;
use robotc_core::ids::Idx;
use serde::{Deserialize, Serialize};

use super::ConvexParts;
use crate::codec;
use crate::graph::{Dep, PlanError, Planner};
use crate::kind::{DecodeError, Kind, Portability};
use crate::parameters::round_step;
use crate::project::{OfRobot, OfShape, Subject};
use crate::projection::{Limits, Mechanism};
use crate::record::Parts;

/// The kind; its artefact is a [`LinkStatistics`](JointStatistics): one row for each degree of freedom.
///
/// The volume that a joint sweeps is that of its links turned through its limits together with the volumes swept by
/// the joints below it. Its cross-section with a half plane through the axis, times the volume of the links that
/// the joint moves, gives the weight: the cube root of the product (thesis, equation 4.62).
pub struct LinkStatistics;

crate::parameters! {
    /// Parameters of [`LinkStatistics`].
    pub struct StatisticsParameters {
        /// Edge of the cells that swept volumes are counted in.
        cell: f64 ["m"] in 0.0001..=1.0 = auto "about a fiftieth of the length of the longest chain of links";
    }
}

/// Joints and shapes.
pub struct Robot {
    mechanism: Mechanism,
    bodies: Vec<(LinkIdx, Dep<ConvexParts>)>,
}

/// What is known about a degree of freedom.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct JointStatistics {
    /// Area of all its [sections](Self::sections), m^2.
    pub cross_section: f64,
    /// Volume of all links that it moves, m^3; what several convex parts share is counted for each.
    pub moved_volume: f64,
    /// Metres that a point of the robot moves for each unit of the joint, at most: the largest distance of a moved point
    /// from the axis of a turning joint, rounded up by a few cells, and 1 for a sliding one.
    pub reach: f64,
    /// Weight in the configuration metric; see [`LinkStatistics`].
    pub weight: f64,
    /// The volume that is swept, cut: one section for each joint that it drives, in the order of the joints.
    pub sections: Vec<SweptSection>,
}

/// The cross-section of the volume that a joint sweeps: with a half plane through the axis of a turning joint, or a plane across
/// the axis of a sliding one. Its squares stand in rows, lowest first.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct SweptSection {
    /// Edge of a square, metres.
    pub cell: f64,
    /// The rows that have squares.
    pub rows: Vec<SectionRow>,
}

/// Squares beside each other.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct SectionRow {
    /// Their lower edge in edges of a square: along the axis of a turning joint, along y for a sliding one.
    pub height: i32,
    /// The near edge of the first, in edges of a square: from the axis of a turning joint, along x for a sliding one.
    pub first: i32,
    /// In how many of 64 directions about the axis each is swept; 0 where it is not, 64 for what slides.
    pub swept: Vec<u8>,
}

impl SweptSection {
    /// Its area, m^2.
    pub fn area(&self) -> f64 {
        let squares = self.rows.iter().flat_map(|row| &row.swept).filter(|swept| **swept > 0).count();
        squares as f64 * self.cell * self.cell
    }

    /// Whether its rows stand one above the other, at places that can be reckoned with.
    fn is_sound(&self) -> bool {
        const FAR: u32 = 1 << 20;
        let near = |row: &SectionRow| {
            row.height.unsigned_abs() < FAR
                && row.first.unsigned_abs() < FAR
                && row.swept.len() < FAR as usize
        };
        self.rows.iter().all(near) && self.rows.is_sorted_by(|a, b| a.height < b.height)
    }
}

/// Four measures, and sections.
type Stored = ([f64; 4], Vec<SweptSection>);

impl Kind for LinkStatistics {
    const NAME: &'static str = "link_statistics";
    const FORMAT: u32 = 2;
    const ALGORITHM: u32 = 1;
    const PORTABILITY: Portability = Portability::Portable;
    const DOC: &'static str = "Swept cross-section, moved volume and reach of every joint. They weigh the joints in the planners' metric.";

    type Subject = OfRobot;
    type Inputs = Robot;
    type Parameters = StatisticsParameters;
    type Artefact = Vec<JointStatistics>;

    fn inputs(planner: &mut Planner<'_>, _subject: &OfRobot) -> Result<Robot, PlanError> {
        let robot = planner.project().robot();
        let mut bodies = Vec::new();
        for shape in OfShape::all(planner.project()) {
            if let OfShape::Link(link) = shape {
                bodies.push((link, planner.need::<ConvexParts>(&shape)?));
            }
        }
        Ok(Robot { mechanism: Mechanism::whole(&robot.model, Limits::Kept), bodies })
    }

    fn key_parts(inputs: &Robot, parts: &mut Parts) {
        let Robot { mechanism, bodies } = inputs;
        mechanism.key_parts(parts);
        let bodies: Vec<usize> = bodies.iter().map(|(link, _)| link.index()).collect();
        parts.add("links with shapes", "", &bodies);
    }

    fn defaults(inputs: &Robot) -> StatisticsParameters {
        let model = inputs.mechanism.model();
        // Longest way from the root to a link, along bones as written.
        let mut depth = vec![0.0_f64; model.links().len()];
        for &j in model.topological_order() {
            let joint = &model.joints()[j];
            let [x, y, z] = joint.origin.xyz;
            depth[joint.child.index()] = depth[joint.parent.index()] + (x * x + y * y + z * z).sqrt();
        }
        let longest = depth.into_iter().fold(0.0, f64::max);
        StatisticsParameters { cell: round_step(longest / 50.0).clamp(0.0005, 0.2) }
    }

    fn encode(artefact: &Vec<JointStatistics>) -> Vec<u8> {
        let stored = |s: &JointStatistics| -> Stored {
            ([s.cross_section, s.moved_volume, s.reach, s.weight], s.sections.clone())
        };
        codec::encode(&artefact.iter().map(stored).collect::<Vec<_>>())
    }

    fn decode(bytes: &[u8]) -> Result<Vec<JointStatistics>, DecodeError> {
        let rows: Vec<Stored> = codec::decode(bytes)?;
        let cells = rows.iter().flat_map(|(_, sections)| sections).map(|section| &section.cell);
        if rows.iter().flat_map(|(measures, _)| measures).chain(cells).any(|x| !x.is_finite() || *x < 0.0) {
            return Err(DecodeError::new("a measure is not a finite, non-negative number"));
        }
        if !rows.iter().flat_map(|(_, sections)| sections).all(SweptSection::is_sound) {
            return Err(DecodeError::new("a section is not made of rows, lowest first"));
        }
        let row = |([cross_section, moved_volume, reach, weight], sections): Stored| JointStatistics {
            cross_section,
            moved_volume,
            reach,
            weight,
            sections,
        };
        Ok(rows.into_iter().map(row).collect())
    }

    fn summary(artefact: &Vec<JointStatistics>) -> String {
        let weights: Vec<String> = artefact.iter().map(|s| format!("{:.3}", s.weight)).collect();
        format!("weights {}", weights.join(" "))
    }
}

#[cfg(feature = "build")]
mod build {
    use std::collections::BTreeMap;
    use std::sync::Arc;

    use nalgebra::{Point3, Unit, UnitQuaternion, Vector3};
    use robotc_core::geom::{ConvexPart, ConvexParts as Parts3};
    use robotc_core::ids::JointIdx;
    use robotc_core::model::{Configuration, Drive, JointMotion, Kinematics, LinkPoses, RobotModel};

    use super::*;
    use crate::kind::{Build, BuildError, Context};

    impl Build for LinkStatistics {
        fn build(
            inputs: &Robot,
            parameters: &StatisticsParameters,
            context: &Context<'_>,
        ) -> Result<Vec<JointStatistics>, BuildError> {
            let model = inputs.mechanism.model();
            let shapes = load(inputs, context)?;
            let mut sweeper =
                Sweeper { model, shapes: &shapes, cell: parameters.cell, swept: BTreeMap::new() };
            let order: Vec<JointIdx> = model.topological_order().iter().rev().copied().collect();
            for (done, &joint) in order.iter().enumerate() {
                context.checkpoint()?;
                if model.joints()[joint].motion != JointMotion::Fixed {
                    sweeper.sweep(joint);
                }
                context.progress(done as u64 + 1, order.len() as u64);
            }
            let statistics = model.dofs().indices().map(|dof| {
                let driven = model.joints().indices().filter(|&j| model.driving_dof(j) == Some(dof));
                let driven: Vec<JointIdx> = driven.collect();
                let mut sum = JointStatistics::default();
                let mut product = 0.0;
                for &joint in &driven {
                    let (area, volume) = (sweeper.swept[&joint].area(), moved_volume(model, joint, &shapes));
                    sum.sections.push(sweeper.swept[&joint].rows());
                    sum.cross_section += area;
                    sum.moved_volume += volume;
                    product += area * volume;
                    // Joints that follow each other along a chain add up; those on two branches do not.
                    let child = model.joints()[joint].child;
                    let along = driven.iter().filter(|&&other| model.joint_moves_link(other, child));
                    let reach =
                        along.map(|&other| factor(model, other) * sweeper.swept[&other].reach()).sum();
                    sum.reach = sum.reach.max(reach);
                }
                JointStatistics { weight: libm::cbrt(product), ..sum }
            });
            Ok(statistics.collect())
        }

        /// Sections have the area that is told of them, and the bounds on travel hold in random configurations: no corner moves
        /// faster under a joint.
        fn check(
            artefact: &Vec<JointStatistics>,
            inputs: &Robot,
            _parameters: &StatisticsParameters,
            context: &Context<'_>,
        ) -> Result<(), BuildError> {
            let model = inputs.mechanism.model();
            if artefact.len() != model.dofs().len() {
                return Err(BuildError::Check("there is not one row for each degree of freedom".into()));
            }
            let of_sections =
                |row: &JointStatistics| row.sections.iter().map(SweptSection::area).sum::<f64>();
            if artefact
                .iter()
                .any(|row| (of_sections(row) - row.cross_section).abs() > 1e-9 * row.cross_section)
            {
                return Err(BuildError::Check(
                    "sections have another area than they are said to have".into(),
                ));
            }
            let shapes = load(inputs, context)?;
            let kinematics = Kinematics::new(model.clone());
            let mut rng = context.seed().split("check").rng();
            let mut poses = LinkPoses::default();
            for _ in 0..100 {
                let q: Vec<f64> =
                    model.dofs().iter().map(|d| d.sampling_range()).map(|(a, b)| rng.range(a, b)).collect();
                kinematics.link_poses(&Configuration::from_values(q), &mut poses);
                for (link, parts) in shapes.iter().enumerate() {
                    let link = LinkIdx::new(link);
                    for p in parts.iter().flat_map(|parts| parts.points()) {
                        let jacobian = kinematics.jacobian(&poses, link, p);
                        for (dof, row) in model.dofs().indices().zip(artefact) {
                            let speed = jacobian.column(dof.index()).fixed_rows::<3>(0).norm();
                            if speed > row.reach * (1.0 + 1e-9) + 1e-9 {
                                return Err(BuildError::Check(format!(
                                    "{dof} moves a corner of {link} by {speed} m per unit, not {}",
                                    row.reach
                                )));
                            }
                        }
                    }
                }
            }
            Ok(())
        }
    }

    fn load(inputs: &Robot, context: &Context<'_>) -> Result<Vec<Option<Arc<Parts3>>>, BuildError> {
        let mut shapes = vec![None; inputs.mechanism.model().links().len()];
        for (link, dep) in &inputs.bodies {
            shapes[link.index()] = Some(context.load(dep)?);
        }
        Ok(shapes)
    }

    fn moved_volume(model: &RobotModel, joint: JointIdx, shapes: &[Option<Arc<Parts3>>]) -> f64 {
        let links = model.subtree(model.joints()[joint].child);
        let parts =
            links.iter().filter_map(|link| shapes[link.index()].as_ref()).flat_map(|parts| parts.iter());
        parts.map(ConvexPart::volume).sum()
    }

    /// Directions about an axis are counted in this many bins: the bits of a word.
    const BINS: u32 = u64::BITS;

    /// A swept volume in the frame whose z axis is the joint's.
    struct Section {
        cell: f64,
        /// How far a point of the volume may be from the nearest point of a cell.
        slack: f64,
        cells: Cells,
    }

    enum Cells {
        /// Of a half plane through the axis, (radius, height); each with the directions in which it is filled.
        Turned(BTreeMap<(i32, i32), u64>),
        /// Of a plane across the axis; each with the lowest and highest place along it.
        Slid(BTreeMap<(i32, i32), (f64, f64)>),
    }

    /// The middle of a cell is no farther than this from any point in it, in edges.
    const HALF_DIAGONAL: f64 = 0.8661;

    impl Section {
        fn area(&self) -> f64 {
            let count = match &self.cells {
                Cells::Turned(cells) => cells.len(),
                Cells::Slid(cells) => cells.len(),
            };
            count as f64 * self.cell * self.cell
        }

        fn reach(&self) -> f64 {
            match &self.cells {
                Cells::Turned(cells) => {
                    let farthest = cells.keys().map(|(r, _)| r + 1).max();
                    farthest.map_or(0.0, |r| f64::from(r) * self.cell + self.slack)
                }
                Cells::Slid(_) => 1.0,
            }
        }

        fn rows(&self) -> SweptSection {
            let squares: BTreeMap<(i32, i32), u8> = match &self.cells {
                Cells::Turned(cells) => {
                    cells.iter().map(|(&(r, z), b)| ((z, r), b.count_ones() as u8)).collect()
                }
                Cells::Slid(cells) => cells.keys().map(|&(x, y)| ((y, x), BINS as u8)).collect(),
            };
            let mut rows: Vec<SectionRow> = Vec::new();
            for ((height, place), swept) in squares {
                if rows.last().is_none_or(|row| row.height != height) {
                    rows.push(SectionRow { height, first: place, swept: Vec::new() });
                }
                let row = rows.last_mut().expect("one was there or is now");
                row.swept.resize((place - row.first) as usize, 0);
                row.swept.push(swept);
            }
            SweptSection { cell: self.cell, rows }
        }

        /// Points no farther apart than a cell is wide, in every cell of the volume.
        fn for_each_point(&self, mut f: impl FnMut(Point3<f64>)) {
            let middle = |i: i32| (f64::from(i) + 0.5) * self.cell;
            let steps = |length: f64| (length / self.cell).ceil().max(1.0) as u32;
            let place = |step: u32, count: u32| (f64::from(step) + 0.5) / f64::from(count);
            match &self.cells {
                Cells::Turned(cells) => {
                    let width = std::f64::consts::TAU / f64::from(BINS);
                    for (&(r, z), &bins) in cells {
                        let (radius, height) = (middle(r), middle(z));
                        let count = steps(radius * width);
                        for bin in (0..BINS).filter(|bin| bins >> bin & 1 == 1) {
                            for step in 0..count {
                                let angle = (f64::from(bin) + place(step, count)) * width;
                                let (x, y) = (radius * libm::cos(angle), radius * libm::sin(angle));
                                f(Point3::new(x, y, height));
                            }
                        }
                    }
                }
                Cells::Slid(cells) => {
                    for (&(x, y), &(low, high)) in cells {
                        let count = steps(high - low);
                        for step in 0..count {
                            f(Point3::new(middle(x), middle(y), low + (high - low) * place(step, count)));
                        }
                    }
                }
            }
        }
    }

    /// The factor of a joint's value to that of the degree of freedom that drives it.
    fn factor(model: &RobotModel, joint: JointIdx) -> f64 {
        match model.joints()[joint].drive {
            Drive::Mimic { multiplier, .. } => multiplier.abs(),
            _ => 1.0,
        }
    }

    struct Sweeper<'a> {
        model: &'a RobotModel,
        shapes: &'a [Option<Arc<Parts3>>],
        cell: f64,
        swept: BTreeMap<JointIdx, Section>,
    }

    impl Sweeper<'_> {
        /// The volume that a joint sweeps; those of all joints below it are known.
        fn sweep(&mut self, index: JointIdx) {
            let model = self.model;
            let joint = &model.joints()[index];
            let axis_from_joint = axis_to_z(joint.unit_axis());
            let (low, high) = self.limits(index);
            let cell = self.cell;
            let at = |x: f64| (x / cell).floor() as i32;
            let mut slack = 0.0_f64;
            let mut cells = match joint.motion {
                JointMotion::Prismatic => Cells::Slid(BTreeMap::new()),
                _ => Cells::Turned(BTreeMap::new()),
            };
            let mut add = |p: Point3<f64>| match &mut cells {
                Cells::Turned(cells) => {
                    let radius = (p.x * p.x + p.y * p.y).sqrt();
                    let angle = libm::atan2(p.y, p.x);
                    *cells.entry((at(radius), at(p.z))).or_insert(0) |= bins(angle + low, angle + high);
                }
                Cells::Slid(cells) => {
                    let span = cells.entry((at(p.x), at(p.y))).or_insert((f64::INFINITY, f64::NEG_INFINITY));
                    *span = (span.0.min(p.z + low), span.1.max(p.z + high));
                }
            };
            // The rigid body below the joint: its links, and the volumes of the joints that hang on them.
            let mut open = vec![(joint.child, axis_from_joint)];
            while let Some((link, axis_from_link)) = open.pop() {
                if let Some(parts) = &self.shapes[link.index()] {
                    for part in parts.iter() {
                        fill(part, cell, |p| add(axis_from_link * p));
                    }
                }
                for &child in &model.links()[link].child_joints {
                    let below = &model.joints()[child];
                    let axis_from_below = axis_from_link * below.parent_from_joint();
                    match self.swept.get(&child) {
                        None => open.push((below.child, axis_from_below)),
                        Some(swept) => {
                            let axis_from_swept = axis_from_below * axis_to_z(below.unit_axis()).inverse();
                            swept.for_each_point(|p| add(axis_from_swept * p));
                            slack = slack.max(swept.slack + HALF_DIAGONAL * cell);
                        }
                    }
                }
            }
            self.swept.insert(index, Section { cell, slack, cells });
        }

        /// Smallest and largest value of a joint; a full turn where it has none, nothing where a slide has none.
        fn limits(&self, joint: JointIdx) -> (f64, f64) {
            let joint = &self.model.joints()[joint];
            let (dof, factor, offset) = match joint.drive {
                Drive::Fixed => return (0.0, 0.0),
                Drive::Dof(dof) => (dof, 1.0, 0.0),
                Drive::Mimic { dof, multiplier, offset } => (dof, multiplier, offset),
            };
            let (low, high) = self.model.dofs()[dof].sampling_range();
            let (a, b) = (factor * low + offset, factor * high + offset);
            match (a.is_finite() && b.is_finite(), joint.motion) {
                (true, _) => (a.min(b), a.max(b)),
                (false, JointMotion::Prismatic) => (0.0, 0.0),
                (false, _) => (-std::f64::consts::PI, std::f64::consts::PI),
            }
        }
    }

    /// The turn that takes a joint's axis to z.
    fn axis_to_z(axis: &Unit<Vector3<f64>>) -> robotc_core::Pose {
        let turn = UnitQuaternion::rotation_between(axis, &Vector3::z());
        let turn =
            turn.unwrap_or_else(|| UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI));
        robotc_core::Pose::from_parts(nalgebra::Translation3::identity(), turn)
    }

    /// The bins of directions from one angle to a larger one.
    fn bins(from: f64, to: f64) -> u64 {
        let scale = f64::from(BINS) / std::f64::consts::TAU;
        let (first, last) = ((from * scale).floor() as i64, (to * scale).floor() as i64);
        if last - first >= i64::from(BINS) - 1 {
            return u64::MAX;
        }
        (first..=last).fold(0, |word, bin| word | 1 << bin.rem_euclid(i64::from(BINS)))
    }

    /// Points of a convex part: its corners, and a lattice inside with this spacing.
    fn fill(part: &ConvexPart, spacing: f64, mut f: impl FnMut(Point3<f64>)) {
        part.points().iter().for_each(|p| f(*p));
        let bounds = part.bounds();
        let steps = bounds.size().map(|x| (x / spacing).floor() as u32);
        for i in 0..=steps.x {
            for j in 0..=steps.y {
                for k in 0..=steps.z {
                    let offset = Vector3::new(f64::from(i), f64::from(j), f64::from(k)) * spacing;
                    let p = bounds.low + offset;
                    if part.contains(&p) {
                        f(p);
                    }
                }
            }
        }
    }
}
