//! Arrays as base64, perhaps compressed, behind a header with their lengths.
//!
//! <https://docs.vtk.org/en/latest/design_documents/VTKFileFormats.html>

use std::io::{self, Write};

use base64::engine::general_purpose::STANDARD;
use base64::write::EncoderWriter;
use flate2::Compression;
use flate2::write::ZlibEncoder;
use rayon::prelude::*;

use super::Numbers;

/// Bytes that are compressed as one: enough to compress well, and few enough for all threads to have some.
const COMPRESSED_BLOCK: usize = 1 << 18;

/// Blocks that are compressed at the same time; bounds the memory of what is not compressed.
const BLOCKS_AT_ONCE: usize = 64;

/// Writes the number of bytes and the bytes as one base64 text.
pub(super) fn write_base64(numbers: &Numbers<'_>, out: &mut dyn Write) -> io::Result<()> {
    let mut encoder = EncoderWriter::new(out, &STANDARD);
    encoder.write_all(&numbers.byte_count().to_ne_bytes())?;
    numbers.write(&mut encoder)?;
    encoder.finish().map(drop)
}

/// Writes the bytes compressed in blocks: one base64 text of the number of blocks, their size, that of the last and what each takes
/// compressed; and one of the blocks.
pub(super) fn write_compressed(numbers: &Numbers<'_>, out: &mut dyn Write) -> io::Result<()> {
    let mut blocks: Vec<Vec<u8>> = Vec::new();
    let mut pending = Vec::new();
    numbers.for_each_block(|bytes| {
        pending.extend_from_slice(bytes);
        if pending.len() >= COMPRESSED_BLOCK * BLOCKS_AT_ONCE {
            let rest = pending.split_off(pending.len() / COMPRESSED_BLOCK * COMPRESSED_BLOCK);
            blocks.extend(compressed(&pending)?);
            pending = rest;
        }
        Ok(())
    })?;
    blocks.extend(compressed(&pending)?);
    let block = COMPRESSED_BLOCK as u64;
    let last = match numbers.byte_count() % block {
        // Readers disagree on what 0 means here: that the last block is full, or empty.
        0 if numbers.byte_count() > 0 => block,
        rest => rest,
    };
    let lengths = blocks.iter().map(|block| block.len() as u64);
    let header = [blocks.len() as u64, block, last].into_iter().chain(lengths);
    let mut encoder = EncoderWriter::new(&mut *out, &STANDARD);
    header.into_iter().try_for_each(|number| encoder.write_all(&number.to_ne_bytes()))?;
    encoder.finish()?;
    drop(encoder);
    let mut encoder = EncoderWriter::new(&mut *out, &STANDARD);
    blocks.iter().try_for_each(|block| encoder.write_all(block))?;
    encoder.finish().map(drop)
}

/// The blocks of some bytes, each compressed.
fn compressed(bytes: &[u8]) -> io::Result<Vec<Vec<u8>>> {
    let compress = |block: &[u8]| {
        // Coordinates compress little, at any effort.
        let mut encoder = ZlibEncoder::new(Vec::new(), Compression::fast());
        encoder.write_all(block)?;
        encoder.finish()
    };
    bytes.par_chunks(COMPRESSED_BLOCK).map(compress).collect()
}
