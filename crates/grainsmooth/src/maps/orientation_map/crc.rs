//! HKL's maps in two files: `.cpr` with the head as text, `.crc` with a packed record for each point, row by row.
//!
//! What is known of them is what MTEX and DefDAP read.

use super::hkl::{hkl_symmetry, hkl_turn};
use super::{HeadGrid, MapPhase, MapPoint, PointList};
use crate::error::map_file::MapProblem;
use crate::maps::stored_numbers::Source;

/// What a record may hold after the phase, by the numbers of the head: those with 1 byte, all others with 4.
const SHORT_FIELDS: [u32; 4] = [7, 8, 10, 11];

/// Numbers of the fields that count.
const X: u32 = 1;
const Y: u32 = 2;
const ANGLES: [u32; 3] = [3, 4, 5];
const BAND_CONTRAST: u32 = 7;

/// Reads a map from either of its files; the other lies beside it.
///
/// # Errors
/// [`MapProblem`] where the other file cannot be read, the head lacks what is needed, or the points are fewer than it tells.
pub(in super::super) fn read(source: &Source<'_>) -> Result<PointList, MapProblem> {
    let is_head = source.path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("cpr"));
    let beside = source.path.with_extension(if is_head { "crc" } else { "cpr" });
    let other = source.beside(&beside.file_name().unwrap_or_default().to_string_lossy())?;
    let (head, records) = if is_head { (source.bytes, &other[..]) } else { (&other[..], source.bytes) };
    let text = String::from_utf8_lossy(head);
    let head = Head(&text);
    let columns: usize = head.needed("Job", "xCells")?;
    let rows: usize = head.needed("Job", "yCells")?;
    let step: f64 = head.needed("Job", "GridDistX")?;
    let row_step: f64 = head.value("Job", "GridDistY").unwrap_or(step);
    let phases = head.phases()?;
    let record = Record::new(&head)?;
    let count = columns.checked_mul(rows).filter(|count| *count > 0);
    let found = records.len() / record.length;
    if count.is_none_or(|count| count > found) {
        return Err(damaged(format!("it has {found} points for {columns} x {rows} cells")));
    }
    let point = |(at, bytes): (usize, &[u8])| {
        let number = i64::from(bytes[0]);
        let symmetry = phases.iter().find(|phase| phase.number == number).and_then(|phase| phase.symmetry);
        let [phi1, phi, phi2] = ANGLES.map(|field| record.value(bytes, field).to_degrees());
        let on_grid = [(at % columns) as f64 * step, (at / columns) as f64 * row_step];
        let place = [X, Y].map(|field| record.value(bytes, field));
        MapPoint {
            line: at + 1,
            place: if place.iter().all(|along| along.is_finite()) { place } else { on_grid },
            phase: (number != 0 && [phi1, phi, phi2].iter().all(|angle| angle.is_finite())).then_some(number),
            angles: [phi1, phi, phi2 - symmetry.map_or(0.0, hkl_turn)],
            quality: record.value(bytes, BAND_CONTRAST),
            confidence: None,
        }
    };
    let points = records.chunks_exact(record.length).take(columns * rows).enumerate().map(point).collect();
    let told = HeadGrid { columns: Some(columns), rows: Some(rows), step: Some(step) };
    Ok(PointList::of_plane(phases, points, told))
}

/// Groups of lines `key=value`, each group after its name in brackets.
struct Head<'a>(&'a str);

impl Head<'_> {
    fn value<T: std::str::FromStr>(&self, group: &str, key: &str) -> Option<T> {
        let mut is_in_group = false;
        for line in self.0.lines().map(str::trim) {
            if let Some(name) = line.strip_prefix('[').and_then(|line| line.strip_suffix(']')) {
                is_in_group = name.eq_ignore_ascii_case(group);
            } else if let Some((name, value)) = line.split_once('=').filter(|_| is_in_group)
                && name.trim().eq_ignore_ascii_case(key)
            {
                // Where the system's language has decimal commas the file has them too.
                let value = value.trim();
                return value.parse().or_else(|_| value.replace(',', ".").parse()).ok();
            }
        }
        None
    }

    fn needed<T: std::str::FromStr>(&self, group: &str, key: &str) -> Result<T, MapProblem> {
        self.value(group, key).ok_or_else(|| damaged(format!("its .cpr file has no {key} under [{group}]")))
    }

    fn phases(&self) -> Result<Vec<MapPhase>, MapProblem> {
        let count: u8 = self.needed("Phases", "Count")?;
        let phase = |number: u8| {
            let group = format!("Phase{number}");
            let name = self.value(&group, "StructureName").filter(|name: &String| !name.is_empty());
            let symmetry = self.value(&group, "LaueGroup").and_then(hkl_symmetry);
            MapPhase {
                number: number.into(),
                name: name.unwrap_or_else(|| format!("phase {number}")),
                symmetry,
            }
        };
        Ok((1..=count).map(phase).collect())
    }
}

/// Where the fields of a record begin.
struct Record {
    fields: Vec<(u32, usize)>,
    length: usize,
}

impl Record {
    fn new(head: &Head<'_>) -> Result<Self, MapProblem> {
        let count: u8 = head.needed("Fields", "Count")?;
        // The phase comes first and is not listed.
        let mut record = Self { fields: Vec::new(), length: 1 };
        for number in 1..=count {
            let field: u32 = head.needed("Fields", &format!("Field{number}"))?;
            record.fields.push((field, record.length));
            record.length += if SHORT_FIELDS.contains(&field) { 1 } else { 4 };
        }
        match ANGLES.into_iter().find(|angle| record.fields.iter().all(|(field, _)| field != angle)) {
            Some(angle) => Err(damaged(format!("its points have no Euler angle: field {angle} is missing"))),
            None => Ok(record),
        }
    }

    /// The number in a field of a point; not a number where it has none.
    fn value(&self, bytes: &[u8], field: u32) -> f64 {
        let Some((_, start)) = self.fields.iter().find(|(known, _)| *known == field) else { return f64::NAN };
        match bytes[*start..].first_chunk::<4>() {
            _ if SHORT_FIELDS.contains(&field) => bytes[*start].into(),
            Some(bytes) => f32::from_le_bytes(*bytes).into(),
            None => f64::NAN,
        }
    }
}

fn damaged(what: String) -> MapProblem {
    MapProblem::Damaged { format: "HKL", what }
}
