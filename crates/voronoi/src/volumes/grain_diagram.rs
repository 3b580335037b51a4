//! Grains of given volumes and shapes, each of several power cells.

use std::sync::Arc;

use glam::{DMat3, DVec3};

use super::grains::{Grains, pieces_of_cells};
use super::laplacian::Laplacian;
use super::newton::{Clipped, MOVED_RESIDUAL, approach};
use super::shape::{GrainShape, InscribedSphere};
use super::spheres::{SPHERE_FRACTION, whole_periods, wrapped};
use super::{GOAL, GOAL_BETWEEN_STEPS, MOST_HALVED_STEPS, VolumesError, check_volumes, first};
use crate::{CellId, Domain, Tessellation, Translation};

/// By how much a grain in two pieces may get more cells before it gets a rounder shape.
const MOST_FINENESS: u32 = 2;

/// The least area of a face that holds two cells together, in faces of a cube (in the plane: sides of a square) as large as the smaller one. Smaller
/// ones close where short edges of cells are taken out before relaxation, and then some grain of 200 that are 3:1:1 was in pieces.
const LEAST_NECK: f64 = 0.2;

/// What the logarithms of a shape's proportions are multiplied by where more cells do not help.
const LESS_CONTRAST: f64 = 0.8;

/// The factor below which a shape becomes a ball, which is a single cell.
const LEAST_CONTRAST: f64 = 0.4;

/// A power diagram in which several cells make up a grain: a polyhedron, which need not be convex, of given volume and near a given shape.
///
/// The cells of a grain are those of spheres inscribed in its ellipsoid. Their weights are the squared radii and one unknown of the grain,
/// which Newton's method finds as in [`PowerDiagram`](super::PowerDiagram); faces between cells of one grain drop out.
#[derive(Debug, Clone, PartialEq)]
pub struct GrainDiagram {
    centers: Vec<DVec3>,
    volumes: Vec<f64>,
    shapes: Vec<GrainShape>,
    /// What the shape that each grain got is of the one it was to get.
    contrasts: Vec<f64>,
    fineness: Vec<u32>,
    tessellation: Tessellation,
    weights: Vec<f64>,
    /// What each grain's cells have beside their squared radii, once weights are found.
    shifts: Option<Vec<f64>>,
    grains: Arc<Grains>,
    /// By how much each cell has to be moved to stand with its grain.
    moves: Vec<Translation>,
    centroid_steps: usize,
}

/// Cells and what they belong to.
struct Sites {
    seeds: Vec<DVec3>,
    /// Squared radii.
    bases: Vec<f64>,
    of_cell: Vec<u32>,
    moves: Vec<Translation>,
}

impl GrainDiagram {
    /// Grains around centres with the given volumes (in the plane: areas), each within [`TOLERANCE`](super::TOLERANCE), of shapes as near
    /// to the given ones as there is room for.
    ///
    /// No grain is in two pieces: one that would be gets more cells, and where that does not help a rounder shape.
    /// [`Self::contrasts`] tells which.
    ///
    /// # Errors
    /// [`VolumesError`], as [`PowerDiagram::with_volumes`](super::PowerDiagram::with_volumes).
    ///
    /// # Panics
    /// When there are not as many shapes as centres, or lengths of a shape are not positive and finite.
    pub fn with_shapes(
        domain: &Domain,
        centers: &[DVec3],
        volumes: &[f64],
        shapes: &[GrainShape],
    ) -> Result<Self, VolumesError> {
        if centers.len() != volumes.len() {
            return Err(VolumesError::Count { seeds: centers.len(), volumes: volumes.len() });
        }
        assert_eq!(centers.len(), shapes.len(), "one shape for each centre");
        let is_good = |shape: &GrainShape| shape.lengths.is_finite() && shape.lengths.min_element() > 0.0;
        assert!(shapes.iter().all(is_good), "positive lengths");
        let volumes = check_volumes(domain, volumes)?;
        // Bad centres are told by their own numbers.
        let tessellation = Tessellation::new(domain, centers)?;
        let count = centers.len();
        let mut diagram = Self {
            centers: centers.to_vec(),
            volumes,
            shapes: shapes.to_vec(),
            contrasts: vec![1.0; count],
            fineness: vec![0; count],
            tessellation,
            weights: vec![0.0; count],
            shifts: None,
            grains: Grains::of_single_cells(count),
            moves: vec![Translation::ZERO; count],
            centroid_steps: 0,
        };
        diagram.solve()?;
        Ok(diagram)
    }

    /// Moves each grain's ellipsoid, as it stands, to the centroid of the grain, with new weights that keep the volumes, and does so again
    /// and again. Steps end early where the next one would leave a grain empty.
    ///
    /// # Errors
    /// [`VolumesError::NotReached`].
    pub fn lloyd(mut self, steps: usize) -> Result<Self, VolumesError> {
        for _ in 0..steps {
            let moved = (0..MOST_HALVED_STEPS).find_map(|halvings| self.moved(0.5f64.powi(halvings)));
            let Some((centers, sites, state)) = moved else { break };
            self.centers = centers;
            self.take(sites, state);
            self.centroid_steps += 1;
        }
        let mut state = self.state();
        approach(&mut state, &self.volumes, GOAL)?;
        let sites = self.sites(&self.centers);
        self.take(sites, state);
        if !self.split_grains().is_empty() {
            self.solve()?;
        }
        Ok(self)
    }

    /// The diagram with rounder shapes for some grains, whose cells lead to no network; nothing where all of them are balls. Centres stay.
    ///
    /// # Errors
    /// [`VolumesError::NotReached`].
    pub fn rounder(&self, grains: impl IntoIterator<Item = usize>) -> Result<Option<Self>, VolumesError> {
        let is_ball = |grain: &usize| self.spheres(*grain).len() == 1;
        let grains: Vec<usize> = grains.into_iter().filter(|grain| !is_ball(grain)).collect();
        if grains.is_empty() {
            return Ok(None);
        }
        let mut rounder = self.clone();
        grains.into_iter().for_each(|grain| rounder.round(grain));
        rounder.solve()?;
        Ok(Some(rounder))
    }

    /// Gives a grain a rounder shape.
    fn round(&mut self, grain: usize) {
        self.fineness[grain] = 0;
        let contrast = LESS_CONTRAST * self.contrasts[grain];
        self.contrasts[grain] = if contrast < LEAST_CONTRAST { 0.0 } else { contrast };
    }

    /// What Newton's method begins with: what grains had before, with other cells, or else spheres of a part of the volumes, which do not
    /// overlap.
    fn start(&self, sites: &Sites, grains: &Arc<Grains>) -> Result<Clipped, VolumesError> {
        let domain = self.tessellation.domain();
        if let Some(shifts) = &self.shifts {
            let weights = grains.shifted(&sites.bases, |grain| shifts[grain]);
            let state = Clipped::new(domain, &sites.seeds, weights, Arc::clone(grains))?;
            if !state.has_empty() {
                return Ok(state);
            }
        }
        // Squared radii of all that a grain has fall alike.
        let share = 1.0 - domain.dimension().cube_edge(SPHERE_FRACTION).powi(2);
        let largest = grain_maxima(sites, self.centers.len());
        let weights = grains.shifted(&sites.bases, |grain| -share * largest[grain]);
        first(domain, &sites.seeds, weights, grains)
    }

    /// Finds weights, with other cells for grains in several pieces until there are none.
    fn solve(&mut self) -> Result<(), VolumesError> {
        loop {
            let sites = self.sites(&self.centers);
            let grains = Grains::of_cells(sites.of_cell.clone(), self.centers.len());
            let mut state = self.start(&sites, &grains)?;
            approach(&mut state, &self.volumes, GOAL)?;
            self.take(sites, state);
            let split = self.split_grains();
            if split.is_empty() {
                return Ok(());
            }
            for grain in split {
                if self.fineness[grain] < MOST_FINENESS {
                    self.fineness[grain] += 1;
                } else {
                    self.round(grain);
                }
            }
        }
    }

    /// The cells of all grains around centres. What lies outside the domain is left out; centres lie inside.
    fn sites(&self, centers: &[DVec3]) -> Sites {
        let domain = self.tessellation.domain();
        let mut sites =
            Sites { seeds: Vec::new(), bases: Vec::new(), of_cell: Vec::new(), moves: Vec::new() };
        for (grain, center) in (0u32..).zip(centers) {
            for sphere in self.spheres(grain as usize) {
                let place = center + sphere.center;
                let seed = wrapped(domain, place);
                if domain.contains(seed) {
                    sites.seeds.push(seed);
                    sites.bases.push(sphere.squared_radius);
                    sites.of_cell.push(grain);
                    sites.moves.push(whole_periods(domain, place - seed));
                }
            }
        }
        sites
    }

    fn spheres(&self, grain: usize) -> Vec<InscribedSphere> {
        let shape = self.shapes[grain].with_contrast(self.contrasts[grain]);
        let dimension = self.tessellation.domain().dimension();
        shape.inscribed_spheres(dimension, self.volumes[grain], self.fineness[grain])
    }

    fn state(&self) -> Clipped {
        Clipped::of(self.tessellation.clone(), self.weights.clone(), Arc::clone(&self.grains))
    }

    fn take(&mut self, sites: Sites, Clipped { tessellation, weights, grains, .. }: Clipped) {
        let mut shifts = vec![0.0; self.centers.len()];
        for ((grain, weight), base) in sites.of_cell.iter().zip(&weights).zip(&sites.bases) {
            shifts[*grain as usize] = weight - base;
        }
        self.shifts = Some(shifts);
        self.moves = sites.moves;
        self.tessellation = tessellation;
        self.weights = weights;
        self.grains = grains;
    }

    /// The grains moved by a fraction of the way to their centroids; nothing where one is empty then.
    fn moved(&self, fraction: f64) -> Option<(Vec<DVec3>, Sites, Clipped)> {
        let domain = self.tessellation.domain();
        let centroids = self.centroids();
        let ways: Vec<DVec3> =
            centroids.iter().zip(&self.centers).map(|(to, from)| fraction * (*to - *from)).collect();
        // Where each cell's seed goes, around which the grain's other cells go along.
        let goals: Vec<DVec3> = self
            .tessellation
            .seeds()
            .iter()
            .zip(self.grains.of_each_cell())
            .map(|(seed, grain)| *seed + ways[*grain as usize])
            .collect();
        let bases = self.sites(&self.centers).bases;
        let laplacian = Laplacian::new(&self.tessellation, &self.grains);
        let mut shifts = vec![0.0; self.centers.len()];
        laplacian.solve(
            &laplacian.right_side_of_moved(&goals, |cell| bases[cell.index()]),
            &mut shifts,
            MOVED_RESIDUAL,
        );
        let centers: Vec<DVec3> =
            self.centers.iter().zip(ways).map(|(center, way)| wrapped(domain, *center + way)).collect();
        if !centers.iter().all(|center| domain.contains(*center)) {
            return None;
        }
        let sites = self.sites(&centers);
        let grains = Grains::of_cells(sites.of_cell.clone(), centers.len());
        let weights = grains.shifted(&sites.bases, |grain| shifts[grain]);
        let mut state = Clipped::new(domain, &sites.seeds, weights, grains).ok()?;
        let is_good = !state.has_empty() && approach(&mut state, &self.volumes, GOAL_BETWEEN_STEPS).is_ok();
        is_good.then_some((centers, sites, state))
    }

    /// The centroids of grains, around their centres.
    fn centroids(&self) -> Vec<DVec3> {
        let domain = self.tessellation.domain();
        let mut sums = vec![(DVec3::ZERO, 0.0); self.centers.len()];
        let cells = self.tessellation.cell_measures();
        for ((cell, moved), grain) in cells.iter().zip(&self.moves).zip(self.grains.of_each_cell()) {
            let (sum, volume) = &mut sums[*grain as usize];
            // From the centre, so that no digits are lost far from the origin.
            *sum += cell.volume * (cell.centroid + moved.vector(domain) - self.centers[*grain as usize]);
            *volume += cell.volume;
        }
        self.centers.iter().zip(sums).map(|(center, (sum, volume))| center + sum / volume).collect()
    }

    /// Of each grain the integral of `r r^T` over it, with r from its centroid: in the plane over its area. It tells the ellipsoid that a grain
    /// is like.
    pub fn second_moments(&self) -> Vec<DMat3> {
        let cells = self.tessellation.cell_measures();
        let centroids = self.centroids();
        let mut moments = vec![DMat3::ZERO; self.centers.len()];
        let all = (0u32..).map(CellId).zip(&cells).zip(&self.moves).zip(self.grains.of_each_cell());
        for (((cell, measure), moved), grain) in all {
            let way =
                measure.centroid + moved.vector(self.tessellation.domain()) - centroids[*grain as usize];
            let of_cell = second_moment(&self.tessellation, cell, measure.centroid);
            moments[*grain as usize] += of_cell + square(way) * measure.volume;
        }
        moments
    }

    /// Grains whose cells do not all hang together by faces that are no mere necks, where they stand with the grain.
    fn split_grains(&self) -> Vec<usize> {
        let pieces = pieces_of_cells(&self.tessellation, &self.grains, &self.moves, LEAST_NECK);
        let mut counts = vec![0; self.centers.len()];
        let cells = (0u32..).map(CellId).zip(&pieces);
        for (cell, _) in cells.filter(|(cell, piece)| cell.index() == **piece) {
            if !self.tessellation.cell_faces(cell).is_empty() {
                counts[self.grains.of(cell) as usize] += 1;
            }
        }
        counts.iter().enumerate().filter(|(_, count)| **count > 1).map(|(grain, _)| grain).collect()
    }

    /// The cells, of which some may be empty.
    pub fn tessellation(&self) -> &Tessellation {
        &self.tessellation
    }

    /// The weights of the cells, with which [`Tessellation::power`] gives them.
    pub fn weights(&self) -> &[f64] {
        &self.weights
    }

    /// The grain of each cell.
    pub fn grain_of_cell(&self) -> &[u32] {
        self.grains.of_each_cell()
    }

    /// By how much each cell has to be moved to stand with its grain: in a periodic domain its seed stands in the box.
    pub fn moves(&self) -> &[Translation] {
        &self.moves
    }

    /// The target volumes, by grain.
    pub fn volumes(&self) -> &[f64] {
        &self.volumes
    }

    /// By which the logarithms of each shape's proportions were multiplied, so that the grain is in one piece: 1 where it got its shape, 0
    /// where it is a convex cell.
    pub fn contrasts(&self) -> &[f64] {
        &self.contrasts
    }

    /// How many times grains moved to their centroids.
    pub fn centroid_steps(&self) -> usize {
        self.centroid_steps
    }
}

/// The largest squared radius of each grain's spheres.
fn grain_maxima(sites: &Sites, count: usize) -> Vec<f64> {
    let mut largest: Vec<f64> = vec![0.0; count];
    for (grain, base) in sites.of_cell.iter().zip(&sites.bases) {
        largest[*grain as usize] = largest[*grain as usize].max(*base);
    }
    largest
}

fn square(way: DVec3) -> DMat3 {
    DMat3::from_cols(way * way.x, way * way.y, way * way.z)
}

/// The second moment of a cell about a place in it: that of cones to its faces, which are convex as it is.
fn second_moment(tessellation: &Tessellation, cell: CellId, about: DVec3) -> DMat3 {
    let mut sum = DMat3::ZERO;
    for &face in tessellation.cell_faces(cell) {
        let corners = tessellation.face_corners(face);
        let at = |place: usize| tessellation.vertices()[corners[place].index()] - about;
        if let [_, _] = corners {
            let [a, b] = [at(0), at(1)];
            let area = 0.5 * a.truncate().perp_dot(b.truncate()).abs();
            sum += (square(a) + square(b) + square(a + b)) * (area / 12.0);
        }
        for last in 2..corners.len() {
            let [a, b, c] = [at(0), at(last - 1), at(last)];
            let volume = a.dot(b.cross(c)).abs() / 6.0;
            sum += (square(a) + square(b) + square(c) + square(a + b + c)) * (volume / 20.0);
        }
    }
    sum
}
