//! Neper's lists of orientations: a passive Rodrigues vector on each line, as Neper writes them, or a unit quaternion.

use glam::DVec3;
use texture::Orientation;

use super::{Fault, OrientationList, number};
use crate::maps::orientation_map::columns;

/// Reads a list. Lines that begin with `#` are comments.
pub(super) fn read(text: &str) -> Result<OrientationList, Fault> {
    let mut orientations = Vec::new();
    for (line, text) in (1..).zip(text.lines().map(str::trim)) {
        if text.is_empty() || text.starts_with('#') {
            continue;
        }
        let numbers = columns(text).map(|column| number(line, column));
        let numbers = numbers.collect::<Result<Vec<f64>, Fault>>()?;
        let orientation = match numbers[..] {
            [x, y, z] => Orientation::from_rodrigues(DVec3::new(x, y, z)),
            [w, x, y, z] => Orientation::from_quaternion([w, x, y, z]).ok_or_else(|| {
                (line, "a quaternion of length 0; correct it or remove the line".to_owned())
            })?,
            _ => {
                let found = numbers.len();
                return Err((
                    line,
                    format!(
                        "{found} numbers; write three of a Rodrigues vector (rodrigues:passive in Neper), or four of a quaternion"
                    ),
                ));
            }
        };
        orientations.push((orientation, 1.0));
    }
    Ok(OrientationList { orientations, symmetry: None })
}
