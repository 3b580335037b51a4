use glam::DVec3;
use rayon::prelude::*;

use crate::Dimension;
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
}

pub(crate) fn cell_measures(tessellation: &Tessellation) -> Vec<CellMeasure> {
    let count = u32::try_from(tessellation.cell_count()).expect("cell ids fit 32 bits");
    (0..count).into_par_iter().map(|cell| measure(tessellation, CellId(cell))).collect()
}

fn measure(tessellation: &Tessellation, cell: CellId) -> CellMeasure {
    let seed = tessellation.seeds[cell.index()];
    let (mut volume, mut area) = (0.0, 0.0);
    let mut corners = Vec::new();
    for &face in tessellation.cell_faces(cell) {
        let ring = tessellation.face_corners(face);
        corners.extend_from_slice(ring);
        // Relative to the seed, for a cell far from the origin would lose digits.
        let at = |k: usize| tessellation.vertices[ring[k].index()] - seed;
        let outward = if tessellation.face_sides(face)[0] == Side::Cell(cell) { 1.0 } else { -1.0 };
        match tessellation.domain.dimension() {
            Dimension::Two => {
                volume += outward * 0.5 * at(0).truncate().perp_dot(at(1).truncate());
                area += at(0).distance(at(1));
            }
            Dimension::Three => {
                let pairs = (1..ring.len() - 1).map(|k| (at(k) - at(0)).cross(at(k + 1) - at(0)));
                let doubled: DVec3 = pairs.sum();
                volume += outward * at(0).dot(doubled) / 6.0;
                area += 0.5 * doubled.length();
            }
        }
    }
    corners.sort_unstable();
    corners.dedup();
    CellMeasure { volume, area, face_count: tessellation.cell_faces(cell).len(), vertex_count: corners.len() }
}
