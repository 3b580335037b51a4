//! Tetrahedra that fill grains as VTK's XML UnstructuredGrid.

use std::io::{self, Write};

use crate::Polycrystal;
use crate::names::VOLUMES;
use crate::volume_mesh::VolumeMesh;
use crate::vtk::{Array, Cells, FieldEntry, FieldValue, PolyData, Values, VtkFormat, write_vtk};

/// Writes the tetrahedra with the cell array `GrainId` and what grains have, the point array `PeriodicOriginal` in a periodic domain, and the field data of networks.
pub(super) fn write(polycrystal: &Polycrystal, mesh: &VolumeMesh, out: &mut dyn Write) -> io::Result<()> {
    let count = mesh.tetrahedra.len();
    let names = polycrystal.file().names;
    let grain = |cell: usize| names.number(mesh.grains[cell]);
    let tuples = polycrystal.grain_tuples();
    let mut cell_arrays = vec![Array { name: names.grain(), values: Values::each(count, grain) }];
    let grain_of = |cell: usize| Some(mesh.grains[cell].index());
    cell_arrays.extend(tuples.iter().map(|tuples| tuples.of_cells(count, grain_of)));
    let (elements, pairs) = polycrystal.elements(mesh)?;
    let mut originals: Vec<i32> = (0..).take(elements.points.len()).collect();
    pairs.iter().for_each(|pair| originals[pair.secondary as usize] = pair.primary.cast_signed());
    let originals = Array { name: "PeriodicOriginal", values: Values::slice(&originals) };
    let point_arrays = if pairs.is_empty() { Vec::new() } else { vec![originals] };
    let mut field = polycrystal.field();
    let volumes = FieldValue::Numbers(polycrystal.network.cell_volumes().to_vec());
    field.push(FieldEntry { name: VOLUMES, value: volumes });
    field.push(polycrystal.seed_ids());
    field.extend(polycrystal.grain_fields());
    let cells = match elements.are_quadratic() {
        true => Cells::QuadraticTetrahedra(bytemuck::cast_slice(elements.nodes())),
        false => Cells::Tetrahedra(&mesh.tetrahedra),
    };
    let data = PolyData { points: &elements.points, cells, point_arrays, cell_arrays, field };
    write_vtk(&data, VtkFormat::Vtu, polycrystal.file().encoding, out)
}
