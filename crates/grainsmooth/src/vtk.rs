//! Surfaces and polylines as VTK files.
//!
//! One data set, [`PolyData`], is written as XML PolyData, XML UnstructuredGrid or legacy PolyData.
//! Coordinates are 64-bit and come back bit for bit. XML files hold their numbers as raw bytes at the end, or as base64.

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
mod values;
mod xml;
mod xml_file;

pub use data_array::{DataArray, DataNumbers};
pub(crate) use field::field_entry;
pub use field::{FieldEntry, FieldValue};
pub use image::{ImageData, write_vti};
pub use item_tuples::ItemTuples;
pub(crate) use pieces::{PieceData, PieceSize, PieceValues, write_pieces};
pub use values::{Tuple, Values};
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
#[derive(Clone)]
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
#[derive(Clone, Copy)]
pub enum Cells<'a> {
    /// Three points each.
    Triangles(&'a [[u32; 3]]),
    /// Three points each, known when they are written.
    TrianglesOf {
        /// Number of triangles.
        count: usize,
        /// The triangle at a position.
        triangle: &'a (dyn Fn(usize) -> [u32; 3] + Sync),
    },
    /// Three or more points each, in order around the face.
    Polygons(&'a [Vec<u32>]),
    /// Two or more points each, in order along the curve.
    Polylines(&'a [Vec<u32>]),
    /// So many first points, each a cell.
    Vertices(usize),
    /// Finite elements of one shape, the points of each after those of the one before; for unstructured grids alone.
    Elements(ElementType, &'a [u32]),
}

/// A type of finite elements, with VTK's code for it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ElementType {
    /// Three corners.
    Triangle = 5,
    /// Four corners around a square.
    Quad = 9,
    /// Four corners.
    Tetrahedron = 10,
    /// Four corners around a square, and those above them.
    Hexahedron = 12,
    /// Three corners, and the middles of the edges 0 1, 1 2, 2 0.
    QuadraticTriangle = 22,
    /// Four corners, and the middles of the edges 0 1, 1 2, 2 0, 0 3, 1 3, 2 3.
    QuadraticTetrahedron = 24,
}

impl ElementType {
    /// Number of points.
    pub fn point_count(self) -> usize {
        match self {
            Self::Triangle => 3,
            Self::Quad | Self::Tetrahedron => 4,
            Self::QuadraticTriangle => 6,
            Self::Hexahedron => 8,
            Self::QuadraticTetrahedron => 10,
        }
    }
}

impl Cells<'_> {
    /// Number of cells.
    pub fn len(&self) -> usize {
        match self {
            Self::Triangles(triangles) => triangles.len(),
            Self::TrianglesOf { count, .. } => *count,
            Self::Polygons(cells) | Self::Polylines(cells) => cells.len(),
            Self::Vertices(count) => *count,
            Self::Elements(kind, points) => points.len() / kind.point_count(),
        }
    }

    /// Whether the cells are finite elements, which PolyData cannot hold.
    fn are_elements(&self) -> bool {
        matches!(self, Self::Elements(..))
    }

    /// Whether there is no cell.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Number of point ids in all cells together.
    fn corner_count(&self) -> usize {
        match self {
            Self::Triangles(_) | Self::TrianglesOf { .. } => 3 * self.len(),
            Self::Polygons(cells) | Self::Polylines(cells) => cells.iter().map(Vec::len).sum(),
            Self::Vertices(count) => *count,
            Self::Elements(_, points) => points.len(),
        }
    }
}

/// A named array over the points or the cells.
#[derive(Clone)]
pub struct Array<'a> {
    /// Name under which VTK lists the array; without blanks, which the legacy format cannot hold.
    pub name: &'a str,
    /// One tuple for each point or cell.
    pub values: Values<'a>,
}

/// The array of unit vectors that viewers shade with.
const NORMALS: &str = "Normals";

/// Whether viewers shade with an array.
fn is_normals(array: &Array<'_>) -> bool {
    array.name == NORMALS && array.values.components == 3 && array.values.kind == ScalarType::Float64
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
///     cell_arrays: vec![Array { name: "Area", values: Values::slice(&[0.5]) }],
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
