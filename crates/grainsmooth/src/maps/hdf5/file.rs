//! What the library reads, as maps need it. No other file knows the library.
//!
//! `hdf5-reader` is Rust alone, bounds-checked and fuzzed, and only reads; what binds the C library would need a C compiler.

use hdf5_reader::group::Group;
use hdf5_reader::{Dataset, Datatype, Hdf5File, OpenOptions};

use super::super::number_type::{ByteOrder, NumberType};
use crate::error::map_file::MapProblem;

/// Groups within groups that are looked into. DREAM3D-NX nests four.
const DEEPEST: usize = 16;

/// The most bytes that a byte of deflated data can hold.
const MOST_OF_BYTE: usize = 1032;

/// All that a file holds, by paths without a first slash.
pub(super) struct Hdf5 {
    arrays: Vec<(String, Dataset)>,
    groups: Vec<(String, Group)>,
    /// The most bytes of an array that the file's own can hold.
    most_bytes: usize,
}

/// The numbers of an array as they are stored.
struct Stored {
    bytes: Vec<u8>,
    number_type: NumberType,
    order: ByteOrder,
}

impl Hdf5 {
    /// Lists what the bytes of a file hold.
    ///
    /// # Errors
    /// [`MapProblem::Damaged`].
    pub(super) fn open(bytes: &[u8]) -> Result<Self, MapProblem> {
        let most_bytes = bytes.len().saturating_mul(MOST_OF_BYTE);
        let options = OpenOptions::default().with_max_read_bytes(most_bytes).with_max_chunk_bytes(most_bytes);
        let file = Hdf5File::from_bytes_with_options(bytes, options).map_err(unread)?;
        let mut found = Self { arrays: Vec::new(), groups: Vec::new(), most_bytes };
        let root = file.root_group().map_err(unread)?;
        found.list(String::new(), root, DEEPEST, &mut Vec::new())?;
        Ok(found)
    }

    fn list(
        &mut self,
        path: String,
        group: Group,
        deeper: usize,
        above: &mut Vec<u64>,
    ) -> Result<(), MapProblem> {
        // A group may hold itself.
        if deeper == 0 || above.contains(&group.address()) {
            return Ok(());
        }
        above.push(group.address());
        let (groups, arrays) = group.members().map_err(unread)?;
        let inside = |name: &str| if path.is_empty() { name.to_owned() } else { format!("{path}/{name}") };
        self.arrays.extend(arrays.into_iter().map(|array| (inside(base(array.name())), array)));
        for group in groups {
            self.list(inside(base(group.name())), group, deeper - 1, above)?;
        }
        above.pop();
        self.groups.push((path, group));
        Ok(())
    }

    /// The paths of all arrays, in the order of the file.
    pub(super) fn paths(&self) -> impl Iterator<Item = &str> {
        self.arrays.iter().map(|(path, _)| path.as_str())
    }

    /// The paths of all groups; those within a group come before it.
    pub(super) fn groups(&self) -> impl Iterator<Item = &str> {
        self.groups.iter().map(|(path, _)| path.as_str())
    }

    fn array(&self, path: &str) -> Option<&Dataset> {
        self.arrays.iter().find(|(known, _)| known == path).map(|(_, array)| array)
    }

    /// Number of places along each index of an array.
    pub(super) fn shape(&self, path: &str) -> Option<Vec<usize>> {
        self.array(path)?.shape().iter().map(|count| usize::try_from(*count).ok()).collect()
    }

    /// The type of an array's numbers; nothing where it holds something else.
    pub(super) fn number_type(&self, path: &str) -> Option<NumberType> {
        number_type(self.array(path)?.dtype()).map(|(number_type, _)| number_type)
    }

    /// The labels that an array holds; nothing where there is no such array of numbers.
    ///
    /// # Errors
    /// [`MapProblem::Damaged`], [`MapProblem::NotWhole`].
    pub(super) fn labels(&self, path: &str) -> Result<Option<Vec<i32>>, MapProblem> {
        let found = self.stored(path)?;
        found.map(|found| found.number_type.labels(&found.bytes, found.order)).transpose()
    }

    /// The numbers of an array; nothing where there is no such array of numbers.
    ///
    /// # Errors
    /// [`MapProblem::Damaged`].
    pub(super) fn numbers(&self, path: &str) -> Result<Option<Vec<f64>>, MapProblem> {
        let found = self.stored(path)?;
        Ok(found.map(|found| found.number_type.numbers(&found.bytes, found.order).collect()))
    }

    fn stored(&self, path: &str) -> Result<Option<Stored>, MapProblem> {
        let Some(array) = self.array(path) else { return Ok(None) };
        let Some((number_type, order)) = number_type(array.dtype()) else { return Ok(None) };
        // Where chunks are missing the library fills all that a header asks for.
        let length = array.raw_byte_len().map_err(unread)?;
        if length > self.most_bytes {
            return Err(damaged(format!("its array {path} has more numbers than the file can hold")));
        }
        let bytes = array.read_raw_bytes().map_err(unread)?;
        Ok(Some(Stored { bytes, number_type, order }))
    }

    /// The texts of an array; none where there is no such array of texts.
    pub(super) fn texts(&self, path: &str) -> Vec<String> {
        let texts = self.array(path).and_then(|array| array.read_strings().ok()).unwrap_or_default();
        texts.into_iter().map(|text| text.trim_matches(['\0', ' ']).to_owned()).collect()
    }

    /// The numbers of a group's attribute, where it has some.
    pub(super) fn attribute(&self, group: &str, name: &str) -> Option<Vec<f64>> {
        let (_, group) = self.groups.iter().find(|(path, _)| path == group)?;
        let attribute = group.attribute(name).ok()?;
        let (number_type, order) = number_type(&attribute.datatype)?;
        Some(number_type.numbers(&attribute.raw_data, order).collect())
    }
}

/// The last part of a path.
pub(super) fn base(path: &str) -> &str {
    path.rsplit('/').next().unwrap_or(path)
}

/// The path of the group that a path lies in.
pub(super) fn parent(path: &str) -> &str {
    path.rsplit_once('/').map_or("", |(parent, _)| parent)
}

/// The path of something in a group.
pub(super) fn within(group: &str, name: &str) -> String {
    if group.is_empty() { name.to_owned() } else { format!("{group}/{name}") }
}

fn number_type(datatype: &Datatype) -> Option<(NumberType, ByteOrder)> {
    let (number_type, order) = match datatype {
        Datatype::FixedPoint { size, signed, byte_order } => {
            let number_type = match (size, signed) {
                (1, false) => NumberType::U8,
                (1, true) => NumberType::I8,
                (2, false) => NumberType::U16,
                (2, true) => NumberType::I16,
                (4, false) => NumberType::U32,
                (4, true) => NumberType::I32,
                (8, false) => NumberType::U64,
                (8, true) => NumberType::I64,
                _ => return None,
            };
            (number_type, byte_order)
        }
        Datatype::FloatingPoint { size: 4, byte_order } => (NumberType::F32, byte_order),
        Datatype::FloatingPoint { size: 8, byte_order } => (NumberType::F64, byte_order),
        // An array with several numbers at each place.
        Datatype::Array { base, .. } => return number_type(base),
        _ => return None,
    };
    let order = match order {
        hdf5_reader::ByteOrder::LittleEndian => ByteOrder::Little,
        hdf5_reader::ByteOrder::BigEndian => ByteOrder::Big,
    };
    Some((number_type, order))
}

fn unread(error: hdf5_reader::error::Error) -> MapProblem {
    damaged(format!("it cannot be read: {}", error.to_string().replace('\n', " ")))
}

/// What is wrong with a file of this format.
pub(super) fn damaged(what: impl Into<String>) -> MapProblem {
    MapProblem::Damaged { format: "HDF5", what: what.into() }
}
