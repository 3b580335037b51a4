//! Memory for arrays of many megabytes.
//!
//! Touching a fresh page costs more than filling it, and refinement fills hundreds of megabytes once. In pages of 2 MiB
//! the first touch costs a fifth; Linux gives them to whoever asks.

use bytemuck::Zeroable;

/// Bytes from which huge pages are worth asking for, and their size.
const HUGE_PAGE: usize = 1 << 21;

/// An empty vector with room for `capacity` elements.
pub(crate) fn with_capacity<T>(capacity: usize) -> Vec<T> {
    let vec = Vec::with_capacity(capacity);
    advise_huge_pages(&vec);
    vec
}

/// `len` zeros; not touched yet if they are many.
pub(crate) fn zeros<T: Zeroable>(len: usize) -> Vec<T> {
    let vec = bytemuck::zeroed_vec(len);
    advise_huge_pages(&vec);
    vec
}

#[cfg(target_os = "linux")]
#[allow(unsafe_code)]
fn advise_huge_pages<T>(vec: &Vec<T>) {
    let bytes = vec.capacity() * size_of::<T>();
    let start = vec.as_ptr().cast::<u8>().cast_mut();
    let before = start.align_offset(HUGE_PAGE);
    if bytes < HUGE_PAGE || before > bytes - HUGE_PAGE {
        return;
    }
    let pages = (bytes - before) / HUGE_PAGE;
    // SAFETY: the range lies within one live allocation, and the advice changes how the kernel backs it, never what it holds. A
    // refusal changes nothing, so the result does not matter.
    unsafe { libc::madvise(start.add(before).cast(), pages * HUGE_PAGE, libc::MADV_HUGEPAGE) };
}

#[cfg(not(target_os = "linux"))]
fn advise_huge_pages<T>(_: &Vec<T>) {}
