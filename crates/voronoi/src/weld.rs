//! From tiles to one complex.
//!
//! A vertex is the set of generators that meet there; all tiles around it know the same set, and the one with the smallest
//! seed owns it. Vertices that coincide (more than four generators through one point) are united afterwards, guided by
//! exact ties and never by distance.

use std::collections::HashMap;

use foldhash::fast::FixedState;
use glam::DVec3;
use rayon::prelude::*;

use crate::Dimension;
use crate::corner::Corner;
use crate::flat_cells::remove_flat_cells;
use crate::generator::{Generator, VertexKey};
use crate::measure::{CellSum, KeptMeasures};
use crate::periodic_weld::{canonical, side};
use crate::predicate::ExactInput;
use crate::search::Search;
use crate::tessellation::{FaceId, Shift, Side, Tessellation, VertexId};
use crate::tile::Tile;
use crate::tile_vertex::NONE;

/// The vertices that a tile owns.
struct Owned {
    /// For each vertex of the tile, its rank among those that the tile owns; [`NONE`] for others.
    ranks: Vec<u32>,
    count: u32,
    /// The ranks of those that are known elsewhere as well.
    shared: HashMap<VertexKey, u32, FixedState>,
}

impl Owned {
    fn new(input: ExactInput, tile: &Tile) -> Self {
        let is_owned =
            |key: &VertexKey| key[0].0 >= tile.seeds.start && canonical(input, key) == (*key, Shift::NONE);
        let mut ranks = vec![0; tile.positions.len()];
        for shared in tile.shared.iter().filter(|shared| !is_owned(&shared.key)) {
            ranks[shared.vertex as usize] = NONE;
        }
        let mut count = 0;
        for rank in ranks.iter_mut().filter(|rank| **rank != NONE) {
            *rank = count;
            count += 1;
        }
        let with_rank = tile.shared.iter().map(|shared| (shared.key, ranks[shared.vertex as usize]));
        let shared = with_rank.filter(|(_, rank)| *rank != NONE).collect();
        Self { ranks, count, shared }
    }
}

/// The number of every vertex of every tile in the whole, with the shift to where it is from there.
pub(crate) fn number_vertices(input: ExactInput, tiles: &[Tile]) -> Vec<Vec<Corner>> {
    let owned: Vec<Owned> = tiles.par_iter().map(|tile| Owned::new(input, tile)).collect();
    let mut starts = vec![0u32];
    for tile in &owned {
        starts.push(starts[starts.len() - 1].checked_add(tile.count).expect("vertex ids fit 32 bits"));
    }
    let numbers = tiles.par_iter().zip(&owned).zip(&starts).map(|((tile, own), start)| {
        // Those of vertices that others own come out wrong here, and right below.
        let number = |rank: &u32| Corner { vertex: start.wrapping_add(*rank), shift: Shift::NONE };
        let mut numbers: Vec<Corner> = own.ranks.iter().map(number).collect();
        for shared in tile.shared.iter().filter(|shared| own.ranks[shared.vertex as usize] == NONE) {
            let (key, shift) = canonical(input, &shared.key);
            let owner = tiles.partition_point(|tile| tile.seeds.start <= key[0].0) - 1;
            let rank = owned[owner].shared.get(&key);
            let rank = rank.expect("exact decisions give every tile the same vertices");
            numbers[shared.vertex as usize] = Corner { vertex: starts[owner] + rank, shift };
        }
        numbers
    });
    numbers.collect()
}

/// The positions of all vertices by number.
pub(crate) fn positions(tiles: &[Tile], numbers: &[Vec<Corner>]) -> Vec<DVec3> {
    let mut positions = Vec::with_capacity(tiles.iter().map(|tile| tile.positions.len()).sum());
    for (tile, numbers) in tiles.iter().zip(numbers) {
        for (position, number) in tile.positions.iter().zip(numbers) {
            // Each tile's own vertices come in order.
            if number.shift == Shift::NONE && number.vertex as usize == positions.len() {
                positions.push(*position);
            }
        }
    }
    positions
}

/// Makes one complex of all tiles; `seeds` and the result's cells are in the order of the input.
pub(crate) fn weld(search: &Search, seeds: &[DVec3], mut tiles: Vec<Tile>) -> Tessellation {
    let domain = search.input().domain;
    let moved = number_vertices(search.input(), &tiles);
    let mut vertices = positions(&tiles, &moved);
    let mut numbers: Vec<Vec<u32>> =
        moved.into_par_iter().map(|tile| tile.iter().map(|vertex| vertex.vertex).collect()).collect();
    let are_coincident = tiles.iter().any(|tile| !tile.coincident.is_empty());
    if are_coincident {
        let (ids, representatives) = unite_coincident(vertices.len(), &tiles, &numbers);
        numbers.iter_mut().flatten().for_each(|number| *number = ids[*number as usize]);
        vertices = representatives.iter().map(|v| vertices[*v as usize]).collect();
    }
    if are_coincident {
        let fewest_corners = domain.dimension().fewest_corners();
        tiles.par_iter_mut().zip(&numbers).for_each(|(tile, numbers)| {
            tile.drop_repeated_corners(|corner| numbers[corner as usize], fewest_corners);
        });
    }
    let mut tessellation = Tessellation::without_faces(domain, seeds, vertices);
    if !are_coincident && domain.dimension() == Dimension::Three {
        tessellation.measures = cell_measures(search, seeds, &tiles);
    }
    let (face_count, corner_count) =
        tiles.iter().map(Tile::counts).fold((0, 0), |a, b| (a.0 + b.0, a.1 + b.1));
    tessellation.face_sides = Vec::with_capacity(face_count);
    tessellation.face_starts = Vec::with_capacity(face_count + 1);
    tessellation.face_starts.push(0);
    tessellation.face_corners = Vec::with_capacity(corner_count);
    for (tile, numbers) in tiles.drain(..).zip(&numbers) {
        let before = tessellation.face_corners.len();
        let corner = |corner: &u32| VertexId(numbers[*corner as usize]);
        let sides = |sides: &[Generator; 2]| sides.map(|side_of| side(search.end(side_of), Shift::NONE));
        let starts = tile.corner_starts[1..].par_iter().map(|start| before + *start as usize);
        tessellation.face_corners.par_extend(tile.corners.par_iter().map(corner));
        tessellation.face_starts.par_extend(starts);
        tessellation.face_sides.par_extend(tile.faces.par_iter().map(sides));
    }
    put_vertices_on_walls(&mut tessellation);
    list_faces_of_cells(&mut tessellation);
    if remove_flat_cells(&mut tessellation) {
        tessellation.measures = KeptMeasures::default();
        list_faces_of_cells(&mut tessellation);
    }
    tessellation
}

/// The measures of all cells, as the tiles summed them, in the order of the input.
pub(crate) fn cell_measures(search: &Search, seeds: &[DVec3], tiles: &[Tile]) -> KeptMeasures {
    let mut sums: Vec<CellSum> = Vec::with_capacity(seeds.len());
    tiles.iter().for_each(|tile| sums.extend(&tile.sums));
    for (seed, sum) in tiles.iter().flat_map(|tile| &tile.sums_beyond) {
        sums[*seed as usize].add(sum);
    }
    let mut places = vec![0; seeds.len()];
    for (place, id) in (0u32..).zip(search.ids()) {
        places[*id as usize] = place;
    }
    let measure = |(place, seed): (&u32, &DVec3)| sums[*place as usize].measure(*seed);
    KeptMeasures(Some(places.par_iter().zip(seeds).map(measure).collect()))
}

/// Unites vertices that are one point. Returns the new number of every old one, and an old one for every new.
fn unite_coincident(vertex_count: usize, tiles: &[Tile], numbers: &[Vec<u32>]) -> (Vec<u32>, Vec<u32>) {
    let count = u32::try_from(vertex_count).expect("vertex ids fit 32 bits");
    let mut parents: Vec<u32> = (0..count).collect();
    for (tile, numbers) in tiles.iter().zip(numbers) {
        for [v, w] in &tile.coincident {
            let (v, w) = (root(&mut parents, numbers[*v as usize]), root(&mut parents, numbers[*w as usize]));
            // The smaller number stays, so the result does not depend on the order of the pairs.
            parents[v.max(w) as usize] = v.min(w);
        }
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

/// Rounding may leave a vertex of a wall's face a last place beside the wall: it gets the wall's own coordinate, unless the
/// wall is oblique.
pub(crate) fn put_vertices_on_walls(tessellation: &mut Tessellation) {
    for face in 0..tessellation.face_sides.len() {
        if let Side::Wall(wall) = tessellation.face_sides[face][1]
            && let Some((axis, coordinate)) = tessellation.domain.across_axis(wall)
        {
            let corners = tessellation.face_starts[face]..tessellation.face_starts[face + 1];
            for corner in &tessellation.face_corners[corners] {
                tessellation.vertices[corner.index()][axis] = coordinate;
            }
        }
    }
}

/// Lists the faces of each cell in order. Each thread takes some of the cells and looks for them through all faces.
pub(crate) fn list_faces_of_cells(tessellation: &mut Tessellation) {
    let cell_count = tessellation.seeds.len();
    let some_cells = cell_count.div_ceil(rayon::current_num_threads());
    let face_sides = &tessellation.face_sides;
    // The cells of a face among `count` from `first` on, counted from there.
    let cells_of = |sides: [Side; 2], first: usize, count: usize| {
        let place = move |side: Side| match side {
            Side::Cell(cell) => Some(cell.index().wrapping_sub(first)).filter(|place| *place < count),
            Side::Image(..) | Side::Wall(_) => None,
        };
        sides.into_iter().filter_map(place)
    };
    let mut starts = vec![0; cell_count + 1];
    starts[1..].par_chunks_mut(some_cells).enumerate().for_each(|(chunk, counts)| {
        for sides in face_sides {
            for place in cells_of(*sides, chunk * some_cells, counts.len()) {
                counts[place] += 1;
            }
        }
    });
    for cell in 0..cell_count {
        starts[cell + 1] += starts[cell];
    }
    let mut cell_faces = vec![FaceId(0); starts[cell_count]];
    let mut rest = &mut cell_faces[..];
    let mut parts = Vec::new();
    for (chunk, cells) in starts[..cell_count].chunks(some_cells).enumerate() {
        let end = starts[chunk * some_cells + cells.len()];
        let (part, others) = rest.split_at_mut(end - cells[0]);
        parts.push((chunk * some_cells, cells, part));
        rest = others;
    }
    parts.into_par_iter().for_each(|(first, starts, part)| {
        let mut next: Vec<usize> = starts.iter().map(|start| start - starts[0]).collect();
        for (face, sides) in (0u32..).zip(face_sides) {
            for place in cells_of(*sides, first, starts.len()) {
                part[next[place]] = FaceId(face);
                next[place] += 1;
            }
        }
    });
    tessellation.cell_starts = starts;
    tessellation.cell_faces = cell_faces;
}
