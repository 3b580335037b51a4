//! Seeds from lines of text: CSV and XYZ.

use glam::DVec3;
use voronoi::Dimension;

use super::{FileSeed, SeedPlace, SeedProblem, shortened, weight};
use crate::files::text_table::{self, TextProblem};

/// What is wrong, and where.
type Located<T> = Result<T, (SeedPlace, SeedProblem)>;

/// What a column may say of the size of a cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Size {
    Radius,
    Diameter,
    Weight,
}

impl Size {
    fn named(name: &str) -> Option<Self> {
        match name {
            "radius" => Some(Self::Radius),
            "diameter" => Some(Self::Diameter),
            "weight" => Some(Self::Weight),
            _ => None,
        }
    }

    /// The power weight that a number of this column stands for.
    fn weight(self, number: f64) -> Result<f64, SeedProblem> {
        match self {
            Self::Radius => weight(number),
            Self::Diameter if number < 0.0 => Err(SeedProblem::NegativeDiameter { diameter: number }),
            Self::Diameter => weight(number / 2.0),
            Self::Weight => Ok(number),
        }
    }
}

/// Where the lines of a file have what of a seed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Columns {
    count: usize,
    x: usize,
    y: usize,
    z: Option<usize>,
    size: Option<(usize, Size)>,
    id: Option<usize>,
}

impl Columns {
    const XY: Self = Self { count: 2, x: 0, y: 1, z: None, size: None, id: None };
    const XYZ: Self = Self { count: 3, z: Some(2), ..Self::XY };
    const XYZ_RADIUS: Self = Self { count: 4, size: Some((3, Size::Radius)), ..Self::XYZ };

    /// What the names in the first line say; columns of other names are passed over.
    fn named(names: &[&str], dimension: Dimension) -> Result<Self, SeedProblem> {
        let lower: Vec<String> = names.iter().map(|name| name.to_lowercase()).collect();
        let mut columns = Self { count: names.len(), ..Self::XY };
        let mut found = [None; 3];
        for (place, name) in lower.iter().enumerate() {
            if let Some(axis) = ["x", "y", "z"].iter().position(|axis| axis == name) {
                if found[axis].replace(place).is_some() {
                    return Err(SeedProblem::NamedTwice { name: name.clone() });
                }
            } else if let Some(size) = Size::named(name)
                && let Some((other, _)) = columns.size.replace((place, size))
            {
                return Err(SeedProblem::SizedTwice { names: [lower[other].clone(), name.clone()] });
            }
        }
        // A table of cells has both: the numbers of cells, and those that their seeds had.
        let named = |name| lower.iter().position(|other| other == name);
        columns.id = named("seedid").or_else(|| named("id"));
        match (found, dimension) {
            ([Some(x), Some(y), None], Dimension::Two) => Ok(Self { x, y, ..columns }),
            ([Some(x), Some(y), Some(z)], _) => Ok(Self { x, y, z: Some(z), ..columns }),
            _ => Err(SeedProblem::ColumnNames { names: shortened(&names.join(", ")), dimension }),
        }
    }

    /// What so many columns without names are.
    fn counted(count: usize, dimension: Dimension) -> Option<Self> {
        match (count, dimension) {
            (2, Dimension::Two) => Some(Self::XY),
            (3, _) => Some(Self::XYZ),
            (4, _) => Some(Self::XYZ_RADIUS),
            _ => None,
        }
    }

    /// The columns of one line: after x and y, z may stand, as programs write it that know three dimensions only.
    fn of_line(self, count: usize) -> Option<Self> {
        match (self, count) {
            _ if self.count == count => Some(self),
            (Self::XY, 3) => Some(Self::XYZ),
            _ => None,
        }
    }
}

/// Seeds of a CSV file, one a line.
pub(super) fn csv(content: &[u8], dimension: Dimension) -> Located<Vec<FileSeed>> {
    let mut seeds = Vec::new();
    let mut known_columns = None;
    for row in text_table::rows(content).map_err(of_text)? {
        let row = row.map_err(of_text)?;
        let place = SeedPlace::Line(row.line);
        let located = |problem| (place, problem);
        let texts = row.columns();
        if known_columns.is_none() && text_table::are_names(&texts) {
            known_columns = Some(Columns::named(&texts, dimension).map_err(located)?);
            continue;
        }
        let found = texts.len();
        let columns = known_columns.or_else(|| Columns::counted(found, dimension));
        let columns = columns.ok_or((place, SeedProblem::ColumnCount { found, dimension }))?;
        known_columns = Some(columns);
        let unequal = SeedProblem::UnequalColumns { found, expected: columns.count };
        let columns = columns.of_line(found).ok_or((place, unequal))?;
        let (position, weight) = seed(&texts, columns, dimension).map_err(located)?;
        let id = columns.id.map(|column| super::id(texts[column])).transpose();
        seeds.push(FileSeed { position, weight, id: id.map_err(located)?, place });
    }
    Ok(seeds)
}

/// Seeds of an XYZ file: their number, a comment, and in each further line the name of an element, which is not used, then
/// x, y, z and perhaps a radius. In 2D, z is 0.
pub(super) fn xyz(content: &[u8], dimension: Dimension) -> Located<Vec<FileSeed>> {
    let mut lines = text_table::lines(content)
        .map(|line| line.map(|(line, text)| (SeedPlace::Line(line), text)).map_err(of_text));
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
            3 => (Columns::XYZ, &columns[..]),
            4 => (Columns::XYZ, &columns[1..]),
            5 => (Columns::XYZ_RADIUS, &columns[1..]),
            found => return Err(located(SeedProblem::XyzColumnCount { found })),
        };
        let (position, weight) = seed(coordinates, kind, dimension).map_err(located)?;
        seeds.push(FileSeed { position, weight, id: None, place });
    }
    if seeds.len() < announced {
        return Err((first, SeedProblem::FewerThanAnnounced { announced, found: seeds.len() }));
    }
    Ok(seeds)
}

fn of_text((line, problem): (usize, TextProblem)) -> (SeedPlace, SeedProblem) {
    let problem = match problem {
        TextProblem::NotUtf8 => SeedProblem::NotUtf8,
        TextProblem::OpenQuote => SeedProblem::OpenQuote,
    };
    (SeedPlace::Line(line), problem)
}

/// Position and weight in a line.
fn seed(texts: &[&str], columns: Columns, dimension: Dimension) -> Result<(DVec3, Option<f64>), SeedProblem> {
    let number = |place: usize| number(texts[place], dimension);
    let position = DVec3::new(number(columns.x)?, number(columns.y)?, columns.z.map_or(Ok(0.0), number)?);
    let weight = columns.size.map(|(place, size)| size.weight(number(place)?)).transpose()?;
    Ok((super::in_dimension(position, dimension)?, weight))
}

fn number(column: &str, dimension: Dimension) -> Result<f64, SeedProblem> {
    match column.parse::<f64>() {
        Ok(number) if number.is_finite() => Ok(number),
        Ok(_) => Err(SeedProblem::NotFinite { value: shortened(column) }),
        Err(_) => Err(SeedProblem::NotANumber { value: shortened(column), dimension }),
    }
}
