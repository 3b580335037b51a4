//! Where a polyhedron is, before it is known to be one.

use std::sync::Arc;

use glam::DVec3;

use crate::clip::clipping::Clipping;
use crate::clip::convex_cell::ConvexCell;
use crate::clip::convex_polygon::ConvexPolygon;
use crate::exact::frame::{Facets, Frame};
use crate::exact::generator::{Generator, Plane};
use crate::exact::image::ImageTable;
use crate::exact::input::ExactInput;
use crate::{Dimension, Domain, VoronoiError, Wall, WallPlane};

/// How much farther than its walls a polyhedron may reach from the origin: beyond, it counts as unbounded.
const FARTHEST: f64 = (1u64 << 30) as f64;

/// Where a polyhedron is.
pub(crate) struct Extent {
    pub(crate) lower: DVec3,
    pub(crate) upper: DVec3,
    /// Mean of its vertices.
    pub(crate) center: DVec3,
}

impl Extent {
    /// Cuts what the walls leave out of a box much larger than they are.
    pub(crate) fn of(facets: &Arc<Facets>, dimension: Dimension) -> Result<Self, VoronoiError> {
        let Facets { planes: walls, normals } = &**facets;
        if let Some(wall) =
            walls.iter().zip(normals).position(|(wall, normal)| !is_plane(wall, *normal, dimension))
        {
            return Err(VoronoiError::BadHalfSpace { wall });
        }
        let distances: Vec<f64> = walls.iter().map(distance_from_origin).collect();
        let is_far = |distance: &f64| distance.is_nan() || distance > Domain::LENGTHS.end();
        if let Some(wall) = distances.iter().position(is_far) {
            return Err(VoronoiError::FarHalfSpace { wall, distance: distances[wall] });
        }
        let farthest = distances.into_iter().fold(0.0, f64::max);
        let in_plane = if dimension == Dimension::Two { DVec3::new(1.0, 1.0, 0.0) } else { DVec3::ONE };
        let corner = in_plane * FARTHEST * if farthest > 0.0 { farthest } else { 1.0 };
        let frame = Frame::new(-corner, corner, dimension.axes().into(), Some(Arc::clone(facets)));
        let (seeds, images) = ([DVec3::ZERO], ImageTable::default());
        let input = ExactInput { frame: &frame, seeds: &seeds, weights: None, images: &images };
        match dimension {
            Dimension::Three => Self::cut(ConvexCell::new(0, input), input),
            Dimension::Two => Self::cut(ConvexPolygon::new(0, input), input),
        }
    }

    fn cut(mut cell: impl Clipping, input: ExactInput) -> Result<Self, VoronoiError> {
        for wall in (0u32..).take(input.frame.wall_planes().len()).map(Wall) {
            cell.cut(Generator::facet(wall), input);
            if cell.radius() < 0.0 {
                return Err(VoronoiError::EmptyDomain { wall: wall.index() });
            }
        }
        // To the last place, so that boxes of round numbers have round numbers.
        let exact = |planes| (planes, input.vertex(0, planes));
        let corners: Vec<([Generator; 3], DVec3)> = cell.vertices().into_iter().map(exact).collect();
        let is_side = |generator: &Generator| matches!(generator.plane(), Plane::Side(side) if !is_drawing_plane(side, input));
        if let Some((_, corner)) = corners.iter().find(|(generators, _)| generators.iter().any(is_side)) {
            return Err(VoronoiError::UnboundedDomain { direction: corner.normalize_or_zero() });
        }
        let positions = || corners.iter().map(|(_, position)| *position);
        Ok(Self {
            lower: positions().fold(DVec3::INFINITY, DVec3::min),
            upper: positions().fold(DVec3::NEG_INFINITY, DVec3::max),
            center: positions().sum::<DVec3>() / corners.len() as f64,
        })
    }
}

/// In the plane, z = 0 is a side through every corner.
fn is_drawing_plane(side: Wall, input: ExactInput) -> bool {
    input.frame.axes == 2 && side.axis() == 2
}

fn is_plane(wall: &WallPlane, normal: DVec3, dimension: Dimension) -> bool {
    let numbers = match wall {
        WallPlane::HalfSpace { normal, offset } => normal.is_finite() && offset.is_finite(),
        WallPlane::Through(points) => points.iter().all(|point| point.is_finite()),
    };
    numbers
        && normal != DVec3::ZERO
        && normal.is_finite()
        && (dimension == Dimension::Three || normal.z == 0.0)
}

fn distance_from_origin(wall: &WallPlane) -> f64 {
    match wall {
        WallPlane::HalfSpace { normal, offset } => {
            // Scaled first, for squares of very large or small coordinates leave the range of doubles.
            let scale = normal.abs().max_element();
            offset.abs() / scale / (*normal / scale).length()
        }
        WallPlane::Through(points) => points.iter().map(|point| point.length()).fold(0.0, f64::max),
    }
}
