//! The elements of an XML file, named and ordered as VTK wants them.
//!
//! `vtkio` has the same tree, but without field data and with parts that only its own conversion can fill;
//! from it come the names of types and the serializer.

use serde::Serialize;
use vtkio::model::ByteOrder;
use vtkio::xml::{DataArrayFormat, DataSetType, ScalarType};

use super::super::raw::{Numbers, NumbersOfFile};
use super::super::{Array, Cells, Each, FieldEntry, FieldValue, NORMALS, PolyData, is_normals};
use super::XmlFormat;

/// The one file version that VTK, ParaView, pyvista and meshio all read.
const VERSION: &str = "1.0";

/// VTK's codes for the kinds of cell.
const VERTEX: u8 = 1;
const POLY_LINE: u8 = 4;
const TRIANGLE: u8 = 5;
const POLYGON: u8 = 7;
const TETRAHEDRON: u8 = 10;
const QUADRATIC_TETRAHEDRON: u8 = 24;

#[derive(Serialize)]
#[serde(rename = "VTKFile")]
pub(super) struct Document {
    #[serde(rename = "@type")]
    data_set_type: DataSetType,
    #[serde(rename = "@version")]
    version: &'static str,
    #[serde(rename = "@byte_order")]
    byte_order: ByteOrder,
    #[serde(rename = "@header_type")]
    header_type: ScalarType,
    #[serde(rename = "@compressor", skip_serializing_if = "Option::is_none")]
    compressor: Option<&'static str>,
    #[serde(rename = "$value")]
    data_set: DataSet,
}

#[derive(Serialize)]
enum DataSet {
    PolyData(Grid),
    UnstructuredGrid(Grid),
}

#[derive(Serialize)]
#[serde(rename_all = "PascalCase")]
struct Grid {
    field_data: Arrays,
    piece: Piece,
}

#[derive(Serialize)]
#[serde(rename_all = "PascalCase")]
struct Piece {
    #[serde(rename = "@NumberOfPoints")]
    number_of_points: usize,
    #[serde(rename = "@NumberOfVerts", skip_serializing_if = "Option::is_none")]
    number_of_verts: Option<usize>,
    #[serde(rename = "@NumberOfLines", skip_serializing_if = "Option::is_none")]
    number_of_lines: Option<usize>,
    #[serde(rename = "@NumberOfPolys", skip_serializing_if = "Option::is_none")]
    number_of_polys: Option<usize>,
    #[serde(rename = "@NumberOfCells", skip_serializing_if = "Option::is_none")]
    number_of_cells: Option<usize>,
    point_data: Arrays,
    cell_data: Arrays,
    points: Arrays,
    #[serde(rename = "$value")]
    topology: Topology,
}

#[derive(Serialize)]
enum Topology {
    Verts(Arrays),
    Lines(Arrays),
    Polys(Arrays),
    Cells(Arrays),
}

#[derive(Serialize)]
struct Arrays {
    /// The array that viewers shade with.
    #[serde(rename = "@Normals", skip_serializing_if = "Option::is_none")]
    normals: Option<&'static str>,
    #[serde(rename = "$value")]
    arrays: Vec<Element>,
}

#[derive(Serialize)]
enum Element {
    DataArray(Header<ScalarType>),
    /// VTK's element for arrays of anything but numbers.
    Array(Header<NotNumeric>),
}

#[derive(Serialize)]
enum NotNumeric {
    String,
}

/// What an array is; its numbers are appended.
#[derive(Serialize)]
struct Header<Type> {
    #[serde(rename = "@type")]
    value_type: Type,
    #[serde(rename = "@Name")]
    name: String,
    #[serde(rename = "@NumberOfComponents")]
    number_of_components: usize,
    /// Only field data need this: other arrays have as many tuples as there are points or cells.
    #[serde(rename = "@NumberOfTuples", skip_serializing_if = "Option::is_none")]
    number_of_tuples: Option<usize>,
    #[serde(rename = "@format")]
    format: DataArrayFormat,
    #[serde(rename = "@offset")]
    offset: u64,
}

impl Arrays {
    fn new(arrays: Vec<Element>) -> Self {
        Self { normals: None, arrays }
    }
}

impl Document {
    /// Describes `data` and lists its arrays in `numbers`.
    pub(super) fn new<'a>(data: &PolyData<'a>, format: XmlFormat, numbers: &mut NumbersOfFile<'a>) -> Self {
        let grid = Grid {
            field_data: Arrays::new(data.field.iter().map(|entry| field(entry, format, numbers)).collect()),
            piece: Piece::new(data, format, numbers),
        };
        let (data_set_type, data_set) = match format {
            XmlFormat::PolyData => (DataSetType::PolyData, DataSet::PolyData(grid)),
            XmlFormat::UnstructuredGrid => (DataSetType::UnstructuredGrid, DataSet::UnstructuredGrid(grid)),
        };
        Self {
            data_set_type,
            version: VERSION,
            byte_order: ByteOrder::native(),
            header_type: ScalarType::UInt64,
            compressor: numbers.compressor(),
            data_set,
        }
    }
}

impl Piece {
    fn new<'a>(data: &PolyData<'a>, format: XmlFormat, numbers: &mut NumbersOfFile<'a>) -> Self {
        let points = array("Points", ScalarType::Float64, 3, numbers.append(Numbers::slice(data.points)));
        let mut piece = Self {
            number_of_points: data.points.len(),
            number_of_verts: None,
            number_of_lines: None,
            number_of_polys: None,
            number_of_cells: None,
            point_data: attributes(&data.point_arrays, numbers),
            cell_data: attributes(&data.cell_arrays, numbers),
            points: Arrays::new(vec![points]),
            topology: Topology::new(data, format, numbers),
        };
        let number_of = match piece.topology {
            Topology::Verts(_) => &mut piece.number_of_verts,
            Topology::Lines(_) => &mut piece.number_of_lines,
            Topology::Polys(_) => &mut piece.number_of_polys,
            Topology::Cells(_) => &mut piece.number_of_cells,
        };
        *number_of = Some(data.cells.len());
        piece
    }
}

impl Topology {
    fn new<'a>(data: &PolyData<'a>, format: XmlFormat, numbers: &mut NumbersOfFile<'a>) -> Self {
        // VTK's ids are signed, and both arrays must have the same width.
        let largest = data.points.len().max(data.cells.corner_count());
        let wide = i32::try_from(largest).is_err();
        let id_type = if wide { ScalarType::Int64 } else { ScalarType::Int32 };
        let (connectivity, ends) = cell_ids(data.cells, wide);
        let mut arrays = vec![
            array("connectivity", id_type, 1, numbers.append(connectivity)),
            array("offsets", id_type, 1, numbers.append(ends)),
        ];
        match (format, data.cells) {
            (XmlFormat::PolyData, Cells::Polylines(_)) => Self::Lines(Arrays::new(arrays)),
            (XmlFormat::PolyData, Cells::Vertices(_)) => Self::Verts(Arrays::new(arrays)),
            // Tetrahedra do not come here: `write` refuses them.
            (XmlFormat::PolyData, _) => Self::Polys(Arrays::new(arrays)),
            (XmlFormat::UnstructuredGrid, cells) => {
                let kind = match cells {
                    Cells::Triangles(_) | Cells::TrianglesOf(_) => TRIANGLE,
                    Cells::Polygons(_) => POLYGON,
                    Cells::Polylines(_) => POLY_LINE,
                    Cells::Vertices(_) => VERTEX,
                    Cells::Tetrahedra(_) => TETRAHEDRON,
                    Cells::QuadraticTetrahedra(_) => QUADRATIC_TETRAHEDRON,
                };
                arrays.push(array(
                    "types",
                    ScalarType::UInt8,
                    1,
                    numbers.append(Numbers::each(cells.len(), move |_| kind)),
                ));
                Self::Cells(Arrays::new(arrays))
            }
        }
    }
}

/// The point ids of all cells in a row, and where in that row each cell ends.
fn cell_ids(cells: Cells<'_>, wide: bool) -> (Numbers<'_>, Numbers<'_>) {
    match cells {
        Cells::Triangles(triangles) => ids_of_alike(triangles, wide),
        Cells::Tetrahedra(tetrahedra) => ids_of_alike(tetrahedra, wide),
        Cells::QuadraticTetrahedra(tetrahedra) => ids_of_alike(tetrahedra, wide),
        Cells::TrianglesOf(Each { count, value }) => {
            let connectivity = match wide {
                false => Numbers::each(count, value),
                true => Numbers::each(count, move |triangle| value(triangle).map(i64::from)),
            };
            let end = |cell: usize| 3 * (cell as u64 + 1);
            (connectivity, ids(count, end, wide))
        }
        Cells::Polygons(cells) | Cells::Polylines(cells) => {
            let corners: Vec<u32> = cells.iter().flatten().copied().collect();
            let ends: Vec<u64> = cells
                .iter()
                .scan(0, |end, cell| {
                    *end += cell.len() as u64;
                    Some(*end)
                })
                .collect();
            let corner = move |index: usize| u64::from(corners[index]);
            let count = usize::try_from(ends.last().copied().unwrap_or(0)).expect("as many as in memory");
            (ids(count, corner, wide), ids(ends.len(), move |cell: usize| ends[cell], wide))
        }
        Cells::Vertices(count) => {
            (ids(count, |cell| cell as u64, wide), ids(count, |cell| cell as u64 + 1, wide))
        }
    }
}

/// The same of cells with so many points each.
fn ids_of_alike<const N: usize>(cells: &[[u32; N]], wide: bool) -> (Numbers<'_>, Numbers<'_>) {
    let corners = cells.as_flattened();
    let connectivity = match wide {
        false => Numbers::slice(corners),
        true => Numbers::each(corners.len(), |corner| i64::from(corners[corner])),
    };
    (connectivity, ids(cells.len(), |cell| N as u64 * (cell as u64 + 1), wide))
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "the caller asks for wide ids where 32 bits do not hold them"
)]
fn ids<'a>(count: usize, id: impl Fn(usize) -> u64 + Sync + 'a, wide: bool) -> Numbers<'a> {
    if wide { Numbers::each(count, id) } else { Numbers::each(count, move |index| id(index) as u32) }
}

fn attributes<'a>(arrays: &[Array<'a>], numbers: &mut NumbersOfFile<'a>) -> Arrays {
    let elements = arrays.iter().map(|Array { name, values }| {
        array(name, values.scalar_type(), values.component_count(), numbers.append(Numbers::of(*values)))
    });
    let elements = elements.collect();
    Arrays { normals: arrays.iter().any(is_normals).then_some(NORMALS), ..Arrays::new(elements) }
}

fn field(entry: &FieldEntry, format: XmlFormat, numbers: &mut NumbersOfFile<'_>) -> Element {
    match (&entry.value, format) {
        (FieldValue::Integer(number), _) => {
            let offset = numbers.append(Numbers::bytes(number.to_ne_bytes().to_vec()));
            Element::DataArray(Header::new(entry.name, ScalarType::UInt64, 1, offset).with_tuples(1))
        }
        (FieldValue::Numbers(values), _) => {
            let offset = numbers.append(Numbers::bytes(bytemuck::cast_slice(values).to_vec()));
            Element::DataArray(
                Header::new(entry.name, ScalarType::Float64, 1, offset).with_tuples(values.len()),
            )
        }
        (FieldValue::Ids(ids), _) => {
            let offset = numbers.append(Numbers::bytes(bytemuck::cast_slice(ids).to_vec()));
            Element::DataArray(Header::new(entry.name, ScalarType::Int32, 1, offset).with_tuples(ids.len()))
        }
        (FieldValue::Items(tuples), _) => {
            let offset = numbers.append(Numbers::bytes(tuples.all().to_vec()));
            let header = Header::new(entry.name, tuples.kind, tuples.components, offset);
            Element::DataArray(header.with_tuples(tuples.len()))
        }
        (FieldValue::Data(array), _) => {
            let offset = numbers.append(Numbers::bytes(array.to_bytes()));
            let header = Header::new(entry.name, array.kind(), array.components, offset);
            Element::DataArray(header.with_tuples(array.len()))
        }
        (FieldValue::Text(text), XmlFormat::UnstructuredGrid) => {
            let offset = numbers.append(Numbers::bytes(text.clone().into_bytes()));
            Element::DataArray(Header::new(entry.name, ScalarType::UInt8, 1, offset).with_tuples(text.len()))
        }
        (FieldValue::Text(text), XmlFormat::PolyData) => {
            let offset = numbers.append(Numbers::bytes(format!("{text}\0").into_bytes()));
            Element::Array(Header::new(entry.name, NotNumeric::String, 1, offset).with_tuples(1))
        }
    }
}

fn array(name: &str, scalar_type: ScalarType, number_of_components: usize, offset: u64) -> Element {
    Element::DataArray(Header::new(name, scalar_type, number_of_components, offset))
}

impl<Type> Header<Type> {
    fn new(name: &str, value_type: Type, number_of_components: usize, offset: u64) -> Self {
        let format = DataArrayFormat::Appended;
        Self {
            value_type,
            name: name.to_owned(),
            number_of_components,
            number_of_tuples: None,
            format,
            offset,
        }
    }

    fn with_tuples(self, count: usize) -> Self {
        Self { number_of_tuples: Some(count), ..self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_are_widened_when_asked() {
        let as_bytes = |ids: &[i64]| bytemuck::cast_slice::<i64, u8>(ids).to_vec();
        let triangles = [[0, 1, 2], [2, 1, u32::MAX]];
        let (connectivity, ends) = cell_ids(Cells::Triangles(&triangles), true);
        assert_eq!(connectivity.to_vec(), as_bytes(&[0, 1, 2, 2, 1, i64::from(u32::MAX)]));
        assert_eq!(ends.to_vec(), as_bytes(&[3, 6]));

        let polylines = [vec![0, 1], vec![2, 1, 3]];
        let (connectivity, ends) = cell_ids(Cells::Polylines(&polylines), true);
        assert_eq!(connectivity.to_vec(), as_bytes(&[0, 1, 2, 1, 3]));
        assert_eq!(ends.to_vec(), as_bytes(&[2, 5]));
    }
}
