//! Size and counts of cells in the plane.

use glam::DVec3;
use rayon::prelude::*;

use crate::{CellMeasure, Side, Tessellation};

/// What each edge adds to its cells, edge by edge: edges are in the order of space, and cells in the user's.
pub(crate) fn planar_measures(tessellation: &Tessellation) -> Vec<CellMeasure> {
    let none = CellMeasure {
        volume: 0.0,
        area: 0.0,
        face_count: 0,
        vertex_count: 0,
        edge_count: 0,
        centroid: DVec3::ZERO,
    };
    let mut measures = vec![none; tessellation.cell_count()];
    for face in tessellation.faces() {
        let &[start, end] = tessellation.face_corners(face) else { unreachable!("an edge has two ends") };
        let ends = [start, end].map(|end| tessellation.vertices[end.index()]);
        let length = ends[0].distance(ends[1]);
        for (side, direction) in tessellation.face_sides(face).into_iter().zip([1.0, -1.0]) {
            let Side::Cell(cell) = side else { continue };
            // Relative to the seed, for a cell far from the origin would lose digits.
            let [from, to] = ends.map(|end| end - tessellation.seeds[cell.index()]);
            let triangle = direction * 0.5 * from.truncate().perp_dot(to.truncate());
            let measure = &mut measures[cell.index()];
            measure.volume += triangle;
            measure.area += length;
            measure.face_count += 1;
            // Not yet divided by the area.
            measure.centroid += (from + to) * (triangle / 3.0);
        }
    }
    measures.par_iter_mut().zip(&tessellation.seeds).for_each(|(measure, seed)| {
        (measure.vertex_count, measure.edge_count) = (measure.face_count, measure.face_count);
        measure.centroid =
            if measure.volume > 0.0 { seed + measure.centroid / measure.volume } else { *seed };
    });
    measures
}
