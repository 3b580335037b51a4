//! VTK's UnstructuredGrid with tetrahedra, or with triangles.

use glam::DVec3;
use polycrystal::GrainId;
use vtkio::{IOBuffer, model::CellType};

use super::{Tie, VolumeFile};
use crate::Names;
use crate::mesh::file::MeshFileProblem;
use crate::names::VOLUMES;
use crate::volume_mesh::element_shape::ElementShape;
use crate::vtk::{Element, XmlFile};
use clap::ValueEnum;

/// VTK's numbers for elements of first and second order.
fn shape_of(kind: i64) -> Option<ElementShape> {
    const TRIANGLES: [CellType; 2] = [CellType::Triangle, CellType::QuadraticTriangle];
    const TETRAHEDRA: [CellType; 2] = [CellType::Tetra, CellType::QuadraticTetra];
    let is_of = |types: [CellType; 2]| types.into_iter().any(|of| of as i64 == kind);
    let shapes = [(TRIANGLES, ElementShape::Triangle), (TETRAHEDRA, ElementShape::Tetrahedron)];
    shapes.into_iter().find(|(types, _)| is_of(*types)).map(|(_, shape)| shape)
}

fn corrupt(what: impl ToString) -> MeshFileProblem {
    MeshFileProblem::corrupt("VTK", what)
}

/// Whether the first cell is a tetrahedron, or a triangle of a grain: those of a network have two.
pub(super) fn has_elements(bytes: &[u8]) -> bool {
    let Some(file) = XmlFile::of(bytes) else { return false };
    let types = named(&file, "Cells", "types").and_then(|array| whole_numbers(&file, array));
    match types.and_then(|types| shape_of(*types.first()?)) {
        None => false,
        Some(ElementShape::Triangle) => grains(&file).is_some(),
        Some(ElementShape::Tetrahedron) => true,
    }
}

/// The array of the grain of each cell.
fn grains<'a, 'b>(file: &'b XmlFile<'a>) -> Option<&'b Element<'a>> {
    let grain_names = Names::value_variants().iter().map(|names| names.grain());
    grain_names.filter_map(|name| named(file, "CellData", name)).next()
}

pub(super) fn read(bytes: &[u8]) -> Result<VolumeFile, MeshFileProblem> {
    let xml = XmlFile::of(bytes).ok_or_else(|| corrupt("it is no XML file of VTK"))?;
    let cells = |name: &str| {
        let array = named(&xml, "Cells", name).and_then(|array| whole_numbers(&xml, array));
        array.ok_or_else(|| corrupt(format!("the array {name} of the cells cannot be read")))
    };
    let points = xml.arrays("Points").next().and_then(|array| numbers(&xml, array));
    let points = points.ok_or_else(|| corrupt("the points cannot be read"))?;
    let (points, []) = points.as_chunks::<3>() else { return Err(corrupt("a point lacks coordinates")) };
    let mut file = VolumeFile {
        points: points.iter().copied().map(DVec3::from_array).collect(),
        node_numbers: (0..).take(points.len()).collect(),
        volumes: xml.field_numbers(VOLUMES),
        ..VolumeFile::default()
    };
    let (connectivity, types) = (cells("connectivity")?, cells("types")?);
    let grains = grains(&xml).and_then(|array| whole_numbers(&xml, array));
    let grains = grains.ok_or_else(|| corrupt("no array tells the grain of each cell, such as GrainId"))?;
    file.shape = types.first().and_then(|kind| shape_of(*kind)).unwrap_or_default();
    let mut start = 0;
    for (cell, ((kind, end), grain)) in types.iter().zip(cells("offsets")?).zip(grains).enumerate() {
        let end = usize::try_from(end).unwrap_or(usize::MAX);
        let nodes = connectivity.get(start..end).unwrap_or_default();
        let node = |node: &i64| {
            let place = u32::try_from(*node).ok().filter(|place| (*place as usize) < points.len());
            place.ok_or_else(|| corrupt(format!("cell {cell} has the node {node}, and there is none")))
        };
        let nodes: Vec<u32> = nodes.iter().map(node).collect::<Result<_, _>>()?;
        let [one, _, _] = file.shape.words();
        if shape_of(*kind) != Some(file.shape) {
            return Err(corrupt(format!("cell {cell} is no {one}")));
        }
        file.push_element(cell as u64, &nodes).map_err(|wanted| {
            corrupt(format!("cell {cell} has {} nodes in place of {wanted}", nodes.len()))
        })?;
        file.grains.push(u32::try_from(grain).map(GrainId).into_iter().collect());
        start = end;
    }
    if file.element_numbers.len() != types.len() || start != connectivity.len() {
        return Err(corrupt("the arrays of the cells are not as long as they should be"));
    }
    let originals = named(&xml, "PointData", "PeriodicOriginal");
    let originals = originals.and_then(|array| whole_numbers(&xml, array)).unwrap_or_default();
    for (copy, original) in (0u32..).zip(originals) {
        let original = u32::try_from(original).ok().filter(|original| (*original as usize) < points.len());
        let original =
            original.ok_or_else(|| corrupt(format!("the original of point {copy} is no point")))?;
        if original != copy {
            file.ties.push(Tie { copy, original, periods: None });
        }
    }
    Ok(file)
}

fn named<'a, 'b>(file: &'b XmlFile<'a>, parent: &str, name: &str) -> Option<&'b Element<'a>> {
    file.arrays(parent).find(|array| array.attribute("Name").as_deref() == Some(name))
}

fn values(file: &XmlFile<'_>, array: &Element<'_>) -> Option<IOBuffer> {
    file.values(array, array.scalar_type()?)
}

fn whole_numbers(file: &XmlFile<'_>, array: &Element<'_>) -> Option<Vec<i64>> {
    values(file, array)?.cast_into()
}

fn numbers(file: &XmlFile<'_>, array: &Element<'_>) -> Option<Vec<f64>> {
    values(file, array)?.cast_into()
}
