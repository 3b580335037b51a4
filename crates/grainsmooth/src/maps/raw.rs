//! Numbers alone, x fastest, little-endian.

use super::label_map::FileMap;
use super::number_type::ByteOrder;
use super::options::MapOptions;
use super::stored_numbers::Source;
use crate::error::map_file::MapProblem;

/// Reads the labels, of which options tell the shape and the type.
pub(super) fn read(source: &Source<'_>, options: &MapOptions) -> Result<FileMap, MapProblem> {
    let (Some(counts), Some(number_type)) = (&options.shape, options.number_type) else {
        return Err(MapProblem::NumbersAlone);
    };
    let count = |axis: usize| counts.get(axis).map_or(1, |count| *count as usize);
    let shape = [0, 1, 2].map(count);
    let width = number_type.width();
    let expected = shape.iter().map(|count| *count as u128).product::<u128>() * width as u128;
    if expected != source.bytes.len() as u128 {
        let voxels = shape.iter().fold(1, |all: usize, count| all.saturating_mul(*count));
        return Err(MapProblem::Length { bytes: source.bytes.len(), voxels, width, expected });
    }
    let labels = number_type.labels(source.bytes, ByteOrder::Little)?;
    Ok(FileMap { shape, spacing: None, origin: None, labels })
}
