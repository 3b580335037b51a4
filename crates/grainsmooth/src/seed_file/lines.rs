//! Seeds from lines of text: CSV and XYZ.
//!
//! Read line by line: the `csv` crate says of a record after comments the line where the comments began.

use glam::DVec3;
use voronoi::Dimension;

use super::{FileSeed, SeedPlace, SeedProblem, shortened, weight};

/// What is wrong, and where.
type Located<T> = Result<T, (SeedPlace, SeedProblem)>;

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

/// Seeds of a CSV file, one a line.
pub(super) fn csv(content: &[u8], dimension: Dimension) -> Located<Vec<FileSeed>> {
    let mut seeds = Vec::new();
    let mut known_columns = None;
    for line in lines(content) {
        let (place, text) = line?;
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
            let names = || SeedProblem::ColumnNames { names: shortened(&columns.join(", ")), dimension };
            known_columns = Some(Columns::named(&columns, dimension).ok_or_else(|| (place, names()))?);
            continue;
        }
        let count = SeedProblem::ColumnCount { found: columns.len(), dimension };
        let kind = known_columns.or_else(|| Columns::counted(columns.len(), dimension));
        let kind = kind.ok_or((place, count))?;
        known_columns = Some(kind);
        let (position, weight) = seed(&columns, kind, dimension).map_err(|problem| (place, problem))?;
        seeds.push(FileSeed { position, weight, place });
    }
    Ok(seeds)
}

/// Seeds of an XYZ file: their number, a remark, and in each further line the name of an element, which is not used, then
/// x, y, z and perhaps a radius. In 2D, z is 0.
pub(super) fn xyz(content: &[u8], dimension: Dimension) -> Located<Vec<FileSeed>> {
    let mut lines = lines(content);
    let Some((first, text)) = lines.next().transpose()? else { return Ok(Vec::new()) };
    let not_a_count = || (first, SeedProblem::NotACount { value: shortened(text) });
    let announced: usize = text.parse().map_err(|_| not_a_count())?;
    lines.next().transpose()?;
    let mut seeds = Vec::new();
    for line in lines {
        let (place, text) = line?;
        if text.is_empty() {
            continue;
        }
        let located = |problem| (place, problem);
        if seeds.len() == announced {
            return Err(located(SeedProblem::MoreThanAnnounced { announced }));
        }
        let columns: Vec<&str> = text.split_whitespace().collect();
        let (kind, coordinates) = match columns.len() {
            3 => (Columns::Xyz, &columns[..]),
            4 => (Columns::Xyz, &columns[1..]),
            5 => (Columns::XyzRadius, &columns[1..]),
            found => return Err(located(SeedProblem::XyzColumnCount { found })),
        };
        let (position, weight) = seed(coordinates, kind, dimension).map_err(located)?;
        seeds.push(FileSeed { position, weight, place });
    }
    if seeds.len() < announced {
        return Err((first, SeedProblem::FewerThanAnnounced { announced, found: seeds.len() }));
    }
    Ok(seeds)
}

/// The lines without blanks around them.
fn lines(content: &[u8]) -> impl Iterator<Item = Located<(SeedPlace, &str)>> {
    (1..).zip(content.split(|&byte| byte == b'\n')).map(|(line, bytes)| {
        let place = SeedPlace::Line(line);
        let text = std::str::from_utf8(bytes).map_err(|_| (place, SeedProblem::NotUtf8))?;
        // Some editors begin a file with this invisible mark.
        Ok((place, text.trim_start_matches('\u{feff}').trim()))
    })
}

/// Position and weight in a line.
fn seed(texts: &[&str], columns: Columns, dimension: Dimension) -> Result<(DVec3, Option<f64>), SeedProblem> {
    let numbers: Vec<f64> = texts.iter().map(|text| number(text, dimension)).collect::<Result<_, _>>()?;
    let (position, radius) = match (columns, numbers.as_slice()) {
        (Columns::Xy, &[x, y]) => (DVec3::new(x, y, 0.0), None),
        (Columns::Xy | Columns::Xyz, &[x, y, z]) => (DVec3::new(x, y, z), None),
        (Columns::XyRadius, &[x, y, radius]) => (DVec3::new(x, y, 0.0), Some(radius)),
        (Columns::XyzRadius, &[x, y, z, radius]) => (DVec3::new(x, y, z), Some(radius)),
        _ => return Err(SeedProblem::ColumnCount { found: texts.len(), dimension }),
    };
    Ok((super::in_dimension(position, dimension)?, radius.map(weight).transpose()?))
}

fn number(column: &str, dimension: Dimension) -> Result<f64, SeedProblem> {
    match column.parse::<f64>() {
        Ok(number) if number.is_finite() => Ok(number),
        Ok(_) => Err(SeedProblem::NotFinite { value: shortened(column) }),
        Err(_) => Err(SeedProblem::NotANumber { value: shortened(column), dimension }),
    }
}
