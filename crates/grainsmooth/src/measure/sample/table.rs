//! Grains of a table: those of `--cells-csv`, `--cells-json`, `--stats`, of [`SampleReport`](crate::SampleReport), or of other programs.

use std::collections::BTreeMap;
use std::path::Path;

use glam::{BVec3, DVec3};
use serde_json::Value;
use texture::Orientation;
use voronoi::Dimension;

use super::{MeasuredGrain, MeasuredSample};
use crate::Error;
use crate::files::{TEXT_FILE, read_input};
use crate::input::size_file::{DIAMETERS, Rows};

/// Columns that only tables of grains in the plane have.
const OF_PLANE: [&str; 2] = ["perimeter", "circularity"];

/// Columns with the number of a grain's faces: of cells, of measured grains, of other programs.
const FACES_IN_SPACE: [&str; 3] = ["faces", "nfaces", "numneighbors"];
const SIDES_IN_PLANE: [&str; 3] = ["sides", "nedges", "numneighbors"];

/// The numbers of a row by the names of their columns in lower case. One of a list of numbers has several, one of other text none.
struct Row {
    /// From 1: the line of a text, or the place in a list of JSON.
    line: usize,
    columns: BTreeMap<String, Vec<f64>>,
}

impl Row {
    fn list(&self, name: &str) -> &[f64] {
        self.columns.get(name).map_or(&[], |numbers| numbers)
    }

    fn number(&self, name: &str) -> Option<f64> {
        match self.list(name) {
            [number] => Some(*number),
            _ => None,
        }
    }

    fn first_of(&self, names: &[&str]) -> Option<f64> {
        names.iter().find_map(|name| self.number(name))
    }
}

pub(super) fn read(path: &Path, dimension: Option<Dimension>) -> Result<MeasuredSample, Error> {
    let bytes = read_input(path, TEXT_FILE)?;
    let bad = |line, problem: String| Error::BadLine { path: path.to_owned(), line, problem };
    let rows = if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("json")) {
        rows_of_json(&bytes)
    } else {
        rows_of_text(&bytes)
    };
    let rows = rows.map_err(|(line, problem)| bad(line, problem))?;
    let Some(first) = rows.first() else {
        return Err(bad(1, "holds no grains; give one on each line".to_owned()));
    };
    let has = |name: &str| first.columns.contains_key(name);
    let dimension = match (OF_PLANE.into_iter().any(has), has("volume")) {
        (true, false) => Dimension::Two,
        (false, true) => Dimension::Three,
        _ => dimension.unwrap_or(Dimension::Three),
    };
    let grain = |(place, row): (u32, &Row)| {
        grain_of(row, place, dimension).ok_or_else(|| {
            let name = if dimension == Dimension::Two { "area" } else { "volume" };
            bad(row.line, format!("no number under diameter or {name}; name one column so, and fill it in"))
        })
    };
    let grains = (0..).zip(&rows).map(grain).collect::<Result<_, _>>()?;
    Ok(MeasuredSample { dimension, grains, box_size: None, periodic: BVec3::FALSE, symmetry: None })
}

fn grain_of(row: &Row, place: u32, dimension: Dimension) -> Option<MeasuredGrain> {
    let (volume, faces, roundness) = match dimension {
        Dimension::Two => ("area", SIDES_IN_PLANE, "circularity"),
        Dimension::Three => ("volume", FACES_IN_SPACE, "sphericity"),
    };
    let diameter = || row.first_of(&DIAMETERS).map(|diameter| dimension.ball_volume(diameter));
    let volume = row.number(volume).or_else(diameter)?;
    let moment = |names: [&str; 3]| {
        let [x, y, z] = names.map(|name| row.number(name));
        Some(DVec3::new(x?, y?, z.or((dimension == Dimension::Two).then_some(0.0))?) / volume)
    };
    let inertia = || {
        let about = moment(["inertia_xx", "inertia_yy", "inertia_zz"])?;
        Some(0.5 * about.element_sum() - about)
    };
    let angles = match row.list("eulerangles") {
        [phi1, phi, phi2] => Some([*phi1, *phi, *phi2]),
        _ => match ["phi1", "phi", "phi2"].map(|name| row.number(name)) {
            [Some(phi1), Some(phi), Some(phi2)] => Some([phi1, phi, phi2]),
            _ => None,
        },
    };
    // Numbers below 0 are walls.
    let is_cut =
        row.number("at_exterior") == Some(1.0) || row.list("neighbors").iter().any(|side| *side < 0.0);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "whole and not negative")]
    let whole =
        |number: f64| (number >= 0.0 && number.fract() == 0.0 && number < 4e9).then_some(number as u32);
    Some(MeasuredGrain {
        id: row.number("id").and_then(whole).unwrap_or(place),
        volume,
        sphericity: row.number(roundness),
        faces: row.first_of(&faces).and_then(whole).map(|count| count as usize),
        is_cut,
        second_moment: inertia().or_else(|| moment(["moment_xx", "moment_yy", "moment_zz"])),
        orientation: angles.map(Orientation::from_euler_degrees),
        phase: row.number("phase").and_then(whole),
    })
}

fn rows_of_text(content: &[u8]) -> Result<Vec<Row>, (usize, String)> {
    let rows = Rows::new(content)?;
    let names = match rows.only() {
        Some(_) => vec![DIAMETERS[0].to_owned()],
        None => rows.names.clone(),
    };
    let row = |(line, columns): &(usize, Vec<String>)| {
        let numbers = names.iter().cloned().zip(columns.iter().map(|text| numbers_of_text(text)));
        Row { line: *line, columns: numbers.collect() }
    };
    Ok(rows.rows.iter().map(row).collect())
}

/// The numbers of a column, with blanks between them; none of other text.
fn numbers_of_text(text: &str) -> Vec<f64> {
    match text {
        "true" => vec![1.0],
        "false" => vec![0.0],
        _ => text.split_whitespace().map(|word| word.parse().ok()).collect::<Option<_>>().unwrap_or_default(),
    }
}

/// The list `cells` or `grains` of a document, or the document itself.
fn rows_of_json(bytes: &[u8]) -> Result<Vec<Row>, (usize, String)> {
    let document: Value = serde_json::from_slice(bytes)
        .map_err(|error| (error.line().max(1), format!("{error}; give a complete JSON document")))?;
    let list = ["cells", "grains"].into_iter().find_map(|name| document.get(name)).unwrap_or(&document);
    let problem = || (1, "no list of grains; give one under the name cells or grains".to_owned());
    let rows = list.as_array().ok_or_else(problem)?;
    let row = |(line, row): (usize, &Value)| {
        let columns = row.as_object().ok_or_else(problem)?;
        let columns = columns.iter().map(|(name, value)| (name.to_lowercase(), numbers_of_json(value)));
        Ok(Row { line, columns: columns.collect() })
    };
    (1..).zip(rows).map(row).collect()
}

fn numbers_of_json(value: &Value) -> Vec<f64> {
    match value {
        Value::Bool(flag) => vec![f64::from(*flag)],
        Value::Array(values) => values.iter().map(Value::as_f64).collect::<Option<_>>().unwrap_or_default(),
        value => value.as_f64().into_iter().collect(),
    }
}
