//! Meshes and polylines as the reference files of subdivision write them: `vertices`, `faces`, `lines`, `creases`, `corners`, `boundary`.

use serde::Deserialize;
use subzero::{BoundaryRule, Crease, INFINITE_SHARPNESS};

use super::json_point::JsonPoint;
use super::{MeshFile, MeshFileProblem};

#[derive(Deserialize)]
struct File {
    vertices: Vec<JsonPoint>,
    #[serde(default)]
    faces: Vec<Vec<u32>>,
    #[serde(default)]
    lines: Vec<Vec<u32>>,
    /// In place of lines: one through all points in their order, and whether it is closed.
    #[serde(default)]
    closed: Option<bool>,
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
    let mut file: File = serde_json::from_slice(bytes).map_err(problem)?;
    if let Some(is_closed) = file.closed.filter(|_| file.faces.is_empty() && file.lines.is_empty()) {
        let ids = (0..).take(file.vertices.len());
        file.lines.push(ids.chain(is_closed.then_some(0)).collect());
    }
    Ok(MeshFile {
        points: file.vertices.into_iter().map(|JsonPoint(point)| point).collect(),
        faces: file.faces,
        lines: file.lines,
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
        ..MeshFile::default()
    })
}

/// A JSON error with its line.
fn problem(error: serde_json::Error) -> MeshFileProblem {
    MeshFileProblem::line(error.line().saturating_sub(1), error.to_string())
}
