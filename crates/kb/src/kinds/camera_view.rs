//! What of its image a camera on the robot sees past the robot itself.

use nalgebra::Point2;
use robotc_core::geom::ConvexPolygon;
use robotc_core::ids::{DofIdx, Idx, LinkIdx};
use robotc_core::model::Origin;
use robotc_vision::{Pinhole, ViewVolume};
use serde::{Deserialize, Serialize};

use crate::codec;
use crate::graph::{Dep, PlanError, Planner};
use crate::kind::{DecodeError, Kind, Portability};
use crate::kinds::ConvexParts;
use crate::parameters::round_step;
use crate::project::{OfCamera, OfShape};
use crate::projection::Mechanism;
use crate::record::Parts;

/// The kind; its artefact is a [`CameraViews`].
///
/// A camera on a hand always sees some of the fingers. What they hide does not depend on where the arm is, only on the
/// preshape; so for each preshape the largest convex polygon of the image that nothing of the hand hides is found once, and
/// what is to be seen has to be in the volume behind it (thesis, section 5.1.1).
pub struct CameraView;

/// What a camera sees past the robot's own parts that move with it.
#[derive(Debug, Clone, PartialEq)]
pub struct CameraViews {
    /// The optics.
    pub camera: Pinhole,
    /// One for each preshape of the gripper whose palm the camera is fixed to; a single one for a camera on no gripper.
    pub masks: Vec<Mask>,
}

/// An image with the shadows of a hand.
#[derive(Debug, Clone, PartialEq)]
pub struct Mask {
    /// Outlines of the convex parts that hide something, within the image; they overlap.
    pub shadows: Vec<ConvexPolygon>,
    /// The largest convex polygon found that shares no area with them; empty when they hide everything.
    pub view: ConvexPolygon,
}

impl CameraViews {
    /// The space behind the free view, in the camera's frame.
    pub fn volume(&self, mask: usize) -> ViewVolume {
        ViewVolume::new(&self.camera, &self.masks[mask].view)
    }

    /// The free share of the image, as one convex polygon.
    pub fn share(&self, mask: usize) -> f64 {
        self.masks[mask].view.area() / self.camera.image().area()
    }
}

crate::parameters! {
    /// Parameters of [`CameraView`].
    pub struct CameraViewParameters {
        /// What is nearer to the lens hides nothing, nor does a part that the lens is in: they are its housing.
        near: f64 ["m"] in 0.000001..=10.0 = auto "at most a twentieth of the size of what moves with the camera";
        /// Searches for the largest free view, each from another start.
        starts: u32 [""] in 1..=100000 = 64;
    }
}

/// A camera, and the links that move with it.
pub struct Inputs {
    camera: Pinhole,
    link_from_camera: Origin,
    /// Of `mechanism`.
    link: LinkIdx,
    mechanism: Mechanism,
    parts: Vec<(LinkIdx, Dep<ConvexParts>)>,
    fingers: Vec<DofIdx>,
    /// Name and positions of the fingers.
    preshapes: Vec<(String, Vec<f64>)>,
}

#[derive(Serialize, Deserialize)]
struct Stored {
    size: [u32; 2],
    focal: [f64; 2],
    centre: [f64; 2],
    masks: Vec<StoredMask>,
}

#[derive(Serialize, Deserialize)]
struct StoredMask {
    shadows: Vec<Vec<[f64; 2]>>,
    view: Vec<[f64; 2]>,
}

impl Kind for CameraView {
    const NAME: &'static str = "camera_view";
    const FORMAT: u32 = 1;
    const ALGORITHM: u32 = 1;
    const PORTABILITY: Portability = Portability::Portable;
    const DOC: &'static str = "What of its image a camera on the robot sees past the hand that it is fixed to, for every preshape. Views of objects are planned inside of it.";

    type Subject = OfCamera;
    type Inputs = Inputs;
    type Parameters = CameraViewParameters;
    type Artefact = CameraViews;

    fn inputs(planner: &mut Planner<'_>, subject: &OfCamera) -> Result<Inputs, PlanError> {
        let project = planner.project();
        let robot = project.robot();
        let camera = &robot.cameras[subject.0];
        let (mechanism, links, fingers, preshapes) = match robot.gripper_of_camera(camera) {
            None => {
                let (mechanism, links) = Mechanism::rigid(&robot.model, camera.link)?;
                (mechanism, links, Vec::new(), vec![(String::new(), Vec::new())])
            }
            Some(gripper) => {
                let (mechanism, reduced, links) = Mechanism::hand(&robot.model, gripper)?;
                let preshapes = reduced.preshapes.into_iter().map(|shape| (shape.name, shape.values));
                (mechanism, links, reduced.dofs, preshapes.collect())
            }
        };
        let link = links.iter().position(|&link| link == camera.link).map(LinkIdx::new);
        let mut parts = Vec::new();
        for (i, &link) in links.iter().enumerate() {
            if !robot.model.links()[link].collisions.is_empty() {
                parts.push((LinkIdx::new(i), planner.need::<ConvexParts>(&OfShape::Link(link))?));
            }
        }
        Ok(Inputs {
            camera: Pinhole::of(camera),
            link_from_camera: *project.camera_pose(subject.0),
            link: link.expect("a link is rigid with itself"),
            mechanism,
            parts,
            fingers,
            preshapes,
        })
    }

    fn key_parts(inputs: &Inputs, parts: &mut Parts) {
        let Inputs { camera, link_from_camera, link, mechanism, parts: bodies, fingers, preshapes } = inputs;
        let Pinhole { size, focal, centre } = camera;
        parts.add("image", "", &(size.map(u64::from).to_vec(), focal.to_vec(), centre.to_vec()));
        parts.add("camera", "", &(link.index(), *link_from_camera));
        mechanism.key_parts(parts);
        let shaped: Vec<usize> = bodies.iter().map(|(link, _)| link.index()).collect();
        let fingers: Vec<usize> = fingers.iter().map(|dof| dof.index()).collect();
        parts.add("links with shapes", "", &(shaped, fingers));
        for (name, values) in preshapes {
            parts.add("preshape", name, values);
        }
    }

    fn defaults(inputs: &Inputs) -> CameraViewParameters {
        let bone = |origin: &Origin| nalgebra::Vector3::from(origin.xyz).norm();
        let bones = inputs.mechanism.model().joints().iter().map(|joint| bone(&joint.origin));
        let size = bones.fold(bone(&inputs.link_from_camera), f64::max);
        let near = if size > 0.0 { round_step(size / 20.0) } else { 0.001 };
        CameraViewParameters { near, ..CameraViewParameters::constants() }
    }

    fn encode(artefact: &CameraViews) -> Vec<u8> {
        let Pinhole { size, focal, centre } = artefact.camera;
        let corners = |polygon: &ConvexPolygon| polygon.corners().iter().map(|p| [p.x, p.y]).collect();
        let mask = |mask: &Mask| StoredMask {
            shadows: mask.shadows.iter().map(corners).collect(),
            view: corners(&mask.view),
        };
        codec::encode(&Stored { size, focal, centre, masks: artefact.masks.iter().map(mask).collect() })
    }

    fn decode(bytes: &[u8]) -> Result<CameraViews, DecodeError> {
        let Stored { size, focal, centre, masks } = codec::decode(bytes)?;
        if !focal.iter().chain(&centre).all(|x| x.is_finite()) || focal.iter().any(|f| *f <= 0.0) {
            return Err(DecodeError::new("not a camera"));
        }
        let polygon = |corners: Vec<[f64; 2]>| {
            let corners = corners.into_iter().map(Point2::from).collect();
            ConvexPolygon::from_corners(corners).ok_or_else(|| DecodeError::new("a polygon is not convex"))
        };
        let mask = |mask: StoredMask| {
            let shadows = mask.shadows.into_iter().map(polygon).collect::<Result<_, _>>()?;
            Ok(Mask { shadows, view: polygon(mask.view)? })
        };
        let masks = masks.into_iter().map(mask).collect::<Result<_, DecodeError>>()?;
        Ok(CameraViews { camera: Pinhole { size, focal, centre }, masks })
    }

    fn summary(artefact: &CameraViews) -> String {
        let share = |i: usize| format!("{:.0} %", 100.0 * artefact.share(i));
        let shares: Vec<String> = (0..artefact.masks.len()).map(share).collect();
        format!("{} of the image free", shares.join(", "))
    }
}

#[cfg(feature = "build")]
mod build {
    use std::sync::Arc;

    use nalgebra::{Point3, Vector3};
    use robotc_core::geom::ConvexPart;
    use robotc_core::model::{Configuration, Kinematics, LinkPoses};
    use robotc_core::{Pose, geom};
    use robotc_vision::{FreeViewOptions, free_view, silhouette};

    use super::*;
    use crate::kind::{Build, BuildError, Context};

    impl Build for CameraView {
        fn build(
            inputs: &Inputs,
            parameters: &CameraViewParameters,
            context: &Context<'_>,
        ) -> Result<CameraViews, BuildError> {
            let options = FreeViewOptions { starts: parameters.starts };
            let camera = inputs.camera;
            let bodies = load(inputs, context)?;
            let masks = context.map(&inputs.preshapes, |_, (_, fingers)| {
                let around = around(inputs, &bodies, fingers);
                let shadow =
                    |(pose, part): &(Pose, ConvexPart)| silhouette(&camera, part, pose, parameters.near);
                let shadows: Vec<ConvexPolygon> = around.iter().filter_map(shadow).collect();
                let view = free_view(&camera.image(), &shadows, &options, context.seed());
                Mask { shadows, view }
            })?;
            Ok(CameraViews { camera, masks })
        }

        /// Rays through a lattice of pixels: those of the free view meet nothing, those of a shadow do.
        fn check(
            artefact: &CameraViews,
            inputs: &Inputs,
            parameters: &CameraViewParameters,
            context: &Context<'_>,
        ) -> Result<(), BuildError> {
            const STEPS: u32 = 60;
            let bodies = load(inputs, context)?;
            let [width, height] = artefact.camera.size.map(f64::from);
            for (mask, (name, fingers)) in artefact.masks.iter().zip(&inputs.preshapes) {
                let around = around(inputs, &bodies, fingers);
                for i in 0..STEPS * STEPS {
                    let place = |k: u32, size: f64| (f64::from(k) + 0.437) / f64::from(STEPS) * size;
                    let pixel = Point2::new(place(i % STEPS, width), place(i / STEPS, height));
                    let ray = artefact.camera.ray(&pixel);
                    let way =
                        |(pose, part): &(Pose, ConvexPart)| way_inside(part, pose, &ray, parameters.near);
                    let longest = around.iter().map(way).fold(0.0, f64::max);
                    let is_hidden = mask.shadows.iter().any(|shadow| shadow.contains(&pixel));
                    let is_wrong = if longest > 1e-6 {
                        !is_hidden || mask.view.contains(&pixel)
                    } else {
                        // A ray along a border may be on either side of it.
                        longest == 0.0 && is_hidden
                    };
                    if is_wrong {
                        let seen = format!(
                            "the ray meets {longest} m of the robot, and it is called hidden: {is_hidden}"
                        );
                        return Err(BuildError::Check(format!("preshape {name}, pixel {pixel}: {seen}")));
                    }
                }
            }
            Ok(())
        }
    }

    type Bodies = Vec<(LinkIdx, Arc<geom::ConvexParts>)>;

    fn load(inputs: &Inputs, context: &Context<'_>) -> Result<Bodies, BuildError> {
        inputs.parts.iter().map(|(link, dep)| Ok((*link, context.load(dep)?))).collect()
    }

    /// The parts round a camera, `camera_from_part` each, for positions of the fingers; without its housing.
    fn around(inputs: &Inputs, bodies: &Bodies, fingers: &[f64]) -> Vec<(Pose, ConvexPart)> {
        let model = inputs.mechanism.model();
        let mut q = Configuration::neutral(model);
        q.set(&inputs.fingers, fingers);
        let mut poses = LinkPoses::default();
        Kinematics::new(model.clone()).link_poses(&q, &mut poses);
        let root_from_camera = poses.root_from(inputs.link) * inputs.link_from_camera.pose();
        let mut around = Vec::new();
        for (link, parts) in bodies {
            let camera_from_link = root_from_camera.inverse() * poses.root_from(*link);
            let lens = camera_from_link.inverse() * Point3::origin();
            let parts = parts.iter().filter(|part| !part.contains(&lens));
            around.extend(parts.map(|part| (camera_from_link, part.clone())));
        }
        around
    }

    /// How much of a ray from the camera, from `near` on, is inside of a part; metres along z.
    fn way_inside(part: &ConvexPart, camera_from_part: &Pose, ray: &Vector3<f64>, near: f64) -> f64 {
        let part_from_camera = camera_from_part.inverse();
        let (lens, along) = (part_from_camera * Point3::origin(), part_from_camera.rotation * ray);
        let (mut from, mut to) = (near, f64::INFINITY);
        for plane in part.planes() {
            let (height, rise) = (plane.height(&lens), plane.normal.dot(&along));
            if rise > 0.0 {
                to = f64::min(to, -height / rise);
            } else if rise < 0.0 {
                from = f64::max(from, -height / rise);
            } else if height > 0.0 {
                return 0.0;
            }
        }
        (to - from).max(0.0)
    }
}
