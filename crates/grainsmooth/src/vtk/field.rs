//! What files say about themselves as a whole, in VTK's field data.

use vtkio::xml::ScalarType;

use super::{DataArray, ItemTuples, XmlFile};

/// A named value about the file as a whole, kept in VTK's field data.
#[derive(Debug, Clone, PartialEq)]
pub struct FieldEntry {
    /// Name under which VTK lists the entry; without blanks, which the legacy format cannot hold.
    pub name: &'static str,
    /// What is said.
    pub value: FieldValue,
}

/// The value of a [`FieldEntry`].
///
/// A text is a string array in .vtp and .vtk. In .vtu it is an array of UInt8 holding the UTF-8 bytes: the
/// tools other than VTK that read .vtu refuse the whole file when they meet a string array.
#[derive(Debug, Clone, PartialEq)]
pub enum FieldValue {
    /// Text without NUL characters.
    Text(String),
    /// A number such as the random seed, kept as UInt64.
    Integer(u64),
    /// Any number of numbers, such as volumes, kept as Float64.
    Numbers(Vec<f64>),
    /// Any number of ids, kept as Int32.
    Ids(Vec<i32>),
    /// A tuple of numbers for each of some items.
    Items(ItemTuples),
    /// Whatever another file held.
    Data(DataArray),
}

impl FieldValue {
    /// The kind of the numbers, how many a tuple has, and their bytes; a text is its bytes.
    pub(super) fn numbers(&self) -> (ScalarType, usize, &[u8]) {
        match self {
            Self::Text(text) => (ScalarType::UInt8, 1, text.as_bytes()),
            Self::Integer(number) => (ScalarType::UInt64, 1, bytemuck::bytes_of(number)),
            Self::Numbers(numbers) => (ScalarType::Float64, 1, bytemuck::cast_slice(numbers)),
            Self::Ids(ids) => (ScalarType::Int32, 1, bytemuck::cast_slice(ids)),
            Self::Items(tuples) => (tuples.kind, tuples.components, tuples.all()),
            Self::Data(array) => (array.kind(), array.components, array.bytes()),
        }
    }
}

/// An entry of the field data of a .vtp, .vtu or .vti file, whatever it is. `is_text` tells a text in a .vtu file, where texts are bytes.
pub(crate) fn field_entry(file: &XmlFile<'_>, name: &'static str, is_text: bool) -> Option<FieldEntry> {
    let array = file.field(name)?;
    let components = array.attribute("NumberOfComponents").and_then(|count| count.parse().ok()).unwrap_or(1);
    let data = |kind| {
        let values = file.values(array, kind)?;
        Some(FieldValue::Data(DataArray::of_buffer(name, components, &values)?))
    };
    let value = match array.attribute("type")?.as_str() {
        "String" => FieldValue::Text(file.field_text(name)?),
        "UInt8" if is_text => FieldValue::Text(file.field_text(name)?),
        "UInt8" => data(ScalarType::UInt8)?,
        "Int32" => data(ScalarType::Int32)?,
        "Float64" => data(ScalarType::Float64)?,
        "UInt64" => {
            FieldValue::Integer(file.values(array, ScalarType::UInt64)?.into_vec::<u64>()?.first().copied()?)
        }
        _ => return None,
    };
    Some(FieldEntry { name, value })
}
