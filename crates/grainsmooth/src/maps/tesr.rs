//! Neper's raster tessellation, 2.0 to 2.2.
//!
//! <https://neper.info/doc/fileformat.html#raster-tessellation-file-tesr>

use std::borrow::Cow;

use glam::DVec3;

use super::cleaning::NO_GRAIN;
use super::label_map::FileMap;
use super::number_type::{ByteOrder, NumberType};
use super::options::MapOptions;
use super::stored_numbers::{Encoding, Source, StoredNumbers, of_axes};
use crate::error::map_file::MapProblem;

/// Reads the labels: the cells' own numbers, where the file lists them. Cell 0 is what is no grain.
pub(super) fn read(source: &Source<'_>, _: &MapOptions) -> Result<FileMap, MapProblem> {
    let mark = b"**data";
    let place = source.bytes.windows(mark.len()).position(|window| window == mark);
    let (head, data) = source.bytes.split_at(place.ok_or_else(|| damaged("it has no **data"))?);
    let head = String::from_utf8_lossy(head);
    let words: Vec<&str> = head.split_whitespace().collect();
    if words.first() != Some(&"***tesr") {
        return Err(damaged("it does not start with ***tesr"));
    }
    let missing = |name: &str| damaged(format!("its head has no {name} that is understood"));
    let after = |name: &str| {
        let place = words.iter().position(|word| *word == name)?;
        words.get(place + 1..)
    };
    let general = after("**general").ok_or_else(|| missing("**general"))?;
    let dimension = general.first().and_then(|word| word.parse().ok());
    let dimension = dimension.filter(|dimension| (2..=3).contains(dimension));
    let dimension: usize = dimension.ok_or_else(|| missing("dimension"))?;
    let vector = |words: Option<&[&str]>| words.map(|words| words.join(" "));
    let sizes = vector(general.get(1..=dimension));
    let shape = sizes.and_then(|text| of_axes(&text, 1)).ok_or_else(|| missing("number of voxels"))?;
    let spacing = vector(general.get(1 + dimension..=2 * dimension));
    let spacing = spacing.and_then(|text| of_axes(&text, 1.0)).ok_or_else(|| missing("size of voxels"))?;
    let origin = after("*origin").and_then(|words| vector(words.get(..dimension)));
    let origin = origin.and_then(|text| of_axes(&text, 0.0)).map(DVec3::from_array);

    let (kind, data) = word(&data[mark.len()..]);
    let (number_type, order) = match kind {
        b"ascii" => (NumberType::I32, ByteOrder::Little),
        b"binary8" => (NumberType::U8, ByteOrder::Little),
        b"binary16" => (NumberType::I16, ByteOrder::Little),
        b"binary16_big" => (NumberType::I16, ByteOrder::Big),
        b"binary32" => (NumberType::I32, ByteOrder::Little),
        b"binary32_big" => (NumberType::I32, ByteOrder::Big),
        _ => return Err(damaged("the kind of its **data is not known")),
    };
    let encoding = if kind == b"ascii" { Encoding::Text } else { Encoding::Raw };
    let stored = StoredNumbers { format: ".tesr", shape, number_type, order, encoding };
    let data = match word(data) {
        (b"*file", rest) => {
            let name = word(rest).0;
            source.beside(&String::from_utf8_lossy(name))?.into()
        }
        // Numbers start behind the end of the line.
        _ => Cow::Borrowed(data.strip_prefix(b"\r").unwrap_or(data).get(1..).unwrap_or_default()),
    };
    let mut labels = stored.labels(&data)?;
    let ids = after("*id").map(|words| words.iter().map_while(|word| word.parse().ok()).collect());
    own_numbers(&mut labels, ids)?;
    Ok(FileMap { shape, spacing: Some(DVec3::from_array(spacing)), origin, labels })
}

/// Turns numbers of cells, from 1, into the numbers that the file lists for them.
fn own_numbers(labels: &mut [i32], ids: Option<Vec<i32>>) -> Result<(), MapProblem> {
    for label in labels {
        *label = match (usize::try_from(*label), &ids) {
            (Err(_) | Ok(0), _) => NO_GRAIN,
            (Ok(_), None) => *label,
            (Ok(cell), Some(ids)) => *ids.get(cell - 1).ok_or_else(|| {
                damaged(format!("a voxel lies in cell {cell}, and its list of cells has {}", ids.len()))
            })?,
        };
    }
    Ok(())
}

/// The next word, and what stands behind it.
fn word(bytes: &[u8]) -> (&[u8], &[u8]) {
    let bytes = bytes.trim_ascii_start();
    let end = bytes.iter().position(u8::is_ascii_whitespace).unwrap_or(bytes.len());
    bytes.split_at(end)
}

fn damaged(what: impl Into<String>) -> MapProblem {
    MapProblem::Damaged { format: ".tesr", what: what.into() }
}
