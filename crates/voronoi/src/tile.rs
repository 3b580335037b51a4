//! The cells of one compact part of the seeds.
//!
//! Cells are completed one after the other. Each starts from the vertices that those before it have found, on average three
//! quarters of its own, and finds the rest.

use std::ops::Range;

use glam::DVec3;
use rayon::prelude::*;

use crate::Dimension;
use crate::convex_cell::ConvexCell;
use crate::generator::{Generator, VertexKey};
use crate::half_space::HalfSpace;
use crate::open_cell::{CellVertex, NewVertex, OpenCell, PLANE};
use crate::polygon::ConvexPolygon;
use crate::search::{ImagesMissing, Search};
use crate::torus::FaceEnd;

/// A vertex while its cells are completed.
struct TileVertex {
    /// A seed, and the planes of its cell in positive orientation.
    generators: [Generator; 4],
    /// Relative to the first generator.
    position: DVec3,
    /// Bound on the error of each coordinate.
    error: f64,
    /// For each generator but the first, the next vertex of the tile in the list of its cell.
    next: [u32; 3],
    has_tie: bool,
}

/// End of a list of vertices.
const END: u32 = u32::MAX;

/// Cells without what they share with one another twice.
pub(crate) struct Tile {
    pub(crate) seeds: Range<u32>,
    pub(crate) vertices: Vec<VertexKey>,
    pub(crate) positions: Vec<DVec3>,
    /// The seed of each face, and the generator beyond: a wall or a site that comes after it in the user's numbering.
    faces: Vec<[Generator; 2]>,
    /// The corners of face f are `corners[corner_starts[f]..corner_starts[f + 1]]`, counter-clockwise from outside the first cell.
    corner_starts: Vec<u32>,
    corners: Vec<u32>,
    /// Pairs of vertices that are one point.
    pub(crate) coincident: Vec<[u32; 2]>,
}

/// Cuts all cells in parallel, with wider search for those that ask for it.
pub(crate) fn cut_tiles(search: &mut Search) -> Vec<Tile> {
    let mut tiles: Vec<Option<Tile>> = search.tiles().iter().map(|_| None).collect();
    loop {
        let missing = tiles.par_iter_mut().zip(search.tiles()).filter(|(tile, _)| tile.is_none());
        missing.for_each(|(tile, seeds)| *tile = cut_tile(search, seeds.clone()).ok());
        if tiles.iter().all(Option::is_some) {
            return tiles.into_iter().flatten().collect();
        }
        search.widen();
    }
}

/// Completes the cells of consecutive seeds.
fn cut_tile(search: &Search, seeds: Range<u32>) -> Result<Tile, ImagesMissing> {
    // Random cells have 6.77 vertices, 7.77 faces and 40.6 corners each, in the plane 2, 3 and 6; walls add to that.
    let [vertices, faces, corners] = match search.input().domain.dimension() {
        Dimension::Two => [3, 4, 8].map(|count| count * seeds.len()),
        Dimension::Three => [8, 9, 46].map(|count| count * seeds.len()),
    };
    let mut corner_starts = Vec::with_capacity(faces);
    corner_starts.push(0);
    let mut builder = Builder {
        search,
        vertices: Vec::with_capacity(vertices),
        lists: vec![END; seeds.len()],
        order: Vec::new(),
        tile: Tile {
            seeds: seeds.clone(),
            vertices: Vec::new(),
            positions: Vec::new(),
            faces: Vec::with_capacity(faces),
            corner_starts,
            corners: Vec::with_capacity(corners),
            coincident: Vec::new(),
        },
    };
    let mut cell = OpenCell::new(search);
    for seed in seeds {
        builder.complete(&mut cell, seed)?;
        builder.push_faces(&cell, seed);
    }
    Ok(builder.finish())
}

struct Builder<'a> {
    search: &'a Search<'a>,
    vertices: Vec<TileVertex>,
    /// First entry of the list of each cell's known vertices. An entry is a vertex's number times four and the place
    /// of the cell among its generators.
    lists: Vec<u32>,
    /// The faces of the cell under way by what lies beyond.
    order: Vec<(FaceEnd, u16)>,
    tile: Tile,
}

impl Builder<'_> {
    fn complete(&mut self, cell: &mut OpenCell, seed: u32) -> Result<(), ImagesMissing> {
        cell.start(seed);
        let own = self.search.input().seeds[seed as usize];
        let mut entry = self.lists[(seed - self.tile.seeds.start) as usize];
        if entry == END {
            let Some(planes) = self.first_vertex(seed)? else { return Ok(()) };
            let vertex = cell.vertex_of(planes)?;
            self.push(cell, seed, &vertex);
        }
        while entry != END {
            let vertex = &self.vertices[(entry / 4) as usize];
            let [p, a, b, c] = vertex.generators;
            // The orientation of the planes as the others of the four see it.
            let (place, generators) =
                [(0, [p, c, b]), (1, [p, a, c]), (2, [p, b, a])][(entry % 4) as usize - 1];
            let shift = self.search.input().seeds[p.0 as usize] - own;
            let position = vertex.position + shift;
            let rounding = f64::EPSILON * (vertex.position.abs() + shift.abs()).max_element();
            let has_tie = vertex.has_tie;
            let known = NewVertex { generators, position, error: vertex.error + rounding, has_tie };
            cell.add(entry / 4, &known);
            entry = vertex.next[place];
        }
        while let Some(vertex) = cell.next_vertex()? {
            self.push(cell, seed, &vertex);
        }
        Ok(())
    }

    /// The planes of one vertex of a cell of which none is known; none if the cell is empty.
    fn first_vertex(&self, seed: u32) -> Result<Option<[Generator; 3]>, ImagesMissing> {
        let input = self.search.input();
        match input.domain.dimension() {
            Dimension::Three => self.search.any_vertex(ConvexCell::new(seed, input), seed),
            Dimension::Two => self.search.any_vertex(ConvexPolygon::new(seed, input), seed),
        }
    }

    /// Adds a vertex to the cell under way and to the lists of the others.
    fn push(&mut self, cell: &mut OpenCell, seed: u32, vertex: &NewVertex) {
        let number = u32::try_from(self.vertices.len()).expect("a tile has fewer than 2^30 vertices");
        cell.add(number, vertex);
        let mut next = [END; 3];
        for (place, generator) in (0u32..).zip(vertex.generators) {
            if self.tile.seeds.contains(&generator.0) {
                let list = &mut self.lists[(generator.0 - self.tile.seeds.start) as usize];
                next[place as usize] = *list;
                *list = 4 * number + place + 1;
            }
        }
        let [a, b, c] = vertex.generators;
        self.vertices.push(TileVertex {
            generators: [Generator::site(seed), a, b, c],
            position: vertex.position,
            error: vertex.error,
            next,
            has_tie: vertex.has_tie,
        });
    }

    /// Adds the faces of a complete cell that it is the first side of, sorted by what lies beyond.
    fn push_faces(&mut self, cell: &OpenCell, seed: u32) {
        let own = Generator::site(seed);
        let own_end = self.search.end(own);
        let (tile, search) = (&mut self.tile, self.search);
        match search.input().domain.dimension() {
            Dimension::Three => {
                self.order.clear();
                let ends = cell.planes().iter().map(|plane| search.end(plane.generator));
                self.order.extend(ends.zip(0u16..).filter(|(end, _)| *end > own_end));
                self.order.sort_unstable();
                for (_, p) in &self.order {
                    cell.for_each_edge(*p, |from, _, to| {
                        tile.corners.push(from.number);
                        tile.note_edge(cell, from, to);
                    });
                    tile.finish_face([own, cell.planes()[usize::from(*p)].generator]);
                }
            }
            Dimension::Two => {
                // The polygon is the face in the plane, and its edges are the faces of the tessellation.
                let is_plane = |(_, plane): &(u16, &HalfSpace)| plane.generator == Generator::side(PLANE);
                for (p, _) in (0u16..).zip(cell.planes()).filter(is_plane) {
                    cell.for_each_edge(p, |from, beyond, to| {
                        tile.note_edge(cell, from, to);
                        if search.end(beyond) > own_end {
                            tile.corners.extend([from.number, to.number]);
                            tile.finish_face([own, beyond]);
                        }
                    });
                }
            }
        }
    }

    fn finish(mut self) -> Tile {
        let key = |vertex: &TileVertex| {
            let mut key = vertex.generators;
            key.sort_unstable();
            key
        };
        self.tile.vertices = self.vertices.iter().map(key).collect();
        let seeds = self.search.input().seeds;
        let absolute = |vertex: &TileVertex| seeds[vertex.generators[0].0 as usize] + vertex.position;
        self.tile.positions = self.vertices.iter().map(absolute).collect();
        self.tile
    }
}

impl Tile {
    /// Numbers of faces and of their corners.
    pub(crate) fn counts(&self) -> (usize, usize) {
        (self.faces.len(), self.corners.len())
    }

    /// The faces with their corners.
    pub(crate) fn faces(&self) -> impl Iterator<Item = (&[Generator; 2], &[u32])> {
        let corners = self.corner_starts.windows(2).map(|range| range[0] as usize..range[1] as usize);
        self.faces.iter().zip(corners.map(|range| &self.corners[range]))
    }

    /// Notes an edge of a cell that has no length.
    fn note_edge(&mut self, cell: &OpenCell, from: &CellVertex, to: &CellVertex) {
        if cell.coincide(from, to) {
            self.coincident.push([from.number, to.number]);
        }
    }

    /// Makes the corners since the last face a face.
    fn finish_face(&mut self, sides: [Generator; 2]) {
        self.faces.push(sides);
        self.corner_starts
            .push(u32::try_from(self.corners.len()).expect("a tile has fewer than 2^32 corners"));
    }
}
