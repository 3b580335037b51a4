//! A folder of numbered images, one for each slice along z.

use std::fs;
use std::path::{Path, PathBuf};

use super::label_map::FileMap;
use super::options::MapOptions;
use super::stored_numbers::Source;
use super::{png, tiff};
use crate::error::map_file::MapProblem;

/// Reads the images of a folder in the order of the last numbers in their names.
///
/// # Errors
/// [`MapProblem`] where there are none, where they are of two kinds or differ in size, or one cannot be read.
pub(super) fn read(folder: &Path, options: &MapOptions) -> Result<FileMap, MapProblem> {
    let mut tiffs = Vec::new();
    let mut pngs = Vec::new();
    for entry in fs::read_dir(folder).map_err(MapProblem::Unreadable)? {
        let path = entry.map_err(MapProblem::Unreadable)?.path();
        match path.extension().unwrap_or_default().to_ascii_lowercase().to_str() {
            Some("tif" | "tiff") => tiffs.push(path),
            Some("png") => pngs.push(path),
            _ => {}
        }
    }
    match (tiffs.is_empty(), pngs.is_empty()) {
        (false, true) => stacked(tiffs, tiff::read, options),
        (true, false) => stacked(pngs, png::read, options),
        (true, true) => Err(MapProblem::Unfit {
            what: "is a folder without images",
            remedy: "give one that holds the slices of a map, each a .tif or .png file",
        }),
        (false, false) => Err(MapProblem::Unfit {
            what: "is a folder with .tif and .png images",
            remedy: "leave only the slices of the map there",
        }),
    }
}

fn stacked(
    mut paths: Vec<PathBuf>,
    read: fn(&Source<'_>, &MapOptions) -> Result<FileMap, MapProblem>,
    options: &MapOptions,
) -> Result<FileMap, MapProblem> {
    let name = |path: &Path| path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    paths.sort_by_cached_key(|path| {
        let name = name(path);
        (last_number(&name), name)
    });
    let mut stack: Option<FileMap> = None;
    for path in paths {
        let of_slice = |problem| MapProblem::Slice { name: name(&path), problem: Box::new(problem) };
        let bytes = fs::read(&path).map_err(|error| of_slice(MapProblem::Unreadable(error)))?;
        let slice = read(&Source { path: &path, bytes: &bytes }, options).map_err(of_slice)?;
        let stack = match &mut stack {
            None => {
                stack = Some(slice);
                continue;
            }
            Some(stack) => stack,
        };
        if slice.shape[..2] != stack.shape[..2] {
            return Err(MapProblem::SliceSize {
                name: name(&path),
                size: [slice.shape[0], slice.shape[1]],
                first: [stack.shape[0], stack.shape[1]],
            });
        }
        stack.shape[2] += slice.shape[2];
        stack.labels.extend(slice.labels);
    }
    stack.ok_or(MapProblem::NoLabels)
}

/// The last number in a name; before all others where there is none.
fn last_number(name: &str) -> Option<u64> {
    let stem = name.rsplit_once('.').map_or(name, |(stem, _)| stem);
    let end = stem.rfind(|character: char| character.is_ascii_digit())? + 1;
    let start = end - stem[..end].bytes().rev().take_while(u8::is_ascii_digit).count();
    // A longer one than any count of slices sorts by the name alone.
    stem[start..end].parse().ok()
}

#[cfg(test)]
mod tests {
    use super::last_number;

    #[test]
    fn slices_are_in_the_order_of_their_last_numbers() {
        for (name, number) in [
            ("slice_10.tif", Some(10)),
            ("2024-scan7_0009.png", Some(9)),
            ("7.tif", Some(7)),
            ("z3_labels.tif", Some(3)),
            ("scheibe\u{e4}12\u{fc}.tif", Some(12)),
            ("labels.tif", None),
        ] {
            assert_eq!(last_number(name), number, "{name}");
        }
    }
}
