//! Seeds from files.

use std::collections::BTreeMap;
use std::path::Path;

use glam::{BVec3, DVec3};
use voronoi::Dimension;

use crate::Error;
use crate::error::seed_file::{SeedPlace, SeedProblem};
use crate::files::read_input;

mod json;
mod lines;
mod tess;

/// A seed as its file gives it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FileSeed {
    /// Coordinates in the user's unit of length; z = 0 in 2D.
    pub position: DVec3,
    /// Power weight, the square of the radius of the seed's sphere; nothing where the file has no radii.
    pub weight: Option<f64>,
    /// Its number, which `SeedId` is to hold; nothing where the file has none.
    pub id: Option<u32>,
    /// Where it stands, for what is to be said about the seed later.
    pub place: SeedPlace,
}

/// The seeds of a file.
#[derive(Debug, Clone, PartialEq)]
pub struct FileSeeds {
    /// One or more, in the order of the file.
    pub seeds: Vec<FileSeed>,
    /// What the file also tells of its grains, and has no place here.
    pub passed_over: Option<&'static str>,
}

/// The format of a seed file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum SeedFormat {
    Csv,
    Xyz,
    Json,
    Tess,
}

impl SeedFormat {
    /// The format that the path's extension names; CSV where it names none.
    fn of_path(path: &Path) -> Self {
        let extension = path.extension().unwrap_or_default().to_ascii_lowercase();
        match extension.to_str() {
            Some("xyz") => Self::Xyz,
            Some("json") => Self::Json,
            Some("tess") => Self::Tess,
            _ => Self::Csv,
        }
    }
}

/// Reads seeds from a file, whose extension names the format.
///
/// - Any text, `.csv`: one seed a line, `x, y, z`, or `x, y` in 2D. Columns stand between semicolons, commas, blanks or tabs, and
///   may be quoted. The first line may name the columns, which then have any order; one of `radius`, `diameter` and `weight`
///   makes the cells power (Laguerre) cells, `SeedId` or else `id` numbers the seeds, and columns of other names are passed over, so a
///   [table of cells](crate::CellTable) is read. Without names, a fourth column is the radius. Empty lines and lines that begin with `#` are skipped. In 2D
///   a third coordinate is taken when it is 0, as programs write it that know three dimensions only.
/// - `.xyz`: the number of seeds, a comment, then lines of an element (not used), x, y, z and perhaps a radius.
/// - `.json`: a list of `[x, y, z]` or `[x, y, z, radius]`, or a [table of cells](crate::CellTable), whose seeds, weights and numbers
///   (`SeedId` or else `id`) are taken.
/// - `.tess`: Neper's seeds and weights (radii), where its cells are those of its seeds to 1e-6 of their volume; what they fill is
///   told by [`read_file_domain`]. The `*id` of a cell is the number of its seed, from 1 there and from 0 here.
///   [`FileSeeds::passed_over`] tells whether it has orientations, which are not read.
///
/// ```
/// use std::path::Path;
///
/// use grainsmooth::read_seed_file;
/// use grainsmooth::voronoi::Dimension;
///
/// let file = read_seed_file(Path::new("data/spheres.csv"), Dimension::Three)?;
/// assert_eq!(file.seeds.len(), 30);
/// assert!(file.seeds.iter().all(|seed| seed.weight.is_some()), "radii squared");
/// # Ok::<(), grainsmooth::Error>(())
/// ```
///
/// # Errors
/// [`Error::Unreadable`] when the file cannot be read; [`Error::NoSeedsInFile`] when it holds none;
/// [`Error::BadSeed`] at the first place that is not as above or holds a number that is not finite.
pub fn read_seed_file(path: &Path, dimension: Dimension) -> Result<FileSeeds, Error> {
    let content = read_input(path, "file")?;
    let alone = |seeds| FileSeeds { seeds, passed_over: None };
    let seeds = match SeedFormat::of_path(path) {
        SeedFormat::Csv => lines::csv(&content, dimension).map(alone),
        SeedFormat::Xyz => lines::xyz(&content, dimension).map(alone),
        SeedFormat::Json => json::seeds(&content, dimension).map(alone),
        SeedFormat::Tess => tess::seeds(&content),
    };
    let FileSeeds { mut seeds, passed_over } = seeds.map_err(|problem| located(path, problem))?;
    if seeds.is_empty() {
        return Err(Error::NoSeedsInFile { path: path.to_owned() });
    }
    // Equal spheres make the cells that no spheres make.
    if seeds.iter().all(|seed| seed.weight == Some(0.0)) {
        seeds.iter_mut().for_each(|seed| seed.weight = None);
    }
    check_ids(&seeds).map_err(|problem| located(path, problem))?;
    Ok(FileSeeds { seeds, passed_over })
}

/// Checks that each seed has a number of its own, or none has one.
fn check_ids(seeds: &[FileSeed]) -> Result<(), (SeedPlace, SeedProblem)> {
    let mut places = BTreeMap::new();
    for seed in seeds {
        if let Some(id) = seed.id
            && let Some(first) = places.insert(id, seed.place)
        {
            return Err((seed.place, SeedProblem::IdTwice { id, first }));
        }
    }
    match seeds.iter().find(|seed| seed.id.is_none()) {
        Some(seed) if !places.is_empty() => Err((seed.place, SeedProblem::NoId)),
        _ => Ok(()),
    }
}

/// A number of a seed, perhaps written as 3.0, from its text.
fn id(text: &str) -> Result<u32, SeedProblem> {
    if text.is_empty() {
        return Err(SeedProblem::EmptyId);
    }
    let whole = text.strip_suffix(".0").unwrap_or(text).parse::<u32>().ok();
    let held = whole.filter(|id| i32::try_from(*id).is_ok());
    held.ok_or_else(|| SeedProblem::BadId { value: shortened(text) })
}

/// What the seeds of a file fill.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FileDomain {
    /// Two or three dimensions.
    pub dimension: Dimension,
    /// Side lengths of the box, which has its lower corner in the origin; z is 1 in 2D.
    pub box_size: DVec3,
    /// Axes along which it repeats.
    pub periodic: BVec3,
}

/// Reads what the seeds of a file fill; nothing where its format does not tell, as only .tess does.
///
/// # Errors
/// As of [`read_seed_file`]; [`Error::BadSeed`] for a domain that is no box with a corner in the origin.
pub fn read_file_domain(path: &Path) -> Result<Option<FileDomain>, Error> {
    if SeedFormat::of_path(path) != SeedFormat::Tess {
        return Ok(None);
    }
    tess::domain(&read_input(path, "file")?).map(Some).map_err(|problem| located(path, problem))
}

fn located(path: &Path, (place, problem): (SeedPlace, SeedProblem)) -> Error {
    Error::BadSeed { path: path.to_owned(), place, problem }
}

/// The weight of a sphere.
fn weight(radius: f64) -> Result<f64, SeedProblem> {
    if radius < 0.0 { Err(SeedProblem::NegativeRadius { radius }) } else { Ok(radius * radius) }
}

/// The position, found to lie in the plane in 2D.
fn in_dimension(position: DVec3, dimension: Dimension) -> Result<DVec3, SeedProblem> {
    match dimension {
        Dimension::Two if position.z != 0.0 => Err(SeedProblem::NotInPlane { z: position.z }),
        _ => Ok(position),
    }
}

/// As much of the user's text as a message of one line bears.
fn shortened(text: &str) -> String {
    const LENGTH: usize = 40;
    match text.char_indices().nth(LENGTH) {
        Some((end, _)) => format!("{}...", &text[..end]),
        None => text.to_owned(),
    }
}

#[cfg(test)]
mod tests;
