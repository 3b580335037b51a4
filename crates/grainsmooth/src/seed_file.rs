//! Seeds from files.

use std::collections::BTreeMap;
use std::fmt;
use std::fs;
use std::io;
use std::path::Path;

use glam::{BVec3, DVec3};
use voronoi::Dimension;

use crate::Error;

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

/// Where a seed stands in its file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SeedPlace {
    /// In a line, counted from 1.
    Line(usize),
    /// In an entry of a list, counted from 1.
    Entry(usize),
}

impl fmt::Display for SeedPlace {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Line(number) => write!(out, "line {number}"),
            Self::Entry(number) => write!(out, "entry {number}"),
        }
    }
}

/// What is wrong with a place of a seed file, and what to do about it.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SeedProblem {
    /// The line is not text.
    #[error("not UTF-8 text; save the file as UTF-8")]
    NotUtf8,
    /// The first line names columns, but not those of the coordinates.
    #[error("columns named {names:?}; name those of the seeds {}", wanted(*.dimension))]
    ColumnNames {
        /// The line, cut short.
        names: String,
        /// What the file is read for.
        dimension: Dimension,
    },
    /// A quoted column goes on in the next line, as where its second quote is missing.
    #[error("a quote that the line does not close; close or remove it")]
    OpenQuote,
    /// Two columns are named alike.
    #[error("two columns named {name}; rename one of them")]
    NamedTwice {
        /// The name.
        name: String,
    },
    /// Two columns say how large cells are.
    #[error("columns {} and {} both say how large grains are; rename one of them", names[0], names[1])]
    SizedTwice {
        /// The names.
        names: [String; 2],
    },
    /// There are too many or too few columns without names.
    #[error("{found} columns; write {} on each line, or name the columns in the first", wanted(*.dimension))]
    ColumnCount {
        /// Number of columns in the line.
        found: usize,
        /// What the file is read for.
        dimension: Dimension,
    },
    /// A line has more or fewer columns than those before.
    #[error("{found} columns after lines of {expected}; write as many on each line")]
    UnequalColumns {
        /// Number of columns in the line.
        found: usize,
        /// Number of columns in the lines before.
        expected: usize,
    },
    /// A column holds something else than a number.
    #[error("{value:?} is not a number; write {} as numbers such as 0.5", wanted(*.dimension))]
    NotANumber {
        /// The column, cut short.
        value: String,
        /// What the file is read for.
        dimension: Dimension,
    },
    /// A number is infinite, NaN, or too large for a double.
    #[error("{value:?} is not a finite number; correct or remove the seed")]
    NotFinite {
        /// The column, cut short.
        value: String,
    },
    /// A radius is negative.
    #[error("radius is {radius}; write 0 or more")]
    NegativeRadius {
        /// The radius.
        radius: f64,
    },
    /// A diameter is negative.
    #[error("diameter is {diameter}; write 0 or more")]
    NegativeDiameter {
        /// The diameter.
        diameter: f64,
    },
    /// A number of a seed that `SeedId` cannot hold.
    #[error("id {value:?} is no whole number from 0 to {}; number the seeds, or rename the column", i32::MAX)]
    BadId {
        /// The number, cut short.
        value: String,
    },
    /// A seed has no number in the column of numbers.
    #[error("the id is empty; number each seed, or rename the column")]
    EmptyId,
    /// Two seeds have the same number.
    #[error("id {id} is that of {first} too; give each seed its own, or rename the column")]
    IdTwice {
        /// The number.
        id: u32,
        /// Where the other seed stands.
        first: SeedPlace,
    },
    /// Some seeds have numbers, and this one has none.
    #[error("no id, and other seeds have one; give each seed its own, or none")]
    NoId,
    /// A seed of a 2D run has a third coordinate.
    #[error("z is {z} in a 2D run; set it to 0, run in 3D, or name the columns x, y, radius")]
    NotInPlane {
        /// The third coordinate.
        z: f64,
    },
    /// An XYZ file does not begin with a number of seeds.
    #[error(
        "{value:?} is not a number of seeds, which an .xyz file begins with; name a file without it .csv"
    )]
    NotACount {
        /// The line, cut short.
        value: String,
    },
    /// A line of an XYZ file has too many or too few columns.
    #[error("{found} columns; write an element, x, y, z and perhaps a radius on each line")]
    XyzColumnCount {
        /// Number of columns in the line.
        found: usize,
    },
    /// An XYZ file has more lines than its first line says, perhaps a second frame.
    #[error(
        "a seed after the {announced} that the first line announces; correct the number, or give one frame only"
    )]
    MoreThanAnnounced {
        /// The number of seeds in the first line.
        announced: usize,
    },
    /// An XYZ file has fewer lines than its first line says.
    #[error("{announced} seeds announced and {found} there; give the complete file, or correct the number")]
    FewerThanAnnounced {
        /// The number of seeds in the first line.
        announced: usize,
        /// The number of seeds in the file.
        found: usize,
    },
    /// The file is not JSON, or has no list of seeds.
    #[error("{what}; write [[x, y, z], ...], [[x, y, z, radius], ...] or what --cells-json writes")]
    NotJsonSeeds {
        /// What is wrong.
        what: String,
    },
    /// The file is no .tess file, or holds what cannot be made here.
    #[error("{what}")]
    Tess {
        /// What is wrong, and what to do about it.
        what: String,
    },
}

fn wanted(dimension: Dimension) -> &'static str {
    match dimension {
        Dimension::Two => "x, y",
        Dimension::Three => "x, y, z",
    }
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
/// - `.xyz`: the number of seeds, a remark, then lines of an element (not used), x, y, z and perhaps a radius.
/// - `.json`: a list of `[x, y, z]` or `[x, y, z, radius]`, or a [table of cells](crate::CellTable), whose seeds, weights and numbers
///   (`SeedId` or else `id`) are taken.
/// - `.tess`: Neper's seeds and weights (radii), where its cells are those of its seeds to 1e-6 of their volume; what they fill is
///   told by [`read_file_domain`]. The `*id` of a cell is the number of its seed, from 1 there and from 0 here.
///   [`FileSeeds::passed_over`] tells whether it has orientations, which are not read.
///
/// # Errors
/// [`Error::SeedFileUnreadable`] when the file cannot be read; [`Error::NoSeedsInFile`] when it holds none;
/// [`Error::BadSeed`] at the first place that is not as above or holds a number that is not finite.
pub fn read_seed_file(path: &Path, dimension: Dimension) -> Result<FileSeeds, Error> {
    let content = content(path)?;
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
    tess::domain(&content(path)?).map(Some).map_err(|problem| located(path, problem))
}

fn content(path: &Path) -> Result<Vec<u8>, Error> {
    fs::read(path).map_err(|cause: io::Error| Error::SeedFileUnreadable { path: path.to_owned(), cause })
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
