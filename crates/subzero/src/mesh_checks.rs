//! Checks that every kind of mesh makes of what it is given.

use glam::DVec3;
use rayon::prelude::*;

use crate::features::INFINITE_SHARPNESS;
use crate::ids::id;
use crate::{FaceId, Features, MeshError};

/// Checks that every coordinate of every point is finite.
///
/// # Errors
/// [`MeshError::NotFinite`] names the first vertex with a coordinate that is NaN or infinite.
pub fn check_finite(points: &[DVec3]) -> Result<(), MeshError> {
    match points.iter().position(|point| !point.is_finite()) {
        Some(vertex) => Err(MeshError::NotFinite { vertex, point: points[vertex].to_array() }),
        None => Ok(()),
    }
}

/// Whether so many elements can be counted with 32-bit ids; the last id is kept for "none".
pub(crate) fn fits(count: usize) -> bool {
    count < u32::MAX as usize
}

/// Checks that so many elements can be counted with 32-bit ids.
pub(crate) fn check_size(what: &'static str, count: usize) -> Result<(), MeshError> {
    if fits(count) { Ok(()) } else { Err(MeshError::TooLarge { what, count }) }
}

pub(crate) fn check_vertex(
    what: &'static str,
    index: usize,
    vertex: u32,
    vertex_count: usize,
) -> Result<(), MeshError> {
    if (vertex as usize) < vertex_count {
        Ok(())
    } else {
        Err(MeshError::VertexOutOfRange { what, index, vertex, vertex_count })
    }
}

pub(crate) fn check_sharpness(what: &'static str, index: usize, sharpness: f32) -> Result<(), MeshError> {
    if sharpness >= 0.0 { Ok(()) } else { Err(MeshError::Sharpness { what, index, sharpness }) }
}

/// Marked corners, as (vertex, sharpness) with sharpness above 0.
pub(crate) fn check_corners(vertex_count: usize, features: &Features) -> Result<Vec<(u32, f32)>, MeshError> {
    let mut corners = Vec::with_capacity(features.corners.len() + features.soft_corners.len());
    for (index, &vertex) in features.corners.iter().enumerate() {
        check_vertex("corner", index, vertex, vertex_count)?;
        corners.push((vertex, INFINITE_SHARPNESS));
    }
    for (index, &(vertex, sharpness)) in features.soft_corners.iter().enumerate() {
        check_vertex("corner", index, vertex, vertex_count)?;
        check_sharpness("corner", index, sharpness)?;
        if sharpness > 0.0 {
            corners.push((vertex, sharpness));
        }
    }
    Ok(corners)
}

/// Whether no two faces have the same vertices; `sorted_faces` are the vertices of each face, sorted.
pub(crate) fn check_duplicates<Face: Ord + Send>(
    sorted_faces: impl Iterator<Item = Face>,
) -> Result<(), MeshError> {
    let mut faces: Vec<(Face, FaceId)> =
        sorted_faces.enumerate().map(|(f, face)| (face, FaceId(id(f)))).collect();
    faces.par_sort_unstable();
    let equal = faces.windows(2).filter(|pair| pair[0].0 == pair[1].0);
    match equal.map(|pair| (pair[0].1, pair[1].1)).min() {
        Some((first, second)) => Err(MeshError::DuplicateFace { first, second }),
        None => Ok(()),
    }
}

/// Whether faces have three or more corners, all different and within range, and no two of them the same.
pub(crate) fn check_faces(vertex_count: usize, faces: &[Vec<u32>]) -> Result<(), MeshError> {
    let mut sorted_faces = Vec::with_capacity(faces.len());
    for (index, face) in faces.iter().enumerate() {
        if face.len() < 3 {
            return Err(MeshError::TooFewCorners { face: FaceId(id(index)), corners: face.len() });
        }
        for &vertex in face {
            check_vertex("face", index, vertex, vertex_count)?;
        }
        let mut sorted = face.clone();
        sorted.sort_unstable();
        if let Some(pair) = sorted.windows(2).find(|pair| pair[0] == pair[1]) {
            return Err(MeshError::Degenerate { what: "face", index, vertex: pair[0] });
        }
        sorted_faces.push(sorted);
    }
    check_duplicates(sorted_faces.into_iter())
}
