//! Triangles in pieces that share no points, made piece by piece while a .vtp file is written, so that memory holds few of them
//! at a time.

use std::io::{self, Write};

use glam::DVec3;

use super::image::{write_field, write_head};
use super::raw::{Numbers, NumbersOfFile};
use super::{FieldEntry, ItemTuples, VtkEncoding};

/// Pieces that are made at the same time; bounds the memory that they take.
const PIECES_AT_ONCE: usize = 64;

/// Number of points and triangles of a piece.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct PieceSize {
    pub(crate) points: usize,
    pub(crate) triangles: usize,
}

/// The surfaces of one file.
pub(crate) struct PieceData<'a> {
    /// The sizes of all pieces.
    pub(crate) sizes: &'a [PieceSize],
    /// Coordinates of a piece.
    pub(crate) points: &'a (dyn Fn(usize) -> Vec<DVec3> + Sync),
    /// Corners of a piece's triangles, by position among its points.
    pub(crate) triangles: &'a (dyn Fn(usize) -> Vec<[u32; 3]> + Sync),
    /// What each point has.
    pub(crate) point_arrays: Vec<(&'static str, PieceVectors<'a>)>,
    /// What each piece has, and with it each of its triangles.
    pub(crate) cell_arrays: Vec<(&'static str, PieceValue<'a>)>,
    /// What is said about the file as a whole.
    pub(crate) field: Vec<FieldEntry>,
}

/// Values at the points of a piece.
pub(crate) enum PieceVectors<'a> {
    UInt8(&'a (dyn Fn(usize) -> Vec<u8> + Sync)),
    Int32(&'a (dyn Fn(usize) -> Vec<i32> + Sync)),
    Float64(&'a (dyn Fn(usize) -> Vec<f64> + Sync)),
    Vectors(&'a (dyn Fn(usize) -> Vec<DVec3> + Sync)),
}

/// A value of all triangles of a piece.
pub(crate) enum PieceValue<'a> {
    Int32(&'a (dyn Fn(usize) -> i32 + Sync)),
    Int32Pair(&'a (dyn Fn(usize) -> [i32; 2] + Sync)),
    Float64(&'a (dyn Fn(usize) -> f64 + Sync)),
    /// One for each piece.
    Float64s(&'a [f64]),
    /// Two for each piece.
    Float64Pairs(&'a [[f64; 2]]),
    /// The tuple of an item for each piece.
    Item(&'a ItemTuples, &'a (dyn Fn(usize) -> Option<usize> + Sync)),
}

/// Writes the file.
pub(crate) fn write_pieces(
    data: &PieceData<'_>,
    encoding: VtkEncoding,
    out: &mut dyn Write,
) -> io::Result<()> {
    let sum = |count: fn(&PieceSize) -> usize| data.sizes.iter().map(count).sum::<usize>();
    let (points, triangles) = (sum(|size| size.points), sum(|size| size.triangles));
    let first_points: Vec<usize> = data
        .sizes
        .iter()
        .scan(0, |next, size| {
            *next += size.points;
            Some(*next - size.points)
        })
        .collect();
    // VTK's ids are signed.
    let wide = i32::try_from(3 * triangles).is_err();
    let (id_type, id_width) = if wide { ("Int64", 8) } else { ("Int32", 4) };
    let mut numbers = NumbersOfFile::new(encoding);
    let mut document = Vec::new();
    let head = &mut document;
    write_head("PolyData", &numbers, head)?;
    writeln!(head, "<PolyData>\n<FieldData>")?;
    write_field(&data.field, &mut numbers, head)?;
    writeln!(
        head,
        "</FieldData>\n<Piece NumberOfPoints=\"{points}\" NumberOfPolys=\"{triangles}\">\n<PointData>"
    )?;
    let count = data.sizes.len();
    let mut list = Listing { numbers, head };
    for (name, values) in &data.point_arrays {
        match values {
            PieceVectors::UInt8(make) => {
                list.array(name, "UInt8", 1, pieces(points, count, make))?;
            }
            PieceVectors::Int32(make) => {
                list.array(name, "Int32", 1, pieces(4 * points, count, |piece| bytes(&make(piece))))?;
            }
            PieceVectors::Float64(make) => {
                list.array(name, "Float64", 1, pieces(8 * points, count, |piece| bytes(&make(piece))))?;
            }
            PieceVectors::Vectors(make) => {
                list.array(name, "Float64", 3, pieces(24 * points, count, |piece| bytes(&make(piece))))?;
            }
        }
    }
    list.line("</PointData>\n<CellData>")?;
    let sizes = data.sizes;
    for (name, value) in &data.cell_arrays {
        match value {
            PieceValue::Int32(value) => {
                let make = |piece| repeated(value(piece), sizes[piece].triangles);
                list.array(name, "Int32", 1, pieces(4 * triangles, count, make))?;
            }
            PieceValue::Int32Pair(value) => {
                let make = |piece| repeated(value(piece), sizes[piece].triangles);
                list.array(name, "Int32", 2, pieces(8 * triangles, count, make))?;
            }
            PieceValue::Float64(value) => {
                let make = |piece| repeated(value(piece), sizes[piece].triangles);
                list.array(name, "Float64", 1, pieces(8 * triangles, count, make))?;
            }
            PieceValue::Float64s(values) => {
                let make = |piece: usize| repeated(values[piece], sizes[piece].triangles);
                list.array(name, "Float64", 1, pieces(8 * triangles, count, make))?;
            }
            PieceValue::Item(tuples, item) => {
                let make = |piece: usize| tuples.of(item(piece)).repeat(sizes[piece].triangles);
                let numbers = pieces(tuples.width() * triangles, count, make);
                list.array(name, tuples.kind_name(), tuples.components, numbers)?;
            }
            PieceValue::Float64Pairs(values) => {
                let make = |piece: usize| repeated(values[piece], sizes[piece].triangles);
                list.array(name, "Float64", 2, pieces(16 * triangles, count, make))?;
            }
        }
    }
    list.line("</CellData>\n<Points>")?;
    list.array("Points", "Float64", 3, pieces(24 * points, count, |piece| bytes(&(data.points)(piece))))?;
    list.line("</Points>\n<Polys>")?;
    let corners = |piece: usize| {
        let corners = (data.triangles)(piece).into_iter().flatten();
        ids(corners.map(|corner| first_points[piece] + corner as usize), wide)
    };
    list.array("connectivity", id_type, 1, pieces(3 * id_width * triangles, count, corners))?;
    let end = |triangle: usize| 3 * (triangle as u64 + 1);
    let ends = match wide {
        true => Numbers::each(triangles, end),
        #[expect(clippy::cast_possible_truncation, reason = "ids are wide where 32 bits do not hold them")]
        false => Numbers::each(triangles, move |triangle| end(triangle) as u32),
    };
    list.array("offsets", id_type, 1, ends)?;
    list.line("</Polys>\n</Piece>\n</PolyData>")?;
    let Listing { numbers, .. } = list;
    numbers.write_file(&document, out)
}

/// The elements of the file and the arrays that they refer to.
struct Listing<'a, 'b> {
    numbers: NumbersOfFile<'a>,
    head: &'b mut Vec<u8>,
}

impl<'a> Listing<'a, '_> {
    fn line(&mut self, text: &str) -> io::Result<()> {
        writeln!(self.head, "{text}")
    }

    fn array(&mut self, name: &str, kind: &str, components: usize, numbers: Numbers<'a>) -> io::Result<()> {
        let offset = self.numbers.append(numbers);
        self.line(&format!(
            "<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{components}\" format=\"appended\" offset=\"{offset}\"/>"
        ))
    }
}

fn pieces<'a>(byte_count: usize, count: usize, make: impl Fn(usize) -> Vec<u8> + Sync + 'a) -> Numbers<'a> {
    Numbers::Pieces { byte_count: byte_count as u64, count, at_once: PIECES_AT_ONCE, make: Box::new(make) }
}

fn bytes<T: bytemuck::NoUninit>(values: &[T]) -> Vec<u8> {
    bytemuck::cast_slice(values).to_vec()
}

fn repeated<T: bytemuck::NoUninit>(value: T, count: usize) -> Vec<u8> {
    bytemuck::bytes_of(&value).repeat(count)
}

#[expect(clippy::cast_possible_truncation, reason = "ids are wide where 32 bits do not hold them")]
fn ids(ids: impl Iterator<Item = usize>, wide: bool) -> Vec<u8> {
    match wide {
        true => ids.flat_map(|id| (id as u64).to_ne_bytes()).collect(),
        false => ids.flat_map(|id| (id as u32).to_ne_bytes()).collect(),
    }
}
