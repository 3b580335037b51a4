//! The parts of an XML file that make the mesh, as `vtkio` can read them.
//!
//! `vtkio` fails on compressed arrays without numbers, which VTK writes for the kinds of cell that a file lacks, and knows no raw
//! appended data, which we and ParaView write. So what is not needed goes, and raw data move into their elements as base64.

use super::{MeshFileProblem, problem};
use crate::vtk::{Element, XmlFile};

/// Elements that no mesh needs.
const NOT_NEEDED: [&str; 2] = ["FieldData", "Verts"];

/// Elements that a mesh can do without.
const DATA: [&str; 2] = ["PointData", "CellData"];

/// Kinds of numbers that arrays are kept of.
const KINDS: [&str; 10] =
    ["Int8", "UInt8", "Int16", "UInt16", "Int32", "UInt32", "Int64", "UInt64", "Float32", "Float64"];

/// Kinds of cell that are left out of the file when there are none, and the attribute with their number.
const PERHAPS_EMPTY: [(&str, &str); 4] = [
    ("Verts", "NumberOfVerts"),
    ("Lines", "NumberOfLines"),
    ("Strips", "NumberOfStrips"),
    ("Polys", "NumberOfPolys"),
];

/// The file with points and faces alone.
///
/// What is no XML comes back as it is, for `vtkio` to refuse.
pub(super) fn points_and_faces(bytes: &[u8]) -> Result<Vec<u8>, MeshFileProblem> {
    reduced(bytes, |element| without(element, &[NOT_NEEDED, DATA].concat()))
}

/// The file with points, faces and all arrays of numbers.
///
/// What is no XML comes back as it is, for `vtkio` to refuse.
pub(super) fn all(bytes: &[u8]) -> Result<Vec<u8>, MeshFileProblem> {
    reduced(bytes, |element| {
        without(element, &NOT_NEEDED);
        keep_arrays(element, "type", &KINDS);
    })
}

/// The file with points, cells, and those of their arrays whose names are wanted.
///
/// What is no XML comes back as it is, for `vtkio` to refuse.
pub(super) fn network(bytes: &[u8], wanted: &[&str]) -> Result<Vec<u8>, MeshFileProblem> {
    reduced(bytes, |element| {
        without(element, &["FieldData"]);
        keep_arrays(element, "Name", wanted);
    })
}

/// The names of the arrays of points and cells.
pub(super) fn array_names(bytes: &[u8]) -> Vec<String> {
    let Some(file) = XmlFile::of(bytes) else { return Vec::new() };
    let arrays = DATA.into_iter().flat_map(|name| file.arrays(name));
    arrays.filter_map(|array| array.attribute("Name")).collect()
}

/// The file after `reduce` has taken away from its elements.
fn reduced(bytes: &[u8], mut reduce: impl FnMut(&mut Element<'_>)) -> Result<Vec<u8>, MeshFileProblem> {
    let Some(mut file) = XmlFile::of(bytes) else { return Ok(bytes.to_vec()) };
    file.root.change(&mut |element| {
        reduce(element);
        let has_none = |(_, count): &(&str, &str)| element.attribute(count).as_deref() == Some("0");
        let empty: Vec<&str> = PERHAPS_EMPTY.into_iter().filter(has_none).map(|(name, _)| name).collect();
        without(element, &empty);
    });
    file.inlined().map_err(problem)
}

fn without(element: &mut Element<'_>, names: &[&str]) {
    element.children.retain(|child| !names.iter().any(|name| child.is(name)));
}

/// Keeps those arrays of points or cells of which an attribute has one of some values.
fn keep_arrays(element: &mut Element<'_>, attribute: &str, values: &[&str]) {
    if DATA.iter().any(|name| element.is(name)) {
        // These name arrays that may go.
        element.clear_attributes();
        element.children.retain(|array| {
            array.is("DataArray") && array.attribute(attribute).is_some_and(|own| values.contains(&&*own))
        });
    }
}
