//! The curved edges of a complex in the plane.

use glam::{DVec2, DVec3};
use voronoi::{FaceId, PeriodicVertex, Side, Tessellation};

use super::GrowthRecipe;
use super::front::{Front, Happened};
use super::step::{Curve, CurveNetwork, Positions};
use super::tuning::GrowthTuning;
use crate::arcs::switching::CurvedEdges;
use crate::energy::sides::{boundary, cell_and_offset, freedom};
use crate::events::reconnection::Reconnections;
use crate::flow::adaptive_steps::Evolution;
use crate::flow::recipe::{Certified, RelaxedCells};
use crate::mesh::id::id;
use crate::{CellComplex, Mesh, Network, NetworkError, Relaxed, Volumes};

/// Fewest segments of an edge.
const FEWEST_SEGMENTS: usize = 4;

/// Length of a segment, in units of the spacing, that counts as none.
const LEAST_LENGTH: f64 = 1e-6;

/// Factor by which the mean segment of an edge may be longer or shorter than the spacing before its points are laid anew.
const UNEVEN: f64 = 1.6;

/// Edges of a complex in the plane, with points along them.
pub(super) struct Curves<'a> {
    pub(super) recipe: &'a GrowthRecipe<'a>,
    pub(super) tuning: &'a GrowthTuning,
    pub(super) edges: CurvedEdges,
    /// Of each edge, by number, its points from end to end without these, where the edge's first side sees them.
    pub(super) inner: Vec<Vec<DVec2>>,
    /// Of each edge, its length before the last step; before the first, no end of it.
    pub(super) lengths: Vec<f64>,
    /// What moves in a step: the edges between grains, and these as curves.
    moving: (Vec<FaceId>, CurveNetwork),
}

impl Evolution for Curves<'_> {
    type Points = Positions;

    fn step(&self, start: &Positions, time: f64) -> Result<Positions, NetworkError> {
        Ok(self.moving.1.step(start, time))
    }

    fn extrapolated(&self, _: &Positions, halves: Positions, whole: &Positions) -> Positions {
        halves.extrapolated(whole)
    }

    fn volumes(&self, points: &Positions) -> Vec<f64> {
        self.areas(&self.moving.0, points)
    }
}

impl Front for Curves<'_> {
    fn start(&mut self, mean: f64) -> Positions {
        let spacing = self.tuning.spacing * mean.sqrt();
        self.resample(spacing);
        let positions;
        (self.moving.0, self.moving.1, positions) = self.moving(spacing);
        positions
    }

    fn take(&mut self, points: Positions) {
        let faces = std::mem::take(&mut self.moving.0);
        self.take_positions(&faces, points);
    }

    fn pass(&mut self, volumes: &[f64], mean: f64) -> Result<Happened, NetworkError> {
        Ok(self.let_happen(volumes, mean))
    }

    fn network(&self) -> Result<(Network, Vec<DVec3>), NetworkError> {
        self.lay()
    }

    fn finish(
        self,
        steps: usize,
        reconnections: Reconnections,
        time: f64,
    ) -> Result<RelaxedCells, NetworkError> {
        let (network, points) = self.lay()?;
        let relaxed = Relaxed { steps, time, is_flat: time == 0.0, ..Relaxed::new(0, points) };
        let certified = Certified::new(&network, &relaxed, Volumes::Free)?;
        let volumes = network.grain_volumes(network.finest(), &certified.points);
        let network = network.with_cell_volumes(volumes);
        let cells = RelaxedCells::of_kept_topology(network, relaxed, certified);
        Ok(RelaxedCells { reconnections, ..cells })
    }
}

impl<'a> Curves<'a> {
    /// The straight edges of some cells.
    pub(super) fn new(
        tessellation: &Tessellation,
        recipe: &'a GrowthRecipe<'a>,
        tuning: &'a GrowthTuning,
    ) -> Self {
        let complex = CellComplex::from(tessellation);
        let count = complex.faces().len();
        let edges = CurvedEdges { complex, turnings: vec![0.0; count] };
        Self {
            recipe,
            tuning,
            edges,
            inner: vec![Vec::new(); count],
            lengths: vec![f64::INFINITY; count],
            moving: (Vec::new(), CurveNetwork::default()),
        }
    }

    pub(super) fn complex(&self) -> &CellComplex {
        &self.edges.complex
    }

    /// The ends of an edge.
    pub(super) fn ends(&self, face: FaceId) -> [DVec2; 2] {
        let corners = self.complex().corners(face);
        [0, 1].map(|end| self.complex().position(corners[end]).truncate())
    }

    /// All points of an edge, from end to end.
    pub(super) fn line(&self, face: FaceId) -> Vec<DVec2> {
        let [start, end] = self.ends(face);
        let inner = self.inner[face.index()].iter().copied();
        std::iter::once(start).chain(inner).chain([end]).collect()
    }

    pub(super) fn length(&self, face: FaceId) -> f64 {
        self.line(face).windows(2).map(|ends| ends[0].distance(ends[1])).sum()
    }

    /// The network of these curves.
    fn lay(&self) -> Result<(Network, Vec<DVec3>), NetworkError> {
        let recipe = self.recipe;
        let complex = self.complex();
        let faces = complex.faces();
        let (cells, corners) = complex.tessellation();
        let segments = |face: &FaceId| id(self.inner[face.index()].len() + 1);
        let own: Vec<u32> = faces.iter().map(segments).collect();
        let copied = cells.periodic_faces().iter().map(|pair| own[pair.primary.index()]);
        let counts: Vec<u32> = own.iter().copied().chain(copied).collect();
        let network = Network::of_divided_lines(&cells, &counts, recipe.network.levels)?
            .with_tensions(recipe.network.tension)?
            .with_mobilities(recipe.mobility)?;
        let mesh = network.control_mesh();
        let Mesh::Segments(lines) = &mesh.mesh else { unreachable!("a network in the plane has lines") };
        let mut points = vec![DVec3::ZERO; mesh.vertex_count()];
        for (point, corner) in points.iter_mut().zip(&corners) {
            *point = complex.position(*corner);
        }
        let mut segments = lines.segments().iter();
        for face in &faces {
            let inner = &self.inner[face.index()];
            for (point, [_, end]) in inner.iter().zip(&mut segments) {
                points[*end as usize] = point.extend(0.0);
            }
            segments.next();
        }
        let walls = points.iter_mut().zip(&mesh.walls);
        walls.for_each(|(point, walls)| *point = network.wall_sets().put_on_walls(*walls, *point));
        mesh.copies.place(network.domain(), &mut points);
        Ok((network, points))
    }

    /// The curves that move, those between grains, by number of their edges, and where they are.
    fn moving(&self, spacing: f64) -> (Vec<FaceId>, CurveNetwork, Positions) {
        let recipe = self.recipe;
        let complex = self.complex();
        let between = |face: &FaceId| !matches!(complex.sides(*face)[1], Side::Wall(_));
        let faces: Vec<FaceId> = complex.faces().into_iter().filter(between).collect();
        let curve = |face: &FaceId| {
            let boundary = boundary(complex.sides(*face));
            let corners = complex.corners(*face);
            let end = |end: usize| {
                let PeriodicVertex { vertex, translation } = corners[end];
                (vertex as usize, translation.vector(complex.domain()).truncate())
            };
            let tension = (recipe.network.tension)(&boundary);
            let mobility = (recipe.mobility)(&boundary);
            Curve { ends: [end(0), end(1)], tension, mobility }
        };
        let curves = faces.iter().map(curve).collect();
        let freedoms = (0..id(complex.vertices.len())).map(|vertex| freedom(complex, vertex)).collect();
        let vertices = complex.vertices.iter().map(|position| position.truncate()).collect();
        let inner = faces.iter().map(|face| self.inner[face.index()].clone()).collect();
        let network = CurveNetwork { curves, freedoms, least_length: LEAST_LENGTH * spacing };
        (faces, network, Positions { vertices, inner })
    }

    /// Takes over where curves are now.
    fn take_positions(&mut self, faces: &[FaceId], positions: Positions) {
        self.lengths = vec![0.0; self.inner.len()];
        for face in self.complex().faces() {
            self.lengths[face.index()] = self.length(face);
        }
        for (vertex, position) in self.edges.complex.vertices.iter_mut().zip(&positions.vertices) {
            *vertex = position.extend(0.0);
        }
        for (face, inner) in faces.iter().zip(positions.inner) {
            self.inner[face.index()] = inner;
        }
        self.straighten_walls();
    }

    /// The area of each cell with some of its edges in given positions.
    fn areas(&self, faces: &[FaceId], positions: &Positions) -> Vec<f64> {
        let complex = self.complex();
        let mut areas = vec![0.0; complex.cell_count()];
        let mut origins: Vec<Option<DVec2>> = vec![None; areas.len()];
        let mut numbers = vec![None; self.inner.len()];
        faces.iter().enumerate().for_each(|(number, face)| numbers[face.index()] = Some(number));
        for face in complex.faces() {
            let corners = complex.corners(face);
            let end = |end: usize| {
                let PeriodicVertex { vertex, translation } = corners[end];
                positions.vertices[vertex as usize] + translation.vector(complex.domain()).truncate()
            };
            let inner = numbers[face.index()].map_or(&[][..], |number: usize| &positions.inner[number]);
            for (side, sign) in complex.sides(face).into_iter().zip([1.0, -1.0]) {
                let Some((cell, offset)) = cell_and_offset(side, complex.domain()) else { continue };
                let offset = offset.truncate();
                // From a point of its own: small cells would lose digits far from the origin.
                let origin = *origins[cell.index()].get_or_insert(end(0) - offset) + offset;
                let line = std::iter::once(end(0)).chain(inner.iter().copied()).chain([end(1)]);
                let (mut last, mut doubled) = (None::<DVec2>, 0.0);
                for point in line {
                    let point = point - origin;
                    doubled += last.map_or(0.0, |last| last.perp_dot(point));
                    last = Some(point);
                }
                areas[cell.index()] += 0.5 * sign * doubled;
            }
        }
        areas
    }

    /// Puts the points of edges on walls evenly between their ends.
    fn straighten_walls(&mut self) {
        for face in self.complex().faces() {
            if matches!(self.complex().sides(face)[1], Side::Wall(_)) {
                let [start, end] = self.ends(face);
                let position = |done: usize| start.lerp(end, done as f64 / FEWEST_SEGMENTS as f64);
                self.inner[face.index()] = (1..FEWEST_SEGMENTS).map(position).collect();
            }
        }
    }

    /// Lays the points of edges anew whose segments are much longer or shorter than the spacing.
    fn resample(&mut self, spacing: f64) {
        for face in self.complex().faces() {
            let length = self.length(face);
            let count = self.inner[face.index()].len() + 1;
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "a length is no less than 0"
            )]
            let wanted = ((length / spacing).round() as usize).max(FEWEST_SEGMENTS);
            let factor = wanted as f64 / count as f64;
            if !(1.0 / UNEVEN..=UNEVEN).contains(&factor) {
                self.inner[face.index()] = evenly(&self.line(face), wanted);
            }
        }
    }
}

/// Points that divide a line into so many parts of about the same length, without its ends. Between points the line is a cubic (Catmull and
/// Rom 1974), as chords would straighten it.
fn evenly(line: &[DVec2], count: usize) -> Vec<DVec2> {
    let mut along = vec![0.0];
    for ends in line.windows(2) {
        along.push(along[along.len() - 1] + ends[0].distance(ends[1]));
    }
    let last = line.len() - 1;
    let slope = |at: usize| {
        let (before, after) = (at.saturating_sub(1), (at + 1).min(last));
        (line[after] - line[before]) / (along[after] - along[before]).max(f64::MIN_POSITIVE)
    };
    let mut segment = 0;
    let mut point = |done: usize| {
        let wanted = along[last] * done as f64 / count as f64;
        while segment + 1 < last && along[segment + 1] < wanted {
            segment += 1;
        }
        let length = (along[segment + 1] - along[segment]).max(f64::MIN_POSITIVE);
        let t = (wanted - along[segment]) / length;
        let [a, b] = [line[segment], line[segment + 1]];
        let [u, v] = [slope(segment) * length, slope(segment + 1) * length];
        let (t2, t3) = (t * t, t * t * t);
        a * (2.0 * t3 - 3.0 * t2 + 1.0) + u * (t3 - 2.0 * t2 + t) + b * (3.0 * t2 - 2.0 * t3) + v * (t3 - t2)
    };
    (1..count).map(&mut point).collect()
}
