//! Narrow views of a project: what an artefact may read, and what its key therefore covers.
//!
//! A view holds copies with names taken away, so that renaming changes no key, and numbers as they were written.

use std::sync::Arc;

use robotc_core::ids::{DofIdx, Idx, JointIdx, LinkIdx};
use robotc_core::model::{
    ChainError, Drive, DynamicLimits, Geometry, Joint, JointMotion, RobotBuilder, RobotModel, Shape, TriMesh,
};
use robotc_core::robot::Gripper;

use crate::key::{Canonical, KeyHasher};
use crate::record::Parts;

/// Whether a [`Mechanism`] holds the limits of its joints.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Limits {
    /// It does.
    Kept,
    /// Of joints that slide; those that turn are unlimited.
    Sliding,
    /// All joints are unlimited.
    Dropped,
}

impl Limits {
    fn keeps(self, motion: JointMotion) -> bool {
        match self {
            Self::Kept => true,
            Self::Sliding => motion == JointMotion::Prismatic,
            Self::Dropped => false,
        }
    }
}

/// The links and joints of a robot, or of a chain of it, as a robot without shapes, masses, speeds and names.
///
/// Links are called `l0`, `l1` ... by position; joints `q1`, `q2` ... where they have a degree of freedom of their own, and
/// `j0`, `j1` ... by position where they do not.
#[derive(Debug, Clone)]
pub struct Mechanism {
    model: Arc<RobotModel>,
    limits: Limits,
    /// What people call the joints.
    joint_names: Vec<String>,
}

impl Mechanism {
    /// All links and joints. Links, joints and degrees of freedom keep their indices.
    pub fn whole(model: &RobotModel, limits: Limits) -> Self {
        let links: Vec<LinkIdx> = model.links().indices().collect();
        Self::of(model, &links, limits).expect("a robot does not mimic joints outside of itself")
    }

    /// The links from `base` to `tip`, which become the first and the last.
    pub fn chain(
        model: &RobotModel,
        base: LinkIdx,
        tip: LinkIdx,
        limits: Limits,
    ) -> Result<Self, ChainError> {
        let name = |link: LinkIdx| model.links()[link].name.clone();
        let joints = model
            .joints_between(base, tip)
            .ok_or_else(|| ChainError::NotBelow { base: name(base), tip: name(tip) })?;
        if joints.iter().all(|&j| model.joints()[j].motion == JointMotion::Fixed) {
            return Err(ChainError::NoJoints { base: name(base), tip: name(tip) });
        }
        let links: Vec<LinkIdx> =
            std::iter::once(base).chain(joints.iter().map(|&j| model.joints()[j].child)).collect();
        Self::of(model, &links, limits)
    }

    /// The links from `base` to `tip` and all that are rigid with one of them: an arm with what it carries, but without what
    /// moves on joints of its own, such as fingers. Comes with the indices that `base` and `tip` have there, and with the
    /// links of `model`, in the order in which they are there.
    pub fn arm(
        model: &RobotModel,
        base: LinkIdx,
        tip: LinkIdx,
        limits: Limits,
    ) -> Result<(Self, [LinkIdx; 2], Vec<LinkIdx>), ChainError> {
        let name = |link: LinkIdx| model.links()[link].name.clone();
        let joints = model
            .joints_between(base, tip)
            .ok_or_else(|| ChainError::NotBelow { base: name(base), tip: name(tip) })?;
        let mut links = model.rigid_group(base);
        for joint in joints {
            links.extend(model.rigid_group(model.joints()[joint].child));
        }
        links.sort();
        links.dedup();
        let place = |wanted: LinkIdx| {
            let position = links.iter().position(|&l| l == wanted);
            LinkIdx::new(position.expect("a link is rigid with itself"))
        };
        Ok((Self::of(model, &links, limits)?, [place(base), place(tip)], links))
    }

    /// The links of a gripper: those rigid with its palm, and all below it. The gripper comes back with the indices that
    /// its links and degrees of freedom have there.
    pub fn hand(model: &RobotModel, gripper: &Gripper) -> Result<(Self, Gripper, Vec<LinkIdx>), ChainError> {
        let mut links = model.rigid_group(gripper.palm);
        links.extend(model.subtree(gripper.palm));
        links.sort();
        links.dedup();
        let hand = Self::of(model, &links, Limits::Kept)?;
        let link = |wanted: LinkIdx| links.iter().position(|&l| l == wanted).map(LinkIdx::new);
        let outside = |name: &str| ChainError::NotBelow {
            base: model.links()[gripper.palm].name.clone(),
            tip: name.to_owned(),
        };
        let dof = |wanted: DofIdx| {
            let name = &model.dofs()[wanted].name;
            let joint = hand.joint_names.iter().position(|joint| joint == name).map(JointIdx::new);
            joint.and_then(|j| hand.model.driving_dof(j)).ok_or_else(|| outside(name))
        };
        let finger = |wanted: LinkIdx| link(wanted).ok_or_else(|| outside(&model.links()[wanted].name));
        let gripper = Gripper {
            name: String::new(),
            palm: link(gripper.palm).expect("a palm is rigid with itself"),
            fingers: gripper.fingers.iter().map(|&l| finger(l)).collect::<Result<_, _>>()?,
            dofs: gripper.dofs.iter().map(|&d| dof(d)).collect::<Result<_, _>>()?,
            ..gripper.clone()
        };
        Ok((hand, gripper, links))
    }

    /// The links that are rigid with a link, in the order in which they are in `model`.
    pub fn rigid(model: &RobotModel, link: LinkIdx) -> Result<(Self, Vec<LinkIdx>), ChainError> {
        let links = model.rigid_group(link);
        Ok((Self::of(model, &links, Limits::Dropped)?, links))
    }

    /// The given links with the joints between them.
    fn of(model: &RobotModel, links: &[LinkIdx], limits: Limits) -> Result<Self, ChainError> {
        let mut builder = RobotBuilder::new("mechanism");
        let link_name = |link: LinkIdx| links.iter().position(|&l| l == link).map(|i| format!("l{i}"));
        for i in 0..links.len() {
            builder.link(format!("l{i}"), Vec::new(), Vec::new(), None);
        }
        let kept: Vec<_> = model
            .joints()
            .enumerate()
            .filter_map(|(index, joint)| {
                Some((index, joint, link_name(joint.parent)?, link_name(joint.child)?))
            })
            .collect();
        let has_dof = |joint: &Joint| matches!(joint.drive, Drive::Dof(_));
        let driving = kept.iter().filter(|(_, joint, ..)| has_dof(joint)).map(|&(index, ..)| index);
        let driving: Vec<JointIdx> = driving.collect();
        let joint_name =
            |index: JointIdx| driving.iter().position(|&j| j == index).map(|i| format!("q{}", i + 1));
        for (i, (index, joint, parent, child)) in kept.iter().enumerate() {
            let mut bounds = (f64::NEG_INFINITY, f64::INFINITY, joint.motion == JointMotion::Revolute);
            let mut mimic = None;
            match joint.drive {
                Drive::Fixed => {}
                Drive::Dof(dof) => {
                    let dof = &model.dofs()[dof];
                    if limits.keeps(joint.motion) {
                        bounds = (dof.lower, dof.upper, dof.continuous);
                    }
                }
                Drive::Mimic { dof, multiplier, offset } => {
                    let target =
                        joint_name(model.dofs()[dof].joint).ok_or_else(|| ChainError::MimicOutside {
                            joint: joint.name.clone(),
                            target: model.dofs()[dof].name.clone(),
                        })?;
                    mimic = Some((target, multiplier, offset));
                }
            }
            let (lower, upper, continuous) = bounds;
            let limits = (lower, upper, continuous, DynamicLimits::DEFAULT);
            let name = joint_name(*index).unwrap_or_else(|| format!("j{i}"));
            builder.moving(&name, joint.motion, parent, child, joint.origin, joint.axis, limits, mimic);
        }
        let joint_names = kept.iter().map(|(_, joint, ..)| joint.name.clone()).collect();
        let model = builder.build().expect("connected links of a robot are a robot");
        Ok(Self { model: Arc::new(model), limits, joint_names })
    }

    /// The reduced robot.
    pub fn model(&self) -> &Arc<RobotModel> {
        &self.model
    }

    /// The last link: the tip of a chain.
    pub fn tip(&self) -> LinkIdx {
        LinkIdx::new(self.model.links().len() - 1)
    }

    /// Adds all of it to a key.
    pub fn key_parts(&self, parts: &mut Parts) {
        for (joint, name) in self.model.joints().iter().zip(&self.joint_names) {
            let drive = match joint.drive {
                Drive::Fixed => None,
                Drive::Dof(dof) => Some((dof.index(), 1.0, 0.0)),
                Drive::Mimic { dof, multiplier, offset } => Some((dof.index(), multiplier, offset)),
            };
            let place = (joint.parent.index(), joint.child.index(), joint.origin);
            let axis = (joint.motion != JointMotion::Fixed).then_some(joint.axis);
            parts.add("joint", name, &(place, joint.motion, axis, drive));
        }
        for dof in self.model.dofs() {
            if self.limits.keeps(self.model.joints()[dof.joint].motion) {
                let name = &self.joint_names[dof.joint.index()];
                let bound = |x: f64| x.is_finite().then_some(x);
                parts.add("limits", name, &(bound(dof.lower), bound(dof.upper), dof.continuous));
            }
        }
    }
}

/// Shapes without colours and file names.
#[derive(Debug, Clone)]
pub struct Shapes {
    elements: Vec<Geometry>,
}

impl Shapes {
    /// These elements.
    pub fn of(elements: &[Geometry]) -> Self {
        let plain = |element: &Geometry| {
            let mut element = Geometry { colour: None, ..element.clone() };
            if let Shape::Mesh { uri, .. } | Shape::Cloud { uri, .. } | Shape::HeightField { uri, .. } =
                &mut element.shape
            {
                uri.clear();
            }
            element
        };
        Self { elements: elements.iter().map(plain).collect() }
    }

    /// All elements as one mesh.
    pub fn surface(&self) -> TriMesh {
        robotc_core::geom::surface(&self.elements)
    }

    /// The elements.
    pub fn elements(&self) -> &[Geometry] {
        &self.elements
    }

    /// Adds all of it to a key; `name` is what people call the body.
    pub fn key_parts(&self, name: &str, parts: &mut Parts) {
        parts.add("shape", name, self.elements.as_slice());
    }
}

impl Canonical for Geometry {
    fn write(&self, out: &mut KeyHasher) {
        out.add(&self.origin);
        match &self.shape {
            Shape::Box { size } => out.add("box").add(size),
            Shape::Cylinder { radius, length } => out.add("cylinder").add(&(*radius, *length)),
            Shape::Capsule { radius, length } => out.add("capsule").add(&(*radius, *length)),
            Shape::Sphere { radius } => out.add("sphere").add(radius),
            Shape::Mesh { mesh, .. } => out.add("mesh").add(&**mesh),
            Shape::Cloud { cloud, .. } => {
                let points = cloud.points().iter().flat_map(|p| [p.x, p.y, p.z]);
                out.add("cloud").add(&cloud.radius()).numbers(points)
            }
            Shape::HeightField { field, .. } => {
                let (spacing, floor) = (field.spacing(), field.floor());
                out.add("height field").add(&(field.columns() as u64)).add(&spacing).add(&floor);
                let known: Vec<u8> = field.heights().iter().map(|h| u8::from(!h.is_nan())).collect();
                out.bytes(&known);
                out.numbers(field.heights().iter().map(|h| if h.is_nan() { 0.0 } else { *h }))
            }
        };
    }
}

impl Canonical for TriMesh {
    fn write(&self, out: &mut KeyHasher) {
        out.numbers(self.vertices.iter().flat_map(|v| [v.x, v.y, v.z]));
        out.bytes(&self.faces.iter().flatten().flat_map(|v| v.to_le_bytes()).collect::<Vec<u8>>());
    }
}

#[cfg(test)]
mod tests {
    use robotc_core::model::Origin;

    use super::*;

    fn arm() -> RobotModel {
        let mut builder = RobotBuilder::new("r");
        for name in ["base", "upper", "lower", "finger"] {
            builder.link(name, Vec::new(), Vec::new(), None);
        }
        let limits = (-1.0, 2.0, false, DynamicLimits::DEFAULT);
        let turn = JointMotion::Revolute;
        let x = [1.0, 0.0, 0.0];
        builder.moving("a", turn, "base", "upper", Origin::default(), x, limits, None);
        builder.moving("b", turn, "upper", "lower", Origin::default(), x, limits, None);
        let follow = Some(("a".to_owned(), 2.0, 0.5));
        builder.moving("c", turn, "lower", "finger", Origin::default(), x, limits, follow);
        builder.build().expect("a robot")
    }

    #[test]
    fn a_chain_keeps_what_moves_it_and_nothing_else() {
        let model = arm();
        let link = |name| model.link_named(name).expect("exists");
        let chain = Mechanism::chain(&model, link("base"), link("lower"), Limits::Dropped).expect("a chain");
        assert_eq!(chain.model().links().len(), 3);
        assert!(chain.model().dofs().iter().all(|d| d.lower == f64::NEG_INFINITY));
        let outside = Mechanism::chain(&model, link("upper"), link("finger"), Limits::Kept);
        assert_eq!(
            outside.expect_err("joint a is not in it"),
            ChainError::MimicOutside { joint: "c".into(), target: "a".into() }
        );
        let above = Mechanism::chain(&model, link("lower"), link("base"), Limits::Kept);
        assert!(matches!(above, Err(ChainError::NotBelow { .. })));
    }

    #[test]
    fn the_whole_keeps_indices_and_mimicry() {
        let model = arm();
        let whole = Mechanism::whole(&model, Limits::Kept);
        for (a, b) in model.joints().iter().zip(whole.model().joints()) {
            assert_eq!((a.parent, a.child, a.drive), (b.parent, b.child, b.drive));
        }
        let bounds = |m: &RobotModel| m.dofs().iter().map(|d| (d.lower, d.upper)).collect::<Vec<_>>();
        assert_eq!(bounds(&model), bounds(whole.model()));
    }
}
