//! From the cells of a periodic domain to one complex of whole cells.
//!
//! Cells that differ by whole periods are one. A vertex of one cell may so be a vertex of another one moved by a translation:
//! each vertex is first named by its generators moved to where the cell with the smallest number owns it, and by the translation
//! back. What comes out first is the complex of the torus, every face once. Then each face that joins a cell to a moved one
//! gets its copy at the other cell, so that all cells are whole, and copies are told by their originals and a translation.

use glam::DVec3;
use rayon::prelude::*;

use crate::build::cell_sums::{CellSums, measures};
use crate::build::tile::Tile;
use crate::build::vertex_numbers::{VertexNumbers, push_positions};
use crate::diagram::cell_sum::CellSum;
use crate::diagram::torus::TorusFaces;
use crate::diagram::united_vertices::UnitedVertices;
use crate::diagram::whole_cells::unwrapped;
use crate::sites::search::Search;
use crate::{Dimension, PeriodicVertex, Tessellation};

pub(crate) fn merge_periodic(search: &Search, seeds: &[DVec3], mut tiles: Vec<Tile>) -> Tessellation {
    let dimension = search.domain().dimension();
    let mut numbers = VertexNumbers::new(search.input()).of_tiles(&tiles);
    let mut positions = Vec::with_capacity(tiles.iter().map(|tile| tile.positions.len()).sum());
    tiles.iter().zip(&numbers).for_each(|(tile, numbers)| push_positions(&mut positions, tile, numbers));
    let are_coincident = tiles.iter().any(|tile| !tile.coincident.is_empty());
    if are_coincident {
        let roots = unite_coincident(positions.len(), &tiles, &numbers);
        tiles.par_iter_mut().zip(&mut numbers).for_each(|(tile, numbers)| {
            for corner in &mut *numbers {
                let root = roots[corner.vertex as usize];
                *corner = PeriodicVertex { translation: corner.translation + root.translation, ..root };
            }
            tile.drop_repeated_corners(|corner| numbers[corner as usize], dimension.fewest_corners());
        });
    }
    let mut faces = faces_of_tiles(search, &tiles, &numbers);
    if are_coincident {
        // Both faces of a flat cell have the same corners.
        faces.remove_flat_cells(seeds.len());
    }
    let indices = search.indices();
    let mut tessellation = unwrapped(search.domain(), seeds, &faces, &positions);
    let mut face_counts = None;
    if !are_coincident && dimension == Dimension::Three {
        let mut sums = CellSums::new(seeds.len());
        tiles.iter().for_each(|tile| sums.push_tile(tile));
        let sums = sums.whole();
        tessellation.measures = measures(&sums, &indices, seeds);
        face_counts = Some(sums.iter().map(CellSum::face_count).collect());
    }
    tessellation.list_faces_of_cells(&indices, face_counts);
    tessellation
}

/// Unites vertices that are one point: of each, the one that stands for it.
fn unite_coincident(count: usize, tiles: &[Tile], numbers: &[Vec<PeriodicVertex>]) -> Vec<PeriodicVertex> {
    let mut vertices = UnitedVertices::new(count);
    for (tile, numbers) in tiles.iter().zip(numbers) {
        for [v, w] in &tile.coincident {
            vertices.unite(numbers[*v as usize], numbers[*w as usize]);
        }
    }
    vertices.roots()
}

/// The faces of all tiles, in the user's numbers of cells, with corners by number.
fn faces_of_tiles(search: &Search, tiles: &[Tile], numbers: &[Vec<PeriodicVertex>]) -> TorusFaces {
    let (face_count, corner_count) =
        tiles.iter().map(Tile::counts).fold((0, 0), |a, b| (a.0 + b.0, a.1 + b.1));
    let mut ends = Vec::with_capacity(face_count);
    let mut starts = Vec::with_capacity(face_count + 1);
    starts.push(0);
    let mut corners = Vec::with_capacity(corner_count);
    for (tile, numbers) in tiles.iter().zip(numbers) {
        let before = corners.len();
        starts.par_extend(tile.corner_starts[1..].par_iter().map(|start| before + *start as usize));
        corners.par_extend(tile.corners.par_iter().map(|corner| numbers[*corner as usize]));
        ends.par_extend(tile.faces.par_iter().map(|sides| sides.map(|side| search.end(side))));
    }
    TorusFaces::of_parts(search.domain().dimension(), ends, starts, corners)
}
