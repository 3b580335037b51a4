//! Going back.

use glam::DVec3;
use smallvec::SmallVec;
use voronoi::CellId;

use crate::complex::cell_complex::{CellComplex, Face, FacesAt, FacesOf, cell_of};

/// What a [`CellComplex`] was like around some vertices.
#[derive(Debug, Clone)]
pub struct Snapshot {
    vertex_count: usize,
    face_count: usize,
    vertices: Vec<(u32, DVec3, FacesAt)>,
    faces: Vec<(u32, Face)>,
    faces_of: Vec<(usize, FacesOf)>,
}

impl CellComplex {
    /// What the complex is like around some vertices.
    pub fn snapshot(&self, vertices: &[u32]) -> Snapshot {
        let faces = self.faces_at(vertices);
        let sides = faces.iter().flat_map(|face| self.faces[face.index()].sides);
        let mut cells: SmallVec<[usize; 32]> = sides.filter_map(cell_of).map(CellId::index).collect();
        cells.sort_unstable();
        cells.dedup();
        let place = |vertex: &u32| {
            let place = *vertex as usize;
            (*vertex, self.vertices[place], self.faces_at[place].clone())
        };
        Snapshot {
            vertex_count: self.vertices.len(),
            face_count: self.faces.len(),
            vertices: vertices.iter().map(place).collect(),
            faces: faces.iter().map(|face| (face.0, self.faces[face.index()].clone())).collect(),
            faces_of: cells.into_iter().map(|cell| (cell, self.faces_of[cell].clone())).collect(),
        }
    }

    /// Takes back all changes since a snapshot. They must have been to its vertices and to those that came instead of them.
    pub fn restore(&mut self, snapshot: Snapshot) {
        self.vertices.truncate(snapshot.vertex_count);
        self.faces_at.truncate(snapshot.vertex_count);
        self.faces.truncate(snapshot.face_count);
        for (vertex, position, faces) in snapshot.vertices {
            self.vertices[vertex as usize] = position;
            self.faces_at[vertex as usize] = faces;
        }
        for (number, face) in snapshot.faces {
            self.faces[number as usize] = face;
        }
        for (cell, faces) in snapshot.faces_of {
            self.faces_of[cell] = faces;
        }
    }
}
