//! What is found of each boundary by itself.

use cancellation::check_cancelled;
use glam::DVec3;
use rayon::prelude::*;
use voronoi::Dimension;

use crate::check::box_tree::Bounds;
use crate::check::folds::folded_in_boundary;
use crate::check::intersections::{Extent, bounds_in};
use crate::check::normal_cone::NormalCone;
use crate::mesh::adjacency::Adjacency;
use crate::mesh::boundary_elements::{BoundaryElements, BoundaryNeighbors};
use crate::mesh::level_points::LevelPoints;
use crate::mesh::triangle_quality::{SmallestAngles, squared_sine};
use crate::mesh::volume::{Cone, ElementSum};
use crate::{Surface, TriangleQuality};

/// Cosine of the angle between normals beyond which neighbours in one boundary are folded: 90 degrees, and as much more as
/// single precision, in which many files keep coordinates, blurs the right angles of a box.
const FOLD_COSINE: f64 = -1e-6;

/// What is found of each boundary by itself: no more of a boundary is held at a time than its own elements.
pub(crate) struct BoundarySurvey {
    /// What each boundary takes up of space.
    pub(crate) extents: Vec<Extent>,
    /// The cone to each boundary from a point of it.
    pub(crate) cones: Vec<Cone>,
    /// The area of each boundary; in the plane its length.
    pub(crate) areas: Vec<f64>,
    /// Elements without area, in order.
    pub(crate) flat: Vec<u32>,
    /// Pairs of neighbours that are folded, in order.
    pub(crate) folded: Vec<[u32; 2]>,
    /// How thin triangles are, in space.
    pub(crate) triangles: Option<TriangleQuality>,
}

/// The same of one boundary.
struct Surveyed {
    extent: Extent,
    cone: Cone,
    area: f64,
    flat: Vec<u32>,
    folded: Vec<[u32; 2]>,
}

impl BoundarySurvey {
    pub(crate) fn new(
        surface: &Surface<'_>,
        boundaries: &BoundaryElements<'_>,
        adjacency: &Adjacency<'_>,
    ) -> Self {
        let neighbors = BoundaryNeighbors::new(surface.boundary_of, boundaries, adjacency);
        let none = || (SmallestAngles::new(surface.elements.len()), Vec::new());
        let survey = |(mut angles, mut surveyed): (SmallestAngles, Vec<Surveyed>), boundary: usize| {
            check_cancelled();
            surveyed.push(Surveyed::new(surface, boundaries, &neighbors, boundary, &mut angles));
            (angles, surveyed)
        };
        let join = |(angles, mut surveyed): (SmallestAngles, Vec<Surveyed>), (other, others): (_, Vec<_>)| {
            surveyed.extend(others);
            (angles.with(other), surveyed)
        };
        let (angles, surveyed) =
            (0..boundaries.boundary_count()).into_par_iter().fold(none, survey).reduce(none, join);
        let mut all = Self {
            extents: Vec::with_capacity(surveyed.len()),
            cones: Vec::with_capacity(surveyed.len()),
            areas: Vec::with_capacity(surveyed.len()),
            flat: Vec::new(),
            folded: Vec::new(),
            triangles: angles.quality(),
        };
        for Surveyed { extent, cone, area, flat, folded } in surveyed {
            all.extents.push(extent);
            all.cones.push(cone);
            all.areas.push(area);
            all.flat.extend(flat);
            all.folded.extend(folded);
        }
        all.flat.sort_unstable();
        all.folded.sort_unstable();
        all
    }
}

impl Surveyed {
    fn new(
        surface: &Surface<'_>,
        boundaries: &BoundaryElements<'_>,
        neighbors: &BoundaryNeighbors<'_>,
        boundary: usize,
        angles: &mut SmallestAngles,
    ) -> Self {
        let elements = surface.elements;
        let dimension = elements.dimension();
        let points = LevelPoints::held(elements, surface.points);
        let mut bounds = Bounds::default();
        let mut normals = Vec::with_capacity(boundaries.count(boundary));
        let mut sum = ElementSum::default();
        for labelled in boundaries.labelled(boundary) {
            bounds = bounds.with(bounds_in(surface, *labelled));
            points.for_each_in(*labelled, |corners| {
                if let [a, b, c] = *corners {
                    angles.add(squared_sine([a, b, c]));
                }
                normals.push(sum.add(corners));
            });
        }
        // Normals of triangles are as long as twice the area.
        let share = if dimension == Dimension::Two { 1.0 } else { 0.5 };
        let has_area = |pair: &[u32; 2]| {
            pair.iter().all(|element| elements.normal(surface.points, *element) != DVec3::ZERO)
        };
        let mut folded = folded_in_boundary(boundaries, neighbors, boundary, &normals, FOLD_COSINE);
        folded.retain(has_area);
        let flat = normals.iter().enumerate().filter(|(_, normal)| **normal == DVec3::ZERO);
        Self {
            extent: Extent { bounds, normals: NormalCone::of(&normals) },
            cone: sum.cone(dimension),
            area: normals.iter().map(|normal| share * normal.length()).sum(),
            flat: flat.map(|(index, _)| boundaries.element(boundary, index)).collect(),
            folded,
        }
    }
}
