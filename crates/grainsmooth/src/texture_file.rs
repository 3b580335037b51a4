//! Orientations from files.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use texture::{AngleHistogram, CrystalSymmetry, HistogramError, Orientation};

use crate::Error;
use crate::text_table::TextProblem;

mod ang;
mod ctf;
mod euler;
mod histogram;
mod ori;

/// A format of files with orientations.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TextureFormat {
    /// A table of Euler angles and weights.
    Euler,
    /// Neper's list of orientations.
    Ori,
    /// TSL's map.
    Ang,
    /// HKL's map.
    Ctf,
}

/// Orientations with weights, of a file.
#[derive(Debug, Clone, PartialEq)]
pub struct OrientationList {
    /// One or more; weights are not negative.
    pub orientations: Vec<(Orientation, f64)>,
    /// The symmetry of the crystals, where the file tells it.
    pub symmetry: Option<CrystalSymmetry>,
}

impl TextureFormat {
    /// The format that the path's extension names, in upper or lower case.
    pub fn of_path(path: &Path) -> Option<Self> {
        let extension = path.extension()?.to_str()?.to_lowercase();
        match extension.as_str() {
            "csv" | "txt" => Some(Self::Euler),
            "ori" => Some(Self::Ori),
            "ang" => Some(Self::Ang),
            "ctf" => Some(Self::Ctf),
            _ => None,
        }
    }
}

/// The line of a fault, counted from 1, and what it is.
type Fault = (usize, String);

/// Reads the orientations of a file; of one without a known extension as a table of Euler angles.
///
/// # Errors
/// [`Error::TextureFileUnreadable`]; [`Error::BadTextureFile`].
pub fn read_texture_file(path: &Path) -> Result<OrientationList, Error> {
    let bytes =
        fs::read(path).map_err(|cause| Error::TextureFileUnreadable { path: path.to_owned(), cause })?;
    // Names of phases and comments may have any coding; numbers have one.
    let text = String::from_utf8_lossy(&bytes);
    let found = match TextureFormat::of_path(path) {
        Some(TextureFormat::Ori) => ori::read(&text),
        Some(TextureFormat::Ang) => ang::read(&text),
        Some(TextureFormat::Ctf) => ctf::read(&text),
        Some(TextureFormat::Euler) | None => euler::read(&bytes),
    };
    let found = found.and_then(|found| match found.orientations.is_empty() {
        true => Err((1, "holds no orientation; give a file with one or more".to_owned())),
        false => Ok(found),
    });
    found.map_err(|(line, problem)| Error::BadTextureFile { path: path.to_owned(), line, problem })
}

/// Reads a histogram of disorientation angles: the upper end of each bin in degrees, and its weight.
///
/// # Errors
/// [`Error::TextureFileUnreadable`]; [`Error::BadTextureFile`].
pub fn read_disorientation_file(path: &Path, symmetry: CrystalSymmetry) -> Result<AngleHistogram, Error> {
    let bytes =
        fs::read(path).map_err(|cause| Error::TextureFileUnreadable { path: path.to_owned(), cause })?;
    let read = || {
        let numbered = histogram::read(&bytes)?;
        let (lines, bins): (Vec<usize>, Vec<(f64, f64)>) = numbered.into_iter().unzip();
        AngleHistogram::new(&bins, symmetry).map_err(|error| {
            let bin = match error {
                HistogramError::NoBins => 1,
                HistogramError::Order { bin, .. }
                | HistogramError::Weight { bin, .. }
                | HistogramError::Unreachable { bin, .. } => bin,
            };
            (lines.get(bin - 1).copied().unwrap_or(1), error.to_string())
        })
    };
    read().map_err(|(line, problem)| Error::BadTextureFile { path: path.to_owned(), line, problem })
}

fn of_text((line, problem): (usize, TextProblem)) -> Fault {
    (line, problem.to_string())
}

/// The columns of a line, between commas, semicolons or blanks.
fn columns(line: &str) -> Vec<&str> {
    let is_between = |character: char| matches!(character, ',' | ';') || character.is_whitespace();
    line.split(is_between).filter(|column| !column.is_empty()).collect()
}

/// The finite number in a column.
fn number(line: usize, column: &str) -> Result<f64, Fault> {
    let number = column.parse().ok().filter(|number: &f64| number.is_finite());
    number.ok_or_else(|| {
        let shown: String = column.chars().take(20).collect();
        (line, format!("'{shown}' is no finite number; correct it or remove the line"))
    })
}

/// The one phase of a map's points, each with its line.
fn only_phase(points: &[(usize, i64)]) -> Result<Option<i64>, Fault> {
    let phases: BTreeSet<i64> = points.iter().map(|(_, phase)| *phase).collect();
    let Some(first) = points.first().map(|(_, phase)| *phase) else { return Ok(None) };
    match points.iter().find(|(_, phase)| *phase != first) {
        None => Ok(Some(first)),
        Some((line, phase)) => Err((
            *line,
            format!(
                "a point of phase {phase} after points of phase {first}; give a map with the points of one of its {} phases",
                phases.len()
            ),
        )),
    }
}
