//! Tables of Bunge's Euler angles in degrees: phi1, Phi, phi2, and perhaps a weight.

use texture::Orientation;

use super::{Fault, OrientationList, number, of_text};
use crate::files::text_table;

/// Names of the columns, in lower case.
const NAMES: [&str; 4] = ["phi1", "phi", "phi2", "weight"];

/// Reads a table: three or four columns, or columns named in the first line, of which others are passed over. Lines that begin with `#`
/// are comments. Without weights all are 1.
pub(super) fn read(content: &[u8]) -> Result<OrientationList, Fault> {
    let mut places: Option<Vec<Option<usize>>> = None;
    let mut orientations = Vec::new();
    for row in text_table::rows(content).map_err(of_text)? {
        let row = row.map_err(of_text)?;
        let (line, columns) = (row.line, row.columns());
        let places = match &places {
            Some(places) => places,
            None if text_table::are_names(&columns) => {
                places = Some(named(line, &columns)?);
                continue;
            }
            None if (3..=4).contains(&columns.len()) => places
                .insert((0..4).map(|place| Some(place).filter(|place| *place < columns.len())).collect()),
            None => {
                let found = columns.len();
                return Err((
                    line,
                    format!(
                        "{found} columns; write phi1, Phi, phi2 in degrees and perhaps a weight, or name the columns in the first line"
                    ),
                ));
            }
        };
        let value = |which: usize| match places[which] {
            Some(place) => {
                let column = columns.get(place);
                number(
                    line,
                    column.ok_or_else(|| {
                        (
                            line,
                            "fewer columns than in the lines before; write the same number on each"
                                .to_owned(),
                        )
                    })?,
                )
            }
            None => Ok(1.0),
        };
        let weight = value(3)?;
        if weight < 0.0 {
            return Err((line, format!("weight is {weight}; write 0 or more")));
        }
        orientations.push((Orientation::from_euler_degrees([value(0)?, value(1)?, value(2)?]), weight));
    }
    Ok(OrientationList { orientations, symmetry: None })
}

/// The places of the columns by their names.
fn named(line: usize, columns: &[&str]) -> Result<Vec<Option<usize>>, Fault> {
    let place = |name: &&str| columns.iter().position(|column| column.to_lowercase() == **name);
    let places: Vec<_> = NAMES.iter().map(place).collect();
    match places[..3].iter().position(Option::is_none) {
        None => Ok(places),
        Some(missing) => {
            let name = ["phi1", "Phi", "phi2"][missing];
            Err((
                line,
                format!(
                    "no column is named {name}; name three of them phi1, Phi and phi2, and perhaps one weight"
                ),
            ))
        }
    }
}
