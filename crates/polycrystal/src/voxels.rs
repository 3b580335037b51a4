//! Networks from labels of voxels, as measured maps have them.
//!
//! Boundaries start as the faces between voxels of different grains. Each point then moves within a box around the middle of its eight voxels, 0.49 of a voxel each way, so that
//! no voxel changes its grain: the boundaries bend as little as they can there, and every grain keeps the volume of its voxels.

mod bending;
mod elements;
mod graph;
mod labels;
mod lattice;
mod pattern;
mod staircase;
mod tuning;
mod untangling;
mod volumes;

use std::ops::Deref;

use glam::{BVec3, DVec3};
use rayon::prelude::*;

use crate::mesh::grouped::Grouped;
use crate::mesh::id::id;
use crate::{Certificate, Junctions, Network, NetworkError, Side, Surface};
use bending::{Boxes, least_bending};
use elements::CutFaces;
use graph::Graph;
use labels::OUTSIDE;
pub use labels::{VoxelLabel, Voxels};
use lattice::Lattice;
use staircase::Staircase;
pub use tuning::VoxelTuning;
use untangling::{Untangling, starts};
use volumes::VolumeSearch;

/// The smooth network of labelled voxels.
#[derive(Debug, Clone)]
pub struct SmoothedVoxels {
    /// Valid but for folds, which grains one voxel thick have.
    pub network: Network,
    /// The points of its only level.
    pub points: Vec<DVec3>,
    /// What the network is like. Its only faults are folds.
    pub certificate: Certificate,
    /// Number of voxels that got another label, because a grain touched itself in a point or along an edge where it could not be parted.
    pub relabelled: usize,
}

/// The network of grains that voxels are labelled with, as smooth as it can be while each voxel stays in its grain and grains have the volumes of their voxels.
///
/// `progress` is told how many steps of how many are done. Points of boundaries follow the mean of their neighbours, points of lines that of both neighbours along the line,
/// by least squares within boxes (after Lempitsky, Surface extraction from binary volumes with higher-order smoothness, 2010, here for any number of labels).
/// Lines that go where grains touch along an edge only are parted for the grain with more voxels.
///
/// ```
/// use polycrystal::{GrainId, Junctions, VoxelLabel, Voxels, smooth_voxels};
/// use voronoi::Domain;
///
/// // 4 x 4 x 4 voxels, x fastest: two grains that meet in the middle.
/// let labels = (0..64).map(|voxel| VoxelLabel::of(GrainId(u32::from(voxel % 4 >= 2)))).collect();
/// let voxels = Voxels::new(Domain::unit_cube(), [4, 4, 4], labels);
/// let smoothed = smooth_voxels(&voxels, Junctions::Crease, |_done, _of| ())?;
/// assert!(smoothed.certificate.is_good());
/// assert_eq!(smoothed.network.grain_count(), 2);
/// # Ok::<(), polycrystal::NetworkError>(())
/// ```
///
/// # Errors
/// [`NetworkError::NoGrain`]; [`NetworkError::MissingGrain`] where some number below the largest has no voxel; [`NetworkError::VoxelsTouch`] when a grain touches itself and its voxels
/// cannot be relabelled; [`NetworkError::Invalid`] when elements cross that could not be untangled, or volumes are not those of the voxels.
pub fn smooth_voxels(
    voxels: &Voxels,
    junctions: Junctions,
    progress: impl Fn(usize, usize) + Sync,
) -> Result<SmoothedVoxels, NetworkError> {
    smooth_voxels_tuned(voxels, junctions, &VoxelTuning::default(), progress)
}

/// As [`smooth_voxels`], by other numbers than its own.
#[doc(hidden)]
pub fn smooth_voxels_tuned(
    voxels: &Voxels,
    junctions: Junctions,
    tuning: &VoxelTuning,
    progress: impl Fn(usize, usize) + Sync,
) -> Result<SmoothedVoxels, NetworkError> {
    let mut lattice = Lattice::new(voxels)?;
    let mut mixed = lattice.mixed_places();
    let relabelled = lattice.part_what_touches(&mut mixed)?;
    let staircase = Staircase::new(&lattice, &mixed);
    let points = smoothed_points(&staircase, &lattice, tuning, &progress);
    let cut = points.cut;
    let sides: Vec<[Side; 2]> =
        staircase.kinds.iter().map(|kind| kind.labels.map(|label| VoxelLabel(label).side())).collect();
    let points = in_domain(voxels, &staircase, &points.places);
    let volume = voxels.spacing().element_product();
    let volumes: Vec<f64> = lattice.counts.iter().map(|count| *count as f64 * volume).collect();
    let surface =
        Surface { points: &points, elements: cut.elements(), boundary_of: &cut.kind_of, sides: &sides };
    let (network, points, certificate) =
        Network::of_measured(voxels.domain(), &surface, Some(&volumes), junctions)?;
    Ok(SmoothedVoxels { network, points, certificate, relabelled })
}

/// Points of a staircase, in units of voxels, and its elements.
struct SmoothedPoints {
    places: Vec<DVec3>,
    cut: CutFaces,
}

fn smoothed_points(
    staircase: &Staircase,
    lattice: &Lattice,
    tuning: &VoxelTuning,
    progress: &(impl Fn(usize, usize) + Sync),
) -> SmoothedPoints {
    let middles: Vec<DVec3> =
        staircase.places.par_iter().map(|place| DVec3::from_array(place.map(|at| at as f64))).collect();
    let is_fixed: Vec<BVec3> = staircase.places.par_iter().map(|place| lattice.is_on_walls(*place)).collect();
    let boxes = Boxes { middles: &middles, is_fixed: &is_fixed, within: tuning.within };
    let faces_at = grouped(middles.len(), staircase.faces.len(), |face| staircase.faces.corners(face));
    let graph = Graph::new(staircase, &faces_at);
    let starts = starts(&middles, &faces_at, |face| staircase.faces.corners(face as usize), tuning.apart);
    let mut points = least_bending(&graph, &starts, &boxes, tuning, progress);
    let cut = CutFaces::new(staircase, &points);
    let sides: Vec<[Side; 2]> =
        staircase.kinds.iter().map(|kind| kind.labels.map(|label| VoxelLabel(label).side())).collect();
    let elements = cut.elements();
    let at_points = grouped(points.len(), elements.len(), |element| elements.corners(id(element)));
    let wanted: Vec<f64> = lattice.counts.iter().map(|count| *count as f64).collect();
    let search = VolumeSearch {
        surface: Surface { points: &middles, elements, boundary_of: &cut.kind_of, sides: &sides },
        at_points: &at_points,
        wanted: &wanted,
        is_open: staircase.kinds.iter().any(|kind| kind.wall.is_none() && kind.labels[1] == OUTSIDE),
        rounds: tuning.volume_rounds,
        longest: tuning.longest_motion,
    };
    let volume_error = search.restore(&mut points, &boxes, &vec![false; middles.len()]);
    let untangling = Untangling { graph: &graph, boxes: &boxes, starts: &starts, search: &search, tuning };
    let places = untangling.untangle(points, volume_error);
    SmoothedPoints { places, cut }
}

/// The faces at each point.
fn grouped<C: Deref<Target = [u32]> + Clone>(
    points: usize,
    faces: usize,
    corners: impl Fn(usize) -> C,
) -> Grouped<u32> {
    let of_face = |face: usize| {
        let corners = corners(face);
        (0..corners.len()).map(move |k| (corners[k] as usize, id(face)))
    };
    Grouped::new(points, (0..faces).flat_map(of_face))
}

/// Points in the unit of the domain: exactly on its walls where they were on those of the lattice.
fn in_domain(voxels: &Voxels, staircase: &Staircase, points: &[DVec3]) -> Vec<DVec3> {
    let (lower, upper, spacing) = (voxels.domain().lower(), voxels.domain().upper(), voxels.spacing());
    let of_point = |(point, place): (&DVec3, &[usize; 3])| {
        let inside = lower + *point * spacing;
        let is_upper = BVec3::from_array(std::array::from_fn(|axis| place[axis] == voxels.shape()[axis]));
        DVec3::select(is_upper, upper, inside)
    };
    points.par_iter().zip(&staircase.places).map(of_point).collect()
}
