//! Raw appended data put where `vtkio` reads them.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

/// The document with raw appended arrays moved into their elements as base64, which `vtkio` knows; any other file as it is.
///
/// Field data that are no numbers stay without their values; [`field_text`] reads those.
pub fn inlined(file: &[u8]) -> Vec<u8> {
    let (head, appended) = split(file);
    let text = String::from_utf8_lossy(head);
    match raw_data(appended).and_then(|data| inline(&text, data)) {
        Some(inlined) => (inlined + "</VTKFile>").into_bytes(),
        None => file.to_vec(),
    }
}

/// A text of the field data of a .vtp, .vtu or .vti file as we write it; nothing where the file has no such entry.
pub fn field_text(file: &[u8], name: &str) -> Option<String> {
    let text = String::from_utf8(field_bytes(file, name)?.to_vec()).ok()?;
    Some(text.trim_end_matches('\0').to_owned())
}

/// The bytes of an entry of such a file's field data.
pub fn field_bytes<'a>(file: &'a [u8], name: &str) -> Option<&'a [u8]> {
    let (head, appended) = split(file);
    let head = String::from_utf8_lossy(head);
    let named = head.find(&format!(" Name=\"{name}\""))?;
    let start = head[..named].rfind('<')?;
    let tag = &head[start..start + head[start..].find('>')?];
    let offset: usize = attribute(tag, "offset")?.parse().ok()?;
    let (length, rest) = raw_data(appended)?.get(offset..)?.split_first_chunk()?;
    rest.get(..usize::try_from(u64::from_ne_bytes(*length)).ok()?)
}

/// What stands before the appended data, and these.
fn split(file: &[u8]) -> (&[u8], &[u8]) {
    file.split_at(find(file, b"<AppendedData").unwrap_or(file.len()))
}

/// The value of an attribute within a tag.
pub(crate) fn attribute<'a>(tag: &'a str, name: &str) -> Option<&'a str> {
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

/// Where `what` stands first.
pub(crate) fn find(bytes: &[u8], what: &[u8]) -> Option<usize> {
    bytes.windows(what.len()).position(|window| window == what)
}
