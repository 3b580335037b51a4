//! Seeds from JSON: a list of coordinates, or a table of cells.

use glam::DVec3;
use serde_json::Value;
use voronoi::Dimension;

use super::{FileSeed, SeedPlace, SeedProblem, in_dimension, shortened, weight};

/// The seeds of a file.
pub(super) fn seeds(content: &[u8], dimension: Dimension) -> Result<Vec<FileSeed>, (SeedPlace, SeedProblem)> {
    let not_seeds = |line, what| (SeedPlace::Line(line), SeedProblem::NotJsonSeeds { what });
    let file: Value = serde_json::from_slice(content).map_err(|error| {
        let message = error.to_string();
        // What follows is the line, which stands before the message already.
        let what = message.split(" at line ").next().unwrap_or_default();
        not_seeds(error.line(), what.to_owned())
    })?;
    let list = file.get("cells").or_else(|| file.get("seeds")).unwrap_or(&file);
    let list = list.as_array().ok_or_else(|| not_seeds(1, "no list of seeds".to_owned()))?;
    let numbered = (1..).map(SeedPlace::Entry).zip(list);
    numbered
        .map(|(place, entry)| {
            let (position, weight) = seed(entry, dimension).map_err(|problem| (place, problem))?;
            let id = entry.get("SeedId").or_else(|| entry.get("id"));
            let id =
                id.map(|id| super::id(&id.to_string())).transpose().map_err(|problem| (place, problem))?;
            Ok(FileSeed { position, weight, id, place })
        })
        .collect()
}

/// Position and weight in an entry.
fn seed(entry: &Value, dimension: Dimension) -> Result<(DVec3, Option<f64>), SeedProblem> {
    let what =
        || SeedProblem::NotJsonSeeds { what: format!("{} is not a seed", shortened(&entry.to_string())) };
    let coordinates = entry.get("seed").unwrap_or(entry).as_array().ok_or_else(what)?;
    let numbers: Option<Vec<f64>> = coordinates.iter().map(Value::as_f64).collect();
    let number = |name| match entry.get(name) {
        None => Ok(None),
        Some(value) => value.as_f64().map(Some).ok_or_else(what),
    };
    let (position, listed) = match (numbers.ok_or_else(what)?.as_slice(), dimension) {
        (&[x, y], Dimension::Two) => (DVec3::new(x, y, 0.0), None),
        (&[x, y, z], _) => (DVec3::new(x, y, z), None),
        (&[x, y, z, radius], _) => (DVec3::new(x, y, z), Some(radius)),
        _ => return Err(what()),
    };
    let of_sphere = number("radius")?.or(listed).map(weight).transpose()?;
    Ok((in_dimension(position, dimension)?, number("weight")?.or(of_sphere)))
}
