//! VTK's UnstructuredGrid with tetrahedra.

use glam::DVec3;
use polycrystal::GrainId;
use vtkio::{IOBuffer, model::CellType};

use super::{Tie, VolumeFile};
use crate::Names;
use crate::mesh::file::MeshFileProblem;
use crate::names::VOLUMES;
use crate::vtk::{Element, XmlFile};
use clap::ValueEnum;

/// VTK's numbers for tetrahedra of first and second order.
const LINEAR: i64 = CellType::Tetra as i64;
const QUADRATIC: i64 = CellType::QuadraticTetra as i64;

fn corrupt(what: impl ToString) -> MeshFileProblem {
    MeshFileProblem::corrupt("VTK", what)
}

/// Whether the first cell is a tetrahedron.
pub(super) fn has_tetrahedra(bytes: &[u8]) -> bool {
    let Some(file) = XmlFile::of(bytes) else { return false };
    let types = named(&file, "Cells", "types").and_then(|array| whole_numbers(&file, array));
    types.is_some_and(|types| matches!(types.first(), Some(&(LINEAR | QUADRATIC))))
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
    let grain_names = Names::value_variants().iter().map(|names| names.grain());
    let grains = grain_names.filter_map(|name| named(&xml, "CellData", name)).next();
    let grains = grains.and_then(|array| whole_numbers(&xml, array));
    let grains = grains.ok_or_else(|| corrupt("no array tells the grain of each cell, such as GrainId"))?;
    let mut start = 0;
    for (cell, ((kind, end), grain)) in types.iter().zip(cells("offsets")?).zip(grains).enumerate() {
        let end = usize::try_from(end).unwrap_or(usize::MAX);
        let nodes = connectivity.get(start..end).unwrap_or_default();
        let node = |node: &i64| {
            let place = u32::try_from(*node).ok().filter(|place| (*place as usize) < points.len());
            place.ok_or_else(|| corrupt(format!("cell {cell} has the node {node}, and there is none")))
        };
        let nodes: Vec<u32> = nodes.iter().map(node).collect::<Result<_, _>>()?;
        match (*kind, nodes.first_chunk::<4>(), nodes.len()) {
            (LINEAR, Some(ends), 4) => file.tetrahedra.push(*ends),
            (QUADRATIC, Some(ends), 10) => {
                file.tetrahedra.push(*ends);
                file.middles.extend(nodes.last_chunk::<6>());
            }
            _ => return Err(corrupt(format!("cell {cell} is no tetrahedron"))),
        }
        file.element_numbers.push(cell as u64);
        file.grains.push(u32::try_from(grain).map(GrainId).into_iter().collect());
        start = end;
    }
    if file.tetrahedra.len() != types.len() || start != connectivity.len() {
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
