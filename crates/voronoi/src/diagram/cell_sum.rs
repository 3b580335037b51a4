//! What the faces of cells add up to.

use glam::DVec3;

use crate::diagram::polygon::FaceMeasure;

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

/// What the faces of a cell add up to: the cell consists of cones from its seed to its faces.
#[derive(Debug, Default, Clone, Copy)]
pub(crate) struct CellSum {
    /// Six times the volume.
    cones: f64,
    /// That times the centroid, relative to the seed.
    moment: DVec3,
    doubled_area: f64,
    face_count: u32,
    corner_count: u32,
}

impl CellSum {
    /// Adds a face whose normal points outward times `direction`; `seed` and the face are relative to the same place.
    #[inline]
    pub(crate) fn add_face(&mut self, face: &FaceMeasure, seed: DVec3, direction: f64) {
        let to_face = face.centroid - seed;
        let cone = direction * to_face.dot(face.normal);
        // A cone's centroid lies at three quarters of the way from its tip to that of its base.
        self.add(&Self {
            cones: cone,
            moment: to_face * (0.75 * cone),
            doubled_area: face.doubled_area,
            face_count: 1,
            corner_count: face.corner_count,
        });
    }

    #[inline]
    pub(crate) fn add(&mut self, other: &Self) {
        self.cones += other.cones;
        self.moment += other.moment;
        self.doubled_area += other.doubled_area;
        self.face_count += other.face_count;
        self.corner_count += other.corner_count;
    }

    /// Takes other numbers of faces and of their corners: those that are left where vertices coincide.
    pub(crate) fn set_counts(&mut self, faces: u32, corners: u32) {
        (self.face_count, self.corner_count) = (faces, corners);
    }

    pub(crate) fn face_count(&self) -> u32 {
        self.face_count
    }

    pub(crate) fn measure(&self, seed: DVec3) -> CellMeasure {
        let face_count = self.face_count as usize;
        // Each edge has a corner in either of its faces, and Euler's formula holds but for an empty cell.
        let edge_count = self.corner_count as usize / 2;
        CellMeasure {
            volume: self.cones / 6.0,
            area: self.doubled_area / 2.0,
            face_count,
            vertex_count: (edge_count + 2).saturating_sub(face_count.max(2)),
            edge_count,
            centroid: if self.cones > 0.0 { seed + self.moment / self.cones } else { seed },
        }
    }
}

/// Measures that were summed while the cells were cut. They follow from the rest of a tessellation, and do not tell one that has
/// them from one that has not.
#[derive(Debug, Default, Clone)]
pub(crate) struct KeptMeasures(pub(crate) Option<Vec<CellMeasure>>);

impl PartialEq for KeptMeasures {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}
