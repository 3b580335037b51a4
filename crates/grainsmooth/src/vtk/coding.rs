//! How XML files encode arrays: as raw bytes or base64, perhaps compressed, behind a header with their lengths.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use vtkio::IOBuffer;
use vtkio::model::ByteOrder;
use vtkio::xml::{Compressor, Data, DataArray, DataArrayFormat, EncodingInfo, ScalarType};

/// Most bytes that one byte of a compressed array can stand for; zlib makes 1032 of one.
const LARGEST_COMPRESSION: usize = 1100;

/// How a file encodes its arrays.
#[derive(Debug, Clone, Copy)]
pub(super) struct Coding(EncodingInfo);

/// An array as base64, as it stands in an element.
pub(super) struct Encoded {
    pub(super) text: String,
    /// Number of bytes of its values.
    byte_count: usize,
}

/// The lengths in an array's header, in bytes.
struct Lengths {
    /// Of what follows the header.
    body: usize,
    /// Of the values, not compressed.
    values: usize,
    /// Whether the last of the compressed blocks is full: its size is given as 0 then, which `vtkio` takes for the size.
    ends_full: bool,
}

impl Coding {
    /// That which the attributes of the file's first element tell.
    pub(super) fn of(attribute: impl Fn(&str) -> Option<String>) -> Self {
        let is_big = attribute("byte_order").as_deref() == Some("BigEndian");
        let is_wide = attribute("header_type").as_deref() == Some("UInt64");
        Self(EncodingInfo {
            byte_order: if is_big { ByteOrder::BigEndian } else { ByteOrder::LittleEndian },
            header_type: if is_wide { ScalarType::UInt64 } else { ScalarType::UInt32 },
            compressor: match attribute("compressor").as_deref() {
                None => Compressor::None,
                Some("vtkLZ4DataCompressor") => Compressor::LZ4,
                Some("vtkLZMADataCompressor") => Compressor::LZMA,
                Some(_) => Compressor::ZLib,
            },
            compression_level: 0,
        })
    }

    pub(super) fn is_compressed(self) -> bool {
        self.0.compressor != Compressor::None
    }

    /// The array that begins with these raw bytes.
    pub(super) fn of_raw(self, bytes: &[u8]) -> Option<Encoded> {
        let (header, rest) = bytes.split_at_checked(self.header_length(bytes)?)?;
        let lengths = self.lengths(header)?;
        let body = rest.get(..lengths.body)?;
        let text = if self.is_compressed() {
            // The header of compressed data is a base64 text of its own.
            STANDARD.encode(self.understood(header, &lengths)) + &STANDARD.encode(body)
        } else {
            STANDARD.encode([header, body].concat())
        };
        Some(Encoded { text, byte_count: lengths.values })
    }

    /// The array that begins with this base64 text.
    pub(super) fn of_text(self, text: &[u8]) -> Option<Encoded> {
        let decode = |byte_count: usize| STANDARD.decode(text.get(..character_count(byte_count)?)?).ok();
        let header_length = self.header_length(&decode(self.width())?)?;
        let mut header = decode(header_length)?;
        header.truncate(header_length);
        let lengths = self.lengths(&header)?;
        let text = if self.is_compressed() {
            let start = character_count(header_length)?;
            let body = text.get(start..start.checked_add(character_count(lengths.body)?)?)?;
            STANDARD.encode(self.understood(&header, &lengths)) + str::from_utf8(body).ok()?
        } else {
            let whole = text.get(..character_count(header_length.checked_add(lengths.body)?)?)?;
            str::from_utf8(whole).ok()?.to_owned()
        };
        Some(Encoded { text, byte_count: lengths.values })
    }

    /// The values of an array.
    pub(super) fn values(self, Encoded { text, byte_count }: Encoded, kind: ScalarType) -> Option<IOBuffer> {
        if byte_count == 0 {
            return Some(IOBuffer::U8(Vec::new()));
        }
        decoded(self.0, DataArrayFormat::Binary, text, byte_count / kind.size(), kind)
    }

    /// Values written as text.
    pub(super) fn values_of_words(self, words: &str, kind: ScalarType) -> Option<IOBuffer> {
        let count = words.split_ascii_whitespace().count();
        decoded(self.0, DataArrayFormat::Ascii, words.to_owned(), count, kind)
    }

    /// Bytes of each number in a header.
    fn width(self) -> usize {
        self.0.header_type.size()
    }

    /// A number in a header.
    fn number(self, header: &[u8], index: usize) -> Option<usize> {
        let start = self.width().checked_mul(index)?;
        let bytes = header.get(start..start.checked_add(self.width())?)?;
        let add = |number: u64, &byte: &u8| number << 8 | u64::from(byte);
        let number = match self.0.byte_order {
            ByteOrder::BigEndian => bytes.iter().fold(0, add),
            ByteOrder::LittleEndian => bytes.iter().rev().fold(0, add),
        };
        usize::try_from(number).ok()
    }

    /// The length of a header, by its first number.
    fn header_length(self, start: &[u8]) -> Option<usize> {
        if !self.is_compressed() {
            return Some(self.width());
        }
        // The number of blocks, their size, that of the last, and how many bytes each takes.
        self.width().checked_mul(self.number(start, 0)?.checked_add(3)?)
    }

    fn lengths(self, header: &[u8]) -> Option<Lengths> {
        let first = self.number(header, 0)?;
        if !self.is_compressed() {
            return Some(Lengths { body: first, values: first, ends_full: false });
        }
        let body = (0..first).map(|block| self.number(header, 3 + block)).sum::<Option<usize>>()?;
        let [size, last] = [self.number(header, 1)?, self.number(header, 2)?];
        let ends_full = first > 0 && last == 0;
        let before = size.checked_mul(first.saturating_sub(1))?;
        let values = before.checked_add(if ends_full { size } else { last })?;
        (values <= body.saturating_mul(LARGEST_COMPRESSION)).then_some(Lengths { body, values, ends_full })
    }

    /// The header as `vtkio` understands it.
    fn understood(self, header: &[u8], lengths: &Lengths) -> Vec<u8> {
        let mut header = header.to_vec();
        if lengths.ends_full {
            header.copy_within(self.width()..2 * self.width(), 2 * self.width());
        }
        header
    }
}

/// Characters of so many bytes in base64.
fn character_count(byte_count: usize) -> Option<usize> {
    byte_count.div_ceil(3).checked_mul(4)
}

fn decoded(
    coding: EncodingInfo,
    format: DataArrayFormat,
    text: String,
    count: usize,
    kind: ScalarType,
) -> Option<IOBuffer> {
    let array = DataArray { scalar_type: kind, format, data: vec![Data::Data(text)], ..DataArray::default() };
    array.into_io_buffer(count, None, coding).ok()
}
