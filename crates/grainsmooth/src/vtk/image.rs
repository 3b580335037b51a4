//! Regular grids as VTK's ImageData, .vti.

use std::io::{self, Write};

use glam::DVec3;
use vtkio::model::ByteOrder;

use super::raw::{Numbers, NumbersOfFile};
use super::{Array, FieldEntry, FieldValue, VtkEncoding};

/// A regular grid of cells.
#[derive(Debug, Clone)]
pub struct ImageData<'a> {
    /// Number of cells along each axis.
    pub size: [usize; 3],
    /// The corner with the smallest coordinates.
    pub origin: DVec3,
    /// Side lengths of a cell.
    pub spacing: DVec3,
    /// Arrays with one tuple for each cell, x fastest, then y, then z.
    pub cell_arrays: Vec<Array<'a>>,
    /// What is said about the file as a whole.
    pub field: Vec<FieldEntry>,
}

/// Writes the grid.
///
/// # Errors
/// Whatever `out` reports.
///
/// # Panics
/// When an array has another length than there are cells.
pub fn write_vti(data: &ImageData<'_>, encoding: VtkEncoding, out: &mut dyn Write) -> io::Result<()> {
    let [nx, ny, nz] = data.size;
    let (origin, spacing) = (numbers(data.origin), numbers(data.spacing));
    let mut numbers_of_file = NumbersOfFile::new(encoding);
    let mut document = Vec::new();
    let head = &mut document;
    write_head("ImageData", &numbers_of_file, head)?;
    writeln!(
        head,
        "<ImageData WholeExtent=\"0 {nx} 0 {ny} 0 {nz}\" Origin=\"{origin}\" Spacing=\"{spacing}\" Direction=\"1 0 0 0 1 0 0 0 1\">"
    )?;
    writeln!(head, "<FieldData>")?;
    write_field(&data.field, &mut numbers_of_file, head)?;
    writeln!(head, "</FieldData>\n<Piece Extent=\"0 {nx} 0 {ny} 0 {nz}\">\n<PointData/>\n<CellData>")?;
    for Array { name, values } in &data.cell_arrays {
        assert_eq!(values.len(), nx * ny * nz, "cell array {name}");
        let (kind, components) = (values.scalar_type(), values.component_count());
        let offset = numbers_of_file.append(Numbers::of(*values));
        writeln!(
            head,
            "<DataArray type=\"{kind:?}\" Name=\"{name}\" NumberOfComponents=\"{components}\" format=\"appended\" offset=\"{offset}\"/>"
        )?;
    }
    writeln!(head, "</CellData>\n</Piece>\n</ImageData>")?;
    numbers_of_file.write_file(&document, out)
}

/// Begins a file.
pub(super) fn write_head(kind: &str, numbers: &NumbersOfFile<'_>, out: &mut dyn Write) -> io::Result<()> {
    let byte_order = match ByteOrder::native() {
        ByteOrder::LittleEndian => "LittleEndian",
        ByteOrder::BigEndian => "BigEndian",
    };
    let compressor = numbers.compressor().map_or(String::new(), |name| format!(" compressor=\"{name}\""));
    writeln!(
        out,
        "<VTKFile type=\"{kind}\" version=\"1.0\" byte_order=\"{byte_order}\" header_type=\"UInt64\"{compressor}>"
    )
}

/// Lists what is said about the file as a whole.
pub(super) fn write_field(
    field: &[FieldEntry],
    numbers_of_file: &mut NumbersOfFile<'_>,
    out: &mut dyn Write,
) -> io::Result<()> {
    for FieldEntry { name, value } in field {
        let (element, kind, components, count, bytes) = match value {
            FieldValue::Text(text) => ("Array", "String", 1, 1, format!("{text}\0").into_bytes()),
            FieldValue::Integer(number) => ("DataArray", "UInt64", 1, 1, number.to_ne_bytes().to_vec()),
            FieldValue::Numbers(numbers) => {
                ("DataArray", "Float64", 1, numbers.len(), bytemuck::cast_slice(numbers).to_vec())
            }
            FieldValue::Ids(ids) => ("DataArray", "Int32", 1, ids.len(), bytemuck::cast_slice(ids).to_vec()),
            FieldValue::Items(tuples) => {
                ("DataArray", tuples.kind_name(), tuples.components, tuples.len(), tuples.all().to_vec())
            }
            FieldValue::Data(array) => {
                ("DataArray", array.kind_name(), array.components, array.len(), array.to_bytes())
            }
        };
        let offset = numbers_of_file.append(Numbers::bytes(bytes));
        let components =
            if components == 1 { String::new() } else { format!(" NumberOfComponents=\"{components}\"") };
        writeln!(
            out,
            "<{element} type=\"{kind}\" Name=\"{name}\"{components} NumberOfTuples=\"{count}\" format=\"appended\" offset=\"{offset}\"/>"
        )?;
    }
    Ok(())
}

fn numbers(vector: DVec3) -> String {
    format!("{:?} {:?} {:?}", vector.x, vector.y, vector.z)
}
