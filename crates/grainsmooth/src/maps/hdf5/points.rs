//! Orientations point by point, as microscopes write them: a group `Data` of arrays with a number for each point, and a group `Header` beside it.
//!
//! <https://github.com/oinanoanalysis/h5oina/blob/master/H5OINAFile.md>, and what EDAX and Bruker write, as orix and kikuchipy know it.

use texture::CrystalSymmetry;

use super::super::orientation_map::hkl::{hkl_symmetry, hkl_turn};
use super::super::orientation_map::{HeadGrid, MapPhase, MapPoint, PointList, ang, is_unsolved_angle};
use super::file::{Hdf5, damaged, parent, within};
use crate::error::map_file::MapProblem;

/// How a maker names what a map needs.
struct Maker {
    /// Three angles in three arrays, or in one.
    angles: &'static [&'static str],
    is_in_degrees: bool,
    places: [&'static str; 2],
    /// Places are numbers of points, by the steps of the header.
    is_counted: bool,
    quality: &'static str,
    confidence: Option<&'static str>,
    /// The phase of each point.
    phase: &'static str,
    /// Names in the header: columns, rows, steps along x and y.
    grid: [&'static str; 4],
    /// The group of the phases, and their names.
    phases: [&'static str; 2],
    symmetry: fn(&Hdf5, &str) -> Result<Option<CrystalSymmetry>, MapProblem>,
    /// Whether x of hexagonal crystals is along the normal of (10-10).
    is_turned: bool,
}

const MAKERS: [Maker; 5] = [
    Maker {
        angles: &["Euler"],
        is_in_degrees: false,
        places: ["X", "Y"],
        is_counted: false,
        quality: "Band Contrast",
        confidence: None,
        phase: "Phase",
        grid: ["X Cells", "Y Cells", "X Step", "Y Step"],
        phases: ["Phases", "Phase Name"],
        symmetry: |file, phase| Ok(number(file, phase, "Laue Group")?.and_then(whole).and_then(hkl_symmetry)),
        is_turned: true,
    },
    Maker {
        angles: &["Phi1", "Phi", "Phi2"],
        is_in_degrees: false,
        places: ["X Position", "Y Position"],
        is_counted: false,
        quality: "IQ",
        confidence: Some("CI"),
        phase: "Phase",
        grid: ["nColumns", "nRows", "Step X", "Step Y"],
        phases: ["Phase", "MaterialName"],
        symmetry: |file, phase| {
            let code = number(file, phase, "Symmetry")?;
            Ok(code.and_then(|code| ang::symmetry(&code.to_string())))
        },
        is_turned: false,
    },
    Maker {
        angles: &["phi1", "PHI", "phi2"],
        is_in_degrees: true,
        places: ["X BEAM", "Y BEAM"],
        is_counted: true,
        quality: "RadonQuality",
        confidence: None,
        phase: "Phase",
        grid: ["NCOLS", "NROWS", "XSTEP", "YSTEP"],
        phases: ["Phases", "Name"],
        symmetry: |file, phase| Ok(number(file, phase, "IT")?.and_then(whole).and_then(of_space_group)),
        is_turned: false,
    },
    // What DREAM.3D makes of EDAX's text, and of Oxford's: .h5ebsd.
    Maker {
        angles: &["Phi1", "Phi", "Phi2"],
        is_in_degrees: false,
        places: ["X Position", "Y Position"],
        is_counted: false,
        quality: "Image Quality",
        confidence: Some("Confidence Index"),
        phase: "PhaseData",
        grid: ["NCOLS_ODD", "NROWS", "XSTEP", "YSTEP"],
        phases: ["Phases", "MaterialName"],
        symmetry: |file, phase| {
            let code = number(file, phase, "Symmetry")?;
            Ok(code.and_then(|code| ang::symmetry(&code.to_string())))
        },
        is_turned: false,
    },
    Maker {
        angles: &["Euler1", "Euler2", "Euler3"],
        is_in_degrees: true,
        places: ["X", "Y"],
        is_counted: false,
        quality: "BC",
        confidence: None,
        phase: "Phase",
        grid: ["XCells", "YCells", "XStep", "YStep"],
        phases: ["Phases", "PhaseName"],
        symmetry: |file, phase| Ok(number(file, phase, "LaueGroup")?.and_then(whole).and_then(hkl_symmetry)),
        is_turned: true,
    },
];

/// The numbers of sections in a file of DREAM.3D that are stacked from the last one down.
const HIGH_TO_LOW: f64 = 1.0;

/// The points of the only map in a file; nothing where it has none.
///
/// # Errors
/// [`MapProblem`] where the file holds several, or its arrays do not go together.
pub(super) fn read(file: &Hdf5) -> Result<Option<PointList>, MapProblem> {
    let has = |group: &str, name: &str| file.shape(&within(group, name)).is_some();
    let mut found = Vec::new();
    for maker in &MAKERS {
        let groups = file.groups().filter(|group| maker.angles.iter().all(|name| has(group, name)));
        found.extend(groups.filter(|group| has(group, maker.phase)).map(|group| (maker, group)));
    }
    // Oxford puts what was computed later beside what was measured.
    if found.len() > 1 && found.iter().any(|(_, group)| group.ends_with("EBSD/Data")) {
        found.retain(|(_, group)| group.ends_with("EBSD/Data"));
    }
    if number(file, "", "Z Resolution")?.is_some() {
        return sections(file, &found);
    }
    match found[..] {
        [] => Ok(None),
        [(maker, group)] => points(file, maker, group).map(Some),
        _ => Err(SEVERAL_MAPS),
    }
}

/// What is wrong with a file of several maps.
pub(super) const SEVERAL_MAPS: MapProblem = MapProblem::Unfit {
    what: "it holds several maps of orientations",
    remedy: "save the one to read in a file of its own",
};

/// The phase of a point; nothing where the point has no solution.
pub(super) fn solved_phase(number: f64, angles: [f64; 3], confidence: Option<f64>) -> Option<i64> {
    #[expect(clippy::cast_possible_truncation, reason = "numbers of phases are small")]
    let phase = number as i64;
    let is_solved = phase > 0
        && confidence.is_none_or(|confidence| confidence >= 0.0)
        && angles.iter().all(|angle| angle.is_finite())
        && !angles.into_iter().any(is_unsolved_angle);
    is_solved.then_some(phase)
}

/// The sections of an .h5ebsd file, in groups that are named by their numbers.
///
/// <https://github.com/BlueQuartzSoftware/DREAM3D/blob/develop/Documentation/ReferenceManual/3_SupportedFileFormats/H5EbsdFile.md>
fn sections(file: &Hdf5, found: &[(&Maker, &str)]) -> Result<Option<PointList>, MapProblem> {
    let mut numbered: Vec<(u64, &Maker, &str)> = found
        .iter()
        .filter_map(|(maker, group)| Some((parent(group).parse().ok()?, *maker, *group)))
        .collect();
    numbered.sort_by_key(|(number, ..)| *number);
    if number(file, "", "Stacking Order")? == Some(HIGH_TO_LOW) {
        numbered.reverse();
    }
    let thickness = number(file, "", "Z Resolution")?.filter(|step| step.is_finite() && *step > 0.0);
    let section =
        |(number, maker, group): &(u64, &Maker, &str)| Ok((number.to_string(), points(file, maker, group)?));
    let found = numbered.iter().map(section).collect::<Result<Vec<_>, MapProblem>>()?;
    match <[_; 1]>::try_from(found) {
        Ok([(_, list)]) => Ok(Some(list)),
        Err(found) if found.is_empty() => Ok(None),
        Err(found) => PointList::of_sections(found, thickness).map(Some),
    }
}

fn points(file: &Hdf5, maker: &Maker, group: &str) -> Result<PointList, MapProblem> {
    let header = within(parent(group), "Header");
    let head_number = |name: &str| number(file, &header, name);
    let [columns, rows, step_x, step_y] = maker.grid;
    let head = HeadGrid {
        columns: head_number(columns)?.and_then(whole),
        rows: head_number(rows)?.and_then(whole),
        step: head_number(step_x)?,
    };
    let phases = phases(file, maker, &within(&header, maker.phases[0]))?;
    let array = |name: &str| file.numbers(&within(group, name));
    let needed = |name: &str| array(name)?.ok_or_else(|| damaged(format!("it has no array {group}/{name}")));
    let phase_of = needed(maker.phase)?;
    let count = phase_of.len();
    let of_count = |numbers: Vec<f64>, name: &str, each: usize| match numbers.len() == each * count {
        true => Ok(numbers),
        false => {
            Err(damaged(format!("its array {group}/{name} has {} numbers for {count} points", numbers.len())))
        }
    };
    let optional = |name: &str| array(name)?.map(|numbers| of_count(numbers, name, 1)).transpose();
    let each = 3 / maker.angles.len();
    let mut angles = Vec::new();
    for name in maker.angles {
        angles.push(of_count(needed(name)?, name, each)?);
    }
    let steps = if maker.is_counted {
        [step_x, step_y].map(|name| head_number(name).map(|step| step.unwrap_or(1.0)))
    } else {
        [Ok(1.0), Ok(1.0)]
    };
    let mut places = Vec::new();
    for (name, step) in maker.places.into_iter().zip(steps) {
        let step = step?;
        places.push(of_count(needed(name)?, name, 1)?.into_iter().map(|at| at * step).collect::<Vec<f64>>());
    }
    let quality = optional(maker.quality)?;
    let confidence = maker.confidence.map_or(Ok(None), optional)?;
    let unit = if maker.is_in_degrees { 1.0 } else { 1_f64.to_degrees() };
    let point = |at: usize| {
        let radians_or_degrees = if each == 3 {
            [0, 1, 2].map(|k| angles[0][3 * at + k])
        } else {
            [0, 1, 2].map(|k| angles[k][at])
        };
        let mut angles = radians_or_degrees.map(|angle| angle * unit);
        let confidence = confidence.as_ref().map(|confidence| confidence[at]);
        let phase = solved_phase(phase_of[at], angles, confidence);
        let symmetry =
            phases.iter().find(|known| Some(known.number) == phase).and_then(|known| known.symmetry);
        if maker.is_turned {
            angles[2] -= symmetry.map_or(0.0, hkl_turn);
        }
        MapPoint {
            line: at + 1,
            place: [places[0][at], places[1][at]],
            phase,
            angles,
            quality: quality.as_ref().map_or(f64::NAN, |quality| quality[at]),
            confidence,
        }
    };
    // Outside what was scanned there are points that stand nowhere.
    let points = (0..count).map(point).filter(|point| point.place.iter().all(|along| along.is_finite()));
    let points = points.collect();
    Ok(PointList::of_plane(phases, points, head))
}

/// The phases of a header, by the numbers that their groups are named with.
fn phases(file: &Hdf5, maker: &Maker, group: &str) -> Result<Vec<MapPhase>, MapProblem> {
    let mut phases = Vec::new();
    for phase in file.groups().filter(|path| parent(path) == group && *path != group) {
        let Some(number) = super::file::base(phase).parse().ok() else { continue };
        let name = file.texts(&within(phase, maker.phases[1])).into_iter().next();
        let name = name.filter(|name| !name.is_empty()).unwrap_or_else(|| format!("phase {number}"));
        phases.push(MapPhase { number, name, symmetry: (maker.symmetry)(file, phase)? });
    }
    phases.sort_by_key(|phase| phase.number);
    Ok(phases)
}

/// The first number of an array; nothing where there is none.
fn number(file: &Hdf5, group: &str, name: &str) -> Result<Option<f64>, MapProblem> {
    Ok(file.numbers(&within(group, name))?.and_then(|numbers| numbers.first().copied()))
}

fn whole(number: f64) -> Option<usize> {
    let is_whole = number.fract() == 0.0 && (0.0..=f64::from(u32::MAX)).contains(&number);
    // Checked to fit.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    is_whole.then_some(number as usize)
}

/// The Laue group of a space group, by its number in the International Tables.
fn of_space_group(number: usize) -> Option<CrystalSymmetry> {
    Some(match number {
        1..=2 => CrystalSymmetry::Triclinic,
        3..=15 => CrystalSymmetry::Monoclinic,
        16..=74 => CrystalSymmetry::Orthorhombic,
        75..=88 => CrystalSymmetry::TetragonalLow,
        89..=142 => CrystalSymmetry::Tetragonal,
        143..=148 => CrystalSymmetry::TrigonalLow,
        149..=167 => CrystalSymmetry::Trigonal,
        168..=176 => CrystalSymmetry::HexagonalLow,
        177..=194 => CrystalSymmetry::Hexagonal,
        195..=206 => CrystalSymmetry::Tetrahedral,
        207..=230 => CrystalSymmetry::Octahedral,
        _ => return None,
    })
}
