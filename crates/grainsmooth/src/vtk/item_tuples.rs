//! Tuples of few items, such as grains, which many cells share.

use std::sync::Arc;

use vtkio::xml::ScalarType;

use super::raw::Numbers;
use super::{Array, Tuple, Values};

/// A named tuple of numbers for each of some items. Cells that belong to none have NaN, or 0 where there is no such number.
#[derive(Debug, Clone, PartialEq)]
pub struct ItemTuples {
    /// Name under which VTK lists the array; without blanks, which the legacy format cannot hold.
    pub name: &'static str,
    pub(super) kind: ScalarType,
    pub(super) components: usize,
    /// Of all items.
    bytes: Vec<u8>,
    /// The tuple of no item.
    none: Vec<u8>,
}

impl ItemTuples {
    /// The tuples of all items.
    pub fn new<T: Tuple, const N: usize>(name: &'static str, tuples: impl Iterator<Item = [T; N]>) -> Self
    where
        [T; N]: Tuple,
    {
        let none = match T::KIND {
            ScalarType::Float64 => bytemuck::cast_slice(&[f64::NAN; N]).to_vec(),
            _ => vec![0; size_of::<[T; N]>()],
        };
        let bytes = tuples.flat_map(|tuple| bytemuck::bytes_of(&tuple).to_vec()).collect();
        Self { name, kind: T::KIND, components: N, bytes, none }
    }

    /// The bytes of an item's tuple.
    pub(crate) fn of(&self, item: Option<usize>) -> &[u8] {
        let width = self.none.len();
        item.map_or(&self.none, |item| &self.bytes[item * width..(item + 1) * width])
    }

    /// The bytes of all items' tuples.
    pub(super) fn all(&self) -> &[u8] {
        &self.bytes
    }

    /// Number of bytes of a tuple.
    pub(super) fn width(&self) -> usize {
        self.none.len()
    }

    /// The array of so many cells, each with its item.
    pub(crate) fn of_cells<'a>(
        &'a self,
        count: usize,
        item: impl Fn(usize) -> Option<usize> + Send + Sync + 'a,
    ) -> Array<'a> {
        let width = self.width();
        let fill = move |first: usize, bytes: &mut [u8]| {
            for (index, place) in bytes.chunks_exact_mut(width).enumerate() {
                place.copy_from_slice(self.of(item(first + index)));
            }
        };
        self.array(count, Numbers::Computed { count, width, fill: Arc::new(fill) })
    }

    /// The same, with the items of cells made block by block.
    pub(crate) fn of_blocks<'a>(
        &'a self,
        count: usize,
        blocks: usize,
        items: impl Fn(usize) -> Vec<Option<usize>> + Send + Sync + 'a,
    ) -> Array<'a> {
        let make = move |block| items(block).into_iter().flat_map(|item| self.of(item)).copied().collect();
        self.array(count, Numbers::blocks(count * self.width(), blocks, make))
    }

    fn array<'a>(&'a self, count: usize, numbers: Numbers<'a>) -> Array<'a> {
        Array { name: self.name, values: Values::new(self.kind, self.components, count, numbers) }
    }
}
