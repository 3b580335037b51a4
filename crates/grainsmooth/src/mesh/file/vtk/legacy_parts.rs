//! A legacy file put so that `vtkio` can read it.

use memchr::memmem;

use super::MeshFileProblem;
use super::field::field_data;
use super::labelled::Notes;

/// Types of arrays that newer versions of VTK write, and older names of the same that `vtkio` knows.
const TYPES: [(&str, &str); 9] = [
    ("signed_char", "char"),
    ("vtktypeint8", "char"),
    ("vtktypeuint8", "unsigned_char"),
    ("vtktypeint16", "short"),
    ("vtktypeuint16", "unsigned_short"),
    ("vtktypeint32", "int"),
    ("vtktypeuint32", "unsigned_int"),
    ("vtktypeint64", "long"),
    ("vtktypeuint64", "unsigned_long"),
];

/// What a text has instead of a number that is none.
const NO_NUMBERS: [&[u8]; 4] = [b"nan", b"-nan", b"inf", b"-inf"];

/// What stands for it.
const BEYOND: &[u8] = b"1e300 ";

/// The file without field data at its head and with what `vtkio` understands in place of newer types of arrays and, in the arrays of a
/// text, of what is no number; and what the field data say.
///
/// Refuses a text with coordinates that are no numbers, by their point.
pub(super) fn readable(bytes: &[u8]) -> Result<(Vec<u8>, Notes), MeshFileProblem> {
    let (field, notes) = field_data(bytes).unwrap_or_default();
    let bytes = [&bytes[..field.start], &bytes[field.end..]].concat();
    let arrays = ["\nPOINT_DATA ", "\nCELL_DATA "];
    let starts = arrays.into_iter().filter_map(|head| memmem::find(&bytes, head.as_bytes()));
    let (geometry, arrays) = bytes.split_at(starts.min().unwrap_or(bytes.len()));
    let geometry = with_wide_cells(geometry);
    let geometry = geometry.as_slice();
    let arrays = with_known_types(arrays);
    let is_text = geometry.split(|byte| *byte == b'\n').nth(2).is_some_and(|line| line.starts_with(b"ASCII"));
    if !is_text {
        return Ok(([geometry, &arrays].concat(), notes));
    }
    check_coordinates(geometry)?;
    Ok(([geometry, &with_numbers_only(&arrays)].concat(), notes))
}

/// The points and cells with 64-bit numbers of points, which alone `vtkio` knows, where VTK wrote 32-bit ones: `OFFSETS int`.
fn with_wide_cells(geometry: &[u8]) -> Vec<u8> {
    let mut wide = geometry.to_vec();
    for (name, place) in [("OFFSETS", 0), ("CONNECTIVITY", 1)] {
        for kind in ["int", "vtktypeint32"] {
            let head = format!("\n{name} {kind}\n");
            let mut done = 0;
            while let Some(found) = memmem::find(&wide[done..], head.as_bytes()) {
                let start = done + found;
                done = start + head.len();
                let Some(count) = count_of_cells(&wide[..start], place) else { break };
                let end = done.saturating_add(count.saturating_mul(size_of::<i32>()));
                let is_text =
                    wide.split(|byte| *byte == b'\n').nth(2).is_some_and(|line| line.starts_with(b"ASCII"));
                let Some(numbers) = wide.get(done..if is_text { done } else { end }) else { break };
                let numbers =
                    numbers.as_chunks().0.iter().map(|number| i64::from(i32::from_be_bytes(*number)));
                let numbers: Vec<u8> = numbers.flat_map(i64::to_be_bytes).collect();
                let head = format!("\n{name} vtktypeint64\n");
                let next = start + head.len() + numbers.len();
                let end = if is_text { done } else { end };
                wide.splice(start..end, head.into_bytes().into_iter().chain(numbers));
                done = next;
            }
        }
    }
    wide
}

/// One of the two numbers after the last name of a kind of cells, as in `POLYGONS 1059 3174`: of offsets and of points.
fn count_of_cells(before: &[u8], place: usize) -> Option<usize> {
    let names = ["\nPOLYGONS ", "\nLINES ", "\nVERTICES ", "\nTRIANGLE_STRIPS ", "\nCELLS "];
    let last =
        |name: &str| Some((before.windows(name.len()).rposition(|at| at == name.as_bytes())?, name.len()));
    let (start, length) = names.into_iter().filter_map(last).max()?;
    let line = before[start + length..].split(|byte| *byte == b'\n').next()?;
    str::from_utf8(line).ok()?.split_whitespace().nth(place)?.parse().ok()
}

/// Looks for coordinates of a text that are no numbers.
fn check_coordinates(geometry: &[u8]) -> Result<(), MeshFileProblem> {
    const HEAD: &[u8] = b"\nPOINTS ";
    let Some(start) = memmem::find(geometry, HEAD) else { return Ok(()) };
    let words = geometry[start + HEAD.len()..].split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
    // The number of points and the type of coordinates come first.
    match words.skip(2).enumerate().find(|(_, word)| NO_NUMBERS.contains(word)) {
        Some((place, word)) => {
            let word = String::from_utf8_lossy(word);
            Err(super::problem(format!("point {} has the coordinate {word}", place / 3)))
        }
        None => Ok(()),
    }
}

/// The arrays with older names of types: `NodeTypes 1 987 signed_char` becomes `NodeTypes 1 987 char`.
fn with_known_types(arrays: &[u8]) -> Vec<u8> {
    let mut known = Vec::with_capacity(arrays.len());
    let mut done = 0;
    for (blank, _) in arrays.iter().enumerate().filter(|(_, byte)| **byte == b' ') {
        let after = &arrays[blank + 1..];
        let is_it = |name: &str| {
            let rest = after.strip_prefix(name.as_bytes());
            rest.is_some_and(|rest| rest.first().is_some_and(u8::is_ascii_whitespace))
        };
        if let Some((newer, older)) = TYPES.iter().find(|(newer, _)| is_it(newer)) {
            known.extend_from_slice(&arrays[done..=blank]);
            known.extend_from_slice(older.as_bytes());
            done = blank + 1 + newer.len();
        }
    }
    known.extend_from_slice(&arrays[done..]);
    known
}

/// The text of arrays with a number beyond all labels for what is none.
fn with_numbers_only(arrays: &[u8]) -> Vec<u8> {
    let mut numbers = Vec::with_capacity(arrays.len());
    for word in arrays.split_inclusive(u8::is_ascii_whitespace) {
        let is_none = NO_NUMBERS.contains(&word.trim_ascii_end());
        numbers.extend_from_slice(if is_none { BEYOND } else { word });
    }
    numbers
}
