//! What a run would make, told before it is made.

use std::fmt;

use glam::DVec3;
use polycrystal::{FaceMesh, MeshSize, remove_short_edges};
use voronoi::Dimension;

use crate::formats::format::FileSize;
use crate::memory::{ControlMesh, LevelSize, available_memory, check_levels, in_words};
use crate::run::pipeline::{motion, voxel_bytes};
use crate::{Config, Error, OutputFormat, PeriodicCut, Tessellated};

/// The size of a run's result: counts are exact but for boundaries that `edge-length` refines, and in space where cells are
/// regularised, as what collapses is decided by relaxation. These, and bytes, are about right.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimate {
    /// Number of grains.
    pub grains: usize,
    /// Points, edges and triangles of the finest level.
    pub mesh: LevelSize,
    /// Elements that fill the grains, if elements have a size: tetrahedra, in the plane triangles.
    pub filled: Option<u128>,
    /// Whether these counts are exact.
    pub is_exact: bool,
    /// Two or three dimensions.
    pub dimension: Dimension,
    /// Bytes of the files; nothing where none is written.
    pub file: Option<u128>,
    /// Bytes of memory that the run takes at its peak.
    pub memory: u128,
    /// Bytes of memory that there are.
    pub available: u64,
    control_mesh: ControlMesh,
    levels: u32,
}

impl Estimate {
    /// The size of what becomes of some cells, in files of these formats.
    pub fn new(config: &Config, cells: &Tessellated, formats: &[OutputFormat]) -> Self {
        let tessellation = &cells.tessellation;
        let to_write = config.to_write();
        let of_voxels = formats.iter().map(|format| format.memory_of_voxels(&to_write)).max().unwrap_or(0);
        let is_flat = config.dimension == Dimension::Two;
        let mut control_mesh = match config.effective_regularize() {
            length if length > 0.0 && !config.lets_topology_change() => {
                let (regular, _) = remove_short_edges(tessellation, length);
                let MeshSize { points, edges, triangles } =
                    config.regular_face_mesh().control_mesh_size(&regular);
                let size = LevelSize { points, edges, triangles };
                ControlMesh { size, arcs: 0, besides: voxel_bytes(config), motion: motion(config) }
            }
            _ => crate::run::pipeline::control_mesh(config, tessellation),
        };
        control_mesh.besides = control_mesh.besides.saturating_add(of_voxels);
        let grains = cells.grain_count();
        let smooth = control_mesh.after(config.levels);
        let remeshed = config.elements.are_asked().then(|| Remeshed::new(config, cells));
        let mesh = remeshed.as_ref().map_or(smooth, |remeshed| remeshed.boundaries);
        Self {
            grains,
            mesh,
            filled: remeshed.map(|remeshed| remeshed.filled),
            is_exact: !config.elements.are_asked()
                && !matches!(config.face_mesh, FaceMesh::Refined { .. })
                && !config.lets_topology_change()
                && (config.effective_regularize() == 0.0 || is_flat),
            dimension: config.dimension,
            file: formats
                .iter()
                .map(|format| format.bytes(&FileSize { mesh, grains: grains as u128, config }))
                .reduce(u128::saturating_add),
            memory: control_mesh.bytes_after(config.levels),
            available: available_memory(),
            control_mesh,
            levels: config.levels,
        }
    }

    /// Checks that it fits.
    ///
    /// # Errors
    /// [`LevelsExceedMemory`](crate::memory::MemoryError::LevelsExceedMemory), [`VoxelsExceedMemory`](crate::memory::MemoryError::VoxelsExceedMemory) and
    /// [`LevelsExceedIds`](crate::memory::MemoryError::LevelsExceedIds).
    pub fn check(&self) -> Result<(), Error> {
        Ok(check_levels(self.control_mesh, self.levels, self.available)?)
    }
}

/// How many elements of a size there will be, by what 200 random grains had with 5 and 10 edges to the mean diameter, and 30 to 2000 in the plane.
struct Remeshed {
    boundaries: LevelSize,
    filled: u128,
}

/// The surface of a grain in units of its squared equivalent diameter, a third more than a ball's; two grains share it but for the sides of the box.
const SURFACE: f64 = 4.2;

/// Tetrahedra for the volume in units of the cubed size, and more for each triangle.
const TETRAHEDRA: f64 = 3.0;
const TETRAHEDRA_OF_TRIANGLE: f64 = 1.3;

/// In the plane, segments for each grain's diameter in units of the size.
const SEGMENTS: f64 = 2.1;

/// Triangles for an area in units of the squared size: 2.26 to 2.35 were found, where equilateral ones would be 2.31.
const TRIANGLES: f64 = 2.3;

impl Remeshed {
    fn new(config: &Config, cells: &Tessellated) -> Self {
        let volumes = cells.volumes();
        let diameters: Vec<f64> =
            volumes.iter().map(|volume| config.dimension.ball_diameter(*volume)).collect();
        let mean = diameters.iter().sum::<f64>() / diameters.len() as f64;
        let per_grain = config.elements.elements_per_grain.map(|count| mean / count);
        let size = config.elements.element_size.or(per_grain).unwrap_or(mean);
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "saturates, and is positive"
        )]
        let count = |number: f64| number.ceil() as u128;
        let of_diameters =
            |power: i32| diameters.iter().map(|diameter| (diameter / size).powi(power)).sum::<f64>();
        let whole: f64 = volumes.iter().sum();
        match config.dimension {
            Dimension::Two => {
                let segments = count(SEGMENTS * of_diameters(1));
                let boundaries = LevelSize { points: segments, edges: segments, triangles: 0 };
                Self { boundaries, filled: count(TRIANGLES * whole / size.powi(2)) }
            }
            Dimension::Three => {
                let sides = config.sides_of_box() / size.powi(2);
                let triangles = TRIANGLES * 0.5 * (SURFACE * of_diameters(2) + sides);
                let filled = TETRAHEDRA * whole / size.powi(3) + TETRAHEDRA_OF_TRIANGLE * triangles;
                let triangles = count(triangles);
                let boundaries = LevelSize { points: triangles / 2, edges: triangles * 3 / 2, triangles };
                Self { boundaries, filled: count(filled) }
            }
        }
    }
}

impl Config {
    /// The area of the box's sides at which grains end.
    fn sides_of_box(&self) -> f64 {
        let DVec3 { x, y, z } = self.box_size;
        let is_side = |axis: usize| !self.periodic.test(axis) || self.periodic_cut == PeriodicCut::Box;
        let pairs = [(0, y * z), (1, x * z), (2, x * y)].into_iter().filter(|(axis, _)| is_side(*axis));
        pairs.map(|(_, area)| 2.0 * area).sum()
    }
}

impl fmt::Display for Estimate {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(out, "grains      {}", self.grains)?;
        let about = if self.is_exact { "" } else { "about " };
        writeln!(out, "points      {about}{}", self.mesh.points)?;
        match self.dimension {
            Dimension::Two => writeln!(out, "segments    {about}{}", self.mesh.edges)?,
            Dimension::Three => writeln!(out, "triangles   {about}{}", self.mesh.triangles)?,
        }
        if let Some(filled) = self.filled {
            match self.dimension {
                Dimension::Two => writeln!(out, "filled      about {filled} triangles")?,
                Dimension::Three => writeln!(out, "filled      about {filled} tetrahedra")?,
            }
        }
        if let Some(bytes) = self.file {
            writeln!(out, "file        about {bytes} bytes ({})", in_words(bytes))?;
        }
        let (needed, available) = (in_words(self.memory), in_words(self.available.into()));
        write!(out, "memory      about {} bytes ({needed}), {available} available", self.memory)
    }
}
