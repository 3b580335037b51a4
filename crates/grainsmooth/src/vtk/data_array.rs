//! Arrays of numbers as files hold them, whatever they are of.

use vtkio::IOBuffer;
use vtkio::xml::ScalarType;

use super::raw::Numbers;

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
        let is_whole = components > 0 && numbers.len().is_multiple_of(components);
        // The legacy format puts blanks between a name and what follows.
        is_whole.then(|| Self { name: name.replace(char::is_whitespace, "_"), components, numbers })
    }

    /// The numbers, where a tuple is a single one.
    pub fn scalars(&self) -> Option<Vec<f64>> {
        let numbers = match &self.numbers {
            _ if self.components != 1 => return None,
            DataNumbers::Int8(numbers) => numbers.iter().map(|number| f64::from(*number)).collect(),
            DataNumbers::UInt8(numbers) => numbers.iter().map(|number| f64::from(*number)).collect(),
            DataNumbers::Int32(numbers) => numbers.iter().map(|number| f64::from(*number)).collect(),
            DataNumbers::Float64(numbers) => numbers.clone(),
        };
        Some(numbers)
    }

    /// Number of tuples.
    pub fn len(&self) -> usize {
        self.numbers.len() / self.components
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
        let tuple = |place: usize| place * self.components..(place + 1) * self.components;
        let (first, second) = (tuple(first), tuple(second));
        match &self.numbers {
            DataNumbers::Int8(numbers) => numbers[first] == numbers[second],
            DataNumbers::UInt8(numbers) => numbers[first] == numbers[second],
            DataNumbers::Int32(numbers) => numbers[first] == numbers[second],
            DataNumbers::Float64(numbers) => numbers[first] == numbers[second],
        }
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

    /// The kind of the numbers as XML files name it.
    pub(super) fn kind_name(&self) -> &'static str {
        match self.numbers {
            DataNumbers::Int8(_) => "Int8",
            DataNumbers::UInt8(_) => "UInt8",
            DataNumbers::Int32(_) => "Int32",
            DataNumbers::Float64(_) => "Float64",
        }
    }

    /// The bytes of all numbers.
    pub(super) fn to_bytes(&self) -> Vec<u8> {
        match &self.numbers {
            DataNumbers::Int8(numbers) => bytemuck::cast_slice(numbers).to_vec(),
            DataNumbers::UInt8(numbers) => numbers.clone(),
            DataNumbers::Int32(numbers) => bytemuck::cast_slice(numbers).to_vec(),
            DataNumbers::Float64(numbers) => bytemuck::cast_slice(numbers).to_vec(),
        }
    }

    pub(super) fn written(&self) -> Numbers<'_> {
        match &self.numbers {
            DataNumbers::Int8(numbers) => Numbers::slice(numbers),
            DataNumbers::UInt8(numbers) => Numbers::slice(numbers),
            DataNumbers::Int32(numbers) => Numbers::slice(numbers),
            DataNumbers::Float64(numbers) => Numbers::slice(numbers),
        }
    }
}

impl DataNumbers {
    fn len(&self) -> usize {
        match self {
            Self::Int8(numbers) => numbers.len(),
            Self::UInt8(numbers) => numbers.len(),
            Self::Int32(numbers) => numbers.len(),
            Self::Float64(numbers) => numbers.len(),
        }
    }
}
