//! What a file format is.

use std::io::{self, Write};

use polycrystal::GrainId;
use voronoi::Dimension;

use super::surface::Surface;
use crate::files::output::OutputPath;
use crate::memory::LevelSize;
use crate::vtk::{ItemTuples, VtkEncoding};
use crate::{Config, Error, Polycrystal, StagedFiles};

/// Bytes of what stands before and after the numbers of a VTK file, or of a table.
pub(super) const HEAD: u128 = 4000;

/// Bytes of a line of text with a point, and with a triangle or an edge, as most numbers are spelled.
pub(super) const TEXT_POINT: u128 = 62;
pub(super) const TEXT_CORNERS: u128 = 24;

/// What there is to know of a format; each stands in the file of its format.
pub(crate) struct Format {
    /// Without its dot.
    pub(super) extension: &'static str,
    pub(super) content: Content,
    /// About how many bytes it takes.
    pub(super) bytes: fn(&FileSize<'_>) -> u128,
    pub(super) write: Writer,
    pub(super) extra: Extra,
}

/// What only some formats have.
pub(super) struct Extra {
    /// The programs that it is for, as `--help` names them; nothing where it is for many.
    pub(super) programs: &'static str,
    /// The only dimension that it can hold, if there is such a one.
    pub(super) dimension: Option<Dimension>,
    pub(super) beside: Option<Beside>,
    /// Writes a grain's closed surface, where the format is for such files.
    pub(super) write_grain: Option<GrainWriter>,
    /// Bytes of memory for each voxel, where a file of voxels needs all at once; 0 where they are written slab by slab.
    pub(super) memory_of_voxel: u128,
}

impl Extra {
    pub(super) const NONE: Self =
        Self { programs: "", dimension: None, beside: None, write_grain: None, memory_of_voxel: 0 };
}

/// What a format holds.
#[derive(Clone, Copy)]
pub(super) enum Content {
    /// The smooth boundaries.
    Boundaries,
    /// The same, or elements that fill grains where these are asked for.
    BoundariesOrElements,
    /// Tetrahedra that fill grains, in the plane triangles.
    Elements,
    /// The flat cells, each of them a grain.
    Cells,
    /// Numbers at voxels, and as many bytes for each as are known beforehand.
    Voxels(fn(&Config) -> u32),
    /// Hexahedra at voxels, in the plane squares, where voxels are asked for; else the same.
    ElementsOrVoxels,
    /// As `BoundariesOrElements`, but hexahedra at voxels where both voxels and elements are asked for.
    BoundariesElementsOrVoxels,
    /// A line for each grain, with its orientation.
    Orientations,
    /// A line for each grain.
    Grains,
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
    Files(fn(&Polycrystal, &OutputPath<()>, &mut StagedFiles) -> Result<(), Error>),
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
        self.polycrystal.grains().renumbered().get(grain..=grain).unwrap_or_default()
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
