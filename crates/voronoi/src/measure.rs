use glam::DVec3;
use rayon::prelude::*;

use crate::Dimension;
use crate::planar_measures::planar_measures;
use crate::tessellation::{CellId, Side, Tessellation};

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
    let sorted: Vec<CellMeasure> = order.par_iter().map(|cell| measure(tessellation, *cell)).collect();
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

fn measure(tessellation: &Tessellation, cell: CellId) -> CellMeasure {
    let seed = tessellation.seeds[cell.index()];
    let (mut volume, mut area, mut moment) = (0.0, 0.0, DVec3::ZERO);
    let mut corner_count = 0;
    for &face in tessellation.cell_faces(cell) {
        let ring = tessellation.face_corners(face);
        corner_count += ring.len();
        // Relative to the seed, for a cell far from the origin would lose digits.
        let at = |k: usize| tessellation.vertices[ring[k].index()] - seed;
        let outward = if tessellation.face_sides(face)[0] == Side::Cell(cell) { 1.0 } else { -1.0 };
        let mut doubled = DVec3::ZERO;
        for k in 1..ring.len() - 1 {
            let normal = (at(k) - at(0)).cross(at(k + 1) - at(0));
            let tetrahedron = outward * at(0).dot(normal) / 6.0;
            doubled += normal;
            moment += (at(0) + at(k) + at(k + 1)) * (tetrahedron / 4.0);
        }
        volume += outward * at(0).dot(doubled) / 6.0;
        area += 0.5 * doubled.length();
    }
    let face_count = tessellation.cell_faces(cell).len();
    // Each edge has a corner in either of its faces, and Euler's formula holds but for an empty cell.
    let edge_count = corner_count / 2;
    let vertex_count = (edge_count + 2).saturating_sub(face_count.max(2));
    let centroid = if volume > 0.0 { seed + moment / volume } else { seed };
    CellMeasure { volume, area, face_count, vertex_count, edge_count, centroid }
}
