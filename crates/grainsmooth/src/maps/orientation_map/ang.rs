//! TSL's maps: Euler angles in radians at each point. Points without a solution have a confidence below 0, or angles of 4 pi.

use rayon::prelude::*;
use texture::CrystalSymmetry;

use super::{Fault, HeadGrid, MapPhase, MapPoint, PointList, columns, is_unsolved_angle, number};

/// The column of the phase.
const PHASE: usize = 7;

/// The numbers of a line that count: to the phase, and the next one, which is not a number where there is none.
type Row = [f64; PHASE + 2];

/// Reads a map.
///
/// # Errors
/// The first line that is no point.
pub(crate) fn read(text: &str) -> Result<PointList, Fault> {
    let mut phases = Vec::new();
    let mut grid = HeadGrid::default();
    let mut lines = Vec::new();
    for (line, text) in (1..).zip(text.lines().map(str::trim)) {
        match text.strip_prefix('#') {
            Some(head) => read_head(head, &mut phases, &mut grid),
            None if !text.is_empty() => lines.push((line, text)),
            None => {}
        }
    }
    last(&mut phases);
    let rows = lines.par_iter().map(|(line, text)| row(*line, text)).collect::<Result<Vec<Row>, Fault>>()?;
    // Old programs write the fit before the phase.
    let is_whole = |column: usize| rows.iter().all(|row| row[column].fract() == 0.0);
    let phase_column = if !is_whole(PHASE) && is_whole(PHASE + 1) { PHASE + 1 } else { PHASE };
    let has_several_phases = phases.len() > 1;
    let point = |(row, (line, _)): (&Row, &(usize, &str))| {
        let [phi1, phi, phi2, x, y, quality, confidence, ..] = *row;
        #[expect(clippy::cast_possible_truncation, reason = "numbers of phases are small")]
        let phase = row[phase_column] as i64;
        // In maps of one phase its number may be 0.
        let is_solved = confidence >= 0.0
            && ![phi1, phi, phi2].into_iter().any(|angle| is_unsolved_angle(angle.to_degrees()))
            && !(has_several_phases && phase == 0);
        MapPoint {
            line: *line,
            place: [x, y],
            phase: is_solved.then_some(phase),
            angles: [phi1, phi, phi2].map(f64::to_degrees),
            quality,
            confidence: Some(confidence),
        }
    };
    let points = rows.iter().zip(&lines).map(point).collect();
    Ok(PointList::of_plane(phases, points, grid))
}

fn read_head(head: &str, phases: &mut Vec<MapPhase>, grid: &mut HeadGrid) {
    let mut words = columns(head);
    match (words.next(), words.next()) {
        (Some("Phase"), Some(number)) => {
            if let Ok(number) = number.parse() {
                phases.push(MapPhase { number, name: format!("phase {number}"), symmetry: None });
            }
        }
        (Some("MaterialName"), Some(_)) => {
            let name = head.trim_start().strip_prefix("MaterialName").unwrap_or_default().trim();
            name.clone_into(&mut last(phases).name);
        }
        (Some("Symmetry"), Some(code)) => last(phases).symmetry = symmetry(code),
        (Some("NCOLS_ODD:" | "NCOLS_EVEN:"), Some(count)) => {
            grid.columns = grid.columns.max(count.parse().ok())
        }
        (Some("NROWS:"), Some(count)) => grid.rows = count.parse().ok(),
        (Some("XSTEP:"), Some(step)) => grid.step = step.parse().ok(),
        _ => {}
    }
}

/// The last phase; the first where a file lists none.
fn last(phases: &mut Vec<MapPhase>) -> &mut MapPhase {
    if phases.is_empty() {
        phases.push(MapPhase { number: 1, name: "phase 1".to_owned(), symmetry: None });
    }
    phases.last_mut().expect("there is one")
}

fn row(line: usize, text: &str) -> Result<Row, Fault> {
    let mut row = [f64::NAN; PHASE + 2];
    let mut count = 0;
    for (value, column) in row.iter_mut().zip(columns(text)) {
        // What stands behind the phase differs from version to version.
        *value = if count > PHASE { column.parse().unwrap_or(f64::NAN) } else { number(line, column)? };
        count += 1;
    }
    if count > PHASE {
        return Ok(row);
    }
    Err((
        line,
        format!(
            "{count} columns; TSL's maps have phi1, Phi, phi2, x, y, quality, confidence, phase on each line"
        ),
    ))
}

/// TSL's number of a Laue group.
pub(crate) fn symmetry(code: &str) -> Option<CrystalSymmetry> {
    Some(match code {
        "1" => CrystalSymmetry::Triclinic,
        "2" | "20" => CrystalSymmetry::Monoclinic,
        "22" => CrystalSymmetry::Orthorhombic,
        "4" => CrystalSymmetry::TetragonalLow,
        "42" => CrystalSymmetry::Tetragonal,
        "3" => CrystalSymmetry::TrigonalLow,
        "32" => CrystalSymmetry::Trigonal,
        "6" => CrystalSymmetry::HexagonalLow,
        "62" => CrystalSymmetry::Hexagonal,
        "23" => CrystalSymmetry::Tetrahedral,
        "43" => CrystalSymmetry::Octahedral,
        _ => return None,
    })
}
