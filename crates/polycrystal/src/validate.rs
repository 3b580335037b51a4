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
    #[error("{count} edges inside boundaries are folded by more than 90 degrees; relax for a shorter time")]
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
