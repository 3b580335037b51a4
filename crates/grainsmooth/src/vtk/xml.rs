//! The XML formats .vtp and .vtu.
//!
//! `vtkio` writes the document; its numbers follow in one base64 `AppendedData` element, encoded in parallel
//! straight from our arrays. The conversion from [`vtkio::Vtk`] would hold every number inline, widen ids to
//! 64 bits, drop field data, and take eight times as long.

use std::borrow::Cow;
use std::io::{self, Write};

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use rayon::prelude::*;

use super::PolyData;
use document::Document;

mod document;

/// Bytes of numbers that are encoded before they are written; bounds the memory that the text takes.
const BLOCK_BYTES: usize = 12 << 20;

/// Bytes of numbers that one task encodes; a multiple of three, so that its text needs no padding.
const TASK_BYTES: usize = 3 << 16;

/// Which of the XML formats.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum XmlFormat {
    /// .vtp
    PolyData,
    /// .vtu
    UnstructuredGrid,
}

/// Writes the file.
pub(super) fn write(data: &PolyData<'_>, format: XmlFormat, out: &mut dyn Write) -> io::Result<()> {
    let mut numbers = AppendedNumbers::default();
    let document = Document::new(data, format, &mut numbers);
    let document = vtkio::xml::se::to_string(&document).map_err(io::Error::other)?;
    let (head, closing_tag) = document.split_at(document.len() - "</VTKFile>".len());
    write!(out, "{head}\n<AppendedData encoding=\"base64\">\n_")?;
    for array in &numbers.arrays {
        write_base64(array, out)?;
    }
    writeln!(out, "\n</AppendedData>\n{closing_tag}")
}

/// The bytes of the file's arrays, in the order of the file.
#[derive(Default)]
struct AppendedNumbers<'a> {
    arrays: Vec<Cow<'a, [u8]>>,
    next_offset: u64,
}

impl<'a> AppendedNumbers<'a> {
    /// Adds an array and returns where its text will begin.
    fn append(&mut self, bytes: impl Into<Cow<'a, [u8]>>) -> u64 {
        let bytes = bytes.into();
        let offset = self.next_offset;
        self.next_offset += (size_of::<u64>() as u64 + bytes.len() as u64).div_ceil(3) * 4;
        self.arrays.push(bytes);
        offset
    }
}

/// Writes the number of bytes and then the bytes, as one base64 text.
fn write_base64(bytes: &[u8], out: &mut dyn Write) -> io::Result<()> {
    // The first byte joins the eight of the count, so that the rest begins between two base64 groups.
    let (first, rest) = bytes.split_at(bytes.len().min(1));
    let mut start = (bytes.len() as u64).to_ne_bytes().to_vec();
    start.extend_from_slice(first);
    out.write_all(STANDARD.encode(&start).as_bytes())?;

    let mut text = Vec::new();
    for block in rest.chunks(BLOCK_BYTES) {
        text.resize(block.len().div_ceil(3) * 4, 0);
        text.par_chunks_mut(TASK_BYTES / 3 * 4)
            .zip(block.par_chunks(TASK_BYTES))
            .try_for_each(|(text, bytes)| STANDARD.encode_slice(bytes, text).map(drop))
            .map_err(io::Error::other)?;
        out.write_all(&text)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_is_the_same_as_encoded_in_one_piece() {
        for length in
            [0, 1, 2, 3, 4, TASK_BYTES, TASK_BYTES + 1, TASK_BYTES + 2, BLOCK_BYTES, BLOCK_BYTES + 5]
        {
            let bytes: Vec<u8> = (0..length).map(|i| (i % 251).to_le_bytes()[0]).collect();
            let mut text = Vec::new();
            write_base64(&bytes, &mut text).unwrap();

            let whole = [&(length as u64).to_ne_bytes()[..], &bytes].concat();
            assert!(STANDARD.encode(&whole).as_bytes() == text, "{length} bytes");

            let mut numbers = AppendedNumbers::default();
            numbers.append(bytes);
            assert_eq!(numbers.next_offset, text.len() as u64);
        }
    }
}
