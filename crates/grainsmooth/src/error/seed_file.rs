//! What is wrong with a file of seeds, and where.

use std::fmt;

use voronoi::Dimension;

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
#[non_exhaustive]
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
    #[error("a quote is not closed on its line; close or remove it")]
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
    #[error("{found} columns, but earlier lines have {expected}; write the same number on each line")]
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
    #[error(
        "id {value:?} is not a whole number from 0 to {}; number the seeds, or rename the column",
        i32::MAX
    )]
    BadId {
        /// The number, cut short.
        value: String,
    },
    /// A seed has no number in the column of numbers.
    #[error("the id is empty; number each seed, or rename the column")]
    EmptyId,
    /// Two seeds have the same number.
    #[error("id {id} is also that of {first}; give each seed its own, or rename the column")]
    IdTwice {
        /// The number.
        id: u32,
        /// Where the other seed stands.
        first: SeedPlace,
    },
    /// Some seeds have numbers, and this one has none.
    #[error("no id, but other seeds have one; give each seed its own, or none")]
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
    #[error("{found} columns; write an element, x, y, z and, if known, a radius on each line")]
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
    #[error("{announced} seeds announced, but {found} found; give the complete file, or correct the number")]
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
