//! How networks are made: of tessellations, of surfaces with labels, of grains that were measured.

use cancellation::check_cancelled;
use glam::DVec3;
use subzero::RefinedMesh;
use voronoi::{Domain, Tessellation};

use super::Network;
use super::control_mesh::ControlMesh;
use super::labelled_mesh::SurfaceKind;
use crate::check::folds::element_normals;
use crate::{Boundary, Certificate, FaceMesh, GrainPart, Junctions, Level, MeshSize, NetworkError, Surface};

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

    /// The network of cells in space, each of whose lines goes through one point, its middle; all of each boundary is seen from its centre.
    pub(crate) fn of_curved_lines(
        tessellation: &Tessellation,
        middles: &[DVec3],
        centers: &[DVec3],
        junctions: Junctions,
        level_count: usize,
    ) -> Result<(Self, Vec<DVec3>), NetworkError> {
        check_face_mesh(tessellation, FaceMesh::SparseFan, level_count)?;
        let control_mesh = ControlMesh::of_curved_lines(tessellation, middles, centers, junctions)?;
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
        check_surface(domain, surface, 0)?;
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
        check_surface(domain, surface, level_count)?;
        SurfaceKind::Whole.certify(domain, surface)?;
        let control_mesh = ControlMesh::of_surface(domain, surface, SurfaceKind::Whole, junctions)?;
        let (mut network, points) = Self::assemble(domain, control_mesh, Vec::new(), level_count)?;
        network.cell_volumes = vec![0.0; grain_count];
        network.cell_volumes = network.grain_volumes(network.control_mesh(), &points);
        Ok((network, points))
    }

    /// The network of a control mesh, and its points.
    pub(super) fn assemble(
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
        let finer_copies = levels[levels.len() - 1].copies_beyond(level_count + 1 - levels.len())?;
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
            finer_copies,
        };
        Ok((network, points))
    }

    /// The network with so many more levels, all held. [`Self::divide`] puts their points on the triangles of the finest level that there is now.
    ///
    /// # Errors
    /// [`NetworkError::TooLarge`].
    pub fn divided(&self, level_count: usize) -> Result<Self, NetworkError> {
        let finest = self.finest_level().into_owned();
        let [points, count] = [finest.vertex_count(), finest.element_count()].map(|count| count as u128);
        check_size(&self.domain, &MeshSize { points, edges: count, triangles: count }, level_count)?;
        let mut divided = self.with_level(finest);
        for coarser in 0..level_count {
            check_cancelled();
            divided.levels.push(divided.levels[coarser].refine(&self.boundaries, &self.wall_sets)?);
        }
        Ok(divided)
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
            finer_copies: Vec::new(),
        }
    }
}

/// The finest level whose points relaxation may move by themselves: it has forty inside a face.
pub(crate) const FINEST_MOVED: usize = 2;

/// The finest level that is held in memory of so many: two more follow from it. In the plane, where levels are small, all are held, and in space those
/// of few, whose points may move by themselves.
fn finest_held(domain: &Domain, level_count: usize) -> usize {
    match domain.dimension() {
        voronoi::Dimension::Two => level_count,
        voronoi::Dimension::Three if level_count <= FINEST_MOVED => level_count,
        voronoi::Dimension::Three => level_count - RefinedMesh::MOST_LEVELS,
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

/// Checks that a surface can be a network, refined so often: its domain has walls only.
fn check_surface(domain: &Domain, surface: &Surface<'_>, level_count: usize) -> Result<(), NetworkError> {
    if domain.is_periodic() {
        return Err(NetworkError::PeriodicSurface);
    }
    check_size(domain, &surface_size(surface), level_count)
}

pub(super) fn surface_size(surface: &Surface<'_>) -> MeshSize {
    let count = surface.elements.len() as u128;
    MeshSize { points: surface.points.len() as u128, edges: count, triangles: count }
}

/// Subdivision multiplies elements by four (in the plane: two); the largest ids are those of half-edges, three a triangle.
pub(super) fn check_size(domain: &Domain, size: &MeshSize, level_count: usize) -> Result<(), NetworkError> {
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
