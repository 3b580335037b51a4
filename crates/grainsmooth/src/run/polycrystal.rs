//! A finished polycrystal.

use std::time::{Duration, Instant};

use glam::{BVec3, DVec3};
use polycrystal::{
    Attempt, BoxCut, Certificate, CurvedBoundaries, HerringResidual, Measures, Network, NetworkError, Side,
    herring_residual, measure_network, validate,
};
use voronoi::Dimension;

use super::elements_reached::ElementsReached;
use super::origin::{Measurement, Origin, Synthesis};
use super::stage::Stage;
use super::topology::Topology;
use crate::volume_mesh::VolumeMesh;
use crate::volume_mesh::filled_plane::FilledPlane;
use crate::{
    CurvedEdges, Error, Failure, FileOptions, GrainAttributes, LawReached, PeriodicCut, Provenance,
    TensionsReached,
};

/// A finished polycrystal: a valid network with the points of its finest level.
#[derive(Debug, Clone)]
pub struct Polycrystal {
    /// Where it comes from.
    pub origin: Origin,
    /// Connectivity of all levels.
    pub network: Network,
    /// Points of the finest level.
    pub points: Vec<DVec3>,
    /// How many faces grains have and how many meet, before a periodic box is cut.
    pub topology: Topology,
    /// What was tried before this result, and why it was given up.
    pub attempts: Vec<Attempt>,
    /// How far triple lines are from rest, if boundaries meet anywhere; of grains cut at a periodic box, before the cut.
    pub residual: Option<HerringResidual>,
    /// The tensions of boundaries, where laws of them are asked for; of grains cut at a periodic box, before the cut.
    pub tensions: Option<TensionsReached>,
    /// Mobilities, where laws are asked for.
    pub mobilities: Option<LawReached>,
    /// What validation found: the angles of the finished network, volumes and how true they are.
    pub validation: Certificate,
    /// How far all grains were moved before a periodic box was cut, for its planes to meet boundaries steeply: where elements of a size are asked for, and where it could not be cut as it was.
    pub moved_for_cut: DVec3,
    /// What became of a wish for elements of a size.
    pub elements: Option<ElementsReached>,
    /// Boundaries with curved edges, where elements of second order are asked for.
    pub curved: Option<CurvedBoundaries>,
    /// Tetrahedra that fill the grains, where these were filled.
    pub volume_mesh: Option<VolumeMesh>,
    /// In the plane, triangles that fill the grains, where elements have a size.
    pub plane_mesh: Option<FilledPlane>,
    /// Time that each stage took.
    pub times: Vec<(Stage, Duration)>,
}

impl Polycrystal {
    /// A network as it is found to be, with nothing that was tried, asked for or added since.
    pub(crate) fn new(
        origin: Origin,
        topology: Topology,
        network: Network,
        points: Vec<DVec3>,
        validation: Certificate,
    ) -> Self {
        Self {
            origin,
            topology,
            residual: herring_residual(&network, &points),
            network,
            points,
            attempts: Vec::new(),
            tensions: None,
            mobilities: None,
            validation,
            moved_for_cut: DVec3::ZERO,
            elements: None,
            curved: None,
            volume_mesh: None,
            plane_mesh: None,
            times: Vec::new(),
        }
    }

    /// What is known of each grain.
    pub fn grains(&self) -> &GrainAttributes {
        match &self.origin {
            Origin::Synthetic(synthesis) => &synthesis.cells.grains,
            Origin::Measured(measurement) => &measurement.grains,
        }
    }

    /// How it came from cells, where it did.
    pub fn synthesis(&self) -> Option<&Synthesis> {
        match &self.origin {
            Origin::Synthetic(synthesis) => Some(synthesis),
            Origin::Measured(_) => None,
        }
    }

    /// How files of it are written.
    pub fn file(&self) -> FileOptions {
        match &self.origin {
            Origin::Synthetic(synthesis) => synthesis.config.file,
            Origin::Measured(measurement) => measurement.file,
        }
    }

    /// The same, to be changed before the next file.
    pub fn file_mut(&mut self) -> &mut FileOptions {
        match &mut self.origin {
            Origin::Synthetic(synthesis) => &mut synthesis.config.file,
            Origin::Measured(measurement) => &mut measurement.file,
        }
    }

    /// How it came from a map, where it did.
    pub fn measurement(&self) -> Option<&Measurement> {
        match &self.origin {
            Origin::Synthetic(_) => None,
            Origin::Measured(measurement) => Some(measurement),
        }
    }

    /// How it was made, as files tell.
    pub fn provenance(&self) -> Provenance<'_> {
        match &self.origin {
            Origin::Synthetic(synthesis) => Provenance::Config(&synthesis.config),
            Origin::Measured(measurement) => Provenance::Command(&measurement.command_line),
        }
    }

    /// The dimension of the grains.
    pub fn dimension(&self) -> Dimension {
        self.network.domain().dimension()
    }

    /// What the network is like. Where it is cut at a periodic box, tensions are not known to be at rest beside the cut; where it is
    /// stretched, nowhere.
    pub(crate) fn measures(&self) -> Measures {
        let mut measures = measure_network(&self.network, &self.points);
        if self.is_stretched() {
            match &mut measures {
                Measures::Space(space) => space.triple_lines.iter_mut().for_each(|line| line.residual = None),
                Measures::Plane(plane) => {
                    plane.triple_points.iter_mut().for_each(|point| point.residual = None)
                }
            }
        }
        if self.axes_cut_at_box().any() {
            let is_cut = |sides: &[Side]| sides.contains(&Side::Exterior);
            match &mut measures {
                Measures::Space(space) => {
                    let cut = space.triple_lines.iter_mut().filter(|line| is_cut(&line.sides));
                    cut.for_each(|line| line.residual = None);
                }
                Measures::Plane(plane) => {
                    let cut = plane.triple_points.iter_mut().filter(|point| is_cut(&point.sides));
                    cut.for_each(|point| point.residual = None);
                }
            }
        }
        measures
    }

    /// The axes across which grains of a periodic box are cut at it in the end.
    pub fn axes_cut_at_box(&self) -> BVec3 {
        let is_plane = self.dimension() == Dimension::Two;
        let axes = match &self.origin {
            Origin::Synthetic(synthesis) => match synthesis.config.periodic_cut {
                PeriodicCut::Box => synthesis.config.periodic,
                PeriodicCut::Wrap => BVec3::FALSE,
            },
            Origin::Measured(measurement) => measurement.cut,
        };
        // The third axis has no meaning in the plane.
        BVec3::new(axes.x, axes.y, axes.z && !is_plane)
    }

    /// What became of the edges on boundaries of elements of second order.
    pub(crate) fn curved_edges(&self) -> Option<CurvedEdges> {
        let in_space = self.volume_mesh.as_ref().and_then(|mesh| mesh.curved);
        in_space.or_else(|| self.plane_mesh.as_ref().and_then(|filled| filled.curved))
    }

    /// How often the mesh of the cells was subdivided.
    pub(crate) fn level(&self) -> u32 {
        self.synthesis().map_or(0, |synthesis| synthesis.config.levels)
    }

    /// What is told of an error on the way from this polycrystal.
    pub(crate) fn failure(self, error: NetworkError) -> Error {
        match self.synthesis() {
            Some(Synthesis { cells, .. }) => Failure::new(error, self.attempts.clone(), cells).into(),
            None => error.into(),
        }
    }

    /// How long the axes of grains become in the end, in units of what they are before.
    pub(crate) fn stretch(&self) -> DVec3 {
        self.synthesis().map_or(DVec3::ONE, |synthesis| synthesis.config.stretch())
    }

    /// Volumes of the grains in the flat cells, where they come from such; else their own. In the plane areas.
    pub(crate) fn volumes_of_cells(&self) -> Vec<f64> {
        match self.synthesis() {
            Some(synthesis) => synthesis.cells.volumes(),
            None => self.network.cell_volumes().to_vec(),
        }
    }

    /// Centroids of the grains in the flat cells, where they come from such; else their own.
    pub(crate) fn centroids(&self) -> Vec<DVec3> {
        if let Some(synthesis) = self.synthesis() {
            let centroids = synthesis.cells.centroids();
            return centroids.into_iter().map(|centroid| centroid + self.moved_for_cut).collect();
        }
        match self.measures() {
            Measures::Space(space) => space.grains.iter().map(|grain| grain.centroid).collect(),
            Measures::Plane(plane) => plane.grains.iter().map(|grain| grain.centroid.extend(0.0)).collect(),
        }
    }

    /// Whether grains are stretched in the end.
    pub(crate) fn is_stretched(&self) -> bool {
        self.stretch() != DVec3::ONE
    }

    /// The points of the finest level before they were stretched.
    pub(crate) fn unstretched_points(&self) -> Vec<DVec3> {
        let stretch = self.stretch();
        self.points.iter().map(|point| point / stretch).collect()
    }

    /// The grains as [`Config::aspect_ratio`](crate::Config::aspect_ratio) stretches them. What was found of angles, triangles and tensions stays that of the
    /// frame in which they were at rest.
    #[must_use]
    pub fn stretched_if_asked(mut self) -> Self {
        let Origin::Synthetic(synthesis) = &mut self.origin else { return self };
        let stretch = synthesis.config.stretch();
        if stretch == DVec3::ONE {
            return self;
        }
        for points in [&mut self.points, &mut synthesis.relaxed.points] {
            points.iter_mut().for_each(|point| *point *= stretch);
        }
        synthesis.cells.stretch(stretch);
        self.moved_for_cut *= stretch;
        self.network = self.network.stretched(stretch);
        self
    }

    /// The grains of a periodic box cut at its walls, as [`PeriodicCut::Box`](crate::PeriodicCut::Box) asks; others as they are.
    ///
    /// Where elements of a size are asked for, all grains move first, so that the walls leave room for good ones; and where the walls
    /// cannot cut the grains as they lie, as boundaries of lattices lie in them but for some noise.
    ///
    /// # Errors
    /// As of [`Network::cut_at_box`].
    pub fn cut_if_asked(mut self) -> Result<Self, Error> {
        let Origin::Synthetic(synthesis) = &self.origin else { return Ok(self) };
        if !self.axes_cut_at_box().any() {
            return Ok(self);
        }
        let cells = &synthesis.cells;
        let volumes = self.network.cell_volumes().to_vec();
        let start = Instant::now();
        let steep = || self.network.motion_for_steep_cut(&self.points);
        let cut = |motion: DVec3| {
            let points: Vec<DVec3> = self.points.iter().map(|point| *point + motion).collect();
            self.network.cut_at_box(&points, synthesis.relaxed.is_flat)
        };
        let is_asked = synthesis.config.elements.are_asked();
        let mut motion = if is_asked { steep() } else { DVec3::ZERO };
        let mut given_up = Vec::new();
        let result = match cut(motion) {
            Err(error) if !is_asked && error.is_of_planes() => {
                error.give_up("the cut at the box, grains where they are", &mut given_up);
                motion = steep();
                cut(motion)
            }
            result => result,
        };
        self.attempts.extend(given_up);
        self.moved_for_cut = motion;
        let (network, points) = match result {
            Ok(BoxCut { network, points, attempts }) => {
                self.attempts.extend(attempts);
                (cells.law.apply(network.with_cell_volumes(volumes))?, points)
            }
            Err(error) => return Err(self.failure(error)),
        };
        let cut_in = start.elapsed();
        let start = Instant::now();
        match validate(&network, &points) {
            Ok(validation) => self.validation = validation,
            Err(faults) => return Err(self.failure(NetworkError::Invalid(faults))),
        }
        (self.network, self.points) = (network, points);
        self.add_time(Stage::Subdivision, cut_in);
        self.add_time(Stage::Validation, start.elapsed());
        Ok(self)
    }
}
