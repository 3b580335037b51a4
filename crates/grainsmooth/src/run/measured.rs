//! From a measured map to its network, and from a network that is there.

use std::path::Path;
use std::time::{Duration, Instant};

use glam::DVec3;
use polycrystal::{
    Certificate, Expected, GrainId, Junctions, Network, NetworkError, Relaxation, Side, SmoothedVoxels,
    Surface, VoxelLabel, VoxelOptions, Voxels, certify, herring_residual, outward_sides, relax,
    smooth_voxels,
};
use texture::CrystalSymmetry;
use voronoi::{Dimension, Domain};

use super::origin::{Measurement, Origin, SmoothedMap};
use super::polycrystal::Polycrystal;
use super::stage::{Progress, Stage};
use super::topology::Topology;
use crate::maps::label_map::{LabelMap, MeasuredCrystals, MeasuredMap};
use crate::{
    Error, FileOptions, GrainAttributes, GrainPhases, GrainTexture, LabelledFile, MapNetworkOptions,
    MeasuredAttributes,
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
/// use grainsmooth::glam::DVec3;
/// use grainsmooth::{FileOptions, LabelMap, MapNetworkOptions, MapOptions, MapRun, MeasuredMap, smooth_map};
///
/// // 4 x 4 x 4 voxels, x fastest: grains 10 and 20. A file would be read by `read_map`.
/// let labels = (0..64).map(|voxel| if voxel % 4 < 2 { 10 } else { 20 }).collect();
/// let map = LabelMap { shape: [4, 4, 4], spacing: DVec3::ONE, origin: DVec3::ZERO, labels };
/// let measured = MeasuredMap::of_labels(map, &MapOptions { min_voxels: 1, ..MapOptions::default() })?;
/// let network = MapNetworkOptions { decimate: Some(0.0), ..MapNetworkOptions::default() };
/// let run = MapRun { command_line: String::new(), file: FileOptions::default(), network, read_in: Duration::ZERO };
/// let polycrystal = smooth_map(Path::new("labels in memory"), &measured, run, &|_, _, _| ())?;
/// assert_eq!(polycrystal.network.grain_count(), 2);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`Error::NetworkOfMap`] where the map leads to none.
pub fn smooth_map(
    path: &Path,
    measured: &MeasuredMap,
    run: MapRun,
    progress: Progress<'_>,
) -> Result<Polycrystal, Error> {
    let failed = |cause| Error::NetworkOfMap { path: path.to_owned(), cause: Box::new(cause) };
    progress(Stage::Network, 0, 1);
    let start = Instant::now();
    let voxels = voxels(&measured.map)?;
    let options = VoxelOptions {
        junctions: Junctions::Crease,
        shortest_edge: run.network.shortest_edge(measured.map.is_plane()),
    };
    let smoothed = smooth_voxels(&voxels, options, |done, count| progress(Stage::Network, done, count));
    let SmoothedVoxels { network, points, certificate, relabelled } = smoothed.map_err(failed)?;
    let times = vec![(Stage::Map, run.read_in), (Stage::Network, start.elapsed())];
    let measurement = Measurement {
        command_line: run.command_line,
        file: run.file,
        grains: attributes(measured),
        map: Some(SmoothedMap {
            shape: measured.map.shape,
            dropped: measured.dropped,
            points: measured.crystals.as_ref().map(|crystals| crystals.points.clone()),
            relabelled,
        }),
        folds: certificate.faults.0.len(),
    };
    let smooth = Polycrystal::measured(measurement, network, points, certificate, times);
    match run.network.relaxation() {
        Some(relaxation) => smooth.relaxed(path, relaxation, progress),
        None => Ok(smooth),
    }
}

impl Polycrystal {
    /// The network of a file, whose grains are numbered from 0 in order of their labels; `SeedId` has these labels. `command_line` is what files tell of where they come from.
    ///
    /// # Errors
    /// [`Error::NetworkOfMap`] where grains are not closed, or cross.
    pub fn of_file(path: &Path, file: &LabelledFile, command_line: String) -> Result<Self, Error> {
        let surface = file.surface();
        let grains = surface.grains();
        let renumbered = |side: &Side| match side {
            Side::Grain(grain) => {
                let rank = grains.binary_search(grain).expect("grains of the surface are listed");
                Side::Grain(GrainId(u32::try_from(rank).expect("no more grains than ids")))
            }
            Side::Exterior => Side::Exterior,
        };
        let sides: Vec<[Side; 2]> =
            surface.sides.iter().map(|sides| [0, 1].map(|k| renumbered(&sides[k]))).collect();
        let points: Vec<DVec3> = file.points.iter().map(|point| *point * file.stretch).collect();
        let surface = Surface { points: &points, sides: &sides, ..surface };
        let own = || grains.iter().map(|grain| grain.0).collect();
        let ids = file.map_labels.clone().filter(|labels| labels.len() == grains.len()).unwrap_or_else(own);
        Self::of_surface(&surface, ids, command_line).map_err(|error| match error {
            Error::Network(cause) => Error::NetworkOfMap { path: path.to_owned(), cause: Box::new(cause) },
            other => other,
        })
    }

    /// The grains of a map or of a given network with boundaries nearer to the equilibrium of their tension. `path` is where they come from. Volumes and neighbours stay.
    ///
    /// # Errors
    /// [`Error::NetworkOfMap`] where boundaries cannot move so far without folds or crossings.
    pub fn relaxed(
        mut self,
        path: &Path,
        relaxation: Relaxation,
        progress: Progress<'_>,
    ) -> Result<Self, Error> {
        let failed = |cause| Error::NetworkOfMap { path: path.to_owned(), cause: Box::new(cause) };
        progress(Stage::Relaxation, 0, 1);
        let start = Instant::now();
        let tell = |done, count| progress(Stage::Relaxation, done, count);
        let relaxed = relax(&self.network, &self.points, &relaxation, tell).map_err(failed)?;
        self.points = relaxed.finest_points(&self.network);
        self.add_time(Stage::Relaxation, start.elapsed());
        progress(Stage::Validation, 0, 1);
        let start = Instant::now();
        let sides = self.network.sides();
        let surface = Surface::of_level(self.network.finest(), &self.points, &sides);
        let volumes: Vec<(GrainId, f64)> =
            (0u32..).map(GrainId).zip(self.network.cell_volumes().iter().copied()).collect();
        let expected = Expected { grain_volumes: Some(&volumes), ..Expected::default() };
        let certificate = certify(&surface, &expected);
        if !certificate.is_good() {
            return Err(failed(NetworkError::Invalid(certificate.faults)));
        }
        self.validation = certificate;
        self.residual = herring_residual(&self.network, &self.points);
        self.attempts.extend(relaxed.given_up);
        if let Origin::Measured(measurement) = &mut self.origin {
            measurement.folds = 0;
        }
        self.add_time(Stage::Validation, start.elapsed());
        Ok(self)
    }

    /// The network of closed grains that are there, such as another program's, numbered from 0; `ids` are the numbers that they had. They need not fill the box around them.
    /// `command_line` is what files tell of where they come from.
    ///
    /// # Errors
    /// [`Error::Network`] where grains are not closed, or cross; as of [`Network::of_closed_grains`].
    ///
    /// # Panics
    /// As [`Network::of_surface`].
    pub fn of_surface(surface: &Surface<'_>, ids: Vec<u32>, command_line: String) -> Result<Self, Error> {
        let start = Instant::now();
        let sides = outward_sides(surface);
        let surface = Surface { sides: &sides, ..*surface };
        let lower = surface.points.iter().copied().fold(DVec3::INFINITY, DVec3::min);
        let upper = surface.points.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
        let domain = match surface.elements.dimension() {
            Dimension::Two => Domain::rectangle(lower, upper),
            Dimension::Three => Domain::cuboid(lower, upper),
        };
        let (network, points, certificate) =
            Network::of_closed_grains(&domain?, &surface, Junctions::Crease)?;
        let measurement = Measurement {
            command_line,
            file: FileOptions::default(),
            grains: GrainAttributes {
                ids,
                parents: None,
                phases: None,
                symmetry: CrystalSymmetry::default(),
                texture: None,
                measured: None,
            },
            map: None,
            folds: certificate.faults.0.len(),
        };
        let times = vec![(Stage::Validation, start.elapsed())];
        Ok(Self::measured(measurement, network, points, certificate, times))
    }

    fn measured(
        measurement: Measurement,
        network: Network,
        points: Vec<DVec3>,
        validation: Certificate,
        times: Vec<(Stage, Duration)>,
    ) -> Self {
        Self {
            origin: Origin::Measured(Box::new(measurement)),
            topology: Topology::new(None, &network),
            residual: herring_residual(&network, &points),
            network,
            points,
            attempts: Vec::new(),
            tensions: None,
            mobilities: None,
            validation,
            elements: None,
            middles: None,
            volume_mesh: None,
            times,
        }
    }
}

/// What the map tells of each grain.
fn attributes(measured: &MeasuredMap) -> GrainAttributes {
    let MeasuredMap { labels, voxel_counts, crystals, .. } = measured;
    let spreads = crystals.as_ref().map(|crystals| crystals.spreads.clone());
    let known = GrainAttributes {
        ids: labels.clone(),
        parents: None,
        phases: None,
        symmetry: CrystalSymmetry::default(),
        texture: None,
        measured: Some(MeasuredAttributes { voxel_counts: voxel_counts.clone(), spreads }),
    };
    let Some(MeasuredCrystals { phases, phase_of, orientations, .. }) = crystals else { return known };
    let symmetries = phases.iter().map(|(_, symmetry)| *symmetry).collect();
    GrainAttributes {
        phases: Some(GrainPhases::measured(phases.clone(), phase_of.clone())),
        texture: Some(GrainTexture::measured(symmetries, phase_of.clone(), orientations.clone())),
        ..known
    }
}

/// The voxels of a map in the box that they fill.
fn voxels(map: &LabelMap) -> Result<Voxels, voronoi::VoronoiError> {
    let label = |label: &i32| match u32::try_from(*label) {
        Ok(grain) => VoxelLabel::of(GrainId(grain)),
        Err(_) => VoxelLabel::EXTERIOR,
    };
    Ok(Voxels::new(map.domain()?, map.shape, map.labels.iter().map(label).collect()))
}
