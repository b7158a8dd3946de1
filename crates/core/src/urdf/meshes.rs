//! The shapes of a description, with meshes read once for each file and scale.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use nalgebra::Vector3;

use super::draft::{Draft, GeometryDraft, ShapeDraft};
use super::grouped::{Grouped, and_others};
use super::resolve::{Resolved, is_away, resolve};
use super::{LoadOptions, MeshPolicy};
use crate::diag::{Diagnostic, Diagnostics, Span};
use crate::model::{Shape, TriMesh};
use crate::system::System;

/// A file and the factors it is scaled by, as bits.
type Scaled = (PathBuf, [u64; 3]);

/// Where the shapes of one description come from.
pub(super) struct MeshSource<'a> {
    system: &'a dyn System,
    options: &'a LoadOptions,
    /// The description file, which references are relative to.
    path: &'a Path,
    draft: &'a Draft,
    files: BTreeMap<PathBuf, Result<Arc<TriMesh>, String>>,
    scaled: BTreeMap<Scaled, Arc<TriMesh>>,
    /// Missing meshes that are to be left out, visual and collision.
    left_out: [Grouped; 2],
}

#[derive(Clone, Copy, PartialEq)]
enum Use {
    Visual,
    Collision,
}

impl<'a> MeshSource<'a> {
    pub(super) fn new(
        system: &'a dyn System,
        options: &'a LoadOptions,
        path: &'a Path,
        draft: &'a Draft,
    ) -> Self {
        let left_out = [Grouped::default(), Grouped::default()];
        Self { system, options, path, draft, files: BTreeMap::new(), scaled: BTreeMap::new(), left_out }
    }

    /// The shape of a visual; `None` when its mesh is left out.
    pub(super) fn visual(
        &mut self,
        geometry: &urdf_rs::Geometry,
        written: &GeometryDraft,
        link: &str,
        found: &mut Diagnostics,
    ) -> Option<Shape> {
        self.shape(geometry, written, link, Use::Visual, found)
    }

    /// The shape of a collision element; `None` when its mesh is left out.
    pub(super) fn collision(
        &mut self,
        geometry: &urdf_rs::Geometry,
        written: &GeometryDraft,
        link: &str,
        found: &mut Diagnostics,
    ) -> Option<Shape> {
        self.shape(geometry, written, link, Use::Collision, found)
    }

    fn shape(
        &mut self,
        geometry: &urdf_rs::Geometry,
        written: &GeometryDraft,
        link: &str,
        purpose: Use,
        found: &mut Diagnostics,
    ) -> Option<Shape> {
        if let Some(shape) = primitive(geometry) {
            return Some(shape);
        }
        let ShapeDraft::Mesh { uri, scale } = &written.shape else { return None };
        if self.options.meshes == MeshPolicy::Ignore {
            return None;
        }
        let Some(Resolved { path, guessed }) =
            resolve(self.system, &self.options.packages, self.path, &uri.text)
        else {
            if self.is_accepted(link, purpose) {
                return None;
            }
            if self.is_skipped(&uri.text) {
                self.left_out[purpose as usize].add(uri.span, &uri.text);
            } else {
                found.push(self.missing(&uri.text, uri.span, link, purpose));
            }
            return None;
        };
        if guessed && !self.files.contains_key(&path) {
            let message = format!("mesh `{}` is not there; `{}` is used", uri.text, path.display());
            found.push(Diagnostic::warning("R0305", message).at(uri.span, "not there"));
        }
        match self.load(&path, uri.span, found) {
            Ok(mesh) => Some(Shape::Mesh { mesh: self.scaled(path, mesh, scale), uri: uri.text.clone() }),
            Err(_) if self.is_accepted(link, purpose) => None,
            Err(reason) => {
                let message = format!("mesh `{}` of link `{link}` cannot be used: {reason}", uri.text);
                found.push(match self.is_fatal(purpose) {
                    true => Diagnostic::error("R0303", message).at(uri.span, "this mesh"),
                    false => {
                        Diagnostic::warning("R0303", format!("{message}; left out")).at(uri.span, "this mesh")
                    }
                });
                None
            }
        }
    }

    /// Whether a damaged or missing mesh of this use keeps the robot from being used.
    fn is_fatal(&self, purpose: Use) -> bool {
        purpose == Use::Collision && self.options.meshes != MeshPolicy::SkipMissing
    }

    /// Whether the caller knows that the link is without this shape.
    fn is_accepted(&self, link: &str, purpose: Use) -> bool {
        purpose == Use::Collision && self.options.shapeless.contains(link)
    }

    /// Whether the policy leaves the missing mesh `uri` out.
    fn is_skipped(&self, uri: &str) -> bool {
        match self.options.meshes {
            MeshPolicy::SkipMissing => true,
            MeshPolicy::SkipAway => is_away(self.system, &self.options.packages, self.path, uri),
            MeshPolicy::Load | MeshPolicy::Ignore => false,
        }
    }

    fn load(&mut self, path: &Path, span: Span, found: &mut Diagnostics) -> Result<Arc<TriMesh>, String> {
        if let Some(known) = self.files.get(path) {
            return known.clone();
        }
        let loaded = self.system.mesh(path).map_err(|e| e.to_string());
        let result = loaded.map(|loaded| {
            if loaded.repairs.are_serious() {
                let dropped = loaded.repairs.bad_indices;
                let message =
                    format!("{}: {dropped} faces name vertices that do not exist; dropped", path.display());
                found.push(Diagnostic::warning("R0304", message).at(span, "used here"));
            }
            loaded.mesh.clone()
        });
        self.files.insert(path.to_owned(), result.clone());
        result
    }

    fn scaled(&mut self, path: PathBuf, mesh: Arc<TriMesh>, scale: &[f64; 3]) -> Arc<TriMesh> {
        if *scale == [1.0; 3] {
            return mesh;
        }
        let key = (path, scale.map(f64::to_bits));
        self.scaled.entry(key).or_insert_with(|| Arc::new(mesh.scaled(Vector3::from(*scale)))).clone()
    }

    fn missing(&self, uri: &str, span: Span, link: &str, purpose: Use) -> Diagnostic {
        let hint = match uri
            .strip_prefix("package://")
            .and_then(|r| r.split('/').next())
            .filter(|p| !p.is_empty())
        {
            Some(package) => {
                format!("say where package `{package}` is, under [packages] or beside the description")
            }
            None => "paths are relative to the folder of the description".to_owned(),
        };
        if purpose == Use::Visual {
            let message = format!("visual mesh `{uri}` of link `{link}` is missing; left out");
            return Diagnostic::warning("R0301", message).at(span, "no such file").hint(hint);
        }
        let joints = self.joints_above(link);
        let affected = match joints.is_empty() {
            true => "of the fixed base".to_owned(),
            false => format!("moved by the joints {}", joints.join(", ")),
        };
        let message = format!("collision mesh `{uri}` of link `{link}` is missing; the link is {affected}");
        let hint = format!(
            "{hint}; a link that may touch nothing is named under `shapeless` in the robot specification"
        );
        Diagnostic::error("R0302", message).at(span, "no such file").hint(hint)
    }

    /// Tells what was left out, once for each use: with all meshes absent there would be a hundred findings.
    pub(super) fn finish(self, found: &mut Diagnostics) {
        let [visual, collision] = self.left_out;
        visual.finish(found, |count, first| {
            let others = and_others(count);
            Diagnostic::warning("R0301", format!("visual mesh `{first}`{others} is missing; left out"))
        });
        collision.finish(found, |count, first| {
            let others = and_others(count);
            let message =
                format!("collision mesh `{first}`{others} is missing; links without one touch nothing");
            Diagnostic::warning("R0302", message)
        });
    }

    /// Names of the moving joints from the root to `link`.
    fn joints_above(&self, link: &str) -> Vec<String> {
        let mut names = Vec::new();
        let mut at = link;
        // The draft is a tree by now, so the walk ends at its root.
        while let Some(joint) = self.draft.joints.iter().find(|j| j.child.text == at) {
            if joint.kind.moves() {
                names.push(format!("`{}`", joint.name.text));
            }
            at = &joint.parent.text;
        }
        names.reverse();
        names
    }
}

/// The primitive shape, or `None` for a mesh.
fn primitive(geometry: &urdf_rs::Geometry) -> Option<Shape> {
    Some(match *geometry {
        urdf_rs::Geometry::Box { size } => Shape::Box { size: *size },
        urdf_rs::Geometry::Cylinder { radius, length } => Shape::Cylinder { radius, length },
        urdf_rs::Geometry::Capsule { radius, length } => Shape::Capsule { radius, length },
        urdf_rs::Geometry::Sphere { radius } => Shape::Sphere { radius },
        urdf_rs::Geometry::Mesh { .. } => return None,
    })
}
