//! Convex parts that cover a link, an object or an obstacle: what collision checks compute with.

use nalgebra::Point3;
use robotc_core::geom::{ConvexPart, ConvexParts as Parts3};
use serde::{Deserialize, Serialize};

use crate::codec;
use crate::graph::{PlanError, Planner};
use crate::kind::{DecodeError, Kind, Portability};
use crate::project::{OfShape, Subject};
use crate::projection::Shapes;
use crate::record::Parts;

/// The kind; its artefact is a [`ConvexParts`](robotc_core::geom::ConvexParts) in the frame of the link or object.
///
/// All elements of a body are covered together. A mesh is cut until every part is convex to within the tolerance
/// (thesis, section 4.6); other shapes are one part each.
pub struct ConvexParts;

crate::parameters! {
    /// Parameters of [`ConvexParts`].
    pub struct ConvexPartsParameters {
        /// How far a part may stand off the solid before it is cut, as a fraction of the size of its mesh.
        concavity: f64 [""] in 0.01..=1.0 = 0.03;
        /// Most parts of one mesh.
        max_parts: u32 [""] in 1..=1024 = 32;
        /// Most corners of one part.
        max_vertices: u32 [""] in 8..=1024 = 32;
    }
}

/// The elements of a body, and what people call it.
pub struct Body {
    shapes: Shapes,
    name: String,
}

#[derive(Serialize, Deserialize)]
struct Stored {
    parts: Vec<StoredPart>,
}

#[derive(Serialize, Deserialize)]
struct StoredPart {
    points: Vec<[f64; 3]>,
    triangles: Vec<[u32; 3]>,
}

impl Kind for ConvexParts {
    const NAME: &'static str = "convex_parts";
    const FORMAT: u32 = 1;
    const ALGORITHM: u32 = 4;
    const PORTABILITY: Portability = Portability::Portable;
    const DOC: &'static str = "Convex parts that cover the collision geometry of a link, object or obstacle. Collision checks compute with them.";

    type Subject = OfShape;
    type Inputs = Body;
    type Parameters = ConvexPartsParameters;
    type Artefact = Parts3;

    fn inputs(planner: &mut Planner<'_>, subject: &OfShape) -> Result<Body, PlanError> {
        let project = planner.project();
        Ok(Body { shapes: Shapes::of(subject.geometry(project)), name: subject.label(project) })
    }

    fn key_parts(inputs: &Body, parts: &mut Parts) {
        let Body { shapes, name } = inputs;
        shapes.key_parts(name, parts);
    }

    fn defaults(_inputs: &Body) -> ConvexPartsParameters {
        ConvexPartsParameters::constants()
    }

    fn encode(artefact: &Parts3) -> Vec<u8> {
        let stored = |part: &ConvexPart| StoredPart {
            points: part.points().iter().map(|p| [p.x, p.y, p.z]).collect(),
            triangles: part.triangles().to_vec(),
        };
        codec::encode(&Stored { parts: artefact.iter().map(stored).collect() })
    }

    fn decode(bytes: &[u8]) -> Result<Parts3, DecodeError> {
        let stored: Stored = codec::decode(bytes)?;
        let part = |part: StoredPart| {
            let points = part.points.into_iter().map(Point3::from).collect();
            ConvexPart::from_raw(points, part.triangles).map_err(|error| DecodeError::new(error.to_string()))
        };
        Ok(Parts3::new(stored.parts.into_iter().map(part).collect::<Result<_, _>>()?))
    }

    fn summary(artefact: &Parts3) -> String {
        let volume: f64 = artefact.iter().map(ConvexPart::volume).sum();
        let corners = artefact.points().count();
        format!("{} parts, {corners} corners, {:.3} litres", artefact.len(), volume * 1e3)
    }
}

#[cfg(feature = "build")]
mod build {
    use robotc_core::geom::{DecomposeOptions, parts_of_shape};
    use robotc_core::model::{Geometry, Shape};

    use super::*;
    use crate::kind::{Build, BuildError, Context};

    impl Build for ConvexParts {
        fn build(
            inputs: &Body,
            parameters: &ConvexPartsParameters,
            context: &Context<'_>,
        ) -> Result<Parts3, BuildError> {
            let elements = inputs.shapes.elements();
            let covers = context.try_map(elements, |_, element| cover(element, parameters))?;
            let mut all = Parts3::default();
            covers.into_iter().for_each(|parts| all.extend(parts));
            Ok(all)
        }

        /// Corners, edges and centres of every triangle of every element have to be inside some part.
        fn check(
            artefact: &Parts3,
            inputs: &Body,
            _parameters: &ConvexPartsParameters,
            context: &Context<'_>,
        ) -> Result<(), BuildError> {
            let bounds = artefact.bounds();
            let slack = 1e-9 * (1.0 + bounds.map_or(0.0, |b| b.diagonal()));
            for element in inputs.shapes.elements() {
                let body_from_element = element.origin.pose();
                let points = surface_points(&element.shape);
                let heights = context.map(&points, |_, p| artefact.height(&(body_from_element * p)))?;
                if let Some((height, point)) =
                    heights.iter().zip(&points).find(|(height, _)| **height > slack)
                {
                    return Err(BuildError::Check(format!("{point} is {height:.3e} m outside of all parts")));
                }
            }
            Ok(())
        }
    }

    fn cover(element: &Geometry, parameters: &ConvexPartsParameters) -> Result<Parts3, BuildError> {
        let options = DecomposeOptions {
            concavity: parameters.concavity,
            max_parts: parameters.max_parts as usize,
            max_vertices: parameters.max_vertices as usize,
        };
        let parts = parts_of_shape(&element.shape, &options);
        let parts = parts.map_err(|error| BuildError::Impossible(error.to_string()))?;
        Ok(parts.transformed(&element.origin.pose()))
    }

    /// Points on the surface of a shape, in its own frame, found without the code that covers it.
    fn surface_points(shape: &Shape) -> Vec<Point3<f64>> {
        const STEPS: usize = 24;
        let ring = |radius: f64, z: f64| {
            (0..STEPS).map(move |i| {
                let angle = std::f64::consts::TAU * i as f64 / STEPS as f64;
                Point3::new(radius * libm::cos(angle), radius * libm::sin(angle), z)
            })
        };
        let ball = |radius: f64, lift: f64| {
            (0..=STEPS).flat_map(move |i| {
                let angle = std::f64::consts::PI * i as f64 / STEPS as f64;
                let (z, r) = (radius * libm::cos(angle), radius * libm::sin(angle));
                ring(r, z + lift.copysign(z))
            })
        };
        match shape {
            Shape::Box { size } => {
                let corner = |i: usize| {
                    let side = |k: usize| if i >> k & 1 == 0 { -0.5 } else { 0.5 } * size[k];
                    Point3::new(side(0), side(1), side(2))
                };
                (0..8).map(corner).collect()
            }
            Shape::Cylinder { radius, length } => {
                [-0.5, 0.5].into_iter().flat_map(|end| ring(*radius, end * length)).collect()
            }
            Shape::Capsule { radius, length } => ball(*radius, 0.5 * length).collect(),
            Shape::Sphere { radius } => ball(*radius, 0.0).collect(),
            Shape::Cloud { .. } | Shape::HeightField { .. } => Vec::new(),
            Shape::Mesh { mesh, .. } => {
                let mut points = mesh.vertices.clone();
                for face in 0..mesh.faces.len() {
                    if mesh.faces[face].iter().all(|&v| (v as usize) < mesh.vertices.len()) {
                        let [a, b, c] = mesh.triangle(face);
                        points.push(Point3::from((a.coords + b.coords + c.coords) / 3.0));
                        points.extend([(a, b), (b, c), (c, a)].map(|(p, q)| nalgebra::center(&p, &q)));
                    }
                }
                points
            }
        }
    }
}
