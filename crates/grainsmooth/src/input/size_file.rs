//! Sizes of grains from text files.

use std::path::Path;

use glam::{DMat3, DVec3};
use sizes::{Table, TableError};
use texture::Orientation;
use voronoi::Dimension;
use voronoi::volumes::GrainShape;

use crate::config::laws::LawKind;
use crate::config::shapes::{MOST_RATIO, are_good_lengths};
use crate::error::Error;
use crate::files::text_table::{self, TextProblem};
use crate::files::{TEXT_FILE, read_input};

/// The line of a fault, counted from 1, and what it is.
pub(crate) type Fault = (usize, String);

/// Reads diameters: a list of them, or of volumes; a histogram; or a distribution function.
///
/// # Errors
/// [`Error::Unreadable`]; [`Error::BadLine`].
pub(crate) fn read_diameter_file(path: &Path, dimension: Dimension) -> Result<Table, Error> {
    read(path, |content| {
        let rows = Rows::new(content)?;
        let shares = ["cdf"];
        let by_number = ["weight", "number", "count"];
        let by_volume = ["volume_fraction", "area_fraction"];
        let table = if let (Some(diameter), Some(share)) = (rows.named(&DIAMETERS), rows.named(&shares)) {
            Table::distribution_function(&rows.numbers([diameter, share])?)
        } else if let (Some(from), Some(to)) = (rows.named(&["from"]), rows.named(&["to"])) {
            match (rows.named(&by_number), rows.named(&by_volume)) {
                (Some(weight), None) => Table::histogram(&rows.numbers([from, to, weight])?, None),
                (None, Some(weight)) => {
                    Table::histogram(&rows.numbers([from, to, weight])?, Some(dimension.axes().into()))
                }
                _ => {
                    let problem = "a histogram needs one column of weights, named weight (by number) or volume_fraction";
                    return Err((rows.first_line, problem.to_owned()));
                }
            }
        } else if let Some(diameter) = rows.named(&DIAMETERS).or_else(|| rows.only()) {
            Table::list(rows.numbers([diameter])?.as_flattened())
        } else if let Some(volume) = rows.named(volume_names(dimension)) {
            let volumes = rows.numbers([volume])?;
            let diameters: Vec<f64> =
                volumes.as_flattened().iter().map(|volume| dimension.ball_diameter(*volume)).collect();
            Table::list(&diameters)
        } else {
            let names = "name a list diameter (or volume), a histogram from, to, weight, and a distribution function diameter, cdf";
            return Err((rows.first_line, format!("columns without these names; {names}")));
        };
        table.map_err(|error| (rows.line(&error), error.to_string()))
    })
}

/// Reads the volume of each grain (in the plane: area).
///
/// # Errors
/// [`Error::Unreadable`]; [`Error::BadLine`].
pub(crate) fn read_volume_file(path: &Path, dimension: Dimension) -> Result<Vec<f64>, Error> {
    read(path, |content| {
        let rows = Rows::new(content)?;
        let name = volume_names(dimension)[0];
        let (column, is_diameter) = match (rows.named(volume_names(dimension)), rows.named(&DIAMETERS)) {
            (Some(column), _) => (column, false),
            (None, Some(column)) => (column, true),
            (None, None) => match rows.only() {
                Some(column) => (column, false),
                None => {
                    let problem = format!("no column is named {name} or diameter; name one so");
                    return Err((rows.first_line, problem));
                }
            },
        };
        let numbers = rows.numbers([column])?;
        let volumes: Vec<f64> = numbers
            .as_flattened()
            .iter()
            .map(|number| if is_diameter { dimension.ball_volume(*number) } else { *number })
            .collect();
        let is_bad = |volume: &f64| !(volume.is_finite() && *volume > 0.0);
        if let Some(row) = volumes.iter().position(is_bad) {
            let name = if is_diameter { "diameter" } else { name };
            let number = numbers.as_flattened()[row];
            let problem =
                format!("the {name} {number} is not positive and finite; correct it or remove the line");
            return Err((rows.rows[row].0, problem));
        }
        if volumes.is_empty() {
            return Err((1, "holds no grains; give one on each line".to_owned()));
        }
        Ok(volumes)
    })
}

/// Reads what diameters are multiplied by along an axis: positions, and factors there.
///
/// # Errors
/// [`Error::Unreadable`]; [`Error::BadLine`].
pub(crate) fn read_gradient_file(path: &Path) -> Result<Vec<[f64; 2]>, Error> {
    read_pairs(path, ["position", "factor"], "factors; give a position", |[position, factor]| {
        (!(position.is_finite() && (1e-3..=1e3).contains(&factor)))
            .then(|| format!("the factor {factor} at {position} is not from 0.001 to 1000; correct it"))
    })
}

/// Reads tensions over the disorientation: angles in degrees, and the values there.
///
/// # Errors
/// [`Error::Unreadable`]; [`Error::BadLine`].
pub(crate) fn read_law_file(path: &Path, kind: LawKind) -> Result<Vec<[f64; 2]>, Error> {
    let name = kind.name();
    read_pairs(path, ["angle", name], "angles; give an angle", |[angle, value]| {
        (!((0.0..=180.0).contains(&angle) && value.is_finite() && value >= 0.0)).then(|| {
            format!(
                "the {name} {value} at {angle} degrees is negative or no number, or the angle not from 0 to 180; correct it"
            )
        })
    })
}

/// Reads two columns of these names, the first one rising. `wanted` is what an empty table lacks; `problem` tells what is wrong with a row.
fn read_pairs(
    path: &Path,
    [first, second]: [&str; 2],
    wanted: &str,
    problem: impl Fn([f64; 2]) -> Option<String>,
) -> Result<Vec<[f64; 2]>, Error> {
    read(path, |content| {
        let rows = Rows::new(content)?;
        let places = match (rows.named(&[first]), rows.named(&[second])) {
            (Some(first), Some(second)) => [first, second],
            _ if rows.names.is_empty() && rows.rows.iter().all(|(_, columns)| columns.len() == 2) => [0, 1],
            _ => return Err((rows.first_line, format!("name two columns {first} and {second}"))),
        };
        let table = rows.numbers(places)?;
        if table.is_empty() {
            return Err((1, format!("holds no {wanted} and a {second} on each line")));
        }
        for (row, pair) in table.iter().enumerate() {
            let line = rows.rows[row].0;
            if let Some(problem) = problem(*pair) {
                return Err((line, problem));
            }
            let place = pair[0];
            if row > 0 && place <= table[row - 1][0] {
                return Err((
                    line,
                    format!("the {first} {place} is not above the one before; list them in order"),
                ));
            }
        }
        Ok(table)
    })
}

/// Reads the shape of each grain: lengths in proportion and Bunge's Euler angles of their directions in degrees; in the plane two lengths and
/// the angle of the first with x.
///
/// # Errors
/// [`Error::Unreadable`]; [`Error::BadLine`].
pub(crate) fn read_shape_file(path: &Path, dimension: Dimension) -> Result<Vec<GrainShape>, Error> {
    read(path, |content| {
        let rows = Rows::new(content)?;
        let names: &[&str] = match dimension {
            Dimension::Two => &["a", "b", "phi1"],
            Dimension::Three => &["a", "b", "c", "phi1", "phi", "phi2"],
        };
        let places: Option<Vec<usize>> = if rows.names.is_empty() {
            let is_good = rows.rows.iter().all(|(_, columns)| columns.len() == names.len());
            is_good.then(|| (0..names.len()).collect())
        } else {
            names.iter().map(|name| rows.named(&[name])).collect()
        };
        let Some(places) = places else {
            return Err((rows.first_line, format!("needs the columns {}; name them so", names.join(", "))));
        };
        let columns: Vec<Vec<[f64; 1]>> =
            places.iter().map(|place| rows.numbers([*place])).collect::<Result<_, _>>()?;
        let axes = usize::from(dimension.axes());
        let shape = |row: usize| {
            let value = |column: usize| columns[column][row][0];
            let lengths: Vec<f64> = (0..axes).map(value).collect();
            let angles: Vec<f64> = (axes..names.len()).map(value).collect();
            if !are_good_lengths(&lengths) || !angles.iter().all(|angle| angle.is_finite()) {
                let problem = format!(
                    "lengths are positive, the longest at most {MOST_RATIO} times the shortest, and angles finite; correct it"
                );
                return Err((rows.rows[row].0, problem));
            }
            let orientation = Orientation::from_euler_degrees(match angles[..] {
                [phi1, phi, phi2] => [phi1, phi, phi2],
                _ => [angles[0], 0.0, 0.0],
            });
            let [x, y, z] = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| orientation.to_sample(axis));
            let lengths = DVec3::new(lengths[0], lengths[1], *lengths.get(2).unwrap_or(&1.0));
            Ok(GrainShape { lengths, axes: DMat3::from_cols(x, y, z) })
        };
        (0..rows.rows.len()).map(shape).collect()
    })
}

/// What columns of diameters may be called.
pub(crate) const DIAMETERS: [&str; 3] = ["diameter", "equivalent_diameter", "equivalentdiameter"];

/// What columns of volumes may be called; areas of cells in space are something else.
fn volume_names(dimension: Dimension) -> &'static [&'static str] {
    match dimension {
        Dimension::Two => &["area", "volume"],
        Dimension::Three => &["volume"],
    }
}

fn read<T>(path: &Path, parse: impl FnOnce(&[u8]) -> Result<T, Fault>) -> Result<T, Error> {
    let bytes = read_input(path, TEXT_FILE)?;
    parse(&bytes).map_err(|(line, problem)| Error::BadLine { path: path.to_owned(), line, problem })
}

/// The lines of a table, which begins with the names of its columns or has none.
pub(crate) struct Rows {
    /// In lower case.
    pub(crate) names: Vec<String>,
    first_line: usize,
    /// With their lines.
    pub(crate) rows: Vec<(usize, Vec<String>)>,
}

impl Rows {
    pub(crate) fn new(content: &[u8]) -> Result<Self, Fault> {
        let of_text = |(line, problem): (usize, TextProblem)| (line, problem.to_string());
        let mut table = Self { names: Vec::new(), first_line: 1, rows: Vec::new() };
        let mut count = None;
        for row in text_table::rows(content).map_err(of_text)? {
            let row = row.map_err(of_text)?;
            let columns = row.columns();
            let found = columns.len();
            if count.is_none() {
                table.first_line = row.line;
                if text_table::are_names(&columns) {
                    table.names = columns.iter().map(|name| name.to_lowercase()).collect();
                }
            }
            let expected = *count.get_or_insert(found);
            if found != expected {
                let problem = format!(
                    "{found} columns, but earlier lines have {expected}; write the same number on each line"
                );
                return Err((row.line, problem));
            }
            if table.names.is_empty() || row.line != table.first_line {
                table.rows.push((row.line, columns.into_iter().map(str::to_owned).collect()));
            }
        }
        Ok(table)
    }

    /// The column of the first of some names that there is.
    fn named(&self, names: &[&str]) -> Option<usize> {
        names.iter().find_map(|name| self.names.iter().position(|other| other == name))
    }

    /// The one column of a table without names.
    pub(crate) fn only(&self) -> Option<usize> {
        let is_one = self.names.is_empty() && self.rows.iter().all(|(_, columns)| columns.len() == 1);
        is_one.then_some(0)
    }

    /// The numbers in some columns.
    fn numbers<const N: usize>(&self, places: [usize; N]) -> Result<Vec<[f64; N]>, Fault> {
        let row = |(line, columns): &(usize, Vec<String>)| {
            let mut numbers = [0.0; N];
            for (number, place) in numbers.iter_mut().zip(places) {
                let text = &columns[place];
                let shown: String = text.chars().take(20).collect();
                *number = text.parse().map_err(|_| {
                    (*line, format!("'{shown}' is not a number; correct it or remove the line"))
                })?;
            }
            Ok(numbers)
        };
        self.rows.iter().map(row).collect()
    }

    /// The line that an error is about.
    fn line(&self, error: &TableError) -> usize {
        let row = error.row().and_then(|row| self.rows.get(row - 1));
        row.map_or(self.first_line, |(line, _)| *line)
    }
}
