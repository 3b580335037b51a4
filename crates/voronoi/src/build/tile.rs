//! The cells of one compact part of the seeds.
//!
//! Seeds are taken one after the other. Each follows the edges of its cell of which one end is known so far to the other end; what
//! it finds there are vertices of three more cells, and the ends of their edges.

use std::ops::Range;

use cancellation::check_cancelled;
use glam::DVec3;
use rayon::prelude::*;

use crate::build::cell_edges::CellEdges;
use crate::build::tile_vertex::{ALL_FACES, FACE_SLOTS, FACES_OF_FIRST, NONE, TileVertex};
use crate::clip::convex_cell::ConvexCell;
use crate::clip::convex_polygon::ConvexPolygon;
use crate::clip::edge_tracing::{EdgeTracing, NewVertex};
use crate::diagram::cell_sum::CellSum;
use crate::diagram::polygon::{FaceMeasure, Polygon};
use crate::exact::generator::{Generator, PLANE, VertexKey};
use crate::exact::half_space::HalfSpace;
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
    current: Vec<EdgeOf>,
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
            self.join(own, 4 * number + LAST_EDGE);
        }
        let mut next = self.first_waiting[place];
        while next != NONE {
            self.join(own, 4 * next + OTHERS_EDGE);
            next = self.vertices[next as usize].next_waiting;
        }
        let ends = self.current.iter().map(|edge_of| (&self.vertices[(edge_of / 4) as usize], edge_of % 4));
        let open = ends.filter(|(vertex, edge)| vertex.ends[*edge as usize] == NONE);
        let radius = open.map(|(vertex, _)| self.relative_to(seed, vertex).length()).reduce(f64::max);
        if let Some(radius) = radius {
            self.edge_tracing.expect(radius)?;
            for edge_of in &self.current {
                let vertex = &self.vertices[(edge_of / 4) as usize];
                self.edge_tracing.suggest(vertex.planes(vertex.slot(own)));
            }
        }
        while let Some(edge_of) = self.current.pop() {
            let (vertex, edge) = (&self.vertices[(edge_of / 4) as usize], (edge_of % 4) as usize);
            if vertex.ends[edge] == NONE {
                let slot = vertex.slot(own);
                let start = self.relative_to(seed, vertex);
                let (along, used) = (vertex.edge_planes(slot, edge), vertex.planes(slot));
                let found = self.edge_tracing.other_end(along, used, start)?;
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
        self.join(own, 4 * number + 1);
        self.join(own, 4 * number + 2);
        number
    }

    /// Joins a vertex to the one at the other end of an edge of the cell under way, once both are known.
    fn join(&mut self, own: Generator, edge_of: EdgeOf) {
        let (vertex, edge) = (&self.vertices[(edge_of / 4) as usize], (edge_of % 4) as usize);
        let planes = vertex.edge_planes(vertex.slot(own), edge);
        if self.is_flat && !planes.contains(&Generator::side(PLANE)) {
            return;
        }
        match self.edges.add(planes, edge_of) {
            Some(other) => self.link(own, edge_of, other),
            None => self.current.push(edge_of),
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

impl Tile {
    /// Empties the tile and makes room for some faces, and for their corners.
    fn restart(&mut self, seeds: Range<u32>, [faces, corners]: [usize; 2]) {
        self.sums.clear();
        self.sums.resize(seeds.len(), CellSum::default());
        self.sums_beyond.clear();
        self.seeds = seeds;
        self.shared.clear();
        self.faces.clear();
        self.faces.reserve(faces);
        self.corner_starts.clear();
        self.corner_starts.reserve(faces + 1);
        self.corner_starts.push(0);
        self.corners.clear();
        self.corners.reserve(corners);
        self.coincident.clear();
    }

    /// Adds those of some faces of a vertex that lie between a seed of the tile and a wall or a site that comes after it in the
    /// user's numbering. All their vertices are known.
    fn push_faces_at(&mut self, search: &Search, vertices: &mut [TileVertex], number: u32, faces: u8) {
        let is_flat = search.domain().dimension() == Dimension::Two;
        let mut faces = faces & !vertices[number as usize].done_faces;
        while faces != 0 {
            let [i, j] = FACE_SLOTS[faces.trailing_zeros() as usize];
            faces &= faces - 1;
            let vertex = &mut vertices[number as usize];
            vertex.mark_done(i, j);
            let Some([own, beyond]) = self.in_order(search, [vertex.generators[i], vertex.generators[j]])
            else {
                continue;
            };
            let is_plane = beyond == Generator::side(PLANE);
            match (is_flat, is_plane) {
                (false, _) => self.push_own_face(search, vertices, number, own, beyond),
                (true, true) => self.push_polygon(search, vertices, number, own),
                (true, false) => {}
            }
        }
    }

    /// The two sides of a face in the order in which this tile has it; none if it is another tile's, or between walls.
    fn in_order(&self, search: &Search, [a, b]: [Generator; 2]) -> Option<[Generator; 2]> {
        let is_first =
            |own: Generator, beyond: Generator| self.seeds.contains(&own.0) && search.is_before(own, beyond);
        if is_first(a, b) { Some([a, b]) } else { is_first(b, a).then_some([b, a]) }
    }

    /// In space, adds the faces of the tile's cells that are other tiles', or the same as others but for periods, each as the tile's cell sees it.
    fn push_faces_of_others(&mut self, search: &Search, vertices: &mut [TileVertex]) {
        let shared: Vec<u32> = self.shared.iter().map(|shared| shared.vertex).collect();
        shared.iter().for_each(|number| vertices[*number as usize].done_faces = 0);
        for number in shared {
            for [i, j] in FACE_SLOTS {
                let vertex = &mut vertices[number as usize];
                if vertex.is_done(i, j) {
                    continue;
                }
                vertex.mark_done(i, j);
                let [a, b] = [vertex.generators[i], vertex.generators[j]];
                let sides = if self.seeds.contains(&a.0) { [a, b] } else { [b, a] };
                if !self.seeds.contains(&sides[0].0) || self.in_order(search, sides).is_some() {
                    continue;
                }
                let [own, beyond] = sides;
                let (face, _) = self.push_ring(search, vertices, number, own, beyond);
                let beyond = beyond.as_site().expect("what lies beyond walls comes after all seeds");
                if !self.seeds.contains(&search.input().image(beyond).seed) {
                    self.sums[(own.0 - self.seeds.start) as usize].add_face(&face, DVec3::ZERO, 1.0);
                }
            }
        }
    }

    /// Adds a face that the tile owns, in space, and what it adds to cells.
    fn push_own_face(
        &mut self,
        search: &Search,
        vertices: &mut [TileVertex],
        first: u32,
        own: Generator,
        beyond: Generator,
    ) {
        let (face, normal) = self.push_ring(search, vertices, first, own, beyond);
        self.sums[(own.0 - self.seeds.start) as usize].add_face(&face, DVec3::ZERO, 1.0);
        if let Some(site) = beyond.as_site() {
            let seed = search.input().image(site).seed;
            match self.sums.get_mut(seed.wrapping_sub(self.seeds.start) as usize) {
                Some(sum) => sum.add_face(&face, normal, -1.0),
                None => {
                    let mut sum = CellSum::default();
                    sum.add_face(&face, normal, -1.0);
                    self.sums_beyond.push((seed, sum));
                }
            }
        }
    }

    /// Adds a face of a cell in space, and returns its measure and a normal: between two sites, the way from one to the other.
    #[inline]
    fn push_ring(
        &mut self,
        search: &Search,
        vertices: &mut [TileVertex],
        first: u32,
        own: Generator,
        beyond: Generator,
    ) -> (FaceMeasure, DVec3) {
        let input = search.input();
        let seed = input.seeds[own.0 as usize];
        let place =
            |vertex: &TileVertex| vertex.position + (input.seeds[vertex.generators[0].0 as usize] - seed);
        let normal = match beyond.as_site() {
            Some(site) => input.difference(own.0, site),
            None => HalfSpace::new(own.0, beyond, input).normal,
        };
        let mut polygon = Polygon::from(place(&vertices[first as usize]), normal);
        for_each_corner(vertices, first, own, beyond, |number, vertex, _, _| {
            self.corners.push(number);
            polygon.go_to(place(vertex));
        });
        let corner_count = self.finish_face([own, beyond]);
        (polygon.measure(corner_count), normal)
    }

    /// Adds the edges of a cell in the plane.
    fn push_polygon(&mut self, search: &Search, vertices: &mut [TileVertex], first: u32, own: Generator) {
        let own_end = search.end(own);
        for_each_corner(vertices, first, own, Generator::side(PLANE), |from, _, beyond, to| {
            if search.end(beyond) > own_end {
                self.corners.extend([from, to]);
                self.finish_face([own, beyond]);
            }
        });
    }

    fn take_vertices(&mut self, search: &Search, vertices: &[TileVertex]) {
        let is_inner =
            |generator: &Generator| self.seeds.contains(&generator.0) || generator.as_site().is_none();
        for (vertex, TileVertex { generators, .. }) in (0u32..).zip(vertices) {
            if !generators.iter().all(is_inner) {
                let mut key = *generators;
                key.sort_unstable();
                self.shared.push(SharedVertex { vertex, key });
            }
        }
        let seeds = search.input().seeds;
        let absolute = |vertex: &TileVertex| seeds[vertex.generators[0].0 as usize] + vertex.position;
        self.positions.clear();
        self.positions.extend(vertices.iter().map(absolute));
    }

    /// Numbers of faces and of their corners.
    pub(crate) fn counts(&self) -> (usize, usize) {
        (self.faces.len(), self.corners.len())
    }

    /// Leaves out corners that have the same number as the one before them, and then faces with fewer than some corners.
    pub(crate) fn drop_repeated_corners<N: PartialEq>(&mut self, number: impl Fn(u32) -> N, fewest: usize) {
        let (faces, starts, corners) = (
            std::mem::take(&mut self.faces),
            std::mem::take(&mut self.corner_starts),
            std::mem::take(&mut self.corners),
        );
        self.corner_starts.push(0);
        let mut ring: Vec<u32> = Vec::new();
        for (sides, range) in faces.iter().zip(starts.windows(2)) {
            ring.clear();
            ring.extend(&corners[range[0] as usize..range[1] as usize]);
            ring.dedup_by_key(|corner| number(*corner));
            while ring.len() > 1 && number(ring[ring.len() - 1]) == number(ring[0]) {
                ring.pop();
            }
            if ring.len() >= fewest {
                self.corners.extend(&ring);
                self.finish_face(*sides);
            }
        }
    }

    /// Makes the corners since the last face a face, and returns their number.
    fn finish_face(&mut self, sides: [Generator; 2]) -> u32 {
        let start = self.corner_starts[self.corner_starts.len() - 1];
        let end = u32::try_from(self.corners.len()).expect("a tile has fewer than 2^32 corners");
        self.faces.push(sides);
        self.corner_starts.push(end);
        end - start
    }
}

/// Visits the corners of a face of a cell of the tile in counter-clockwise order as seen from outside: each corner, what
/// lies beyond the edge from it to the next, and that. Marks the face as done.
fn for_each_corner(
    vertices: &mut [TileVertex],
    first: u32,
    own: Generator,
    other: Generator,
    mut visit: impl FnMut(u32, &TileVertex, Generator, u32),
) {
    let mut at = first;
    loop {
        let vertex = &mut vertices[at as usize];
        let (cell, plane) = (vertex.slot(own), vertex.slot(other));
        vertex.mark_done(cell, plane);
        let (edge, beyond) = TileVertex::next_edge(cell, plane);
        let next = vertex.ends[edge];
        visit(at, vertex, vertex.generators[beyond], next);
        if next == first {
            return;
        }
        at = next;
    }
}
