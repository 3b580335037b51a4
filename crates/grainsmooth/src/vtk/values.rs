//! The numbers of an array, whatever they are of and wherever they come from.

use glam::DVec3;
use vtkio::xml::ScalarType;

use super::raw::Numbers;

/// What one point or cell has in an array: numbers of one kind.
pub trait Tuple: bytemuck::NoUninit {
    /// The kind of its numbers.
    const KIND: ScalarType;
}

impl Tuple for i8 {
    const KIND: ScalarType = ScalarType::Int8;
}

impl Tuple for u8 {
    const KIND: ScalarType = ScalarType::UInt8;
}

impl Tuple for i32 {
    const KIND: ScalarType = ScalarType::Int32;
}

impl Tuple for f64 {
    const KIND: ScalarType = ScalarType::Float64;
}

impl Tuple for DVec3 {
    const KIND: ScalarType = f64::KIND;
}

impl<T: Tuple, const N: usize> Tuple for [T; N]
where
    [T; N]: bytemuck::NoUninit,
{
    const KIND: ScalarType = T::KIND;
}

/// The numbers of an [`Array`](super::Array): tuples in memory, or made when they are written.
#[derive(Clone)]
pub struct Values<'a> {
    pub(super) kind: ScalarType,
    pub(super) components: usize,
    count: usize,
    pub(super) numbers: Numbers<'a>,
}

impl<'a> Values<'a> {
    /// Tuples in memory.
    pub fn slice<T: Tuple>(tuples: &'a [T]) -> Self {
        Self::of::<T>(tuples.len(), Numbers::slice(tuples))
    }

    /// So many tuples, each computed from its position when it is written.
    pub fn each<T: Tuple>(count: usize, tuple: impl Fn(usize) -> T + Send + Sync + 'a) -> Self {
        Self::of::<T>(count, Numbers::each(count, tuple))
    }

    /// So many tuples, made block by block when they are written.
    pub fn blocks<T: Tuple>(
        count: usize,
        blocks: usize,
        make: impl Fn(usize) -> Vec<T> + Send + Sync + 'a,
    ) -> Self {
        let make = move |block| bytemuck::cast_slice(&make(block)).to_vec();
        Self::of::<T>(count, Numbers::blocks(count * size_of::<T>(), blocks, make))
    }

    /// Tuples of so many numbers each, one tuple after the other.
    pub fn tuples<T: Tuple>(components: usize, numbers: &'a [T]) -> Self {
        Self::new(T::KIND, components, numbers.len() / components, Numbers::slice(numbers))
    }

    fn of<T: Tuple>(count: usize, numbers: Numbers<'a>) -> Self {
        Self::new(T::KIND, size_of::<T>() / T::KIND.size(), count, numbers)
    }

    pub(super) fn new(kind: ScalarType, components: usize, count: usize, numbers: Numbers<'a>) -> Self {
        Self { kind, components, count, numbers }
    }

    /// Number of tuples.
    pub fn len(&self) -> usize {
        self.count
    }

    /// Whether there is no tuple.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}
