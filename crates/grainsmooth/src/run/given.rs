//! From a network that is there, in a file or in memory, to a polycrystal.

use std::path::Path;
use std::time::{Duration, Instant};

use glam::{BVec3, DVec3};
use polycrystal::{
    Certificate, GrainId, Junctions, Network, NetworkError, Side, Surface, outward_sides, validate,
};
use texture::CrystalSymmetry;
use voronoi::{Dimension, Domain, VoronoiError};

use super::origin::{Measurement, Origin};
use super::polycrystal::Polycrystal;
use super::stage::Stage;
use super::topology::Topology;
use crate::{Error, FileOptions, GrainAttributes, GrainPhases, GrainTexture, LabelledFile};

impl Polycrystal {
    /// The network of a file, whose grains are numbered from 0 in order of their labels. Phases, orientations and numbers of seeds are those that the file tells; without these,
    /// `SeedId` has the labels. A network that repeats goes on doing so. Others are in `domain`, where it is known, or in the box around them. `command_line` is what files tell of where
    /// they come from.
    ///
    /// # Errors
    /// [`Error::NetworkOfMap`] where grains are not closed, or cross.
    pub fn of_file(
        path: &Path,
        file: &LabelledFile,
        domain: Option<Domain>,
        command_line: String,
    ) -> Result<Self, Error> {
        let start = Instant::now();
        let surface = file.surface();
        let labels = surface.grains();
        let renumbered = |side: &Side| match side {
            Side::Grain(grain) => {
                let rank = labels.binary_search(grain).expect("grains of the surface are listed");
                Side::Grain(GrainId(u32::try_from(rank).expect("no more grains than ids")))
            }
            Side::Exterior => Side::Exterior,
        };
        let sides: Vec<[Side; 2]> =
            surface.sides.iter().map(|sides| [0, 1].map(|k| renumbered(&sides[k]))).collect();
        let points: Vec<DVec3> = file.points.iter().map(|point| *point * file.stretch).collect();
        let surface = Surface { points: &points, sides: &sides, ..surface };
        let repeats = file.periods.map_or(BVec3::FALSE, |periods| periods.cmpgt(DVec3::ZERO));
        let made = match (file.periods, &file.originals) {
            (Some(periods), Some(originals)) => whole_grains(&surface, periods, originals),
            _ => closed_grains(&surface, domain),
        };
        let (network, points, certificate) = made.map_err(|error| match error {
            Error::Network(cause) => Error::NetworkOfMap { path: path.to_owned(), cause: Box::new(cause) },
            other => other,
        })?;
        let measurement = Measurement {
            cut: if network.domain().is_periodic() { BVec3::FALSE } else { repeats },
            ..Measurement::given(command_line, attributes_of_file(file, &labels))
        };
        let times = vec![(Stage::Validation, start.elapsed())];
        Ok(Self::measured(measurement, network, points, certificate, times))
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
        let (network, points, certificate) = closed_grains(surface, None)?;
        let measurement = Measurement::given(command_line, grains_called(ids));
        let times = vec![(Stage::Validation, start.elapsed())];
        Ok(Self::measured(measurement, network, points, certificate, times))
    }

    pub(super) fn measured(
        measurement: Measurement,
        network: Network,
        points: Vec<DVec3>,
        validation: Certificate,
        times: Vec<(Stage, Duration)>,
    ) -> Self {
        let topology = Topology::new(None, &network);
        let origin = Origin::Measured(Box::new(measurement));
        Self { times, ..Self::new(origin, topology, network, points, validation) }
    }
}

impl Measurement {
    /// Of a network that is there.
    fn given(command_line: String, grains: GrainAttributes) -> Self {
        Self { command_line, file: FileOptions::default(), grains, map: None, cut: BVec3::FALSE }
    }
}

/// The network of closed grains in a domain, or in the box around them, which they need not fill.
fn closed_grains(
    surface: &Surface<'_>,
    domain: Option<Domain>,
) -> Result<(Network, Vec<DVec3>, Certificate), Error> {
    let sides = outward_sides(surface);
    let surface = Surface { sides: &sides, ..*surface };
    let domain = domain.map_or_else(|| box_between(&surface, bounds(surface.points)), Ok)?;
    Ok(Network::of_closed_grains(&domain, &surface, Junctions::Crease)?)
}

/// The network of whole grains that fill a box which repeats, from a corner at 0, along the axes with periods.
fn whole_grains(
    surface: &Surface<'_>,
    periods: DVec3,
    originals: &[u32],
) -> Result<(Network, Vec<DVec3>, Certificate), Error> {
    let periodic = periods.cmpgt(DVec3::ZERO);
    let (lower, upper) = bounds(surface.points);
    let corners = (DVec3::select(periodic, DVec3::ZERO, lower), DVec3::select(periodic, periods, upper));
    let domain = box_between(surface, corners)?.with_periods(periodic);
    let (network, points) = Network::of_periodic_grains(&domain, surface, originals, Junctions::Crease)?;
    let certificate = validate(&network, &points).map_err(NetworkError::Invalid)?;
    Ok((network, points, certificate))
}

fn box_between(surface: &Surface<'_>, (lower, upper): (DVec3, DVec3)) -> Result<Domain, VoronoiError> {
    match surface.elements.dimension() {
        Dimension::Two => Domain::rectangle(lower, upper),
        Dimension::Three => Domain::cuboid(lower, upper),
    }
}

/// The corners of the box around some points.
fn bounds(points: &[DVec3]) -> (DVec3, DVec3) {
    let points = || points.iter().copied();
    (points().fold(DVec3::INFINITY, DVec3::min), points().fold(DVec3::NEG_INFINITY, DVec3::max))
}

/// Grains of which nothing but their numbers is known.
pub(super) fn grains_called(ids: Vec<u32>) -> GrainAttributes {
    GrainAttributes {
        ids,
        parents: None,
        phases: None,
        symmetry: CrystalSymmetry::default(),
        texture: None,
        measured: None,
    }
}

/// What a file tells of the grains with some labels.
fn attributes_of_file(file: &LabelledFile, labels: &[GrainId]) -> GrainAttributes {
    let ids = of_labels(file.seed_ids.as_deref(), labels);
    let known = grains_called(ids.unwrap_or_else(|| labels.iter().map(|label| label.0).collect()));
    let symmetry = |phase: usize| file.symmetries.get(phase).copied().unwrap_or_default();
    let phase_of: Option<Vec<usize>> = of_labels(file.phases.as_deref(), labels)
        .map(|numbers| numbers.into_iter().map(|number| (number as usize).saturating_sub(1)).collect());
    let phase_of = phase_of.filter(|of| of.iter().all(|phase| *phase < file.phase_names.len()));
    let phases = phase_of.as_ref().map(|phase_of| {
        let named = file.phase_names.iter().enumerate().map(|(phase, name)| (name.clone(), symmetry(phase)));
        GrainPhases::measured(named.collect(), phase_of.clone())
    });
    let orientations = of_labels(file.orientations.as_deref(), labels);
    let texture = orientations.map(|orientations| {
        let phase_of = phase_of.unwrap_or_else(|| vec![0; labels.len()]);
        let count = file.phase_names.len().max(1);
        GrainTexture::measured((0..count).map(symmetry).collect(), phase_of, orientations)
    });
    GrainAttributes { phases, symmetry: symmetry(0), texture, ..known }
}

/// What is known of the grains with some labels; nothing where one lacks it.
fn of_labels<T: Copy>(known: Option<&[(GrainId, T)]>, labels: &[GrainId]) -> Option<Vec<T>> {
    let known = known?;
    let of_label = |label: &GrainId| {
        let place = known.binary_search_by_key(label, |(grain, _)| *grain).ok()?;
        Some(known[place].1)
    };
    labels.iter().map(of_label).collect()
}
