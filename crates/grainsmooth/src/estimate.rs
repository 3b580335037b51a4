//! What a run would make, told before it is made.

use std::fmt;

use polycrystal::{FaceMesh, MeshSize, remove_short_edges};
use voronoi::Dimension;

use crate::formats::format::FileSize;
use crate::memory::{ControlMesh, LevelSize, available_memory, check_levels, in_words};
use crate::run::pipeline::voxel_bytes;
use crate::{Config, Error, OutputFormat, Tessellated};

/// The size of a run's result: counts are exact but for boundaries that `edge-length` refines, and in space where cells are
/// regularised, as what collapses is decided by relaxation. These, and bytes, are about right.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimate {
    /// Number of grains.
    pub grains: usize,
    /// Points, edges and triangles of the finest level.
    pub mesh: LevelSize,
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
        let is_flat = config.dimension == Dimension::Two;
        let control_mesh = match config.effective_regularize() {
            length if length > 0.0 && !config.lets_topology_change() => {
                let (regular, _) = remove_short_edges(tessellation, length);
                let MeshSize { points, edges, triangles } =
                    config.regular_face_mesh().control_mesh_size(&regular);
                let size = LevelSize { points, edges, triangles };
                ControlMesh { size, arcs: 0, besides: voxel_bytes(config), is_still: false }
            }
            _ => crate::run::pipeline::control_mesh(config, tessellation),
        };
        let mesh = control_mesh.after(config.levels);
        let grains = cells.grain_count();
        Self {
            grains,
            mesh,
            is_exact: !matches!(config.face_mesh, FaceMesh::Refined { .. })
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
    /// [`LevelsExceedMemory`](crate::memory::MemoryError::LevelsExceedMemory) and [`LevelsExceedIds`](crate::memory::MemoryError::LevelsExceedIds).
    pub fn check(&self) -> Result<(), Error> {
        Ok(check_levels(self.control_mesh, self.levels, self.available)?)
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
        if let Some(bytes) = self.file {
            writeln!(out, "file        about {bytes} bytes ({})", in_words(bytes))?;
        }
        let (needed, available) = (in_words(self.memory), in_words(self.available.into()));
        write!(out, "memory      about {} bytes ({needed}), {available} available", self.memory)
    }
}
