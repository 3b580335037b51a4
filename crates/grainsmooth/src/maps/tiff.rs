//! TIFF: pages are slices along z, rows along y from 0 on, as NumPy's arrays [z, y, x] have them.

use std::io::Cursor;

use glam::DVec3;
use tiff::ColorType;
use tiff::decoder::ifd::Value;
use tiff::decoder::{Decoder, DecodingResult, Limits};
use tiff::tags::Tag;

use super::label_map::FileMap;
use super::number_type::{ByteOrder, NumberType};
use super::options::MapOptions;
use super::stored_numbers::{COLORS, Source};
use crate::error::map_file::MapProblem;

/// The most bytes that a byte of packed data can hold: a single value in LZW comes to 1280.
const MOST_OF_BYTE: usize = 1400;

/// Reads the labels of all pages, packed or not.
pub(super) fn read(source: &Source<'_>, _: &MapOptions) -> Result<FileMap, MapProblem> {
    let most = source.bytes.len().saturating_mul(MOST_OF_BYTE);
    let mut limits = Limits::default();
    limits.decoding_buffer_size = most;
    limits.intermediate_buffer_size = most;
    let mut file = Decoder::new(Cursor::new(source.bytes)).map_err(unread)?.with_limits(limits);
    let told = ImageJ::of(&mut file);
    let size = file.dimensions().map_err(unread)?;
    let mut labels = Vec::new();
    let mut pages = 0;
    loop {
        if file.dimensions().map_err(unread)? != size {
            return Err(MapProblem::Unfit {
                what: "its pages differ in size",
                remedy: "save the slices of the map without other images",
            });
        }
        if !matches!(file.colortype().map_err(unread)?, ColorType::Gray(8..) | ColorType::Palette(8..)) {
            return Err(COLORS);
        }
        labels.extend(numbers(file.read_image().map_err(unread)?)?);
        if labels.len() > most {
            return Err(damaged("its pages have more pixels than it can hold"));
        }
        pages += 1;
        if !file.more_images() {
            break;
        }
        file.next_image().map_err(unread)?;
    }
    if told.as_ref().and_then(|told| told.pages).is_some_and(|told| told > 1 && pages == 1) {
        return Err(MapProblem::Unfit {
            what: "its slices lie behind its only page, as ImageJ writes above 4 GB",
            remedy: "save it as .nrrd, .mhd or .raw",
        });
    }
    let [nx, ny] = [size.0, size.1].map(|count| count as usize);
    Ok(FileMap { shape: [nx, ny, pages], spacing: told.and_then(|told| told.spacing), origin: None, labels })
}

/// What ImageJ tells of a stack, and those that write as it does.
struct ImageJ {
    pages: Option<usize>,
    spacing: Option<DVec3>,
}

impl ImageJ {
    /// Nothing where another program wrote the file: its resolution is one of paper.
    fn of(file: &mut Decoder<Cursor<&[u8]>>) -> Option<Self> {
        let text = file.get_tag_ascii_string(Tag::ImageDescription).ok()?;
        let lines = text.strip_prefix("ImageJ=")?;
        let value = |key: &str| lines.lines().find_map(|line| line.strip_prefix(key)?.strip_prefix('='));
        let mut pixel = |tag: Tag| match file.get_tag(tag).ok()? {
            Value::Rational(pixels, length) => Some(f64::from(length) / f64::from(pixels)),
            _ => None,
        };
        let along_z = value("spacing").and_then(|text| text.trim().parse().ok());
        let [x, y] = [Tag::XResolution, Tag::YResolution].map(&mut pixel);
        let spacing = x.zip(y).map(|(x, y)| DVec3::new(x, y, along_z.unwrap_or(x)));
        Some(Self { pages: value("images").and_then(|text| text.trim().parse().ok()), spacing })
    }
}

/// The labels of a page.
fn numbers(mut page: DecodingResult) -> Result<Vec<i32>, MapProblem> {
    let number_type = match page {
        DecodingResult::U8(_) => NumberType::U8,
        DecodingResult::U16(_) => NumberType::U16,
        DecodingResult::U32(_) => NumberType::U32,
        DecodingResult::U64(_) => NumberType::U64,
        DecodingResult::I8(_) => NumberType::I8,
        DecodingResult::I16(_) => NumberType::I16,
        DecodingResult::I32(_) => NumberType::I32,
        DecodingResult::I64(_) => NumberType::I64,
        DecodingResult::F32(_) => NumberType::F32,
        DecodingResult::F64(_) => NumberType::F64,
        DecodingResult::F16(_) => {
            return Err(MapProblem::Unfit {
                what: "its pixels are floating point numbers of 16 bits",
                remedy: "save the labels as whole numbers",
            });
        }
    };
    let order = if cfg!(target_endian = "big") { ByteOrder::Big } else { ByteOrder::Little };
    number_type.labels(page.as_buffer(0).as_bytes(), order)
}

fn unread(error: tiff::TiffError) -> MapProblem {
    damaged(format!("it cannot be read: {}", error.to_string().replace('\n', " ")))
}

fn damaged(what: impl Into<String>) -> MapProblem {
    MapProblem::Damaged { format: "TIFF", what: what.into() }
}
