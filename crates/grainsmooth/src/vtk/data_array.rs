//! Arrays of numbers as files hold them, whatever they are of.

use vtkio::IOBuffer;
use vtkio::xml::ScalarType;

use super::raw::Numbers;
use super::{Array, Values};

/// An array of tuples under its name.
#[derive(Debug, Clone, PartialEq)]
pub struct DataArray {
    /// Name under which VTK lists the array; without blanks, which the legacy format cannot hold.
    pub name: String,
    /// Number of components of a tuple, at least 1.
    pub components: usize,
    /// All components, one tuple after the other.
    pub numbers: DataNumbers,
}

/// The numbers of a [`DataArray`], of the kinds that this program writes.
#[derive(Debug, Clone, PartialEq)]
pub enum DataNumbers {
    /// 8-bit integers.
    Int8(Vec<i8>),
    /// Unsigned 8-bit integers.
    UInt8(Vec<u8>),
    /// 32-bit integers.
    Int32(Vec<i32>),
    /// 64-bit floating point numbers.
    Float64(Vec<f64>),
}

impl DataArray {
    /// Whole numbers, one a tuple.
    pub fn int32(name: &str, numbers: Vec<i32>) -> Self {
        Self { name: name.to_owned(), components: 1, numbers: DataNumbers::Int32(numbers) }
    }

    /// Floating point numbers, so many a tuple.
    pub fn float64(name: &str, components: usize, numbers: Vec<f64>) -> Self {
        Self { name: name.to_owned(), components, numbers: DataNumbers::Float64(numbers) }
    }

    /// What `vtkio` has read; integers that 32 bits do not hold become floating point numbers. Nothing for bits, and where tuples
    /// are not whole.
    pub(crate) fn of_buffer(name: &str, components: usize, buffer: &IOBuffer) -> Option<Self> {
        let numbers = match buffer {
            IOBuffer::Bit(_) => return None,
            IOBuffer::I8(numbers) => DataNumbers::Int8(numbers.clone()),
            IOBuffer::U8(numbers) => DataNumbers::UInt8(numbers.clone()),
            IOBuffer::F32(_) | IOBuffer::F64(_) => DataNumbers::Float64(buffer.cast_into()?),
            _ => {
                let wide: Vec<i64> = buffer.cast_into()?;
                match wide.iter().map(|number| i32::try_from(*number)).collect() {
                    Ok(numbers) => DataNumbers::Int32(numbers),
                    Err(_) => DataNumbers::Float64(buffer.cast_into()?),
                }
            }
        };
        // The legacy format puts blanks between a name and what follows.
        let array = Self { name: name.replace(char::is_whitespace, "_"), components, numbers };
        let is_whole = components > 0 && buffer.len().is_multiple_of(components);
        is_whole.then_some(array)
    }

    /// All numbers, whatever their kind.
    pub fn to_f64(&self) -> Vec<f64> {
        match &self.numbers {
            DataNumbers::Int8(numbers) => numbers.iter().map(|number| f64::from(*number)).collect(),
            DataNumbers::UInt8(numbers) => numbers.iter().map(|number| f64::from(*number)).collect(),
            DataNumbers::Int32(numbers) => numbers.iter().map(|number| f64::from(*number)).collect(),
            DataNumbers::Float64(numbers) => numbers.clone(),
        }
    }

    /// The same, where a tuple is a single number.
    pub fn scalars(&self) -> Option<Vec<f64>> {
        (self.components == 1).then(|| self.to_f64())
    }

    /// Number of tuples.
    pub fn len(&self) -> usize {
        self.bytes().len() / (self.kind().size() * self.components)
    }

    /// Whether there is no tuple.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The tuples at these places, in this order.
    ///
    /// # Panics
    /// If there is no such place.
    pub fn at(&self, places: impl Iterator<Item = usize>) -> Self {
        fn gathered<T: Copy>(numbers: &[T], width: usize, places: impl Iterator<Item = usize>) -> Vec<T> {
            places.flat_map(|place| &numbers[place * width..(place + 1) * width]).copied().collect()
        }
        let width = self.components;
        let numbers = match &self.numbers {
            DataNumbers::Int8(numbers) => DataNumbers::Int8(gathered(numbers, width, places)),
            DataNumbers::UInt8(numbers) => DataNumbers::UInt8(gathered(numbers, width, places)),
            DataNumbers::Int32(numbers) => DataNumbers::Int32(gathered(numbers, width, places)),
            DataNumbers::Float64(numbers) => DataNumbers::Float64(gathered(numbers, width, places)),
        };
        Self { name: self.name.clone(), components: width, numbers }
    }

    /// Whether two tuples are the same.
    ///
    /// # Panics
    /// If there is no such tuple.
    pub fn are_equal(&self, first: usize, second: usize) -> bool {
        self.tuple(first) == self.tuple(second)
    }

    /// The bytes of a tuple.
    pub(super) fn tuple(&self, place: usize) -> &[u8] {
        let width = self.kind().size() * self.components;
        &self.bytes()[place * width..(place + 1) * width]
    }

    /// Exchanges the two components of a tuple.
    ///
    /// # Panics
    /// If there is no such tuple, or it has not two components.
    pub fn swap_pair(&mut self, place: usize) {
        assert_eq!(self.components, 2, "pairs alone can be exchanged");
        let [first, second] = [2 * place, 2 * place + 1];
        match &mut self.numbers {
            DataNumbers::Int8(numbers) => numbers.swap(first, second),
            DataNumbers::UInt8(numbers) => numbers.swap(first, second),
            DataNumbers::Int32(numbers) => numbers.swap(first, second),
            DataNumbers::Float64(numbers) => numbers.swap(first, second),
        }
    }

    pub(super) fn kind(&self) -> ScalarType {
        match self.numbers {
            DataNumbers::Int8(_) => ScalarType::Int8,
            DataNumbers::UInt8(_) => ScalarType::UInt8,
            DataNumbers::Int32(_) => ScalarType::Int32,
            DataNumbers::Float64(_) => ScalarType::Float64,
        }
    }

    /// The bytes of all numbers.
    pub(super) fn bytes(&self) -> &[u8] {
        match &self.numbers {
            DataNumbers::Int8(numbers) => bytemuck::cast_slice(numbers),
            DataNumbers::UInt8(numbers) => numbers,
            DataNumbers::Int32(numbers) => bytemuck::cast_slice(numbers),
            DataNumbers::Float64(numbers) => bytemuck::cast_slice(numbers),
        }
    }

    /// The array for a file.
    pub(crate) fn array(&self) -> Array<'_> {
        let numbers = Numbers::slice(self.bytes());
        Array { name: &self.name, values: Values::new(self.kind(), self.components, self.len(), numbers) }
    }
}
