//! Orientation maps of other programs, point by point.

pub(crate) mod ang;
pub(super) mod crc;
pub(crate) mod ctf;
pub(crate) mod hkl;

use texture::CrystalSymmetry;

use crate::error::map_file::MapProblem;

/// The line of a fault, counted from 1, and what it is.
pub(crate) type Fault = (usize, String);

/// What a file tells.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct PointList {
    pub(crate) phases: Vec<MapPhase>,
    /// All points, in the order of the file.
    pub(crate) points: Vec<MapPoint>,
    pub(crate) head: HeadGrid,
    /// The sections that the points are of, one after the other, the uppermost first; none where all are of a single map.
    pub(crate) sections: Vec<Section>,
    /// From section to section, where that is told.
    pub(crate) thickness: Option<f64>,
}

/// A section of a stack.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Section {
    /// Of its file, or its number in the file of all.
    pub(crate) name: String,
    /// How many points it has.
    pub(crate) points: usize,
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
    /// A map in the plane.
    pub(crate) fn of_plane(phases: Vec<MapPhase>, points: Vec<MapPoint>, head: HeadGrid) -> Self {
        Self { phases, points, head, sections: Vec::new(), thickness: None }
    }

    /// Sections one above the other, the uppermost first, each with its name. The phases are those of the first.
    ///
    /// # Errors
    /// [`MapProblem::Slice`] where a section has other phases; where there are more points than numbers.
    pub(crate) fn of_sections(
        found: Vec<(String, Self)>,
        thickness: Option<f64>,
    ) -> Result<Self, MapProblem> {
        let mut stack: Option<Self> = None;
        for (name, list) in found {
            let section = Section { name, points: list.points.len() };
            let Some(stack) = &mut stack else {
                stack = Some(Self { sections: vec![section], thickness, ..list });
                continue;
            };
            if list.phases != stack.phases {
                let what = "lists other phases than the first section";
                let problem = MapProblem::Unfit { what, remedy: "give all sections the same list" };
                return Err(MapProblem::Slice { name: section.name, problem: Box::new(problem) });
            }
            stack.points.extend(list.points);
            stack.sections.push(section);
        }
        let stack = stack.ok_or(MapProblem::NoLabels)?;
        if u32::try_from(stack.points.len()).is_err() {
            return Err(MapProblem::Unfit {
                what: "has more points than 4294967295",
                remedy: "give fewer sections at a time",
            });
        }
        Ok(stack)
    }

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
