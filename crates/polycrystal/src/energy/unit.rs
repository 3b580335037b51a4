//! The unit of tensions and mobilities.

use voronoi::Tessellation;

use crate::energy::sides::boundary;
use crate::network::tension::{in_unit, mean_in_flow};
use crate::{Boundary, NetworkError};

/// The unit of the tensions (or mobilities) of some cells: their mean, as of [`mean_in_flow`].
#[derive(Debug, Clone, Copy)]
pub(crate) struct Unit {
    size: f64,
    /// Whether any boundary has more than 0, and whether one between grains has.
    pub(crate) is_of_any: bool,
    pub(crate) is_of_grains: bool,
}

impl Unit {
    /// That of a law, each value of which passes a check.
    pub(crate) fn of(
        cells: &Tessellation,
        law: &dyn Fn(&Boundary) -> f64,
        check: impl Fn(&Boundary, f64) -> Result<f64, NetworkError>,
    ) -> Result<Self, NetworkError> {
        let mut given = Vec::new();
        for face in cells.faces() {
            let boundary = boundary(cells.face_sides(face));
            given.push((boundary, check(&boundary, law(&boundary))?));
        }
        Ok(Self {
            size: mean_in_flow(given.iter().map(|(boundary, value)| (boundary, *value))),
            is_of_any: given.iter().any(|(_, value)| *value > 0.0),
            is_of_grains: given.iter().any(|(boundary, value)| boundary.wall.is_none() && *value > 0.0),
        })
    }

    /// A value in this unit.
    pub(crate) fn measure(self, value: f64) -> f64 {
        in_unit(value, self.size)
    }
}
