use glam::DVec3;
use rayon::prelude::*;

use crate::crease_uses::{CreaseUse, crease_uses};
use crate::folds::{element_normals, folded_edges};
use crate::{GrainId, Level, Mesh, Network, Side};

/// Largest difference of a grain's volume from its cell's, as a share of the cell's, in a valid network.
const VOLUME_TOLERANCE: f64 = 1e-9;

/// What a valid network was found to be like.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Validation {
    /// Largest difference of a grain's volume from its cell's, as a share of the cell's.
    pub largest_volume_error: f64,
    /// Difference of the grains' total volume from the domain's, as a share of the domain's.
    pub total_volume_error: f64,
}

/// What makes a network invalid. Places are numbers of the finest level.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum Fault {
    /// A point has a coordinate that is NaN or infinite.
    #[error("point {vertex} is not finite")]
    NotFinite {
        /// The point.
        vertex: usize,
    },
    /// Elements have no area (in the plane: no length).
    #[error(
        "{count} triangles or segments have no area, the first is number {first}; seeds may be too close"
    )]
    NoArea {
        /// Number of elements.
        count: usize,
        /// The first of them.
        first: usize,
    },
    /// Different points stand at the same place.
    #[error("{count} points stand at the place of another; seeds may be too close")]
    DuplicatePoints {
        /// Number of points.
        count: usize,
    },
    /// A grain's surface has a hole, or an element winds the wrong way.
    #[error("grains are not closed at {count} edges")]
    Open {
        /// Number of edges where the grains around do not close.
        count: usize,
    },
    /// Elements of one boundary are folded over each other.
    #[error(
        "{count} edges inside boundaries are folded by more than 90 degrees; use fewer levels, or move seeds apart that nearly share a vertex"
    )]
    Folded {
        /// Number of edges.
        count: usize,
    },
    /// A grain does not have the volume of its cell.
    #[error("the volume of grain {} differs from its cell's by {relative_error:e} of it", grain.0)]
    WrongVolume {
        /// The grain that is farthest off.
        grain: GrainId,
        /// The difference as a share of the cell's volume.
        relative_error: f64,
    },
    /// The grains do not fill the domain.
    #[error("the grains' volumes sum to the domain's but for {relative_error:e} of it")]
    WrongTotal {
        /// The difference as a share of the domain's volume.
        relative_error: f64,
    },
}

/// Checks the finest level of a network with the given points: closed grains of the right volume, no folds, no
/// elements without area, no two points at one place.
///
/// # Errors
/// The first [`Fault`] found.
pub fn validate(network: &Network, points: &[DVec3]) -> Result<Validation, Fault> {
    let level = network.finest();
    if let Some(vertex) = points.iter().position(|point| !point.is_finite()) {
        return Err(Fault::NotFinite { vertex });
    }
    let normals = element_normals(level, points);
    let without_area = || normals.iter().enumerate().filter(|(_, normal)| normal.length() == 0.0);
    if let Some((first, _)) = without_area().next() {
        return Err(Fault::NoArea { count: without_area().count(), first });
    }
    fail_on(duplicate_points(points), |count| Fault::DuplicatePoints { count })?;
    fail_on(open_places(network, level), |count| Fault::Open { count })?;
    fail_on(folded_edges(level, points, 0.0).len(), |count| Fault::Folded { count })?;
    check_volumes(network, level, points)
}

fn fail_on(count: usize, fault: impl Fn(usize) -> Fault) -> Result<(), Fault> {
    if count == 0 { Ok(()) } else { Err(fault(count)) }
}

fn duplicate_points(points: &[DVec3]) -> usize {
    // Adding zero gives -0 the bits of 0.
    let bits = |point: &DVec3| (*point + DVec3::ZERO).to_array().map(f64::to_bits);
    let mut places: Vec<[u64; 3]> = points.par_iter().map(bits).collect();
    places.par_sort_unstable();
    places.windows(2).filter(|pair| pair[0] == pair[1]).count()
}

/// Places (edges, in the plane vertices) where the surface of some grain, or of the exterior, does not close.
///
/// Only places where boundaries meet can be open: inside a boundary the mesh pairs triangles that wind alike.
fn open_places(network: &Network, level: &Level) -> usize {
    let uses = crease_uses(level);
    let is_open = |at: &[CreaseUse]| {
        // Each use walks the place one way for its first side and the other way for its second.
        let mut walks: Vec<(Side, i32)> = Vec::with_capacity(2 * at.len());
        for at in at {
            let boundary = &network.boundaries()[level.boundary_of[at.element as usize].index()];
            let direction = direction(&level.mesh, at);
            walks.extend(boundary.sides.into_iter().zip([direction, -direction]));
        }
        walks.sort_unstable();
        walks.chunk_by(|a, b| a.0 == b.0).any(|walks| walks.iter().map(|(_, way)| way).sum::<i32>() != 0)
    };
    uses.chunk_by(|a, b| a.place == b.place).filter(|at| is_open(at)).count()
}

/// 1 where the element runs along the edge (in the plane: starts at the vertex), -1 where against it.
fn direction(mesh: &Mesh, at: &CreaseUse) -> i32 {
    let is_along = match mesh {
        Mesh::Triangles(mesh) => {
            let corner = mesh.triangles()[at.element as usize][usize::from(at.corner)];
            corner == mesh.edge(at.place)[0]
        }
        Mesh::Segments(_) => at.corner == 0,
    };
    if is_along { 1 } else { -1 }
}

fn check_volumes(network: &Network, level: &Level, points: &[DVec3]) -> Result<Validation, Fault> {
    let volumes = network.grain_volumes(level, points);
    let whole = network.domain().measure();
    let total_volume_error = (volumes.iter().sum::<f64>() / whole - 1.0).abs();
    let errors = volumes.iter().zip(network.cell_volumes()).map(|(grain, cell)| (grain / cell - 1.0).abs());
    let (grain, largest_volume_error) = (0u32..)
        .map(GrainId)
        .zip(errors)
        .max_by(|a, b| a.1.total_cmp(&b.1))
        .expect("a network has at least one grain");
    if largest_volume_error > VOLUME_TOLERANCE {
        return Err(Fault::WrongVolume { grain, relative_error: largest_volume_error });
    }
    if total_volume_error > VOLUME_TOLERANCE {
        return Err(Fault::WrongTotal { relative_error: total_volume_error });
    }
    Ok(Validation { largest_volume_error, total_volume_error })
}

#[cfg(test)]
mod tests {
    use voronoi::{Domain, Tessellation};

    use super::*;
    use crate::{Boundary, Junctions};

    fn cubes(domain: &Domain) -> (Network, Vec<DVec3>) {
        let middle = 0.5 * domain.size().z;
        let seeds: Vec<DVec3> = (0..4)
            .map(|i| DVec3::new(f64::from(i % 2) * 0.5 + 0.25, f64::from(i / 2) * 0.5 + 0.25, middle))
            .collect();
        let tessellation = Tessellation::new(domain, &seeds).expect("valid seeds");
        let (network, flat) = Network::new(&tessellation, Junctions::Crease, 1).expect("a small network");
        let points = network.subdivide(&flat);
        (network, points)
    }

    /// A point inside a boundary, for the faults to start from.
    fn inner_point(network: &Network) -> usize {
        let node_types = &network.finest().node_types;
        node_types.iter().position(|node_type| *node_type == crate::NodeType::INTERIOR).expect("a boundary")
    }

    #[test]
    fn good_networks_pass() {
        for domain in [Domain::unit_cube(), Domain::unit_square()] {
            let (network, points) = cubes(&domain);
            let validation = validate(&network, &points).expect("valid");
            assert!(validation.largest_volume_error < 1e-14 && validation.total_volume_error < 1e-14);
        }
    }

    #[test]
    fn a_point_that_is_no_number_is_found() {
        let (network, mut points) = cubes(&Domain::unit_cube());
        points[7].y = f64::NAN;
        assert_eq!(validate(&network, &points), Err(Fault::NotFinite { vertex: 7 }));
    }

    #[test]
    fn points_at_the_same_place_are_found() {
        let (network, mut points) = cubes(&Domain::unit_cube());
        // Two points with no triangle in common.
        let last = points.len() - 1;
        points[last] = points[0];
        assert_eq!(validate(&network, &points), Err(Fault::DuplicatePoints { count: 1 }));
    }

    #[test]
    fn triangles_and_segments_without_size_are_found() {
        for domain in [Domain::unit_cube(), Domain::unit_square()] {
            let (network, mut points) = cubes(&domain);
            let (a, b) = match &network.finest().mesh {
                Mesh::Triangles(mesh) => (mesh.triangles()[0][0], mesh.triangles()[0][1]),
                Mesh::Segments(mesh) => (mesh.segments()[0][0], mesh.segments()[0][1]),
            };
            points[a as usize] = points[b as usize];
            assert!(matches!(validate(&network, &points), Err(Fault::NoArea { .. })));
        }
    }

    #[test]
    fn folds_are_found() {
        for domain in [Domain::unit_cube(), Domain::unit_square()] {
            let (network, mut points) = cubes(&domain);
            // Out of its own fan, within the plane of its boundary.
            let inner = inner_point(&network);
            points[inner] += DVec3::new(0.01, 0.9, 0.0);
            assert!(matches!(validate(&network, &points), Err(Fault::Folded { .. })));
        }
    }

    #[test]
    fn grains_of_the_wrong_volume_are_found() {
        for domain in [Domain::unit_cube(), Domain::unit_square()] {
            let (network, mut points) = cubes(&domain);
            points[inner_point(&network)] += DVec3::new(1e-4, 1e-4, 0.0);
            assert!(matches!(validate(&network, &points), Err(Fault::WrongVolume { .. })));
        }
    }

    #[test]
    fn grains_that_are_not_closed_are_found() {
        for domain in [Domain::unit_cube(), Domain::unit_square()] {
            let (mut network, points) = cubes(&domain);
            let wrong: &mut Boundary = network.boundary_mut(0);
            wrong.sides = [Side::Grain(GrainId(2)), Side::Grain(GrainId(3))];
            assert!(matches!(validate(&network, &points), Err(Fault::Open { .. })));
        }
    }
}
