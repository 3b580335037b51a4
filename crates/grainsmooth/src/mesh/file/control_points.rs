//! Points in lines of plain text: control points of curves and surfaces, and polylines.

use glam::DVec3;

use super::{MeshFile, MeshFileProblem};

/// What a text holds.
#[derive(Debug, Default, PartialEq)]
pub(in crate::mesh) struct ControlPoints {
    /// The points of each curve.
    pub(in crate::mesh) curves: Vec<Vec<DVec3>>,
    /// The points of each surface, in rows.
    pub(in crate::mesh) surfaces: Vec<Vec<Vec<DVec3>>>,
}

/// Reads a point `x y z` on each line; a blank line ends a curve. A line with two numbers `m n` begins a surface of these degrees, with
/// (m + 1)(n + 1) points after it, and the first line may be the number of surfaces. Where no line has more than two numbers, these are
/// points `x y` of curves in the plane.
pub(in crate::mesh) fn read(text: &str) -> Result<ControlPoints, MeshFileProblem> {
    let mut found = ControlPoints::default();
    let mut points = Vec::new();
    // Points in a row, and rows, of the surface at hand.
    let mut surface: Option<[usize; 2]> = None;
    let is_plane = text.lines().all(|line| words(line).count() < 3);
    for (index, line) in text.lines().chain([""]).enumerate() {
        let problem = |what: String| MeshFileProblem::Line { line: index + 1, what };
        let words: Vec<&str> = words(line).collect();
        let number = |word: &str| -> Result<f64, _> {
            let number = word.parse().ok().filter(|number: &f64| number.is_finite());
            number.ok_or_else(|| problem(format!("'{word}' is not a finite number")))
        };
        match words[..] {
            [x, y, z] => points.push(DVec3::new(number(x)?, number(y)?, number(z)?)),
            [x, y] if is_plane => points.push(DVec3::new(number(x)?, number(y)?, 0.0)),
            // The teapot's files begin with their number of patches.
            [_] if found == ControlPoints::default() && points.is_empty() && surface.is_none() => {}
            [rows, columns] if points.is_empty() => {
                let degree = |word: &str| {
                    let degree = word.parse().ok().filter(|degree: &u8| *degree > 0);
                    degree
                        .ok_or_else(|| problem(format!("'{word}' is not the degree of a surface, 1 to 255")))
                };
                surface = Some([usize::from(degree(rows)?) + 1, usize::from(degree(columns)?) + 1]);
            }
            [] if surface.is_none() && !points.is_empty() => found.curves.push(std::mem::take(&mut points)),
            [] => {}
            _ => {
                return Err(problem(
                    "not a control point x y z, nor the degrees m n of a surface".to_owned(),
                ));
            }
        }
        if let Some([rows, columns]) = surface
            && points.len() == rows * columns
        {
            found.surfaces.push(points.chunks(columns).map(<[DVec3]>::to_vec).collect());
            points.clear();
            surface = None;
        }
    }
    match surface {
        Some([rows, columns]) => {
            let what = format!("the last surface has {} of {} points", points.len(), rows * columns);
            Err(MeshFileProblem::Corrupt { format: "control point", what })
        }
        None => Ok(found),
    }
}

/// Reads the curves as polylines; one whose last point is its first is closed.
pub(super) fn read_polylines(bytes: &[u8]) -> Result<MeshFile, MeshFileProblem> {
    let found = read(&String::from_utf8_lossy(bytes))?;
    if !found.surfaces.is_empty() {
        let what = "a surface of control points is not a polyline";
        return Err(MeshFileProblem::corrupt("polyline", what));
    }
    let mut mesh = MeshFile::default();
    for mut curve in found.curves {
        let is_closed = curve.len() > 3 && curve[0] == curve[curve.len() - 1];
        if is_closed {
            curve.pop();
        }
        let count = mesh.points.len() + curve.len();
        let id =
            |id: usize| u32::try_from(id).map_err(|_| subzero::MeshError::TooLarge { what: "points", count });
        let first = id(mesh.points.len())?;
        mesh.lines.push((first..id(count)?).chain(is_closed.then_some(first)).collect());
        mesh.points.extend(curve);
    }
    Ok(mesh)
}

/// The words of a line, without its comment.
fn words(line: &str) -> impl Iterator<Item = &str> {
    let line = line.split('#').next().unwrap_or_default();
    line.split([' ', '\t', ',', '\r']).filter(|word| !word.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curves_and_patches() {
        let found = read("0 0 0\n1, 2, 0 # end\n\n0 0 1\n1 1 1\n2 0 1\n").unwrap();
        assert_eq!(found.curves.iter().map(Vec::len).collect::<Vec<_>>(), [2, 3]);
        let patch = "1 2\n0 0 0\n0 1 0\n0 2 0\n1 0 0\n1 1 0\n1 2 0\n";
        let found = read(&format!("2\n{patch}{patch}")).unwrap();
        assert_eq!((found.surfaces.len(), found.surfaces[0].len()), (2, 2));
    }

    #[test]
    fn two_coordinates_are_curves_in_the_plane() {
        let mesh = read_polylines(b"0 0\n1 0\n1 1\n0 0\n\n3 3\n4 4\n").unwrap();
        assert_eq!(mesh.lines, [vec![0, 1, 2, 0], vec![3, 4]]);
        assert_eq!(mesh.points[3], DVec3::new(3.0, 3.0, 0.0));
    }

    #[test]
    fn messages_name_the_place() {
        for (text, message) in [
            ("0 0 0\n0 0 x\n", "line 2: 'x' is not a finite number"),
            ("0 0 0\n0 0 0 0\n", "line 2: not a control point x y z, nor the degrees m n of a surface"),
            ("3 0\n0 0 0\n", "line 1: '0' is not the degree of a surface, 1 to 255"),
            ("1 1\n0 0 0\n", "the last surface has 1 of 4 points; give a complete control point file"),
        ] {
            assert_eq!(read(text).unwrap_err().to_string(), message);
        }
    }
}
