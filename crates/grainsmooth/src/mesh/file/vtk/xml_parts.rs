//! The parts of an XML file that make the mesh, put so that `vtkio` can read them.
//!
//! `vtkio` fails on compressed arrays without numbers, which VTK writes for the kinds of cell that a file lacks, and knows no raw
//! appended data, which we and ParaView write. So what is not needed goes, and raw data move into their elements as base64.

use std::ops::Range;

use super::{MeshFileProblem, problem};
use crate::vtk::{attribute, find, try_inlined};

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
    parts(bytes, |head| NOT_NEEDED.iter().chain(&DATA).for_each(|name| remove(head, name)))
}

/// The file with points, faces and all arrays of numbers.
///
/// What is no XML comes back as it is, for `vtkio` to refuse.
pub(super) fn all(bytes: &[u8]) -> Result<Vec<u8>, MeshFileProblem> {
    parts(bytes, |head| {
        NOT_NEEDED.iter().for_each(|name| remove(head, name));
        keep_arrays(head, |array| attribute(array, "type").is_some_and(|kind| KINDS.contains(&kind)));
    })
}

/// The file with points, cells, and those of their arrays whose names are wanted.
///
/// What is no XML comes back as it is, for `vtkio` to refuse.
pub(super) fn network(bytes: &[u8], wanted: &[&str]) -> Result<Vec<u8>, MeshFileProblem> {
    parts(bytes, |head| {
        remove(head, "FieldData");
        keep_arrays(head, |array| attribute(array, "Name").is_some_and(|name| wanted.contains(&name)));
    })
}

/// The names of the arrays of points and cells.
pub(super) fn array_names(bytes: &[u8]) -> Vec<String> {
    let head = String::from_utf8_lossy(&bytes[..find(bytes, b"<AppendedData").unwrap_or(bytes.len())]);
    let of_element = |name: &&str| element(&head, name).map(|found| &head[found]);
    let tags = DATA.iter().filter_map(of_element).flat_map(|element| element.split("<DataArray").skip(1));
    tags.filter_map(|tag| attribute(tag, "Name").map(str::to_owned)).collect()
}

/// Keeps those arrays of points and cells that are wanted.
fn keep_arrays(head: &mut String, is_wanted: impl Fn(&str) -> bool) {
    for name in DATA {
        let Some(found) = element(head, name) else { continue };
        let mut rest = &head[found.clone()];
        let mut kept = format!("<{name}>");
        while let Some(array) = element(rest, "DataArray") {
            kept.push_str(if is_wanted(&rest[array.clone()]) { &rest[array.clone()] } else { "" });
            rest = &rest[array.end..];
        }
        head.replace_range(found, &format!("{kept}</{name}>"));
    }
}

fn remove(head: &mut String, name: &str) {
    while let Some(element) = element(head, name) {
        head.replace_range(element, "");
    }
}

/// The file after `reduce` has taken away from what stands before its appended data.
fn parts(bytes: &[u8], reduce: impl FnOnce(&mut String)) -> Result<Vec<u8>, MeshFileProblem> {
    let appended = find(bytes, b"<AppendedData").unwrap_or(bytes.len());
    let (head, appended) = bytes.split_at(appended);
    let mut head = String::from_utf8_lossy(head).into_owned();
    reduce(&mut head);
    for (name, count) in PERHAPS_EMPTY {
        let mut kept = 0;
        while let Some(found) = element(&head[kept..], name) {
            let element = kept + found.start..kept + found.end;
            let piece = head[..element.start].rfind("<Piece").unwrap_or(0);
            if attribute(&head[piece..element.start], count) == Some("0") {
                head.replace_range(element, "");
            } else {
                kept = element.end;
            }
        }
    }
    try_inlined(&[head.as_bytes(), appended].concat()).map_err(problem)
}

/// Where the first element of this name stands.
fn element(text: &str, name: &str) -> Option<Range<usize>> {
    let opening = format!("<{name}");
    let mut from = 0;
    loop {
        let start = from + text[from..].find(&opening)?;
        let after = &text[start + opening.len()..];
        if !after.starts_with(|next: char| next.is_whitespace() || next == '>' || next == '/') {
            from = start + opening.len();
            continue;
        }
        let tag_end = start + opening.len() + after.find('>')? + 1;
        if text[..tag_end].ends_with("/>") {
            return Some(start..tag_end);
        }
        let closing = format!("</{name}>");
        return Some(start..tag_end + text[tag_end..].find(&closing)? + closing.len());
    }
}
