//! Domains from the surfaces of convex bodies.

use std::collections::BTreeMap;

use glam::DVec3;

use crate::domain::check_sides;
use crate::{Dimension, Domain, VoronoiError, WallPlane};

/// How far a vertex may lie outside a face's plane, or a face's normal off that of one in the same plane, in units of the
/// body's size and of 1: surfaces have rounded coordinates, and files often six digits.
const FLATNESS: f64 = 1e-6;

impl Domain {
    /// The body in a closed convex surface of polygons, given by their vertices; their order tells neither inside from outside
    /// nor matters otherwise.
    ///
    /// Neighbouring faces in one plane make one wall, that through three vertices of its largest face. Walls that share
    /// a vertex meet in it exactly unless it is one of more than three corners of a face that rounding bent; then they may
    /// meet in several corners, as far apart as the rounding.
    ///
    /// # Errors
    /// [`VoronoiError::OpenSurface`] names an edge without a second face, [`VoronoiError::NotConvex`] a vertex outside a face by
    /// more than a millionth of the body's size; [`VoronoiError::BadDomain`] and [`VoronoiError::FlatDomain`].
    ///
    /// # Panics
    /// When a face refers to a vertex that does not exist.
    pub fn convex_surface(points: &[DVec3], faces: &[Vec<u32>]) -> Result<Self, VoronoiError> {
        check_closed(faces)?;
        let used = || faces.iter().flatten().map(|corner| points[*corner as usize]);
        let (lower, upper) =
            (used().fold(DVec3::INFINITY, DVec3::min), used().fold(DVec3::NEG_INFINITY, DVec3::max));
        if !faces.is_empty() {
            check_sides(lower, upper, Dimension::Three)?;
        }
        let size = (upper - lower).length();
        let center = lower.midpoint(upper);
        let at = |corner: u32| points[corner as usize] - center;
        let doubled_area = |face: &[u32]| -> DVec3 {
            (1..face.len().saturating_sub(1))
                .map(|k| (at(face[k]) - at(face[0])).cross(at(face[k + 1]) - at(face[0])))
                .sum()
        };
        let volume: f64 = faces
            .iter()
            .map(|face| face.first().map_or(0.0, |first| at(*first).dot(doubled_area(face))))
            .sum();
        // Largest faces first: their planes are known best.
        let mut order: Vec<(f64, usize)> =
            faces.iter().enumerate().map(|(number, face)| (-doubled_area(face).length(), number)).collect();
        order.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let mut walls: Vec<(usize, WallPlane)> = Vec::new();
        let mut planes: Vec<(DVec3, f64)> = Vec::new();
        for (_, number) in order {
            let face = &faces[number];
            let normal = (doubled_area(face) * volume.signum()).normalize_or_zero();
            if normal == DVec3::ZERO {
                // A face without area bounds nothing; its neighbours do.
                continue;
            }
            let distance = normal.dot(at(face[0]));
            let is_known = |(other, offset): &(DVec3, f64)| {
                other.distance(normal) < FLATNESS && (offset - distance).abs() < FLATNESS * size
            };
            if planes.iter().any(is_known) {
                continue;
            }
            let outside =
                faces.iter().flatten().find(|corner| normal.dot(at(**corner)) - distance > FLATNESS * size);
            if let Some(vertex) = outside {
                return Err(VoronoiError::NotConvex { face: number, vertex: *vertex as usize });
            }
            planes.push((normal, distance));
            walls.push((number, WallPlane::Through(widest_triangle(points, face, normal))));
        }
        walls.sort_by_key(|(number, _)| *number);
        let name = format!("a convex surface with {} faces", walls.len());
        Self::cut_out(walls.into_iter().map(|(_, wall)| wall).collect(), Dimension::Three, Some(name))
    }
}

/// Three corners of a face, far apart, counter-clockwise around a normal.
fn widest_triangle(points: &[DVec3], face: &[u32], normal: DVec3) -> [DVec3; 3] {
    let corners = || face.iter().map(|corner| points[*corner as usize]);
    let first = points[face[0] as usize];
    let by = |measure: &dyn Fn(DVec3) -> f64| {
        corners().max_by(|a, b| measure(*a).total_cmp(&measure(*b))).unwrap_or(first)
    };
    let second = by(&|corner| corner.distance_squared(first));
    let third = by(&|corner| (second - first).cross(corner - first).length_squared());
    if (second - first).cross(third - first).dot(normal) > 0.0 {
        [first, second, third]
    } else {
        [first, third, second]
    }
}

/// Each edge must have two faces, which walk it in opposite senses.
fn check_closed(faces: &[Vec<u32>]) -> Result<(), VoronoiError> {
    let mut walks: BTreeMap<[u32; 2], usize> = BTreeMap::new();
    let edges = |face: usize| {
        let corners = &faces[face];
        let next = corners.iter().cycle().skip(1);
        corners.iter().zip(next).map(|(from, to)| [*from, *to]).collect::<Vec<_>>()
    };
    for face in 0..faces.len() {
        for ends in edges(face) {
            if walks.insert(ends, face).is_some() {
                return Err(VoronoiError::OpenSurface { face, ends });
            }
        }
    }
    match (0..faces.len())
        .flat_map(|face| edges(face).into_iter().map(move |ends| (face, ends)))
        .find(|(_, [from, to])| !walks.contains_key(&[*to, *from]))
    {
        Some((face, ends)) => Err(VoronoiError::OpenSurface { face, ends }),
        None => Ok(()),
    }
}
