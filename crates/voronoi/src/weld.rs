//! From tiles to one complex.
//!
//! A vertex is the set of generators that meet there; all tiles around it know the same set, and the one with the smallest
//! seed owns it. Vertices that coincide (more than four generators through one point) are united afterwards, guided by
//! exact ties and never by distance.

use std::collections::HashMap;

use glam::DVec3;
use rayon::prelude::*;

use crate::Dimension;
use crate::flat_cells::remove_flat_cells;
use crate::generator::{Generator, VertexKey};
use crate::periodic_weld::{canonical, side};
use crate::predicate::ExactInput;
use crate::search::Search;
use crate::tessellation::{FaceId, Shift, Side, Tessellation, VertexId};
use crate::tile::Tile;

/// A vertex moved by whole periods.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct MovedVertex {
    pub(crate) vertex: u32,
    pub(crate) shift: Shift,
}

/// The vertices that a tile owns.
struct Owned {
    /// For each vertex of the tile, its rank among those that the tile owns.
    ranks: Vec<Option<u32>>,
    count: u32,
    /// The ranks of those that are known elsewhere as well.
    shared: HashMap<VertexKey, u32>,
}

impl Owned {
    fn new(input: ExactInput, tile: &Tile) -> Self {
        let mut owned =
            Self { ranks: Vec::with_capacity(tile.vertices.len()), count: 0, shared: HashMap::new() };
        for key in &tile.vertices {
            let is_inner =
                |generator: &Generator| generator.as_site().is_none_or(|site| tile.seeds.contains(&site));
            let is_shared = !key.iter().all(is_inner);
            let is_owned =
                !is_shared || (key[0].0 >= tile.seeds.start && canonical(input, key) == (*key, Shift::NONE));
            owned.ranks.push(is_owned.then_some(owned.count));
            if is_owned {
                if is_shared {
                    owned.shared.insert(*key, owned.count);
                }
                owned.count += 1;
            }
        }
        owned
    }
}

/// The number of every vertex of every tile in the whole, with the shift to where it is from there.
pub(crate) fn number_vertices(input: ExactInput, tiles: &[Tile]) -> Vec<Vec<MovedVertex>> {
    let owned: Vec<Owned> = tiles.par_iter().map(|tile| Owned::new(input, tile)).collect();
    let mut starts = vec![0u32];
    for tile in &owned {
        starts.push(starts[starts.len() - 1].checked_add(tile.count).expect("vertex ids fit 32 bits"));
    }
    let numbers = tiles.par_iter().zip(&owned).zip(&starts).map(|((tile, own), start)| {
        let number = |(rank, key): (&Option<u32>, &VertexKey)| match rank {
            Some(rank) => MovedVertex { vertex: start + rank, shift: Shift::NONE },
            None => {
                let (key, shift) = canonical(input, key);
                let owner = tiles.partition_point(|tile| tile.seeds.start <= key[0].0) - 1;
                let rank = owned[owner].shared.get(&key);
                let rank = rank.expect("exact decisions give every tile the same vertices");
                MovedVertex { vertex: starts[owner] + rank, shift }
            }
        };
        own.ranks.iter().zip(&tile.vertices).map(number).collect()
    });
    numbers.collect()
}

/// The positions of all vertices by number.
pub(crate) fn positions(tiles: &[Tile], numbers: &[Vec<MovedVertex>]) -> Vec<DVec3> {
    let mut positions = Vec::new();
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
        moved.iter().map(|tile| tile.iter().map(|vertex| vertex.vertex).collect()).collect();
    let are_coincident = tiles.iter().any(|tile| !tile.coincident.is_empty());
    if are_coincident {
        let (ids, representatives) = unite_coincident(vertices.len(), &tiles, &numbers);
        numbers.iter_mut().flatten().for_each(|number| *number = ids[*number as usize]);
        vertices = representatives.iter().map(|v| vertices[*v as usize]).collect();
    }
    let fewest_corners = match domain.dimension() {
        Dimension::Two => 2,
        Dimension::Three => 3,
    };
    let mut tessellation = Tessellation::without_faces(domain, seeds, vertices);
    let (face_count, corner_count) =
        tiles.iter().map(Tile::counts).fold((0, 0), |a, b| (a.0 + b.0, a.1 + b.1));
    tessellation.face_sides.reserve_exact(face_count);
    tessellation.face_starts.reserve_exact(face_count);
    tessellation.face_corners.reserve_exact(corner_count);
    for (tile, numbers) in tiles.drain(..).zip(&numbers) {
        for (sides, corners) in tile.faces() {
            let start = tessellation.face_corners.len();
            let ring = &mut tessellation.face_corners;
            ring.extend(corners.iter().map(|corner| VertexId(numbers[*corner as usize])));
            if are_coincident {
                drop_repeated(ring, start);
            }
            if ring.len() - start < fewest_corners {
                ring.truncate(start);
                continue;
            }
            tessellation.face_sides.push(sides.map(|generator| side(search.end(generator), Shift::NONE)));
            tessellation.face_starts.push(ring.len());
        }
    }
    put_vertices_on_walls(&mut tessellation);
    list_faces_of_cells(&mut tessellation);
    if remove_flat_cells(&mut tessellation) {
        list_faces_of_cells(&mut tessellation);
    }
    tessellation
}

/// Leaves out corners that follow themselves in the ring from `start` on.
fn drop_repeated(ring: &mut Vec<VertexId>, start: usize) {
    let mut kept = start;
    for corner in start..ring.len() {
        if kept == start || ring[corner] != ring[kept - 1] {
            ring[kept] = ring[corner];
            kept += 1;
        }
    }
    while kept > start + 1 && ring[kept - 1] == ring[start] {
        kept -= 1;
    }
    ring.truncate(kept);
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
