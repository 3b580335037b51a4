//! The table of all formats.

use std::fmt;
use std::path::{Path, PathBuf};

use voronoi::Dimension;

use super::format::{Beside, Content, FileSize, Format, GrainWriter, Writer};
use crate::config::Config;
use crate::config::volume_mesh::VolumeMeshOptions;
use crate::error::Error;
use crate::memory::{available_memory, check_voxels};

/// A file format that results are written in.
#[derive(Clone, Copy)]
pub struct OutputFormat(&'static Format);

impl OutputFormat {
    /// The default: surfaces and lines as VTK's XML PolyData.
    pub const VTP: Self = Self(&super::vtk::VTP);

    /// Input of Abaqus and CalculiX.
    pub const INP: Self = Self(&super::inp::FORMAT);

    /// Every format, the default first. A format is a file, its `mod`, and a line here.
    pub const ALL: &[Self] = &[
        Self::VTP,
        Self(&super::vtk::VTU),
        Self(&super::vtk::VTK),
        Self(&super::blocks::FORMAT),
        Self(&super::stl::FORMAT),
        Self(&super::ply::FORMAT),
        Self(&super::obj::FORMAT),
        Self(&super::gmsh::FORMAT),
        Self(&super::evolver::FORMAT),
        Self(&super::tess::FORMAT),
        Self(&super::vti::FORMAT),
        Self(&super::npy::FORMAT),
        Self(&super::dream3d::FORMAT),
        Self::INP,
        Self(&super::bdf::FORMAT),
        Self(&super::xdmf::FORMAT),
        Self(&super::ang::FORMAT),
        Self(&super::ctf::FORMAT),
        Self(&super::grain_table::FORMAT),
        Self(&super::euler::FORMAT),
        Self(&super::ori::FORMAT),
        Self(&super::material::FORMAT),
    ];

    /// The extension that stands for the format, without its dot.
    pub fn extension(self) -> &'static str {
        self.0.extension
    }

    /// The format of an extension, in upper or lower case, without its dot.
    pub fn of_extension(extension: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|format| extension.eq_ignore_ascii_case(format.extension()))
    }

    /// The format that the path's extension names, in upper or lower case.
    ///
    /// ```
    /// use std::path::Path;
    ///
    /// use grainsmooth::OutputFormat;
    ///
    /// let format = OutputFormat::of_path(Path::new("grains.STL")).expect("a format that is known");
    /// assert_eq!(format.extension(), "stl");
    /// assert!(OutputFormat::of_path(Path::new("grains.docx")).is_none());
    /// ```
    pub fn of_path(path: &Path) -> Option<Self> {
        Self::of_extension(path.extension()?.to_str()?)
    }

    /// The extensions as a message lists them: `*.vtp, *.vtu or *.vtk`.
    pub fn known_extensions() -> String {
        let known: Vec<String> = Self::ALL.iter().map(|format| format!("*.{}", format.extension())).collect();
        let (last, others) = known.split_last().expect("there are formats");
        format!("{} or {last}", others.join(", "))
    }

    /// The extensions with the programs that they are for, as `--help` lists them: `.vtp, .msh (Gmsh)`.
    pub fn described() -> String {
        let described = Self::ALL.iter().map(|Self(format)| match format.extra.programs {
            "" => format!(".{}", format.extension),
            programs => format!(".{} ({programs})", format.extension),
        });
        described.collect::<Vec<_>>().join(", ")
    }

    /// The formats that a grain's own surface may have.
    pub fn of_grains() -> impl Iterator<Item = Self> {
        Self::ALL.iter().copied().filter(|format| format.0.extra.write_grain.is_some())
    }

    /// Whether the format holds voxels.
    pub fn has_voxels(self) -> bool {
        matches!(self.0.content, Content::Voxels(_))
    }

    /// Whether a file of the format holds elements that fill grains: always, or where they are asked for, or where no voxels are.
    pub fn needs_elements(self, to_write: &ToWrite) -> bool {
        match self.0.content {
            Content::Elements => true,
            Content::ElementsOrVoxels => !to_write.has_voxels(),
            Content::BoundariesOrElements => to_write.volume.volume_mesh,
            Content::BoundariesElementsOrVoxels => to_write.volume.volume_mesh && !to_write.has_voxels(),
            Content::Boundaries
            | Content::Cells
            | Content::Voxels(_)
            | Content::Orientations
            | Content::Grains => false,
        }
    }

    /// Whether a file of the format holds voxels as elements where otherwise it would hold boundaries.
    pub fn needs_voxel_elements(self, to_write: &ToWrite) -> bool {
        let is_asked = to_write.volume.volume_mesh && to_write.has_voxels();
        is_asked && matches!(self.0.content, Content::BoundariesElementsOrVoxels)
    }

    /// Whether elements in the plane have a state across it.
    pub fn has_plane_state(self) -> bool {
        matches!(self.0.content, Content::Elements | Content::ElementsOrVoxels)
    }

    /// Whether the format is a single file, as standard output takes.
    pub fn is_single_file(self) -> bool {
        matches!(self.0.write, Writer::File(_))
    }

    /// What is written beside a file of this format, under its name.
    pub(crate) fn beside(self, path: &Path) -> Option<PathBuf> {
        self.0.extra.beside.map(|beside| match beside {
            Beside::File(extension) => path.with_extension(extension),
            Beside::Folder => path.with_extension(""),
        })
    }

    /// The same where it is a file.
    pub(crate) fn file_beside(self, path: &Path) -> Option<PathBuf> {
        self.beside(path).filter(|_| matches!(self.0.extra.beside, Some(Beside::File(_))))
    }

    /// About how many bytes a file takes.
    pub(crate) fn bytes(self, size: &FileSize<'_>) -> u128 {
        (self.0.bytes)(size)
    }

    /// Bytes that are known to be written for each voxel.
    pub(crate) fn bytes_of_voxel(self, config: &Config) -> u32 {
        match self.0.content {
            Content::Voxels(bytes) => bytes(config),
            _ => 0,
        }
    }

    /// Bytes of memory that voxels take while a file is written, besides a slab of them.
    pub(crate) fn memory_of_voxels(self, to_write: &ToWrite) -> u128 {
        let is_of_voxels = match self.0.content {
            Content::Voxels(_) | Content::ElementsOrVoxels => true,
            _ => self.needs_voxel_elements(to_write),
        };
        if is_of_voxels { to_write.voxels.saturating_mul(self.0.extra.memory_of_voxel) } else { 0 }
    }

    /// Checks that there is memory for the voxels of a file.
    ///
    /// # Errors
    /// [`VoxelsExceedMemory`](crate::memory::MemoryError::VoxelsExceedMemory).
    pub fn check_voxels(self, to_write: &ToWrite) -> Result<(), Error> {
        Ok(check_voxels(self.memory_of_voxels(to_write), available_memory())?)
    }

    pub(super) fn writer(self) -> Writer {
        self.0.write
    }

    pub(super) fn grain_writer(self) -> Option<GrainWriter> {
        self.0.extra.write_grain
    }

    /// Checks that the format can hold what there is to write, for an output that messages call `path`.
    ///
    /// # Errors
    /// [`Error::FormatDimension`]; [`Error::NoElementSize`] for triangles that fill grains in the plane, when elements have no size; [`Error::NoVoxels`] for a format of voxels when their number is not given; [`Error::NoTexture`] for one
    /// of orientations where grains have none; [`Error::CellsOfGrains`] for one of cells where grains are none.
    pub fn check_holds(self, path: &Path, to_write: &ToWrite) -> Result<(), Error> {
        let ToWrite { dimension, has_map, has_orientations, has_cells, .. } = *to_write;
        let path = || path.to_owned();
        let needs_elements = self.needs_elements(to_write);
        match (self.0.extra.dimension, self.0.content) {
            _ if needs_elements && dimension == Dimension::Two && !to_write.has_element_size => {
                Err(Error::NoElementSize { path: path() })
            }
            (Some(only), _) if only != dimension && !needs_elements => {
                Err(Error::FormatDimension { path: path(), dimension: only })
            }
            (_, Content::Voxels(_)) if !to_write.has_voxels() && !has_map => {
                Err(Error::NoVoxels { path: path() })
            }
            (_, Content::Orientations) if !has_orientations => Err(Error::NoTexture { path: path() }),
            (_, Content::Cells) if !has_cells => Err(Error::CellsOfGrains { path: path() }),
            _ => Ok(()),
        }
    }
}

/// What there is to write, which not every format can hold.
#[derive(Debug, Clone, Copy)]
pub struct ToWrite {
    /// The dimension of the grains.
    pub dimension: Dimension,
    /// The number of voxels that is given; 0 where none is.
    pub voxels: u128,
    /// Whether grains come from a map, whose voxels are taken where their number is not given.
    pub has_map: bool,
    /// Whether grains have orientations.
    pub has_orientations: bool,
    /// Whether each grain is a convex cell.
    pub has_cells: bool,
    /// Whether elements have a size.
    pub has_element_size: bool,
    /// What is asked of elements that fill grains.
    pub volume: VolumeMeshOptions,
}

impl ToWrite {
    /// Whether the number of voxels is given.
    pub fn has_voxels(&self) -> bool {
        self.voxels > 0
    }
}

impl Config {
    /// What this makes.
    pub fn to_write(&self) -> ToWrite {
        ToWrite {
            dimension: self.dimension,
            voxels: self.voxel_count(),
            has_map: false,
            has_orientations: self.has_texture(),
            has_cells: !self.has_grains_of_several_cells(),
            has_element_size: self.elements.are_asked(),
            volume: self.file.volume,
        }
    }
}

impl PartialEq for OutputFormat {
    fn eq(&self, other: &Self) -> bool {
        self.extension() == other.extension()
    }
}

impl Eq for OutputFormat {}

impl fmt::Debug for OutputFormat {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.debug_tuple("OutputFormat").field(&self.extension()).finish()
    }
}
