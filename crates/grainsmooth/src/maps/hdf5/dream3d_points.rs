//! Orientations of DREAM.3D: an array of angles for the points of a grid, in the plane or of sections, without a coordinate of each.

use texture::CrystalSymmetry;

use super::super::orientation_map::{HeadGrid, MapPhase, MapPoint, PointList, Section};
use super::file::{Hdf5, base, damaged, parent, within};
use super::geometry::Geometry;
use super::points::{SEVERAL_MAPS, solved_phase};
use crate::error::map_file::MapProblem;

/// The points of the only map in a file; nothing where it has none.
///
/// # Errors
/// [`MapProblem`] where the file holds several, or its arrays do not go together.
pub(super) fn read(file: &Hdf5) -> Result<Option<PointList>, MapProblem> {
    let is_map = |group: &&str| {
        ["EulerAngles", "Phases"].iter().all(|name| file.shape(&within(group, name)).is_some())
    };
    let groups: Vec<&str> = file.groups().filter(is_map).collect();
    let group = match groups[..] {
        [] => return Ok(None),
        [group] => group,
        _ => return Err(SEVERAL_MAPS),
    };
    let geometry = Geometry::of(file, &within(group, "Phases"))?;
    let geometry = geometry.ok_or_else(|| damaged("it tells no grid of its orientations"))?;
    let [columns, rows, sections] =
        geometry.shape.ok_or_else(|| damaged("it tells no grid of its orientations"))?;
    let array = |name: &str| file.numbers(&within(group, name));
    let missing = |name: &str| damaged(format!("its array {group}/{name} does not fit its grid"));
    let each = columns.checked_mul(rows);
    let count = each.and_then(|each| each.checked_mul(sections));
    let fitting = |name: &str, each: usize| {
        let numbers = array(name)?
            .filter(|numbers| count.and_then(|count| count.checked_mul(each)) == Some(numbers.len()));
        Ok::<_, MapProblem>(numbers)
    };
    let angles = fitting("EulerAngles", 3)?.ok_or_else(|| missing("EulerAngles"))?;
    let phase_of = fitting("Phases", 1)?.ok_or_else(|| missing("Phases"))?;
    let confidence = fitting("Confidence Index", 1)?;
    // EDAX's name, and Oxford's.
    let quality = match fitting("Image Quality", 1)? {
        None => fitting("BC", 1)?,
        found => found,
    };
    let point = |(at, number): (usize, &f64)| {
        let angles = [0, 1, 2].map(|k| angles[3 * at + k].to_degrees());
        let confidence = confidence.as_ref().map(|confidence| confidence[at]);
        let [column, row] = [at % columns, at / columns % rows];
        MapPoint {
            line: at + 1,
            place: [column as f64 * geometry.spacing.x, row as f64 * geometry.spacing.y],
            phase: solved_phase(*number, angles, confidence),
            angles,
            quality: quality.as_ref().map_or(f64::NAN, |quality| quality[at]),
            confidence,
        }
    };
    let points: Vec<MapPoint> = phase_of.iter().enumerate().map(point).collect();
    let list = PointList::of_plane(phases(file, parent(group))?, points, HeadGrid::default());
    if sections == 1 {
        return Ok(Some(list));
    }
    let section = |number: usize| Section { name: format!("section {number}"), points: columns * rows };
    let sections = (0..sections).map(section).collect();
    Ok(Some(PointList { sections, thickness: Some(geometry.spacing.z), ..list }))
}

/// The phases of the container's ensemble, of which the first is none.
fn phases(file: &Hdf5, container: &str) -> Result<Vec<MapPhase>, MapProblem> {
    let structures =
        file.paths().find(|path| base(path) == "CrystalStructures" && path.starts_with(container));
    let Some(structures) = structures else { return Ok(Vec::new()) };
    let codes = file.numbers(structures)?.unwrap_or_default();
    let names = file.texts(&within(parent(structures), "MaterialName"));
    let phase = |(number, code): (usize, &f64)| MapPhase {
        number: i64::try_from(number).unwrap_or(i64::MAX),
        name: names
            .get(number)
            .filter(|name| !name.is_empty())
            .cloned()
            .unwrap_or_else(|| format!("phase {number}")),
        symmetry: symmetry(*code),
    };
    Ok(codes.iter().enumerate().skip(1).map(phase).collect())
}

/// Laue groups by DREAM.3D's numbers.
const LAUE_GROUPS: [CrystalSymmetry; 11] = [
    CrystalSymmetry::Hexagonal,
    CrystalSymmetry::Octahedral,
    CrystalSymmetry::HexagonalLow,
    CrystalSymmetry::Tetrahedral,
    CrystalSymmetry::Triclinic,
    CrystalSymmetry::Monoclinic,
    CrystalSymmetry::Orthorhombic,
    CrystalSymmetry::TetragonalLow,
    CrystalSymmetry::Tetragonal,
    CrystalSymmetry::TrigonalLow,
    CrystalSymmetry::Trigonal,
];

/// What DREAM.3D calls the Laue group of no crystal.
const UNKNOWN_LAUE_GROUP: u32 = 999;

/// The Laue group with a number.
fn symmetry(code: f64) -> Option<CrystalSymmetry> {
    (0..).map(f64::from).zip(LAUE_GROUPS).find(|(number, _)| *number == code).map(|(_, symmetry)| symmetry)
}

/// The number of a Laue group.
pub(crate) fn laue_group_number(symmetry: Option<CrystalSymmetry>) -> u32 {
    let found = (0..).zip(LAUE_GROUPS).find(|(_, known)| Some(*known) == symmetry);
    found.map_or(UNKNOWN_LAUE_GROUP, |(number, _)| number)
}
