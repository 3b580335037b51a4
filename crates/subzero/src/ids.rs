//! Conversions between ids and indices.

/// "No such half-edge"; never leaves this crate.
pub(crate) const NONE: u32 = u32::MAX;

/// The id of an index into an array whose length was checked against `u32` when its mesh was made or refined.
#[allow(clippy::cast_possible_truncation)]
pub(crate) fn id(index: usize) -> u32 {
    debug_assert!(u32::try_from(index).is_ok(), "index {index} does not fit an id");
    index as u32
}

/// The half-edge after `h` in its triangle.
pub(crate) fn next(h: u32) -> u32 {
    if h % 3 == 2 { h - 2 } else { h + 1 }
}

/// The half-edge before `h` in its triangle.
pub(crate) fn prev(h: u32) -> u32 {
    if h.is_multiple_of(3) { h + 2 } else { h - 1 }
}
