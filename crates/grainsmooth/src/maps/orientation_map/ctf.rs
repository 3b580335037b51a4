//! HKL's maps: Euler angles in degrees at each point. Points without a solution have phase 0.

use rayon::prelude::*;

use super::hkl::{hkl_symmetry, hkl_turn};
use super::{Fault, HeadGrid, MapPhase, MapPoint, PointList, number};

/// Reads a map.
///
/// In trigonal and hexagonal crystals HKL has x along the normal of (10-10), 30 degrees from the two-fold axis that is along x here.
///
/// # Errors
/// A file that does not name its columns; the first line that is no point.
pub(crate) fn read(text: &str) -> Result<PointList, Fault> {
    let mut phases = Vec::new();
    let mut head = HeadGrid::default();
    let mut phases_to_come = 0;
    let mut lines = (1..).zip(text.lines());
    let places = loop {
        let Some((line, text)) = lines.next() else {
            return Err((
                1,
                "no line names the columns Phase, Euler1, Euler2 and Euler3; give a whole .ctf file"
                    .to_owned(),
            ));
        };
        let columns: Vec<&str> = text.split_whitespace().collect();
        if phases_to_come > 0 {
            phases_to_come -= 1;
            phases.push(phase(phases.last().map_or(1, |last: &MapPhase| last.number + 1), text));
        } else if let ["Phases", count] = columns[..] {
            phases_to_come = count.parse().unwrap_or(0_usize);
        } else if columns.contains(&"Euler1") {
            break Places::of(line, &columns)?;
        } else {
            match columns[..] {
                ["XCells", count] => head.columns = count.parse().ok(),
                ["YCells", count] => head.rows = count.parse().ok(),
                ["XStep", step] => head.step = step.replace(',', ".").parse().ok(),
                _ => {}
            }
        }
    };
    let lines: Vec<(usize, &str)> = lines.filter(|(_, text)| !text.trim().is_empty()).collect();
    let points = lines.par_iter().map(|(line, text)| places.point(*line, text, &phases));
    let points = points.collect::<Result<_, Fault>>()?;
    Ok(PointList::of_plane(phases, points, head))
}

/// The phase of a line: lattice, angles, name and number of the Laue group.
fn phase(number: i64, text: &str) -> MapPhase {
    let mut columns = text.split('\t').skip(2).map(str::trim);
    let name = columns.next().filter(|name| !name.is_empty());
    MapPhase {
        number,
        name: name.map_or_else(|| format!("phase {number}"), str::to_owned),
        symmetry: columns.next().and_then(|code| code.parse().ok()).and_then(hkl_symmetry),
    }
}

/// The places of the columns that count.
struct Places {
    /// Phase and Euler angles.
    needed: [usize; 4],
    /// X, Y and band contrast.
    others: [Option<usize>; 3],
}

impl Places {
    fn of(line: usize, columns: &[&str]) -> Result<Self, Fault> {
        let place = |name: &str| columns.iter().position(|column| *column == name);
        let needed = |name: &str| {
            place(name).ok_or_else(|| (line, format!("no column is named {name}; give a whole .ctf file")))
        };
        Ok(Self {
            needed: [needed("Phase")?, needed("Euler1")?, needed("Euler2")?, needed("Euler3")?],
            others: ["X", "Y", "BC"].map(place),
        })
    }

    fn point(&self, line: usize, text: &str, phases: &[MapPhase]) -> Result<MapPoint, Fault> {
        let columns: Vec<&str> = text.split_whitespace().collect();
        let value = |place: usize| {
            let column = columns.get(place).ok_or_else(|| {
                (line, "fewer columns than names; write one for each name on each line".to_owned())
            })?;
            // Where the system's language has decimal commas the file has them too.
            if column.contains(',') { number(line, &column.replace(',', ".")) } else { number(line, column) }
        };
        let other = |which: usize| self.others[which].map_or(Ok(f64::NAN), value);
        let [number, phi1, phi, phi2] = self.needed;
        #[expect(clippy::cast_possible_truncation, reason = "numbers of phases are small")]
        let number = value(number)? as i64;
        let symmetry = phases.iter().find(|phase| phase.number == number).and_then(|phase| phase.symmetry);
        Ok(MapPoint {
            line,
            place: [other(0)?, other(1)?],
            phase: (number != 0).then_some(number),
            angles: [value(phi1)?, value(phi)?, value(phi2)? - symmetry.map_or(0.0, hkl_turn)],
            quality: other(2)?,
            confidence: None,
        })
    }
}
