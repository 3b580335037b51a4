//! Integrals over boundaries and grains, summed triangle by triangle.

use std::f64::consts::PI;

use glam::{DMat3, DVec3};
use voronoi::Dimension;

use super::{BoundaryMeasures, GrainMeasures};
use crate::mesh::volume::triangle_volume;
use crate::{BoundaryId, GrainId, Side};

/// The lines around a boundary.
#[derive(Debug, Clone, Default)]
pub(super) struct Rim {
    pub(super) edge_count: usize,
    pub(super) perimeter: f64,
}

/// Integrals over a boundary.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Sums {
    pub(super) area: f64,
    /// The sum of the normals of triangles, as long as their areas.
    pub(super) normal: DVec3,
    /// The integral over the area of the position, from the origin.
    pub(super) area_moment: DVec3,
    pub(super) origin: DVec3,
    /// Lengths of edges times their exterior angles.
    pub(super) edges: f64,
}

impl Sums {
    pub(super) fn of(triangles: impl Iterator<Item = [DVec3; 3]> + Clone) -> Self {
        let mut sums =
            Self { origin: triangles.clone().next().map_or(DVec3::ZERO, |[a, ..]| a), ..Self::default() };
        for corners in triangles {
            let [a, b, c] = corners.map(|corner| corner - sums.origin);
            let normal = 0.5 * (b - a).cross(c - a);
            sums.area += normal.length();
            sums.normal += normal;
            sums.area_moment += (a + b + c) * (normal.length() / 3.0);
        }
        sums
    }

    pub(super) fn boundary(&self, boundary: BoundaryId, sides: [Side; 2], rim: &Rim) -> BoundaryMeasures {
        let per_area = if self.area > 0.0 { 1.0 / self.area } else { 0.0 };
        BoundaryMeasures {
            boundary,
            sides,
            area: self.area,
            centroid: self.origin + self.area_moment * per_area,
            mean_normal: self.normal * per_area,
            edge_count: rim.edge_count,
            perimeter: rim.perimeter,
            // An edge has half its angle as the integral of mean curvature across it.
            mean_curvature: 0.5 * self.edges * per_area,
        }
    }
}

/// Integrals over a grain, as the sum of cones to its boundaries.
///
/// Their apex is a point of the grain: of a grain that is small against its distance, cones from elsewhere leave no digit.
#[derive(Debug, Clone, Copy)]
pub(super) struct Enclosed {
    pub(super) apex: Option<DVec3>,
    pub(super) volume: f64,
    pub(super) first_moment: DVec3,
    pub(super) second_moment: DMat3,
}

impl Default for Enclosed {
    /// Nothing yet. What glam calls the default of a matrix is the identity.
    fn default() -> Self {
        Self { apex: None, volume: 0.0, first_moment: DVec3::ZERO, second_moment: DMat3::ZERO }
    }
}

impl Enclosed {
    pub(super) fn add_cones(&mut self, triangles: impl Iterator<Item = [DVec3; 3]>, sign: f64) {
        let square = |v: DVec3| DMat3::from_cols(v * v.x, v * v.y, v * v.z);
        for corners in triangles {
            let apex = *self.apex.get_or_insert(corners[0]);
            let [a, b, c] = corners.map(|corner| corner - apex);
            let volume = sign * triangle_volume([a, b, c]);
            let sum = a + b + c;
            self.volume += volume;
            // A tetrahedron's integrals of r and of r r^T, one corner being the apex.
            self.first_moment += sum * (volume / 4.0);
            self.second_moment += (square(a) + square(b) + square(c) + square(sum)) * (volume / 20.0);
        }
    }
}

#[derive(Debug, Default)]
pub(super) struct GrainSums {
    pub(super) area: f64,
    pub(super) enclosed: Enclosed,
    /// Lengths times exterior angles of all edges.
    pub(super) edges: f64,
    /// The same within boundaries to other grains.
    pub(super) inner_edges: f64,
    pub(super) triple_line_length: f64,
    pub(super) edge_count: usize,
    pub(super) vertex_count: usize,
    /// Edges of all faces together.
    pub(super) edges_of_faces: usize,
    /// The sides beyond its boundaries.
    pub(super) beyond: Vec<Side>,
}

impl GrainSums {
    pub(super) fn add_boundary(&mut self, boundary: &Sums, beyond: Side, edges: f64) {
        self.area += boundary.area;
        self.edges += edges;
        if beyond != Side::Exterior {
            self.inner_edges += edges;
        }
        self.beyond.push(beyond);
    }

    pub(super) fn measures(self, grain: GrainId) -> GrainMeasures {
        let area = self.area;
        let Enclosed { apex, volume, first_moment, second_moment } = self.enclosed;
        let centroid = first_moment / volume;
        let square = DMat3::from_cols(centroid * centroid.x, centroid * centroid.y, centroid * centroid.z);
        let central = second_moment - square * volume;
        let trace = central.x_axis.x + central.y_axis.y + central.z_axis.z;
        let equivalent_diameter = Dimension::Three.ball_diameter(volume);
        let mean_width = self.edges / (4.0 * PI);
        let is_at_exterior = self.beyond.contains(&Side::Exterior);
        let mut neighbors: Vec<GrainId> = self.beyond.iter().filter_map(|side| side.grain()).collect();
        neighbors.sort_unstable();
        neighbors.dedup();
        let growth_rate = -2.0 * PI * (2.0 * mean_width - self.triple_line_length / 6.0);
        let face_count = self.beyond.len();
        GrainMeasures {
            grain,
            volume,
            area,
            centroid: apex.unwrap_or_default() + centroid,
            inertia: DMat3::from_diagonal(DVec3::splat(trace)) - central,
            sphericity: PI * equivalent_diameter.powi(2) / area,
            equivalent_diameter,
            neighbors,
            is_at_exterior,
            face_count,
            edge_count: self.edge_count,
            vertex_count: self.vertex_count,
            edges_per_face: self.edges_of_faces as f64 / face_count as f64,
            mean_width,
            integral_mean_curvature: 2.0 * PI * mean_width,
            triple_line_length: self.triple_line_length,
            growth_rate: (!is_at_exterior).then_some(growth_rate),
            // An edge has its angle as the integral of the sum of the principal curvatures across it.
            curvature_rate: -self.inner_edges,
        }
    }
}
