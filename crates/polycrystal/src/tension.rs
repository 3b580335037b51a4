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
