//! NumPy's array file, versions 1 to 3.
//!
//! <https://numpy.org/doc/stable/reference/generated/numpy.lib.format.html>

use super::label_map::FileMap;
use super::number_type::{ByteOrder, NumberType};
use super::options::{Axes, MapOptions};
use super::stored_numbers::Source;
use crate::error::map_file::MapProblem;

/// Reads the labels; more bytes than the array takes may follow.
pub(super) fn read(source: &Source<'_>, options: &MapOptions) -> Result<FileMap, MapProblem> {
    let (header, numbers) = split(source.bytes).ok_or_else(|| damaged("its header is cut off"))?;
    let array = Array::of_header(&header)?;
    let shape = match (&array.shape[..], options.axes.unwrap_or(Axes::Xyz)) {
        (&[x, y], Axes::Xyz) | (&[y, x], Axes::Zyx) => [x, y, 1],
        (&[x, y, z], Axes::Xyz) | (&[z, y, x], Axes::Zyx) => [x, y, z],
        (indices, _) => return Err(MapProblem::Indices { count: indices.len() }),
    };
    let needed = array.shape.iter().try_fold(array.number_type.width(), |all, count| all.checked_mul(*count));
    let numbers = needed.and_then(|needed| numbers.get(..needed));
    let numbers = numbers.ok_or_else(|| {
        damaged(format!("it has too few bytes for {:?} numbers of {}", array.shape, array.number_type))
    })?;
    let labels = array.number_type.labels(numbers, array.order)?;
    let is_x_fastest = array.is_first_fastest == (options.axes.unwrap_or(Axes::Xyz) == Axes::Xyz);
    let labels = if is_x_fastest { labels } else { with_x_fastest(&labels, shape) };
    Ok(FileMap { shape, spacing: None, origin: None, labels })
}

/// What a header tells.
struct Array {
    number_type: NumberType,
    order: ByteOrder,
    is_first_fastest: bool,
    shape: Vec<usize>,
}

impl Array {
    fn of_header(header: &str) -> Result<Self, MapProblem> {
        let unknown = |key: &str| damaged(format!("its header has no {key} that is understood"));
        let value = |key: &str| {
            let (_, rest) = header.split_once(&format!("'{key}'"))?;
            Some(rest.split_once(':')?.1.trim_start())
        };
        let descr = value("descr").and_then(|rest| rest.strip_prefix('\'')?.split('\'').next());
        let descr = descr.ok_or_else(|| unknown("descr"))?;
        let (order, name) = descr.split_at_checked(1).ok_or_else(|| unknown("descr"))?;
        let number_type = match name {
            "u1" | "b1" => NumberType::U8,
            "i1" => NumberType::I8,
            "u2" => NumberType::U16,
            "i2" => NumberType::I16,
            "u4" => NumberType::U32,
            "i4" => NumberType::I32,
            "u8" => NumberType::U64,
            "i8" => NumberType::I64,
            "f4" => NumberType::F32,
            "f8" => NumberType::F64,
            _ => return Err(damaged(format!("its numbers are `{descr}`, no whole or floating point ones"))),
        };
        let shape = value("shape").and_then(|rest| rest.strip_prefix('(')?.split(')').next());
        let counts = shape.map(|text| text.split(',').map(str::trim).filter(|count| !count.is_empty()));
        let shape = counts.and_then(|counts| counts.map(|count| count.parse().ok()).collect::<Option<_>>());
        Ok(Self {
            number_type,
            order: if order == ">" { ByteOrder::Big } else { ByteOrder::Little },
            is_first_fastest: value("fortran_order")
                .ok_or_else(|| unknown("fortran_order"))?
                .starts_with("True"),
            shape: shape.ok_or_else(|| unknown("shape"))?,
        })
    }
}

/// The header and what follows.
fn split(bytes: &[u8]) -> Option<(String, &[u8])> {
    let rest = bytes.strip_prefix(b"\x93NUMPY")?;
    let (version, rest) = rest.split_at_checked(2)?;
    let width = if version[0] == 1 { 2 } else { 4 };
    let (length, rest) = rest.split_at_checked(width)?;
    let length = length.iter().rev().fold(0, |length, byte| length << 8 | usize::from(*byte));
    let (header, numbers) = rest.split_at_checked(length)?;
    Some((String::from_utf8_lossy(header).into_owned(), numbers))
}

/// Labels that stand z fastest.
fn with_x_fastest(labels: &[i32], [nx, ny, nz]: [usize; 3]) -> Vec<i32> {
    let place = move |z: usize, y: usize, x: usize| (x * ny + y) * nz + z;
    let rows = (0..nz).flat_map(|z| (0..ny).map(move |y| (z, y)));
    rows.flat_map(|(z, y)| (0..nx).map(move |x| labels[place(z, y, x)])).collect()
}

fn damaged(what: impl Into<String>) -> MapProblem {
    MapProblem::Damaged { format: "NumPy", what: what.into() }
}
