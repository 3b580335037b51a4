//! The parts of an XML file that make the mesh, put so that `vtkio` can read them.
//!
//! `vtkio` fails on compressed arrays without numbers, which VTK writes for the kinds of cell that a file lacks, and knows no raw
//! appended data, which ParaView writes. So what is not needed goes, and raw data move into their elements as base64.

use std::ops::Range;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

/// Elements that no mesh needs.
const NOT_NEEDED: [&str; 5] = ["FieldData", "PointData", "CellData", "Verts", "Lines"];

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
pub(super) fn points_and_faces(bytes: &[u8]) -> Vec<u8> {
    parts(bytes, |head| NOT_NEEDED.iter().for_each(|name| remove(head, name)))
}

/// The file with points, cells, and those of their arrays whose names are wanted.
///
/// What is no XML comes back as it is, for `vtkio` to refuse.
pub(super) fn network(bytes: &[u8], wanted: &[&str]) -> Vec<u8> {
    parts(bytes, |head| {
        remove(head, "FieldData");
        for name in ["PointData", "CellData"] {
            let Some(found) = element(head, name) else { continue };
            let mut rest = &head[found.clone()];
            let mut kept = format!("<{name}>");
            while let Some(array) = element(rest, "DataArray") {
                let is_wanted =
                    attribute(&rest[array.clone()], "Name").is_some_and(|name| wanted.contains(&name));
                kept.push_str(if is_wanted { &rest[array.clone()] } else { "" });
                rest = &rest[array.end..];
            }
            head.replace_range(found, &format!("{kept}</{name}>"));
        }
    })
}

fn remove(head: &mut String, name: &str) {
    while let Some(element) = element(head, name) {
        head.replace_range(element, "");
    }
}

/// The file after `reduce` has taken away from what stands before its appended data.
fn parts(bytes: &[u8], reduce: impl FnOnce(&mut String)) -> Vec<u8> {
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
    match raw_data(appended).and_then(|data| inline(&head, data)) {
        Some(inlined) => (inlined + "</VTKFile>").into_bytes(),
        None => [head.as_bytes(), appended].concat(),
    }
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

/// The value of an attribute within a tag.
fn attribute<'a>(tag: &'a str, name: &str) -> Option<&'a str> {
    let (_, value) = tag.split_once(&format!(" {name}=\""))?;
    value.split('"').next()
}

/// The bytes behind the underscore, if they are raw.
fn raw_data(appended: &[u8]) -> Option<&[u8]> {
    let tag_end = find(appended, b">")?;
    let tag = String::from_utf8_lossy(&appended[..tag_end]);
    (attribute(&tag, "encoding") == Some("raw")).then_some(())?;
    let start = find(&appended[tag_end..], b"_")?;
    appended.get(tag_end + start + 1..)
}

/// The document with the arrays of `data` within its elements; nothing if they do not fit together.
fn inline(head: &str, data: &[u8]) -> Option<String> {
    let file = &head[head.find("<VTKFile")?..];
    let width = if attribute(file, "header_type") == Some("UInt64") { 8 } else { 4 };
    let is_big = attribute(file, "byte_order") == Some("BigEndian");
    let is_compressed = attribute(file.split('>').next()?, "compressor").is_some();
    let number = |at: usize| -> Option<usize> {
        let bytes = data.get(at..at.checked_add(width)?)?;
        let add = |number: u64, &byte: &u8| number << 8 | u64::from(byte);
        let number = if is_big { bytes.iter().fold(0, add) } else { bytes.iter().rev().fold(0, add) };
        usize::try_from(number).ok()
    };
    let mut inlined = String::new();
    let mut rest = head;
    while let Some(start) = rest.find("<DataArray") {
        let end = start + rest[start..].find('>')? + 1;
        let tag = &rest[start..end];
        inlined.push_str(&rest[..start]);
        rest = &rest[end..];
        let Some(offset) = attribute(tag, "offset").filter(|_| attribute(tag, "format") == Some("appended"))
        else {
            inlined.push_str(tag);
            continue;
        };
        let at: usize = offset.parse().ok()?;
        let (header, length) = if is_compressed {
            // The number of blocks, their size, that of the last, and how many bytes each takes.
            let blocks = number(at)?;
            let header = width.checked_mul(blocks.checked_add(3)?)?;
            data.get(at..at.checked_add(header)?)?;
            let sizes = (0..blocks).map(|block| number(at + width * (3 + block)));
            (header, sizes.sum::<Option<usize>>()?)
        } else {
            (width, number(at)?)
        };
        let start = at.checked_add(header)?;
        let (header, array) = (&data[at..start], data.get(start..start.checked_add(length)?)?);
        inlined.push_str(&tag.trim_end_matches('>').trim_end_matches('/').replacen("appended", "binary", 1));
        inlined.push('>');
        // The header of compressed data is a base64 text of its own.
        if is_compressed {
            inlined.push_str(&STANDARD.encode(header));
            inlined.push_str(&STANDARD.encode(array));
        } else {
            inlined.push_str(&STANDARD.encode([header, array].concat()));
        }
        inlined.push_str("</DataArray>");
        // An element that was not empty closes itself.
        if !tag.ends_with("/>") {
            rest = rest.split_once("</DataArray>")?.1;
        }
    }
    Some(inlined + rest)
}

fn find(bytes: &[u8], what: &[u8]) -> Option<usize> {
    bytes.windows(what.len()).position(|window| window == what)
}
