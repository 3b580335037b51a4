use cancellation::check_cancelled;
use glam::DVec3;
use rayon::prelude::*;

use crate::LevelView;
use crate::mesh::adjacency::Adjacency;
use crate::mesh::boundary_elements::{BoundaryElements, BoundaryNeighbors};
use crate::mesh::fold::is_folded;
use crate::mesh::level_points::LevelPoints;

/// Normal of a triangle, or normal of a segment in the plane, as long as twice its area or as its length.
pub(crate) fn element_normals<'a>(level: impl Into<LevelView<'a>>, points: &[DVec3]) -> Vec<DVec3> {
    level.into().elements().normals(points)
}

/// Pairs of neighbouring elements of one boundary whose normals are more than the angle apart whose cosine is given.
///
/// 0 finds folds over 90 degrees. Elements without area count as folded.
///
/// ```
/// use glam::DVec3;
/// use polycrystal::{Junctions, Network, folded_edges};
/// use voronoi::{Domain, Tessellation};
///
/// let seeds = [DVec3::new(0.3, 0.4, 0.5), DVec3::new(0.7, 0.3, 0.2), DVec3::new(0.6, 0.8, 0.9)];
/// let cells = Tessellation::new(&Domain::unit_cube(), &seeds)?;
/// let (network, flat) = Network::new(&cells, Junctions::Crease, 2)?;
/// assert!(folded_edges(network.finest(), &network.subdivide(&flat), 0.0).is_empty());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn folded_edges<'a>(level: impl Into<LevelView<'a>>, points: &[DVec3], cosine: f64) -> Vec<[u32; 2]> {
    let level = level.into();
    let normals = element_normals(level, points);
    let normals = |pair: &[u32; 2]| pair.map(|element| normals[element as usize]);
    let pairs = Adjacency::of_level(level).inner.pairs();
    pairs.into_par_iter().filter(|pair| is_folded(normals(pair), cosine)).collect()
}

/// The pairs of neighbours that are folded in some boundary, sorted, without normals of more than a boundary at a time.
pub(crate) fn folded_neighbors(
    points: &LevelPoints<'_>,
    boundaries: &BoundaryElements<'_>,
    neighbors: &BoundaryNeighbors<'_>,
    cosine: f64,
) -> Vec<[u32; 2]> {
    let of_boundary = |boundary: usize| {
        check_cancelled();
        let normals = boundaries.normals(boundary, points);
        folded_in_boundary(boundaries, neighbors, boundary, &normals, cosine)
    };
    let boundaries = (0..boundaries.boundary_count()).into_par_iter();
    let mut folded: Vec<[u32; 2]> = boundaries.flat_map_iter(of_boundary).collect();
    folded.par_sort_unstable();
    folded
}

/// The pairs of neighbours that are folded in a boundary whose elements have these normals.
pub(crate) fn folded_in_boundary(
    boundaries: &BoundaryElements<'_>,
    neighbors: &BoundaryNeighbors<'_>,
    boundary: usize,
    normals: &[DVec3],
    cosine: f64,
) -> Vec<[u32; 2]> {
    let mut folded = Vec::new();
    neighbors.for_each_in(boundaries, boundary, |pair| {
        if is_folded(pair.map(|index| normals[index]), cosine) {
            let mut pair = pair.map(|index| boundaries.element(boundary, index));
            pair.sort_unstable();
            folded.push(pair);
        }
    });
    folded
}
