//! The legacy format .vtk: big-endian PolyData through `vtkio`.

use std::io::{self, Write};

use vtkio::Vtk;
use vtkio::model::{
    Attribute, Attributes, ByteOrder, DataSet, FieldArray, IOBuffer, PolyDataPiece, Version, VertexNumbers,
};

use super::{Array, Cells, FieldEntry, FieldValue, PolyData, Values};

/// The last version whose cells are 32-bit; every reader knows it.
const VERSION: (u32, u32) = (4, 2);

/// The line after which VTK expects the field data, which `vtkio` does not write.
const DATA_SET_LINE: &[u8] = b"DATASET POLYDATA\n";

/// Writes the file.
pub(super) fn write(data: &PolyData<'_>, out: &mut dyn Write) -> io::Result<()> {
    let mut bytes = Vec::new();
    to_vtkio(data)?.write_legacy(&mut bytes).map_err(io::Error::other)?;
    let field_start = bytes
        .windows(DATA_SET_LINE.len())
        .position(|window| window == DATA_SET_LINE)
        .map(|start| start + DATA_SET_LINE.len())
        .ok_or_else(|| io::Error::other("the legacy writer did not begin a PolyData set"))?;
    let (head, rest) = bytes.split_at(field_start);
    out.write_all(head)?;
    write_field(&data.field, out)?;
    out.write_all(rest)
}

fn to_vtkio(data: &PolyData<'_>) -> io::Result<Vtk> {
    // Each cell is stored as its number of points and their ids.
    checked_count(data.points.len().max(data.cells.len() + data.cells.corner_count()))?;
    let (mut verts, mut lines, mut polys) = (None, None, None);
    match data.cells {
        Cells::Triangles(triangles) => polys = Some(counted_cells(triangles.iter().map(|cell| &cell[..]))?),
        Cells::Polygons(polygons) => polys = Some(counted_cells(polygons.iter().map(|cell| &cell[..]))?),
        Cells::Polylines(polylines) => lines = Some(counted_cells(polylines.iter().map(|cell| &cell[..]))?),
        Cells::Vertices(count) => {
            let ids: Vec<u32> = (0..checked_count(count)?).collect();
            verts = Some(counted_cells(ids.iter().map(std::slice::from_ref))?);
        }
    }
    let coordinates: &[f64] = bytemuck::cast_slice(data.points);
    Ok(Vtk {
        version: Version::new_legacy(VERSION.0, VERSION.1),
        title: env!("CARGO_PKG_NAME").to_owned(),
        byte_order: ByteOrder::BigEndian,
        file_path: None,
        data: DataSet::inline(PolyDataPiece {
            points: coordinates.to_vec().into(),
            verts,
            lines,
            polys,
            data: Attributes { point: attributes(&data.point_arrays), cell: attributes(&data.cell_arrays) },
            ..Default::default()
        }),
    })
}

fn counted_cells<'a>(cells: impl ExactSizeIterator<Item = &'a [u32]>) -> io::Result<VertexNumbers> {
    let num_cells = checked_count(cells.len())?;
    let mut vertices = Vec::with_capacity(4 * cells.len());
    for cell in cells {
        vertices.push(checked_count(cell.len())?);
        vertices.extend_from_slice(cell);
    }
    Ok(VertexNumbers::Legacy { num_cells, vertices })
}

/// A count as the format stores it: in the positive half of a signed 32-bit integer.
fn checked_count(count: usize) -> io::Result<u32> {
    i32::try_from(count).map(i32::cast_unsigned).map_err(|_| {
        let message =
            format!("{count} numbers are more than the legacy format can count; write .vtp instead");
        io::Error::new(io::ErrorKind::InvalidInput, message)
    })
}

/// The arrays as one field: of arrays written as scalars VTK reads only the first.
fn attributes(arrays: &[Array<'_>]) -> Vec<Attribute> {
    if arrays.is_empty() {
        return Vec::new();
    }
    let arrays = arrays.iter().map(|Array { name, values }| FieldArray {
        name: (*name).to_owned(),
        elem: u32::try_from(values.component_count()).expect("few components"),
        data: match values {
            Values::Int8(values) => IOBuffer::I8(values.to_vec()),
            Values::Int32(values) => IOBuffer::I32(values.to_vec()),
            Values::Int32Pairs(pairs) => IOBuffer::I32(pairs.as_flattened().to_vec()),
            Values::Float64(values) => IOBuffer::F64(values.to_vec()),
            Values::Float64Pairs(pairs) => IOBuffer::F64(pairs.as_flattened().to_vec()),
            Values::Vectors(vectors) => IOBuffer::F64(bytemuck::cast_slice(vectors).to_vec()),
            Values::Int8Of(each) => IOBuffer::I8((0..each.count).map(each.value).collect()),
            Values::Int32Of(each) => IOBuffer::I32((0..each.count).map(each.value).collect()),
            Values::Int32PairsOf(each) => IOBuffer::I32((0..each.count).flat_map(each.value).collect()),
            Values::Int32Tuples(tuples) => IOBuffer::I32(tuples.values.to_vec()),
            Values::Float64Of(each) => IOBuffer::F64((0..each.count).map(each.value).collect()),
        },
    });
    vec![Attribute::field("FieldData").with_field_data(arrays)]
}

fn write_field(entries: &[FieldEntry], out: &mut dyn Write) -> io::Result<()> {
    if entries.is_empty() {
        return Ok(());
    }
    writeln!(out, "FIELD FieldData {}", entries.len())?;
    for FieldEntry { name, value } in entries {
        match value {
            FieldValue::Integer(number) => {
                // The older name `unsigned_long` has four bytes on some systems.
                writeln!(out, "{name} 1 1 vtktypeuint64")?;
                out.write_all(&number.to_be_bytes())?;
            }
            FieldValue::Text(text) => {
                writeln!(out, "{name} 1 1 string")?;
                // The two highest bits say how long the length is: 01 for four bytes in all.
                let length = checked_count(text.len())?.min(0x3fff_ffff);
                out.write_all(&(length | 0x4000_0000).to_be_bytes())?;
                out.write_all(text.as_bytes())?;
            }
        }
        writeln!(out)?;
    }
    Ok(())
}
