//! The legacy format .vtk: big-endian PolyData.
//!
//! `vtkio` writes it too, but holds all numbers once more in its own arrays and the whole file in memory.

use std::io::{self, Write};

use vtkio::xml::ScalarType;

use super::raw::Numbers;
use super::{Array, Cells, FieldEntry, FieldValue, PolyData, is_normals};

/// The last version whose cells are 32-bit; every reader knows it.
const VERSION: &str = "4.2";

/// Writes the file.
pub(super) fn write(data: &PolyData<'_>, out: &mut dyn Write) -> io::Result<()> {
    // Each cell is stored as its number of points and their ids.
    let numbers_of_cells = data.cells.len() + data.cells.corner_count();
    checked_count(data.points.len().max(numbers_of_cells))?;
    let title = env!("CARGO_PKG_NAME");
    write!(out, "# vtk DataFile Version {VERSION}\n{title}\nBINARY\n\nDATASET POLYDATA\n")?;
    write_field(&data.field, out)?;
    writeln!(out, "POINTS {} double", data.points.len())?;
    Numbers::slice(data.points).write_big_endian(size_of::<f64>(), out)?;
    let (keyword, cells) = match data.cells {
        Cells::Triangles(triangles) => {
            let cell = |index: usize| {
                let [a, b, c] = triangles[index];
                [3, a, b, c]
            };
            ("POLYGONS", Numbers::each(triangles.len(), cell))
        }
        Cells::TrianglesOf { count, triangle } => {
            let cell = move |index: usize| {
                let [a, b, c] = triangle(index);
                [3, a, b, c]
            };
            ("POLYGONS", Numbers::each(count, cell))
        }
        Cells::Polygons(cells) => ("POLYGONS", counted(cells)?),
        Cells::Polylines(cells) => ("LINES", counted(cells)?),
        Cells::Vertices(count) => {
            // No more than the positive half of 32 bits, as checked.
            #[expect(clippy::cast_possible_truncation, reason = "checked above")]
            let cell = |index: usize| [1, index as u32];
            ("VERTICES", Numbers::each(count, cell))
        }
        Cells::Elements(..) => return Err(io::Error::other("PolyData holds no finite elements")),
    };
    write!(out, "\n\n{keyword} {} {numbers_of_cells}\n", data.cells.len())?;
    cells.write_big_endian(size_of::<u32>(), out)?;
    write!(out, "\n\n")?;
    write_arrays("POINT_DATA", data.points.len(), &data.point_arrays, out)?;
    write_arrays("CELL_DATA", data.cells.len(), &data.cell_arrays, out)
}

/// Cells with any number of points: that number, then their ids.
fn counted(cells: &[Vec<u32>]) -> io::Result<Numbers<'static>> {
    let mut numbers = Vec::new();
    for cell in cells {
        numbers.push(checked_count(cell.len())?);
        numbers.extend_from_slice(cell);
    }
    Ok(Numbers::bytes(bytemuck::cast_slice(&numbers).to_vec()))
}

/// A count as the format stores it: in the positive half of a signed 32-bit integer.
fn checked_count(count: usize) -> io::Result<u32> {
    i32::try_from(count).map(i32::cast_unsigned).map_err(|_| {
        let message =
            format!("{count} numbers are more than the legacy format can count; write .vtp instead");
        io::Error::new(io::ErrorKind::InvalidInput, message)
    })
}

/// The arrays as one field: of arrays written as scalars VTK reads only the first. Normals alone stand before it, as those to shade with.
fn write_arrays(keyword: &str, count: usize, arrays: &[Array<'_>], out: &mut dyn Write) -> io::Result<()> {
    if arrays.is_empty() {
        return Ok(());
    }
    write!(out, "{keyword} {count}\n\n")?;
    let (normals, arrays): (Vec<&Array<'_>>, Vec<_>) = arrays.iter().partition(|array| is_normals(array));
    for Array { name, values } in normals {
        writeln!(out, "NORMALS {name} double")?;
        values.numbers.write_big_endian(size_of::<f64>(), out)?;
        writeln!(out)?;
    }
    if arrays.is_empty() {
        return writeln!(out);
    }
    writeln!(out, "FIELD FieldData {}", arrays.len())?;
    for Array { name, values } in arrays {
        let (kind, bytes) = kind_and_width(values.kind);
        writeln!(out, "{name} {} {count} {kind}", values.components)?;
        values.numbers.write_big_endian(bytes, out)?;
        writeln!(out)?;
    }
    writeln!(out)
}

/// The format's name for a kind of numbers, and the bytes of each.
fn kind_and_width(kind: ScalarType) -> (&'static str, usize) {
    match kind {
        ScalarType::Int8 => ("char", size_of::<i8>()),
        ScalarType::UInt8 => ("unsigned_char", size_of::<u8>()),
        ScalarType::Float64 => ("double", size_of::<f64>()),
        // The older name `unsigned_long` has four bytes on some systems.
        ScalarType::UInt64 => ("vtktypeuint64", size_of::<u64>()),
        _ => ("int", size_of::<i32>()),
    }
}

fn write_field(entries: &[FieldEntry], out: &mut dyn Write) -> io::Result<()> {
    if entries.is_empty() {
        return Ok(());
    }
    writeln!(out, "FIELD FieldData {}", entries.len())?;
    for FieldEntry { name, value } in entries {
        match value {
            FieldValue::Text(text) => {
                writeln!(out, "{name} 1 1 string")?;
                // The two highest bits say how long the length is: 01 for four bytes in all.
                let length = checked_count(text.len())?.min(0x3fff_ffff);
                out.write_all(&(length | 0x4000_0000).to_be_bytes())?;
                out.write_all(text.as_bytes())?;
            }
            _ => {
                let (kind, components, bytes) = value.numbers();
                let (name_of_kind, width) = kind_and_width(kind);
                let count = bytes.len() / (width * components);
                writeln!(out, "{name} {components} {count} {name_of_kind}")?;
                Numbers::slice(bytes).write_big_endian(width, out)?;
            }
        }
        writeln!(out)?;
    }
    Ok(())
}
