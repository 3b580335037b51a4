//! Measures of cells and faces.

use glam::DVec3;
use rayon::prelude::*;

use crate::diagram::cell_sum::{CellSum, KeptMeasures};
use crate::diagram::planar_measures::planar_measures;
use crate::diagram::polygon::{FaceMeasure, Polygon};
use crate::{CellId, CellMeasure, Dimension, FaceId, Side, Tessellation, VertexId};

/// Distance of the places that Lloyd's algorithm moves seeds to, along each axis and as a share of the domain's extent; a seed that one of
/// them is no nearer to stays. This is far below the distance of seeds, and far above the 1e-15 or so by which centroids are off: that would
/// tilt columns and layers of cells, and tear their corners into edges of 1e-12.
const LLOYD_GRID: f64 = 1.0 / (1u64 << 40) as f64;

impl Tessellation {
    /// Volume, surface and counts of every cell.
    pub fn cell_measures(&self) -> Vec<CellMeasure> {
        cell_measures(self)
    }

    /// The area of a face; in the plane its length.
    pub fn face_area(&self, face: FaceId) -> f64 {
        face_area_and_centroid(self, face).0
    }

    /// The centroid of every cell, in the domain. That of an empty cell is its seed.
    pub fn centroids(&self) -> Vec<DVec3> {
        let cells = self.cell_measures();
        cells.iter().zip(&self.seeds).map(|(cell, seed)| self.nearest_inside(cell.centroid, *seed)).collect()
    }

    /// The seeds after a step of Lloyd's algorithm: in the centroids of their cells, but for the last digits. Those of seeds that lie in one
    /// plane or repeat are the same afterwards too, although centroids are not known that well.
    ///
    /// Steps even the cells out: each lowers the sum over all cells of the integral of `|x - s|^2 - w`.
    pub fn lloyd_step(&self) -> Vec<DVec3> {
        self.toward_centroids(&self.cell_measures(), 1.0)
    }

    /// The same for a fraction of the way, given the cells' measures.
    pub(crate) fn toward_centroids(&self, measures: &[CellMeasure], fraction: f64) -> Vec<DVec3> {
        let lower = self.domain.lower();
        let grid = LLOYD_GRID * self.domain.size().max_element();
        let moved = measures.iter().zip(&self.seeds).map(|(cell, seed)| {
            let goal = if fraction < 1.0 { seed.lerp(cell.centroid, fraction) } else { cell.centroid };
            let stays = (goal - *seed).abs().cmplt(DVec3::splat(0.5 * grid));
            let place = DVec3::select(stays, *seed, lower + ((goal - lower) / grid).round() * grid);
            self.nearest_inside(place, *seed)
        });
        moved.collect()
    }

    /// A place in the domain that is a goal, or beside it on the way to a seed.
    fn nearest_inside(&self, goal: DVec3, seed: DVec3) -> DVec3 {
        let (lower, upper) = (self.domain.lower(), self.domain.upper());
        // Across periodic walls the cell of a seed inside may have its centroid outside.
        let wrapped = self.domain.wrapped(goal);
        // Rounding may put the centroid of a very thin cell a last place outside.
        let clamped = wrapped.clamp(lower, upper);
        // The same beside an oblique wall, where the way to the seed leads inside.
        let steps = (-52..=0).map(|exponent| clamped.lerp(seed, 2f64.powi(exponent)));
        let mut places = std::iter::once(clamped).chain(steps);
        places.find(|place| self.domain.contains(*place)).unwrap_or(seed)
    }
}

fn cell_measures(tessellation: &Tessellation) -> Vec<CellMeasure> {
    if tessellation.domain.dimension() == Dimension::Two {
        return planar_measures(tessellation);
    }
    if let KeptMeasures(Some(measures)) = &tessellation.measures {
        return measures.par_iter().copied().collect();
    }
    let face_measures: Vec<FaceMeasure> = (0..tessellation.face_count())
        .into_par_iter()
        .map(|face| face_measure(tessellation, FaceId(u32::try_from(face).expect("face ids fit 32 bits"))))
        .collect();
    let cells = (0..tessellation.cell_count()).into_par_iter();
    let measure = |cell: usize| {
        let cell = CellId(u32::try_from(cell).expect("cell ids fit 32 bits"));
        let seed = tessellation.seeds[cell.index()];
        let mut sum = CellSum::default();
        for &face in tessellation.cell_faces(cell) {
            let is_first = tessellation.face_sides(face)[0] == Side::Cell(cell);
            sum.add_face(&face_measures[face.index()], seed, if is_first { 1.0 } else { -1.0 });
        }
        sum.measure(seed)
    };
    cells.map(measure).collect()
}

/// Area and centroid of a face; in the plane length and middle of an edge.
pub(crate) fn face_area_and_centroid(tessellation: &Tessellation, face: FaceId) -> (f64, DVec3) {
    if let &[start, end] = tessellation.face_corners(face) {
        let [start, end] = [start, end].map(|end| tessellation.vertices[end.index()]);
        return (start.distance(end), start.midpoint(end));
    }
    let measure = face_measure(tessellation, face);
    (measure.doubled_area / 2.0, measure.centroid)
}

fn face_measure(tessellation: &Tessellation, face: FaceId) -> FaceMeasure {
    let corners = tessellation.face_corners(face);
    let at = |corner: &VertexId| tessellation.vertices[corner.index()];
    let first = at(&corners[0]);
    let triangles = corners[1..].windows(2).map(|ends| (at(&ends[0]) - first).cross(at(&ends[1]) - first));
    let mut polygon = Polygon::from(first, triangles.sum());
    corners[1..].iter().for_each(|corner| polygon.go_to(at(corner)));
    polygon.measure(u32::try_from(corners.len()).expect("corners were counted in 32 bits"))
}
