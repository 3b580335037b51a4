//! Orientations from files.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use texture::{AngleHistogram, CrystalSymmetry, Orientation};

use crate::config::texture::TextureFormat;
use crate::error::Error;
use crate::files::text_table::TextProblem;

mod ang;
mod ctf;
mod euler;
mod histogram;
pub(crate) mod hkl;
mod ori;

/// Orientations with weights, of a file.
#[derive(Debug, Clone, PartialEq)]
pub struct OrientationList {
    /// One or more; weights are not negative.
    pub orientations: Vec<(Orientation, f64)>,
    /// The symmetry of the crystals, where the file tells it.
    pub symmetry: Option<CrystalSymmetry>,
}

/// The line of a fault, counted from 1, and what it is.
type Fault = (usize, String);

/// Reads the orientations of a file, of one phase where a map has several; of one without a known extension as a table of Euler angles.
///
/// # Errors
/// [`Error::TextureFileUnreadable`]; [`Error::BadTextureFile`].
pub fn read_texture_file(path: &Path, phase: Option<i64>) -> Result<OrientationList, Error> {
    let bytes =
        fs::read(path).map_err(|cause| Error::TextureFileUnreadable { path: path.to_owned(), cause })?;
    // Names of phases and comments may have any coding; numbers have one.
    let text = String::from_utf8_lossy(&bytes);
    let found = match TextureFormat::of_path(path) {
        Some(TextureFormat::Ori) => ori::read(&text),
        Some(TextureFormat::Ang) => ang::read(&text, phase),
        Some(TextureFormat::Ctf) => ctf::read(&text, phase),
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
            let line = error.bin().and_then(|bin| lines.get(bin - 1).copied());
            (line.unwrap_or(1), error.to_string())
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

/// A point of a map.
struct MapPoint {
    line: usize,
    phase: i64,
    /// In degrees.
    angles: [f64; 3],
}

/// Leaves the points of one phase, and gives that: the one that is asked for, or the only one; nothing where there are no points.
fn keep_phase(points: &mut Vec<MapPoint>, asked: Option<i64>) -> Result<Option<i64>, Fault> {
    let Some(first) = points.first().map(|point| point.phase) else { return Ok(None) };
    let phases: BTreeSet<i64> = points.iter().map(|point| point.phase).collect();
    let Some(asked) = asked else {
        return match points.iter().find(|point| point.phase != first) {
            None => Ok(Some(first)),
            Some(MapPoint { line, phase, .. }) => Err((
                *line,
                format!(
                    "a point of phase {phase} after points of phase {first}; name one of its {} phases behind the path: #{phase}",
                    phases.len()
                ),
            )),
        };
    };
    if !phases.contains(&asked) {
        let known: Vec<String> = phases.iter().map(i64::to_string).collect();
        return Err((1, format!("holds no point of phase {asked}; it has phases {}", known.join(", "))));
    }
    points.retain(|point| point.phase == asked);
    Ok(Some(asked))
}
