//! Tensions and mobilities of boundaries, which may come in any unit.

use crate::{Boundary, NetworkError};

/// A tension, if it is one.
pub(crate) fn checked_tension(boundary: &Boundary, tension: f64) -> Result<f64, NetworkError> {
    if tension.is_finite() && tension >= 0.0 {
        Ok(tension)
    } else {
        Err(NetworkError::BadTension { sides: boundary.sides, tension })
    }
}

/// A mobility, if it is one.
pub(crate) fn checked_mobility(boundary: &Boundary, mobility: f64) -> Result<f64, NetworkError> {
    if mobility.is_finite() && mobility > 0.0 {
        Ok(mobility)
    } else {
        Err(NetworkError::BadMobility { sides: boundary.sides, mobility })
    }
}

/// Bits of a value, of 52 behind the point, that are left out in relaxation.
const LEFT_OUT: u64 = (1 << 20) - 1;

/// A tension or mobility in a unit, to ten digits: what rounding makes of one in two units is so the same number, and relaxation the same.
pub(crate) fn in_unit(value: f64, unit: f64) -> f64 {
    let bits = (value / unit).to_bits();
    f64::from_bits((bits + LEFT_OUT / 2) & !LEFT_OUT)
}

/// The mean tension (or mobility) of those boundaries between grains that have any; of walls, where no other has; 1 where none has.
///
/// In this unit a flow has the same steps whatever unit they are given in.
pub(crate) fn mean_in_flow<'a>(values: impl Iterator<Item = (&'a Boundary, f64)>) -> f64 {
    let (walls, between): (Vec<_>, Vec<_>) =
        values.filter(|(_, value)| *value > 0.0).partition(|(boundary, _)| boundary.wall.is_some());
    let some = if between.is_empty() { walls } else { between };
    let largest = some.iter().map(|(_, value)| *value).fold(0.0, f64::max);
    if largest == 0.0 {
        return 1.0;
    }
    // As shares of the largest, no sum is infinite.
    let shares: f64 = some.iter().map(|(_, value)| value / largest).sum();
    largest * (shares / some.len() as f64)
}
