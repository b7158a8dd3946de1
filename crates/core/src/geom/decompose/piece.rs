//! A piece of surface, and cutting it by a plane.

use std::collections::HashMap;

use nalgebra::{Point3, Vector3};

use super::super::HullError;
use super::super::hull::convex_hull;
use crate::model::TriMesh;

/// Points with `normal . p = offset`.
#[derive(Debug, Clone, Copy)]
pub(super) struct CutPlane {
    pub(super) normal: Vector3<f64>,
    pub(super) offset: f64,
    /// Points this near count as on the plane.
    pub(super) tolerance: f64,
}

/// Vertices and faces, without a promise that they close. Every vertex counts, also one without a face.
#[derive(Debug, Clone, Default)]
pub(super) struct Piece {
    pub(super) vertices: Vec<Point3<f64>>,
    pub(super) faces: Vec<[u32; 3]>,
}

impl Piece {
    /// The mesh with equal vertices made one.
    pub(super) fn new(mesh: &TriMesh) -> Result<Self, HullError> {
        if mesh.vertices.is_empty() {
            return Err(HullError::NoPoints);
        }
        if !mesh.vertices.iter().all(|p| p.coords.iter().all(|x| x.is_finite())) {
            return Err(HullError::NotFinite);
        }
        let mut number = HashMap::new();
        let mut piece = Self::default();
        let welded: Vec<u32> = mesh
            .vertices
            .iter()
            .map(|p| {
                // Adding zero makes -0 and 0 one.
                let key = [p.x, p.y, p.z].map(|x| (x + 0.0).to_bits());
                *number.entry(key).or_insert_with(|| {
                    piece.vertices.push(*p);
                    piece.vertices.len() as u32 - 1
                })
            })
            .collect();
        let exists = |f: &&[u32; 3]| f.iter().all(|&v| (v as usize) < welded.len());
        piece.faces = mesh.faces.iter().filter(exists).map(|f| f.map(|v| welded[v as usize])).collect();
        piece.faces.retain(|[a, b, c]| a != b && b != c && c != a);
        Ok(piece)
    }

    /// Both pieces together.
    pub(super) fn joined(&self, other: &Self) -> Self {
        let shift = self.vertices.len() as u32;
        let mut out = self.clone();
        out.vertices.extend_from_slice(&other.vertices);
        out.faces.extend(other.faces.iter().map(|f| f.map(|v| v + shift)));
        out
    }

    /// What lies below and above the plane; `None` when one side is empty. Faces in the plane go to the side whose
    /// hull grows less by them.
    pub(super) fn cut(&self, plane: &CutPlane) -> Option<(Self, Self)> {
        let heights: Vec<f64> =
            self.vertices.iter().map(|p| plane.normal.dot(&p.coords) - plane.offset).collect();
        let side = |v: u32| {
            let h = heights[v as usize];
            if h.abs() <= plane.tolerance { 0 } else { h.signum() as i32 }
        };
        let mut low = Builder::default();
        let mut high = Builder::default();
        let mut flat: Vec<Vec<u32>> = Vec::new();
        let mut has_face = vec![false; self.vertices.len()];
        for face in &self.faces {
            face.iter().for_each(|&v| has_face[v as usize] = true);
            let sides = face.map(side);
            let (lowest, highest) = (*sides.iter().min()?, *sides.iter().max()?);
            match (lowest, highest) {
                (0, 0) => flat.push(face.to_vec()),
                (_, 0) => low.face(self, face.map(Corner::Old).as_slice()),
                (0, _) => high.face(self, face.map(Corner::Old).as_slice()),
                (-1, -1) => low.face(self, face.map(Corner::Old).as_slice()),
                (1, 1) => high.face(self, face.map(Corner::Old).as_slice()),
                _ => {
                    let mut below = Vec::with_capacity(4);
                    let mut above = Vec::with_capacity(4);
                    for i in 0..3 {
                        let (v, next) = (face[i], face[(i + 1) % 3]);
                        let (s, next_s) = (side(v), side(next));
                        if s <= 0 {
                            below.push(Corner::Old(v));
                        }
                        if s >= 0 {
                            above.push(Corner::Old(v));
                        }
                        if s * next_s < 0 {
                            // The same point for both faces of the edge: always cut from its lower end.
                            let (a, b) = if v < next { (v, next) } else { (next, v) };
                            let (ha, hb) = (heights[a as usize], heights[b as usize]);
                            let (pa, pb) = (self.vertices[a as usize], self.vertices[b as usize]);
                            let point = pa + (pb - pa) * (ha / (ha - hb));
                            below.push(Corner::New(a, b, point));
                            above.push(Corner::New(a, b, point));
                        }
                    }
                    low.face(self, &below);
                    high.face(self, &above);
                }
            }
        }
        for v in (0..self.vertices.len() as u32).filter(|&v| !has_face[v as usize]) {
            match side(v) {
                0 => flat.push(vec![v]),
                s if s < 0 => drop(low.vertex(self, Corner::Old(v))),
                _ => drop(high.vertex(self, Corner::Old(v))),
            }
        }
        if low.piece.vertices.is_empty() || high.piece.vertices.is_empty() {
            return None;
        }
        if !flat.is_empty() {
            let growth = |builder: &Builder| {
                let hull = convex_hull(&builder.piece.vertices).ok()?;
                let reach: Vec<f64> = flat
                    .iter()
                    .map(|f| f.iter().map(|&v| hull.height(&self.vertices[v as usize])).fold(0.0, f64::max))
                    .collect();
                Some(reach)
            };
            let (below, above) = (growth(&low)?, growth(&high)?);
            for (i, face) in flat.iter().enumerate() {
                let corners: Vec<Corner> = face.iter().map(|&v| Corner::Old(v)).collect();
                let target = if below[i] <= above[i] { &mut low } else { &mut high };
                target.face(self, &corners);
            }
        }
        Some((low.piece, high.piece))
    }
}

#[derive(Clone, Copy)]
enum Corner {
    /// A vertex of the piece that is cut.
    Old(u32),
    /// A point on the edge between two of them.
    New(u32, u32, Point3<f64>),
}

/// Collects one side of a cut.
#[derive(Default)]
struct Builder {
    piece: Piece,
    numbers: HashMap<(u32, u32), u32>,
}

impl Builder {
    fn vertex(&mut self, source: &Piece, corner: Corner) -> u32 {
        let (key, point) = match corner {
            Corner::Old(v) => ((v, v), source.vertices[v as usize]),
            Corner::New(a, b, point) => ((a, b), point),
        };
        let vertices = &mut self.piece.vertices;
        *self.numbers.entry(key).or_insert_with(|| {
            vertices.push(point);
            vertices.len() as u32 - 1
        })
    }

    /// Adds a convex polygon as a fan; fewer than three corners are just vertices.
    fn face(&mut self, source: &Piece, corners: &[Corner]) {
        let numbers: Vec<u32> = corners.iter().map(|&c| self.vertex(source, c)).collect();
        for i in 2..numbers.len() {
            self.piece.faces.push([numbers[0], numbers[i - 1], numbers[i]]);
        }
    }
}
