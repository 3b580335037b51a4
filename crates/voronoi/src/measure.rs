use glam::DVec3;
use rayon::prelude::*;

use crate::Dimension;
use crate::planar_measures::planar_measures;
use crate::tessellation::{CellId, FaceId, Side, Tessellation, VertexId};

/// Size and counts of one cell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CellMeasure {
    /// Volume; in the plane, area.
    pub volume: f64,
    /// Surface area with the parts on walls; in the plane, perimeter.
    pub area: f64,
    /// Number of faces; in the plane, of edges.
    pub face_count: usize,
    /// Number of vertices.
    pub vertex_count: usize,
    /// Number of edges; in the plane the same as `face_count`.
    pub edge_count: usize,
    /// Centre of mass; the seed for an empty cell.
    pub centroid: DVec3,
}

pub(crate) fn cell_measures(tessellation: &Tessellation) -> Vec<CellMeasure> {
    if tessellation.domain.dimension() == Dimension::Two {
        return planar_measures(tessellation);
    }
    let order = in_space(tessellation);
    let faces = 0..tessellation.face_count();
    let face_id = |face: usize| FaceId(u32::try_from(face).expect("face ids fit 32 bits"));
    let face_measures: Vec<FaceMeasure> =
        faces.into_par_iter().map(|face| face_measure(tessellation, face_id(face))).collect();
    let sorted: Vec<CellMeasure> =
        order.par_iter().map(|cell| measure(tessellation, &face_measures, *cell)).collect();
    let mut measures = sorted.clone();
    for (cell, measure) in order.iter().zip(sorted) {
        measures[cell.index()] = measure;
    }
    measures
}

/// The cells in the order of the faces, which is that of space: what neighbours read is in the cache.
fn in_space(tessellation: &Tessellation) -> Vec<CellId> {
    let mut is_listed = vec![false; tessellation.cell_count()];
    let mut order = Vec::with_capacity(tessellation.cell_count());
    let mut list = |cell: CellId| {
        if !std::mem::replace(&mut is_listed[cell.index()], true) {
            order.push(cell);
        }
    };
    for [first, _] in &tessellation.face_sides {
        if let Side::Cell(cell) = first {
            list(*cell);
        }
    }
    (0u32..).take(tessellation.cell_count()).map(CellId).for_each(list);
    order
}

/// What both cells of a face need of it.
#[derive(Clone, Copy)]
struct FaceMeasure {
    /// Normal toward the second side, as long as twice the area.
    normal: DVec3,
    centroid: DVec3,
}

fn face_measure(tessellation: &Tessellation, face: FaceId) -> FaceMeasure {
    let ring = tessellation.face_corners(face);
    let first = tessellation.vertices[ring[0].index()];
    // Relative to a corner, for a face far from the origin would lose digits.
    let at = |corner: VertexId| tessellation.vertices[corner.index()] - first;
    // Each triangle counts by its area along the normal of all, which is known at the end only: the moments are summed for
    // each coordinate of the triangles' own normals.
    let (mut normal, mut moments) = (DVec3::ZERO, [DVec3::ZERO; 3]);
    let mut b = at(ring[1]);
    for corner in &ring[2..] {
        let c = at(*corner);
        let (triangle, ends) = (b.cross(c), b + c);
        normal += triangle;
        moments[0] += ends * triangle.x;
        moments[1] += ends * triangle.y;
        moments[2] += ends * triangle.z;
        b = c;
    }
    let weight = normal.length_squared();
    let moment = moments[0] * normal.x + moments[1] * normal.y + moments[2] * normal.z;
    let centroid = if weight > 0.0 { first + moment / (3.0 * weight) } else { first };
    FaceMeasure { normal, centroid }
}

fn measure(tessellation: &Tessellation, face_measures: &[FaceMeasure], cell: CellId) -> CellMeasure {
    let seed = tessellation.seeds[cell.index()];
    // The cell consists of cones from its seed to its faces, here with six times their volumes.
    let (mut cones, mut doubled_area, mut moment) = (0.0, 0.0, DVec3::ZERO);
    let mut corner_count = 0;
    for &face in tessellation.cell_faces(cell) {
        corner_count += tessellation.face_corners(face).len();
        let FaceMeasure { normal, centroid } = face_measures[face.index()];
        let to_face = centroid - seed;
        let is_first = tessellation.face_sides(face)[0] == Side::Cell(cell);
        let cone = if is_first { to_face.dot(normal) } else { -to_face.dot(normal) };
        cones += cone;
        // A cone's centroid lies at three quarters of the way from its tip to that of its base.
        moment += to_face * (0.75 * cone);
        doubled_area += normal.length();
    }
    let (volume, area) = (cones / 6.0, doubled_area / 2.0);
    let face_count = tessellation.cell_faces(cell).len();
    // Each edge has a corner in either of its faces, and Euler's formula holds but for an empty cell.
    let edge_count = corner_count / 2;
    let vertex_count = (edge_count + 2).saturating_sub(face_count.max(2));
    let centroid = if cones > 0.0 { seed + moment / cones } else { seed };
    CellMeasure { volume, area, face_count, vertex_count, edge_count, centroid }
}
