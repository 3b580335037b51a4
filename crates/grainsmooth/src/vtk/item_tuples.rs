//! Tuples of few items, such as grains, which many cells share.

use vtkio::xml::ScalarType;

use super::raw::Numbers;

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
    /// Tuples of 64-bit floating point numbers.
    pub fn numbers<const N: usize>(name: &'static str, tuples: impl Iterator<Item = [f64; N]>) -> Self {
        let none = bytemuck::cast_slice(&[f64::NAN; N]).to_vec();
        let bytes = tuples.flat_map(|tuple| bytemuck::cast_slice::<f64, u8>(&tuple).to_vec()).collect();
        Self { name, kind: ScalarType::Float64, components: N, bytes, none }
    }

    /// Tuples of 32-bit integers.
    pub fn integers<const N: usize>(name: &'static str, tuples: impl Iterator<Item = [i32; N]>) -> Self {
        let bytes = tuples.flat_map(|tuple| bytemuck::cast_slice::<i32, u8>(&tuple).to_vec()).collect();
        Self { name, kind: ScalarType::Int32, components: N, bytes, none: vec![0; N * size_of::<i32>()] }
    }

    /// Tuples of unsigned 8-bit integers.
    pub fn bytes<const N: usize>(name: &'static str, tuples: impl Iterator<Item = [u8; N]>) -> Self {
        Self {
            name,
            kind: ScalarType::UInt8,
            components: N,
            bytes: tuples.flatten().collect(),
            none: vec![0; N],
        }
    }

    /// The bytes of an item's tuple.
    pub(crate) fn of(&self, item: Option<usize>) -> &[u8] {
        let width = self.none.len();
        item.map_or(&self.none, |item| &self.bytes[item * width..(item + 1) * width])
    }

    /// The kind of the numbers as XML files name it.
    pub(super) fn kind_name(&self) -> &'static str {
        match self.kind {
            ScalarType::UInt8 => "UInt8",
            ScalarType::Int32 => "Int32",
            _ => "Float64",
        }
    }

    /// Number of items.
    pub(super) fn len(&self) -> usize {
        self.bytes.len() / self.width()
    }

    /// The bytes of all items' tuples.
    pub(super) fn all(&self) -> &[u8] {
        &self.bytes
    }

    /// Number of bytes of a tuple.
    pub(super) fn width(&self) -> usize {
        self.none.len()
    }

    /// The tuples of cells, each with its item.
    pub(super) fn of_cells<'a>(
        &'a self,
        count: usize,
        item: &'a (dyn Fn(usize) -> Option<usize> + Sync),
    ) -> Numbers<'a> {
        let width = self.width();
        let fill = move |first: usize, bytes: &mut [u8]| {
            for (index, place) in bytes.chunks_exact_mut(width).enumerate() {
                place.copy_from_slice(self.of(item(first + index)));
            }
        };
        Numbers::Computed { count, width, fill: Box::new(fill) }
    }
}
