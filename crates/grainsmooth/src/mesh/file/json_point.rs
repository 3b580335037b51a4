//! Points as JSON holds them: `[x, y, z]`, or `[x, y]` in the plane.

use std::fmt;

use glam::DVec3;
use serde::Deserialize;
use serde::de::{Deserializer, Error, SeqAccess, Visitor};

/// A point; in the plane z is 0.
pub(in crate::mesh) struct JsonPoint(pub(in crate::mesh) DVec3);

impl<'de> Deserialize<'de> for JsonPoint {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_seq(Coordinates)
    }
}

struct Coordinates;

impl<'de> Visitor<'de> for Coordinates {
    type Value = JsonPoint;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("a point [x, y, z], or [x, y] in the plane")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut sequence: A) -> Result<JsonPoint, A::Error> {
        let mut coordinate = |count: usize| {
            sequence
                .next_element::<f64>()
                .map(|found| found.ok_or(A::Error::invalid_length(count, &Coordinates)))
        };
        let [x, y] = [coordinate(0)??, coordinate(1)??];
        let z = coordinate(2)?.unwrap_or(0.0);
        match sequence.next_element::<f64>()? {
            Some(_) => Err(A::Error::invalid_length(4, &Self)),
            None => Ok(JsonPoint(DVec3::new(x, y, z))),
        }
    }
}
