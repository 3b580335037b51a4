pub(crate) mod coarsening;
pub(crate) mod control_mesh;
pub(crate) mod error;
pub(crate) mod face_mesh;
pub(crate) mod fan;
pub(crate) mod grain_complex;
pub(crate) mod grain_mesh;
pub(crate) mod junctions;
pub(crate) mod labelled_mesh;
pub(crate) mod line_coarsening;
pub(crate) mod tension;

use std::borrow::Cow;

use cancellation::check_cancelled;
use glam::DVec3;
use rayon::prelude::*;
use subzero::EdgeId;
use voronoi::{Domain, Tessellation};

use crate::check::folds::element_normals;
use crate::mesh::id::id;
use crate::mesh::volume::{boundary_cones, volumes_of_grains};
use crate::{
    Boundary, Certificate, FaceMesh, Freedom, GrainPart, Junctions, Level, LevelView, Mesh, MeshSize,
    NetworkError, PeriodicCopies, Side, Surface, WallSet, WallSets,
};
use control_mesh::{ControlMesh, JunctionCounts};
use labelled_mesh::SurfaceKind;
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
    /// Where the finest level is one more: the copies there.
    finest_copies: Option<PeriodicCopies>,
}

impl Network {
    /// The network of a tessellation, refined `level_count` times, and its control points: still flat.
    ///
    /// ```
    /// use glam::DVec3;
    /// use polycrystal::{Junctions, Network};
    /// use voronoi::{Domain, Tessellation};
    ///
    /// let seeds = [DVec3::new(0.25, 0.5, 0.5), DVec3::new(0.75, 0.5, 0.5)];
    /// let cells = Tessellation::new(&Domain::unit_cube(), &seeds)?;
    /// let (network, control_points) = Network::new(&cells, Junctions::Crease, 2)?;
    /// assert_eq!(network.boundaries().len(), 11, "one between the grains, five walls of each");
    /// // Each level has four times as many triangles as the one before.
    /// assert_eq!(network.finest().element_count(), 16 * network.control_mesh().element_count());
    /// let points = network.subdivide(&control_points);
    /// assert!((network.grain_volumes(network.finest(), &points)[0] - 0.5).abs() < 1e-12);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`NetworkError::TooLarge`] when a level outgrows 32-bit ids; [`NetworkError::BoundaryTooSmall`] when more than four
    /// grains all but meet in a point.
    pub fn new(
        tessellation: &Tessellation,
        junctions: Junctions,
        level_count: usize,
    ) -> Result<(Self, Vec<DVec3>), NetworkError> {
        Self::with_face_mesh(tessellation, FaceMesh::Fan, junctions, level_count)
    }

    /// As [`Self::new`], with a choice of control points.
    ///
    /// # Errors
    /// As [`Self::new`]; [`NetworkError::BadEdgeLength`].
    pub fn with_face_mesh(
        tessellation: &Tessellation,
        face_mesh: FaceMesh,
        junctions: Junctions,
        level_count: usize,
    ) -> Result<(Self, Vec<DVec3>), NetworkError> {
        check_face_mesh(tessellation, face_mesh, level_count)?;
        let control_mesh = ControlMesh::new(tessellation, face_mesh, junctions)?;
        let cell_volumes = tessellation.cell_measures().iter().map(|cell| cell.volume).collect();
        Self::assemble(tessellation.domain(), control_mesh, cell_volumes, level_count)
    }

    /// As [`Self::with_face_mesh`] of grains of one cell or several each, by the grain that each cell is part of. Faces between cells of one grain drop
    /// out; a boundary is what faces between two grains make up where they hang together, in however many planes they lie.
    ///
    /// Grains need not be convex, and one may lie within another. In a periodic domain, cells of a grain touch each other once they are moved to stand with it.
    ///
    /// `coarsening` collapses edges that cells leave in the boundaries and lines between grains: those shorter than this part of the size of the smallest grain
    /// there (the edge of a cube as large; in the plane, of a square). Lines between two points of four grains collapse where they are shorter than two fifths of that. 0 keeps all edges.
    ///
    /// # Errors
    /// As [`Self::with_face_mesh`]; [`NetworkError::GrainInPieces`], [`NetworkError::MissingGrain`].
    ///
    /// # Panics
    /// When there is not one grain for each cell.
    pub fn of_grains(
        tessellation: &Tessellation,
        parts: &[GrainPart],
        face_mesh: FaceMesh,
        junctions: Junctions,
        coarsening: f64,
        level_count: usize,
    ) -> Result<(Self, Vec<DVec3>), NetworkError> {
        check_face_mesh(tessellation, face_mesh, level_count)?;
        let grain_count = parts.iter().map(|part| part.grain.index() + 1).max().unwrap_or(0);
        let mut volumes = vec![0.0; grain_count];
        for (part, cell) in parts.iter().zip(tessellation.cell_measures()) {
            volumes[part.grain.index()] += cell.volume;
        }
        let dimension = tessellation.domain().dimension();
        let lengths =
            volumes.iter().map(|volume| coarsening * dimension.cube_edge(*volume)).collect::<Vec<f64>>();
        let control_mesh = ControlMesh::of_grains(tessellation, parts, &lengths, face_mesh, junctions)?;
        Self::assemble(tessellation.domain(), control_mesh, volumes, level_count)
    }

    /// The network of cells in space, each of whose lines goes through one point, its middle.
    pub(crate) fn of_curved_lines(
        tessellation: &Tessellation,
        middles: &[DVec3],
        junctions: Junctions,
        level_count: usize,
    ) -> Result<(Self, Vec<DVec3>), NetworkError> {
        check_face_mesh(tessellation, FaceMesh::SparseFan, level_count)?;
        let control_mesh = ControlMesh::of_curved_lines(tessellation, middles, junctions)?;
        let cell_volumes = tessellation.cell_measures().iter().map(|cell| cell.volume).collect();
        Self::assemble(tessellation.domain(), control_mesh, cell_volumes, level_count)
    }

    /// The network of cells in the plane, each of whose edges, in order, has so many segments on the control mesh.
    pub(crate) fn of_divided_lines(
        tessellation: &Tessellation,
        counts: &[u32],
        level_count: usize,
    ) -> Result<Self, NetworkError> {
        let edges: u128 = counts.iter().map(|count| u128::from(*count)).sum();
        let points = tessellation.vertices().len() as u128 + edges - counts.len() as u128;
        check_size(tessellation.domain(), &MeshSize { points, edges, triangles: 0 }, level_count)?;
        let control_mesh = ControlMesh::of_divided_lines(tessellation, counts)?;
        let cell_volumes = vec![0.0; tessellation.cell_count()];
        Ok(Self::assemble(tessellation.domain(), control_mesh, cell_volumes, level_count)?.0)
    }

    /// The network of any triangles (in the plane: segments) between grains that fill a domain without periods, refined
    /// `level_count` times, and its control points: those of the surface.
    ///
    /// Elements of one boundary that do not hang together, or lie on several walls, become several boundaries; of the two
    /// sides the smaller comes first. Lines of the network are the edges where not just two elements of one boundary meet.
    ///
    /// # Errors
    /// [`NetworkError::Invalid`] with all that [`certify`](crate::certify) finds wrong: grains must be closed, fill the domain,
    /// and cross nowhere. [`NetworkError::NotOnWall`], [`NetworkError::MissingGrain`], [`NetworkError::PeriodicSurface`],
    /// [`NetworkError::TooLarge`].
    ///
    /// # Panics
    /// When elements refer to points or boundaries that there are not.
    pub fn of_surface(
        domain: &Domain,
        surface: &Surface<'_>,
        junctions: Junctions,
        level_count: usize,
    ) -> Result<(Self, Vec<DVec3>), NetworkError> {
        let count = surface.grains().last().map_or(0, |grain| grain.index() + 1);
        let (network, points) = Self::of_grains_left(domain, surface, count, junctions, level_count)?;
        match (0u32..).zip(&network.cell_volumes).find(|(_, volume)| **volume == 0.0) {
            Some((grain, _)) => Err(NetworkError::MissingGrain { grain: crate::GrainId(grain) }),
            None => Ok((network, points)),
        }
    }

    /// As [`Self::of_surface`], of any closed grains, such as another program's file holds: they need not fill the domain, and may be folded. What lies on the domain's walls is known
    /// as such. Also what [`certify`](crate::certify) finds, whose only faults are folds.
    ///
    /// # Errors
    /// [`NetworkError::Invalid`] with all faults but folds; [`NetworkError::MissingGrain`], [`NetworkError::PeriodicSurface`], [`NetworkError::TooLarge`].
    ///
    /// # Panics
    /// As [`Self::of_surface`].
    pub fn of_closed_grains(
        domain: &Domain,
        surface: &Surface<'_>,
        junctions: Junctions,
    ) -> Result<(Self, Vec<DVec3>, Certificate), NetworkError> {
        let grains = surface.grains();
        if let Some((number, _)) = (0u32..).zip(&grains).find(|(number, grain)| *number != grain.0) {
            return Err(NetworkError::MissingGrain { grain: crate::GrainId(number) });
        }
        Self::of_measured(domain, surface, None, junctions)
    }

    /// As [`Self::of_closed_grains`], which are to have these volumes, where some are given.
    pub(crate) fn of_measured(
        domain: &Domain,
        surface: &Surface<'_>,
        volumes: Option<&[f64]>,
        junctions: Junctions,
    ) -> Result<(Self, Vec<DVec3>, Certificate), NetworkError> {
        check_surface_size(domain, surface, 0)?;
        let kind = SurfaceKind::Measured { volumes };
        let certificate = kind.certify(domain, surface)?;
        let control_mesh = ControlMesh::of_surface(domain, surface, kind, junctions)?;
        let own = || certificate.grain_volumes.iter().map(|(_, volume)| *volume).collect();
        let volumes = volumes.map_or_else(own, <[f64]>::to_vec);
        let (network, points) = Self::assemble(domain, control_mesh, volumes, 0)?;
        Ok((network, points, certificate))
    }

    /// As [`Self::of_surface`], where some of so many grains may be missing.
    pub(crate) fn of_grains_left(
        domain: &Domain,
        surface: &Surface<'_>,
        grain_count: usize,
        junctions: Junctions,
        level_count: usize,
    ) -> Result<(Self, Vec<DVec3>), NetworkError> {
        check_surface_size(domain, surface, level_count)?;
        SurfaceKind::Whole.certify(domain, surface)?;
        let control_mesh = ControlMesh::of_surface(domain, surface, SurfaceKind::Whole, junctions)?;
        let (mut network, points) = Self::assemble(domain, control_mesh, Vec::new(), level_count)?;
        network.cell_volumes = vec![0.0; grain_count];
        network.cell_volumes = network.grain_volumes(network.control_mesh(), &points);
        Ok((network, points))
    }

    /// The network of a control mesh, and its points.
    fn assemble(
        domain: &Domain,
        control_mesh: ControlMesh,
        cell_volumes: Vec<f64>,
        level_count: usize,
    ) -> Result<(Self, Vec<DVec3>), NetworkError> {
        let ControlMesh { level, mut points, boundaries, wall_sets, junctions } = control_mesh;
        level.copies.place(domain, &mut points);
        let mut normals = element_normals(&level, &points).into_iter().zip(&level.boundary_of);
        if let Some((_, boundary)) = normals.find(|(normal, _)| normal.length() == 0.0 || normal.is_nan()) {
            let sides = boundaries[boundary.index()].sides_across(&boundaries);
            return Err(NetworkError::BoundaryTooSmall { sides });
        }
        let mut levels = vec![level];
        for coarser in 0..level_count.min(finest_held(domain, level_count)) {
            check_cancelled();
            levels.push(levels[coarser].refine(&boundaries, &wall_sets)?);
        }
        let finest_copies = match &levels[levels.len() - 1] {
            held if levels.len() <= level_count => Some(held.finest_copies()?),
            _ => None,
        };
        let is_between_grains = |boundary: &Boundary| boundary.is_interior() || boundary.twin.is_some();
        let tension = |boundary: &Boundary| if is_between_grains(boundary) { 1.0 } else { 0.0 };
        let network = Self {
            tensions: boundaries.iter().map(tension).collect(),
            mobilities: vec![1.0; boundaries.len()],
            domain: domain.clone(),
            boundaries,
            junctions,
            cell_volumes,
            wall_sets,
            levels,
            finest_copies,
        };
        Ok((network, points))
    }

    /// The same boundaries on another, single level.
    pub(crate) fn with_level(&self, level: Level) -> Self {
        Self {
            domain: self.domain.clone(),
            boundaries: self.boundaries.clone(),
            junctions: self.junctions.clone(),
            cell_volumes: self.cell_volumes.clone(),
            tensions: self.tensions.clone(),
            mobilities: self.mobilities.clone(),
            wall_sets: self.wall_sets.clone(),
            levels: vec![level],
            finest_copies: None,
        }
    }

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
        self.tensions.clear();
        for boundary in &self.boundaries {
            let boundary = boundary.between_grains(&self.boundaries);
            self.tensions.push(checked_tension(&boundary, tension(&boundary))?);
        }
        Ok(self)
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
        self.mobilities.clear();
        for boundary in &self.boundaries {
            let boundary = boundary.between_grains(&self.boundaries);
            self.mobilities.push(checked_mobility(&boundary, mobility(&boundary))?);
        }
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
        self.levels.len() - usize::from(self.finest_copies.is_none())
    }

    /// The connectivity of the levels that are held in memory: all of few, and in space all but the finest from the third on.
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
        match (self.levels.get(level), &self.finest_copies) {
            (Some(held), _) => held.into(),
            (None, Some(copies)) if level == self.levels.len() => LevelView::Refined {
                parent: &self.levels[level - 1],
                copies,
                generation: u8::try_from(level).expect("there are fewer than 128 levels"),
            },
            _ => panic!("there is no level {level}"),
        }
    }

    /// The connectivity of the finest level.
    pub fn finest(&self) -> LevelView<'_> {
        self.level(self.level_count())
    }

    /// The finest level as a whole, made for it where it is not held in memory.
    pub fn finest_level(&self) -> Cow<'_, Level> {
        match self.finest() {
            LevelView::Held(level) => Cow::Borrowed(level),
            LevelView::Refined { parent, .. } => {
                let finest = parent.refine(&self.boundaries, &self.wall_sets);
                Cow::Owned(finest.expect("ids were counted when the network was made"))
            }
        }
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
        let coarsest = self.level(from);
        assert_eq!(points.len(), coarsest.vertex_count(), "there must be one point per vertex");
        let mut points = points.to_vec();
        coarsest.copies().place(&self.domain, &mut points);
        for level in from + 1..=to {
            check_cancelled();
            let finer = self.level(level);
            points = self.levels[level - 1].mesh.step(&points);
            points.par_iter_mut().enumerate().for_each(|(vertex, point)| {
                let walls = finer.walls(vertex, &self.wall_sets);
                if !walls.is_empty() {
                    *point = self.wall_sets.put_on_walls(walls, *point);
                }
            });
            finer.copies().place(&self.domain, &mut points);
        }
        points
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
            let middles: Vec<DVec3> = match &self.levels[level - 1].mesh {
                Mesh::Triangles(mesh) => {
                    let edges = (0..mesh.counts().edges).into_par_iter();
                    edges.map(|edge| middle(mesh.edge(EdgeId(edge)))).collect()
                }
                Mesh::Segments(mesh) => mesh.segments().par_iter().map(|ends| middle(*ends)).collect(),
            };
            points.extend(middles);
            self.level(level).copies().place(&self.domain, &mut points);
        }
        points
    }

    /// Volume (in the plane: area) of each grain, for points of the given level.
    pub fn grain_volumes<'a>(&self, level: impl Into<LevelView<'a>>, points: &[DVec3]) -> Vec<f64> {
        let cones = boundary_cones(&Surface::of_level(level.into(), points, &self.sides()));
        volumes_of_grains(&self.boundaries, &cones, self.grain_count())
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

/// The finest level whose points relaxation may move by themselves.
const FINEST_MOVED: usize = 2;

/// The finest level that is held in memory of so many: points of no finer one move by themselves, and the last follows from the one before. In
/// the plane, where levels are small, all.
fn finest_held(domain: &Domain, level_count: usize) -> usize {
    match domain.dimension() {
        voronoi::Dimension::Two => level_count,
        voronoi::Dimension::Three => FINEST_MOVED.max(level_count.saturating_sub(1)),
    }
}

/// Checks that the faces of cells can be filled as asked, and refined so often.
fn check_face_mesh(
    tessellation: &Tessellation,
    face_mesh: FaceMesh,
    level_count: usize,
) -> Result<(), NetworkError> {
    if let FaceMesh::Refined { edge_length } = face_mesh
        && !(edge_length.is_finite() && edge_length > 0.0)
    {
        return Err(NetworkError::BadEdgeLength(edge_length));
    }
    check_size(tessellation.domain(), &face_mesh.control_mesh_size(tessellation), level_count)
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

fn check_surface_size(
    domain: &Domain,
    surface: &Surface<'_>,
    level_count: usize,
) -> Result<(), NetworkError> {
    let count = surface.elements.len() as u128;
    let size = MeshSize { points: surface.points.len() as u128, edges: count, triangles: count };
    check_size(domain, &size, level_count)
}

/// Subdivision multiplies elements by four (in the plane: two); the largest ids are those of half-edges, three a triangle.
fn check_size(domain: &Domain, size: &MeshSize, level_count: usize) -> Result<(), NetworkError> {
    let (factor, parts, of_control_mesh) = match domain.dimension() {
        voronoi::Dimension::Two => (2u128, "segments", size.edges),
        voronoi::Dimension::Three => (4u128, "half-edges", 3 * size.triangles),
    };
    for level in 0..=level_count {
        let growth = factor.saturating_pow(u32::try_from(level).unwrap_or(u32::MAX));
        let count = growth.saturating_mul(of_control_mesh);
        if count >= u128::from(u32::MAX) {
            return Err(NetworkError::TooLarge { level, count, parts });
        }
    }
    Ok(())
}
