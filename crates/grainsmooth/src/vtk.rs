//! Surfaces and polylines as VTK files.
//!
//! One data set, [`PolyData`], is written as XML PolyData, XML UnstructuredGrid or legacy PolyData.
//! Coordinates are 64-bit and come back bit for bit. XML files hold their numbers as raw bytes at the end, or as base64.

use std::fmt;
use std::io::{self, Write};

use clap::ValueEnum;
use glam::DVec3;
use serde::Serialize;
use vtkio::xml::ScalarType;

use xml::XmlFormat;

mod coding;
mod data_array;
mod field;
mod image;
mod item_tuples;
mod legacy;
mod pieces;
mod raw;
mod xml;
mod xml_file;

pub use data_array::{DataArray, DataNumbers};
pub(crate) use field::field_entry;
pub use field::{FieldEntry, FieldValue};
pub use image::{ImageData, write_vti};
pub use item_tuples::ItemTuples;
pub(crate) use pieces::{PieceData, PieceSize, PieceValue, PieceVectors, write_pieces};
pub(crate) use xml_file::{Element, XmlFile, document};
pub use xml_file::{field_bytes, field_numbers, field_text, inlined};

/// A format of VTK files.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum VtkFormat {
    /// XML PolyData, .vtp.
    Vtp,
    /// XML UnstructuredGrid, .vtu.
    Vtu,
    /// Legacy PolyData, .vtk.
    Vtk,
}

impl VtkFormat {
    /// Every format.
    pub const ALL: [Self; 3] = [Self::Vtp, Self::Vtu, Self::Vtk];

    /// The extension that stands for the format, without its dot.
    pub fn extension(self) -> &'static str {
        match self {
            Self::Vtp => "vtp",
            Self::Vtu => "vtu",
            Self::Vtk => "vtk",
        }
    }
}

/// How XML files hold their numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum VtkEncoding {
    /// As raw bytes at the end: the fastest. VTK, ParaView, pyvista and meshio read it; `vtkio` does not.
    #[default]
    Raw,
    /// As base64 in their elements, which every reader knows.
    Base64,
    /// The same compressed by zlib.
    Zlib,
}

/// Points, the cells between them, and what is known about both: the content of one VTK file.
#[derive(Debug, Clone)]
pub struct PolyData<'a> {
    /// Coordinates in the user's unit of length; z = 0 in 2D.
    pub points: &'a [DVec3],
    /// Triangles, polygons or polylines, by position in `points`.
    pub cells: Cells<'a>,
    /// Arrays with one tuple for each point.
    pub point_arrays: Vec<Array<'a>>,
    /// Arrays with one tuple for each cell.
    pub cell_arrays: Vec<Array<'a>>,
    /// What is said about the file as a whole, such as the command line that made it.
    pub field: Vec<FieldEntry>,
}

/// The cells of a data set, all of one kind.
#[derive(Debug, Clone, Copy)]
pub enum Cells<'a> {
    /// Three points each.
    Triangles(&'a [[u32; 3]]),
    /// Three points each, known when they are written.
    TrianglesOf(Each<'a, [u32; 3]>),
    /// Three or more points each, in order around the face.
    Polygons(&'a [Vec<u32>]),
    /// Two or more points each, in order along the curve.
    Polylines(&'a [Vec<u32>]),
    /// So many first points, each a cell.
    Vertices(usize),
    /// Four points each; for unstructured grids alone.
    Tetrahedra(&'a [[u32; 4]]),
    /// Ten points each: the corners, then the middles of the edges 0 1, 1 2, 2 0, 0 3, 1 3, 2 3; for unstructured grids alone.
    QuadraticTetrahedra(&'a [[u32; 10]]),
}

impl Cells<'_> {
    /// Number of cells.
    pub fn len(&self) -> usize {
        match self {
            Self::Triangles(triangles) => triangles.len(),
            Self::TrianglesOf(each) => each.count,
            Self::Polygons(cells) | Self::Polylines(cells) => cells.len(),
            Self::Vertices(count) => *count,
            Self::Tetrahedra(tetrahedra) => tetrahedra.len(),
            Self::QuadraticTetrahedra(tetrahedra) => tetrahedra.len(),
        }
    }

    /// Whether the cells are solids, which PolyData cannot hold.
    fn are_solids(&self) -> bool {
        matches!(self, Self::Tetrahedra(_) | Self::QuadraticTetrahedra(_))
    }

    /// Whether there is no cell.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Number of point ids in all cells together.
    fn corner_count(&self) -> usize {
        match self {
            Self::Triangles(_) | Self::TrianglesOf(_) => 3 * self.len(),
            Self::Polygons(cells) | Self::Polylines(cells) => cells.iter().map(Vec::len).sum(),
            Self::Vertices(count) => *count,
            Self::Tetrahedra(tetrahedra) => 4 * tetrahedra.len(),
            Self::QuadraticTetrahedra(tetrahedra) => 10 * tetrahedra.len(),
        }
    }
}

/// A named array over the points or the cells.
#[derive(Debug, Clone, Copy)]
pub struct Array<'a> {
    /// Name under which VTK lists the array; without blanks, which the legacy format cannot hold.
    pub name: &'a str,
    /// One tuple for each point or cell.
    pub values: Values<'a>,
}

/// The numbers of an [`Array`].
#[derive(Debug, Clone, Copy)]
pub enum Values<'a> {
    /// One 8-bit integer each.
    Int8(&'a [i8]),
    /// One unsigned 8-bit integer each.
    UInt8(&'a [u8]),
    /// One 32-bit integer each.
    Int32(&'a [i32]),
    /// Two 32-bit integers each.
    Int32Pairs(&'a [[i32; 2]]),
    /// One 64-bit floating point number each.
    Float64(&'a [f64]),
    /// Two 64-bit floating point numbers each.
    Float64Pairs(&'a [[f64; 2]]),
    /// Three 64-bit floating point numbers each.
    Vectors(&'a [DVec3]),
    /// One 8-bit integer each, computed when it is written.
    Int8Of(Each<'a, i8>),
    /// One unsigned 8-bit integer each, computed when it is written.
    UInt8Of(Each<'a, u8>),
    /// One 32-bit integer each, computed when it is written.
    Int32Of(Each<'a, i32>),
    /// Two 32-bit integers each, computed when they are written.
    Int32PairsOf(Each<'a, [i32; 2]>),
    /// Several 32-bit integers each.
    Int32Tuples(Tuples<'a>),
    /// One 32-bit integer each, made block by block when they are written.
    Int32Blocks(Blocks<'a>),
    /// One 64-bit floating point number each, computed when it is written.
    Float64Of(Each<'a, f64>),
    /// Those of an array that was read or made before.
    Data(&'a DataArray),
    /// The tuple of an item for each.
    Items(Items<'a>),
    /// The same, with the items made block by block when they are written.
    ItemBlocks(ItemBlocks<'a>),
}

/// Tuples of items, of which each cell belongs to one or to none.
#[derive(Clone, Copy)]
pub struct Items<'a> {
    /// What each item has.
    pub tuples: &'a ItemTuples,
    /// Number of cells.
    pub count: usize,
    /// The item of a cell.
    pub item: &'a (dyn Fn(usize) -> Option<usize> + Sync),
}

impl fmt::Debug for Items<'_> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{} tuples", self.count)
    }
}

/// Tuples of items that are found in blocks, one block after the other.
#[derive(Clone, Copy)]
pub struct ItemBlocks<'a> {
    /// What each item has.
    pub tuples: &'a ItemTuples,
    /// Number of cells.
    pub count: usize,
    /// Number of blocks.
    pub blocks: usize,
    /// The items of the cells of a block.
    pub make: &'a (dyn Fn(usize) -> Vec<Option<usize>> + Sync),
}

impl fmt::Debug for ItemBlocks<'_> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{} tuples in {} blocks", self.count, self.blocks)
    }
}

/// Tuples of any number of components.
#[derive(Debug, Clone, Copy)]
pub struct Tuples<'a> {
    /// Number of components, at least 1.
    pub components: usize,
    /// All components, one tuple after the other.
    pub values: &'a [i32],
}

/// Numbers that are made in blocks, one block after the other.
#[derive(Clone, Copy)]
pub struct Blocks<'a> {
    /// Number of numbers.
    pub count: usize,
    /// Number of blocks.
    pub blocks: usize,
    /// The numbers of a block.
    pub make: &'a (dyn Fn(usize) -> Vec<i32> + Sync),
}

impl fmt::Debug for Blocks<'_> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{} values in {} blocks", self.count, self.blocks)
    }
}

/// Tuples that need no memory, as each follows from its position.
#[derive(Clone, Copy)]
pub struct Each<'a, T> {
    /// Number of tuples.
    pub count: usize,
    /// The tuple at a position.
    pub value: &'a (dyn Fn(usize) -> T + Sync),
}

impl<T> fmt::Debug for Each<'_, T> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{} values", self.count)
    }
}

impl<'a> Values<'a> {
    /// Number of tuples.
    pub fn len(&self) -> usize {
        match self {
            Self::Int8(values) => values.len(),
            Self::UInt8(values) => values.len(),
            Self::Int32(values) => values.len(),
            Self::Int32Pairs(pairs) => pairs.len(),
            Self::Float64(values) => values.len(),
            Self::Float64Pairs(pairs) => pairs.len(),
            Self::Vectors(vectors) => vectors.len(),
            Self::Int8Of(each) => each.count,
            Self::UInt8Of(each) => each.count,
            Self::Int32Of(each) => each.count,
            Self::Int32PairsOf(each) => each.count,
            Self::Float64Of(each) => each.count,
            Self::Int32Tuples(tuples) => tuples.values.len() / tuples.components,
            Self::Int32Blocks(blocks) => blocks.count,
            Self::Data(array) => array.len(),
            Self::Items(items) => items.count,
            Self::ItemBlocks(blocks) => blocks.count,
        }
    }

    /// Whether there is no tuple.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    fn component_count(&self) -> usize {
        match self {
            Self::Int8(_) | Self::Int8Of(_) | Self::UInt8(_) | Self::UInt8Of(_) => 1,
            Self::Int32(_) | Self::Int32Of(_) | Self::Int32Blocks(_) => 1,
            Self::Float64(_) | Self::Float64Of(_) => 1,
            Self::Int32Pairs(_) | Self::Int32PairsOf(_) | Self::Float64Pairs(_) => 2,
            Self::Vectors(_) => 3,
            Self::Int32Tuples(tuples) => tuples.components,
            Self::Data(array) => array.components,
            Self::Items(items) => items.tuples.components,
            Self::ItemBlocks(blocks) => blocks.tuples.components,
        }
    }

    fn scalar_type(&self) -> ScalarType {
        match self {
            Self::Int8(_) | Self::Int8Of(_) => ScalarType::Int8,
            Self::UInt8(_) | Self::UInt8Of(_) => ScalarType::UInt8,
            Self::Int32(_) | Self::Int32Of(_) | Self::Int32Blocks(_) => ScalarType::Int32,
            Self::Int32Pairs(_) | Self::Int32PairsOf(_) | Self::Int32Tuples(_) => ScalarType::Int32,
            Self::Float64(_) | Self::Float64Of(_) => ScalarType::Float64,
            Self::Float64Pairs(_) | Self::Vectors(_) => ScalarType::Float64,
            Self::Data(array) => array.kind(),
            Self::Items(items) => items.tuples.kind,
            Self::ItemBlocks(blocks) => blocks.tuples.kind,
        }
    }
}

/// The array of unit vectors that viewers shade with.
const NORMALS: &str = "Normals";

/// Whether viewers shade with an array.
fn is_normals(array: &Array<'_>) -> bool {
    array.name == NORMALS
        && array.values.component_count() == 3
        && array.values.scalar_type() == ScalarType::Float64
}

/// Writes `data` in `format`; XML files hold their numbers in `encoding`.
///
/// ```
/// use grainsmooth::glam::DVec3;
/// use grainsmooth::vtk::{Array, Cells, PolyData, Values, VtkEncoding, VtkFormat, write_vtk};
///
/// let data = PolyData {
///     points: &[DVec3::ZERO, DVec3::X, DVec3::Y],
///     cells: Cells::Triangles(&[[0, 1, 2]]),
///     point_arrays: vec![],
///     cell_arrays: vec![Array { name: "Area", values: Values::Float64(&[0.5]) }],
///     field: vec![],
/// };
/// let mut file = Vec::new();
/// write_vtk(&data, VtkFormat::Vtk, VtkEncoding::default(), &mut file)?;
/// assert!(file.starts_with(b"# vtk DataFile Version"));
/// # Ok::<(), std::io::Error>(())
/// ```
///
/// # Errors
/// Whatever `out` reports; and [`io::ErrorKind::InvalidInput`] when the legacy format, whose ids are signed
/// 32-bit numbers, cannot hold so many points or cells.
///
/// # Panics
/// When an array has another length than the points or cells that it describes.
pub fn write_vtk(
    data: &PolyData<'_>,
    format: VtkFormat,
    encoding: VtkEncoding,
    out: &mut dyn Write,
) -> io::Result<()> {
    for array in &data.point_arrays {
        assert_eq!(array.values.len(), data.points.len(), "point array {}", array.name);
    }
    for array in &data.cell_arrays {
        assert_eq!(array.values.len(), data.cells.len(), "cell array {}", array.name);
    }
    match format {
        VtkFormat::Vtp => xml::write(data, XmlFormat::PolyData, encoding, out),
        VtkFormat::Vtu => xml::write(data, XmlFormat::UnstructuredGrid, encoding, out),
        VtkFormat::Vtk => legacy::write(data, out),
    }
}
