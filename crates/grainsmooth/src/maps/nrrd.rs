//! NRRD: a text header, then numbers, or the name of the file that holds them.
//!
//! <https://teem.sourceforge.net/nrrd/format.html>

use std::borrow::Cow;

use glam::DVec3;

use super::label_map::FileMap;
use super::number_type::{ByteOrder, NumberType};
use super::options::MapOptions;
use super::stored_numbers::{Encoding, IN_SEVERAL_FILES, Source, StoredNumbers, TURNED_AXES, of_axes};
use crate::error::map_file::MapProblem;

/// Reads the labels; their first axis is x.
pub(super) fn read(source: &Source<'_>, _: &MapOptions) -> Result<FileMap, MapProblem> {
    let (header, rest) = split(source.bytes).ok_or_else(|| damaged("it does not start with NRRD"))?;
    let header = String::from_utf8_lossy(header);
    let field = |names: &[&str]| {
        let fields = header.lines().filter(|line| !line.starts_with('#'));
        let mut fields = fields.filter_map(|line| line.split_once(": "));
        fields.find(|(name, _)| names.contains(name)).map(|(_, value)| value.trim())
    };
    let missing = |name: &str| damaged(format!("its header has no {name} that is understood"));
    let number_type = field(&["type"]).and_then(number_type).ok_or_else(|| missing("type"))?;
    let shape = field(&["sizes"]).and_then(|text| of_axes(text, 1)).ok_or_else(|| missing("sizes"))?;
    let encoding = match field(&["encoding"]) {
        Some("raw") => Encoding::Raw,
        Some("gzip" | "gz") => Encoding::Gzip,
        Some("ascii" | "text" | "txt") => Encoding::Text,
        _ => return Err(missing("encoding (raw, gzip or ascii)")),
    };
    let order = match field(&["endian"]) {
        Some("little") => ByteOrder::Little,
        Some("big") => ByteOrder::Big,
        None if number_type.width() == 1 || encoding == Encoding::Text => ByteOrder::Little,
        _ => return Err(missing("endian")),
    };
    let stored = StoredNumbers { format: "NRRD", shape, number_type, order, encoding };
    let data = match field(&["data file", "datafile"]) {
        None => Cow::Borrowed(rest),
        Some(name) if name.starts_with("LIST") || name.contains('%') => {
            return Err(IN_SEVERAL_FILES);
        }
        Some(name) => source.beside(name)?.into(),
    };
    let data = without_skipped(
        &data,
        field(&["line skip", "lineskip"]),
        field(&["byte skip", "byteskip"]),
        &stored,
    )?;
    let spacing = match (field(&["spacings"]), field(&["space directions"])) {
        (_, Some(text)) => Some(spacing_of_directions(text)?),
        (Some(text), None) => {
            let spacing = of_axes(text, 1.0).ok_or_else(|| missing("spacings"))?;
            // Not a number where the file does not know.
            (!spacing.iter().any(|width: &f64| width.is_nan())).then(|| DVec3::from_array(spacing))
        }
        (None, None) => None,
    };
    let first_center = field(&["space origin"]).and_then(vector);
    let origin = first_center.map(|center| center - 0.5 * spacing.unwrap_or(DVec3::ONE));
    Ok(FileMap { shape, spacing, origin, labels: stored.labels(data)? })
}

/// The header and what follows its empty line.
fn split(bytes: &[u8]) -> Option<(&[u8], &[u8])> {
    if !bytes.starts_with(b"NRRD") {
        return None;
    }
    let end_of = |mark: &[u8]| {
        let place = bytes.windows(mark.len()).position(|window| window == mark)?;
        Some((place, place + mark.len()))
    };
    let ends = [end_of(b"\n\n"), end_of(b"\r\n\r\n")].into_iter().flatten();
    let (end, rest) = ends.min().unwrap_or((bytes.len(), bytes.len()));
    Some((&bytes[..end], &bytes[rest..]))
}

/// The numbers behind what the header says to skip; -1 bytes mean that they end the file.
fn without_skipped<'a>(
    data: &'a [u8],
    lines: Option<&str>,
    bytes: Option<&str>,
    stored: &StoredNumbers,
) -> Result<&'a [u8], MapProblem> {
    let missing = |name: &str| damaged(format!("its {name} leads past the end of the file"));
    let mut rest = data;
    for _ in 0..lines.map_or(Ok(0), str::parse::<usize>).map_err(|_| missing("line skip"))? {
        let end = rest.iter().position(|byte| *byte == b'\n').ok_or_else(|| missing("line skip"))?;
        rest = &rest[end + 1..];
    }
    let skipped = match bytes {
        Some("-1") => rest.len().checked_sub(stored.length()?),
        Some(count) if stored.encoding == Encoding::Raw => count.parse().ok(),
        _ => Some(0),
    };
    skipped.and_then(|skipped| rest.get(skipped..)).ok_or_else(|| missing("byte skip"))
}

fn number_type(name: &str) -> Option<NumberType> {
    Some(match name {
        "signed char" | "int8" | "int8_t" => NumberType::I8,
        "uchar" | "unsigned char" | "uint8" | "uint8_t" => NumberType::U8,
        "short" | "short int" | "signed short" | "signed short int" | "int16" | "int16_t" => NumberType::I16,
        "ushort" | "unsigned short" | "unsigned short int" | "uint16" | "uint16_t" => NumberType::U16,
        "int" | "signed int" | "int32" | "int32_t" => NumberType::I32,
        "uint" | "unsigned int" | "uint32" | "uint32_t" => NumberType::U32,
        "longlong" | "long long" | "long long int" | "signed long long" | "int64" | "int64_t" => {
            NumberType::I64
        }
        "ulonglong" | "unsigned long long" | "unsigned long long int" | "uint64" | "uint64_t" => {
            NumberType::U64
        }
        "float" => NumberType::F32,
        "double" => NumberType::F64,
        _ => return None,
    })
}

/// Edges of voxels whose axes are those of space.
fn spacing_of_directions(text: &str) -> Result<DVec3, MapProblem> {
    let directions: Option<Vec<DVec3>> = text.split_inclusive(')').map(vector).collect();
    let directions = directions.ok_or_else(|| damaged("its space directions are not understood"))?;
    let (x, y) = match directions[..] {
        [x, y] | [x, y, _] => (x, y),
        _ => return Err(damaged("its space directions are not two or three")),
    };
    let z = directions.get(2).copied().unwrap_or(DVec3::Z);
    let spacing = DVec3::new(x.x, y.y, z.z);
    let is_straight = [x, y, z] == [DVec3::X * spacing.x, DVec3::Y * spacing.y, DVec3::Z * spacing.z];
    if is_straight && spacing.min_element() > 0.0 {
        return Ok(spacing);
    }
    Err(TURNED_AXES)
}

/// A vector as in `(0.5,0,0)`.
fn vector(text: &str) -> Option<DVec3> {
    let numbers = text.trim().strip_prefix('(')?.strip_suffix(')')?.replace(',', " ");
    of_axes(&numbers, 0.0).map(DVec3::from_array)
}

fn damaged(what: impl Into<String>) -> MapProblem {
    MapProblem::Damaged { format: "NRRD", what: what.into() }
}
