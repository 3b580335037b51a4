//! The faces of a tile's cells, as rings of its vertices, and what they add up to.

use std::ops::Range;

use glam::DVec3;

use crate::Dimension;
use crate::build::tile::{SharedVertex, Tile};
use crate::build::tile_vertex::{FACE_SLOTS, TileVertex};
use crate::diagram::cell_sum::CellSum;
use crate::diagram::polygon::{FaceMeasure, Polygon};
use crate::exact::generator::{Generator, PLANE};
use crate::exact::half_space::HalfSpace;
use crate::sites::search::Search;

impl Tile {
    /// Empties the tile and makes room for some faces, and for their corners.
    pub(super) fn restart(&mut self, seeds: Range<u32>, [faces, corners]: [usize; 2]) {
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
    pub(super) fn push_faces_at(
        &mut self,
        search: &Search,
        vertices: &mut [TileVertex],
        number: u32,
        faces: u8,
    ) {
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
    pub(super) fn push_faces_of_others(&mut self, search: &Search, vertices: &mut [TileVertex]) {
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
        let normal = match beyond.as_site() {
            Some(site) => input.difference(own.0, site),
            None => HalfSpace::new(own.0, beyond, input).normal,
        };
        let before = self.corners.len();
        for_each_corner(vertices, first, own, beyond, |number, _, _, _| self.corners.push(number));
        // Measured afterwards: each corner tells where the next one is, and nothing else should wait for that.
        let place = |number: &u32| {
            let vertex = &vertices[*number as usize];
            vertex.position + (input.seeds[vertex.generators[0].0 as usize] - seed)
        };
        let mut corners = self.corners[before..].iter().map(place);
        let mut polygon = Polygon::from(corners.next().unwrap_or_default(), normal);
        corners.for_each(|corner| polygon.go_to(corner));
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

    pub(super) fn take_vertices(&mut self, search: &Search, vertices: &[TileVertex]) {
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
    let (cell, plane) = (vertices[at as usize].slot(own), vertices[at as usize].slot(other));
    let mut beyond = vertices[at as usize].generators[TileVertex::slot_before(cell, plane)];
    loop {
        let vertex = &mut vertices[at as usize];
        // The next edge leaves the plane that the last one ran along, beside the face, for the vertex's fourth generator.
        let before = vertex.slot(beyond);
        let next = vertex.ends[before];
        beyond = vertex.fourth([own, other, beyond]);
        vertex.mark_done_beside(before, vertex.slot(beyond));
        visit(at, vertex, beyond, next);
        if next == first {
            return;
        }
        at = next;
    }
}
