//! From tiles to one complex.
//!
//! A vertex is the set of generators that meet there; all tiles around it know the same set, and the one with the smallest
//! seed owns it. Vertices that coincide (more than four generators through one point) are united afterwards, guided by
//! exact ties and never by distance.

use glam::DVec3;
use rayon::prelude::*;

use crate::build::cell_sums::{CellSums, measures};
use crate::build::tile::{Tile, for_each_tiles};
use crate::build::vertex_numbers::{VertexNumbers, push_positions};
use crate::diagram::cell_sum::CellSum;
use crate::diagram::united_vertices::UnitedVertices;
use crate::diagram::whole_cells::unwrapped;
use crate::exact::generator::Generator;
use crate::sites::search::Search;
use crate::{Dimension, PeriodicVertex, Side, Tessellation, Translation, VertexId};

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
    let indices = search.indices();
    let mut face_counts = None;
    if !coincident.is_empty() {
        tessellation = unite_coincident(&tessellation, &coincident);
    } else if domain.dimension() == Dimension::Three {
        let sums = sums.whole();
        tessellation.measures = measures(&sums, &indices, seeds);
        face_counts = Some(sums.iter().map(CellSum::face_count).collect());
    }
    tessellation.shrink_to_fit();
    tessellation.put_vertices_on_walls();
    tessellation.list_faces_of_cells(&indices, face_counts);
    tessellation
}

/// Adds the vertices that a tile owns, its faces and their sums.
fn push_tile(
    tessellation: &mut Tessellation,
    sums: &mut CellSums,
    search: &Search,
    tile: &Tile,
    numbers: &[PeriodicVertex],
) {
    let Tessellation { vertices, face_sides, face_starts, face_corners, .. } = tessellation;
    let before = face_corners.len();
    let corner = |corner: &u32| VertexId(numbers[*corner as usize].vertex);
    let sides =
        |sides: &[Generator; 2]| sides.map(|generator| Side::of(search.end(generator), Translation::ZERO));
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

/// Makes vertices that are one point one vertex, and leaves out what shrinks to points, lines or polygons by that.
fn unite_coincident(cells: &Tessellation, pairs: &[[u32; 2]]) -> Tessellation {
    let mut vertices = UnitedVertices::new(cells.vertices.len());
    for pair in pairs {
        let [v, w] = pair.map(|vertex| PeriodicVertex { vertex, translation: Translation::ZERO });
        vertices.unite(v, w);
    }
    let mut faces = vertices.faces(cells);
    faces.remove_flat_cells(cells.cell_count());
    unwrapped(&cells.domain, &cells.seeds, &faces, &cells.vertices)
}
