//! TSL's maps: Euler angles in radians at each point. What has no solution (confidence below 0, or angles of 4 pi) is left out.

use std::collections::BTreeMap;
use std::f64::consts::TAU;

use texture::{CrystalSymmetry, Orientation};

use super::{Fault, MapPoint, OrientationList, columns, keep_phase, number};

/// Columns of the confidence and of the phase.
const CONFIDENCE: usize = 6;
const PHASE: usize = 7;

/// Reads the points of a map, of one phase where one is asked for, each of weight 1.
pub(super) fn read(text: &str, asked: Option<i64>) -> Result<OrientationList, Fault> {
    let mut symmetries: BTreeMap<i64, CrystalSymmetry> = BTreeMap::new();
    let (mut phase, mut points) = (1, Vec::new());
    for (line, text) in (1..).zip(text.lines().map(str::trim)) {
        if let Some(head) = text.strip_prefix('#') {
            match columns(head)[..] {
                ["Phase", number] => phase = number.parse().unwrap_or(phase),
                ["Symmetry", code] => {
                    symmetries.extend(symmetry(code).map(|symmetry| (phase, symmetry)));
                }
                _ => {}
            }
            continue;
        }
        let columns = columns(text);
        if columns.is_empty() {
            continue;
        }
        let numbers = columns.iter().take(PHASE + 1).map(|column| number(line, column));
        let numbers = numbers.collect::<Result<Vec<f64>, Fault>>()?;
        if numbers.len() <= PHASE {
            let found = numbers.len();
            return Err((
                line,
                format!(
                    "{found} columns; TSL's maps have phi1, Phi, phi2, x, y, quality, confidence, phase on each line"
                ),
            ));
        }
        let angles = [numbers[0], numbers[1], numbers[2]];
        if numbers[CONFIDENCE] < 0.0 || angles.iter().any(|angle| *angle > 1.99 * TAU) {
            continue;
        }
        #[expect(clippy::cast_possible_truncation, reason = "numbers of phases are small")]
        let phase = numbers[PHASE] as i64;
        points.push(MapPoint { line, phase, angles: angles.map(f64::to_degrees) });
    }
    // A map of one phase may call it 0.
    let symmetry = keep_phase(&mut points, asked)?.and_then(|phase| {
        symmetries.get(&phase).copied().or_else(|| symmetries.values().next().copied().filter(|_| phase == 0))
    });
    let orientations =
        points.into_iter().map(|point| (Orientation::from_euler_degrees(point.angles), 1.0)).collect();
    Ok(OrientationList { orientations, symmetry })
}

/// TSL's number of a Laue group.
fn symmetry(code: &str) -> Option<CrystalSymmetry> {
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
