//! Networks in the plane from polygons, one or more for each grain: JSON with shared points, as MATLAB writes the grains of MTEX, and tables.

use std::collections::{BTreeMap, HashMap};

use glam::{DVec2, DVec3};
use serde::Deserialize;

use crate::files::text_table;
use crate::mesh::file::vtk::labelled::{LabelledCells, Notes};
use crate::mesh::file::{MeshFile, MeshFileProblem};
use crate::names::{EULER_ANGLES, PHASE, PHASE_NAMES, SEED_ID};
use crate::vtk::{DataArray, FieldValue};

/// Grains by the names that they have in MTEX.
#[derive(Deserialize)]
struct Grains {
    /// Coordinates of points.
    #[serde(rename = "V")]
    points: Vec<[f64; 2]>,
    /// The points around each grain, counted from 1, each polygon closed by its first point. Further polygons of a grain follow: holes and other parts.
    poly: Vec<Vec<u32>>,
    #[serde(default)]
    id: Vec<u32>,
    #[serde(default)]
    phase: Vec<u32>,
    /// Bunge's angles in degrees.
    #[serde(default)]
    euler: Vec<[f64; 3]>,
}

/// Reads `{"V": [[x, y], ...], "poly": [[1, 2, 3, 1], ...], "id": [...], "phase": [...], "euler": [...]}`; the last three may be missing.
///
/// # Errors
/// The line where JSON ends to be right; the grain with a point that does not exist, or without two neighbours.
pub(super) fn read_json(bytes: &[u8]) -> Result<LabelledCells, MeshFileProblem> {
    let Grains { points, poly, id, phase, euler }: Grains = serde_json::from_slice(bytes)
        .map_err(|error| MeshFileProblem::line(error.line().saturating_sub(1), error.to_string()))?;
    for (name, count) in [("id", id.len()), ("phase", phase.len()), ("euler", euler.len())] {
        if count != 0 && count != poly.len() {
            return Err(problem(format!("{name} has {count} entries for {} polygons", poly.len())));
        }
    }
    if let Some(place) = phase.iter().position(|phase| *phase == 0) {
        let grain = place + 1;
        return Err(problem(format!(
            "polygon {grain} has phase 0, which is what was not indexed; leave it out"
        )));
    }
    let known = |(grain, corners): (usize, &Vec<u32>)| {
        let place = |number: &u32| {
            let place = number.checked_sub(1).filter(|place| (*place as usize) < points.len());
            place.ok_or_else(|| {
                problem(format!("polygon {} has point {number}, and V has 1 to {}", grain + 1, points.len()))
            })
        };
        corners.iter().map(place).collect::<Result<Vec<u32>, _>>()
    };
    let corners: Vec<Vec<u32>> = poly.iter().enumerate().map(known).collect::<Result<_, _>>()?;
    let points: Vec<DVec3> = points.into_iter().map(|[x, y]| DVec3::new(x, y, 0.0)).collect();
    let ids = if id.is_empty() { (0..).take(poly.len()).collect() } else { id };
    let mut cells = network(points, &corners, &ids)?;
    let notes = &mut cells.notes;
    if let Some(last) = phase.iter().max() {
        let names: Vec<String> = (1..=*last).map(|number| number.to_string()).collect();
        notes.note(PHASE_NAMES, FieldValue::Text(names.join(",")));
        notes.note(PHASE, whole_numbers(PHASE, &phase));
    }
    if !euler.is_empty() {
        let angles = euler.into_iter().flatten().collect();
        notes.note(EULER_ANGLES, FieldValue::Data(DataArray::float64(EULER_ANGLES, 3, angles)));
    }
    Ok(cells)
}

fn whole_numbers(name: &'static str, numbers: &[u32]) -> FieldValue {
    FieldValue::Data(DataArray::int32(name, numbers.iter().map(|number| number.cast_signed()).collect()))
}

/// Reads lines `grain,x,y` with the points around each grain, in their order; points are one where their coordinates are equal.
///
/// # Errors
/// The line that is wrong; the grain without a polygon.
pub(super) fn read_csv(bytes: &[u8]) -> Result<LabelledCells, MeshFileProblem> {
    let of_text = |(line, problem): (usize, text_table::TextProblem)| {
        MeshFileProblem::line(line.saturating_sub(1), problem.to_string())
    };
    let mut points = Vec::new();
    let mut seen: HashMap<[u64; 2], u32> = HashMap::new();
    let mut grains: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
    for (index, row) in text_table::rows(bytes).map_err(of_text)?.enumerate() {
        let row = row.map_err(of_text)?;
        let columns = row.columns();
        if index == 0 && text_table::are_names(&columns) {
            continue;
        }
        let wrong = |what: String| MeshFileProblem::line(row.line - 1, what);
        let [grain, x, y] = columns[..] else {
            return Err(wrong(format!("{} columns; write three: grain,x,y", columns.len())));
        };
        let number = |word: &str| {
            let number = word.parse::<f64>().ok().filter(|number| number.is_finite());
            // Adding 0 makes one zero of two.
            number
                .map(|number| number + 0.0)
                .ok_or_else(|| wrong(format!("{word:?} is no coordinate; give a number")))
        };
        let grain = grain
            .parse()
            .map_err(|_| wrong(format!("{grain:?} is no number of a grain; give 0, 1 and so on")))?;
        let place = [number(x)?, number(y)?];
        let next =
            u32::try_from(points.len()).map_err(|_| problem("it has more points than ids can name"))?;
        let id = *seen.entry(place.map(f64::to_bits)).or_insert(next);
        if id == next {
            points.push(DVec3::new(place[0], place[1], 0.0));
        }
        grains.entry(grain).or_default().push(id);
    }
    let (ids, corners): (Vec<u32>, Vec<Vec<u32>>) = grains.into_iter().unzip();
    network(points, &corners, &ids)
}

fn problem(what: impl ToString) -> MeshFileProblem {
    MeshFileProblem::corrupt("polygon", what)
}

/// The segments between grains, numbered from 0, and between them and the exterior.
fn network(points: Vec<DVec3>, grains: &[Vec<u32>], ids: &[u32]) -> Result<LabelledCells, MeshFileProblem> {
    // From the smaller point of each segment to the larger, the grains to the left and right.
    let mut segments: BTreeMap<[u32; 2], [Option<usize>; 2]> = BTreeMap::new();
    for (grain, corners) in grains.iter().enumerate() {
        let polygons = polygons(corners);
        if polygons.is_empty() {
            return Err(problem(format!("grain {} has no polygon of three points", ids[grain])));
        }
        for (index, polygon) in polygons.iter().enumerate() {
            let inside = polygons.iter().enumerate().filter(|(other, around)| {
                *other != index && is_inside(middle(&points, polygon), &points, around)
            });
            let is_hole = inside.count() % 2 == 1;
            let is_left = (area(&points, polygon) > 0.0) != is_hole;
            for [from, to] in sides(polygon) {
                let ends = [from.min(to), from.max(to)];
                let side = usize::from((from < to) != is_left);
                if segments.entry(ends).or_default()[side].replace(grain).is_some() {
                    let [x, y, _] = points[from as usize].to_array();
                    return Err(problem(format!("grain {} overlaps another at ({x}, {y})", ids[grain])));
                }
            }
        }
    }
    let label = |side: Option<usize>| side.map_or(-1, |grain| i64::try_from(grain).expect("fewer than ids"));
    let (mut faces, mut labels) = (Vec::new(), Vec::new());
    for ([from, to], sides) in segments {
        let [left, right] = sides.map(label);
        let is_turned = left < 0 || right >= 0 && right < left;
        faces.push(if is_turned { vec![to, from] } else { vec![from, to] });
        labels.push(if is_turned { [right, left] } else { [left, right] });
    }
    let mut notes = Notes::default();
    notes.note(SEED_ID, whole_numbers(SEED_ID, ids));
    Ok(LabelledCells {
        mesh: MeshFile { points, faces, ..MeshFile::default() },
        is_plane: true,
        labels,
        label_array: "FaceLabels",
        notes,
        ..LabelledCells::default()
    })
}

/// The closed polygons of a list of points: each ends where its first point comes again, the last also at the end.
fn polygons(corners: &[u32]) -> Vec<Vec<u32>> {
    let mut polygons: Vec<Vec<u32>> = Vec::new();
    let mut open: Vec<u32> = Vec::new();
    for corner in corners {
        if open.first() == Some(corner) {
            polygons.push(std::mem::take(&mut open));
        } else if open.last() != Some(corner) {
            open.push(*corner);
        }
    }
    polygons.push(open);
    polygons.retain(|polygon| polygon.len() >= 3);
    polygons
}

fn sides(polygon: &[u32]) -> impl Iterator<Item = [u32; 2]> {
    polygon.iter().zip(polygon.iter().cycle().skip(1)).map(|(from, to)| [*from, *to])
}

/// The middle of the first side: other polygons of the grain have at most points in common with this one.
fn middle(points: &[DVec3], polygon: &[u32]) -> DVec2 {
    points[polygon[0] as usize].midpoint(points[polygon[1] as usize]).truncate()
}

/// Twice the area, positive where the polygon runs counterclockwise.
fn area(points: &[DVec3], polygon: &[u32]) -> f64 {
    let origin = points[polygon[0] as usize].truncate();
    sides(polygon)
        .map(|ends| ends.map(|end| points[end as usize].truncate() - origin))
        .map(|[from, to]| from.perp_dot(to))
        .sum()
}

/// Whether a horizontal ray to the right crosses the polygon an odd number of times.
fn is_inside(place: DVec2, points: &[DVec3], polygon: &[u32]) -> bool {
    let crossed = sides(polygon).map(|ends| ends.map(|end| points[end as usize].truncate() - place)).filter(
        |[from, to]| {
            let rises = (from.y > 0.0) != (to.y > 0.0);
            rises && (from.perp_dot(*to) > 0.0) == (to.y > from.y)
        },
    );
    crossed.count() % 2 == 1
}
