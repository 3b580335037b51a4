//! Orientation maps of other programs, point by point.

pub(crate) mod ang;
pub(super) mod crc;
pub(crate) mod ctf;
pub(crate) mod hkl;

use texture::CrystalSymmetry;

/// The line of a fault, counted from 1, and what it is.
pub(crate) type Fault = (usize, String);

/// What a file tells.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct PointList {
    pub(crate) phases: Vec<MapPhase>,
    /// All points, in the order of the file.
    pub(crate) points: Vec<MapPoint>,
    pub(crate) head: HeadGrid,
}

/// What the head of a file says of the grid, which its points may contradict.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct HeadGrid {
    pub(crate) columns: Option<usize>,
    pub(crate) rows: Option<usize>,
    /// Between neighbours along a row.
    pub(crate) step: Option<f64>,
}

/// A phase of a map.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct MapPhase {
    /// Its number in the file.
    pub(crate) number: i64,
    pub(crate) name: String,
    /// Where the file has a known one.
    pub(crate) symmetry: Option<CrystalSymmetry>,
}

/// A point of a map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct MapPoint {
    /// The line of the file, from 1.
    pub(crate) line: usize,
    /// Where it stands, y downward; not a number where the file does not tell.
    pub(crate) place: [f64; 2],
    /// Number of its phase in the file; nothing where the pattern has no solution.
    pub(crate) phase: Option<i64>,
    /// Bunge's Euler angles in degrees, with an axis of trigonal and hexagonal crystals along x as this program has them.
    pub(crate) angles: [f64; 3],
    /// How good the pattern is: image quality or band contrast, in the unit of the file.
    pub(crate) quality: f64,
    /// The confidence index, where the file has one.
    pub(crate) confidence: Option<f64>,
}

impl PointList {
    /// The phase with a number; in a file of one phase also that of number 0.
    pub(crate) fn phase(&self, number: i64) -> Option<usize> {
        let found = self.phases.iter().position(|phase| phase.number == number);
        found.or_else(|| (number == 0 && self.phases.len() == 1).then_some(0))
    }
}

/// Whether an Euler angle in degrees is what EDAX writes where a pattern has no solution: 4 pi.
pub(crate) fn is_unsolved_angle(degrees: f64) -> bool {
    degrees > 1.99 * 360.0
}

/// The finite number in a column.
pub(crate) fn number(line: usize, column: &str) -> Result<f64, Fault> {
    let number = column.parse().ok().filter(|number: &f64| number.is_finite());
    number.ok_or_else(|| {
        let shown: String = column.chars().take(20).collect();
        (line, format!("'{shown}' is not a finite number; correct it or remove the line"))
    })
}

/// The columns of a line, between commas, semicolons or blanks.
pub(crate) fn columns(line: &str) -> impl Iterator<Item = &str> {
    let is_between = |character: char| matches!(character, ',' | ';') || character.is_whitespace();
    line.split(is_between).filter(|column| !column.is_empty())
}
