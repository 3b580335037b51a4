//! HKL's maps: Euler angles in degrees at each point. What has no solution (phase 0) is left out.

use texture::{CrystalSymmetry, Orientation};

use super::hkl::{self, hkl_symmetry};
use super::{Fault, MapPoint, OrientationList, keep_phase, number};

/// Reads the points of a map, of one phase where one is asked for, each of weight 1.
///
/// In trigonal and hexagonal crystals HKL has x along the normal of (10-10), 30 degrees from the two-fold axis that is along x here.
pub(super) fn read(text: &str, phase: Option<i64>) -> Result<OrientationList, Fault> {
    let mut symmetries: Vec<Option<CrystalSymmetry>> = Vec::new();
    let mut phases_to_come = 0;
    let mut places: Option<[usize; 4]> = None;
    let mut points = Vec::new();
    for (line, text) in (1..).zip(text.lines()) {
        let columns: Vec<&str> = text.split_whitespace().collect();
        let Some(places) = places else {
            if phases_to_come > 0 {
                phases_to_come -= 1;
                let laue = text.split('\t').nth(3).and_then(|code| code.trim().parse().ok());
                symmetries.push(laue.and_then(hkl_symmetry));
            } else if let ["Phases", count] = columns[..] {
                phases_to_come = count.parse().unwrap_or(0_usize);
            } else if columns.contains(&"Euler1") {
                places = Some(places_of(line, &columns)?);
            }
            continue;
        };
        if columns.is_empty() {
            continue;
        }
        let value = |which: usize| {
            let column = columns.get(places[which]);
            let column = column
                .ok_or_else(|| (line, "fewer columns than names; write as many on each line".to_owned()))?;
            // Where the system's language has decimal commas the file has them too.
            number(line, &column.replace(',', "."))
        };
        #[expect(clippy::cast_possible_truncation, reason = "numbers of phases are small")]
        let phase = value(0)? as i64;
        if phase != 0 {
            points.push(MapPoint { line, phase, angles: [value(1)?, value(2)?, value(3)?] });
        }
    }
    if places.is_none() {
        return Err((
            1,
            "no line names the columns Phase, Euler1, Euler2 and Euler3; give a whole .ctf file".to_owned(),
        ));
    }
    let phase = keep_phase(&mut points, phase)?.and_then(|phase| usize::try_from(phase - 1).ok());
    let symmetry = phase.and_then(|phase| symmetries.get(phase).copied().flatten());
    let turn = hkl_turn(symmetry);
    let orientation = |[phi1, phi, phi2]: [f64; 3]| Orientation::from_euler_degrees([phi1, phi, phi2 - turn]);
    let orientations = points.into_iter().map(|point| (orientation(point.angles), 1.0)).collect();
    Ok(OrientationList { orientations, symmetry })
}

/// By how many degrees HKL's phi2 is larger than that of an x axis along a two-fold one.
fn hkl_turn(symmetry: Option<CrystalSymmetry>) -> f64 {
    symmetry.map_or(0.0, hkl::hkl_turn)
}

/// The places of the columns that count.
fn places_of(line: usize, columns: &[&str]) -> Result<[usize; 4], Fault> {
    let place = |name: &str| {
        let place = columns.iter().position(|column| *column == name);
        place.ok_or_else(|| (line, format!("no column is named {name}; give a whole .ctf file")))
    };
    Ok([place("Phase")?, place("Euler1")?, place("Euler2")?, place("Euler3")?])
}
