//! Reference files, and how their numbering maps to ours.
#![allow(missing_docs, clippy::cast_possible_truncation, clippy::unwrap_used)]

use std::collections::HashMap;
use std::path::Path;

use glam::DVec3;
use serde::Deserialize;
use serde::de::DeserializeOwned;
use subzero::{BoundaryRule, Crease, EdgeId, Features, TriangleMesh};

#[derive(Deserialize)]
pub struct TriangleReference {
    pub vertices: Vec<DVec3>,
    pub faces: Vec<[u32; 3]>,
    #[serde(default)]
    pub creases: Vec<(u32, u32, f32)>,
    #[serde(default)]
    pub corners: Vec<(u32, f32)>,
    #[serde(default)]
    pub boundary: Option<String>,
    pub levels: Vec<TriangleLevel>,
    #[serde(default)]
    pub limits: Vec<Limits>,
    #[serde(default)]
    pub sector_normals_level0: Vec<SectorNormal>,
}

#[derive(Deserialize)]
pub struct TriangleLevel {
    pub vertices: Vec<DVec3>,
    pub parents: Vec<[u32; 2]>,
    #[serde(default)]
    pub faces: Vec<[u32; 3]>,
}

#[derive(Deserialize)]
pub struct Limits {
    pub level: usize,
    pub kind: Vec<u8>,
    pub position_exact: Vec<DVec3>,
    pub normal_exact: Vec<[Option<f64>; 3]>,
}

#[derive(Deserialize)]
pub struct SectorNormal {
    pub v: u32,
    pub ring: Vec<u32>,
    pub normal: DVec3,
}

pub fn load<T: DeserializeOwned>(name: &str) -> T {
    load_from("subdivision", name)
}

pub fn load_from<T: DeserializeOwned>(folder: &str, name: &str) -> T {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data");
    let path = data.join(folder).join(name).with_extension("json");
    let text = std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    serde_json::from_str(&text).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// Makes a mesh with the features of a reference file.
pub fn with_features<T>(
    creases: &[(u32, u32, f32)],
    corners: &[(u32, f32)],
    boundary: Option<&str>,
    make: impl FnOnce(&Features) -> T,
) -> T {
    let creases: Vec<Crease> =
        creases.iter().map(|&(a, b, sharpness)| Crease { ends: [a, b], sharpness }).collect();
    let boundary = match boundary {
        Some("edge_corner") => BoundaryRule::EdgeCorner,
        _ => BoundaryRule::Edge,
    };
    make(&Features { creases: &creases, corners: &[], soft_corners: corners, boundary })
}

impl TriangleReference {
    pub fn mesh(&self) -> TriangleMesh {
        with_features(&self.creases, &self.corners, self.boundary.as_deref(), |features| {
            TriangleMesh::new(self.vertices.len(), self.faces.clone(), features).unwrap()
        })
    }
}

/// Our id on the finer level of each vertex of the reference, from those on the coarser level.
pub fn map_vertices(coarse: &TriangleMesh, coarse_ids: &[u32], parents: &[[u32; 2]]) -> Vec<u32> {
    let edges: HashMap<[u32; 2], EdgeId> = (0..coarse.edge_count() as u32)
        .map(EdgeId)
        .map(|e| {
            let [a, b] = coarse.edge(e);
            ([a.min(b), a.max(b)], e)
        })
        .collect();
    parents
        .iter()
        .map(|parents| {
            let [a, b] = parents.map(|v| coarse_ids[v as usize]);
            if a == b { a } else { coarse.counts().edge_vertex(edges[&[a.min(b), a.max(b)]]) }
        })
        .collect()
}

/// Triangles as a set: each turned so that its lowest vertex comes first, then sorted.
pub fn as_set(triangles: impl IntoIterator<Item = [u32; 3]>) -> Vec<[u32; 3]> {
    let mut set: Vec<[u32; 3]> = triangles
        .into_iter()
        .map(|mut triangle| {
            while triangle[0] > triangle[1] || triangle[0] > triangle[2] {
                triangle.rotate_left(1);
            }
            triangle
        })
        .collect();
    set.sort_unstable();
    set
}

/// Asserts that two points agree in every coordinate.
#[track_caller]
pub fn assert_close(ours: DVec3, theirs: DVec3, tolerance: f64, what: &str) {
    let difference = (ours - theirs).abs().max_element();
    assert!(difference <= tolerance, "{what}: {ours} is not {theirs}, off by {difference:e}");
}
