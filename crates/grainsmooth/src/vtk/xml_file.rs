//! XML files of VTK as they are read: their elements, and the numbers of their arrays wherever they stand.

use std::borrow::Cow;

use quick_xml::events::attributes::Attribute;
use quick_xml::events::{BytesEnd, BytesStart, BytesText, Event};
use quick_xml::{Reader, Writer};
use vtkio::IOBuffer;
use vtkio::xml::ScalarType;

use super::coding::{Coding, Encoded};

/// Elements within each other that are read, so that no file exhausts the stack; VTK's have seven at most.
const MOST_NESTED: usize = 64;

/// The document with appended arrays moved into their elements as base64, which `vtkio` knows, and with headers of compressed ones
/// as it understands them; any other file as it is.
///
/// Field data that are no numbers stay without their values; [`field_text`] reads those.
pub fn inlined(file: &[u8]) -> Vec<u8> {
    let document = XmlFile::of(file).and_then(|file| file.inlined().ok());
    document.unwrap_or_else(|| file.to_vec())
}

/// A text of the field data of a .vtp, .vtu or .vti file, whichever program wrote it; nothing where the file has no such entry.
pub fn field_text(file: &[u8], name: &str) -> Option<String> {
    XmlFile::of(file)?.field_text(name)
}

/// The bytes of an entry of such a file's field data.
pub fn field_bytes(file: &[u8], name: &str) -> Option<Vec<u8>> {
    XmlFile::of(file)?.field_bytes(name)
}

/// The 64-bit floating point numbers of an entry of such a file's field data.
pub fn field_numbers(file: &[u8], name: &str) -> Option<Vec<f64>> {
    XmlFile::of(file)?.field_numbers(name)
}

/// An element, with what stands within it.
pub(crate) struct Element<'a> {
    tag: BytesStart<'a>,
    pub(crate) children: Vec<Self>,
    /// The text before the first child, as it stands in the file.
    text: Cow<'a, [u8]>,
}

impl<'a> Element<'a> {
    fn new(tag: BytesStart<'a>) -> Self {
        Self { tag, children: Vec::new(), text: Cow::default() }
    }

    /// Whether this is the element's name.
    pub(crate) fn is(&self, name: &str) -> bool {
        self.tag.name().as_ref() == name.as_bytes()
    }

    /// The type of an array's numbers; nothing where VTK's readers know none of that name.
    pub(crate) fn scalar_type(&self) -> Option<ScalarType> {
        Some(match self.attribute("type")?.as_str() {
            "Int8" => ScalarType::Int8,
            "UInt8" => ScalarType::UInt8,
            "Int16" => ScalarType::Int16,
            "UInt16" => ScalarType::UInt16,
            "Int32" => ScalarType::Int32,
            "UInt32" => ScalarType::UInt32,
            "Int64" => ScalarType::Int64,
            "UInt64" => ScalarType::UInt64,
            "Float32" => ScalarType::Float32,
            "Float64" => ScalarType::Float64,
            _ => return None,
        })
    }

    /// The value of an attribute.
    pub(crate) fn attribute(&self, name: &str) -> Option<String> {
        let mut attributes = self.tag.attributes();
        let found = attributes
            .with_checks(false)
            .filter_map(Result::ok)
            .find(|attribute| attribute.key.as_ref() == name.as_bytes())?;
        let value = found.unescape_value().map(Cow::into_owned);
        Some(value.unwrap_or_else(|_| String::from_utf8_lossy(&found.value).into_owned()))
    }

    /// The first element of a name within this one.
    pub(crate) fn first(&self, name: &str) -> Option<&Self> {
        self.children.iter().find_map(|child| if child.is(name) { Some(child) } else { child.first(name) })
    }

    /// All elements of a name within this one, in the order of the file.
    pub(crate) fn all(&self, name: &str) -> Vec<&Self> {
        let mut found = Vec::new();
        for child in &self.children {
            found.extend(child.is(name).then_some(child));
            found.extend(child.all(name));
        }
        found
    }

    /// Changes this element, and then all within it.
    pub(crate) fn change(&mut self, change: &mut dyn FnMut(&mut Self)) {
        change(self);
        self.children.iter_mut().for_each(|child| child.change(change));
    }

    /// Takes away all attributes.
    pub(crate) fn clear_attributes(&mut self) {
        self.tag.clear_attributes();
    }
}

/// The elements of some XML: one without a name holds all. Ends at the first element named `last`, and where the XML is
/// wrong. Also gives what follows, as the tag of that element and the rest, and whether the XML was whole so far.
fn elements<'a>(xml: &'a [u8], last: Option<&str>) -> (Element<'a>, Option<(Element<'a>, &'a [u8])>, bool) {
    let mut reader = Reader::from_reader(xml);
    let mut open = vec![Element::new(BytesStart::new(""))];
    let (rest, is_whole) = loop {
        let nested = open.len();
        let innermost = &mut open[nested - 1];
        match reader.read_event() {
            Ok(Event::Start(tag)) if last.is_some_and(|last| tag.name().as_ref() == last.as_bytes()) => {
                let read = usize::try_from(reader.buffer_position()).unwrap_or(xml.len());
                break (Some((Element::new(tag), &xml[read..])), true);
            }
            Ok(Event::Start(tag)) if nested <= MOST_NESTED => open.push(Element::new(tag)),
            Ok(Event::Empty(tag)) => innermost.children.push(Element::new(tag)),
            Ok(Event::End(_)) if nested > 1 => close(&mut open),
            Ok(Event::Text(text)) if innermost.children.is_empty() => innermost.text = text.into_inner(),
            Ok(Event::Eof) => break (None, nested == 1),
            Ok(Event::Start(_) | Event::End(_)) | Err(_) => break (None, false),
            Ok(_) => {}
        }
    };
    while open.len() > 1 {
        close(&mut open);
    }
    (open.swap_remove(0), rest, is_whole)
}

/// Puts the innermost of some elements into the one around it.
fn close(open: &mut Vec<Element<'_>>) {
    if let (Some(inner), Some(outer)) = (open.pop(), open.last_mut()) {
        outer.children.push(inner);
    }
}

/// The elements of a file that has no appended data; one without a name holds all.
pub(crate) fn document(xml: &[u8]) -> Element<'_> {
    elements(xml, None).0
}

/// An XML file of VTK.
pub(crate) struct XmlFile<'a> {
    /// The element that holds all others but the appended data.
    pub(crate) root: Element<'a>,
    appended: Appended<'a>,
    coding: Coding,
    is_whole: bool,
}

impl<'a> XmlFile<'a> {
    /// The file, if it is one, as far as it goes.
    pub(crate) fn of(file: &'a [u8]) -> Option<Self> {
        let (document, appended, is_whole) = elements(file, Some("AppendedData"));
        let root = document.children.into_iter().find(|child| child.is("VTKFile"))?;
        let appended = appended.map_or(Appended::None, |(tag, rest)| Appended::new(&tag, rest));
        Some(Self { coding: Coding::of(|name| root.attribute(name)), root, appended, is_whole })
    }

    /// The arrays of the first element of a name, such as `CellData`.
    pub(crate) fn arrays<'b>(&'b self, name: &str) -> impl Iterator<Item = &'b Element<'a>> + use<'a, 'b> {
        let children = self.root.first(name).map_or(&[][..], |found| &found.children);
        children.iter().filter(|child| child.is("DataArray") || child.is("Array"))
    }

    /// The numbers of an array.
    pub(crate) fn values(&self, array: &Element<'_>, kind: ScalarType) -> Option<IOBuffer> {
        match array.attribute("format")?.as_str() {
            "appended" => self.coding.values(self.appended.array(self.coding, array)?, kind),
            "binary" => self.coding.values(self.coding.of_text(array.text.trim_ascii())?, kind),
            _ => self.coding.values_of_words(str::from_utf8(&array.text).ok()?, kind),
        }
    }

    /// An entry of the field data.
    pub(crate) fn field(&self, name: &str) -> Option<&Element<'a>> {
        self.arrays("FieldData").find(|array| array.attribute("Name").as_deref() == Some(name))
    }

    /// The numbers of an entry of the field data, which are of this kind.
    pub(crate) fn field_values(&self, name: &str, kind: ScalarType) -> Option<IOBuffer> {
        self.values(self.field(name)?, kind)
    }

    /// The bytes of an entry of the field data.
    pub(crate) fn field_bytes(&self, name: &str) -> Option<Vec<u8>> {
        self.field_values(name, ScalarType::UInt8)?.into_vec()
    }

    /// A text of the field data.
    pub(crate) fn field_text(&self, name: &str) -> Option<String> {
        let text = String::from_utf8(self.field_bytes(name)?).ok()?;
        Some(text.trim_end_matches('\0').to_owned())
    }

    /// The 64-bit floating point numbers of an entry of the field data.
    pub(crate) fn field_numbers(&self, name: &str) -> Option<Vec<f64>> {
        self.field_values(name, ScalarType::Float64)?.into_vec()
    }

    /// The document with its arrays within its elements, as `vtkio` understands them; or what is damaged.
    pub(crate) fn inlined(&self) -> Result<Vec<u8>, String> {
        let mut writer = Writer::new(Vec::new());
        self.write(&self.root, &mut writer)?;
        if !self.is_whole {
            return Err("its last element is cut off".to_owned());
        }
        Ok(writer.into_inner())
    }

    fn write(&self, element: &Element<'_>, writer: &mut Writer<Vec<u8>>) -> Result<(), String> {
        let mut write = |event: Event<'_>| writer.write_event(event).map_err(|error| error.to_string());
        let name = String::from_utf8_lossy(element.tag.name().as_ref()).into_owned();
        if let Some(array) = self.encoded(element)? {
            let attributes = element.tag.attributes().filter_map(Result::ok);
            let tag = BytesStart::new(name.as_str()).with_attributes(attributes.map(|attribute| {
                let is_format = attribute.key.as_ref() == b"format";
                if is_format { Attribute::from(("format", "binary")) } else { attribute }
            }));
            write(Event::Start(tag))?;
            write(Event::Text(BytesText::from_escaped(array.text)))?;
        } else {
            write(Event::Start(element.tag.borrow()))?;
            write(Event::Text(BytesText::from_escaped(String::from_utf8_lossy(&element.text))))?;
            for child in &element.children {
                self.write(child, writer)?;
            }
        }
        writer.write_event(Event::End(BytesEnd::new(name))).map_err(|error| error.to_string())
    }

    /// An array that `vtkio` does not understand where it stands, or as it is.
    fn encoded(&self, element: &Element<'_>) -> Result<Option<Encoded>, String> {
        let format = element.attribute("format");
        let array = match format.as_deref().filter(|_| element.is("DataArray")) {
            Some("appended") => self.appended.array(self.coding, element),
            Some("binary") if self.coding.is_compressed() => self.coding.of_text(element.text.trim_ascii()),
            _ => return Ok(None),
        };
        array.map(Some).ok_or_else(|| {
            let name = element.attribute("Name").unwrap_or_else(|| "without a name".to_owned());
            format!("the numbers of its array {name} are damaged or cut off")
        })
    }
}

/// The appended data behind the underscore.
enum Appended<'a> {
    None,
    Raw(&'a [u8]),
    Base64(&'a [u8]),
}

impl<'a> Appended<'a> {
    fn new(tag: &Element<'_>, rest: &'a [u8]) -> Self {
        let data = rest.iter().position(|byte| *byte == b'_').map(|start| &rest[start + 1..]);
        match (tag.attribute("encoding").as_deref(), data) {
            (Some("raw"), Some(data)) => Self::Raw(data),
            (Some("base64"), Some(data)) => Self::Base64(data),
            _ => Self::None,
        }
    }

    /// The array that an element names by its offset.
    fn array(&self, coding: Coding, element: &Element<'_>) -> Option<Encoded> {
        let at: usize = element.attribute("offset")?.parse().ok()?;
        match self {
            Self::None => None,
            Self::Raw(data) => coding.of_raw(data.get(at..)?),
            Self::Base64(data) => coding.of_text(data.get(at..)?),
        }
    }
}
