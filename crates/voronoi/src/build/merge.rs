//! From tiles to one complex.
//!
//! A vertex is the set of generators that meet there; all tiles around it know the same set, and the one with the smallest
//! seed owns it. Vertices that coincide (more than four generators through one point) are united afterwards, guided by
//! exact ties and never by distance.

use glam::DVec3;
use rayon::prelude::*;

use crate::build::cell_sums::{CellSums, measures};
use crate::build::flat_cells::remove_flat_cells;
use crate::build::tile::{Tile, for_each_tiles};
use crate::build::vertex_numbers::{VertexNumbers, push_positions};
use crate::diagram::cell_sum::{CellSum, KeptMeasures};
use crate::exact::generator::Generator;
use crate::sites::search::Search;
use crate::{CellId, Corner, Dimension, Shift, Side, Tessellation, VertexId};

/// Cuts all cells and makes one complex of them; `seeds` and the result's cells are in the order of the input.
pub(crate) fn merge(search: &Search, seeds: &[DVec3]) -> Tessellation {
    let domain = search.domain();
    let mut tessellation = Tessellation::without_faces(domain, seeds, Vec::new());
    tessellation.make_room();
    let mut numbering = VertexNumbers::new(search.input());
    let mut coincident = Vec::new();
    let mut sums = CellSums::new(seeds.len());
    for_each_tiles(search, |tiles| {
        let numbers = numbering.of_tiles(tiles);
        for (tile, numbers) in tiles.iter().zip(&numbers) {
            push_tile(&mut tessellation, &mut sums, search, tile, numbers);
            coincident.extend(tile.coincident.iter().map(|pair| pair.map(|v| numbers[v as usize].vertex)));
        }
    });
    let places = search.places();
    let mut face_counts = None;
    if !coincident.is_empty() {
        unite_coincident(&mut tessellation, &coincident);
    } else if domain.dimension() == Dimension::Three {
        let sums = sums.whole();
        tessellation.measures = measures(&sums, &places, seeds);
        face_counts = Some(sums.iter().map(CellSum::face_count).collect());
    }
    tessellation.shrink_to_fit();
    tessellation.put_vertices_on_walls();
    tessellation.list_faces_of_cells(&places, face_counts);
    if remove_flat_cells(&mut tessellation) {
        tessellation.measures = KeptMeasures::default();
        tessellation.list_faces_of_cells(&places, None);
    }
    tessellation
}

/// Adds the vertices that a tile owns, its faces and their sums.
fn push_tile(
    tessellation: &mut Tessellation,
    sums: &mut CellSums,
    search: &Search,
    tile: &Tile,
    numbers: &[Corner],
) {
    let Tessellation { vertices, face_sides, face_starts, face_corners, .. } = tessellation;
    let before = face_corners.len();
    let corner = |corner: &u32| VertexId(numbers[*corner as usize].vertex);
    let sides = |sides: &[Generator; 2]| {
        sides.map(|generator| match search.ids().get(generator.0 as usize) {
            Some(id) => Side::Cell(CellId(*id)),
            None => Side::of(search.end(generator), Shift::NONE),
        })
    };
    rayon::join(
        || {
            push_positions(vertices, tile, numbers);
            sums.push_tile(tile);
        },
        || {
            face_corners.par_extend(tile.corners.par_iter().map(corner));
            face_starts.par_extend(tile.corner_starts[1..].par_iter().map(|start| before + *start as usize));
            face_sides.par_extend(tile.faces.par_iter().map(sides));
        },
    );
}

/// Makes vertices that are one point one vertex, and leaves out edges and faces that shrink to points or lines by that.
fn unite_coincident(tessellation: &mut Tessellation, pairs: &[[u32; 2]]) {
    let (ids, representatives) = united_numbers(tessellation.vertices.len(), pairs);
    tessellation.vertices = representatives.iter().map(|v| tessellation.vertices[*v as usize]).collect();
    tessellation.face_corners.par_iter_mut().for_each(|corner| corner.0 = ids[corner.index()]);
    let fewest_corners = tessellation.domain.dimension().fewest_corners();
    let Tessellation { face_sides, face_starts, face_corners, .. } = tessellation;
    // What is kept moves to the front.
    let (mut face, mut start, mut from) = (0, 0, 0);
    for old in 0..face_sides.len() {
        let to = face_starts[old + 1];
        let mut end = start;
        for place in from..to {
            if end == start || face_corners[end - 1] != face_corners[place] {
                face_corners[end] = face_corners[place];
                end += 1;
            }
        }
        while end > start + 1 && face_corners[end - 1] == face_corners[start] {
            end -= 1;
        }
        if end - start >= fewest_corners {
            face_sides[face] = face_sides[old];
            face += 1;
            face_starts[face] = end;
            start = end;
        }
        from = to;
    }
    face_sides.truncate(face);
    face_starts.truncate(face + 1);
    face_corners.truncate(start);
}

/// Unites vertices that are one point, given pairs of them. Returns the new number of every old one, and an old one for every new.
fn united_numbers(vertex_count: usize, pairs: &[[u32; 2]]) -> (Vec<u32>, Vec<u32>) {
    let count = u32::try_from(vertex_count).expect("vertex ids fit 32 bits");
    let mut parents: Vec<u32> = (0..count).collect();
    for pair in pairs {
        let [v, w] = pair.map(|vertex| root(&mut parents, vertex));
        // The smaller number stays, so the result does not depend on the order of the pairs.
        parents[v.max(w) as usize] = v.min(w);
    }
    let mut new = vec![0; vertex_count];
    let mut representatives = Vec::new();
    for v in 0..count {
        let root = root(&mut parents, v);
        new[v as usize] = if root == v {
            representatives.push(v);
            u32::try_from(representatives.len() - 1).expect("no more vertices than before")
        } else {
            new[root as usize]
        };
    }
    (new, representatives)
}

/// The representative of a union-find tree, with path halving.
fn root(parents: &mut [u32], mut v: u32) -> u32 {
    while parents[v as usize] != v {
        parents[v as usize] = parents[parents[v as usize] as usize];
        v = parents[v as usize];
    }
    v
}
