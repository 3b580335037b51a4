//! A folder of numbered slices: images one above the other along z, or sections with orientations.

use std::fs;
use std::path::{Path, PathBuf};

use rayon::prelude::*;

use super::label_map::{FileMap, MapContent};
use super::options::MapOptions;
use super::orientation_map::{Fault, PointList, ang, ctf};
use super::stored_numbers::Source;
use super::{png, tiff};
use crate::error::map_file::MapProblem;

/// What reads a slice of a kind.
#[derive(Clone, Copy)]
enum Kind {
    Image(fn(&Source<'_>, &MapOptions) -> Result<FileMap, MapProblem>),
    Orientations(fn(&str) -> Result<PointList, Fault>),
}

/// Extensions of slices, the first of each kind's the name of the kind.
const KINDS: [(&[&str], Kind); 4] = [
    (&["tif", "tiff"], Kind::Image(tiff::read)),
    (&["png"], Kind::Image(png::read)),
    (&["ang"], Kind::Orientations(ang::read)),
    (&["ctf"], Kind::Orientations(ctf::read)),
];

/// Reads the slices of a folder in the order of the last numbers in their names: images of labels, or sections with orientations.
///
/// # Errors
/// [`MapProblem`] where there are none, where they are of two kinds or differ in size, or one cannot be read.
pub(super) fn read(folder: &Path, options: &MapOptions) -> Result<MapContent, MapProblem> {
    let mut paths = vec![Vec::new(); KINDS.len()];
    for entry in fs::read_dir(folder).map_err(MapProblem::Unreadable)? {
        let path = entry.map_err(MapProblem::Unreadable)?.path();
        let extension = path.extension().unwrap_or_default().to_ascii_lowercase();
        let kind = KINDS.iter().position(|(known, _)| known.iter().any(|known| extension == *known));
        if let Some(kind) = kind {
            paths[kind].push(path);
        }
    }
    let mut found = paths.into_iter().zip(KINDS).filter(|(paths, _)| !paths.is_empty());
    match (found.next(), found.next()) {
        (Some((paths, (_, Kind::Image(read)))), None) => {
            stacked(in_order(paths), read, options).map(MapContent::Labels)
        }
        (Some((paths, (_, Kind::Orientations(read)))), None) => {
            sections(&in_order(paths), read).map(MapContent::Points)
        }
        (None, _) => Err(MapProblem::Unfit {
            what: "is a folder without slices",
            remedy: "give one that holds the slices of a map, each a .tif, .png, .ang or .ctf file",
        }),
        (Some(_), Some(_)) => Err(MapProblem::Unfit {
            what: "is a folder with slices of two kinds",
            remedy: "leave only the slices of the map there, all .tif, .png, .ang or .ctf",
        }),
    }
}

fn name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

fn in_order(mut paths: Vec<PathBuf>) -> Vec<PathBuf> {
    paths.sort_by_cached_key(|path| (last_number(&name(path)), name(path)));
    paths
}

/// Sections with orientations, of which the first is the uppermost.
fn sections(paths: &[PathBuf], read: fn(&str) -> Result<PointList, Fault>) -> Result<PointList, MapProblem> {
    let section = |path: &PathBuf| {
        let of_slice = |problem| MapProblem::Slice { name: name(path), problem: Box::new(problem) };
        let bytes = fs::read(path).map_err(|error| of_slice(MapProblem::Unreadable(error)))?;
        let found = read(&String::from_utf8_lossy(&bytes));
        found.map(|list| (name(path), list)).map_err(|(line, what)| of_slice(MapProblem::Line { line, what }))
    };
    let found = paths.par_iter().map(section).collect::<Result<Vec<_>, MapProblem>>()?;
    PointList::of_sections(found, None)
}

fn stacked(
    paths: Vec<PathBuf>,
    read: fn(&Source<'_>, &MapOptions) -> Result<FileMap, MapProblem>,
    options: &MapOptions,
) -> Result<FileMap, MapProblem> {
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

/// The last number in the name of a file; before all others where there is none.
pub(crate) fn last_number(name: &str) -> Option<u64> {
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
