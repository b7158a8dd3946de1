//! Convex parts of mesh files, for comparing with others: `cargo run --release -p robotc-core --example convex_parts -- OUT MESH...`
//! writes the corners of all parts to OUT as JSON, with the seconds that each mesh took. `xtask/convex/compare.py` reads it.

use std::fmt::Write as _;
use std::time::Instant;

use nalgebra::Point3;
use robotc_core::geom::{DecomposeOptions, decompose};
use robotc_core::model::TriMesh;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut args = std::env::args().skip(1);
    let out = args.next().ok_or("usage: OUT MESH...")?;
    let mut json = "[".to_owned();
    for path in args {
        let scene = mesh_loader::Loader::default().load_from_slice(&std::fs::read(&path)?, &path)?;
        let mut mesh = TriMesh::default();
        for m in scene.meshes {
            let vertices = m.vertices.iter().map(|v| Point3::from(v.map(f64::from))).collect();
            mesh.append(&TriMesh { vertices, faces: m.faces });
        }
        let start = Instant::now();
        let parts = decompose(&mesh, &DecomposeOptions::default())?;
        let seconds = start.elapsed().as_secs_f64();
        let corners = |part: &robotc_core::geom::ConvexPart| {
            let points: Vec<[f64; 3]> = part.points().iter().map(|p| [p.x, p.y, p.z]).collect();
            format!("{points:?}")
        };
        let parts: Vec<String> = parts.iter().map(corners).collect();
        let comma = if json.len() > 1 { "," } else { "" };
        write!(json, "{comma}\n{{\"mesh\":{path:?},\"seconds\":{seconds},\"vertices\":[")?;
        let vertices: Vec<String> =
            mesh.vertices.iter().map(|p| format!("[{:?},{:?},{:?}]", p.x, p.y, p.z)).collect();
        let faces: Vec<String> = mesh.faces.iter().map(|f| format!("{f:?}")).collect();
        write!(
            json,
            "{}],\"faces\":[{}],\"parts\":[{}]}}",
            vertices.join(","),
            faces.join(","),
            parts.join(",")
        )?;
    }
    json.push_str("\n]\n");
    std::fs::write(out, json)?;
    Ok(())
}
