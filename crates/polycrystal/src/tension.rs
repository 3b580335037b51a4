//! Tensions of boundaries, which may come in any unit.

use crate::{Boundary, NetworkError};

/// A tension, if it is one.
pub(crate) fn checked_tension(boundary: &Boundary, tension: f64) -> Result<f64, NetworkError> {
    if tension.is_finite() && tension >= 0.0 {
        Ok(tension)
    } else {
        Err(NetworkError::BadTension { sides: boundary.sides, tension })
    }
}

/// Bits of a tension, of 52 behind the point, that are left out in relaxation.
const LEFT_OUT: u64 = (1 << 20) - 1;

/// A tension in a unit, to ten digits: what rounding makes of one tension in two units is so the same number, and relaxation the same.
pub(crate) fn in_unit(tension: f64, unit: f64) -> f64 {
    let bits = (tension / unit).to_bits();
    f64::from_bits((bits + LEFT_OUT / 2) & !LEFT_OUT)
}

/// The mean tension of those boundaries between grains that have any; of walls, where no other has; 1 where none has.
///
/// In this unit a flow has the same steps whatever unit tensions are given in.
pub(crate) fn mean_tension<'a>(tensions: impl Iterator<Item = (&'a Boundary, f64)>) -> f64 {
    let (walls, between): (Vec<_>, Vec<_>) =
        tensions.filter(|(_, tension)| *tension > 0.0).partition(|(boundary, _)| boundary.wall.is_some());
    let some = if between.is_empty() { walls } else { between };
    let largest = some.iter().map(|(_, tension)| *tension).fold(0.0, f64::max);
    if largest == 0.0 {
        return 1.0;
    }
    // As shares of the largest, no sum is infinite.
    let shares: f64 = some.iter().map(|(_, tension)| tension / largest).sum();
    largest * (shares / some.len() as f64)
}
