//! A hand and an object as rigid bodies. rapier stays behind this file.
//!
//! The palm stands still; what moves on joints of its own is a body, and so is the object, of one kilogram: with forces given
//! in weights of the object, its mass does not matter. A drive pushes with a constant force. Joints that share a drive, such as two
//! jaws, are pulled to their common value by implicit springs: stiff against one joint alone, and free when all move together.

use nalgebra::{Point3, UnitQuaternion, Vector3};
use rapier3d_f64::dynamics::{
    FrictionModel, GenericJoint, GenericJointBuilder, ImpulseJointHandle, IntegrationParameters,
    JointAxesMask, JointAxis, MassProperties, MotorModel, RigidBodyBuilder, RigidBodyHandle,
    SpringCoefficients,
};
use rapier3d_f64::geometry::{ColliderBuilder, Group, InteractionGroups, InteractionTestMode, SharedShape};
use rapier3d_f64::math;
use rapier3d_f64::pipeline::PhysicsWorld;
use robotc_core::Pose;
use robotc_core::geom::{Aabb, ConvexPart, ConvexParts};
use robotc_core::ids::Idx;
use robotc_core::model::{Drive as JointDrive, Joint as ModelJoint, JointMotion, RobotModel};

use crate::kinds::grip::hand::Hand;

/// Weight of the object, newtons.
const WEIGHT: f64 = 9.81;
/// Mass of a finger link, kilograms.
const LINK_MASS: f64 = 0.3;
/// How far a finger gives way when the others of its drive stand still and the drive pushes it alone, metres.
const PLAY: f64 = 5e-4;
/// Speed of a finger that nothing stops, metres a second.
const SPEED: f64 = 0.2;
/// Seconds after the fingers could have closed before anything pulls.
const SETTLING: f64 = 0.15;
/// Steps between two looks whether the object is still there.
const GLANCE: usize = 10;
/// How firmly surfaces push each other apart, hertz: pads give way by tenths of a millimetre.
const CONTACT_FREQUENCY: f64 = 120.0;

/// How a grasp is shaken.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct ShakeOptions {
    /// Force of a drive at the farthest point that it moves, in weights of the object.
    pub(super) squeeze: f64,
    /// Pull, metres a second squared.
    pub(super) pull: f64,
    /// How long it pulls in each direction, seconds.
    pub(super) seconds: f64,
    /// Step of the simulation, seconds.
    pub(super) step: f64,
    /// How far the object may go, metres.
    pub(super) lost: f64,
    /// Room between open fingers and what they close on, metres.
    pub(super) room: f64,
}

/// One try: where the hand stands, and what it holds.
pub(super) struct Try<'a> {
    /// The palm, in the frame of the object as it was thought to stand.
    pub(super) object_from_palm: Pose,
    /// Finger values when closed, and those to approach with, in the order of the gripper's degrees of freedom.
    pub(super) closed: &'a [f64],
    pub(super) open: &'a [f64],
    /// Where the object really stands.
    pub(super) object_from_displaced: Pose,
    /// Coulomb friction of all that touches.
    pub(super) friction: f64,
}

/// A hand and an object, ready to be tried.
pub(super) struct Rig {
    /// The first is that of the palm.
    bodies: Vec<Body>,
    /// Parents first.
    joints: Vec<Joint>,
    /// In the order of the gripper's degrees of freedom.
    drives: Vec<Drive>,
    palm_from_root: Pose,
    object: Vec<SharedShape>,
    /// Kilograms for a cubic metre.
    density: f64,
    centre: Point3<f64>,
    options: ShakeOptions,
}

/// What moves as one.
#[derive(Default)]
struct Body {
    shapes: Vec<(math::Pose, SharedShape)>,
    bounds: Option<Aabb>,
}

struct Joint {
    parent: usize,
    child: usize,
    /// From the parent's body to the link that the joint hangs on.
    body_from_parent: Pose,
    described: ModelJoint,
    /// The drive that moves it, times, plus; one that none moves stays at the last.
    drive: Option<usize>,
    multiplier: f64,
    offset: f64,
    limits: [f64; 2],
}

struct Drive {
    /// Which way it closes; zero when it holds its value.
    closing: f64,
    /// Metres that a point moves for one unit of the drive, at most.
    lever: f64,
    /// Sum of the squared multipliers of its joints.
    joints: f64,
}

impl Rig {
    /// Parts and centre of mass of the object in its frame; `model` is that of the hand. `None` when the object has no volume.
    pub(super) fn new(
        model: &RobotModel,
        hand: &Hand,
        object: &ConvexParts,
        centre: Point3<f64>,
        options: ShakeOptions,
    ) -> Option<Self> {
        let gripper = hand.gripper();
        let mut bodies = vec![Body::default()];
        let mut joints: Vec<Joint> = Vec::new();
        let mut body_from: Vec<(usize, Pose)> = vec![(0, Pose::identity()); model.links().len()];
        let root = model.links().indices().find(|&link| model.links()[link].parent_joint.is_none())?;
        for link in model.subtree(root).into_iter().skip(1) {
            let joint = &model.joints()[model.links()[link].parent_joint?];
            let (parent, body_from_parent) = body_from[joint.parent.index()];
            body_from[link.index()] = if joint.motion == JointMotion::Fixed {
                (parent, body_from_parent * joint.parent_from_child(0.0))
            } else {
                joints.push(Joint::of(model, hand, joint, parent, bodies.len(), body_from_parent));
                bodies.push(Body::default());
                (bodies.len() - 1, Pose::identity())
            };
        }
        for link in &hand.links {
            let (body, body_from_link) = &body_from[link.link.index()];
            let body = &mut bodies[*body];
            let shape = |part: &ConvexPart| Some((pose(body_from_link), shape(part)?));
            body.shapes.extend(link.parts.iter().filter_map(shape));
            body.bounds = link.parts.bounds().map(|b| body.bounds.map_or(b, |all| all.union(&b)));
        }
        let drives = (0..gripper.dofs.len()).map(|i| {
            let lever = hand.travels(i).iter().map(|t| t.most_speed).fold(0.0, f64::max);
            let moved = joints.iter().filter(|joint| joint.drive == Some(i));
            let sum: f64 = moved.map(|joint| joint.multiplier * joint.multiplier).sum();
            Drive {
                closing: gripper.closing[i].signum() * f64::from(gripper.closing[i] != 0.0),
                lever,
                joints: sum,
            }
        });
        let volume: f64 = object.iter().map(ConvexPart::volume).sum();
        let drives = drives.collect();
        let palm_from_root = body_from[gripper.palm.index()].1.inverse();
        let object: Vec<SharedShape> = object.iter().filter_map(shape).collect();
        let rig =
            Self { bodies, joints, drives, palm_from_root, object, density: 1.0 / volume, centre, options };
        (volume > 0.0 && !rig.object.is_empty()).then_some(rig)
    }

    /// Closes the hand and pulls along each direction in turn, in the frame of the object as it was thought to stand; how many of them
    /// it withstood before the object was gone.
    pub(super) fn withstood(&self, attempt: &Try<'_>, directions: &[Vector3<f64>]) -> u32 {
        let mut scene = Scene::new(self, attempt);
        let ShakeOptions { pull, seconds, step, lost, room, .. } = self.options;
        scene.advance((((room / SPEED) + SETTLING) / step) as usize, |_| true);
        let held_at = scene.centre();
        let held = |scene: &Scene<'_>| {
            let gone = (scene.centre() - held_at).norm();
            gone.is_finite() && gone < lost
        };
        let mut count = 0;
        for direction in directions {
            scene.world.gravity = vector(&(direction * pull));
            if !scene.advance((seconds / step) as usize, held) {
                break;
            }
            count += 1;
        }
        count
    }

    /// Finger values a little more open than closed.
    fn start(&self, attempt: &Try<'_>) -> Vec<f64> {
        let value = |(i, drive): (usize, &Drive)| {
            if drive.closing == 0.0 {
                return attempt.open[i];
            }
            let room = self.options.room / drive.lever.max(1e-6);
            attempt.closed[i] + (attempt.open[i] - attempt.closed[i]).clamp(-room, room)
        };
        self.drives.iter().enumerate().map(value).collect()
    }
}

impl Joint {
    fn of(
        model: &RobotModel,
        hand: &Hand,
        joint: &ModelJoint,
        parent: usize,
        child: usize,
        body_from_parent: Pose,
    ) -> Self {
        let (dof, multiplier, offset) = match joint.drive {
            JointDrive::Fixed => (None, 0.0, 0.0),
            JointDrive::Dof(dof) => (Some(dof), 1.0, 0.0),
            JointDrive::Mimic { dof, multiplier, offset } => (Some(dof), multiplier, offset),
        };
        let (low, high) = dof.map_or((0.0, 0.0), |dof| model.dofs()[dof].sampling_range());
        let ends = [multiplier * low + offset, multiplier * high + offset];
        let limits = [ends[0].min(ends[1]), ends[0].max(ends[1])];
        let drive = dof.and_then(|dof| hand.gripper().dofs.iter().position(|&d| d == dof));
        let (multiplier, offset) = match drive {
            Some(_) => (multiplier, offset),
            None => (0.0, 0.0_f64.clamp(limits[0], limits[1])),
        };
        let described = joint.clone();
        Self { parent, child, body_from_parent, described, drive, multiplier, offset, limits }
    }

    fn value(&self, values: &[f64]) -> f64 {
        self.drive.map_or(0.0, |drive| self.multiplier * values[drive]) + self.offset
    }

    fn slides(&self) -> bool {
        self.described.motion == JointMotion::Prismatic
    }

    fn free_axis(&self) -> JointAxis {
        if self.slides() { JointAxis::LinX } else { JointAxis::AngX }
    }

    /// From the parent's body to the joint at value zero.
    fn body_from_joint(&self) -> Pose {
        self.body_from_parent * self.described.parent_from_joint()
    }

    /// Its value, from where its bodies are.
    fn measured(&self, world_from_parent: &Pose, world_from_child: &Pose) -> f64 {
        let joint_from_child = (world_from_parent * self.body_from_joint()).inv_mul(world_from_child);
        let axis = self.described.unit_axis();
        if self.slides() {
            return joint_from_child.translation.vector.dot(axis);
        }
        let turn = joint_from_child.rotation;
        let half = libm::atan2(turn.imag().dot(axis), turn.w);
        let angle = 2.0 * half;
        let full = std::f64::consts::TAU;
        // The value of its range, where that is longer than a turn the nearest to its middle.
        let middle = 0.5 * (self.limits[0] + self.limits[1]);
        angle - full * ((angle - middle) / full).round()
    }

    fn build(&self) -> GenericJoint {
        let locked = if self.slides() {
            JointAxesMask::LOCKED_PRISMATIC_AXES
        } else {
            JointAxesMask::LOCKED_REVOLUTE_AXES
        };
        // Of the frames of a joint here, the first axis is the free one.
        let aligned = UnitQuaternion::rotation_between_axis(&Vector3::x_axis(), self.described.unit_axis())
            .unwrap_or_else(|| UnitQuaternion::from_axis_angle(&Vector3::z_axis(), std::f64::consts::PI));
        let aligned = Pose::from_parts(nalgebra::Translation3::identity(), aligned);
        GenericJointBuilder::new(locked)
            .local_frame1(pose(&(self.body_from_joint() * aligned)))
            .local_frame2(pose(&aligned))
            .contacts_enabled(false)
            .limits(self.free_axis(), self.limits)
            .motor_model(self.free_axis(), MotorModel::ForceBased)
            .build()
    }
}

/// A rig while it moves.
struct Scene<'a> {
    rig: &'a Rig,
    world: PhysicsWorld,
    bodies: Vec<RigidBodyHandle>,
    joints: Vec<ImpulseJointHandle>,
    object: RigidBodyHandle,
    /// Where each drive was at first.
    start: Vec<f64>,
}

impl<'a> Scene<'a> {
    fn new(rig: &'a Rig, attempt: &Try<'_>) -> Self {
        let mut world = PhysicsWorld::new();
        world.gravity = math::Vector::ZERO;
        let softness = SpringCoefficients::new(CONTACT_FREQUENCY, 5.0);
        world.integration_parameters = IntegrationParameters {
            dt: rig.options.step,
            length_unit: 0.1,
            contact_softness: softness,
            static_contact_softness: softness,
            contact_recycling: false,
            num_internal_pgs_iterations: 8,
            max_ccd_substeps: 0,
            friction_model: FrictionModel::Coulomb,
            ..IntegrationParameters::default()
        };
        let groups =
            |member: Group, with: Group| InteractionGroups::new(member, with, InteractionTestMode::And);
        let collider = |shape: &SharedShape| ColliderBuilder::new(shape.clone()).friction(attempt.friction);
        let start = rig.start(attempt);
        let mut placed = vec![attempt.object_from_palm * rig.palm_from_root; rig.bodies.len()];
        for joint in &rig.joints {
            let value = joint.value(&start);
            let body_from_child = joint.body_from_parent * joint.described.parent_from_child(value);
            placed[joint.child] = placed[joint.parent] * body_from_child;
        }
        let mut bodies = Vec::with_capacity(rig.bodies.len());
        for (i, body) in rig.bodies.iter().enumerate() {
            let built = if i == 0 { RigidBodyBuilder::fixed() } else { RigidBodyBuilder::dynamic() };
            let handle = world.insert_body(
                built
                    .pose(pose(&placed[i]))
                    .gravity_scale(0.0)
                    .can_sleep(false)
                    .additional_mass_properties(body.mass_properties()),
            );
            for (body_from_shape, shape) in &body.shapes {
                let built = collider(shape).position(*body_from_shape).density(0.0);
                let built = built.collision_groups(groups(Group::GROUP_1, Group::GROUP_2));
                world.insert_collider(built, Some(handle));
            }
            bodies.push(handle);
        }
        let built = RigidBodyBuilder::dynamic().pose(pose(&attempt.object_from_displaced)).can_sleep(false);
        let object = world.insert_body(built);
        for shape in &rig.object {
            let built = collider(shape).density(rig.density);
            world.insert_collider(
                built.collision_groups(groups(Group::GROUP_2, Group::GROUP_1)),
                Some(object),
            );
        }
        let insert = |joint: &Joint| {
            world.impulse_joints.insert(bodies[joint.parent], bodies[joint.child], joint.build(), true)
        };
        let joints = rig.joints.iter().map(insert).collect();
        Self { rig, world, bodies, joints, object, start }
    }

    /// Takes steps for as long as `on` says so every now and then; whether it always did.
    fn advance(&mut self, steps: usize, on: impl Fn(&Self) -> bool) -> bool {
        for step in 1..=steps {
            self.drive();
            self.world.step();
            if (step % GLANCE == 0 || step == steps) && !on(self) {
                return false;
            }
        }
        true
    }

    /// Pushes every joint, and pulls it to the common value of its drive.
    fn drive(&mut self) {
        let rig = self.rig;
        let placed: Vec<Pose> =
            self.bodies.iter().map(|&body| from_pose(self.world.bodies[body].position())).collect();
        let mut common = self.start.clone();
        for (i, drive) in rig.drives.iter().enumerate().filter(|(_, drive)| drive.closing != 0.0) {
            let of_drive = rig.joints.iter().filter(|joint| joint.drive == Some(i));
            let sum: f64 = of_drive
                .map(|j| j.multiplier * (j.measured(&placed[j.parent], &placed[j.child]) - j.offset))
                .sum();
            // A drive whose every joint has the multiplier zero moves nothing.
            common[i] = if drive.joints > 0.0 { sum / drive.joints } else { common[i] };
        }
        for &body in &self.bodies {
            self.world.bodies[body].reset_forces(true);
            self.world.bodies[body].reset_torques(true);
        }
        let force = rig.options.squeeze * WEIGHT;
        for (i, joint) in rig.joints.iter().enumerate() {
            let drive = joint.drive.map(|i| &rig.drives[i]);
            let lever = drive.map_or(0.1, |drive| drive.lever).max(1e-3);
            let stiffness = force * lever * lever / PLAY;
            let closes = drive.filter(|drive| drive.closing != 0.0 && drive.joints > 0.0);
            let damping = match closes {
                Some(drive) => {
                    let share = joint.multiplier / drive.joints * drive.closing * force * lever;
                    self.push(joint, &placed, share);
                    force * lever * lever / (SPEED * drive.joints)
                }
                None => 0.01 * stiffness,
            };
            if let Some(built) = self.world.impulse_joints.get_mut(self.joints[i], false) {
                built.data.set_motor(joint.free_axis(), joint.value(&common), 0.0, stiffness, damping);
            }
        }
    }

    /// Pushes both bodies of a joint along its axis, or turns them about it.
    fn push(&mut self, joint: &Joint, placed: &[Pose], share: f64) {
        let axis = placed[joint.child].rotation * joint.described.unit_axis().into_inner() * share;
        let (child, parent) = (self.bodies[joint.child], self.bodies[joint.parent]);
        for (body, way) in [(child, 1.0), (parent, -1.0)] {
            let body = &mut self.world.bodies[body];
            match joint.described.motion {
                JointMotion::Prismatic => body.add_force(vector(&(axis * way)), true),
                _ => body.add_torque(vector(&(axis * way)), true),
            }
        }
    }

    /// The centre of mass of the object.
    fn centre(&self) -> Point3<f64> {
        from_pose(self.world.bodies[self.object].position()) * self.rig.centre
    }
}

impl Body {
    /// Those of a ball of its size in its middle.
    fn mass_properties(&self) -> MassProperties {
        let (centre, diagonal) = self.bounds.map_or((Point3::origin(), 0.0), |b| (b.centre(), b.diagonal()));
        let radius = (0.25 * diagonal).max(0.01);
        let inertia = LINK_MASS * radius * radius;
        MassProperties::new(vector(&centre.coords), LINK_MASS, math::Vector::splat(inertia))
    }
}

fn shape(part: &ConvexPart) -> Option<SharedShape> {
    let points: Vec<math::Vector> = part.points().iter().map(|p| vector(&p.coords)).collect();
    SharedShape::convex_mesh(points.clone(), part.triangles()).or_else(|| SharedShape::convex_hull(&points))
}

fn vector(v: &Vector3<f64>) -> math::Vector {
    math::Vector::new(v.x, v.y, v.z)
}

fn pose(p: &Pose) -> math::Pose {
    let q = p.rotation.coords;
    math::Pose::from_parts(vector(&p.translation.vector), math::Rotation::from_xyzw(q.x, q.y, q.z, q.w))
}

fn from_pose(p: &math::Pose) -> Pose {
    let (t, q) = (p.translation, p.rotation);
    let turn = UnitQuaternion::new_normalize(nalgebra::Quaternion::new(q.w, q.x, q.y, q.z));
    Pose::from_parts(nalgebra::Translation3::new(t.x, t.y, t.z), turn)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kinds::grip::jaws::jaws;
    use robotc_core::geom::box_part;

    /// How many of the pulls along both ways of each axis jaws withstand that close on a box at this place of their tool.
    fn withstood(object_from_tool: Pose, displaced: Pose, friction: f64, squeeze: f64) -> u32 {
        let (kinematics, gripper, parts) = jaws();
        let hand =
            Hand::new(&kinematics, &gripper, |l| parts.iter().find(|(link, _)| *link == l).map(|(_, p)| p));
        let object = ConvexParts::new(vec![box_part(Vector3::new(0.1, 0.05, 0.06))]);
        let options =
            ShakeOptions { squeeze, pull: 10.0, seconds: 0.25, step: 0.002, lost: 0.05, room: 0.03 };
        let rig = Rig::new(kinematics.model(), &hand, &object, Point3::origin(), options).unwrap();
        let ways: Vec<Vector3<f64>> =
            [1.0, -1.0].iter().flat_map(|s| (0..3).map(move |k| Vector3::ith(k, *s))).collect();
        let attempt = Try {
            object_from_palm: object_from_tool * gripper.palm_from_tool.inverse(),
            closed: &[0.025],
            open: &[0.04],
            object_from_displaced: displaced,
            friction,
        };
        let count = rig.withstood(&attempt, &ways);
        assert_eq!(count, rig.withstood(&attempt, &ways));
        count
    }

    #[test]
    fn jaws_hold_a_box_by_friction_and_force() {
        let (middle, exact) = (Pose::identity(), Pose::identity());
        assert_eq!(withstood(middle, exact, 0.5, 10.0), 6);
        // The drive pushes both jaws with ten weights: five each, of which friction bears two times a hundredth.
        let slippery = withstood(middle, exact, 0.01, 10.0);
        assert!(slippery < 6, "{slippery}");
        let weak = withstood(middle, exact, 0.5, 0.5);
        assert!(weak < 6, "{weak}");
    }

    #[test]
    fn jaws_centre_what_is_displaced() {
        for y in [-0.008, 0.008] {
            assert_eq!(withstood(Pose::identity(), Pose::translation(0.003, y, 0.0), 0.6, 10.0), 6);
        }
    }

    #[test]
    fn what_is_not_between_the_jaws_is_lost() {
        assert_eq!(withstood(Pose::translation(0.0, 0.0, -0.3), Pose::identity(), 0.8, 10.0), 0);
    }
}
