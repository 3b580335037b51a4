//! Wavefront OBJ, read here: the crates for it split faces, round to single precision or forget lines.

use super::lines::{Words, short};
use super::{MeshFile, MeshFileProblem};

/// Reads vertices, faces and lines; everything else, such as normals, texture and groups, is passed over.
pub(super) fn read(bytes: &[u8]) -> Result<MeshFile, MeshFileProblem> {
    let text = String::from_utf8_lossy(bytes);
    let mut mesh = MeshFile::default();
    // A face may refer to vertices that come after it.
    let mut cell_lines = Vec::new();
    for (index, line) in joined_lines(&text) {
        let line = line.split('#').next().unwrap_or_default();
        let mut line = Words { index, words: line.split_whitespace() };
        match line.words.next() {
            Some("v") => mesh.points.push(line.point()?),
            Some(word @ ("f" | "l")) => {
                let vertex_count = mesh.points.len();
                let kind = if word == "f" { Kind::Face } else { Kind::Line };
                let cell: Result<Vec<i64>, _> =
                    line.words.clone().map(|word| vertex(word, vertex_count, kind, &line)).collect();
                cell_lines.push((index, kind, cell?));
            }
            _ => {}
        }
    }
    let vertex_count = mesh.points.len();
    for (index, kind, cell) in cell_lines {
        let what = match kind {
            Kind::Face if cell.len() < 3 => {
                format!("a face with {} corners; it needs at least three", cell.len())
            }
            Kind::Line if cell.len() < 2 => {
                format!("a line with {} points; it needs at least two", cell.len())
            }
            _ => String::new(),
        };
        if !what.is_empty() {
            return Err(MeshFileProblem::line(index, what));
        }
        let position = |id: i64| {
            let position = u32::try_from(id).ok().filter(|&id| (id as usize) < vertex_count);
            position.ok_or_else(|| {
                let name = kind.name();
                let what =
                    format!("{name} refers to vertex {}, but the file has {vertex_count} vertices", id + 1);
                MeshFileProblem::line(index, what)
            })
        };
        let cell = cell.into_iter().map(position).collect::<Result<_, _>>()?;
        match kind {
            Kind::Face => mesh.faces.push(cell),
            Kind::Line => mesh.lines.push(cell),
        }
    }
    Ok(mesh)
}

/// What refers to vertices.
#[derive(Clone, Copy)]
enum Kind {
    Face,
    Line,
}

impl Kind {
    fn name(self) -> &'static str {
        match self {
            Self::Face => "a face",
            Self::Line => "a line",
        }
    }
}

/// The position, from 0, of the vertex that `7`, `7/1/2` or `-1` stands for; not yet known to exist.
fn vertex(word: &str, vertex_count: usize, kind: Kind, line: &Words<'_>) -> Result<i64, MeshFileProblem> {
    let id = word.split('/').next().unwrap_or_default();
    match id.parse::<i32>() {
        Ok(0) => Err(line.problem(format!("{} refers to vertex 0, but OBJ counts from 1", kind.name()))),
        Ok(id) if id > 0 => Ok(i64::from(id) - 1),
        // Negative ids count back from the last vertex so far.
        Ok(id) => Ok(i64::try_from(vertex_count).unwrap_or(i64::MAX) + i64::from(id)),
        Err(_) => Err(line.problem(format!("'{}' is not a vertex of {}", short(word), kind.name()))),
    }
}

/// The lines with their positions, those that end in a backslash joined with the next.
fn joined_lines(text: &str) -> impl Iterator<Item = (usize, String)> {
    let mut lines = text.lines().enumerate();
    std::iter::from_fn(move || {
        let (index, line) = lines.next()?;
        let mut joined = line.trim_end().to_owned();
        while joined.ends_with('\\') {
            joined.pop();
            joined.push(' ');
            match lines.next() {
                Some((_, more)) => joined.push_str(more.trim_end()),
                None => break,
            }
        }
        Some((index, joined))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_ways_to_name_a_vertex() {
        let text = "# a pyramid\no x\nv 0 0 0\nv 1 0 0 1.0\nv 1 1 0\nv 0 1 0\nvn 0 0 1\nf 1/1/1 2//1 \\\n 3 4/2\n\
                    f -4 -3 5 # forward\nv 0.5 0.5 1\n";
        let mesh = read(text.as_bytes()).unwrap();
        assert_eq!(mesh.points.len(), 5);
        assert_eq!(mesh.faces, [vec![0, 1, 2, 3], vec![0, 1, 4]]);
    }

    #[test]
    fn lines_are_polylines() {
        let mesh = read(b"v 0 0 0\nv 1 0 0\nv 1 1 0\nl 1 2/7 3 1\nl -1 -2\n").unwrap();
        assert_eq!(mesh.lines, [vec![0, 1, 2, 0], vec![2, 1]]);
    }

    #[test]
    fn messages_name_the_line() {
        for (text, message) in [
            ("v 0 0\n", "line 1: ends before a z coordinate"),
            ("v 0 0 x\n", "line 1: 'x' is not a z coordinate"),
            ("\nv 0 nan 0\n", "line 2: NaN is a y coordinate that is not finite"),
            ("f 0 1 2\n", "line 1: a face refers to vertex 0, but OBJ counts from 1"),
            ("v 0 0 0\nf 1 2 1\n", "line 2: a face refers to vertex 2, but the file has 1 vertices"),
            ("v 0 0 0\nf 1 1\n", "line 2: a face with 2 corners; it needs at least three"),
            ("v 0 0 0\nl 1\n", "line 2: a line with 1 points; it needs at least two"),
            ("v 0 0 0\nl 1 2\n", "line 2: a line refers to vertex 2, but the file has 1 vertices"),
            ("v 0 0 0\nf 1 a/2 1\n", "line 2: 'a/2' is not a vertex of a face"),
        ] {
            assert_eq!(read(text.as_bytes()).unwrap_err().to_string(), message);
        }
    }
}
