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

/// What both cells of a face need of it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct FaceMeasure {
    /// Normal toward the second side, as long as twice the area.
    normal: DVec3,
    doubled_area: f64,
    centroid: DVec3,
    corner_count: u32,
}

/// A plane polygon, corner by corner. Its triangles from the first corner on count by their area along the normal.
pub(crate) struct Polygon {
    first: DVec3,
    /// Relative to the first corner, for a face far from the origin would lose digits.
    last: DVec3,
    /// Its largest coordinate is 1.
    normal: DVec3,
    /// Twice the area, times the length of the normal.
    weight: f64,
    moment: DVec3,
}

impl Polygon {
    /// From the first corner on. The normal may have any length.
    #[inline]
    pub(crate) fn from(first: DVec3, normal: DVec3) -> Self {
        // The square of the length of a normal between seeds that nearly coincide can be too small for a number.
        let size = normal.abs().max_element();
        let normal = if size > 0.0 { normal / size } else { DVec3::ZERO };
        Self { first, last: DVec3::ZERO, normal, weight: 0.0, moment: DVec3::ZERO }
    }

    #[inline]
    pub(crate) fn go_to(&mut self, corner: DVec3) {
        let next = corner - self.first;
        let triangle = self.last.cross(next).dot(self.normal);
        self.weight += triangle;
        self.moment += (self.last + next) * triangle;
        self.last = next;
    }

    #[inline]
    pub(crate) fn measure(&self, corner_count: u32) -> FaceMeasure {
        if self.weight == 0.0 {
            return FaceMeasure {
                normal: DVec3::ZERO,
                doubled_area: 0.0,
                centroid: self.first,
                corner_count,
            };
        }
        let squared_length = self.normal.length_squared();
        let normal = self.normal * (self.weight / squared_length);
        let doubled_area = self.weight.abs() / squared_length.sqrt();
        FaceMeasure {
            normal,
            doubled_area,
            centroid: self.first + self.moment / (3.0 * self.weight),
            corner_count,
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

pub(crate) fn cell_measures(tessellation: &Tessellation) -> Vec<CellMeasure> {
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
