//! MetaImage of ITK: lines of keys and values, then numbers, or the name of the file that holds them.
//!
//! <https://docs.itk.org/en/latest/learn/metaio.html>

use std::borrow::Cow;

use glam::DVec3;

use super::label_map::FileMap;
use super::number_type::{ByteOrder, NumberType};
use super::options::MapOptions;
use super::stored_numbers::{Encoding, IN_SEVERAL_FILES, Source, StoredNumbers, TURNED_AXES, of_axes};
use crate::error::map_file::MapProblem;

/// Reads the labels; their first axis is x.
pub(super) fn read(source: &Source<'_>, _: &MapOptions) -> Result<FileMap, MapProblem> {
    let (header, name, rest) = split(source.bytes).ok_or_else(|| damaged("it names no ElementDataFile"))?;
    let field = |names: &[&str]| {
        let mut fields = header.lines().filter_map(|line| line.split_once('='));
        fields.find(|(name, _)| names.contains(&name.trim())).map(|(_, value)| value.trim())
    };
    let is_true = |names: &[&str]| field(names).is_some_and(|value| value.eq_ignore_ascii_case("true"));
    let missing = |name: &str| damaged(format!("its header has no {name} that is understood"));
    let shape = field(&["DimSize"]).and_then(|text| of_axes(text, 1)).ok_or_else(|| missing("DimSize"))?;
    let number_type = field(&["ElementType"]).and_then(number_type).ok_or_else(|| missing("ElementType"))?;
    if field(&["ElementNumberOfChannels"]).is_some_and(|count| count != "1") {
        return Err(MapProblem::Unfit {
            what: "its voxels have several numbers each",
            remedy: "save the labels of grains alone",
        });
    }
    let is_big = is_true(&["ElementByteOrderMSB", "BinaryDataByteOrderMSB"]);
    let is_text = field(&["BinaryData"]).is_some_and(|value| value.eq_ignore_ascii_case("false"));
    let encoding = match (is_text, is_true(&["CompressedData"])) {
        (true, _) => Encoding::Text,
        (false, true) => Encoding::Zlib,
        (false, false) => Encoding::Raw,
    };
    let order = if is_big { ByteOrder::Big } else { ByteOrder::Little };
    let stored = StoredNumbers { format: "MetaImage", shape, number_type, order, encoding };
    let data = match name {
        "LOCAL" | "Local" | "local" => Cow::Borrowed(rest),
        _ if name.starts_with("LIST") || name.contains('%') => {
            return Err(IN_SEVERAL_FILES);
        }
        _ => source.beside(name)?.into(),
    };
    let skipped = match field(&["HeaderSize"]) {
        // The numbers end the file.
        Some("-1") => data.len().checked_sub(stored.length()?),
        Some(count) => count.parse().ok(),
        None => Some(0),
    };
    let data = skipped.and_then(|skipped| data.get(skipped..));
    let data = data.ok_or_else(|| damaged("its HeaderSize leads past the end of the file"))?;
    if let Some(axes) = field(&["TransformMatrix", "Rotation", "Orientation"]) {
        let axes: Vec<Option<f64>> = axes.split_whitespace().map(|number| number.parse().ok()).collect();
        let side = if axes.len() == 4 { 2 } else { 3 };
        let is_one = |place: usize| place.is_multiple_of(side + 1);
        let mut axes = axes.into_iter().enumerate();
        if !axes.all(|(place, number)| number == Some(f64::from(u8::from(is_one(place))))) {
            return Err(TURNED_AXES);
        }
    }
    let spacing = match field(&["ElementSpacing", "ElementSize"]) {
        Some(text) => Some(of_axes(text, 1.0).ok_or_else(|| missing("ElementSpacing"))?),
        None => None,
    };
    let spacing = spacing.map(DVec3::from_array);
    let first_center = match field(&["Offset", "Position", "Origin"]) {
        Some(text) => Some(of_axes(text, 0.0).ok_or_else(|| missing("Offset"))?),
        None => None,
    };
    let half = 0.5 * spacing.unwrap_or(DVec3::ONE);
    let origin = first_center.map(|center| DVec3::from_array(center) - half);
    Ok(FileMap { shape, spacing, origin, labels: stored.labels(data)? })
}

/// The header, the name of the data's file, and what follows: that name ends the header.
fn split(bytes: &[u8]) -> Option<(Cow<'_, str>, &str, &[u8])> {
    let key = b"ElementDataFile";
    let place = bytes.windows(key.len()).position(|window| window == key)?;
    let (header, rest) = bytes.split_at(place);
    let end = rest.iter().position(|byte| *byte == b'\n').unwrap_or(rest.len());
    let (_, name) = std::str::from_utf8(&rest[..end]).ok()?.split_once('=')?;
    Some((String::from_utf8_lossy(header), name.trim(), rest.get(end + 1..).unwrap_or_default()))
}

fn number_type(name: &str) -> Option<NumberType> {
    Some(match name {
        "MET_CHAR" => NumberType::I8,
        "MET_UCHAR" => NumberType::U8,
        "MET_SHORT" => NumberType::I16,
        "MET_USHORT" => NumberType::U16,
        "MET_INT" | "MET_LONG" => NumberType::I32,
        "MET_UINT" | "MET_ULONG" => NumberType::U32,
        "MET_LONG_LONG" => NumberType::I64,
        "MET_ULONG_LONG" => NumberType::U64,
        "MET_FLOAT" => NumberType::F32,
        "MET_DOUBLE" => NumberType::F64,
        _ => return None,
    })
}

fn damaged(what: impl Into<String>) -> MapProblem {
    MapProblem::Damaged { format: "MetaImage", what: what.into() }
}
