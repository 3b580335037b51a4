//! Loops compiled again for processors that take more numbers at once than the oldest, which takes a fraction of their time.
//!
//! Rust compiles for the oldest processors of an architecture unless told otherwise. Only the speed differs: no version
//! contracts or reorders operations. The crate's only unsafe code is here and in `sites/bisectors`: calls of functions that need AVX2
//! or AVX-512, each behind the question whether the processor has it, and with AVX-512 loads and stores of whole lanes, each within a slice.

/// Numbers that loops take at a time.
pub(crate) const LANES: usize = 8;

/// Defines a function that calls `$anywhere`, compiled for what the processor has.
macro_rules! compiled_thrice {
    ($(#[$doc:meta])* fn $name:ident($($argument:ident: $type:ty),*) -> $result:ty = $anywhere:ident) => {
        $(#[$doc])*
        #[inline]
        #[allow(unsafe_code)]
        pub(crate) fn $name($($argument: $type),*) -> $result {
            #[cfg(target_arch = "x86_64")]
            {
                #[target_feature(enable = "avx2")]
                fn avx2($($argument: $type),*) -> $result {
                    $anywhere($($argument),*)
                }
                #[target_feature(enable = "avx512f,avx512vl,avx512dq")]
                fn avx512($($argument: $type),*) -> $result {
                    $anywhere($($argument),*)
                }
                if $crate::lanes::has_avx512() {
                    // SAFETY: the processor has AVX-512.
                    return unsafe { avx512($($argument),*) };
                }
                if is_x86_feature_detected!("avx2") {
                    // SAFETY: the processor has AVX2.
                    return unsafe { avx2($($argument),*) };
                }
            }
            $anywhere($($argument),*)
        }
    };
}

pub(crate) use compiled_thrice;

/// Whether the processor has what loops are compiled for.
#[cfg(target_arch = "x86_64")]
#[inline]
pub(crate) fn has_avx512() -> bool {
    is_x86_feature_detected!("avx512f")
        && is_x86_feature_detected!("avx512vl")
        && is_x86_feature_detected!("avx512dq")
}

/// The larger of two numbers, in one instruction: which of them counts if one is none does not matter.
#[inline(always)]
pub(crate) fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

#[inline(always)]
pub(crate) fn smaller(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

/// Numbers that fill the first lanes.
#[inline(always)]
pub(crate) fn lanes(numbers: &[f64]) -> [f64; LANES] {
    numbers.try_into().unwrap_or_else(|_| {
        let mut lanes = [0.0; LANES];
        lanes[..numbers.len()].copy_from_slice(numbers);
        lanes
    })
}
