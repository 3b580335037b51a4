//! What a run would make, told before it is made.

use std::fmt;

use polycrystal::{FaceMesh, MeshSize};
use voronoi::Dimension;

use crate::memory::{ControlMesh, LevelSize, available_memory, check_levels, in_words};
use crate::pipeline::voxel_bytes;
use crate::vtk::{VtkEncoding, VtkFormat};
use crate::{Config, Error, OutputFormat, StlEncoding, Tessellated};

/// Bytes of what stands before and after the numbers of a VTK file.
const VTK_HEAD: u128 = 4000;

/// Bytes of a line of text with a point, and with a triangle or an edge, as most numbers are spelled.
const TEXT_POINT: u128 = 62;
const TEXT_CORNERS: u128 = 24;

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
                let (regular, _) = tessellation.regularized(length);
                let MeshSize { points, edges, triangles } =
                    config.regular_face_mesh().control_mesh_size(&regular);
                let size = LevelSize { points, edges, triangles };
                ControlMesh { size, arcs: 0, besides: voxel_bytes(config) }
            }
            _ => crate::pipeline::control_mesh(config, tessellation),
        };
        let mesh = control_mesh.after(config.levels);
        let grains = tessellation.cell_count();
        Self {
            grains,
            mesh,
            is_exact: !matches!(config.face_mesh, FaceMesh::Refined { .. })
                && !config.lets_topology_change()
                && (config.effective_regularize() == 0.0 || is_flat),
            dimension: config.dimension,
            file: formats
                .iter()
                .map(|format| file_bytes(*format, &mesh, grains, config))
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
    /// [`Error::LevelsExceedMemory`] and [`Error::LevelsExceedIds`].
    pub fn check(&self) -> Result<(), Error> {
        check_levels(self.control_mesh, self.levels, self.available)
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

/// Bytes of a file, from those of each point, triangle and grain.
fn file_bytes(format: OutputFormat, mesh: &LevelSize, grains: usize, config: &Config) -> u128 {
    let LevelSize { points, edges, triangles } = *mesh;
    let is_flat = config.dimension == Dimension::Two;
    // Coordinates and three arrays; corners, end and three numbers. In the plane lines share their arrays.
    let (of_point, of_triangle) = if config.periodic.any() { (31, 32) } else { (27, 28) };
    let network = VTK_HEAD + of_point * points + if is_flat { 4 * edges } else { of_triangle * triangles };
    let voxels = config.voxel_count();
    let bytes = match format {
        OutputFormat::Vtk(VtkFormat::Vtp | VtkFormat::Vtk) => network,
        OutputFormat::Vtk(VtkFormat::Vtu) => network + triangles,
        // Boundaries have normals, and every triangle comes at two grains, with five arrays.
        OutputFormat::Vtm => network + 27 * points + 2 * (24 * points + 48 * triangles),
        OutputFormat::Stl if config.file.stl == StlEncoding::Ascii => 270 * triangles,
        OutputFormat::Stl => 84 + 50 * triangles,
        OutputFormat::Ply => 24 * points + 25 * triangles,
        OutputFormat::Obj => TEXT_POINT * points + TEXT_CORNERS * triangles,
        OutputFormat::Msh => TEXT_POINT * points + (TEXT_CORNERS + 8) * triangles,
        OutputFormat::Fe => TEXT_POINT * points + TEXT_CORNERS * (edges + triangles),
        // Of a Poisson-Voronoi cell's share: 7 vertices, 14 edges and 8 faces of three lines.
        OutputFormat::Tess => grains as u128 * (7 * TEXT_POINT + 14 * TEXT_CORNERS + 8 * 150),
        OutputFormat::Vti => VTK_HEAD + u128::from(config.bytes_of_voxel()) * voxels,
        OutputFormat::Npy => VTK_HEAD + 4 * voxels,
        // A node and an element each, and its number in a set.
        OutputFormat::Inp => VTK_HEAD + (TEXT_POINT + 3 * TEXT_CORNERS) * voxels,
        OutputFormat::Ang | OutputFormat::Ctf => VTK_HEAD + TEXT_POINT * voxels,
        // Three or four numbers of 20 characters, and some words.
        OutputFormat::Txt | OutputFormat::Ori => VTK_HEAD + 80 * grains as u128,
        OutputFormat::Yaml => VTK_HEAD + 160 * grains as u128,
    };
    match (format, config.file.encoding) {
        (OutputFormat::Vtk(VtkFormat::Vtk), _) | (_, VtkEncoding::Raw) => bytes,
        // Labels repeat, coordinates hardly do: 200 random grains took 0.55 of their raw bytes at level 3, and 200^3 voxels of 20 to 200
        // grains 0.03 to 0.05 of theirs.
        (OutputFormat::Vti, VtkEncoding::Zlib) => VTK_HEAD + bytes / 25,
        (OutputFormat::Vtk(_) | OutputFormat::Vtm, VtkEncoding::Zlib) => bytes * 11 / 20,
        (OutputFormat::Vtk(_) | OutputFormat::Vtm | OutputFormat::Vti, VtkEncoding::Base64) => bytes * 4 / 3,
        _ => bytes,
    }
}
