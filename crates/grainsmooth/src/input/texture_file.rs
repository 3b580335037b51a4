//! Orientations from files.

use std::collections::BTreeSet;
use std::path::Path;

use texture::{AngleHistogram, CrystalSymmetry, Orientation};

use crate::config::texture::TextureFormat;
use crate::error::Error;
use crate::files::text_table::TextProblem;
use crate::files::{TEXT_FILE, read_input};
use crate::maps::orientation_map::{self, Fault, PointList, number};

mod euler;
mod histogram;
mod ori;

/// Orientations with weights, of a file.
#[derive(Debug, Clone, PartialEq)]
pub struct OrientationList {
    /// One or more; weights are not negative.
    pub orientations: Vec<(Orientation, f64)>,
    /// The symmetry of the crystals, where the file tells it.
    pub symmetry: Option<CrystalSymmetry>,
}

/// Reads the orientations of a file, of one phase where a map has several; of one without a known extension as a table of Euler angles.
///
/// # Errors
/// [`Error::Unreadable`]; [`Error::BadLine`].
pub fn read_texture_file(path: &Path, phase: Option<i64>) -> Result<OrientationList, Error> {
    let bytes = read_input(path, TEXT_FILE)?;
    // Names of phases and comments may have any coding; numbers have one.
    let text = String::from_utf8_lossy(&bytes);
    let found = match TextureFormat::of_path(path) {
        Some(TextureFormat::Ori) => ori::read(&text),
        Some(TextureFormat::Ang) => {
            orientation_map::ang::read(&text).and_then(|found| of_one_phase(&found, phase))
        }
        Some(TextureFormat::Ctf) => {
            orientation_map::ctf::read(&text).and_then(|found| of_one_phase(&found, phase))
        }
        Some(TextureFormat::Euler) | None => euler::read(&bytes),
    };
    let found = found.and_then(|found| match found.orientations.is_empty() {
        true => Err((1, "holds no orientation; give a file with one or more".to_owned())),
        false => Ok(found),
    });
    found.map_err(|(line, problem)| Error::BadLine { path: path.to_owned(), line, problem })
}

/// Reads a histogram of disorientation angles: the upper end of each bin in degrees, and its weight.
///
/// # Errors
/// [`Error::Unreadable`]; [`Error::BadLine`].
pub fn read_disorientation_file(path: &Path, symmetry: CrystalSymmetry) -> Result<AngleHistogram, Error> {
    let bytes = read_input(path, TEXT_FILE)?;
    let read = || {
        let numbered = histogram::read(&bytes)?;
        let (lines, bins): (Vec<usize>, Vec<(f64, f64)>) = numbered.into_iter().unzip();
        AngleHistogram::new(&bins, symmetry).map_err(|error| {
            let line = error.bin().and_then(|bin| lines.get(bin - 1).copied());
            (line.unwrap_or(1), error.to_string())
        })
    };
    read().map_err(|(line, problem)| Error::BadLine { path: path.to_owned(), line, problem })
}

fn of_text((line, problem): (usize, TextProblem)) -> Fault {
    (line, problem.to_string())
}

/// The orientations of one phase, each of weight 1: of the one that is asked for, or of the only one.
fn of_one_phase(list: &PointList, asked: Option<i64>) -> Result<OrientationList, Fault> {
    let solved = || list.points.iter().filter_map(|point| Some((point.phase?, point)));
    let Some((first, _)) = solved().next() else {
        return Ok(OrientationList { orientations: Vec::new(), symmetry: None });
    };
    let phases: BTreeSet<i64> = solved().map(|(phase, _)| phase).collect();
    let kept = match asked {
        None => match solved().find(|(phase, _)| *phase != first) {
            None => first,
            Some((phase, point)) => {
                return Err((
                    point.line,
                    format!(
                        "a point of phase {phase} after points of phase {first}; name one of its {} phases behind the path: #{phase}",
                        phases.len()
                    ),
                ));
            }
        },
        Some(asked) if phases.contains(&asked) => asked,
        Some(asked) => {
            let known: Vec<String> = phases.iter().map(i64::to_string).collect();
            return Err((1, format!("holds no point of phase {asked}; it has phases {}", known.join(", "))));
        }
    };
    let of_phase = solved().filter(|(phase, _)| *phase == kept);
    Ok(OrientationList {
        orientations: of_phase
            .map(|(_, point)| (Orientation::from_euler_degrees(point.angles), 1.0))
            .collect(),
        symmetry: list.phase(kept).and_then(|phase| list.phases[phase].symmetry),
    })
}
