//! Meshes as the reference files of subdivision write them: `vertices`, `faces`, `creases`, `corners`, `boundary`.

use glam::DVec3;
use serde::Deserialize;
use subzero::{BoundaryRule, Crease, INFINITE_SHARPNESS};

use super::{MeshFile, MeshFileProblem};

#[derive(Deserialize)]
struct File {
    vertices: Vec<[f64; 3]>,
    faces: Vec<Vec<u32>>,
    #[serde(default)]
    creases: Vec<CreaseEntry>,
    #[serde(default)]
    corners: Vec<CornerEntry>,
    /// Files of schemes without a choice say something else here.
    #[serde(default)]
    boundary: Option<String>,
}

#[derive(Deserialize)]
#[serde(untagged, expecting = "a crease is [a, b] or [a, b, sharpness]")]
enum CreaseEntry {
    Infinite(u32, u32),
    Sharp(u32, u32, f32),
}

#[derive(Deserialize)]
#[serde(untagged, expecting = "a corner is a vertex or [vertex, sharpness]")]
enum CornerEntry {
    Infinite(u32),
    Sharp(u32, f32),
}

/// Reads a mesh; levels and limits that the file may have are passed over.
pub(super) fn read(bytes: &[u8]) -> Result<MeshFile, MeshFileProblem> {
    let file: File = serde_json::from_slice(bytes).map_err(problem)?;
    Ok(MeshFile {
        points: file.vertices.into_iter().map(DVec3::from_array).collect(),
        faces: file.faces,
        creases: file
            .creases
            .into_iter()
            .map(|entry| match entry {
                CreaseEntry::Infinite(a, b) => Crease::infinite([a, b]),
                CreaseEntry::Sharp(a, b, sharpness) => Crease { ends: [a, b], sharpness },
            })
            .collect(),
        corners: file
            .corners
            .into_iter()
            .map(|entry| match entry {
                CornerEntry::Infinite(vertex) => (vertex, INFINITE_SHARPNESS),
                CornerEntry::Sharp(vertex, sharpness) => (vertex, sharpness),
            })
            .collect(),
        boundary: match file.boundary.as_deref() {
            Some("edge_corner" | "edge-corner") => BoundaryRule::EdgeCorner,
            _ => BoundaryRule::Edge,
        },
        welded_corners: None,
    })
}

/// A JSON error with its line.
fn problem(error: serde_json::Error) -> MeshFileProblem {
    MeshFileProblem::line(error.line().saturating_sub(1), error.to_string())
}
