//! The elements of an XML file, named and ordered as VTK wants them.
//!
//! `vtkio` has the same tree, but without field data and with parts that only its own conversion can fill.

use quick_xml::escape::escape;
use vtkio::xml::ScalarType;

use super::super::image::head;
use super::super::raw::{Numbers, NumbersOfFile};
use super::super::{Array, Cells, FieldEntry, FieldValue, NORMALS, PolyData, Values, is_normals};
use super::XmlFormat;

/// VTK's codes for the kinds of cell.
const VERTEX: u8 = 1;
const POLY_LINE: u8 = 4;
const TRIANGLE: u8 = 5;
const POLYGON: u8 = 7;

/// The elements of a file but for the last tag, whose arrays are listed in `numbers`.
pub(super) fn document<'a>(
    data: &PolyData<'a>,
    format: XmlFormat,
    numbers: &mut NumbersOfFile<'a>,
) -> String {
    let (kind, cells) = match (format, data.cells) {
        (XmlFormat::UnstructuredGrid, _) => ("UnstructuredGrid", "Cells"),
        (XmlFormat::PolyData, Cells::Polylines(_)) => ("PolyData", "Lines"),
        (XmlFormat::PolyData, Cells::Vertices(_)) => ("PolyData", "Verts"),
        // Finite elements do not come here: `write` refuses them.
        (XmlFormat::PolyData, _) => ("PolyData", "Polys"),
    };
    let field: String = data.field.iter().map(|entry| field(entry, format, numbers)).collect();
    let points = Array { name: "Points", values: Values::slice(data.points) };
    let points = elements(&[points], numbers);
    let (of_points, of_cells) = (elements(&data.point_arrays, numbers), elements(&data.cell_arrays, numbers));
    let topology = elements(&topology(data, format), numbers);
    let attributes = |name: &str, arrays: &[Array<'_>], elements: String| {
        let shaded =
            if arrays.iter().any(is_normals) { format!(" Normals=\"{NORMALS}\"") } else { String::new() };
        group(name, &shaded, &elements)
    };
    format!(
        "{}<{kind}>{}<Piece NumberOfPoints=\"{}\" NumberOf{cells}=\"{}\">{}{}{}{}</Piece></{kind}>",
        head(kind, numbers),
        group("FieldData", "", &field),
        data.points.len(),
        data.cells.len(),
        attributes("PointData", &data.point_arrays, of_points),
        attributes("CellData", &data.cell_arrays, of_cells),
        group("Points", "", &points),
        group(cells, "", &topology),
    )
}

/// An element around others.
fn group(name: &str, attributes: &str, elements: &str) -> String {
    match elements {
        "" => format!("<{name}{attributes}/>"),
        _ => format!("<{name}{attributes}>{elements}</{name}>"),
    }
}

/// The arrays that tell which points are in which cell.
fn topology<'a>(data: &PolyData<'a>, format: XmlFormat) -> Vec<Array<'a>> {
    // VTK's ids are signed, and both arrays must have the same width.
    let largest = data.points.len().max(data.cells.corner_count());
    let wide = i32::try_from(largest).is_err();
    let id_type = if wide { ScalarType::Int64 } else { ScalarType::Int32 };
    let (connectivity, ends) = cell_ids(data.cells, wide);
    let ids = |name, numbers| Array { name, values: Values::new(id_type, 1, 0, numbers) };
    let mut arrays = vec![ids("connectivity", connectivity), ids("offsets", ends)];
    if format == XmlFormat::UnstructuredGrid {
        let kind = match data.cells {
            Cells::Triangles(_) | Cells::TrianglesOf { .. } => TRIANGLE,
            Cells::Polygons(_) => POLYGON,
            Cells::Polylines(_) => POLY_LINE,
            Cells::Vertices(_) => VERTEX,
            Cells::Elements(kind, _) => kind as u8,
        };
        arrays.push(Array { name: "types", values: Values::each(data.cells.len(), move |_| kind) });
    }
    arrays
}

/// The point ids of all cells in a row, and where in that row each cell ends.
fn cell_ids(cells: Cells<'_>, wide: bool) -> (Numbers<'_>, Numbers<'_>) {
    match cells {
        Cells::Triangles(triangles) => ids_of_alike(triangles.as_flattened(), 3, wide),
        Cells::Elements(kind, points) => ids_of_alike(points, kind.point_count(), wide),
        Cells::TrianglesOf { count, triangle } => {
            let connectivity = match wide {
                false => Numbers::each(count, triangle),
                true => Numbers::each(count, move |index| triangle(index).map(i64::from)),
            };
            (connectivity, Numbers::ids(count, |cell| 3 * (cell as u64 + 1), wide))
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
            (Numbers::ids(count, corner, wide), Numbers::ids(ends.len(), move |cell: usize| ends[cell], wide))
        }
        Cells::Vertices(count) => {
            (Numbers::ids(count, |cell| cell as u64, wide), Numbers::ids(count, |cell| cell as u64 + 1, wide))
        }
    }
}

/// The same of cells with so many points each.
fn ids_of_alike(corners: &[u32], of_cell: usize, wide: bool) -> (Numbers<'_>, Numbers<'_>) {
    let connectivity = match wide {
        false => Numbers::slice(corners),
        true => Numbers::each(corners.len(), |corner| i64::from(corners[corner])),
    };
    (connectivity, Numbers::ids(corners.len() / of_cell, move |cell| (of_cell * (cell + 1)) as u64, wide))
}

/// The elements of arrays, which have a tuple for each point or cell.
fn elements<'a>(arrays: &[Array<'a>], numbers: &mut NumbersOfFile<'a>) -> String {
    let element = |Array { name, values }: &Array<'a>| {
        let offset = numbers.append(values.numbers.clone());
        element("DataArray", &format!("{:?}", values.kind), name, values.components, None, offset)
    };
    arrays.iter().map(element).collect()
}

fn field(
    FieldEntry { name, value }: &FieldEntry,
    format: XmlFormat,
    numbers: &mut NumbersOfFile<'_>,
) -> String {
    let (kind, components, bytes) = value.numbers();
    if matches!(value, FieldValue::Text(_)) && format == XmlFormat::PolyData {
        let offset = numbers.append(Numbers::bytes([bytes, b"\0"].concat()));
        return element("Array", "String", name, 1, Some(1), offset);
    }
    let offset = numbers.append(Numbers::bytes(bytes.to_vec()));
    let count = bytes.len() / (kind.size() * components);
    element("DataArray", &format!("{kind:?}"), name, components, Some(count), offset)
}

/// An element whose numbers stand behind the document. Only field data need their number of tuples.
fn element(
    element: &str,
    kind: &str,
    name: &str,
    components: usize,
    tuples: Option<usize>,
    offset: u64,
) -> String {
    let tuples = tuples.map_or_else(String::new, |count| format!(" NumberOfTuples=\"{count}\""));
    let name = escape(name);
    format!(
        "<{element} type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{components}\"{tuples} format=\"appended\" offset=\"{offset}\"/>"
    )
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
