//! Regular grids as VTK's ImageData, .vti.

use std::io::{self, Write};

use glam::DVec3;
use vtkio::model::ByteOrder;

use super::raw::{Numbers, NumbersOfFile};
use super::{Array, FieldEntry, FieldValue, VtkEncoding};

/// A regular grid of cells.
#[derive(Clone)]
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
    writeln!(document, "{}", head("ImageData", &numbers_of_file))?;
    writeln!(
        document,
        "<ImageData WholeExtent=\"0 {nx} 0 {ny} 0 {nz}\" Origin=\"{origin}\" Spacing=\"{spacing}\" Direction=\"1 0 0 0 1 0 0 0 1\">"
    )?;
    writeln!(document, "<FieldData>")?;
    write_field(&data.field, &mut numbers_of_file, &mut document)?;
    writeln!(document, "</FieldData>\n<Piece Extent=\"0 {nx} 0 {ny} 0 {nz}\">\n<PointData/>\n<CellData>")?;
    for array in &data.cell_arrays {
        assert_eq!(array.values.len(), nx * ny * nz, "cell array {}", array.name);
        write_array(array, &mut numbers_of_file, &mut document)?;
    }
    writeln!(document, "</CellData>\n</Piece>\n</ImageData>")?;
    numbers_of_file.write_file(&document, out)
}

/// The first tag of a file. Its version is the one that VTK, ParaView, pyvista and meshio all read.
pub(super) fn head(kind: &str, numbers: &NumbersOfFile<'_>) -> String {
    let byte_order = match ByteOrder::native() {
        ByteOrder::LittleEndian => "LittleEndian",
        ByteOrder::BigEndian => "BigEndian",
    };
    let compressor = numbers.compressor().map_or(String::new(), |name| format!(" compressor=\"{name}\""));
    format!(
        "<VTKFile type=\"{kind}\" version=\"1.0\" byte_order=\"{byte_order}\" header_type=\"UInt64\"{compressor}>"
    )
}

/// Lists an array of points or cells.
pub(super) fn write_array<'a>(
    Array { name, values }: &Array<'a>,
    numbers_of_file: &mut NumbersOfFile<'a>,
    out: &mut dyn Write,
) -> io::Result<()> {
    let (kind, components) = (values.kind, values.components);
    let offset = numbers_of_file.append(values.numbers.clone());
    writeln!(
        out,
        "<DataArray type=\"{kind:?}\" Name=\"{name}\" NumberOfComponents=\"{components}\" format=\"appended\" offset=\"{offset}\"/>"
    )
}

/// Lists what is said about the file as a whole.
pub(super) fn write_field(
    field: &[FieldEntry],
    numbers_of_file: &mut NumbersOfFile<'_>,
    out: &mut dyn Write,
) -> io::Result<()> {
    for FieldEntry { name, value } in field {
        let (kind, components, bytes) = value.numbers();
        let (element, kind, count, bytes) = match value {
            FieldValue::Text(_) => ("Array", "String".to_owned(), 1, [bytes, b"\0"].concat()),
            _ => ("DataArray", format!("{kind:?}"), bytes.len() / (kind.size() * components), bytes.to_vec()),
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
