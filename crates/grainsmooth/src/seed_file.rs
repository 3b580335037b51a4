//! Seeds from a text file.
//!
//! Read line by line: the `csv` crate says of a record after comments the line where the comments began.

use std::fs;
use std::path::Path;

use glam::DVec3;
use voronoi::Dimension;

use crate::Error;

/// A seed as its file gives it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FileSeed {
    /// Coordinates in the user's unit of length; z = 0 in 2D.
    pub position: DVec3,
    /// Radius of the seed's sphere, whose square is its power weight; nothing where the file has no such column.
    pub radius: Option<f64>,
    /// Line of the file, counted from 1, for what is to be said about the seed later.
    pub line: usize,
}

/// What is wrong with a line of a seed file, and what to do about it.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SeedLineProblem {
    /// The line is not text.
    #[error("not UTF-8 text; save the file as UTF-8")]
    NotUtf8,
    /// The first line names other columns than the coordinates.
    #[error("columns named {names:?}; name them {} or drop the line", wanted(*.dimension))]
    ColumnNames {
        /// The line, cut short.
        names: String,
        /// What the file is read for.
        dimension: Dimension,
    },
    /// There are too many or too few columns.
    #[error("{found} columns; write {} on each line", wanted(*.dimension))]
    ColumnCount {
        /// Number of columns in the line.
        found: usize,
        /// What the file is read for.
        dimension: Dimension,
    },
    /// A column holds something else than a number.
    #[error("{value:?} is not a number; write {} as decimal numbers", wanted(*.dimension))]
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
    /// A seed of a 2D run has a third coordinate.
    #[error("z is {z} in a 2D run; set it to 0, run in 3D, or name the columns x, y, radius")]
    NotInPlane {
        /// The third coordinate.
        z: f64,
    },
}

fn wanted(dimension: Dimension) -> &'static str {
    match dimension {
        Dimension::Two => "x, y",
        Dimension::Three => "x, y, z",
    }
}

/// The columns of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Columns {
    Xy,
    Xyz,
    XyRadius,
    XyzRadius,
}

impl Columns {
    /// What the first line names them.
    fn named(names: &[&str], dimension: Dimension) -> Option<Self> {
        let names: Vec<String> = names.iter().map(|name| name.to_lowercase()).collect();
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        match (names.as_slice(), dimension) {
            (["x", "y"], Dimension::Two) => Some(Self::Xy),
            (["x", "y", "radius"], Dimension::Two) => Some(Self::XyRadius),
            (["x", "y", "z"], _) => Some(Self::Xyz),
            (["x", "y", "z", "radius"], _) => Some(Self::XyzRadius),
            _ => None,
        }
    }

    /// What so many columns without names are.
    fn counted(count: usize, dimension: Dimension) -> Option<Self> {
        match (count, dimension) {
            (2, Dimension::Two) => Some(Self::Xy),
            (3, _) => Some(Self::Xyz),
            (4, _) => Some(Self::XyzRadius),
            _ => None,
        }
    }
}

/// Reads seeds from a CSV file with one seed a line: `x, y, z`, or `x, y` in 2D.
///
/// Columns stand between commas or, in lines without a comma, between blanks or tabs. The first line may name
/// the columns; empty lines and lines that begin with `#` are skipped. A last column `radius` makes the cells power
/// (Laguerre) cells; after two coordinates it needs its name. In 2D a third coordinate is taken when it is 0, as programs
/// write it that know three dimensions only.
///
/// # Errors
/// [`Error::SeedFileUnreadable`] when the file cannot be read; [`Error::NoSeedsInFile`] when it holds none;
/// [`Error::BadSeedLine`] at the first line that is not as above or holds a number that is not finite.
pub fn read_seed_file(path: &Path, dimension: Dimension) -> Result<Vec<FileSeed>, Error> {
    let content =
        fs::read(path).map_err(|cause| Error::SeedFileUnreadable { path: path.to_owned(), cause })?;
    let mut seeds = Vec::new();
    let mut known_columns = None;
    for (index, bytes) in content.split(|&byte| byte == b'\n').enumerate() {
        let line = index + 1;
        let bad_line = |problem| Error::BadSeedLine { path: path.to_owned(), line, problem };
        let text = std::str::from_utf8(bytes).map_err(|_| bad_line(SeedLineProblem::NotUtf8))?;
        // Some editors begin a file with this invisible mark.
        let text = text.trim_start_matches('\u{feff}').trim();
        if text.is_empty() || text.starts_with('#') {
            continue;
        }
        let columns: Vec<&str> = if text.contains(',') {
            text.split(',').map(str::trim).collect()
        } else {
            text.split_whitespace().collect()
        };
        let are_names = columns.iter().all(|column| column.parse::<f64>().is_err());
        if known_columns.is_none() && are_names {
            known_columns = Some(Columns::named(&columns, dimension).ok_or_else(|| {
                bad_line(SeedLineProblem::ColumnNames { names: shortened(&columns.join(", ")), dimension })
            })?);
            continue;
        }
        let problem = || bad_line(SeedLineProblem::ColumnCount { found: columns.len(), dimension });
        let kind =
            known_columns.or_else(|| Columns::counted(columns.len(), dimension)).ok_or_else(problem)?;
        known_columns = Some(kind);
        let (position, radius) = seed(&columns, kind, dimension).map_err(bad_line)?;
        seeds.push(FileSeed { position, radius, line });
    }
    if seeds.is_empty() {
        return Err(Error::NoSeedsInFile { path: path.to_owned() });
    }
    Ok(seeds)
}

/// Position and radius in a line.
fn seed(
    texts: &[&str],
    columns: Columns,
    dimension: Dimension,
) -> Result<(DVec3, Option<f64>), SeedLineProblem> {
    let numbers: Vec<f64> = texts.iter().map(|text| number(text, dimension)).collect::<Result<_, _>>()?;
    let (position, radius) = match (columns, numbers.as_slice()) {
        (Columns::Xy, &[x, y]) => (DVec3::new(x, y, 0.0), None),
        (Columns::Xy | Columns::Xyz, &[x, y, z]) => (DVec3::new(x, y, z), None),
        (Columns::XyRadius, &[x, y, radius]) => (DVec3::new(x, y, 0.0), Some(radius)),
        (Columns::XyzRadius, &[x, y, z, radius]) => (DVec3::new(x, y, z), Some(radius)),
        _ => return Err(SeedLineProblem::ColumnCount { found: texts.len(), dimension }),
    };
    if dimension == Dimension::Two && position.z != 0.0 {
        return Err(SeedLineProblem::NotInPlane { z: position.z });
    }
    match radius {
        Some(radius) if radius < 0.0 => Err(SeedLineProblem::NegativeRadius { radius }),
        _ => Ok((position, radius)),
    }
}

fn number(column: &str, dimension: Dimension) -> Result<f64, SeedLineProblem> {
    match column.parse::<f64>() {
        Ok(number) if number.is_finite() => Ok(number),
        Ok(_) => Err(SeedLineProblem::NotFinite { value: shortened(column) }),
        Err(_) => Err(SeedLineProblem::NotANumber { value: shortened(column), dimension }),
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
mod tests {
    use super::*;

    fn read(content: impl AsRef<[u8]>, dimension: Dimension) -> Result<Vec<FileSeed>, String> {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("seeds.csv");
        fs::write(&path, content).unwrap();
        let prefix = format!("{}{}", directory.path().display(), std::path::MAIN_SEPARATOR);
        read_seed_file(&path, dimension).map_err(|error| error.to_string().replace(&prefix, ""))
    }

    fn seed(line: usize, x: f64, y: f64, z: f64) -> FileSeed {
        FileSeed { position: DVec3::new(x, y, z), radius: None, line }
    }

    #[test]
    fn files_as_users_have_them() {
        let plain = "0.1,0.2,0.3\n1e-3,-4,+5.\n";
        let expected = vec![seed(1, 0.1, 0.2, 0.3), seed(2, 1e-3, -4.0, 5.0)];
        assert_eq!(read(plain, Dimension::Three), Ok(expected.clone()));
        for separator in [", ", " ", "\t", "   ", " , "] {
            assert_eq!(read(plain.replace(',', separator), Dimension::Three), Ok(expected.clone()));
        }
        assert_eq!(read(plain.replace('\n', "\r\n"), Dimension::Three), Ok(expected.clone()));
        assert_eq!(read(plain.trim_end(), Dimension::Three), Ok(expected.clone()));
        assert_eq!(read(format!("\u{feff}{plain}"), Dimension::Three), Ok(expected));

        let dressed = "\n# from the tomogram\n X , Y, z\n\n 1, 2, 3 \n#4, 5, 6\n\t\n7, 8, 9\n\n";
        let expected = vec![seed(5, 1.0, 2.0, 3.0), seed(8, 7.0, 8.0, 9.0)];
        assert_eq!(read(dressed, Dimension::Three), Ok(expected));

        let flat = "x y\n1 2\n3 4 0\n";
        assert_eq!(read(flat, Dimension::Two), Ok(vec![seed(2, 1.0, 2.0, 0.0), seed(3, 3.0, 4.0, 0.0)]));
        assert_eq!(read("x,y,z\n1,2,0\n", Dimension::Two), Ok(vec![seed(2, 1.0, 2.0, 0.0)]));
    }

    #[test]
    fn radii_follow_the_coordinates() {
        let weighted = |line, x, y, z, radius| FileSeed { radius: Some(radius), ..seed(line, x, y, z) };
        let expected = vec![weighted(1, 1.0, 2.0, 3.0, 0.5), weighted(2, 4.0, 5.0, 6.0, 0.0)];
        assert_eq!(read("1,2,3,0.5\n4,5,6,0", Dimension::Three), Ok(expected));
        let named = "x,y,radius\n1,2,0.5\n";
        assert_eq!(read(named, Dimension::Two), Ok(vec![weighted(2, 1.0, 2.0, 0.0, 0.5)]));
        let named = "x y z radius\n1 2 0 0.5\n";
        assert_eq!(read(named, Dimension::Two), Ok(vec![weighted(2, 1.0, 2.0, 0.0, 0.5)]));
    }

    #[test]
    fn each_mistake_is_named_with_its_line() {
        let long = "1".repeat(50) + "o";
        let cut = format!("seeds.csv line 1: \"{}...\" is not a number; ", "1".repeat(40));
        for (content, dimension, message) in [
            (
                "1,2,3\n\n# c\n1,abc,3\n",
                3,
                "seeds.csv line 4: \"abc\" is not a number; write x, y, z as decimal numbers",
            ),
            ("1,2,3\n1,,3", 3, "seeds.csv line 2: \"\" is not a number; write x, y, z as decimal numbers"),
            ("1,2 3", 2, "seeds.csv line 1: \"2 3\" is not a number; write x, y as decimal numbers"),
            ("1, nan, 3", 3, "seeds.csv line 1: \"nan\" is not a finite number; correct or remove the seed"),
            (
                "1, 2, -inf",
                3,
                "seeds.csv line 1: \"-inf\" is not a finite number; correct or remove the seed",
            ),
            (
                "1, 2, 1e999",
                3,
                "seeds.csv line 1: \"1e999\" is not a finite number; correct or remove the seed",
            ),
            ("x,y,z\n1,2\n", 3, "seeds.csv line 2: 2 columns; write x, y, z on each line"),
            ("1,2,3,4,5\n", 3, "seeds.csv line 1: 5 columns; write x, y, z on each line"),
            ("1,2,3,-4\n", 3, "seeds.csv line 1: radius is -4; write 0 or more"),
            ("1,2,3\n1,2,3,4\n", 3, "seeds.csv line 2: 4 columns; write x, y, z on each line"),
            ("1\n", 2, "seeds.csv line 1: 1 columns; write x, y on each line"),
            (
                "1,2,0.5",
                2,
                "seeds.csv line 1: z is 0.5 in a 2D run; set it to 0, run in 3D, or name the columns x, y, radius",
            ),
            (
                "z,y,x\n1,2,3",
                3,
                "seeds.csv line 1: columns named \"z, y, x\"; name them x, y, z or drop the line",
            ),
            ("x,y\n1,2,3", 3, "seeds.csv line 1: columns named \"x, y\"; name them x, y, z or drop the line"),
            ("1,2,3\nx,y,z", 3, "seeds.csv line 2: \"x\" is not a number; write x, y, z as decimal numbers"),
            ("", 3, "seeds.csv: holds no seeds; write x, y, z on each line"),
            ("x,y,z\n# 1,2,3\n\n", 3, "seeds.csv: holds no seeds; write x, y, z on each line"),
            (&format!("1,2,{long}"), 3, &format!("{cut}write x, y, z as decimal numbers")),
        ] {
            let dimension = if dimension == 2 { Dimension::Two } else { Dimension::Three };
            assert_eq!(read(content, dimension), Err(message.to_owned()));
        }
    }

    #[test]
    fn files_that_are_no_text_or_cannot_be_read() {
        let not_text = read(b"1,2,3\n\xff\xfe1\0", Dimension::Three);
        assert_eq!(not_text, Err("seeds.csv line 2: not UTF-8 text; save the file as UTF-8".to_owned()));

        let directory = tempfile::tempdir().unwrap();
        for path in [directory.path().join("missing.csv"), directory.path().to_owned()] {
            let error = read_seed_file(&path, Dimension::Three).unwrap_err().to_string();
            assert!(error.starts_with(&format!("{}: cannot be read: ", path.display())), "{error}");
            assert!(error.ends_with("; give the path of a readable CSV file"), "{error}");
        }
    }
}
