//! PNG: one slice, rows along y from 0 on.

use std::io::Cursor;

use png::{BitDepth, ColorType, Decoder, Limits};

use super::label_map::FileMap;
use super::number_type::{ByteOrder, NumberType};
use super::options::MapOptions;
use super::stored_numbers::{COLORS, Source};
use crate::error::map_file::MapProblem;

/// The most bytes that a byte of deflated data can hold.
const MOST_OF_BYTE: usize = 1032;

/// Reads the labels: shades of grey, or the numbers of colours in a palette.
pub(super) fn read(source: &Source<'_>, _: &MapOptions) -> Result<FileMap, MapProblem> {
    let most = source.bytes.len().saturating_mul(MOST_OF_BYTE);
    let decoder = Decoder::new_with_limits(Cursor::new(source.bytes), Limits { bytes: most });
    let mut reader = decoder.read_info().map_err(unread)?;
    let number_type = match reader.output_color_type() {
        (ColorType::Grayscale | ColorType::Indexed, BitDepth::Eight) => NumberType::U8,
        (ColorType::Grayscale, BitDepth::Sixteen) => NumberType::U16,
        _ => return Err(COLORS),
    };
    let length = reader.output_buffer_size().filter(|length| *length <= most);
    let mut bytes = vec![0; length.ok_or_else(|| damaged("it has more pixels than it can hold"))?];
    let info = reader.next_frame(&mut bytes).map_err(unread)?;
    let shape = [info.width as usize, info.height as usize, 1];
    let labels = number_type.labels(&bytes, ByteOrder::Big)?;
    Ok(FileMap { shape, spacing: None, origin: None, labels })
}

fn unread(error: png::DecodingError) -> MapProblem {
    damaged(format!("it cannot be read: {}", error.to_string().replace('\n', " ")))
}

fn damaged(what: impl Into<String>) -> MapProblem {
    MapProblem::Damaged { format: "PNG", what: what.into() }
}
