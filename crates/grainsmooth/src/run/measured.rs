//! From a measured map to its network.

use std::path::Path;
use std::time::{Duration, Instant};

use glam::{BVec3, DVec3};
use polycrystal::{
    Certificate, Certified, GrainId, Junctions, Level, Mesh, NetworkError, Relaxation, RelaxationStep,
    SmoothedVoxels, Subdivided, Volumes, VoxelLabel, VoxelOptions, Voxels, herring_residual, relax_certified,
    smooth_voxels, validate,
};

use super::fitted_cells::{FittedCells, fitted_cells};
use super::given::grains_called;
use super::origin::{Measurement, SmoothedMap};
use super::polycrystal::Polycrystal;
use super::stage::{Progress, Stage};
use crate::maps::label_map::{LabelMap, MeasuredCrystals, MeasuredMap};
use crate::memory::{ControlMesh, LevelSize, Motion, available_memory, check_levels};
use crate::{
    Error, FileOptions, GrainAttributes, GrainPhases, GrainTexture, MapNetworkOptions, MeasuredAttributes,
};

/// What is said of a map that is smoothed.
#[derive(Debug, Clone)]
pub struct MapRun {
    /// The command that asks for it, for files to tell.
    pub command_line: String,
    /// How files are written.
    pub file: FileOptions,
    /// What the network is to be like.
    pub network: MapNetworkOptions,
    /// Time that reading the map took.
    pub read_in: Duration,
}

/// The smooth network of a map.
///
/// ```
/// use std::path::Path;
/// use std::time::Duration;
///
/// use grainsmooth::glam::{BVec3, DVec3};
/// use grainsmooth::{FileOptions, LabelMap, MapNetworkOptions, MapOptions, MapRun, MeasuredMap, smooth_map};
///
/// // 4 x 4 x 4 voxels, x fastest: grains 10 and 20. A file would be read by `read_map`.
/// let labels = (0..64).map(|voxel| if voxel % 4 < 2 { 10 } else { 20 }).collect();
/// let map = LabelMap { shape: [4, 4, 4], spacing: DVec3::ONE, origin: DVec3::ZERO, periodic: BVec3::FALSE, labels };
/// let measured = MeasuredMap::of_labels(map, &MapOptions { min_voxels: 1, ..MapOptions::default() })?;
/// let network = MapNetworkOptions { decimate: Some(0.0), ..MapNetworkOptions::default() };
/// let run = MapRun { command_line: String::new(), file: FileOptions::default(), network, read_in: Duration::ZERO };
/// let polycrystal = smooth_map(Path::new("labels in memory"), measured, run, &|_, _, _| ())?;
/// assert_eq!(polycrystal.network.grain_count(), 2);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`Error::NetworkOfMap`], [`Error::MixedVoxels`] and [`Error::RelaxesFolded`] where the map leads to none.
pub fn smooth_map(
    path: &Path,
    measured: MeasuredMap,
    run: MapRun,
    progress: Progress<'_>,
) -> Result<Polycrystal, Error> {
    let failed = |cause| Error::NetworkOfMap { path: path.to_owned(), cause: Box::new(cause) };
    progress(Stage::Network, 0, 1);
    let start = Instant::now();
    let mut map = SmoothedMap {
        shape: measured.map.shape,
        dropped: measured.dropped,
        points: measured.crystals.as_ref().map(|crystals| crystals.points.clone()),
        relabelled: 0,
        slices: measured.map.middle_slices(),
        fit: None,
    };
    let grains = attributes(&measured);
    let (network, points, certificate) = if run.network.fit_cells {
        let FittedCells { network, points, fit } = fitted_cells(path, &measured)?;
        map.fit = Some(fit);
        let certificate =
            validate(&network, &points).map_err(|faults| failed(NetworkError::Invalid(faults)))?;
        (network, points, certificate)
    } else {
        let options = VoxelOptions {
            junctions: Junctions::Crease,
            shortest_edge: run.network.shortest_edge(measured.map.is_plane()),
        };
        let voxels = voxels(measured.map)?;
        let smoothed = smooth_voxels(voxels, options, |done, count| progress(Stage::Network, done, count));
        let SmoothedVoxels { network, points, certificate, relabelled } =
            smoothed.map_err(|error| match error {
                NetworkError::Invalid(faults) => Error::MixedVoxels { path: path.to_owned(), faults },
                other => failed(other),
            })?;
        map.relabelled = relabelled;
        (network, points, certificate)
    };
    let times = vec![(Stage::Map, run.read_in), (Stage::Network, start.elapsed())];
    let measurement = Measurement {
        command_line: run.command_line,
        file: run.file,
        grains,
        map: Some(map),
        cut: BVec3::FALSE,
    };
    let smooth = Polycrystal::measured(measurement, network, points, certificate, times);
    smooth.refined(path, &run.network, progress)
}

impl Polycrystal {
    /// The grains of a map or of a given network with boundaries nearer to the equilibrium of their tension, then subdivided, as far as that is asked for. `path` is where they come
    /// from. Volumes and neighbours stay.
    ///
    /// # Errors
    /// [`Error::NetworkOfMap`] or [`Error::RelaxesFolded`] where boundaries cannot move so far without folds or crossings, and [`LevelsExceedMemory`](crate::memory::MemoryError::LevelsExceedMemory) or
    /// [`LevelsExceedIds`](crate::memory::MemoryError::LevelsExceedIds).
    pub fn refined(
        mut self,
        path: &Path,
        options: &MapNetworkOptions,
        progress: Progress<'_>,
    ) -> Result<Self, Error> {
        let failed = |cause| Error::NetworkOfMap { path: path.to_owned(), cause: Box::new(cause) };
        if let Some(relaxation) = options.relaxation() {
            let folds = self.validation.faults.0.len();
            self.relax(relaxation, progress).map_err(|cause| match folds {
                0 => failed(cause),
                _ => Error::RelaxesFolded { path: path.to_owned(), folds, cause: Box::new(cause) },
            })?;
        }
        if options.levels > 0 {
            let control_mesh =
                ControlMesh { motion: Motion::Still, ..size(self.network.control_mesh()).into() };
            check_levels(control_mesh, options.levels, available_memory())?;
            progress(Stage::Subdivision, 0, 1);
            let start = Instant::now();
            let subdivided = self.network.subdivided(&self.points, options.levels as usize);
            let Subdivided { network, points, certificate } = subdivided.map_err(failed)?;
            self.network = network;
            self.set_points(points, certificate);
            self.add_time(Stage::Subdivision, start.elapsed());
        }
        Ok(self)
    }

    /// Moves points toward equilibrium.
    fn relax(&mut self, relaxation: Relaxation, progress: Progress<'_>) -> Result<(), NetworkError> {
        progress(Stage::Relaxation, 0, 1);
        let start = Instant::now();
        let tell = |step: RelaxationStep<'_>| progress(Stage::Relaxation, step.done, step.count);
        let relaxed = relax_certified(&self.network, &self.points, &relaxation, Volumes::Kept, tell);
        let (relaxed, Certified { points, validation, validated_in }) = relaxed?;
        self.add_time(Stage::Relaxation, start.elapsed().saturating_sub(validated_in));
        let start = Instant::now();
        self.attempts.extend(relaxed.given_up);
        self.set_points(points, validation);
        self.add_time(Stage::Validation, validated_in + start.elapsed());
        Ok(())
    }

    fn set_points(&mut self, points: Vec<DVec3>, validation: Certificate) {
        (self.points, self.validation) = (points, validation);
        self.residual = herring_residual(&self.network, &self.points);
    }
}

fn size(level: &Level) -> LevelSize {
    let (edges, triangles) = match &level.mesh {
        Mesh::Triangles(mesh) => (mesh.edge_count(), level.element_count()),
        Mesh::Segments(mesh) => (mesh.segments().len(), 0),
    };
    let [points, edges, triangles] = [level.vertex_count(), edges, triangles].map(|count| count as u128);
    LevelSize { points, edges, triangles }
}

/// What the map tells of each grain.
fn attributes(measured: &MeasuredMap) -> GrainAttributes {
    let MeasuredMap { labels, voxel_counts, crystals, .. } = measured;
    let spreads = crystals.as_ref().map(|crystals| crystals.spreads.clone());
    let measured = MeasuredAttributes { voxel_counts: voxel_counts.clone(), spreads };
    let known = GrainAttributes { measured: Some(measured), ..grains_called(labels.clone()) };
    let Some(MeasuredCrystals { phases, phase_of, orientations, .. }) = crystals else { return known };
    let symmetries = phases.iter().map(|(_, symmetry)| *symmetry).collect();
    GrainAttributes {
        phases: Some(GrainPhases::measured(phases.clone(), phase_of.clone())),
        texture: Some(GrainTexture::measured(symmetries, phase_of.clone(), orientations.clone())),
        ..known
    }
}

/// The voxels of a map in the box that they fill.
fn voxels(map: LabelMap) -> Result<Voxels, voronoi::VoronoiError> {
    let label = |label: i32| match u32::try_from(label) {
        Ok(grain) => VoxelLabel::of(GrainId(grain)),
        Err(_) => VoxelLabel::EXTERIOR,
    };
    Ok(Voxels::new(map.domain()?, map.shape, map.labels.into_iter().map(label).collect()))
}
