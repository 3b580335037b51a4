//! The cells of one compact part of the seeds.
//!
//! Cells are completed one after the other. Each starts from the vertices that those before it have found, on average three
//! quarters of its own, and finds the rest.

use std::ops::Range;

use glam::DVec3;

use crate::Dimension;
use crate::convex_cell::ConvexCell;
use crate::generator::Generator;
use crate::near_seeds::NearSeeds;
use crate::open_cell::{NewVertex, OpenCell, PLANE};
use crate::polygon::ConvexPolygon;

/// The four generators whose bisectors and walls meet in a vertex in general position: a seed, and the planes of its cell in
/// positive orientation.
pub(crate) type VertexGenerators = [Generator; 4];

/// A vertex while its cells are completed.
struct TileVertex {
    generators: VertexGenerators,
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
    pub(crate) vertices: Vec<VertexGenerators>,
    pub(crate) positions: Vec<DVec3>,
    /// The seed of each face, and the generator beyond: a wall or a seed of greater number.
    pub(crate) faces: Vec<[Generator; 2]>,
    /// The corners of face f are `corners[corner_starts[f]..corner_starts[f + 1]]`, counter-clockwise from outside the first cell.
    pub(crate) corner_starts: Vec<u32>,
    pub(crate) corners: Vec<u32>,
    /// Pairs of vertices that are one point.
    pub(crate) coincident: Vec<[u32; 2]>,
}

/// Completes the cells of consecutive seeds.
pub(crate) fn cut_tile(near: NearSeeds, seeds: Range<u32>) -> Tile {
    let mut builder = Builder {
        near,
        vertices: Vec::new(),
        lists: vec![END; seeds.len()],
        tile: Tile {
            seeds: seeds.clone(),
            vertices: Vec::new(),
            positions: Vec::new(),
            faces: Vec::new(),
            corner_starts: vec![0],
            corners: Vec::new(),
            coincident: Vec::new(),
        },
    };
    let mut cell = OpenCell::new(near);
    for seed in seeds {
        builder.complete(&mut cell, seed);
        builder.push_faces(&cell, seed);
    }
    builder.finish()
}

struct Builder<'a> {
    near: NearSeeds<'a>,
    vertices: Vec<TileVertex>,
    /// First entry of the list of each cell's known vertices. An entry is a vertex's number times four and the place
    /// of the cell among its generators.
    lists: Vec<u32>,
    tile: Tile,
}

impl Builder<'_> {
    fn complete(&mut self, cell: &mut OpenCell, seed: u32) {
        cell.start(seed);
        let own = self.near.input.seeds[seed as usize];
        let mut entry = self.lists[(seed - self.tile.seeds.start) as usize];
        if entry == END {
            let Some(planes) = self.first_vertex(seed) else { return };
            let vertex = cell.vertex_of(planes);
            self.push(cell, seed, &vertex);
        }
        while entry != END {
            let vertex = &self.vertices[(entry / 4) as usize];
            let [p, a, b, c] = vertex.generators;
            // The orientation of the planes as the others of the four see it.
            let (place, generators) = [(0, [p, c, b]), (1, [p, a, c]), (2, [p, b, a])][(entry % 4) as usize - 1];
            let shift = self.near.input.seeds[p.0 as usize] - own;
            let position = vertex.position + shift;
            let rounding = f64::EPSILON * (vertex.position.abs() + shift.abs()).max_element();
            let has_tie = vertex.has_tie;
            let known = NewVertex { generators, position, error: vertex.error + rounding, has_tie };
            cell.add(entry / 4, &known);
            entry = vertex.next[place];
        }
        while let Some(vertex) = cell.next_vertex() {
            self.push(cell, seed, &vertex);
        }
    }

    /// The planes of one vertex of a cell of which none is known; none if the cell is empty.
    fn first_vertex(&self, seed: u32) -> Option<[Generator; 3]> {
        fn cut(near: &NearSeeds, mut cell: impl crate::near_seeds::Cutting, seed: u32) -> Option<[Generator; 3]> {
            near.cut(&mut cell, seed);
            cell.any_vertex()
        }
        match self.near.input.domain.dimension() {
            Dimension::Three => cut(&self.near, ConvexCell::new(seed, self.near.input), seed),
            Dimension::Two => cut(&self.near, ConvexPolygon::new(seed, self.near.input), seed),
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
            generators: [Generator::seed(seed), a, b, c],
            position: vertex.position,
            error: vertex.error,
            next,
            has_tie: vertex.has_tie,
        });
    }

    /// Adds the faces of a complete cell towards greater cells and walls.
    fn push_faces(&mut self, cell: &OpenCell, seed: u32) {
        let own = Generator::seed(seed);
        let tile = &mut self.tile;
        let planes = (0u16..).zip(cell.planes());
        match self.near.input.domain.dimension() {
            Dimension::Three => {
                for (p, plane) in planes.filter(|(_, plane)| plane.generator > own) {
                    cell.for_each_edge(p, |from, _, to| {
                        tile.corners.push(from.number);
                        if cell.coincide(from, to) {
                            tile.coincident.push([from.number, to.number]);
                        }
                    });
                    tile.finish_face([own, plane.generator]);
                }
            }
            Dimension::Two => {
                for (p, _) in planes.filter(|(_, plane)| plane.generator == Generator::wall(PLANE)) {
                    cell.for_each_edge(p, |from, beyond, to| {
                        if cell.coincide(from, to) {
                            tile.coincident.push([from.number, to.number]);
                        }
                        if beyond > own {
                            tile.corners.extend([from.number, to.number]);
                            tile.finish_face([own, beyond]);
                        }
                    });
                }
            }
        }
    }

    fn finish(mut self) -> Tile {
        self.tile.vertices = self.vertices.iter().map(|vertex| vertex.generators).collect();
        let seeds = self.near.input.seeds;
        let absolute = |vertex: &TileVertex| seeds[vertex.generators[0].0 as usize] + vertex.position;
        self.tile.positions = self.vertices.iter().map(absolute).collect();
        self.tile
    }
}

impl Tile {
    /// Makes the corners since the last face a face.
    fn finish_face(&mut self, sides: [Generator; 2]) {
        self.faces.push(sides);
        self.corner_starts.push(u32::try_from(self.corners.len()).expect("a tile has fewer than 2^32 corners"));
    }
}
