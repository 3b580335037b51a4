//! NumPy's archive of arrays: a zip file of `.npy`.
//!
//! <https://pkware.cachefly.net/webdocs/casestudies/APPNOTE.TXT>

use std::borrow::Cow;
use std::io::Read;

use flate2::read::DeflateDecoder;

use super::label_map::{FileMap, USUAL_NAMES};
use super::npy;
use super::options::MapOptions;
use super::stored_numbers::Source;
use crate::error::map_file::MapProblem;

/// Reads the labels: those of the array asked for, else of the only one, or the only one with a usual name.
pub(super) fn read(source: &Source<'_>, options: &MapOptions) -> Result<FileMap, MapProblem> {
    let mut found = Entry::all(source.bytes).ok_or_else(|| damaged("the list of its arrays is damaged"))?;
    let known = |entries: &[Entry<'_>]| {
        entries.iter().map(|entry| entry.array.as_str()).collect::<Vec<_>>().join(", ")
    };
    if let Some(name) = &options.label_array {
        let all = known(&found);
        found.retain(|entry| entry.array == *name);
        if found.is_empty() && !all.is_empty() {
            return Err(MapProblem::NoSuchArray { name: name.clone(), known: all });
        }
    } else if found.len() > 1 {
        let is_usual =
            |entry: &Entry<'_>| USUAL_NAMES.iter().any(|name| name.eq_ignore_ascii_case(&entry.array));
        if found.iter().any(is_usual) {
            found.retain(is_usual);
        }
    }
    match &found[..] {
        [] => Err(MapProblem::NoLabels),
        [entry] => npy::read(&Source { path: source.path, bytes: &entry.unpacked()? }, options),
        _ => Err(MapProblem::SeveralArrays { known: known(&found) }),
    }
}

/// An array in an archive.
struct Entry<'a> {
    /// Its name, without `.npy`.
    array: String,
    is_deflated: bool,
    packed: &'a [u8],
    /// As the archive tells.
    unpacked_length: usize,
}

impl<'a> Entry<'a> {
    /// The arrays that the directory at the end of an archive lists; nothing where that is damaged.
    fn all(bytes: &'a [u8]) -> Option<Vec<Self>> {
        let end = bytes.windows(4).rposition(|window| window == b"PK\x05\x06")?;
        let count = number(bytes, end + 10, 2)?;
        let mut at = number(bytes, end + 16, 4)?;
        let mut entries = Vec::new();
        for _ in 0..count {
            if bytes.get(at..at + 4)? != b"PK\x01\x02" {
                return None;
            }
            let [method, length, unpacked_length, name, extra, comment, head] =
                [(10, 2), (20, 4), (24, 4), (28, 2), (30, 2), (32, 2), (42, 4)]
                    .map(|(off, width)| number(bytes, at + off, width));
            let named = bytes.get(at + 46..at + 46 + name?)?;
            // The head of the array's own bytes has a name and an extra field of other length.
            let head = head?;
            let [own_name, own_extra] = [26, 28].map(|off| number(bytes, head + off, 2));
            let start = head + 30 + own_name? + own_extra?;
            let packed = bytes.get(start..start + length?)?;
            let named = String::from_utf8_lossy(named);
            if let Some(array) = named.strip_suffix(".npy") {
                let is_deflated = match method? {
                    0 => false,
                    8 => true,
                    _ => return None,
                };
                entries.push(Self {
                    array: array.to_owned(),
                    is_deflated,
                    packed,
                    unpacked_length: unpacked_length?,
                });
            }
            at = at + 46 + name? + extra? + comment?;
        }
        Some(entries)
    }

    /// The bytes of the array.
    ///
    /// # Errors
    /// [`MapProblem::Damaged`].
    fn unpacked(&self) -> Result<Cow<'a, [u8]>, MapProblem> {
        if !self.is_deflated {
            return Ok(Cow::Borrowed(self.packed));
        }
        let mut bytes = Vec::new();
        let read = DeflateDecoder::new(self.packed).take(self.unpacked_length as u64).read_to_end(&mut bytes);
        read.map_err(|error| damaged(format!("its compressed numbers are damaged: {error}")))?;
        Ok(Cow::Owned(bytes))
    }
}

/// A little-endian number of four bytes at most; nothing beyond the end.
fn number(bytes: &[u8], at: usize, width: usize) -> Option<usize> {
    let bytes = bytes.get(at..at + width)?;
    Some(bytes.iter().rev().fold(0, |number, byte| number << 8 | usize::from(*byte)))
}

fn damaged(what: impl Into<String>) -> MapProblem {
    MapProblem::Damaged { format: "NumPy", what: what.into() }
}
