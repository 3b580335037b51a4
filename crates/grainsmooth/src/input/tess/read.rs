//! Reads a .tess file, word by word.

use glam::DVec3;
use texture::Orientation;
use voronoi::{Dimension, Wall};

use super::{Oriented, POLYHEDRON, Tess, TessCopy, TessDomain, TessFace, TessPeriodicity, TessSeed};

/// What is wrong with a .tess file.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("line {line}: {what}")]
pub struct TessProblem {
    /// Line, counted from 1.
    pub line: usize,
    /// What is wrong there, and what to do about it.
    pub what: String,
}

/// Versions whose sections are those that are read here.
const VERSIONS: [&str; 3] = ["3.3", "3.4", "3.5"];

/// The version from which on an edge of the domain says what curve it is.
const VERSION_WITH_CURVES: &str = "3.5";

/// Reads a tessellation, standard or periodic; scales are passed over, and orientations in descriptors that are not known.
///
/// # Errors
/// [`TessProblem`] at the first word that is not what it must be, or that refers to what does not exist.
pub fn read_tess(text: &str) -> Result<Tess, TessProblem> {
    let mut words = Words::new(text);
    words.expect("***tess")?;
    words.expect("**format")?;
    let version = words.next("the version")?;
    if !VERSIONS.contains(&version) {
        return Err(words.problem(format!(
            "version {version:?} is none of {}; write the file again with another Neper",
            VERSIONS.join(", ")
        )));
    }
    words.expect("**general")?;
    let dimension = match words.next("the dimension")? {
        "2" => Dimension::Two,
        "3" => Dimension::Three,
        other => return Err(words.problem(format!("{other:?} is not a dimension; write 2 or 3"))),
    };
    words.next("the type")?;
    let mut reader = Reader { words, version, cell_count: 0 };
    let mut tess = Tess {
        dimension,
        ids: Vec::new(),
        groups: Vec::new(),
        has_orientations: false,
        orientations: Vec::new(),
        crystal_symmetry: None,
        seeds: Vec::new(),
        vertices: Vec::new(),
        edges: Vec::new(),
        faces: Vec::new(),
        polyhedra: Vec::new(),
        domain: TessDomain { kind: String::new(), lower: DVec3::ZERO, upper: DVec3::ZERO, walls: Vec::new() },
        periodicity: None,
    };
    loop {
        match reader.words.next("***end")? {
            "***end" => break,
            "**cell" => reader.cells(&mut tess)?,
            "**vertex" => tess.vertices = reader.vertices()?,
            "**edge" => tess.edges = reader.edges(tess.vertices.len())?,
            "**face" => tess.faces = reader.faces(&tess)?,
            "**polyhedron" => tess.polyhedra = reader.polyhedra(tess.faces.len())?,
            "**domain" => tess.domain = reader.domain(&tess)?,
            "**periodicity" => tess.periodicity = Some(reader.periodicity(&tess)?),
            section if section.starts_with("**") => reader.words.skip_section(),
            word => return Err(reader.words.problem(format!("{word:?} where a section must begin"))),
        }
    }
    let (what, count) = match dimension {
        Dimension::Two => ("faces", tess.faces.len()),
        Dimension::Three => ("polyhedra", tess.polyhedra.len()),
    };
    if count != reader.cell_count {
        return Err(reader.words.problem(format!("{count} {what} for {} cells", reader.cell_count)));
    }
    Ok(tess)
}

/// The words of the text and the line of the last one.
struct Words<'a> {
    words: std::iter::Peekable<Box<dyn Iterator<Item = (usize, &'a str)> + 'a>>,
    line: usize,
}

impl<'a> Words<'a> {
    fn new(text: &'a str) -> Self {
        let lines = (1..).zip(text.lines());
        let words = lines.flat_map(|(line, text)| text.split_whitespace().map(move |word| (line, word)));
        let words: Box<dyn Iterator<Item = (usize, &'a str)> + 'a> = Box::new(words);
        Self { words: words.peekable(), line: 1 }
    }

    fn next(&mut self, what: &str) -> Result<&'a str, TessProblem> {
        match self.words.next() {
            Some((line, word)) => {
                self.line = line;
                Ok(word)
            }
            None => Err(self.problem(format!("the file ends before {what}; give a complete file"))),
        }
    }

    fn expect(&mut self, expected: &str) -> Result<(), TessProblem> {
        let word = self.next(expected)?;
        if word == expected {
            Ok(())
        } else {
            Err(self.problem(format!("{word:?} where {expected} must stand")))
        }
    }

    fn count(&mut self, what: &str) -> Result<usize, TessProblem> {
        let word = self.next(what)?;
        word.parse().map_err(|_| self.problem(format!("{word:?} is not {what}")))
    }

    fn number(&mut self, what: &str) -> Result<f64, TessProblem> {
        let word = self.next(what)?;
        let number = word.parse().ok().filter(|number: &f64| number.is_finite());
        number.ok_or_else(|| self.problem(format!("{word:?} is not {what}")))
    }

    fn point(&mut self) -> Result<DVec3, TessProblem> {
        Ok(DVec3::new(
            self.number("an x coordinate")?,
            self.number("a y coordinate")?,
            self.number("a z coordinate")?,
        ))
    }

    /// The number of a cell from 0, as it is of the seed, where the next word counts from 1.
    fn seed_id(&mut self) -> Result<u32, TessProblem> {
        let word = self.next("the id of a cell")?;
        let id = word.parse::<i32>().ok().and_then(|id| u32::try_from(id - 1).ok());
        id.ok_or_else(|| self.problem(format!("{word:?} is not an id of a cell; number cells from 1")))
    }

    /// Checks that the next word is the number of the item at `index`.
    fn id(&mut self, what: &str, index: usize) -> Result<(), TessProblem> {
        let id = self.count(what)?;
        if id == index + 1 {
            Ok(())
        } else {
            Err(self.problem(format!("{what} {id} where {} must stand", index + 1)))
        }
    }

    /// The number of one of `count` things, from 0.
    fn index(&mut self, what: &str, count: usize) -> Result<u32, TessProblem> {
        let oriented = self.oriented(what, count)?;
        if oriented.is_reversed {
            Err(self.problem(format!("a negative {what}")))
        } else {
            Ok(oriented.index)
        }
    }

    /// The number of one of `count` things, negative where it is reversed.
    fn oriented(&mut self, what: &str, count: usize) -> Result<Oriented, TessProblem> {
        let word = self.next(what)?;
        let number: i64 =
            word.parse().map_err(|_| self.problem(format!("{word:?} is not the number of a {what}")))?;
        let index = number.unsigned_abs().checked_sub(1).and_then(|index| u32::try_from(index).ok());
        match index.filter(|&index| (index as usize) < count) {
            Some(index) => Ok(Oriented { index, is_reversed: number < 0 }),
            None => Err(self.problem(format!("{what} {number} does not exist, there are {count}"))),
        }
    }

    fn translation(&mut self) -> Result<[i32; 3], TessProblem> {
        let mut translation = [0; 3];
        for periods in &mut translation {
            let word = self.next("a number of periods")?;
            *periods =
                word.parse().map_err(|_| self.problem(format!("{word:?} is not a number of periods")))?;
        }
        Ok(translation)
    }

    /// A part of the periodicity; edges and faces say last whether they run the same way.
    fn copies(&mut self, what: &str, count: usize, has_sense: bool) -> Result<Vec<TessCopy>, TessProblem> {
        self.expect(&format!("*{what}"))?;
        let length = self.count("a number of copies")?;
        self.list(length, |words, _| {
            let secondary = words.index(what, count)?;
            let index = words.index(what, count)?;
            let translation = words.translation()?;
            let is_reversed = has_sense && words.next("1 or -1")? == "-1";
            Ok(TessCopy { secondary, primary: Oriented { index, is_reversed }, translation })
        })
    }

    /// So many items; memory grows with what is read, not with what a corrupt file announces.
    fn list<T>(
        &mut self,
        count: usize,
        mut item: impl FnMut(&mut Self, usize) -> Result<T, TessProblem>,
    ) -> Result<Vec<T>, TessProblem> {
        let mut items = Vec::new();
        for index in 0..count {
            items.push(item(self, index)?);
        }
        Ok(items)
    }

    /// Whether a section, or a part of one, begins here.
    fn is_at(&mut self, stars: &str) -> bool {
        self.words.peek().is_some_and(|(_, word)| word.starts_with(stars))
    }

    fn skip_section(&mut self) {
        while self.words.peek().is_some() && !self.is_at("**") {
            self.words.next();
        }
    }

    fn problem(&self, what: String) -> TessProblem {
        TessProblem { line: self.line, what }
    }
}

struct Reader<'a> {
    words: Words<'a>,
    version: &'a str,
    cell_count: usize,
}

impl Reader<'_> {
    fn cells(&mut self, tess: &mut Tess) -> Result<(), TessProblem> {
        self.cell_count = self.words.count("the number of cells")?;
        while !self.words.is_at("**") {
            match self.words.next("***end")? {
                "*id" => tess.ids = self.words.list(self.cell_count, |words, _| words.seed_id())?,
                "*group" => {
                    tess.groups = self.words.list(self.cell_count, |words, _| {
                        let group = words.count("the group of a cell")?;
                        u32::try_from(group)
                            .map_err(|_| words.problem(format!("{group} is not a group of a cell")))
                    })?;
                }
                "*seed" => {
                    tess.seeds = self.words.list(self.cell_count, |words, index| {
                        words.id("seed", index)?;
                        Ok(TessSeed { position: words.point()?, radius: words.number("a weight")? })
                    })?;
                }
                "*ori" => {
                    tess.has_orientations = true;
                    tess.orientations = self.orientations();
                }
                "*crysym" => tess.crystal_symmetry = self.words.next("a symmetry")?.parse().ok(),
                _ => {}
            }
        }
        Ok(())
    }

    /// The orientations of the cells; none where they are not as many, or not understood.
    fn orientations(&mut self) -> Vec<Orientation> {
        let mut words = Vec::new();
        while !self.words.is_at("*")
            && let Some((line, word)) = self.words.words.next()
        {
            self.words.line = line;
            words.push(word);
        }
        let Some((descriptor, numbers)) = words.split_first() else { return Vec::new() };
        let numbers: Option<Vec<f64>> =
            numbers.iter().map(|word| word.parse().ok().filter(|number: &f64| number.is_finite())).collect();
        let numbers = numbers.unwrap_or_default();
        // Passive is what Neper takes where it is not said.
        let orientations: Option<Vec<Orientation>> = match descriptor.trim_end_matches(":passive") {
            "rodrigues" => {
                let vectors = numbers.as_chunks().0.iter();
                Some(vectors.map(|vector| Orientation::from_rodrigues(DVec3::from_array(*vector))).collect())
            }
            "quaternion" => {
                numbers.as_chunks().0.iter().map(|parts| Orientation::from_quaternion(*parts)).collect()
            }
            "euler-bunge" => {
                let angles = numbers.as_chunks().0.iter();
                Some(angles.map(|angles| Orientation::from_euler_degrees(*angles)).collect())
            }
            _ => None,
        };
        orientations.filter(|found| found.len() == self.cell_count).unwrap_or_default()
    }

    fn vertices(&mut self) -> Result<Vec<DVec3>, TessProblem> {
        let count = self.words.count("the number of vertices")?;
        self.words.list(count, |words, index| {
            words.id("vertex", index)?;
            let position = words.point()?;
            words.next("a state")?;
            Ok(position)
        })
    }

    fn edges(&mut self, vertex_count: usize) -> Result<Vec<[u32; 2]>, TessProblem> {
        let count = self.words.count("the number of edges")?;
        self.words.list(count, |words, index| {
            words.id("edge", index)?;
            let ends = [words.index("vertex", vertex_count)?, words.index("vertex", vertex_count)?];
            words.next("a state")?;
            Ok(ends)
        })
    }

    fn faces(&mut self, tess: &Tess) -> Result<Vec<TessFace>, TessProblem> {
        let count = self.words.count("the number of faces")?;
        self.words.list(count, |words, index| {
            words.id("face", index)?;
            let corners = words.count("the number of corners")?;
            let vertices = words.list(corners, |words, _| words.index("vertex", tess.vertices.len()))?;
            let edges = words.count("the number of edges")?;
            let edges = words.list(edges, |words, _| words.oriented("edge", tess.edges.len()))?;
            let mut plane = [0.0; 4];
            for number in &mut plane {
                *number = words.number("a number of the plane")?;
            }
            for what in ["a state", "a point", "its x", "its y", "its z"] {
                words.next(what)?;
            }
            Ok(TessFace { vertices, edges, plane })
        })
    }

    fn polyhedra(&mut self, face_count: usize) -> Result<Vec<Vec<Oriented>>, TessProblem> {
        let count = self.words.count("the number of polyhedra")?;
        self.words.list(count, |words, index| {
            words.id("polyhedron", index)?;
            let faces = words.count("the number of faces")?;
            words.list(faces, |words, _| words.oriented("face", face_count))
        })
    }

    fn domain(&mut self, tess: &Tess) -> Result<TessDomain, TessProblem> {
        let words = &mut self.words;
        words.expect("*general")?;
        let kind = match (words.next("the kind of domain")?, tess.dimension) {
            ("cube", Dimension::Two) => "square",
            (kind, _) => kind,
        };
        words.expect("*vertex")?;
        let count = words.count("the number of corners")?;
        let (mut lower, mut upper) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        words.list(count, |words, index| {
            words.id("corner", index)?;
            let corner = words.point()?;
            (lower, upper) = (lower.min(corner), upper.max(corner));
            words.next("a label")?;
            skip_counted(words)
        })?;
        if count == 0 {
            return Err(words.problem("a domain without corners".to_owned()));
        }
        let mut domain = TessDomain { kind: kind.to_owned(), lower, upper, walls: Vec::new() };
        match (domain.kind.as_str(), tess.dimension) {
            ("cube", Dimension::Three) => {
                domain.walls = vec![Vec::new(); 6];
                self.domain_edges(None, 0)?;
                self.domain_faces(&mut domain, tess.faces.len())?;
            }
            ("square", Dimension::Two) => {
                domain.walls = vec![Vec::new(); 4];
                self.domain_edges(Some(&mut domain), tess.edges.len())?;
            }
            (POLYHEDRON, Dimension::Three) => {
                self.domain_edges(None, 0)?;
                self.domain_faces(&mut domain, tess.faces.len())?;
            }
            (POLYHEDRON, Dimension::Two) => self.domain_edges(Some(&mut domain), tess.edges.len())?,
            _ => self.words.skip_section(),
        }
        Ok(domain)
    }

    fn periodicity(&mut self, tess: &Tess) -> Result<TessPeriodicity, TessProblem> {
        let words = &mut self.words;
        let cell_count = self.cell_count;
        words.expect("*general")?;
        let mut axes = [false; 3];
        for is_periodic in &mut axes {
            *is_periodic = words.count("0 or 1")? != 0;
        }
        let lengths = words.point()?;
        words.expect("*seed")?;
        let count = words.count("the number of seeds")?;
        let seeds = words.list(count, |words, index| {
            words.id("seed", cell_count + index)?;
            Ok((words.index("seed", cell_count)?, words.translation()?))
        })?;
        let vertices = words.copies("vertex", tess.vertices.len(), false)?;
        let edges = words.copies("edge", tess.edges.len(), true)?;
        let faces = match tess.dimension {
            Dimension::Two => Vec::new(),
            Dimension::Three => words.copies("face", tess.faces.len(), true)?,
        };
        Ok(TessPeriodicity { axes, lengths, seeds, vertices, edges, faces })
    }

    /// The edges of the domain, which are its walls in the plane.
    fn domain_edges(
        &mut self,
        mut domain: Option<&mut TessDomain>,
        edge_count: usize,
    ) -> Result<(), TessProblem> {
        let has_curve = self.version == VERSION_WITH_CURVES;
        self.words.expect("*edge")?;
        let count = self.words.count("the number of edges")?;
        self.words.list(count, |words, index| {
            words.id("edge", index)?;
            skip_counted(words)?;
            if has_curve {
                words.next("a curve")?;
                skip_counted(words)?;
            }
            match &mut domain {
                Some(domain) => wall(words, domain, "edge", edge_count),
                None => {
                    words.next("a label")?;
                    skip_counted(words)
                }
            }
        })?;
        Ok(())
    }

    fn domain_faces(&mut self, domain: &mut TessDomain, face_count: usize) -> Result<(), TessProblem> {
        self.words.expect("*face")?;
        let count = self.words.count("the number of faces")?;
        self.words.list(count, |words, index| {
            words.id("face", index)?;
            skip_counted(words)?;
            skip_counted(words)?;
            words.next("a surface")?;
            skip_counted(words)?;
            wall(words, domain, "face", face_count)
        })?;
        Ok(())
    }
}

/// The label of a wall and what lies on it.
fn wall(words: &mut Words<'_>, domain: &mut TessDomain, what: &str, count: usize) -> Result<(), TessProblem> {
    let label = words.next("a label")?;
    let wall = if domain.kind == POLYHEDRON {
        // No more walls than parts that lie on them.
        let number = label.strip_prefix('f').and_then(|number| number.parse::<usize>().ok());
        number.filter(|number| (1..=count).contains(number)).map(|number| number - 1)
    } else {
        let mut walls = Wall::ALL.into_iter().take(domain.walls.len());
        walls.find(|wall| domain.label(*wall) == label).map(Wall::index)
    };
    let Some(wall) = wall else {
        return Err(words.problem(format!("{label:?} is not a wall of a {}", domain.kind)));
    };
    if wall >= domain.walls.len() {
        domain.walls.resize(wall + 1, Vec::new());
    }
    let length = words.count("a number of parts")?;
    domain.walls[wall] = words.list(length, |words, _| words.index(what, count))?;
    Ok(())
}

/// A count and as many words.
fn skip_counted(words: &mut Words<'_>) -> Result<(), TessProblem> {
    let count = words.count("a number of words")?;
    for _ in 0..count {
        words.next("a word")?;
    }
    Ok(())
}
