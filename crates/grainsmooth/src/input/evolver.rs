//! The network of Surface Evolver's bodies.

mod datafile;
mod torus;

use glam::DVec3;

use self::datafile::{Datafile, Signed};
use crate::mesh::file::vtk::labelled::LabelledCells;
use crate::mesh::file::{MeshFile, MeshFileProblem};

/// The boundaries of all bodies, whose numbers are the labels; facets with more than three edges become triangles around their middle, as in Evolver itself.
///
/// # Errors
/// As of [`datafile::read`]; elements with more than two bodies or open facets.
pub(super) fn read(bytes: &[u8]) -> Result<LabelledCells, MeshFileProblem> {
    let file = datafile::read(bytes)?;
    let elements = elements(&file)?;
    if let Some(periods) = file.periods {
        return torus::cells(&file, periods, &elements);
    }
    let mut points = file.vertices.clone();
    let (mut faces, mut labels) = (Vec::new(), Vec::new());
    for element in elements {
        let (corners, sides) = element.smaller_first(&file);
        let corners = corners.into_iter().map(|corner| id(corner.vertex)).collect::<Result<Vec<_>, _>>()?;
        let pieces = if file.is_plane { vec![corners] } else { triangles(corners, &mut points)? };
        labels.resize(labels.len() + pieces.len(), sides);
        faces.extend(pieces);
    }
    Ok(LabelledCells {
        mesh: MeshFile { points, faces, ..MeshFile::default() },
        is_plane: file.is_plane,
        labels,
        label_array: "FaceLabels",
        ..LabelledCells::default()
    })
}

/// A corner of an element, and how many periods it is from the vertex.
#[derive(Debug, Clone, Copy)]
struct Corner {
    vertex: usize,
    periods: [i32; 3],
}

/// A facet, in the plane an edge.
struct Element {
    corners: Vec<Corner>,
    /// The edge from each corner to the next; in the plane the one that it is.
    edges: Vec<Signed>,
    /// The bodies behind and in front (in the plane: to the left and right), by position.
    sides: [Option<usize>; 2],
}

impl Element {
    /// The corners and labels, turned so that the smaller label comes first and the exterior, -1, second.
    fn smaller_first(&self, file: &Datafile) -> (Vec<Corner>, [i64; 2]) {
        let label = |side: Option<usize>| side.map_or(-1, |body| i64::from(file.bodies[body].0));
        let [first, second] = self.sides.map(label);
        if first < 0 || second >= 0 && second < first {
            return (self.corners.iter().rev().copied().collect(), [second, first]);
        }
        (self.corners.clone(), [first, second])
    }
}

/// All elements that bodies have.
fn elements(file: &Datafile) -> Result<Vec<Element>, MeshFileProblem> {
    let problem = |what: String| MeshFileProblem::corrupt("Surface Evolver", what);
    let count = if file.is_plane { file.edges.len() } else { file.faces.len() };
    let mut sides = vec![[None; 2]; count];
    for (body, (number, around)) in file.bodies.iter().enumerate() {
        for face in around {
            let of_face =
                if file.is_plane { &file.faces[face.index][..] } else { std::slice::from_ref(face) };
            for element in of_face {
                let is_reversed = element.is_reversed ^ (file.is_plane && face.is_reversed);
                if sides[element.index][usize::from(is_reversed)].replace(body).is_some() {
                    let what = if file.is_plane { "edge" } else { "face" };
                    return Err(problem(format!(
                        "{what} {} by order has body {number} and another on one side",
                        element.index + 1
                    )));
                }
            }
        }
    }
    let mut elements = Vec::new();
    for (index, sides) in sides.into_iter().enumerate().filter(|(_, sides)| *sides != [None; 2]) {
        let own = [Signed { index, is_reversed: false }];
        let edges = if file.is_plane { &own[..] } else { &file.faces[index] };
        let mut corners = Vec::with_capacity(edges.len() + 1);
        let mut next: Option<Corner> = None;
        for edge in edges {
            let [from, to] = along(file, *edge);
            let at = next.map_or([0; 3], |next| next.periods);
            if next.is_some_and(|next| next.vertex != from.vertex) {
                return Err(problem(format!(
                    "the edges of face {} by order do not follow one another",
                    index + 1
                )));
            }
            corners.push(Corner { vertex: from.vertex, periods: at });
            next = Some(Corner {
                vertex: to.vertex,
                periods: [0, 1, 2].map(|axis| at[axis] + to.periods[axis]),
            });
        }
        match (next, file.is_plane) {
            (Some(last), true) => corners.push(last),
            (Some(last), false) if last.vertex == corners[0].vertex && last.periods == [0; 3] => {}
            _ => return Err(problem(format!("the edges of face {} by order do not close", index + 1))),
        }
        elements.push(Element { corners, edges: edges.to_vec(), sides });
    }
    Ok(elements)
}

/// The ends of an edge as it is run through, the second in periods from the first.
fn along(file: &Datafile, edge: Signed) -> [Corner; 2] {
    let datafile::Edge { ends: [from, to], wraps } = file.edges[edge.index];
    let corner = |vertex, periods| Corner { vertex, periods };
    match edge.is_reversed {
        false => [corner(from, [0; 3]), corner(to, wraps)],
        true => [corner(to, [0; 3]), corner(from, wraps.map(|wrap| -wrap))],
    }
}

/// A facet as it is, or around a new point in its middle.
fn triangles(corners: Vec<u32>, points: &mut Vec<DVec3>) -> Result<Vec<Vec<u32>>, MeshFileProblem> {
    if corners.len() == 3 {
        return Ok(vec![corners]);
    }
    let middle = corners.iter().map(|corner| points[*corner as usize]).sum::<DVec3>() / corners.len() as f64;
    let center = id(points.len())?;
    points.push(middle);
    let next = corners.iter().cycle().skip(1);
    Ok(corners.iter().zip(next).map(|(from, to)| vec![center, *from, *to]).collect())
}

fn id(index: usize) -> Result<u32, MeshFileProblem> {
    u32::try_from(index)
        .map_err(|_| MeshFileProblem::corrupt("Surface Evolver", "it has more points than ids can name"))
}
