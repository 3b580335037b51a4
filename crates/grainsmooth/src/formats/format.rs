//! What a file format is, and the table of all of them.

use std::fmt;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use polycrystal::GrainId;
use voronoi::Dimension;

use super::{
    Surface, ang, blocks, ctf, euler, evolver, gmsh, inp, material, npy, obj, ori, ply, stl, tess, vti, vtk,
};
use crate::memory::LevelSize;
use crate::vtk::{ItemTuples, VtkEncoding};
use crate::{Config, Error, Output, Polycrystal, StagedFiles};

/// Bytes of what stands before and after the numbers of a VTK file, or of a table.
pub(super) const HEAD: u128 = 4000;

/// Bytes of a line of text with a point, and with a triangle or an edge, as most numbers are spelled.
pub(super) const TEXT_POINT: u128 = 62;
pub(super) const TEXT_CORNERS: u128 = 24;

/// A file format that results are written in.
#[derive(Clone, Copy)]
pub struct OutputFormat(&'static Format);

/// What there is to know of a format; each stands in the file of its format.
pub(crate) struct Format {
    /// Without its dot.
    pub(super) extension: &'static str,
    /// The programs that it is for, as `--help` names them; nothing where it is for many.
    pub(super) programs: &'static str,
    pub(super) content: Content,
    /// The only dimension that it can hold, if there is such a one.
    pub(super) dimension: Option<Dimension>,
    pub(super) beside: Option<Beside>,
    /// About how many bytes it takes.
    pub(super) bytes: fn(&FileSize<'_>) -> u128,
    pub(super) write: Writer,
    /// Writes a grain's closed surface, where the format is for such files.
    pub(super) write_grain: Option<GrainWriter>,
}

/// What a format holds.
#[derive(Clone, Copy)]
pub(super) enum Content {
    /// The smooth boundaries, or the flat cells.
    Boundaries,
    /// Numbers at voxels, and as many bytes for each as are known beforehand.
    Voxels(fn(&Config) -> u32),
    /// A line for each grain, with its orientation.
    Orientations,
}

/// What is written beside a file, under its name.
#[derive(Clone, Copy)]
pub(super) enum Beside {
    /// A file with this extension.
    File(&'static str),
    Folder,
}

/// How a format is written.
#[derive(Clone, Copy)]
pub(super) enum Writer {
    /// As one file.
    File(fn(&Polycrystal, &mut dyn Write) -> io::Result<()>),
    /// As several files, which appear together.
    Files(fn(&Polycrystal, &Output, &mut StagedFiles) -> Result<(), Error>),
}

pub(super) type GrainWriter = fn(&GrainSurface<'_>, &mut dyn Write) -> io::Result<()>;

/// What the size of a file depends on.
pub(crate) struct FileSize<'a> {
    pub(crate) mesh: LevelSize,
    pub(crate) grains: u128,
    pub(crate) config: &'a Config,
}

/// The closed surface of a grain.
pub(super) struct GrainSurface<'a> {
    pub(super) polycrystal: &'a Polycrystal,
    pub(super) surface: &'a Surface<'a>,
    pub(super) grain: GrainId,
    /// What files hold of each grain.
    pub(super) tuples: &'a [ItemTuples],
}

impl GrainSurface<'_> {
    /// The number of its seed, where seeds have other numbers than grains.
    pub(super) fn renumbered(&self) -> &[u32] {
        let grain = self.grain.index();
        self.polycrystal.cells.renumbered().get(grain..=grain).unwrap_or_default()
    }
}

impl FileSize<'_> {
    /// A network as VTK's numbers: coordinates and three arrays; corners, end and three numbers. In the plane lines share their arrays.
    pub(super) fn of_network(&self) -> u128 {
        let LevelSize { points, edges, triangles } = self.mesh;
        let (of_point, of_triangle) = if self.config.periodic.any() { (31, 32) } else { (27, 28) };
        let is_flat = self.config.dimension == Dimension::Two;
        HEAD + of_point * points + if is_flat { 4 * edges } else { of_triangle * triangles }
    }

    pub(super) fn voxels(&self) -> u128 {
        self.config.voxel_count()
    }

    /// So many bytes in the encoding that is asked for, which makes them this share of it when they are compressed.
    pub(super) fn encoded(&self, bytes: u128, compressed: [u128; 2]) -> u128 {
        let [share, of] = compressed;
        match self.config.file.encoding {
            VtkEncoding::Raw => bytes,
            VtkEncoding::Zlib => bytes * share / of,
            VtkEncoding::Base64 => bytes * 4 / 3,
        }
    }
}

impl OutputFormat {
    /// The default: surfaces and lines as VTK's XML PolyData.
    pub const VTP: Self = Self(&vtk::VTP);

    /// Every format, the default first. A format is a file, and a line here.
    pub const ALL: [Self; 18] = [
        Self::VTP,
        Self(&vtk::VTU),
        Self(&vtk::VTK),
        Self(&blocks::FORMAT),
        Self(&stl::FORMAT),
        Self(&ply::FORMAT),
        Self(&obj::FORMAT),
        Self(&gmsh::FORMAT),
        Self(&evolver::FORMAT),
        Self(&tess::FORMAT),
        Self(&vti::FORMAT),
        Self(&npy::FORMAT),
        Self(&inp::FORMAT),
        Self(&ang::FORMAT),
        Self(&ctf::FORMAT),
        Self(&euler::FORMAT),
        Self(&ori::FORMAT),
        Self(&material::FORMAT),
    ];

    /// The extension that stands for the format, without its dot.
    pub fn extension(self) -> &'static str {
        self.0.extension
    }

    /// The format of an extension, in upper or lower case, without its dot.
    pub fn of_extension(extension: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|format| extension.eq_ignore_ascii_case(format.extension()))
    }

    /// The format that the path's extension names, in upper or lower case.
    pub fn of_path(path: &Path) -> Option<Self> {
        Self::of_extension(path.extension()?.to_str()?)
    }

    /// The extensions as a message lists them: `*.vtp, *.vtu or *.vtk`.
    pub fn known_extensions() -> String {
        let [others @ .., last] = Self::ALL.map(|format| format!("*.{}", format.extension()));
        format!("{} or {last}", others.join(", "))
    }

    /// The extensions with the programs that they are for, as `--help` lists them: `.vtp, .msh (Gmsh)`.
    pub fn described() -> String {
        let described = Self::ALL.map(|Self(format)| match format.programs {
            "" => format!(".{}", format.extension),
            programs => format!(".{} ({programs})", format.extension),
        });
        described.join(", ")
    }

    /// The formats that a grain's own surface may have.
    pub fn of_grains() -> impl Iterator<Item = Self> {
        Self::ALL.into_iter().filter(|format| format.0.write_grain.is_some())
    }

    /// Whether the format holds voxels.
    pub fn has_voxels(self) -> bool {
        matches!(self.0.content, Content::Voxels(_))
    }

    /// Whether the format is a single file, as standard output takes.
    pub fn is_single_file(self) -> bool {
        matches!(self.0.write, Writer::File(_))
    }

    /// What is written beside a file of this format, under its name.
    pub(crate) fn beside(self, path: &Path) -> Option<PathBuf> {
        self.0.beside.map(|beside| match beside {
            Beside::File(extension) => path.with_extension(extension),
            Beside::Folder => path.with_extension(""),
        })
    }

    /// The same where it is a file.
    pub(crate) fn file_beside(self, path: &Path) -> Option<PathBuf> {
        self.beside(path).filter(|_| matches!(self.0.beside, Some(Beside::File(_))))
    }

    /// About how many bytes a file takes.
    pub(crate) fn bytes(self, size: &FileSize<'_>) -> u128 {
        (self.0.bytes)(size)
    }

    /// Bytes that are known to be written for each voxel.
    pub(crate) fn bytes_of_voxel(self, config: &Config) -> u32 {
        match self.0.content {
            Content::Voxels(bytes) => bytes(config),
            Content::Boundaries | Content::Orientations => 0,
        }
    }

    pub(super) fn writer(self) -> Writer {
        self.0.write
    }

    pub(super) fn grain_writer(self) -> Option<GrainWriter> {
        self.0.write_grain
    }

    /// Checks that the format can hold what a config makes, for an output that messages call `path`.
    ///
    /// # Errors
    /// [`Error::FormatDimension`]; [`Error::NoVoxels`] for a format of voxels when their number is not given; [`Error::NoTexture`] for one
    /// of orientations where grains have none.
    pub fn check_fits(self, path: &Path, config: &Config) -> Result<(), Error> {
        let path = || path.to_owned();
        match (self.0.dimension, self.0.content) {
            (Some(dimension), _) if dimension != config.dimension => {
                Err(Error::FormatDimension { path: path(), dimension })
            }
            (_, Content::Voxels(_)) if config.file.voxels.is_none() => Err(Error::NoVoxels { path: path() }),
            (_, Content::Orientations) if !config.has_texture() => Err(Error::NoTexture { path: path() }),
            _ if config.has_grains_of_several_cells() && self.extension() == "tess" => {
                Err(Error::CellsOfGrains { path: path() })
            }
            _ => Ok(()),
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

impl Polycrystal {
    /// Completes an output, as one of several that appear together.
    ///
    /// # Errors
    /// [`Error::WriteOutput`]; [`Error::OutputTwice`]; as of [`Output::check_fits`].
    pub fn stage(&self, output: &Output, files: &mut StagedFiles) -> Result<(), Error> {
        output.check_fits(&self.config)?;
        match output.format().writer() {
            Writer::File(write) => output.stage(files, |out| write(self, out)),
            Writer::Files(stage) => stage(self, output, files),
        }
    }

    /// Writes a format that is a single file.
    ///
    /// # Errors
    /// Whatever `out` reports; that the format is several files, or cannot hold this polycrystal.
    pub fn write_to(&self, format: OutputFormat, out: &mut dyn Write) -> io::Result<()> {
        match format.writer() {
            Writer::File(write) => write(self, out),
            Writer::Files(_) => Err(io::Error::other("several files are not written as one")),
        }
    }
}
