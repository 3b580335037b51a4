//! The arrays of an XML file put where `vtkio` reads them, and as it understands them.

use std::borrow::Cow;

use vtkio::IOBuffer;
use vtkio::xml::ScalarType;

use super::coding::{Coding, Encoded};

/// The document with appended arrays moved into their elements as base64, which `vtkio` knows, and with headers of compressed ones
/// as it understands them; any other file as it is.
///
/// Field data that are no numbers stay without their values; [`field_text`] reads those.
pub fn inlined(file: &[u8]) -> Vec<u8> {
    try_inlined(file).unwrap_or_else(|_| file.to_vec())
}

/// As [`inlined`], or what is damaged.
pub(crate) fn try_inlined(file: &[u8]) -> Result<Vec<u8>, String> {
    let (head, appended) = split(file);
    let text = String::from_utf8_lossy(head);
    Ok(match inline(&text, &Appended::of(appended))? {
        Some(inlined) if appended.is_empty() => inlined.into_bytes(),
        Some(inlined) => (inlined + "</VTKFile>").into_bytes(),
        None => file.to_vec(),
    })
}

/// A text of the field data of a .vtp, .vtu or .vti file, whichever program wrote it; nothing where the file has no such entry.
pub fn field_text(file: &[u8], name: &str) -> Option<String> {
    let text = String::from_utf8(field_bytes(file, name)?).ok()?;
    Some(text.trim_end_matches('\0').to_owned())
}

/// The bytes of an entry of such a file's field data.
pub fn field_bytes(file: &[u8], name: &str) -> Option<Vec<u8>> {
    field_values(file, name, ScalarType::UInt8)?.into_vec()
}

/// The 64-bit floating point numbers of an entry of such a file's field data.
pub fn field_numbers(file: &[u8], name: &str) -> Option<Vec<f64>> {
    field_values(file, name, ScalarType::Float64)?.into_vec()
}

/// The names of all entries of such a file's field data.
pub(crate) fn field_names(file: &[u8]) -> Vec<String> {
    let head = String::from_utf8_lossy(split(file).0);
    let field = head.split_once("<FieldData").and_then(|(_, rest)| rest.split_once("</FieldData>"));
    let tags = field.map_or("", |(field, _)| field).split("Array ").skip(1);
    tags.filter_map(|tag| attribute(&format!(" {tag}"), "Name").map(str::to_owned)).collect()
}

/// The tag of an entry of such a file's field data.
pub(crate) fn field_tag(file: &[u8], name: &str) -> Option<String> {
    let head = String::from_utf8_lossy(split(file).0);
    Some(field_element(&head, name)?.0.to_owned())
}

/// The numbers of an entry of such a file's field data, which are of this kind.
pub(crate) fn field_values(file: &[u8], name: &str, kind: ScalarType) -> Option<IOBuffer> {
    let file = XmlFile::of(file)?;
    let (tag, content) = field_element(&file.head, name)?;
    file.values(tag, content, kind)
}

/// An XML file of VTK: its elements, and the numbers of its arrays wherever they stand.
pub(crate) struct XmlFile<'a> {
    /// All that stands before the appended data.
    pub(crate) head: Cow<'a, str>,
    appended: Appended<'a>,
    coding: Coding,
}

impl<'a> XmlFile<'a> {
    /// The file, if it is one.
    pub(crate) fn of(file: &'a [u8]) -> Option<Self> {
        let (head, appended) = split(file);
        let head = String::from_utf8_lossy(head);
        let coding = Coding::of(&head)?;
        Some(Self { head, appended: Appended::of(appended), coding })
    }

    /// The tag and the content of each array of an element, such as `CellData`, where it stands first.
    pub(crate) fn arrays(&self, element: &str) -> Vec<(&str, &str)> {
        let found = self.head.split_once(&format!("<{element}"));
        let inside = found.and_then(|(_, rest)| rest.split_once(&format!("</{element}>")));
        let arrays = inside.map_or("", |(inside, _)| inside).split("<DataArray").skip(1);
        arrays
            .filter_map(|array| array.split_once('>'))
            .map(|(tag, rest)| (tag, rest.split('<').next().unwrap_or_default()))
            .collect()
    }

    /// The numbers of an array.
    pub(crate) fn values(&self, tag: &str, content: &str, kind: ScalarType) -> Option<IOBuffer> {
        match attribute(tag, "format")? {
            "appended" => self.coding.values(self.appended.array(self.coding, tag)?, kind),
            "binary" => self.coding.values(self.coding.of_text(content.trim().as_bytes())?, kind),
            _ => self.coding.values_of_words(content, kind),
        }
    }
}

/// The tag and the content of an entry of the field data.
fn field_element<'a>(head: &'a str, name: &str) -> Option<(&'a str, &'a str)> {
    let (_, field) = head.split_once("<FieldData")?;
    let (field, _) = field.split_once("</FieldData>")?;
    let start = field[..field.find(&format!(" Name=\"{name}\""))?].rfind('<')?;
    let (tag, rest) = field[start..].split_once('>')?;
    Some((tag, rest.split('<').next()?))
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

/// The appended data behind the underscore.
enum Appended<'a> {
    None,
    Raw(&'a [u8]),
    Base64(&'a [u8]),
}

impl<'a> Appended<'a> {
    fn of(appended: &'a [u8]) -> Self {
        let Some((tag, rest)) = find(appended, b">").map(|end| appended.split_at(end)) else {
            return Self::None;
        };
        let tag = String::from_utf8_lossy(tag);
        let data = find(rest, b"_").map(|start| &rest[start + 1..]);
        match (attribute(&tag, "encoding"), data) {
            (Some("raw"), Some(data)) => Self::Raw(data),
            (Some("base64"), Some(data)) => Self::Base64(data),
            _ => Self::None,
        }
    }

    /// The array that a tag names by its offset.
    fn array(&self, coding: Coding, tag: &str) -> Option<Encoded> {
        let at: usize = attribute(tag, "offset")?.parse().ok()?;
        match self {
            Self::None => None,
            Self::Raw(data) => coding.of_raw(data.get(at..)?),
            Self::Base64(data) => coding.of_text(data.get(at..)?),
        }
    }
}

/// The document with its arrays within its elements; nothing if nothing needs to change, or it is no document.
fn inline(head: &str, appended: &Appended<'_>) -> Result<Option<String>, String> {
    let Some(coding) = Coding::of(head) else { return Ok(None) };
    if !head.contains("format=\"appended\"") && !coding.is_compressed() {
        return Ok(None);
    }
    let cut_off = || "its last element is cut off".to_owned();
    let mut inlined = String::with_capacity(head.len());
    let mut rest = head;
    while let Some(start) = rest.find("<DataArray") {
        let end = start + rest[start..].find('>').ok_or_else(cut_off)? + 1;
        let tag = &rest[start..end];
        inlined.push_str(&rest[..start]);
        rest = &rest[end..];
        let array = match attribute(tag, "format") {
            Some("appended") if attribute(tag, "offset").is_some() => appended.array(coding, tag),
            Some("binary") if coding.is_compressed() && !tag.ends_with("/>") => {
                rest.split('<').next().and_then(|content| coding.of_text(content.trim().as_bytes()))
            }
            _ => {
                inlined.push_str(tag);
                continue;
            }
        };
        let name = attribute(tag, "Name").unwrap_or("without a name");
        let array = array.ok_or_else(|| format!("the numbers of its array {name} are damaged or cut off"))?;
        inlined.push_str(&tag.trim_end_matches('>').trim_end_matches('/').replacen("appended", "binary", 1));
        inlined.push('>');
        inlined.push_str(&array.text);
        inlined.push_str("</DataArray>");
        // An element that was not empty closes itself.
        if !tag.ends_with("/>") {
            rest = rest.split_once("</DataArray>").ok_or_else(cut_off)?.1;
        }
    }
    Ok(Some(inlined + rest))
}

/// Where `what` stands first.
pub(crate) fn find(bytes: &[u8], what: &[u8]) -> Option<usize> {
    bytes.windows(what.len()).position(|window| window == what)
}
