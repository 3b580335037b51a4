//! How files hold numbers.

use std::fmt;
use std::str::FromStr;

use crate::error::map_file::MapProblem;

/// A type of numbers in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NumberType {
    /// 8 bits without sign.
    U8,
    /// 8 bits.
    I8,
    /// 16 bits without sign.
    U16,
    /// 16 bits.
    I16,
    /// 32 bits without sign.
    U32,
    /// 32 bits.
    I32,
    /// 64 bits without sign.
    U64,
    /// 64 bits.
    I64,
    /// Floating point of 32 bits.
    F32,
    /// Floating point of 64 bits.
    F64,
}

/// The order of the bytes of a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ByteOrder {
    Little,
    Big,
}

impl NumberType {
    /// Every type with its name.
    const NAMES: [(&str, Self); 10] = [
        ("u8", Self::U8),
        ("i8", Self::I8),
        ("u16", Self::U16),
        ("i16", Self::I16),
        ("u32", Self::U32),
        ("i32", Self::I32),
        ("u64", Self::U64),
        ("i64", Self::I64),
        ("f32", Self::F32),
        ("f64", Self::F64),
    ];

    /// Bytes of a number.
    pub(super) fn width(self) -> usize {
        match self {
            Self::U8 | Self::I8 => 1,
            Self::U16 | Self::I16 => 2,
            Self::U32 | Self::I32 | Self::F32 => 4,
            Self::U64 | Self::I64 | Self::F64 => 8,
        }
    }

    /// The labels that some bytes hold; a last number that is cut off is left out. Labels have 32 bits, which floating point numbers hold.
    pub(super) fn labels(self, bytes: &[u8], order: ByteOrder) -> Result<Vec<i32>, MapProblem> {
        let whole = match self {
            Self::U8 => whole(bytes, order, u8::from_le_bytes),
            Self::I8 => whole(bytes, order, i8::from_le_bytes),
            Self::U16 => whole(bytes, order, u16::from_le_bytes),
            Self::I16 => whole(bytes, order, i16::from_le_bytes),
            Self::U32 => whole(bytes, order, u32::from_le_bytes),
            Self::I32 => whole(bytes, order, i32::from_le_bytes),
            Self::U64 => whole(bytes, order, u64::from_le_bytes),
            Self::I64 => whole(bytes, order, i64::from_le_bytes),
            Self::F32 | Self::F64 => None,
        };
        // Those that do not fit are found, and named, among floating point numbers.
        whole.map_or_else(|| labels_of_floats(self.numbers(bytes, order)), Ok)
    }

    /// The numbers that some bytes hold; a last one that is cut off is left out.
    pub(super) fn numbers(self, bytes: &[u8], order: ByteOrder) -> Box<dyn Iterator<Item = f64> + '_> {
        match self {
            Self::U8 => Box::new(bytes.iter().map(|byte| f64::from(*byte))),
            Self::I8 => Box::new(bytes.iter().map(|byte| f64::from(byte.cast_signed()))),
            Self::U16 => Box::new(numbers(bytes, order, u16::from_le_bytes).map(f64::from)),
            Self::I16 => Box::new(numbers(bytes, order, i16::from_le_bytes).map(f64::from)),
            Self::U32 => Box::new(numbers(bytes, order, u32::from_le_bytes).map(f64::from)),
            Self::I32 => Box::new(numbers(bytes, order, i32::from_le_bytes).map(f64::from)),
            Self::U64 => Box::new(numbers(bytes, order, u64::from_le_bytes).map(|number| number as f64)),
            Self::I64 => Box::new(numbers(bytes, order, i64::from_le_bytes).map(|number| number as f64)),
            Self::F32 => Box::new(numbers(bytes, order, f32::from_le_bytes).map(f64::from)),
            Self::F64 => Box::new(numbers(bytes, order, f64::from_le_bytes)),
        }
    }
}

/// Labels that are written as floating point numbers.
///
/// # Errors
/// [`MapProblem::NotWhole`].
pub(super) fn labels_of_floats(numbers: impl Iterator<Item = f64>) -> Result<Vec<i32>, MapProblem> {
    let mut labels = Vec::with_capacity(numbers.size_hint().0);
    for (voxel, label) in numbers.enumerate() {
        let is_label = label.fract() == 0.0 && (f64::from(i32::MIN)..=f64::from(i32::MAX)).contains(&label);
        if !is_label {
            return Err(MapProblem::NotWhole { voxel, label });
        }
        // Checked to fit.
        #[allow(clippy::cast_possible_truncation)]
        labels.push(label as i32);
    }
    Ok(labels)
}

/// Whole numbers that all fit a label.
fn whole<const N: usize, T>(bytes: &[u8], order: ByteOrder, number: fn([u8; N]) -> T) -> Option<Vec<i32>>
where
    i32: TryFrom<T>,
{
    let mut labels = Vec::with_capacity(bytes.len() / N);
    for number in numbers(bytes, order, number) {
        labels.push(i32::try_from(number).ok()?);
    }
    Some(labels)
}

fn numbers<const N: usize, T>(
    bytes: &[u8],
    order: ByteOrder,
    number: fn([u8; N]) -> T,
) -> impl Iterator<Item = T> {
    let chunks = bytes.as_chunks::<N>().0.iter();
    chunks.map(move |bytes| {
        let mut bytes = *bytes;
        if order == ByteOrder::Big {
            bytes.reverse();
        }
        number(bytes)
    })
}

impl FromStr for NumberType {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let named = Self::NAMES.iter().find(|(name, _)| *name == text).map(|(_, number)| *number);
        named.ok_or_else(|| format!("the types are {}", Self::NAMES.map(|(name, _)| name).join(", ")))
    }
}

impl fmt::Display for NumberType {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = Self::NAMES.iter().find(|(_, number)| number == self).map_or("", |(name, _)| name);
        out.write_str(name)
    }
}
