//! Reads Surface Evolver's datafiles and dumps, line by line.

use glam::DVec3;
use voronoi::Dimension;

use crate::mesh::file::MeshFileProblem;

/// An edge, facet or other element with the sense in which it is run through.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Signed {
    /// Counted from 0.
    pub(super) index: usize,
    pub(super) is_reversed: bool,
}

/// What a datafile says of a network; elements are counted from 0, by their order in the file.
#[derive(Debug, Default)]
pub(super) struct Datafile {
    /// Edges bound bodies in the plane, facets in space.
    pub(super) is_plane: bool,
    /// The periods of the torus model.
    pub(super) periods: Option<DVec3>,
    pub(super) vertices: Vec<DVec3>,
    pub(super) edges: Vec<Edge>,
    /// Loops of edges: facets, in the plane cells.
    pub(super) faces: Vec<Vec<Signed>>,
    /// The number of each body and its faces; in the plane there is one.
    pub(super) bodies: Vec<(u32, Vec<Signed>)>,
}

#[derive(Debug)]
pub(super) struct Edge {
    pub(super) ends: [usize; 2],
    /// How many periods it crosses from its first end to the second.
    pub(super) wraps: [i32; 3],
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Section {
    Head,
    Vertices,
    Edges,
    Faces,
    Bodies,
}

impl Section {
    fn of_keyword(word: &str) -> Option<Self> {
        match word.to_ascii_lowercase().as_str() {
            "vertices" | "vertex" => Some(Self::Vertices),
            "edges" | "edge" => Some(Self::Edges),
            "faces" | "face" | "facets" | "facet" => Some(Self::Faces),
            "bodies" | "body" => Some(Self::Bodies),
            _ => None,
        }
    }
}

/// Numbers in the file, in increasing order or not, of the elements of one kind.
#[derive(Default)]
struct Numbers(std::collections::BTreeMap<u32, usize>);

impl Numbers {
    fn add(&mut self, line: &Line<'_>, what: &str) -> Result<u32, MeshFileProblem> {
        let word = line.words.first().copied().unwrap_or_default();
        let number: u32 = word
            .parse()
            .map_err(|_| line.problem(format!("{word:?} where the number of a {what} must stand")))?;
        match self.0.insert(number, self.0.len()) {
            None => Ok(number),
            Some(_) => Err(line.problem(format!("{what} {number} stands here a second time; leave one out"))),
        }
    }

    fn find(&self, line: &Line<'_>, word: &str, what: &str) -> Result<Signed, MeshFileProblem> {
        let number: i64 = word
            .parse()
            .map_err(|_| line.problem(format!("{word:?} where the number of a {what} must stand")))?;
        let found = u32::try_from(number.unsigned_abs()).ok().and_then(|number| self.0.get(&number));
        let index = found.copied().ok_or_else(|| {
            line.problem(format!(
                "there is no {what} {}; add it, or leave it out here",
                number.unsigned_abs()
            ))
        })?;
        Ok(Signed { index, is_reversed: number < 0 })
    }
}

/// A line without comments, together with those that a backslash joins to it.
struct Line<'a> {
    /// Counted from 0.
    index: usize,
    words: Vec<&'a str>,
}

impl Line<'_> {
    fn problem(&self, what: impl Into<String>) -> MeshFileProblem {
        MeshFileProblem::line(self.index, what)
    }

    fn coordinate(&self, place: usize) -> Result<f64, MeshFileProblem> {
        let word = self.words.get(place).copied().unwrap_or_default();
        let number = word.parse().ok().filter(|number: &f64| number.is_finite());
        number.ok_or_else(|| {
            let what = format!("{word:?} where a number must stand");
            self.problem(format!("{what}; write the state with Surface Evolver's command `dump`"))
        })
    }

    /// The numbers from a place on, up to the first word that is none.
    fn numbers_from(&self, place: usize) -> impl Iterator<Item = &str> {
        self.words.iter().skip(place).copied().take_while(|word| word.parse::<i64>().is_ok())
    }
}

/// Reads a datafile or a dump; constraints, quantities and all else that is not geometry are passed over.
///
/// # Errors
/// The line that is wrong; models other than that of straight edges and flat facets.
pub(super) fn read(bytes: &[u8]) -> Result<Datafile, MeshFileProblem> {
    let text = without_comments(&String::from_utf8_lossy(bytes));
    let mut file = Datafile::default();
    let mut section = Section::Head;
    let [mut vertices, mut edges, mut faces, mut bodies] = [(); 4].map(|()| Numbers::default());
    let mut missing_periods = 0;
    let mut dimension = Dimension::Three;
    for line in lines(&text) {
        let first = line.words[0];
        if first.eq_ignore_ascii_case("read") {
            break;
        }
        if let Some(next) = Section::of_keyword(first).filter(|_| line.words.len() == 1) {
            section = next;
            continue;
        }
        match section {
            Section::Head if missing_periods > 0 => {
                period(&mut file, 3 - missing_periods, &line)?;
                missing_periods -= 1;
            }
            Section::Head => match first.to_ascii_lowercase().as_str() {
                "string" => file.is_plane = true,
                "space_dimension" if line.words.get(1) == Some(&"2") => dimension = Dimension::Two,
                "quadratic" | "lagrange" | "simplex_representation" => {
                    return Err(line.problem(format!(
                        "the model {first} has curved elements; give Surface Evolver's command `linear`, then `dump`"
                    )));
                }
                "periods" => missing_periods = 3,
                _ => {}
            },
            Section::Vertices => {
                vertices.add(&line, "vertex")?;
                let z = if dimension == Dimension::Two { 0.0 } else { line.coordinate(3)? };
                file.vertices.push(DVec3::new(line.coordinate(1)?, line.coordinate(2)?, z));
            }
            Section::Edges => {
                edges.add(&line, "edge")?;
                let end = |place: usize| {
                    let word = line.words.get(place).copied().unwrap_or_default();
                    vertices.find(&line, word, "vertex").map(|end| end.index)
                };
                file.edges.push(Edge { ends: [end(1)?, end(2)?], wraps: wraps(&line) });
            }
            Section::Faces => {
                faces.add(&line, "face")?;
                let around = line.numbers_from(1).map(|word| edges.find(&line, word, "edge"));
                file.faces.push(around.collect::<Result<_, _>>()?);
                let count = file.faces.last().map_or(0, Vec::len);
                if count < 2 || count < 3 && !file.is_plane {
                    return Err(line.problem(format!("a face of {count} edges; give it at least three")));
                }
            }
            Section::Bodies => {
                let number = bodies.add(&line, "body")?;
                let around = line.numbers_from(1).map(|word| faces.find(&line, word, "face"));
                file.bodies.push((number, around.collect::<Result<_, _>>()?));
            }
        }
    }
    if file.is_plane != (dimension == Dimension::Two) {
        let what = "strings are read in the plane, with `space_dimension 2`, and facets in space";
        return Err(MeshFileProblem::corrupt("Surface Evolver", what));
    }
    if file.bodies.is_empty() {
        return Err(MeshFileProblem::corrupt("Surface Evolver", "it holds no bodies, which grains are"));
    }
    Ok(file)
}

/// Reads the vector of a period, which must lie along its axis.
fn period(file: &mut Datafile, axis: usize, line: &Line<'_>) -> Result<(), MeshFileProblem> {
    let count = if line.words.len() == 2 { 2 } else { 3 };
    for place in 0..count {
        let number = line.coordinate(place)?;
        if place != axis && number != 0.0 || place == axis && number <= 0.0 {
            return Err(
                line.problem("periods are read along the axes only: turn the torus, or shear it back")
            );
        }
        if place == axis {
            file.periods.get_or_insert(DVec3::ZERO)[axis] = number;
        }
    }
    Ok(())
}

/// How many periods an edge crosses along each axis: `*` none, `+` and `-` one.
fn wraps(line: &Line<'_>) -> [i32; 3] {
    let sign = |place: usize| match line.words.get(place) {
        Some(&"+") => 1,
        Some(&"-") => -1,
        _ => 0,
    };
    [3, 4, 5].map(sign)
}

/// The text with blanks in place of comments, so that lines keep their numbers.
fn without_comments(text: &str) -> String {
    let mut kept = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(begin) = rest.find('/') {
        let (before, comment) = rest.split_at(begin);
        kept += before;
        let end = if comment.starts_with("//") {
            comment.find('\n').unwrap_or(comment.len())
        } else if let Some(inside) = comment.strip_prefix("/*") {
            inside.find("*/").map_or(comment.len(), |end| end + 4)
        } else {
            kept.push('/');
            rest = &comment[1..];
            continue;
        };
        kept.push(' ');
        kept.extend(comment[..end].matches('\n'));
        rest = &comment[end..];
    }
    kept + rest
}

/// The lines that are not empty.
fn lines(text: &str) -> impl Iterator<Item = Line<'_>> {
    let mut lines = text.lines().enumerate();
    std::iter::from_fn(move || {
        loop {
            let (index, mut part) = lines.next()?;
            let mut words = Vec::new();
            while let Some(begun) = part.trim_end().strip_suffix('\\') {
                words.extend(begun.split_whitespace());
                part = lines.next().map_or("", |(_, next)| next);
            }
            words.extend(part.split_whitespace());
            if !words.is_empty() {
                return Some(Line { index, words });
            }
        }
    })
}
