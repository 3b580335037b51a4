//! Elements that fill grains as VTK's XML UnstructuredGrid.

use std::io::{self, Write};

use glam::DVec3;
use polycrystal::GrainId;
use voronoi::Dimension;

use super::hexahedra::Hexahedra;
use crate::Polycrystal;
use crate::names::VOLUMES;
use crate::volume_mesh::element_shape::ElementShape;
use crate::vtk::{Array, Cells, ElementType, FieldEntry, FieldValue, PolyData, Values, VtkFormat, write_vtk};

/// Writes the elements with the cell array `GrainId` and what grains have, the point array `PeriodicOriginal` in a periodic domain, and the field data of networks.
pub(super) fn write(polycrystal: &Polycrystal, out: &mut dyn Write) -> io::Result<()> {
    let (elements, pairs) = polycrystal.elements()?;
    let mut originals: Vec<i32> = (0..).take(elements.points.len()).collect();
    pairs.iter().for_each(|pair| originals[pair.secondary as usize] = pair.primary.cast_signed());
    let originals = Array { name: "PeriodicOriginal", values: Values::slice(&originals) };
    let point_arrays = if pairs.is_empty() { Vec::new() } else { vec![originals] };
    let kind = match (elements.shape, elements.are_quadratic()) {
        (ElementShape::Triangle, false) => ElementType::Triangle,
        (ElementShape::Triangle, true) => ElementType::QuadraticTriangle,
        (ElementShape::Tetrahedron, false) => ElementType::Tetrahedron,
        (ElementShape::Tetrahedron, true) => ElementType::QuadraticTetrahedron,
    };
    let cells = Cells::Elements(kind, elements.nodes());
    write_cells(polycrystal, (&elements.points, point_arrays), cells, elements.grains, out)
}

/// Writes voxels as hexahedra, in the plane as squares, with the same arrays of cells.
pub(super) fn write_voxels(polycrystal: &Polycrystal, out: &mut dyn Write) -> io::Result<()> {
    let grid = polycrystal.label_grid()?;
    let hexahedra = Hexahedra::new(&grid, polycrystal.dimension());
    let nodes = hexahedra.nodes();
    let points: Vec<DVec3> = nodes.iter().map(|node| hexahedra.place(*node)).collect();
    let too_many = |_| io::Error::other("more nodes than 32-bit ids can name; give fewer voxels");
    let number = |node: usize| u32::try_from(nodes.partition_point(|other| *other < node)).map_err(too_many);
    let corners = hexahedra.voxels().flat_map(|voxel| hexahedra.nodes_of(voxel));
    let corners = corners.map(number).collect::<io::Result<Vec<u32>>>()?;
    let kind = match polycrystal.dimension() {
        Dimension::Two => ElementType::Quad,
        Dimension::Three => ElementType::Hexahedron,
    };
    let grains: Vec<GrainId> = hexahedra.grains.iter().flatten().map(|grain| GrainId(*grain)).collect();
    write_cells(polycrystal, (&points, Vec::new()), Cells::Elements(kind, &corners), &grains, out)
}

fn write_cells(
    polycrystal: &Polycrystal,
    (points, point_arrays): (&[DVec3], Vec<Array<'_>>),
    cells: Cells<'_>,
    grains: &[GrainId],
    out: &mut dyn Write,
) -> io::Result<()> {
    let count = grains.len();
    let names = polycrystal.file().names;
    let grain = |cell: usize| names.number(grains[cell]);
    let tuples = polycrystal.grain_tuples();
    let mut cell_arrays = vec![Array { name: names.grain(), values: Values::each(count, grain) }];
    let grain_of = |cell: usize| Some(grains[cell].index());
    cell_arrays.extend(tuples.iter().map(|tuples| tuples.of_cells(count, grain_of)));
    let mut field = polycrystal.field();
    let volumes = FieldValue::Numbers(polycrystal.network.cell_volumes().to_vec());
    field.push(FieldEntry { name: VOLUMES, value: volumes });
    field.push(polycrystal.seed_ids());
    field.extend(polycrystal.grain_fields());
    let data = PolyData { points, cells, point_arrays, cell_arrays, field };
    write_vtk(&data, VtkFormat::Vtu, polycrystal.file().encoding, out)
}
