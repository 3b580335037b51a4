//! Winding that agrees: which faces to reverse so that each edge is run through in both directions.

use glam::DVec3;

use crate::edge_table::EdgeTable;
use crate::ids::{NONE, id};
use crate::mesh_checks::{check_faces, check_size};
use crate::{FaceId, MeshError};

/// Which faces of a mesh are to be reversed, and which of them are connected.
#[derive(Clone, Debug, PartialEq)]
pub struct Orientation {
    /// Per face: whether it is to be reversed.
    reversed: Vec<bool>,
    /// Per face: its component.
    component_of: Vec<u32>,
    /// Per component: whether each of its edges has exactly two faces.
    is_closed: Vec<bool>,
}

/// Finds which faces to reverse for the winding to agree: in each component the fewer ones, and of equally many those
/// that wind unlike its first face. Edges of three or more faces join nothing.
///
/// ```
/// use subzero::orient;
///
/// // The third triangle winds the other way round.
/// let mut faces = [[0, 1, 2], [0, 3, 1], [0, 3, 2], [1, 3, 2]].map(Vec::from);
/// let orientation = orient(4, &faces)?;
/// assert_eq!(orientation.reversed(), [false, false, true, false]);
/// orientation.apply(&mut faces);
/// assert_eq!(faces[2], [0, 2, 3]);
/// # Ok::<(), subzero::MeshError>(())
/// ```
///
/// # Errors
/// [`MeshError::NotOrientable`] where no choice helps, as on a Moebius strip; a face with fewer than three corners or with a
/// vertex twice, a vertex id out of range, two faces with the same vertices, or more elements than 32-bit ids can count.
pub fn orient(vertex_count: usize, faces: &[Vec<u32>]) -> Result<Orientation, MeshError> {
    check_size("vertices", vertex_count)?;
    check_size("half-edges", faces.iter().map(Vec::len).sum::<usize>().saturating_mul(2))?;
    check_faces(vertex_count, faces)?;
    let half_edges: Vec<[u32; 2]> = faces.iter().flat_map(|face| sides(face)).collect();
    let owners = faces.iter().enumerate().flat_map(|(f, face)| std::iter::repeat_n(id(f), face.len()));
    let owners: Vec<u32> = owners.collect();
    let table = EdgeTable::new(&half_edges);
    let agreeing = table.edges.iter().filter(|edge| edge[1] != NONE).map(|edge| (*edge, false));
    let mixed = table.same_way.iter().map(|(_, pair)| (*pair, true));
    let mut links = vec![Vec::new(); faces.len()];
    for ([first, second], same_way) in agreeing.chain(mixed) {
        for [from, to] in [[first, second], [second, first]] {
            links[owners[from as usize] as usize].push((owners[to as usize], same_way, from));
        }
    }

    let mut orientation = Orientation {
        reversed: vec![false; faces.len()],
        component_of: vec![NONE; faces.len()],
        is_closed: Vec::new(),
    };
    for first in 0..faces.len() {
        if orientation.component_of[first] != NONE {
            continue;
        }
        let component = id(orientation.is_closed.len());
        orientation.component_of[first] = component;
        let mut members = vec![id(first)];
        let mut done = 0;
        while let Some(&face) = members.get(done) {
            done += 1;
            let reversed = orientation.reversed[face as usize];
            for &(neighbour, same_way, half_edge) in &links[face as usize] {
                let wanted = reversed != same_way;
                if orientation.component_of[neighbour as usize] == NONE {
                    orientation.component_of[neighbour as usize] = component;
                    orientation.reversed[neighbour as usize] = wanted;
                    members.push(neighbour);
                } else if orientation.reversed[neighbour as usize] != wanted {
                    let ends = half_edges[half_edge as usize];
                    return Err(MeshError::NotOrientable {
                        first: FaceId(face),
                        second: FaceId(neighbour),
                        ends,
                    });
                }
            }
        }
        let reversed = members.iter().filter(|face| orientation.reversed[**face as usize]).count();
        if 2 * reversed > members.len() {
            orientation.reverse(&members);
        }
        let linked: usize = members.iter().map(|face| links[*face as usize].len()).sum();
        let side_count: usize = members.iter().map(|face| faces[*face as usize].len()).sum();
        orientation.is_closed.push(linked == side_count);
    }
    Ok(orientation)
}

impl Orientation {
    /// Per face: whether it is to be reversed.
    pub fn reversed(&self) -> &[bool] {
        &self.reversed
    }

    /// Per face: its component. Components are connected by edges of exactly two faces, and count in the order of their first faces.
    pub fn component_of(&self) -> &[u32] {
        &self.component_of
    }

    /// Per component: whether each of its edges has exactly two faces.
    pub fn is_closed(&self) -> &[bool] {
        &self.is_closed
    }

    /// Reverses closed components, too, whose normals would point inward: those of negative volume.
    ///
    /// # Panics
    /// If `faces` are not those that were oriented, or `points` are fewer than their vertices.
    pub fn face_outward(&mut self, points: &[DVec3], faces: &[Vec<u32>]) {
        let mut volumes = vec![0.0; self.is_closed.len()];
        let mut origins = vec![None; self.is_closed.len()];
        for (f, face) in faces.iter().enumerate() {
            let component = self.component_of[f] as usize;
            // Near the component, lest a far origin costs digits.
            let origin = *origins[component].get_or_insert(points[face[0] as usize]);
            let [a, rest @ ..] = &face[..] else { continue };
            let a = points[*a as usize] - origin;
            let volume: f64 = rest
                .windows(2)
                .map(|pair| {
                    let [b, c] = [pair[0], pair[1]].map(|v| points[v as usize] - origin);
                    a.dot(b.cross(c))
                })
                .sum();
            volumes[component] += if self.reversed[f] { -volume } else { volume };
        }
        for (f, component) in self.component_of.iter().enumerate() {
            let component = *component as usize;
            if self.is_closed[component] && volumes[component] < 0.0 {
                self.reversed[f] = !self.reversed[f];
            }
        }
    }

    /// The faces with those reversed that are to be; each keeps its first corner.
    ///
    /// # Panics
    /// If `faces` are not as many as were oriented.
    pub fn apply(&self, faces: &mut [Vec<u32>]) {
        assert_eq!(faces.len(), self.reversed.len(), "there must be the faces that were oriented");
        for (face, _) in faces.iter_mut().zip(&self.reversed).filter(|(_, reversed)| **reversed) {
            face[1..].reverse();
        }
    }

    fn reverse(&mut self, members: &[u32]) {
        for &face in members {
            self.reversed[face as usize] = !self.reversed[face as usize];
        }
    }
}

/// The half-edges of a face.
fn sides(face: &[u32]) -> impl Iterator<Item = [u32; 2]> {
    face.iter().zip(face.iter().cycle().skip(1)).map(|(&a, &b)| [a, b])
}
