//! From the squares of the plane to one complex.

use glam::{DVec2, DVec3};

use crate::diagram::cell_faces::CellFaces;
use crate::exact::generator::{Generator, Plane};
use crate::{CellId, Domain, FaceId, Side, Tessellation, VertexId};

/// The generators of a vertex, sorted.
pub(crate) type PlanarKey = [Generator; 3];

/// The cells of the seeds in a square. Seeds are in the order of the squares, vertices and edges numbered within the square.
#[derive(Default)]
pub(crate) struct SquareCells {
    pub(crate) vertices: Vec<DVec2>,
    /// Vertices that other squares or cells know too.
    pub(crate) shared_vertices: Vec<(PlanarKey, u32)>,
    /// Seed, what lies beyond, and the ends of the edge, the seed's cell to the left.
    pub(crate) edges: Vec<([Generator; 2], [u32; 2])>,
    /// Edges that other squares know too, by their seeds.
    pub(crate) shared_edges: Vec<([Generator; 2], u32)>,
    /// The seed and the number of edges of each cell.
    pub(crate) edge_counts: Vec<(u32, u32)>,
    /// The edges of one cell after the other, each counter-clockwise.
    pub(crate) cell_edges: Vec<u32>,
}

/// Makes one complex of the cells of all squares. `seeds` and the result's cells are in the user's order, which `ids` tells.
pub(crate) fn merge_squares(
    domain: &Domain,
    seeds: &[DVec3],
    ids: &[u32],
    squares: &[SquareCells],
) -> Tessellation {
    let vertex_ids = number(squares, |cells| (cells.vertices.len(), &cells.shared_vertices));
    let face_ids = number(squares, |cells| (cells.edges.len(), &cells.shared_edges));
    let (vertices, (faces, lists)) = rayon::join(
        || positions(squares, &vertex_ids),
        || rayon::join(|| faces(ids, squares, &vertex_ids, &face_ids), || lists(ids, squares, &face_ids)),
    );
    let mut tessellation = Tessellation::without_faces(domain, seeds, vertices);
    (tessellation.face_sides, tessellation.face_corners) = faces;
    tessellation.face_starts = (0..=tessellation.face_sides.len()).map(|face| 2 * face).collect();
    tessellation.cell_faces = lists;
    tessellation.put_vertices_on_walls();
    tessellation
}

fn positions(squares: &[SquareCells], vertex_ids: &[Vec<u32>]) -> Vec<DVec3> {
    let mut positions = Vec::with_capacity(squares.iter().map(|cells| cells.vertices.len()).sum());
    for (cells, ids) in squares.iter().zip(vertex_ids) {
        for (position, id) in cells.vertices.iter().zip(ids) {
            if *id as usize == positions.len() {
                positions.push(position.extend(0.0));
            }
        }
    }
    positions
}

/// Sides and ends of the edges.
fn faces(
    ids: &[u32],
    squares: &[SquareCells],
    vertex_ids: &[Vec<u32>],
    face_ids: &[Vec<u32>],
) -> (Vec<[Side; 2]>, Vec<VertexId>) {
    let most = squares.iter().map(|cells| cells.edges.len()).sum();
    let (mut all_sides, mut corners) = (Vec::with_capacity(most), Vec::with_capacity(2 * most));
    let side = |generator: Generator| match generator.plane() {
        Plane::Site(site) => Side::Cell(CellId(ids[site as usize])),
        Plane::Side(wall) | Plane::Facet(wall) => Side::Wall(wall),
    };
    for ((cells, vertex_ids), face_ids) in squares.iter().zip(vertex_ids).zip(face_ids) {
        for ((sides, ends), id) in cells.edges.iter().zip(face_ids) {
            if *id as usize == all_sides.len() {
                let mut sides = sides.map(side);
                let mut ends = ends.map(|end| VertexId(vertex_ids[end as usize]));
                if sides[1] < sides[0] {
                    sides.swap(0, 1);
                    ends.swap(0, 1);
                }
                all_sides.push(sides);
                corners.extend(ends);
            }
        }
    }
    (all_sides, corners)
}

fn lists(ids: &[u32], squares: &[SquareCells], face_ids: &[Vec<u32>]) -> CellFaces {
    let mut starts = vec![0; ids.len() + 1];
    for (seed, count) in squares.iter().flat_map(|cells| &cells.edge_counts) {
        starts[ids[*seed as usize] as usize + 1] = *count;
    }
    for cell in 1..starts.len() {
        starts[cell] += starts[cell - 1];
    }
    let mut faces = vec![FaceId(0); starts[ids.len()] as usize];
    for (cells, face_ids) in squares.iter().zip(face_ids) {
        let mut edges = cells.cell_edges.iter();
        for (seed, count) in &cells.edge_counts {
            let places = starts[ids[*seed as usize] as usize] as usize..;
            for (face, edge) in faces[places].iter_mut().zip(edges.by_ref().take(*count as usize)) {
                *face = FaceId(face_ids[*edge as usize]);
            }
        }
    }
    CellFaces { ranges: starts.windows(2).map(|range| range[0]..range[1]).collect(), lists: faces }
}

/// Numbers what the squares have, of which several may know the same: it has its number from the first of them. What is new in a
/// square is numbered in order.
fn number<Key: Copy + Ord>(
    squares: &[SquareCells],
    part: impl Fn(&SquareCells) -> (usize, &Vec<(Key, u32)>),
) -> Vec<Vec<u32>> {
    const FOUND_BEFORE: u32 = u32::MAX;
    let mut shared: Vec<(Key, usize, u32)> = Vec::new();
    let mut numbers = Vec::with_capacity(squares.len());
    for (square, cells) in squares.iter().enumerate() {
        let (count, known_elsewhere) = part(cells);
        shared.extend(known_elsewhere.iter().map(|(key, place)| (*key, square, *place)));
        numbers.push(vec![0; count]);
    }
    shared.sort_unstable();
    let same = || shared.chunk_by(|(left, ..), (right, ..)| left == right);
    for same in same() {
        for &(_, square, place) in &same[1..] {
            numbers[square][place as usize] = FOUND_BEFORE;
        }
    }
    let new = numbers.iter_mut().flatten().filter(|number| **number != FOUND_BEFORE);
    for (number, next) in new.zip(0..) {
        *number = next;
    }
    for same in same() {
        let (_, square, place) = same[0];
        let first = numbers[square][place as usize];
        for &(_, square, place) in &same[1..] {
            numbers[square][place as usize] = first;
        }
    }
    numbers
}
