//! Triangles in pieces that share no points, made piece by piece while a .vtp file is written, so that memory holds few of them
//! at a time.

use std::io::{self, Write};
use std::sync::Arc;

use glam::DVec3;
use vtkio::xml::ScalarType;

use super::image::{head, write_array, write_field};
use super::raw::{MakePiece, Numbers, NumbersOfFile};
use super::{Array, DataArray, FieldEntry, ItemTuples, Tuple, Values, VtkEncoding};

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
    /// What the points of each piece have.
    pub(crate) point_arrays: Vec<PieceValues<'a>>,
    /// What each piece has, a tuple that each of its triangles gets.
    pub(crate) cell_arrays: Vec<PieceValues<'a>>,
    /// What is said about the file as a whole.
    pub(crate) field: Vec<FieldEntry>,
}

/// An array, made piece by piece.
pub(crate) struct PieceValues<'a> {
    name: &'a str,
    kind: ScalarType,
    components: usize,
    make: MakePiece<'a>,
}

impl<'a> PieceValues<'a> {
    /// The tuples at all points of a piece.
    pub(crate) fn at_points<T: Tuple>(
        name: &'a str,
        tuples: impl Fn(usize) -> Vec<T> + Send + Sync + 'a,
    ) -> Self {
        let make = Arc::new(move |piece| bytes(&tuples(piece)));
        Self { name, kind: T::KIND, components: size_of::<T>() / T::KIND.size(), make }
    }

    /// The tuple of a piece.
    pub(crate) fn each<T: Tuple>(name: &'a str, tuple: impl Fn(usize) -> T + Send + Sync + 'a) -> Self {
        Self::at_points(name, move |piece| vec![tuple(piece)])
    }

    /// The tuple of the item that a piece belongs to.
    pub(crate) fn of_items(
        tuples: &'a ItemTuples,
        item: impl Fn(usize) -> Option<usize> + Send + Sync + 'a,
    ) -> Self {
        let make = Arc::new(move |piece| tuples.of(item(piece)).to_vec());
        Self { name: tuples.name, kind: tuples.kind, components: tuples.components, make }
    }

    /// Tuples that were found before, one for each piece.
    pub(crate) fn of_data(array: &'a DataArray) -> Self {
        let make = Arc::new(|piece| bytes(array.tuple(piece)));
        Self { name: &array.name, kind: array.kind(), components: array.components, make }
    }

    /// The tuple of each piece once for each of its triangles.
    fn repeated(&self, sizes: &'a [PieceSize]) -> Self {
        let each = Arc::clone(&self.make);
        Self { make: Arc::new(move |piece| each(piece).repeat(sizes[piece].triangles)), ..*self }
    }

    /// The array of so many tuples in so many pieces.
    fn array(&self, tuples: usize, count: usize) -> Array<'a> {
        let Self { name, kind, components, .. } = *self;
        let byte_count = (kind.size() * components * tuples) as u64;
        let make = Arc::clone(&self.make);
        let numbers = Numbers::Pieces { byte_count, count, at_once: PIECES_AT_ONCE, make };
        Array { name, values: Values::new(kind, components, tuples, numbers) }
    }
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
    let id_type = if wide { ScalarType::Int64 } else { ScalarType::Int32 };
    let mut numbers = NumbersOfFile::new(encoding);
    let mut document = Vec::new();
    writeln!(document, "{}\n<PolyData>\n<FieldData>", head("PolyData", &numbers))?;
    write_field(&data.field, &mut numbers, &mut document)?;
    writeln!(
        document,
        "</FieldData>\n<Piece NumberOfPoints=\"{points}\" NumberOfPolys=\"{triangles}\">\n<PointData>"
    )?;
    let count = data.sizes.len();
    for values in &data.point_arrays {
        write_array(&values.array(points, count), &mut numbers, &mut document)?;
    }
    writeln!(document, "</PointData>\n<CellData>")?;
    for values in &data.cell_arrays {
        write_array(&values.repeated(data.sizes).array(triangles, count), &mut numbers, &mut document)?;
    }
    writeln!(document, "</CellData>\n<Points>")?;
    let positions = PieceValues::at_points("Points", data.points);
    write_array(&positions.array(points, count), &mut numbers, &mut document)?;
    writeln!(document, "</Points>\n<Polys>")?;
    let make = Arc::new(|piece: usize| {
        let corners = (data.triangles)(piece).into_iter().flatten();
        ids(corners.map(|corner| first_points[piece] + corner as usize), wide)
    });
    let corners = PieceValues { name: "connectivity", kind: id_type, components: 1, make };
    write_array(&corners.array(3 * triangles, count), &mut numbers, &mut document)?;
    let ends = Numbers::ids(triangles, |triangle| 3 * (triangle as u64 + 1), wide);
    let ends = Array { name: "offsets", values: Values::new(id_type, 1, triangles, ends) };
    write_array(&ends, &mut numbers, &mut document)?;
    writeln!(document, "</Polys>\n</Piece>\n</PolyData>")?;
    numbers.write_file(&document, out)
}

fn bytes<T: bytemuck::NoUninit>(values: &[T]) -> Vec<u8> {
    bytemuck::cast_slice(values).to_vec()
}

#[expect(clippy::cast_possible_truncation, reason = "ids are wide where 32 bits do not hold them")]
fn ids(ids: impl Iterator<Item = usize>, wide: bool) -> Vec<u8> {
    match wide {
        true => ids.flat_map(|id| (id as u64).to_ne_bytes()).collect(),
        false => ids.flat_map(|id| (id as u32).to_ne_bytes()).collect(),
    }
}
