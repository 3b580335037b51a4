//! Numbers for the page: a head of JSON, then arrays. Text would take three times the bytes, and bytes are time.

use serde::Serialize;

/// Where an array stands, for the page.
#[derive(Serialize)]
struct Place {
    name: &'static str,
    /// `f32`, `u32` or `i8`.
    kind: &'static str,
    /// How many numbers.
    count: usize,
}

/// The head with where the arrays stand.
#[derive(Serialize)]
struct Head<'a, T> {
    #[serde(flatten)]
    content: &'a T,
    arrays: &'a [Place],
}

/// Arrays on their way to the page: little-endian, each from a multiple of four bytes on.
#[derive(Default)]
pub(super) struct Packed {
    places: Vec<Place>,
    bytes: Vec<u8>,
}

impl Packed {
    pub(super) fn floats(&mut self, name: &'static str, numbers: impl IntoIterator<Item = f32>) {
        self.add(name, "f32", 4, numbers.into_iter().flat_map(f32::to_le_bytes));
    }

    pub(super) fn ids(&mut self, name: &'static str, numbers: impl IntoIterator<Item = u32>) {
        self.add(name, "u32", 4, numbers.into_iter().flat_map(u32::to_le_bytes));
    }

    pub(super) fn small(&mut self, name: &'static str, numbers: impl IntoIterator<Item = i8>) {
        self.add(name, "i8", 1, numbers.into_iter().flat_map(i8::to_le_bytes));
    }

    fn add(&mut self, name: &'static str, kind: &'static str, width: usize, bytes: impl Iterator<Item = u8>) {
        let start = self.bytes.len();
        self.bytes.extend(bytes);
        self.places.push(Place { name, kind, count: (self.bytes.len() - start) / width });
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
    }

    /// The head's length as a 32-bit number, the head, filled up with blanks, and the arrays in the order in which they came.
    pub(super) fn finish(self, content: &impl Serialize) -> serde_json::Result<Vec<u8>> {
        let mut head = serde_json::to_vec(&Head { content, arrays: &self.places })?;
        head.resize(head.len().next_multiple_of(4), b' ');
        // Heads tell a few facts a grain: far from 4 GB.
        let length = u32::try_from(head.len()).unwrap_or(u32::MAX);
        Ok([&length.to_le_bytes()[..], &head, &self.bytes].concat())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arrays_stand_where_the_head_says() {
        let mut packed = Packed::default();
        packed.small("a", [1, -2, 3]);
        packed.floats("b", [0.5]);
        packed.ids("c", [7, 8]);
        let bytes = packed.finish(&serde_json::json!({ "x": 1 })).unwrap();
        let length = u32::from_le_bytes(bytes[..4].try_into().unwrap()) as usize;
        let head: serde_json::Value = serde_json::from_slice(&bytes[4..4 + length]).unwrap();
        assert_eq!((&head["x"], &head["arrays"][1]["name"], length % 4), (&1.into(), &"b".into(), 0));
        assert_eq!(bytes[4 + length..][..4], [1, 254, 3, 0]);
        assert_eq!(bytes[4 + length..][4..8], 0.5_f32.to_le_bytes());
        assert_eq!(bytes[4 + length..][8..], [7, 0, 0, 0, 8, 0, 0, 0]);
    }
}
