pub(crate) mod build;
pub(crate) mod coarsening;
pub(crate) mod control_mesh;
mod corners;
pub(crate) mod error;
pub(crate) mod face_mesh;
pub(crate) mod fan;
pub(crate) mod grain_complex;
pub(crate) mod grain_mesh;
pub(crate) mod junctions;
pub(crate) mod labelled_mesh;
pub(crate) mod line_coarsening;
pub(crate) mod merged;
pub(crate) mod periodic_grains;
pub(crate) mod tension;

use std::borrow::Cow;

use cancellation::check_cancelled;
use glam::DVec3;
use rayon::prelude::*;
use subzero::{EdgeId, TriangleMesh};
use voronoi::Domain;

use crate::mesh::boundary_elements::BoundaryElements;
use crate::mesh::id::id;
use crate::mesh::level::LevelMesh;
use crate::mesh::level_points::LevelPoints;
use crate::mesh::volume::{boundary_cones, volumes_of_grains};
use crate::{
    Boundary, Freedom, Level, LevelView, Mesh, NetworkError, PeriodicCopies, RefinedLevel, Side, WallSet,
    WallSets,
};
use control_mesh::JunctionCounts;
use tension::{checked_mobility, checked_tension, mean_in_flow};

/// All boundaries, triple lines and quadruple points of one polycrystal, on every level of subdivision.
///
/// Holds connectivity only; control points and refined points live beside it as slices.
#[derive(Debug, Clone, PartialEq)]
pub struct Network {
    domain: Domain,
    boundaries: Vec<Boundary>,
    junctions: JunctionCounts,
    cell_volumes: Vec<f64>,
    /// Of each boundary.
    tensions: Vec<f64>,
    mobilities: Vec<f64>,
    wall_sets: WallSets,
    /// From the control mesh to the finest that is held in memory.
    levels: Vec<Level>,
    /// The copies on each finer level.
    finer_copies: Vec<PeriodicCopies>,
}

impl Network {
    /// The network with other volumes (in the plane: areas) for relaxation to give its grains: those of the cells before
    /// their tessellation was regularised.
    ///
    /// # Panics
    /// When there are not as many volumes as grains.
    #[must_use]
    pub fn with_cell_volumes(mut self, volumes: Vec<f64>) -> Self {
        assert_eq!(volumes.len(), self.grain_count(), "one volume for each grain");
        self.cell_volumes = volumes;
        self
    }

    /// The network of points whose coordinates are multiplied by a factor of each axis; cells keep their volumes but for the factors'
    /// product.
    ///
    /// # Panics
    /// As [`Domain::stretched`].
    #[must_use]
    pub fn stretched(mut self, factors: DVec3) -> Self {
        self.domain = self.domain.stretched(factors);
        self.wall_sets = self.wall_sets.stretched(factors);
        let product = factors.element_product();
        self.cell_volumes.iter_mut().for_each(|volume| *volume *= product);
        self
    }

    /// The network with other tensions: energies per area (in the plane: per length) of its boundaries, in any unit. Without,
    /// boundaries between grains have 1 and walls 0.
    ///
    /// Each boundary is shown as [`Boundary::between_grains`] has it, in a periodic network like any other.
    ///
    /// # Errors
    /// [`NetworkError::BadTension`] where one is negative or not finite.
    pub fn with_tensions(mut self, tension: impl Fn(&Boundary) -> f64) -> Result<Self, NetworkError> {
        self.tensions = self.of_boundaries(|boundary| checked_tension(boundary, tension(boundary)))?;
        Ok(self)
    }

    fn of_boundaries<T, E>(&self, value: impl Fn(&Boundary) -> Result<T, E>) -> Result<Vec<T>, E> {
        self.boundaries.iter().map(|boundary| value(&boundary.between_grains(&self.boundaries))).collect()
    }

    /// The sides of all boundaries, by number.
    pub fn sides(&self) -> Vec<[Side; 2]> {
        self.boundaries().iter().map(|boundary| boundary.sides).collect()
    }

    /// The tension of each boundary, by number.
    pub fn tensions(&self) -> &[f64] {
        &self.tensions
    }

    /// The network with other mobilities, velocity per pressure, of its boundaries, in any unit; without, all have 1. In [`relax`] a boundary
    /// moves the faster. Where volumes are kept this changes the way to rest, and not rest itself; [`relax_cells`] knows of none.
    ///
    /// [`relax`]: crate::relax()
    /// [`relax_cells`]: crate::relax_cells
    ///
    /// # Errors
    /// [`NetworkError::BadMobility`].
    pub fn with_mobilities(mut self, mobility: impl Fn(&Boundary) -> f64) -> Result<Self, NetworkError> {
        self.mobilities = self.of_boundaries(|boundary| checked_mobility(boundary, mobility(boundary)))?;
        Ok(self)
    }

    /// The mobility of each boundary, by number.
    pub fn mobilities(&self) -> &[f64] {
        &self.mobilities
    }

    /// The unit of tensions in relaxation, as of [`mean_in_flow`].
    pub(crate) fn mean_tension(&self) -> f64 {
        mean_in_flow(self.boundaries.iter().zip(self.tensions.iter().copied()))
    }

    /// The unit of mobilities in relaxation.
    pub(crate) fn mean_mobility(&self) -> f64 {
        mean_in_flow(self.boundaries.iter().zip(self.mobilities.iter().copied()))
    }

    /// The domain that the grains fill.
    pub fn domain(&self) -> &Domain {
        &self.domain
    }

    /// Whether grains fill the domain: what is given may have pores, or not reach all walls.
    pub fn fills_domain(&self) -> bool {
        let is_inside = |boundary: &Boundary| {
            boundary.is_interior() || boundary.wall.is_some() || boundary.twin.is_some()
        };
        self.boundaries.iter().all(is_inside)
    }

    /// All boundaries, by number.
    pub fn boundaries(&self) -> &[Boundary] {
        &self.boundaries
    }

    /// For tests that break a network.
    #[cfg(test)]
    pub(crate) fn boundary_mut(&mut self, boundary: usize) -> &mut Boundary {
        &mut self.boundaries[boundary]
    }

    /// Numbers of triple lines and quadruple points.
    pub fn junction_counts(&self) -> &JunctionCounts {
        &self.junctions
    }

    /// Number of grains, with those that have vanished.
    pub fn grain_count(&self) -> usize {
        self.cell_volumes.len()
    }

    /// Number of grains that have a volume: grains that grow keep their numbers, and leave the volume 0 where they vanish.
    pub fn grains_left(&self) -> usize {
        self.cell_volumes.iter().filter(|volume| **volume != 0.0).count()
    }

    /// The volume (in the plane: area) of each grain's cell, which relaxation keeps.
    pub fn cell_volumes(&self) -> &[f64] {
        &self.cell_volumes
    }

    /// What the sets of walls in [`Level::walls`] are.
    pub fn wall_sets(&self) -> &WallSets {
        &self.wall_sets
    }

    /// How a point can move without leaving its walls.
    pub(crate) fn freedom(&self, walls: WallSet) -> Freedom {
        self.wall_sets.freedom(walls)
    }

    /// How often the control mesh is subdivided.
    pub fn level_count(&self) -> usize {
        self.levels.len() - 1 + self.finer_copies.len()
    }

    /// The connectivity of the levels that are held in memory: all of few, and in space all but the finest two from the third on.
    pub fn levels(&self) -> &[Level] {
        &self.levels
    }

    /// The control mesh.
    pub fn control_mesh(&self) -> &Level {
        &self.levels[0]
    }

    /// The connectivity of one level, the control mesh being level 0.
    ///
    /// # Panics
    /// When there is no such level.
    pub fn level(&self, level: usize) -> LevelView<'_> {
        if let Some(held) = self.levels.get(level) {
            return held.into();
        }
        let beyond = level - self.levels.len();
        let copies = self.finer_copies.get(beyond).unwrap_or_else(|| panic!("there is no level {level}"));
        let held = &self.levels[self.levels.len() - 1];
        LevelView::Refined(RefinedLevel::new(held, beyond + 1, &self.boundaries, copies, level))
    }

    /// The same, in space as it follows from the level two before where there is one.
    pub(crate) fn level_from_before(&self, level: usize) -> LevelView<'_> {
        if self.beyond(level).is_none() {
            return self.level(level);
        }
        let (before, copies) = (&self.levels[level - 2], self.level(level).copies());
        LevelView::Refined(RefinedLevel::new(before, 2, &self.boundaries, copies, level))
    }

    /// The connectivity of the finest level.
    pub fn finest(&self) -> LevelView<'_> {
        self.level(self.level_count())
    }

    /// The finest level as a whole, made for it where it is not held in memory.
    pub fn finest_level(&self) -> Cow<'_, Level> {
        self.whole_level(self.level_count())
    }

    /// One level as a whole, made for it where it is not held in memory.
    ///
    /// # Panics
    /// When there is no such level.
    pub fn whole_level(&self, level: usize) -> Cow<'_, Level> {
        assert!(level <= self.level_count(), "there is no level {level}");
        let held = level.min(self.levels.len() - 1);
        (held..level).fold(Cow::Borrowed(&self.levels[held]), |coarser, _| {
            let finer = coarser.refine(&self.boundaries, &self.wall_sets);
            Cow::Owned(finer.expect("ids were counted when the network was made"))
        })
    }

    /// The network with all levels up to this one held in memory, so that the points of this one can move by themselves.
    ///
    /// # Panics
    /// When there is no such level.
    pub(crate) fn holding(&self, level: usize) -> Cow<'_, Self> {
        let mut network = Cow::Borrowed(self);
        for finer in self.levels.len()..=level {
            let made = self.whole_level(finer).into_owned();
            let network = network.to_mut();
            network.levels.push(made);
            network.finer_copies.remove(0);
        }
        network
    }

    /// The points of the finest level for the given control points, all boundaries in parallel.
    ///
    /// Costs one pass over the points of each level: connectivity is not touched.
    ///
    /// # Panics
    /// When there is not one point per vertex of the control mesh.
    pub fn subdivide(&self, control_points: &[DVec3]) -> Vec<DVec3> {
        self.subdivide_between(0, self.level_count(), control_points)
    }

    /// The points of level `to` for those of level `from`.
    ///
    /// # Panics
    /// When there is not one point per vertex of level `from`, or no level `to`.
    pub fn subdivide_between(&self, from: usize, to: usize, points: &[DVec3]) -> Vec<DVec3> {
        let mut refined = self.refined_points(from, to, points);
        let level = self.level(to);
        if from < to {
            refined.par_iter_mut().enumerate().for_each(|(vertex, point)| {
                let walls = level.walls(vertex, &self.wall_sets);
                if !walls.is_empty() {
                    *point = self.wall_sets.put_on_walls(walls, *point);
                }
            });
        }
        level.copies().place(&self.domain, &mut refined);
        refined
    }

    /// The points of level `to`, as of [`Self::level_from_before`], for those of level `from`, up to rounding. In space, those of level 2 and finer ones are not
    /// kept: they would take four times as much memory as those of the level before.
    ///
    /// # Panics
    /// As of [`Self::subdivide_between`].
    pub(crate) fn points_between(&self, from: usize, to: usize, points: &[DVec3]) -> LevelPoints<'_> {
        match self.beyond(to) {
            Some(mesh) if from < to => {
                LevelPoints::following(mesh, self.refined_points(from, to - 1, points))
            }
            _ => {
                let elements = self.level_from_before(to).elements();
                LevelPoints::held(elements, self.subdivide_between(from, to, points))
            }
        }
    }

    /// As [`Self::subdivide_between`], where rounding may take points on walls and copies from their places.
    fn refined_points(&self, from: usize, to: usize, points: &[DVec3]) -> Vec<DVec3> {
        assert_eq!(points.len(), self.level(from).vertex_count(), "there must be one point per vertex");
        let mut points = points.to_vec();
        self.level(from).copies().place(&self.domain, &mut points);
        (from + 1..=to).fold(points, |points, level| {
            check_cancelled();
            match self.beyond(level) {
                Some(mesh) => mesh.loop_step_beyond(&points),
                None => self.levels[level - 1].mesh.step(&points),
            }
        })
    }

    /// Puts the points of the level before that make up a point of a level in place of `entries`, each with its weight.
    ///
    /// # Panics
    /// When there is no such level, or it is the control mesh.
    pub(crate) fn stencil(&self, level: usize, point: u32, entries: &mut Vec<(u32, f64)>) {
        match self.beyond(level) {
            Some(mesh) => mesh.loop_stencil_beyond(point, entries),
            None => self.levels[level - 1].mesh.stencil(point, entries),
        }
    }

    /// In space, the mesh two levels before a level: it alone says how points of that level follow from those of the one between.
    fn beyond(&self, level: usize) -> Option<&TriangleMesh> {
        match self.levels.get(level.checked_sub(2)?)?.mesh {
            Mesh::Triangles(ref mesh) => Some(mesh),
            Mesh::Segments(_) => None,
        }
    }

    /// The points of the finest level for flat boundaries: each new one midway between the ends of its edge.
    ///
    /// Within a plane [`Self::subdivide`] would change nothing but where points are, and in the fan of a long, thin boundary it would
    /// put triangles over each other. Halving edges keeps the shape of every triangle.
    ///
    /// # Panics
    /// When there is not one point per vertex of the control mesh.
    pub fn divide(&self, control_points: &[DVec3]) -> Vec<DVec3> {
        assert_eq!(
            control_points.len(),
            self.control_mesh().vertex_count(),
            "there must be one point per vertex"
        );
        let mut points = control_points.to_vec();
        self.control_mesh().copies.place(&self.domain, &mut points);
        for level in 1..=self.level_count() {
            let middle = |[a, b]: [u32; 2]| points[a as usize].midpoint(points[b as usize]);
            let middles: Vec<DVec3> = match self.level(level - 1).mesh() {
                LevelMesh::Triangles(mesh) => {
                    let edges = (0..mesh.counts().edges).into_par_iter();
                    edges.map(|edge| middle(mesh.edge(EdgeId(edge)))).collect()
                }
                LevelMesh::Segments(mesh) => mesh.segments().par_iter().map(|ends| middle(*ends)).collect(),
            };
            points.extend(middles);
            self.level(level).copies().place(&self.domain, &mut points);
        }
        points
    }

    /// Volume (in the plane: area) of each grain, for points of the given level.
    pub fn grain_volumes<'a>(&self, level: impl Into<LevelView<'a>>, points: &[DVec3]) -> Vec<f64> {
        let level = level.into();
        self.volumes_of(level, &LevelPoints::held(level.elements(), points))
    }

    /// Volume (in the plane: area) of each grain on a level whose elements have these points.
    pub(crate) fn volumes_of(&self, level: LevelView<'_>, points: &LevelPoints<'_>) -> Vec<f64> {
        let boundaries = BoundaryElements::of_level(level, self.boundaries.len());
        volumes_of_grains(&self.boundaries, &boundary_cones(&boundaries, points), self.grain_count())
    }

    /// Surface area (in the plane: perimeter) of each grain, for points of the given level.
    pub(crate) fn grain_areas(&self, level: LevelView<'_>, points: &[DVec3]) -> Vec<f64> {
        let share = match self.domain.dimension() {
            voronoi::Dimension::Two => 1.0,
            voronoi::Dimension::Three => 0.5,
        };
        let elements = level.elements();
        let mut areas = vec![0.0; self.grain_count()];
        for element in 0..id(elements.len()) {
            let area = share * elements.normal(points, element).length();
            for (grain, _) in self.boundaries[level.boundary(element).index()].signed_grains() {
                areas[grain.index()] += area;
            }
        }
        areas
    }

    /// The edge of a cube (in the plane: of a square) with the mean grain volume: the unit of lengths in relaxation.
    pub fn mean_grain_size(&self) -> f64 {
        mean_grain_size(&self.domain, self.grains_left())
    }

    /// The mean grain size, or the box's shortest side where that is shorter: the size of what can be seen to be small.
    pub(crate) fn feature_size(&self) -> f64 {
        feature_size(&self.domain, self.grains_left())
    }
}

/// As of [`Network::mean_grain_size`], of so many grains in a domain.
pub(crate) fn mean_grain_size(domain: &Domain, grain_count: usize) -> f64 {
    domain.dimension().cube_edge(domain.measure() / grain_count as f64)
}

/// As of [`Network::feature_size`], of so many grains in a domain.
pub(crate) fn feature_size(domain: &Domain, grain_count: usize) -> f64 {
    let size = domain.size();
    let shortest = match domain.dimension() {
        voronoi::Dimension::Two => size.truncate().min_element(),
        voronoi::Dimension::Three => size.min_element(),
    };
    mean_grain_size(domain, grain_count).min(shortest)
}
