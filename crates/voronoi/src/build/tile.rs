//! The cells of one compact part of the seeds.
//!
//! Seeds are taken one after the other. Each follows the edges of its cell of which one end is known so far to the other end; what
//! it finds there are vertices of three more cells, and the ends of their edges.

use std::ops::Range;

use cancellation::check_cancelled;
use glam::DVec3;
use rayon::prelude::*;

use crate::build::cell_edges::CellEdges;
use crate::build::tile_vertex::{ALL_FACES, FACES_OF_FIRST, NONE, TileVertex};
use crate::clip::convex_cell::ConvexCell;
use crate::clip::convex_polygon::ConvexPolygon;
use crate::clip::edge_tracing::{EdgeTracing, NewVertex};
use crate::diagram::cell_sum::CellSum;
use crate::exact::generator::{Generator, PLANE, VertexKey};
use crate::sites::search::{ImagesMissing, Search};
use crate::{Dimension, VoronoiError};

/// Distance of two vertices, relative to their distances from the seeds that found them, beyond which they cannot coincide: far
/// above the 1e-12 to which coordinates are known, so that only true candidates go to exact arithmetic.
const POSSIBLY_COINCIDENT: f64 = 1e-9;

/// Cells without what they share with one another twice.
#[derive(Default)]
pub(crate) struct Tile {
    pub(crate) seeds: Range<u32>,
    /// Where the vertices are.
    pub(crate) positions: Vec<DVec3>,
    /// The vertices of which other tiles know as well, or which are others moved by periods.
    pub(crate) shared: Vec<SharedVertex>,
    /// The seed of each face, and the generator beyond: a wall or a site that comes after it in the user's numbering.
    pub(crate) faces: Vec<[Generator; 2]>,
    /// The corners of face f are `corners[corner_starts[f]..corner_starts[f + 1]]`, counter-clockwise from outside the first cell.
    pub(crate) corner_starts: Vec<u32>,
    pub(crate) corners: Vec<u32>,
    /// Pairs of vertices that are one point.
    pub(crate) coincident: Vec<[u32; 2]>,
    /// In space, of the tile's cells: what the faces add up to.
    pub(crate) sums: Vec<CellSum>,
    /// What faces add to cells of other tiles.
    pub(crate) sums_beyond: Vec<(u32, CellSum)>,
}

/// A vertex with generators outside its tile.
pub(crate) struct SharedVertex {
    pub(crate) vertex: u32,
    pub(crate) key: VertexKey,
}

/// Cuts all cells in parallel, with wider search for those that ask for it.
///
/// # Errors
/// [`VoronoiError::TooManySeeds`] as in [`Search::widen`].
pub(crate) fn cut_tiles(search: &mut Search) -> Result<Vec<Tile>, VoronoiError> {
    for_each_tile(search, |builder| std::mem::take(&mut builder.tile))
}

/// Cuts all cells in parallel, and takes of each tile what is wanted of it, in order. All faces of its cells are the tile's own.
///
/// # Errors
/// As of [`cut_tiles`].
pub(crate) fn map_whole_cells<T: Send>(
    search: &mut Search,
    take: impl Fn(&Search<'_>, &mut Tile) -> T + Sync,
) -> Result<Vec<T>, VoronoiError> {
    for_each_tile(search, |builder| {
        builder.tile.push_faces_of_others(builder.search, &mut builder.vertices);
        take(builder.search, &mut builder.tile)
    })
}

fn for_each_tile<T: Send>(
    search: &mut Search,
    take: impl Fn(&mut Builder<'_>) -> T + Sync,
) -> Result<Vec<T>, VoronoiError> {
    let mut taken: Vec<Option<T>> = search.tiles().iter().map(|_| None).collect();
    loop {
        let missing = taken.par_iter_mut().zip(search.tiles()).filter(|(taken, _)| taken.is_none());
        missing.for_each_init(
            || Builder::new(search),
            |builder, (taken, seeds)| *taken = builder.cut(seeds.clone()).ok().map(|()| take(builder)),
        );
        if taken.iter().all(Option::is_some) {
            return Ok(taken.into_iter().flatten().collect());
        }
        search.widen()?;
    }
}

/// Cuts all cells between walls, as many tiles in parallel as there are threads, and shows these in order. Tiles that follow take
/// over their memory: new pages cost about as much as what is written on them.
pub(crate) fn for_each_tiles(search: &Search, mut visit: impl FnMut(&[Tile])) {
    let count = rayon::current_num_threads().min(search.tiles().len());
    let mut builders: Vec<Builder> = (0..count).map(|_| Builder::new(search)).collect();
    let mut tiles: Vec<Tile> = Vec::with_capacity(count);
    for seeds in search.tiles().chunks(count) {
        builders.par_iter_mut().zip(seeds).for_each(|(builder, seeds)| {
            builder.cut(seeds.clone()).expect("between walls there are no images");
        });
        tiles.extend(builders[..seeds.len()].iter_mut().map(|builder| std::mem::take(&mut builder.tile)));
        visit(&tiles);
        builders.iter_mut().zip(tiles.drain(..)).for_each(|(builder, tile)| builder.tile = tile);
    }
}

/// An edge of a vertex, as one number: four times the vertex's, and the edge's.
type EdgeOf = u32;

/// An edge of the cell under way, with one of its ends.
#[derive(Clone, Copy)]
struct OpenEdge {
    edge_of: EdgeOf,
    /// In the order in which they come before the plane at the other end in positive orientation.
    planes: [Generator; 2],
}

/// Of a new vertex, the edge that runs along all its generators but the seed that found it.
const OTHERS_EDGE: EdgeOf = 0;

/// Of a new vertex, the edge that runs along the first three of its generators.
const LAST_EDGE: EdgeOf = 3;

/// Reused from tile to tile so that the buffers are allocated once.
struct Builder<'a> {
    search: &'a Search<'a>,
    edge_tracing: EdgeTracing<'a>,
    seeds: Range<u32>,
    is_flat: bool,
    vertices: Vec<TileVertex>,
    /// The edges of the cell under way.
    edges: CellEdges,
    /// Whether some vertex of the cell is known, seed by seed.
    has_vertex: Vec<bool>,
    /// Of each seed, the list of vertices of which [`OTHERS_EDGE`] waits for it.
    first_waiting: Vec<u32>,
    /// Edges of the cell under way that may lack their other end.
    current: Vec<OpenEdge>,
    /// The one cut last.
    tile: Tile,
}

impl<'a> Builder<'a> {
    fn new(search: &'a Search<'a>) -> Self {
        Self {
            search,
            edge_tracing: EdgeTracing::new(search),
            seeds: 0..0,
            is_flat: search.domain().dimension() == Dimension::Two,
            vertices: Vec::new(),
            edges: CellEdges::new(),
            has_vertex: Vec::new(),
            first_waiting: Vec::new(),
            current: Vec::new(),
            tile: Tile::default(),
        }
    }

    /// Completes the cells of consecutive seeds.
    fn cut(&mut self, seeds: Range<u32>) -> Result<(), ImagesMissing> {
        let count = seeds.len();
        self.seeds = seeds.clone();
        self.vertices.clear();
        self.has_vertex.clear();
        self.has_vertex.resize(count, false);
        self.first_waiting.clear();
        self.first_waiting.resize(count, NONE);
        self.current.clear();
        // Random cells have 6.77 vertices, 7.77 faces and 40.6 corners each, in the plane 2, 3 and 6; walls and what lies on the
        // sides of the tile add to that.
        let per_cell = if self.is_flat { [3, 4, 8] } else { [9, 9, 46] };
        let [vertices, faces, corners] = per_cell.map(|per_cell| per_cell * count);
        self.vertices.reserve(vertices);
        self.tile.restart(seeds.clone(), [faces, corners]);
        for seed in seeds {
            check_cancelled();
            self.complete(seed)?;
        }
        for number in (0u32..).take(self.vertices.len()) {
            self.tile.push_faces_at(self.search, &mut self.vertices, number, ALL_FACES);
        }
        self.tile.take_vertices(self.search, &self.vertices);
        Ok(())
    }

    fn complete(&mut self, seed: u32) -> Result<(), ImagesMissing> {
        self.edge_tracing.start(seed);
        self.edges.clear();
        let known = self.vertices.len();
        let own = Generator::site(seed);
        let place = self.place(seed);
        if !self.has_vertex[place] {
            let Some(planes) = self.first_vertex(seed)? else { return Ok(()) };
            let vertex = self.edge_tracing.vertex_of(planes)?;
            let number = self.push(seed, &vertex);
            let [a, b, _] = vertex.planes;
            self.join(own, 4 * number + LAST_EDGE, [b, a]);
        }
        let mut next = self.first_waiting[place];
        while next != NONE {
            let vertex = &self.vertices[next as usize];
            let (number, planes) = (next, vertex.edge_planes(vertex.slot(own), OTHERS_EDGE as usize));
            next = vertex.next_waiting;
            self.join(own, 4 * number + OTHERS_EDGE, planes);
        }
        let ends =
            self.current.iter().map(|edge| (&self.vertices[(edge.edge_of / 4) as usize], edge.edge_of % 4));
        let open = ends.filter(|(vertex, edge)| vertex.ends[*edge as usize] == NONE);
        let radius = open.map(|(vertex, _)| self.relative_to(seed, vertex).length()).reduce(f64::max);
        if let Some(radius) = radius {
            self.edge_tracing.expect(radius)?;
            for edge in &self.current {
                let vertex = &self.vertices[(edge.edge_of / 4) as usize];
                self.edge_tracing.suggest(vertex.planes(vertex.slot(own)));
            }
        }
        while let Some(OpenEdge { edge_of, planes }) = self.current.pop() {
            let (vertex, edge) = (&self.vertices[(edge_of / 4) as usize], (edge_of % 4) as usize);
            if vertex.ends[edge] == NONE {
                let (start, last) = (self.relative_to(seed, vertex), vertex.generators[edge]);
                let found = self.edge_tracing.other_end(planes, last, start)?;
                let number = self.push(seed, &found);
                // What the two vertices share comes first in the new one.
                self.link(own, 4 * number + LAST_EDGE, edge_of);
            }
        }
        // Nearly all faces are found here, while their vertices are in the cache.
        for number in (0u32..).take(self.vertices.len()).skip(known) {
            self.tile.push_faces_at(self.search, &mut self.vertices, number, FACES_OF_FIRST);
        }
        Ok(())
    }

    fn place(&self, seed: u32) -> usize {
        (seed - self.seeds.start) as usize
    }

    /// The position of a vertex relative to a seed.
    fn relative_to(&self, seed: u32, vertex: &TileVertex) -> DVec3 {
        let seeds = self.search.input().seeds;
        vertex.position + (seeds[vertex.generators[0].0 as usize] - seeds[seed as usize])
    }

    /// The planes of one vertex of a cell of which none is known; none if the cell is empty.
    fn first_vertex(&mut self, seed: u32) -> Result<Option<[Generator; 3]>, ImagesMissing> {
        let (search, input) = (self.search, self.search.input());
        let cutter = |planes| self.edge_tracing.cutter(planes);
        match self.search.domain().dimension() {
            Dimension::Three => search.any_vertex(|| ConvexCell::new(seed, input), seed, cutter),
            Dimension::Two => search.any_vertex(|| ConvexPolygon::new(seed, input), seed, cutter),
        }
    }

    /// Adds a vertex of the cell under way, and joins it to those at the other ends of its edges that are known, but for the last.
    fn push(&mut self, seed: u32, found: &NewVertex) -> u32 {
        let number = u32::try_from(self.vertices.len())
            .ok()
            .filter(|number| *number < NONE / 4)
            .expect("a tile has fewer than 2^30 vertices");
        let own = Generator::site(seed);
        let [a, b, c] = found.planes;
        self.has_vertex[(seed - self.seeds.start) as usize] = true;
        // Edges of earlier seeds have both ends, so the edge of the others waits for its first seed in the tile.
        let mut first = Generator::NONE;
        for generator in [a, b, c].into_iter().filter(|generator| self.seeds.contains(&generator.0)) {
            let place = self.place(generator.0);
            self.has_vertex[place] = true;
            first = first.min(generator);
        }
        let mut next_waiting = NONE;
        if first != Generator::NONE && (!self.is_flat || [a, b, c].contains(&Generator::side(PLANE))) {
            let place = self.place(first.0);
            next_waiting = std::mem::replace(&mut self.first_waiting[place], number);
        }
        self.vertices.push(TileVertex {
            generators: [own, a, b, c],
            position: found.position,
            ends: [NONE; 4],
            next_waiting,
            has_tie: found.has_tie,
            done_faces: 0,
        });
        self.join(own, 4 * number + 1, [c, b]);
        self.join(own, 4 * number + 2, [a, c]);
        number
    }

    /// Joins a vertex to the one at the other end of an edge of the cell under way, along two planes, once both are known.
    fn join(&mut self, own: Generator, edge_of: EdgeOf, planes: [Generator; 2]) {
        if self.is_flat && !planes.contains(&Generator::side(PLANE)) {
            return;
        }
        match self.edges.add(planes, edge_of) {
            Some(other) => self.link(own, edge_of, other),
            None => self.current.push(OpenEdge { edge_of, planes }),
        }
    }

    /// Makes two vertices the ends of an edge of a cell.
    fn link(&mut self, own: Generator, one: EdgeOf, other: EdgeOf) {
        self.vertices[(one / 4) as usize].ends[(one % 4) as usize] = other / 4;
        self.vertices[(other / 4) as usize].ends[(other % 4) as usize] = one / 4;
        if self.vertices[(one / 4) as usize].has_tie && self.coincide(own, one / 4, other) {
            self.tile.coincident.push([one / 4, other / 4]);
        }
    }

    /// Whether the two ends of an edge of a cell are one point, exactly: then the plane that they do not share passes through
    /// both.
    fn coincide(&self, cell: Generator, number: u32, other: EdgeOf) -> bool {
        let v = &self.vertices[number as usize];
        let (w, edge) = (&self.vertices[(other / 4) as usize], (other % 4) as usize);
        let [at_v, at_w] = [v, w].map(|vertex| self.relative_to(cell.0, vertex));
        // The cell's own seed may be where they are, and its distance from them nothing: that of the seeds that found them is what
        // rounding is relative to, and, as these lie elsewhere, the cell's own.
        let size = v.position.length() + w.position.length() + at_v.length();
        v.has_tie
            && w.has_tie
            && at_v.distance(at_w) <= POSSIBLY_COINCIDENT * size
            && self.search.input().decide(cell.0, v.planes(v.slot(cell)), w.generators[edge]).tie
    }
}

#[cfg(test)]
mod tests {
    use glam::BVec3;

    use super::*;
    use crate::Domain;

    /// Edges that were believed to be as long as the box made all tiles be cut thrice, with more and more images.
    #[test]
    fn random_cells_of_a_periodic_box_need_the_first_images_alone() {
        let fraction = |i: u32, k: f64| (f64::from(i) * k).fract();
        let seed =
            |i: u32| DVec3::new(fraction(i, 0.618_034), fraction(i * i, 0.754_878), fraction(i, 0.569_84));
        let seeds: Vec<DVec3> = (0..20_000).map(seed).collect();
        let domain = Domain::unit_cube().with_periods(BVec3::TRUE);
        let mut search = Search::new(&domain, &seeds, None).expect("seeds are good");
        let tiles = cut_tiles(&mut search).expect("few images");
        assert!(tiles.len() > 1);
        assert_eq!(search.layers.len(), 1);
    }
}
