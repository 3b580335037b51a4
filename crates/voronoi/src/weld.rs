//! From tiles to one complex.
//!
//! A vertex is the set of generators that meet there; all tiles around it know the same set, and the one with the smallest
//! seed owns it. Vertices that coincide (more than four generators through one point) are united afterwards, guided by
//! exact ties and never by distance.

use std::collections::HashMap;

use glam::DVec3;
use rayon::prelude::*;

use crate::flat_cells::remove_flat_cells;
use crate::generator::Generator;
use crate::grid::SeedGrid;
use crate::tessellation::{CellId, FaceId, Side, Tessellation, VertexId};
use crate::tile::{Tile, VertexGenerators};
use crate::{Dimension, Domain};

/// The vertices that a tile owns.
struct Owned {
    /// For each vertex of the tile, its rank among those that the tile owns.
    ranks: Vec<Option<u32>>,
    count: u32,
    /// The ranks of those that other tiles know as well, by their sorted generators.
    shared: HashMap<VertexGenerators, u32>,
}

impl Owned {
    fn new(tile: &Tile) -> Self {
        let mut owned = Self { ranks: Vec::with_capacity(tile.vertices.len()), count: 0, shared: HashMap::new() };
        for generators in &tile.vertices {
            let is_owned = generators.iter().all(|generator| generator.0 >= tile.seeds.start);
            owned.ranks.push(is_owned.then_some(owned.count));
            if is_owned {
                let is_inner = |generator: &Generator| {
                    generator.as_seed().is_none_or(|seed| seed < tile.seeds.end)
                };
                if !generators.iter().all(is_inner) {
                    owned.shared.insert(sorted(*generators), owned.count);
                }
                owned.count += 1;
            }
        }
        owned
    }
}

fn sorted(mut generators: VertexGenerators) -> VertexGenerators {
    generators.sort_unstable();
    generators
}

/// The number of every vertex of every tile in the whole, and how many there are.
fn number_vertices(tiles: &[Tile]) -> (Vec<Vec<u32>>, usize) {
    let owned: Vec<Owned> = tiles.par_iter().map(Owned::new).collect();
    let mut starts = vec![0u32];
    for tile in &owned {
        starts.push(starts[starts.len() - 1].checked_add(tile.count).expect("vertex ids fit 32 bits"));
    }
    let numbers = tiles.par_iter().zip(&owned).zip(&starts).map(|((tile, own), start)| {
        let number = |(rank, generators): (&Option<u32>, &VertexGenerators)| match rank {
            Some(rank) => start + rank,
            None => {
                let key = sorted(*generators);
                let owner = tiles.partition_point(|tile| tile.seeds.start <= key[0].0) - 1;
                let rank = owned[owner].shared.get(&key);
                starts[owner] + rank.expect("exact decisions give every tile the same vertices")
            }
        };
        own.ranks.iter().zip(&tile.vertices).map(number).collect()
    });
    (numbers.collect(), starts[starts.len() - 1] as usize)
}

/// Makes one complex of all tiles; `seeds` and the result's cells are in the order of the input.
pub(crate) fn weld(domain: &Domain, seeds: &[DVec3], grid: &SeedGrid, mut tiles: Vec<Tile>) -> Tessellation {
    let (mut numbers, vertex_count) = number_vertices(&tiles);
    let mut vertices = vec![DVec3::ZERO; vertex_count];
    for (tile, numbers) in tiles.iter().zip(&numbers) {
        for (position, number) in tile.positions.iter().zip(numbers) {
            vertices[*number as usize] = *position;
        }
    }
    let are_coincident = tiles.iter().any(|tile| !tile.coincident.is_empty());
    if are_coincident {
        let (ids, representatives) = unite_coincident(vertex_count, &tiles, &numbers);
        numbers.iter_mut().flatten().for_each(|number| *number = ids[*number as usize]);
        vertices = representatives.iter().map(|v| vertices[*v as usize]).collect();
    }
    let side = |generator: Generator| match generator.as_wall() {
        Some(wall) => Side::Wall(wall),
        None => Side::Cell(CellId(grid.ids[generator.0 as usize])),
    };
    let fewest_corners = match domain.dimension() {
        Dimension::Two => 2,
        Dimension::Three => 3,
    };
    let mut tessellation = Tessellation {
        domain: *domain,
        seeds: seeds.to_vec(),
        vertices,
        face_sides: Vec::new(),
        face_starts: vec![0],
        face_corners: Vec::new(),
        cell_starts: Vec::new(),
        cell_faces: Vec::new(),
    };
    for (tile, numbers) in tiles.drain(..).zip(&numbers) {
        for (face, [first, second]) in tile.faces.iter().enumerate() {
            let corners = tile.corner_starts[face] as usize..tile.corner_starts[face + 1] as usize;
            let start = tessellation.face_corners.len();
            let ring = &mut tessellation.face_corners;
            ring.extend(tile.corners[corners].iter().map(|corner| VertexId(numbers[*corner as usize])));
            if are_coincident {
                drop_repeated(ring, start);
            }
            if ring.len() - start < fewest_corners {
                ring.truncate(start);
                continue;
            }
            let mut sides = [side(*first), side(*second)];
            if sides[1] < sides[0] {
                sides.swap(0, 1);
                ring[start..].reverse();
            }
            tessellation.face_sides.push(sides);
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
            let (v, w) =
                (root(&mut parents, numbers[*v as usize]), root(&mut parents, numbers[*w as usize]));
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

/// Rounding may leave a vertex of a wall's face a last place beside the wall: it gets the wall's own coordinate.
fn put_vertices_on_walls(tessellation: &mut Tessellation) {
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

fn list_faces_of_cells(tessellation: &mut Tessellation) {
    let cells_of = |sides: &[Side; 2]| {
        sides.map(|side| match side {
            Side::Cell(cell) => Some(cell.index()),
            Side::Wall(_) => None,
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
