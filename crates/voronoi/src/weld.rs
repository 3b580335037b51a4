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
use crate::tessellation::{CellId, Shift, Side, Tessellation, VertexId};
use crate::tile::{Tile, for_each_tiles};
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

/// Numbers in the whole for the vertices of tiles.
pub(crate) struct VertexNumbers<'a> {
    input: ExactInput<'a>,
    /// Of each tile that was numbered, its first seed, the number of its first own vertex, and the ranks of its own vertices that
    /// are known elsewhere as well.
    first_seeds: Vec<u32>,
    starts: Vec<u32>,
    shared: Vec<HashMap<VertexKey, u32, FixedState>>,
    count: u32,
}

impl<'a> VertexNumbers<'a> {
    pub(crate) fn new(input: ExactInput<'a>) -> Self {
        Self { input, first_seeds: Vec::new(), starts: Vec::new(), shared: Vec::new(), count: 0 }
    }

    /// The number of every vertex of further tiles, with the shift to where it is from there. Who owns a vertex must be numbered
    /// before, or among them: between walls that holds for tiles in order.
    pub(crate) fn of_tiles(&mut self, tiles: &[Tile]) -> Vec<Vec<Corner>> {
        let input = self.input;
        let owned: Vec<Owned> = tiles.par_iter().map(|tile| Owned::new(input, tile)).collect();
        let first = self.starts.len();
        let mut ranks = Vec::with_capacity(tiles.len());
        for (tile, owned) in tiles.iter().zip(owned) {
            self.first_seeds.push(tile.seeds.start);
            self.starts.push(self.count);
            self.count = self.count.checked_add(owned.count).expect("vertex ids fit 32 bits");
            self.shared.push(owned.shared);
            ranks.push(owned.ranks);
        }
        let numbers =
            tiles.par_iter().zip(&ranks).zip(&self.starts[first..]).map(|((tile, ranks), start)| {
                // Those of vertices that others own come out wrong here, and right below.
                let number = |rank: &u32| Corner { vertex: start.wrapping_add(*rank), shift: Shift::NONE };
                let mut numbers: Vec<Corner> = ranks.iter().map(number).collect();
                for shared in tile.shared.iter().filter(|shared| ranks[shared.vertex as usize] == NONE) {
                    let (key, shift) = canonical(input, &shared.key);
                    let owner = self.first_seeds.partition_point(|first| *first <= key[0].0) - 1;
                    let rank = self.shared[owner].get(&key);
                    let rank = rank.expect("exact decisions give every tile the same vertices");
                    numbers[shared.vertex as usize] = Corner { vertex: self.starts[owner] + rank, shift };
                }
                numbers
            });
        numbers.collect()
    }
}

/// Adds the positions of a tile's own vertices to those of the tiles before.
pub(crate) fn push_positions(positions: &mut Vec<DVec3>, tile: &Tile, numbers: &[Corner]) {
    for (position, number) in tile.positions.iter().zip(numbers) {
        // Each tile's own vertices come in order.
        if number.shift == Shift::NONE && number.vertex as usize == positions.len() {
            positions.push(*position);
        }
    }
}

/// Cuts all cells and makes one complex of them; `seeds` and the result's cells are in the order of the input.
pub(crate) fn weld(search: &Search, seeds: &[DVec3]) -> Tessellation {
    let domain = search.input().domain;
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
    put_vertices_on_walls(&mut tessellation);
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
            None => side(search.end(generator), Shift::NONE),
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

/// What the faces of every cell add up to, gathered from tiles.
pub(crate) struct CellSums {
    sums: Vec<CellSum>,
    /// What tiles add to cells of others.
    beyond: Vec<(u32, CellSum)>,
}

impl CellSums {
    pub(crate) fn new(cell_count: usize) -> Self {
        Self { sums: Vec::with_capacity(cell_count), beyond: Vec::new() }
    }

    /// Adds the next tile.
    pub(crate) fn push_tile(&mut self, tile: &Tile) {
        self.sums.extend_from_slice(&tile.sums);
        self.beyond.extend_from_slice(&tile.sums_beyond);
    }

    /// The sums of all cells.
    pub(crate) fn whole(mut self) -> Vec<CellSum> {
        for (seed, sum) in &self.beyond {
            self.sums[*seed as usize].add(sum);
        }
        self.sums
    }
}

/// The measures of the cells of all seeds, of which the places in the order of the sums are given.
pub(crate) fn measures(sums: &[CellSum], places: &[u32], seeds: &[DVec3]) -> KeptMeasures {
    let measure = |(place, seed): (&u32, &DVec3)| sums[*place as usize].measure(*seed);
    KeptMeasures(Some(places.par_iter().zip(seeds).map(measure).collect()))
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

/// Rounding may leave a vertex of a wall's face a last place beside the wall: it gets the wall's own coordinate, unless the
/// wall is oblique.
pub(crate) fn put_vertices_on_walls(tessellation: &mut Tessellation) {
    let domain = &tessellation.domain;
    let on_wall = |(face, sides): (usize, &[Side; 2])| match sides[1] {
        Side::Wall(wall) => domain.across_axis(wall).map(|(axis, coordinate)| (face, axis, coordinate)),
        Side::Cell(_) | Side::Image(..) => None,
    };
    let faces: Vec<_> = tessellation.face_sides.par_iter().enumerate().filter_map(on_wall).collect();
    for (face, axis, coordinate) in faces {
        let corners = tessellation.face_starts[face]..tessellation.face_starts[face + 1];
        for corner in &tessellation.face_corners[corners] {
            tessellation.vertices[corner.index()][axis] = coordinate;
        }
    }
}
