//! Numbers for the vertices of tiles: each has its number from the one tile that owns it.

use std::collections::HashMap;

use foldhash::fast::FixedState;
use glam::DVec3;
use rayon::prelude::*;

use crate::build::tile::Tile;
use crate::build::tile_vertex::NONE;
use crate::exact::generator::{Generator, Plane, VertexKey};
use crate::exact::image::Image;
use crate::exact::input::ExactInput;
use crate::{PeriodicVertex, Translation};

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
        let is_owned = |key: &VertexKey| {
            key[0].0 >= tile.seeds.start && canonical(input, key) == (*key, Translation::ZERO)
        };
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

    /// The number of every vertex of further tiles, with the translation to where it is from there. Who owns a vertex must be numbered
    /// before, or among them: between walls that holds for tiles in order.
    pub(crate) fn of_tiles(&mut self, tiles: &[Tile]) -> Vec<Vec<PeriodicVertex>> {
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
                let number = |rank: &u32| PeriodicVertex {
                    vertex: start.wrapping_add(*rank),
                    translation: Translation::ZERO,
                };
                let mut numbers: Vec<PeriodicVertex> = ranks.iter().map(number).collect();
                for shared in tile.shared.iter().filter(|shared| ranks[shared.vertex as usize] == NONE) {
                    let (key, translation) = canonical(input, &shared.key);
                    let owner = self.first_seeds.partition_point(|first| *first <= key[0].0) - 1;
                    let rank = self.shared[owner].get(&key);
                    let rank = rank.expect("exact decisions give every tile the same vertices");
                    numbers[shared.vertex as usize] =
                        PeriodicVertex { vertex: self.starts[owner] + rank, translation };
                }
                numbers
            });
        numbers.collect()
    }
}

/// The generators of a vertex, all moved by whole periods to where the cell of the smallest number among them owns it, and
/// the translation from there back. Where that cell meets the vertex in several places, the smallest list of generators tells.
pub(crate) fn canonical(input: ExactInput, key: &VertexKey) -> (VertexKey, Translation) {
    let first_image =
        Generator::site(u32::try_from(input.seeds.len()).expect("site ids were checked to fit"));
    let is_image = |generator: &Generator| *generator >= first_image && generator.as_site().is_some();
    if !key.iter().any(is_image) {
        return (*key, Translation::ZERO);
    }
    let planes = key.map(Generator::plane);
    let images = planes.map(|plane| match plane {
        Plane::Site(site) => Some(input.image(site)),
        Plane::Side(_) | Plane::Facet(_) => None,
    });
    let smallest = images.iter().flatten().map(|image| image.seed).min();
    let candidates = images.iter().flatten().filter(|image| Some(image.seed) == smallest);
    let moved = candidates.map(|owner| {
        let mut moved = images.map(|image| {
            image.map(|Image { seed, translation }| Image {
                seed,
                translation: translation - owner.translation,
            })
        });
        moved.sort_unstable();
        (moved, owner.translation)
    });
    let (moved, translation) = moved.min().expect("every vertex belongs to a cell");
    let mut sites =
        moved.iter().flatten().map(|image| input.site(*image).expect("the owner was cut by these sites"));
    let mut owned = planes.map(|plane| match plane {
        Plane::Site(_) => Generator::site(sites.next().expect("as many sites as before")),
        Plane::Side(wall) => Generator::side(wall),
        Plane::Facet(wall) => Generator::facet(wall),
    });
    owned.sort_unstable();
    (owned, translation)
}

/// Adds the positions of a tile's own vertices to those of the tiles before.
pub(crate) fn push_positions(positions: &mut Vec<DVec3>, tile: &Tile, numbers: &[PeriodicVertex]) {
    for (position, number) in tile.positions.iter().zip(numbers) {
        // Each tile's own vertices come in order.
        if number.translation == Translation::ZERO && number.vertex as usize == positions.len() {
            positions.push(*position);
        }
    }
}
