//! From cells with vertices of their own to one complex.
//!
//! A vertex is the set of generators that meet there; all its cells know the same set, and the cell with the smallest
//! number owns it. Vertices that coincide (more than four generators through one point) are united afterwards, guided by
//! exact ties and never by distance.

use rayon::prelude::*;

use crate::batch::{CellBatch, CellView};
use crate::flat_cells::remove_flat_cells;
use crate::generator::{Generator, Plane};
use crate::predicate::ExactInput;
use crate::tessellation::{CellId, FaceId, Side, Tessellation, VertexId};
use crate::{Dimension, Domain};

/// The cells of all batches by number, with the numbering of the vertices that they own.
struct Cells<'a> {
    batches: &'a [CellBatch],
    /// Cells in every batch but the last.
    batch_size: usize,
    /// Number of the first vertex that each cell owns.
    owned_starts: Vec<u32>,
}

impl<'a> Cells<'a> {
    fn new(batches: &'a [CellBatch]) -> Self {
        let batch_size = batches.first().map_or(1, CellBatch::cell_count);
        let mut cells = Self { batches, batch_size, owned_starts: vec![0] };
        let mut count = 0;
        for cell in 0..batches.iter().map(CellBatch::cell_count).sum() {
            count += cells.owned(cell).0.keys.len() - cells.owned(cell).1;
            cells.owned_starts.push(u32::try_from(count).expect("vertex ids fit 32 bits"));
        }
        cells
    }

    fn cell(&self, cell: usize) -> CellView<'a> {
        self.batches[cell / self.batch_size].cell(cell % self.batch_size)
    }

    /// A cell and the place of the first vertex that it owns: keys are sorted, so vertices of smaller cells come first.
    fn owned(&self, cell: usize) -> (CellView<'a>, usize) {
        let view = self.cell(cell);
        let own = u32::try_from(cell).expect("cell ids fit 32 bits");
        let first = view.keys.partition_point(|key| key[0] < Generator::site(own));
        (view, first)
    }

    /// Number of the vertex with the given key.
    fn vertex(&self, key: &[Generator; 4]) -> u32 {
        let owner = key[0].as_site().expect("every vertex belongs to a cell") as usize;
        let (view, first) = self.owned(owner);
        let place = view.keys[first..].binary_search(key);
        let place = place.expect("exact decisions give every cell the same vertices");
        self.owned_starts[owner] + u32::try_from(place).expect("a cell has fewer than 2^32 vertices")
    }
}

/// A face while the complex is put together.
struct LooseFace {
    sides: [Side; 2],
    corners: Vec<VertexId>,
}

pub(crate) fn weld(input: ExactInput, batches: &[CellBatch]) -> Tessellation {
    let cells = Cells::new(batches);
    // Number of every cell vertex, batch by batch.
    let numbers: Vec<Vec<u32>> = batches
        .par_iter()
        .map(|batch| {
            let of_cell = |cell: usize| batch.cell(cell).keys.iter().map(|key| cells.vertex(key));
            (0..batch.cell_count()).flat_map(of_cell).collect()
        })
        .collect();
    let vertex_count = cells.owned_starts[cells.owned_starts.len() - 1] as usize;
    let (vertex_ids, representatives) = unite_coincident(vertex_count, batches, &numbers);

    let faces: Vec<Vec<LooseFace>> = (0..batches.len())
        .into_par_iter()
        .map(|batch| {
            let first_cell = batch * cells.batch_size;
            (0..batches[batch].cell_count())
                .flat_map(|cell| {
                    let view = batches[batch].cell(cell);
                    let numbers = &numbers[batch][view.first_vertex..];
                    owned_faces(&view, first_cell + cell, numbers, &vertex_ids, input.domain)
                })
                .collect()
        })
        .collect();

    let mut owned_positions = Vec::with_capacity(vertex_count);
    for cell in 0..input.seeds.len() {
        let (view, first) = cells.owned(cell);
        owned_positions.extend_from_slice(&view.positions[first..]);
    }
    let mut tessellation = Tessellation {
        domain: *input.domain,
        seeds: input.seeds.to_vec(),
        vertices: representatives.iter().map(|v| owned_positions[*v as usize]).collect(),
        face_sides: Vec::new(),
        face_starts: vec![0],
        face_corners: Vec::new(),
        cell_starts: Vec::new(),
        cell_faces: Vec::new(),
        periodic_vertices: Vec::new(),
        periodic_faces: Vec::new(),
    };
    for face in faces.into_iter().flatten() {
        tessellation.push_face(face.sides, face.corners.into_iter());
    }
    put_vertices_on_walls(&mut tessellation);
    list_faces_of_cells(&mut tessellation);
    if remove_flat_cells(&mut tessellation) {
        list_faces_of_cells(&mut tessellation);
    }
    tessellation
}

/// The faces of a cell towards greater cells and walls, without those that have shrunk to a line or a point.
fn owned_faces(
    view: &CellView,
    cell: usize,
    numbers: &[u32],
    vertex_ids: &[VertexId],
    domain: &Domain,
) -> Vec<LooseFace> {
    let own = u32::try_from(cell).expect("cell ids fit 32 bits");
    let fewest_corners = match domain.dimension() {
        Dimension::Two => 2,
        Dimension::Three => 3,
    };
    let mut faces = Vec::new();
    for (generator, corners) in view.faces().filter(|(generator, _)| *generator > Generator::site(own)) {
        let id = |corner: &u32| vertex_ids[numbers[*corner as usize] as usize];
        let mut corners: Vec<VertexId> = corners.iter().map(id).collect();
        corners.dedup();
        if corners.len() > 1 && corners.first() == corners.last() {
            corners.pop();
        }
        if corners.len() >= fewest_corners {
            faces.push(LooseFace { sides: [Side::Cell(CellId(own)), side(generator)], corners });
        }
    }
    faces
}

/// Unites vertices that are one point. Returns the new id of every old one, and an old one for every new id.
fn unite_coincident(
    vertex_count: usize,
    batches: &[CellBatch],
    numbers: &[Vec<u32>],
) -> (Vec<VertexId>, Vec<u32>) {
    let count = u32::try_from(vertex_count).expect("vertex ids fit 32 bits");
    let mut parents: Vec<u32> = (0..count).collect();
    for (batch, numbers) in batches.iter().zip(numbers) {
        for [v, w] in &batch.coincident {
            let (v, w) = (root(&mut parents, numbers[*v]), root(&mut parents, numbers[*w]));
            // The smaller number stays, so the result does not depend on the order of the pairs.
            parents[v.max(w) as usize] = v.min(w);
        }
    }
    let mut ids = vec![VertexId(0); vertex_count];
    let mut representatives = Vec::new();
    for v in 0..count {
        let root = root(&mut parents, v);
        ids[v as usize] = if root == v {
            representatives.push(v);
            VertexId(u32::try_from(representatives.len() - 1).expect("no more ids than before"))
        } else {
            ids[root as usize]
        };
    }
    (ids, representatives)
}

/// The representative of a union-find tree, with path halving.
fn root(parents: &mut [u32], mut v: u32) -> u32 {
    while parents[v as usize] != v {
        parents[v as usize] = parents[parents[v as usize] as usize];
        v = parents[v as usize];
    }
    v
}

/// Rounding may leave a vertex of a wall's face a last place beside the wall: it gets the wall's own coordinate.
pub(crate) fn put_vertices_on_walls(tessellation: &mut Tessellation) {
    for face in 0..tessellation.face_sides.len() {
        if let Side::Wall(wall) = tessellation.face_sides[face][1] {
            let corners = tessellation.face_starts[face]..tessellation.face_starts[face + 1];
            for corner in &tessellation.face_corners[corners] {
                tessellation.vertices[corner.index()][wall.axis()] =
                    tessellation.domain.wall_coordinate(wall);
            }
        }
    }
}

pub(crate) fn list_faces_of_cells(tessellation: &mut Tessellation) {
    let cells_of = |sides: &[Side; 2]| {
        sides.map(|side| match side {
            Side::Cell(cell) => Some(cell.index()),
            Side::Image(..) | Side::Wall(_) => None,
        })
    };
    let mut starts = vec![0; tessellation.seeds.len() + 1];
    for cell in tessellation.face_sides.iter().flat_map(cells_of).flatten() {
        starts[cell + 1] += 1;
    }
    for cell in 1..starts.len() {
        starts[cell] += starts[cell - 1];
    }
    let mut next = starts.clone();
    let mut cell_faces = vec![FaceId(0); starts[starts.len() - 1]];
    for (face, sides) in (0u32..).zip(&tessellation.face_sides) {
        for cell in cells_of(sides).into_iter().flatten() {
            cell_faces[next[cell]] = FaceId(face);
            next[cell] += 1;
        }
    }
    tessellation.cell_starts = starts;
    tessellation.cell_faces = cell_faces;
}

fn side(generator: Generator) -> Side {
    match generator.plane() {
        Plane::Site(seed) => Side::Cell(CellId(seed)),
        Plane::Wall(wall) => Side::Wall(wall),
    }
}
