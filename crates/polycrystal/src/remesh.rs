//! A network with triangles of a wanted size, as finite elements need them.
//!
//! The reference is the finest level of a network, or a coarser one through points of it whose edges are short enough: new points lie on it, those of a boundary on that boundary. Lines are divided first, evenly in units of the size there; then
//! each boundary, between its lines, gets triangles of its own. What lies a period away is copied, bit for bit. In the end points move a little to give grains their volumes back,
//! and the certificate is asked; where it finds a fault, elements become half as large, and all begins anew.

mod assembled;
mod curved;
mod divide_lines;
mod gradation;
mod joints;
mod lines;
mod narrow_corners;
pub(crate) mod narrow_triangles;
mod outline;
mod parts;
mod patch;
mod plane;
mod reference;
mod shaping;
mod short_line_search;
mod short_lines;
mod size_field;
mod skeleton;
mod torus;
mod tuning;
mod unfolding;
mod volumes;

use std::borrow::Cow;

use glam::{BVec3, DVec3};
use rayon::prelude::*;
use voronoi::{Dimension, Translation};

use crate::mesh::id::id;
use crate::{BoundaryId, Certificate, Faults, Level, Mesh, Network, NetworkError, Surface, validate};
use assembled::{Assembled, NewBoundary, assemble};
pub use curved::CurvedBoundaries;
use divide_lines::divide_lines;
use joints::separate_joints;
use lines::DividedLine;
use outline::{Numbering, Outlined, is_loop};
use parts::Parts;
pub use plane::PlaneMesh;
pub use short_lines::MergedLine;
use short_lines::ShortLines;
use size_field::{Halved, SizeField, Surroundings};
use skeleton::Skeleton;
use torus::{Moved, Torus};
pub use tuning::RemeshTuning;

/// How large elements are to be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ElementSize {
    /// Length of edges, in the unit of the domain.
    pub length: f64,
    /// By how much edges become longer per length, away from short lines and other narrow places.
    pub growth: f64,
    /// Length of edges as a share of the radius of curvature, where that is less.
    pub of_radius: Option<f64>,
    /// Whether edges get points in their middle, for elements of second order.
    pub has_middles: bool,
    /// Whether lines shorter than the elements become points, where every grain stays a closed ball.
    pub merges_short_lines: bool,
}

impl ElementSize {
    /// Growth of sizes where nothing else is asked: 0.25 and 0.7 give triangles and tetrahedra that are as good.
    pub const GROWTH: f64 = 0.4;

    /// Edges of one length.
    pub fn new(length: f64) -> Self {
        Self { length, growth: Self::GROWTH, of_radius: None, has_middles: false, merges_short_lines: false }
    }
}

/// A network with triangles of a wanted size.
#[derive(Debug, Clone)]
pub struct Remeshed {
    /// The same boundaries, lines and points where these meet, on a single level.
    pub network: Network,
    /// Its points.
    pub points: Vec<DVec3>,
    /// What was found about it.
    pub certificate: Certificate,
    /// How often elements became smaller somewhere, because what came out was invalid there.
    pub refinements: usize,
    /// Lines that became points, where that is asked for, the shortest first.
    pub merged: Vec<MergedLine>,
    /// Points and middles of edges on the smooth surface, where middles are asked for; volumes are restored by [`CurvedBoundaries::restore_volumes`].
    pub curved: Option<CurvedBoundaries>,
    /// In the plane, the triangles that fill the grains.
    pub triangles: Option<PlaneMesh>,
}

impl Network {
    /// The network with triangles of the size asked for, for the points of its finest level.
    ///
    /// New points lie on the coarsest level whose edges, between points of the finest, have no more than 0.4 of that size on the mean. The finest should: with longer
    /// edges tetrahedra between the triangles get worse.
    ///
    /// Boundaries, triple lines and quadruple points stay what they are; elements are smaller where lines are short. Grains keep the volumes of their cells. Copies are
    /// the same, bit for bit; so are, along the axes of `cut`, the opposite walls of a periodic network that was cut at its box.
    ///
    /// ```
    /// use glam::{BVec3, DVec3};
    /// use polycrystal::{ElementSize, Junctions, Network};
    /// use voronoi::{Domain, Tessellation};
    ///
    /// let seeds = [DVec3::new(0.3, 0.4, 0.5), DVec3::new(0.7, 0.3, 0.2), DVec3::new(0.6, 0.8, 0.9)];
    /// let cells = Tessellation::new(&Domain::unit_cube(), &seeds)?;
    /// let (network, flat) = Network::new(&cells, Junctions::Crease, 3)?;
    /// let remeshed = network.remeshed(&network.subdivide(&flat), &ElementSize::new(0.2), BVec3::FALSE)?;
    /// assert!(remeshed.certificate.is_good());
    /// assert!(remeshed.network.mean_edge_length(&remeshed.points) <= 0.2);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`NetworkError::BadElementSize`]; [`NetworkError::LineTooShort`] in space, and [`NetworkError::LinesCross`] in the plane; [`NetworkError::NoCopyOnWall`] where opposite walls are not alike;
    /// [`NetworkError::RemeshInvalid`] with what the certificate finds where smaller elements did not help.
    ///
    /// # Panics
    /// When there is not one point per vertex of the finest level.
    pub fn remeshed(
        &self,
        points: &[DVec3],
        size: &ElementSize,
        cut: BVec3,
    ) -> Result<Remeshed, NetworkError> {
        self.remeshed_tuned(points, size, cut, &RemeshTuning::default())
    }

    /// As [`Self::remeshed`] with other tuned numbers.
    ///
    /// # Errors
    /// # Panics
    /// As of [`Self::remeshed`].
    #[doc(hidden)]
    pub fn remeshed_tuned(
        &self,
        points: &[DVec3],
        size: &ElementSize,
        cut: BVec3,
        tuning: &RemeshTuning,
    ) -> Result<Remeshed, NetworkError> {
        for number in [size.length, size.growth, size.of_radius.unwrap_or(1.0)] {
            if !(number.is_finite() && number > 0.0) {
                return Err(NetworkError::BadElementSize(number));
            }
        }
        assert_eq!(points.len(), self.finest().vertex_count(), "there must be one point per vertex");
        let level = &*self.reference_level(points, size.length, tuning);
        match self.domain().dimension() {
            Dimension::Two => plane::remeshed(self, level, points, size, cut, tuning),
            Dimension::Three => self.remeshed_on(level, points, size, cut, tuning),
        }
    }

    /// The network in space with new points on a level.
    fn remeshed_on(
        &self,
        level: &Level,
        points: &[DVec3],
        size: &ElementSize,
        cut: BVec3,
        tuning: &RemeshTuning,
    ) -> Result<Remeshed, NetworkError> {
        // A finer level has the vertices of a coarser one first.
        let points = &points[..level.vertex_count()];
        let Mesh::Triangles(mesh) = &level.mesh else { unreachable!("boundaries in space have triangles") };
        let torus = Torus::new(self, level, points, cut)?;
        let skeleton = Skeleton::new((level, mesh), self.wall_sets(), &torus, |_| false);
        let parts = Parts::new((level, mesh), &skeleton, &torus, self.boundaries())?;
        let sides = |boundary: BoundaryId| self.boundaries()[boundary.index()].sides;
        let mut around = Surroundings {
            short: ShortLines::default(),
            level,
            mesh,
            points,
            torus: &torus,
            skeleton: &skeleton,
            parts: &parts,
            is_plane: false,
        };
        until_valid(size, tuning, |halved, refinements| {
            if size.merges_short_lines {
                around.short = ShortLines::new(self, &around, sides, tuning.short_line * size.length, halved);
            }
            around.check_lines(size, tuning)?;
            let sizes = SizeField::new(&around, size, halved, tuning);
            let lines = divide_lines(&around, &sizes, tuning);
            let numbering = Numbering::new(&around, &lines);
            let mut assembled = remesh(self, &around, &sizes, (&lines[..], &numbering), tuning)?;
            let curved =
                size.has_middles.then(|| CurvedBoundaries::new(&assembled, &around, &lines, &numbering));
            volumes::restore(&mut assembled);
            let (network, points) = (&assembled.network, assembled.points());
            let certificate = match validate(network, &points) {
                Ok(certificate) => certificate,
                Err(faults) => return Ok(Err(Faulty::of(faults, network, &points))),
            };
            let network = assembled.network;
            let merged = around.short.merged.clone();
            Ok(Ok(Remeshed { network, points, certificate, refinements, merged, curved, triangles: None }))
        })
    }

    /// The mean length of the edges of the finest level, for its points; in the plane of the segments.
    ///
    /// # Panics
    /// When there is not one point per vertex.
    pub fn mean_edge_length(&self, points: &[DVec3]) -> f64 {
        self.finest_level().mesh.mean_edge_length(points)
    }

    /// The coarsest level with edges that are short enough for elements of a size, at the points of the finest one; the finest if there is none.
    fn reference_level(&self, points: &[DVec3], size: f64, tuning: &RemeshTuning) -> Cow<'_, Level> {
        let is_fine = |level: &Cow<'_, Level>| {
            level.mesh.mean_edge_length(points) <= tuning.longest_of_reference * size
        };
        let mut coarser = (0..self.level_count()).map(|level| self.whole_level(level));
        coarser.find(is_fine).unwrap_or_else(|| self.finest_level())
    }
}

/// What is wrong with what came out, and where.
struct Faulty {
    faults: Faults,
    places: Vec<DVec3>,
}

impl Faulty {
    fn of(faults: Faults, network: &Network, points: &[DVec3]) -> Self {
        let sides = network.sides();
        let surface = Surface::of_level(network.finest(), points, &sides);
        let places = faults.0.iter().filter_map(|fault| fault.position(&surface)).collect();
        Self { faults, places }
    }
}

/// Remeshes, with elements half as large where what came out is invalid, until it is valid. `remesh` is told where they are smaller, and how often they became so.
fn until_valid(
    size: &ElementSize,
    tuning: &RemeshTuning,
    mut remesh: impl FnMut(&[Halved], usize) -> Result<Result<Remeshed, Faulty>, NetworkError>,
) -> Result<Remeshed, NetworkError> {
    let mut halved = Vec::new();
    for refinements in 0.. {
        let Faulty { faults, places } = match remesh(&halved, refinements)? {
            Ok(remeshed) => return Ok(remeshed),
            Err(faulty) => faulty,
        };
        if refinements == tuning.refinements || places.is_empty() {
            return Err(NetworkError::RemeshInvalid(faults));
        }
        let mut more: Vec<Halved> = Vec::new();
        for place in places {
            // Faults that lie close together count as one: each would halve what the others did.
            if !more.iter().any(|near| near.place.distance(place) < 0.5 * near.within) {
                more.push(halved_at(place, &halved, size, tuning));
            }
        }
        halved.extend(more);
    }
    unreachable!("refinements end")
}

/// Elements around a place half as large as they were there.
fn halved_at(place: DVec3, before: &[Halved], size: &ElementSize, tuning: &RemeshTuning) -> Halved {
    let was = before.iter().filter(|near| near.place.distance(place) < near.within).map(|near| near.factor);
    let was = was.fold(1.0, f64::min);
    Halved { place, within: tuning.halving_radius * was * size.length, factor: 0.5 * was }
}

/// One way from sizes to a network on the smooth surface; nobody has restored volumes or looked for faults yet.
fn remesh(
    network: &Network,
    around: &Surroundings<'_>,
    sizes: &SizeField,
    (lines, numbering): (&[DividedLine], &Numbering),
    tuning: &RemeshTuning,
) -> Result<Assembled, NetworkError> {
    let positions = positions_on_lines(around, lines, numbering);
    let new = shaped_parts(network, around, sizes, (lines, numbering, &positions), tuning);
    assemble(network, around, lines, numbering, positions, new)
}

/// The triangles of all parts that are no copies, between lines whose points are where they are.
fn shaped_parts(
    network: &Network,
    around: &Surroundings<'_>,
    sizes: &SizeField,
    (lines, numbering, positions): (&[DividedLine], &Numbering, &[DVec3]),
    tuning: &RemeshTuning,
) -> Vec<NewBoundary> {
    let domain = network.domain();
    let position = |point: Moved<u32>| {
        let original = positions[point.original as usize];
        if point.translation == Translation::ZERO {
            original
        } else {
            original + point.translation.vector(domain)
        }
    };
    let originals: Vec<usize> = around.parts.originals().collect();
    let mut shaped: Vec<_> = originals
        .par_iter()
        .map(|part| {
            let triangles = around.parts.triangles.of(*part);
            let outlined = Outlined::new(around, triangles, sizes, lines, numbering, position);
            outlined.shaped(tuning)
        })
        .collect();
    separate_joints(&mut shaped, around, lines, numbering);
    shaped.into_iter().map(|shaped| new_boundary(shaped, numbering.count)).collect()
}

/// Where nodes and the points of lines are.
fn positions_on_lines(around: &Surroundings<'_>, lines: &[DividedLine], numbering: &Numbering) -> Vec<DVec3> {
    let place = |node: u32| around.short.place(node).unwrap_or(around.points[node as usize]);
    let mut positions: Vec<DVec3> = numbering.nodes().map(place).collect();
    for (line, divided) in around.skeleton.lines.iter().zip(lines) {
        positions.extend(&divided.points);
        if is_loop(line.vertices[0], line.is_closed(), around) {
            positions.push(around.points[line.vertices[0] as usize]);
        }
    }
    positions
}

/// The triangles of a patch by new points; those inside count on from the points of lines.
fn new_boundary((shaping, keys): joints::Shaped<'_>, first: usize) -> NewBoundary {
    let patch = &shaping.patch;
    let mut points = Vec::new();
    let mut numbers = vec![None; patch.points.len()];
    let mut number = |point: u32| match keys.get(&point) {
        Some(key) => *key,
        None => *numbers[point as usize].get_or_insert_with(|| {
            points.push(patch.place(point));
            Moved { original: id(first + points.len() - 1), translation: Translation::ZERO }
        }),
    };
    let triangles = patch.all().map(|corners| corners.map(&mut number)).collect();
    NewBoundary { triangles, points }
}
