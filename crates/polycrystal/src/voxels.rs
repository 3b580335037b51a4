//! Networks from labels of voxels, as measured maps have them.
//!
//! Boundaries start as the faces between voxels of different grains. Each point then moves within a box around the middle of its eight voxels, 0.49 of a voxel each way, so that
//! no voxel changes its grain: the boundaries bend as little as they can there, and every grain keeps the volume of its voxels.

mod bending;
mod copies;
mod decimation;
mod elements;
mod graph;
mod labels;
mod lattice;
mod neighbors;
mod pattern;
mod staircase;
mod surface;
mod tiles;
mod tuning;
mod untangling;
mod volume_slopes;
mod volumes;
mod whole_grains;

use glam::{DVec3, Vec3};

use crate::network::labelled_mesh::but_folded;
use crate::validate::certificate;
use crate::{Certificate, Junctions, Network, NetworkError, Surface};
use bending::{Boxes, least_bending};
use decimation::{Decimation, Faulty};
use elements::{CutFaces, at_corners};
use graph::Graph;
use labels::Grid;
pub use labels::{VoxelLabel, Voxels};
use lattice::Lattice;
use staircase::{Staircase, sides_of_whole_grains};
use surface::VoxelSurface;
pub use tuning::VoxelTuning;
use untangling::{Untangling, starts};
use volumes::{VolumeSearch, Wanted};
use whole_grains::whole_grains;

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

/// How voxels become a network.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VoxelOptions {
    /// How subdivision of the network would smooth its lines.
    pub junctions: Junctions,
    /// Edges that are shorter than so many edges of a voxel collapse, where grains are large enough; 0 keeps all. Of lines between two points where four or more grains
    /// meet only those shorter than two fifths of that do.
    pub shortest_edge: f64,
}

impl VoxelOptions {
    /// Every point of the boundaries of voxels: no voxel changes its grain.
    pub const ALL_POINTS: Self = Self { junctions: Junctions::Crease, shortest_edge: 0.0 };
}

/// The network of grains that voxels are labelled with, as smooth as it can be while each voxel stays in its grain and grains have the volumes of their voxels.
///
/// `progress` is told how many steps of how many are done. Points of boundaries follow the mean of their neighbours, points of lines that of both neighbours along the line,
/// by least squares within boxes (after Lempitsky, Surface extraction from binary volumes with higher-order smoothness, 2010, here for any number of labels).
/// Lines that go where grains touch along an edge only are parted for the grain with more voxels. Where the box has periods, grains go on through its sides, and are whole.
///
/// Then short edges collapse, if that is asked for. Grains keep their volumes, but the middle of a voxel near a boundary may come to lie in the grain beyond.
/// Where the certificate finds a fault in what is left, more points stay.
///
/// ```
/// use polycrystal::{GrainId, VoxelLabel, VoxelOptions, Voxels, smooth_voxels};
/// use voronoi::Domain;
///
/// // 4 x 4 x 4 voxels, x fastest: two grains that meet in the middle.
/// let labels = (0..64).map(|voxel| VoxelLabel::of(GrainId(u32::from(voxel % 4 >= 2)))).collect();
/// let voxels = Voxels::new(Domain::unit_cube(), [4, 4, 4], labels);
/// let smoothed = smooth_voxels(voxels, VoxelOptions::ALL_POINTS, |_done, _of| ())?;
/// assert!(smoothed.certificate.is_good());
/// assert_eq!(smoothed.network.grain_count(), 2);
/// # Ok::<(), polycrystal::NetworkError>(())
/// ```
///
/// # Errors
/// [`NetworkError::NoGrain`]; [`NetworkError::MissingGrain`] where some number below the largest has no voxel; [`NetworkError::VoxelsTouch`] when a grain touches itself and its voxels
/// cannot be relabelled; [`NetworkError::ShortPeriod`], [`NetworkError::EndlessGrain`] and [`NetworkError::PeriodicPores`] where the box has periods; [`NetworkError::Invalid`] when elements cross that could not be untangled, or volumes are not those of the voxels.
pub fn smooth_voxels(
    voxels: Voxels,
    options: VoxelOptions,
    progress: impl Fn(usize, usize) + Sync,
) -> Result<SmoothedVoxels, NetworkError> {
    smooth_voxels_tuned(voxels, options, &VoxelTuning::default(), &progress)
}

/// As [`smooth_voxels`], by other numbers than its own.
#[doc(hidden)]
pub fn smooth_voxels_tuned(
    voxels: Voxels,
    options: VoxelOptions,
    tuning: &VoxelTuning,
    progress: &(dyn Fn(usize, usize) + Sync),
) -> Result<SmoothedVoxels, NetworkError> {
    let (staircase, counts, relabelled) = {
        let mut lattice = Lattice::new(&voxels)?;
        let mut mixed = lattice.mixed_places();
        let relabelled = lattice.part_what_touches(&mut mixed)?;
        (Staircase::new(&lattice, &mixed, &whole_grains(&lattice, &mixed)?), lattice.counts, relabelled)
    };
    // Where there are many voxels, memory is short.
    let Voxels { grid, labels } = voxels;
    drop(labels);
    let is_periodic = grid.domain.is_periodic();
    let kinds = staircase.kinds.clone();
    let sides = sides_of_whole_grains(&kinds, is_periodic);
    let counts: Vec<f64> = counts.iter().map(|count| *count as f64).collect();
    let wanted = Wanted { volumes: &counts, sides: &sides };
    let whole = smoothed(staircase, &grid, &wanted, tuning, progress);
    let voxel = grid.spacing().element_product();
    let volumes: Vec<f64> = counts.iter().map(|count| count * voxel).collect();
    let network = |found: &VoxelSurface| -> Result<SmoothedVoxels, (NetworkError, Faulty)> {
        let points = found.in_domain(&grid);
        let faulty = |error: NetworkError, surface: &Surface<'_>| {
            let faulty = match &error {
                NetworkError::Invalid(faults) => Faulty::new(faults, surface, &grid),
                _ => Faulty::default(),
            };
            (error, faulty)
        };
        let (network, points, certificate) = if is_periodic {
            let faces = found.torus_faces(&kinds);
            let (network, points) =
                Network::of_torus_faces(&grid.domain, &points, faces, volumes.clone(), options.junctions)
                    .map_err(|error| (error, Faulty::default()))?;
            let certificate =
                but_folded(certificate(&network, &points, network.cell_volumes())).map_err(|error| {
                    let sides = network.sides();
                    faulty(error, &Surface::of_level(network.finest(), &points, &sides))
                })?;
            (network, points, certificate)
        } else {
            let elements = found.cut.elements();
            let surface =
                Surface { points: &points, elements, boundary_of: &found.cut.kind_of, sides: &sides };
            Network::of_measured(&grid.domain, &surface, Some(&volumes), options.junctions)
                .map_err(|error| faulty(error, &surface))?
        };
        Ok(SmoothedVoxels { network, points, certificate, relabelled })
    };
    if options.shortest_edge > 0.0 {
        let decimation = Decimation {
            whole: &whole,
            grid: &grid,
            kinds: &kinds,
            wanted: &wanted,
            shortest_edge: options.shortest_edge,
            tuning,
        };
        let mut is_held = vec![false; whole.points.len()];
        for _ in 0..tuning.decimations {
            match network(&decimation.decimated(&is_held)) {
                Ok(found) => return Ok(found),
                Err((NetworkError::Invalid(_), faulty)) => decimation.hold(&mut is_held, &faulty),
                Err((other, _)) => return Err(other),
            }
        }
    }
    network(&whole).map_err(|(error, _)| error)
}

/// The boundaries between voxels, bent as little as their boxes allow, with the volumes wanted and without crossings.
fn smoothed(
    staircase: Staircase,
    grid: &Grid,
    wanted: &Wanted<'_>,
    tuning: &VoxelTuning,
    progress: &(dyn Fn(usize, usize) + Sync),
) -> VoxelSurface {
    let boxes = Boxes::new(&staircase.places, grid, tuning.within);
    let (graph, starts) = {
        let faces = &staircase.faces;
        let faces_at = at_corners(staircase.places.len(), faces.len(), |face| faces.corners(face));
        let corners = |face: u32| faces.corners(face as usize);
        (Graph::new(&staircase, &faces_at), starts(&boxes, &faces_at, corners, tuning.apart))
    };
    let mut points = least_bending(&graph, &starts, &boxes, tuning, progress);
    let apart: Vec<(u32, Vec3)> = (0u32..).zip(starts).filter(|(_, start)| *start != Vec3::ZERO).collect();
    let cut = CutFaces::new(&staircase, grid, &points);
    // Where there are many voxels, memory is short.
    drop((staircase.faces, staircase.kind_of));
    let search = VolumeSearch::new(points.len(), &cut, wanted, tuning);
    let restored = search.restore(&mut points, &boxes, &vec![false; graph.count()]);
    let untangling = Untangling { graph: &graph, boxes: &boxes, apart: &apart, search: &search, tuning };
    let points = untangling.untangle(points, restored);
    VoxelSurface { points, places: staircase.places, cut }
}
