//! The numbers that a text header describes: after it or in a file beside it, packed or not.

use std::borrow::Cow;
use std::fs;
use std::io::Read;
use std::path::Path;

use flate2::read::{MultiGzDecoder, ZlibDecoder};

use super::number_type::{ByteOrder, NumberType, labels_of_floats};
use crate::error::map_file::MapProblem;

pub(super) const IN_SEVERAL_FILES: MapProblem =
    MapProblem::Unfit { what: "its numbers are in several files", remedy: "save them in one" };

pub(super) const TURNED_AXES: MapProblem =
    MapProblem::Unfit { what: "its axes are turned", remedy: "sample the map again along x, y and z" };

pub(super) const COLORS: MapProblem = MapProblem::Unfit {
    what: "its pixels are colours, or have fewer than 8 bits",
    remedy: "save the labels of grains as shades of grey of 8, 16 or 32 bits",
};

/// A map's file as it is read.
pub(super) struct Source<'a> {
    pub(super) path: &'a Path,
    pub(super) bytes: &'a [u8],
}

impl Source<'_> {
    /// A file that the map names, as seen from the map's folder.
    ///
    /// # Errors
    /// [`MapProblem::DataFile`].
    pub(super) fn beside(&self, name: &str) -> Result<Vec<u8>, MapProblem> {
        let path = self.path.parent().unwrap_or(Path::new("")).join(name);
        fs::read(path).map_err(|error| MapProblem::DataFile { name: name.to_owned(), error })
    }
}

/// How numbers are put into bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Encoding {
    Raw,
    Gzip,
    Zlib,
    Text,
}

/// What a header tells of its numbers.
pub(super) struct StoredNumbers {
    /// Name of the format, for messages.
    pub(super) format: &'static str,
    pub(super) shape: [usize; 3],
    pub(super) number_type: NumberType,
    pub(super) order: ByteOrder,
    pub(super) encoding: Encoding,
}

impl StoredNumbers {
    /// Bytes of all numbers.
    ///
    /// # Errors
    /// [`MapProblem::Damaged`] where no computer has as many.
    pub(super) fn length(&self) -> Result<usize, MapProblem> {
        let length =
            self.shape.iter().try_fold(self.number_type.width(), |all, count| all.checked_mul(*count));
        length.ok_or_else(|| self.damaged("the voxels of its header are too many for any file".to_owned()))
    }

    /// The labels, as many as the header tells. More bytes may follow.
    ///
    /// Never takes more memory than the numbers that are there: what a header tells beyond them is refused.
    ///
    /// # Errors
    /// [`MapProblem::Damaged`] with fewer numbers than the header tells, [`MapProblem::NotWhole`].
    pub(super) fn labels(&self, bytes: &[u8]) -> Result<Vec<i32>, MapProblem> {
        let length = self.length()?;
        let unpacked: Cow<'_, [u8]> = match self.encoding {
            Encoding::Text => return self.labels_of_text(bytes),
            Encoding::Raw => bytes.into(),
            Encoding::Gzip => self.unpacked(MultiGzDecoder::new(bytes), length)?.into(),
            Encoding::Zlib => self.unpacked(ZlibDecoder::new(bytes), length)?.into(),
        };
        let numbers = unpacked.get(..length).ok_or_else(|| {
            let found = unpacked.len() / self.number_type.width();
            self.few(found)
        })?;
        self.number_type.labels(numbers, self.order)
    }

    fn unpacked(&self, packed: impl Read, length: usize) -> Result<Vec<u8>, MapProblem> {
        let mut bytes = Vec::new();
        // One more than needed, as the checksum stands behind the last.
        let read = packed.take((length as u64).saturating_add(1)).read_to_end(&mut bytes);
        read.map_err(|error| self.damaged(format!("its compressed numbers are damaged: {error}")))?;
        Ok(bytes)
    }

    fn labels_of_text(&self, bytes: &[u8]) -> Result<Vec<i32>, MapProblem> {
        let count = self.length()? / self.number_type.width();
        let text = String::from_utf8_lossy(bytes);
        let mut numbers = Vec::new();
        for word in text.split_whitespace().take(count) {
            let number = word.parse::<f64>();
            numbers.push(
                number.map_err(|_| self.damaged(format!("`{word}` among its labels is not a number")))?,
            );
        }
        if numbers.len() < count {
            return Err(self.few(numbers.len()));
        }
        labels_of_floats(numbers.into_iter())
    }

    fn few(&self, found: usize) -> MapProblem {
        let [nx, ny, nz] = self.shape;
        self.damaged(format!("it has {found} numbers for {nx} x {ny} x {nz} voxels"))
    }

    fn damaged(&self, what: String) -> MapProblem {
        MapProblem::Damaged { format: self.format, what }
    }
}

/// Two or three numbers, one for each axis; in the plane the third is the one given.
pub(super) fn of_axes<T: std::str::FromStr>(text: &str, third: T) -> Option<[T; 3]> {
    let words: Vec<&str> = text.split_whitespace().collect();
    let number = |axis: usize| words.get(axis)?.parse().ok();
    let third = match words.len() {
        2 => third,
        3 => number(2)?,
        _ => return None,
    };
    Some([number(0)?, number(1)?, third])
}
