//! The numbers of an XML file: as raw bytes at its end, or encoded within their elements; and arrays as other programs encode them.

use std::borrow::Cow;
use std::io::{self, Write};
use std::sync::Arc;

use rayon::prelude::*;

use super::VtkEncoding;

mod encode;

/// Numbers that are computed before they are written; so few that they are still in the cache then.
const BLOCK_NUMBERS: usize = 1 << 17;

/// Numbers that one task computes.
const TASK_NUMBERS: usize = 1 << 13;

/// Makes the bytes of a piece.
pub(super) type MakePiece<'a> = Arc<dyn Fn(usize) -> Vec<u8> + Send + Sync + 'a>;

/// Fills in the bytes of values from a position on.
type Fill<'a> = Arc<dyn Fn(usize, &mut [u8]) + Send + Sync + 'a>;

/// The bytes of one array.
#[derive(Clone)]
pub(crate) enum Numbers<'a> {
    /// Bytes in memory.
    Bytes(Cow<'a, [u8]>),
    /// Bytes computed when they are written.
    Computed {
        /// Number of values.
        count: usize,
        /// Bytes of each.
        width: usize,
        /// Fills in the bytes of values from a position on.
        fill: Fill<'a>,
    },
    /// Bytes made piece by piece when they are written.
    Pieces {
        /// Number of bytes in all.
        byte_count: u64,
        /// Number of pieces.
        count: usize,
        /// Pieces that are made at the same time.
        at_once: usize,
        /// Makes those of a piece.
        make: MakePiece<'a>,
    },
}

impl<'a> Numbers<'a> {
    /// Bytes as they are.
    pub(crate) fn bytes(bytes: Vec<u8>) -> Self {
        Self::Bytes(bytes.into())
    }

    /// Values in memory.
    pub(crate) fn slice<T: bytemuck::NoUninit>(values: &'a [T]) -> Self {
        Self::Bytes(bytemuck::cast_slice(values).into())
    }

    /// Values that follow from their positions.
    pub(crate) fn each<T: bytemuck::NoUninit>(
        count: usize,
        value: impl Fn(usize) -> T + Send + Sync + 'a,
    ) -> Self {
        let width = size_of::<T>();
        let fill = move |first: usize, bytes: &mut [u8]| {
            for (index, place) in bytes.chunks_exact_mut(width).enumerate() {
                place.copy_from_slice(bytemuck::bytes_of(&value(first + index)));
            }
        };
        Self::Computed { count, width, fill: Arc::new(fill) }
    }

    /// Ids that follow from their positions, of 64 bits where `wide` asks for that: where 32 do not hold them.
    #[expect(clippy::cast_possible_truncation, reason = "ids are wide where 32 bits do not hold them")]
    pub(super) fn ids(count: usize, id: impl Fn(usize) -> u64 + Send + Sync + 'a, wide: bool) -> Self {
        if wide { Self::each(count, id) } else { Self::each(count, move |index| id(index) as u32) }
    }

    /// So many bytes, made block by block. Blocks are large, and each is made in parallel.
    pub(super) fn blocks(
        byte_count: usize,
        count: usize,
        make: impl Fn(usize) -> Vec<u8> + Send + Sync + 'a,
    ) -> Self {
        Self::Pieces { byte_count: byte_count as u64, count, at_once: 1, make: Arc::new(make) }
    }

    fn byte_count(&self) -> u64 {
        match self {
            Self::Bytes(bytes) => bytes.len() as u64,
            Self::Computed { count, width, .. } => (count * width) as u64,
            Self::Pieces { byte_count, .. } => *byte_count,
        }
    }

    fn write(&self, out: &mut dyn Write) -> io::Result<()> {
        match self {
            Self::Bytes(bytes) => out.write_all(bytes),
            _ => self.for_each_block(|block| out.write_all(block)),
        }
    }

    /// Writes them big-endian, each of so many bytes.
    pub(crate) fn write_big_endian(&self, bytes_of_each: usize, out: &mut dyn Write) -> io::Result<()> {
        self.for_each_block(|block| {
            if cfg!(target_endian = "little") {
                block
                    .par_chunks_exact_mut(bytes_of_each)
                    .with_min_len(TASK_NUMBERS)
                    .for_each(<[u8]>::reverse);
            }
            out.write_all(block)
        })
    }

    /// Hands out all bytes, in blocks of whole values that may be changed.
    fn for_each_block(&self, mut use_block: impl FnMut(&mut [u8]) -> io::Result<()>) -> io::Result<()> {
        match self {
            Self::Bytes(bytes) => {
                let mut block = Vec::new();
                for bytes in bytes.chunks(BLOCK_NUMBERS * size_of::<f64>()) {
                    block.clear();
                    block.extend_from_slice(bytes);
                    use_block(&mut block)?;
                }
            }
            Self::Computed { count, width, fill } => {
                let mut block = vec![0; BLOCK_NUMBERS.min(*count) * width];
                for first in (0..*count).step_by(BLOCK_NUMBERS) {
                    let bytes = &mut block[..BLOCK_NUMBERS.min(count - first) * width];
                    let tasks = bytes.par_chunks_mut(TASK_NUMBERS * width).enumerate();
                    tasks.for_each(|(task, bytes)| fill(first + task * TASK_NUMBERS, bytes));
                    use_block(bytes)?;
                }
            }
            Self::Pieces { count, at_once, make, .. } => {
                for first in (0..*count).step_by(*at_once) {
                    let pieces = first..(first + at_once).min(*count);
                    let made: Vec<Vec<u8>> = pieces.into_par_iter().map(|piece| make(piece)).collect();
                    made.into_iter().try_for_each(|mut piece| use_block(&mut piece))?;
                }
            }
        }
        Ok(())
    }

    #[cfg(test)]
    pub(super) fn to_vec(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        self.write(&mut bytes).unwrap();
        bytes
    }
}

/// The arrays of a file, in the order in which its document refers to them.
pub(crate) struct NumbersOfFile<'a> {
    encoding: VtkEncoding,
    arrays: Vec<(u64, Numbers<'a>)>,
    next_offset: u64,
}

impl<'a> NumbersOfFile<'a> {
    /// No arrays yet.
    pub(crate) fn new(encoding: VtkEncoding) -> Self {
        Self { encoding, arrays: Vec::new(), next_offset: 0 }
    }

    /// What the head of the file calls its compression.
    pub(crate) fn compressor(&self) -> Option<&'static str> {
        (self.encoding == VtkEncoding::Zlib).then_some("vtkZLibDataCompressor")
    }

    /// Adds an array and returns where its raw bytes will begin, by which the document refers to it.
    pub(crate) fn append(&mut self, numbers: Numbers<'a>) -> u64 {
        let offset = self.next_offset;
        self.next_offset += size_of::<u64>() as u64 + numbers.byte_count();
        self.arrays.push((offset, numbers));
        offset
    }

    /// Writes a file whose document, but for its last tag, refers to the arrays.
    pub(crate) fn write_file(&self, document: impl AsRef<[u8]>, out: &mut dyn Write) -> io::Result<()> {
        let document = str::from_utf8(document.as_ref()).map_err(io::Error::other)?;
        match self.encoding {
            VtkEncoding::Raw => self.write_behind(document, out)?,
            VtkEncoding::Base64 | VtkEncoding::Zlib => self.write_within(document, out)?,
        }
        writeln!(out, "</VTKFile>")
    }

    /// The document, and raw bytes behind it: before each array its number of bytes.
    fn write_behind(&self, document: &str, out: &mut dyn Write) -> io::Result<()> {
        write!(out, "{}\n<AppendedData encoding=\"raw\">\n_", document.trim_end())?;
        for (_, array) in &self.arrays {
            out.write_all(&array.byte_count().to_ne_bytes())?;
            array.write(out)?;
        }
        writeln!(out, "\n</AppendedData>")
    }

    /// The document with each array within the element that refers to it.
    fn write_within(&self, document: &str, out: &mut dyn Write) -> io::Result<()> {
        let mut rest = document;
        while let Some((before, after)) = rest.split_once(REFERENCE) {
            let unknown = || io::Error::other("an element refers to no array");
            let (offset, after) = after.split_once("\"/>").ok_or_else(unknown)?;
            let offset: u64 = offset.parse().map_err(io::Error::other)?;
            let index = self.arrays.binary_search_by_key(&offset, |(offset, _)| *offset);
            let (_, array) = &self.arrays[index.map_err(|_| unknown())?];
            let element = before.rsplit('<').next().and_then(|tag| tag.split(' ').next()).unwrap_or_default();
            write!(out, "{before}format=\"binary\">")?;
            match self.encoding {
                VtkEncoding::Zlib => encode::write_compressed(array, out)?,
                _ => encode::write_base64(array, out)?,
            }
            write!(out, "</{element}>")?;
            rest = after;
        }
        writeln!(out, "{}", rest.trim_end())
    }
}

/// How elements of the document refer to an array, before its offset.
const REFERENCE: &str = "format=\"appended\" offset=\"";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn computed_numbers_are_those_in_memory() {
        for count in [0, 1, TASK_NUMBERS, TASK_NUMBERS + 1, BLOCK_NUMBERS, BLOCK_NUMBERS + 5] {
            let values: Vec<i32> = (0..).take(count).map(|value| value * 7 - 3).collect();
            let computed = Numbers::each(count, |index| values[index]);
            assert!(computed.to_vec() == Numbers::slice(&values).to_vec());
            let big: Vec<u8> = values.iter().flat_map(|value| value.to_be_bytes()).collect();
            for numbers in [computed, Numbers::slice(&values)] {
                let mut written = Vec::new();
                numbers.write_big_endian(4, &mut written).unwrap();
                assert!(written == big);
            }
            let mut numbers = NumbersOfFile::new(VtkEncoding::Raw);
            assert_eq!(numbers.append(Numbers::slice(&values)), 0);
            assert_eq!(numbers.append(Numbers::bytes(vec![])), 8 + 4 * count as u64);
        }
    }
}
