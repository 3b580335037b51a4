//! One cell, completed vertex by vertex from those that its neighbours know.
//!
//! A vertex is the triple of planes that meet there, in general position always three (ties are broken symbolically),
//! oriented so that the determinant of their normals is positive. Its three edges run along the planes taken two by two. An
//! edge that has one end so far is followed to the other: the first plane to cut it. Whatever suggests that plane, the vertex
//! is taken only after every seed near enough has been shown not to cut it off.

use glam::DVec3;

use crate::candidates::Candidates;
use crate::edge_ends::EdgeEnds;
use crate::generator::Generator;
use crate::half_space::{EVALUATION_ERROR, HalfSpace, Intersection};
use crate::predicate::Decision;
use crate::search::{ImagesMissing, Search};
use crate::{Dimension, Wall};

/// In two dimensions the plane z = 0 is a third plane through every corner, so that polygons are faces of polyhedra.
pub(crate) const PLANE: Wall = Wall::ALL[5];

/// Relative error bound above which the coordinates of a vertex are computed exactly. The bound overestimates by an order
/// of magnitude, so coordinates are good to about 1e-13 of the cell's size.
const LOOSE: f64 = 2e-12;

/// Sine of the angle between a plane and an edge below which the plane is not suggested as the edge's end: there rounding
/// decides where they meet. Planes through the edge are such.
const GRAZING: f64 = 1e-10;

/// Distance of two vertices, relative to their distance from the seed, beyond which they cannot coincide: far above
/// the 1e-12 to which coordinates are known, so that only true candidates go to exact arithmetic.
const POSSIBLY_COINCIDENT: f64 = 1e-9;

/// A vertex of the cell under way.
#[derive(Debug, Clone, Copy)]
pub(crate) struct CellVertex {
    /// The cell's planes that meet here, in positive orientation.
    planes: [u16; 3],
    /// The vertex's number in the tile.
    pub(crate) number: u32,
    /// Relative to the cell's seed.
    pub(crate) position: DVec3,
    /// Whether a further plane passes through the vertex, exactly.
    pub(crate) has_tie: bool,
}

/// A vertex that was found.
#[derive(Debug, Clone, Copy)]
pub(crate) struct NewVertex {
    pub(crate) generators: [Generator; 3],
    /// Relative to the cell's seed.
    pub(crate) position: DVec3,
    /// Bound on the error of each coordinate.
    pub(crate) error: f64,
    pub(crate) has_tie: bool,
}

/// The cell of one seed while it is being completed. Reused from seed to seed so that the buffers are allocated once.
pub(crate) struct OpenCell<'a> {
    search: &'a Search<'a>,
    seed: u32,
    planes: Vec<HalfSpace>,
    /// Those of the planes.
    generators: Vec<Generator>,
    vertices: Vec<CellVertex>,
    ends: EdgeEnds,
    /// For each plane another that shares a corner with it, coming first in the corner's order.
    first_corners: Vec<u16>,
    /// Directed edges that may lack their other end, with the vertex that they leave.
    open: Vec<([u16; 2], u16)>,
    candidates: Candidates,
    /// All seeds up to this distance are candidates.
    reach: f64,
    /// Largest distance of a vertex from the seed.
    radius: f64,
}

impl<'a> OpenCell<'a> {
    pub(crate) fn new(search: &'a Search<'a>) -> Self {
        Self {
            search,
            seed: 0,
            planes: Vec::new(),
            generators: Vec::new(),
            vertices: Vec::new(),
            ends: EdgeEnds::default(),
            first_corners: Vec::new(),
            open: Vec::new(),
            candidates: Candidates::default(),
            reach: 0.0,
            radius: 0.0,
        }
    }

    /// Starts anew without a vertex.
    pub(crate) fn start(&mut self, seed: u32) {
        self.seed = seed;
        self.planes.clear();
        self.generators.clear();
        self.vertices.clear();
        self.ends.clear();
        self.first_corners.clear();
        self.open.clear();
        self.candidates.clear();
        self.reach = -1.0;
        self.radius = 0.0;
    }

    pub(crate) fn planes(&self) -> &[HalfSpace] {
        &self.planes
    }

    /// Adds a vertex.
    pub(crate) fn add(&mut self, number: u32, vertex: &NewVertex) {
        self.radius = self.radius.max(distance(vertex.position, vertex.error));
        let [a, b, c] = vertex.generators;
        let planes = [self.plane(a), self.plane(b), self.plane(c)];
        let place = u16::try_from(self.vertices.len()).expect("a cell has fewer than 65 536 vertices");
        self.vertices.push(CellVertex { planes, number, position: vertex.position, has_tie: vertex.has_tie });
        let [a, b, c] = planes;
        // A new plane comes with its first corner.
        for (p, incoming) in [(a, b), (b, c), (c, a)] {
            if usize::from(p) >= self.first_corners.len() {
                self.first_corners.resize(usize::from(p) + 1, incoming);
            }
        }
        for (from, to, across) in [(a, b, c), (b, c, a), (c, a, b)] {
            self.ends.insert([from, to], place, across);
            if self.ends.get([to, from]).is_none() {
                self.open.push(([from, to], place));
            }
        }
    }

    /// The number of a plane among the cell's.
    #[inline]
    fn plane(&mut self, generator: Generator) -> u16 {
        let known = self.generators.iter().position(|known| *known == generator);
        let number = known.unwrap_or_else(|| {
            self.generators.push(generator);
            self.planes.push(HalfSpace::new(self.seed, generator, self.search.input()));
            self.planes.len() - 1
        });
        u16::try_from(number).expect("a cell has fewer than 65 536 faces")
    }

    /// Follows an edge without a second end to that end; none when the cell is complete.
    pub(crate) fn next_vertex(&mut self) -> Result<Option<NewVertex>, ImagesMissing> {
        while let Some((edge, vertex)) = self.open.pop() {
            if self.is_wanted(edge) {
                return self.other_end(edge, vertex).map(Some);
            }
        }
        Ok(None)
    }

    /// Whether an edge lacks its other end. In the plane only the edges in it count.
    fn is_wanted(&self, [from, to]: [u16; 2]) -> bool {
        let in_plane = |p: u16| self.generators[usize::from(p)] == Generator::side(PLANE);
        let counts = match self.search.input().domain.dimension() {
            Dimension::Three => true,
            Dimension::Two => in_plane(from) || in_plane(to),
        };
        counts && self.ends.get([to, from]).is_none()
    }

    /// The other end of an edge from a vertex.
    fn other_end(&mut self, [from, to]: [u16; 2], vertex: u16) -> Result<NewVertex, ImagesMissing> {
        self.gather(self.search.reach(self.seed, self.radius))?;
        let CellVertex { planes, position: start, .. } = self.vertices[usize::from(vertex)];
        // Seen from the other end the edge's planes change places.
        let edge = [self.planes[usize::from(to)], self.planes[usize::from(from)]];
        let direction = edge[0].normal.cross(edge[1].normal);
        let used = planes.map(|p| self.generators[usize::from(p)]);
        let threshold = GRAZING * direction.length() * self.candidates.largest_sum;

        let mut first = 0;
        let mut end: Option<(Generator, Intersection, f64)> = None;
        loop {
            self.candidates.cross(first, start, direction, threshold);
            let nearest = end.map_or(f64::INFINITY, |(.., crossing)| crossing);
            loop {
                let (number, crossing) = self.candidates.first_crossing();
                if crossing >= nearest {
                    break;
                }
                let generator = self.candidates.generators()[first + number];
                if !used.contains(&generator)
                    && let Some(at) = self.intersect(&edge, generator)
                {
                    end = Some((generator, at, crossing));
                    break;
                }
                self.candidates.forget_crossing(number);
            }
            let (generator, at, _) = *end.get_or_insert_with(|| self.any_end(&edge));
            first = self.candidates.len();
            let wanted = self.search.reach(self.seed, distance(at.position, at.error));
            if wanted <= self.reach {
                return Ok(self.confirm(&edge, generator, at));
            }
            self.gather(self.search.grow(self.reach, wanted))?;
        }
    }

    /// One of the outermost planes that cuts an edge somewhere, for when rounding hides all.
    fn any_end(&self, edge: &[HalfSpace; 2]) -> (Generator, Intersection, f64) {
        let cut = |plane| self.intersect(edge, plane).map(|at| (plane, at, f64::INFINITY));
        self.search
            .input()
            .outermost_planes(self.seed)
            .find_map(cut)
            .expect("a cell's outermost planes end every edge")
    }

    /// The vertex of three planes, which the cell is known to have.
    pub(crate) fn vertex_of(&mut self, [a, b, c]: [Generator; 3]) -> Result<NewVertex, ImagesMissing> {
        let edge = [a, b].map(|generator| HalfSpace::new(self.seed, generator, self.search.input()));
        let at = self.intersect(&edge, c).expect("the planes of a vertex are in positive orientation");
        self.gather(self.search.reach(self.seed, distance(at.position, at.error)))?;
        Ok(self.confirm(&edge, c, at))
    }

    /// The first end of an edge, given a plane that ends it there or later: whatever cuts that end off comes first.
    fn confirm(&self, edge: &[HalfSpace; 2], mut generator: Generator, mut at: Intersection) -> NewVertex {
        let input = self.search.input();
        let mut has_tie = false;
        'confirm: loop {
            let generators = [edge[0].generator, edge[1].generator, generator];
            let per_sum = at.evaluation_error();
            let slack = self.candidates.largest_sum * per_sum
                + EVALUATION_ERROR * self.candidates.largest_offset_size;
            // The vertex's own planes are always among those that it may lie beyond.
            if self.candidates.count_beyond(at.position, slack) > 3 {
                has_tie = false;
                for number in 0..self.candidates.len() {
                    let excess = self.candidates.excess(number, at.position);
                    let other = self.candidates.generators()[number];
                    if excess < -slack || generators.contains(&other) {
                        continue;
                    }
                    let plane = HalfSpace::new(self.seed, other, input);
                    let error = plane.sum() * per_sum + EVALUATION_ERROR * plane.offset_size;
                    let decision = if excess.abs() > error {
                        Decision { beyond: excess > 0.0, tie: false }
                    } else {
                        input.decide(self.seed, generators, other)
                    };
                    has_tie |= decision.tie;
                    if decision.beyond {
                        generator = other;
                        at = self
                            .intersect(edge, other)
                            .expect("a plane that cuts a vertex off ends the edge");
                        continue 'confirm;
                    }
                }
            }
            return NewVertex { generators, position: at.position, error: at.error, has_tie };
        }
    }

    /// Where a plane cuts an edge; none where it runs along it or faces the other way.
    fn intersect(&self, edge: &[HalfSpace; 2], generator: Generator) -> Option<Intersection> {
        let input = self.search.input();
        let third = HalfSpace::new(self.seed, generator, input);
        let planes = [&edge[0], &edge[1], &third];
        if let Some(at) = Intersection::rounded(planes).filter(|at| at.is_good_to(LOOSE)) {
            return Some(at);
        }
        input
            .is_positive(self.seed, planes.map(|plane| plane.generator))
            .then(|| Intersection::exact(self.seed, planes, input))
    }

    /// Makes all sites up to a distance candidates, and before them the outermost planes.
    fn gather(&mut self, reach: f64) -> Result<(), ImagesMissing> {
        if reach <= self.reach {
            return Ok(());
        }
        let (seed, input) = (self.seed, self.search.input());
        if self.candidates.len() == 0 {
            let plane = (input.domain.dimension() == Dimension::Two).then_some(Generator::side(PLANE));
            for generator in input.outermost_planes(seed).chain(plane) {
                self.candidates.push_plane(&HalfSpace::new(seed, generator, input));
            }
        }
        let own_weight = input.weight(seed);
        let candidates = &mut self.candidates;
        input.for_each_facet_within(seed, [self.reach, reach], |plane, _| candidates.push_plane(&plane));
        self.search.for_each_within(seed, [self.reach, reach], |site, normal, squared| {
            let weight = input.weight(site);
            let offset = 0.5 * (squared + (own_weight - weight));
            let offset_size = 0.5 * (squared + own_weight.abs() + weight.abs());
            candidates.push(Generator::site(site), normal, offset, offset_size);
        })?;
        self.reach = reach;
        Ok(())
    }

    /// Visits the edges of the face on a plane in counter-clockwise order as seen from outside: the vertex where each starts,
    /// what lies beyond it, and the vertex where it ends.
    pub(crate) fn for_each_edge(
        &self,
        plane: u16,
        mut visit: impl FnMut(&CellVertex, Generator, &CellVertex),
    ) {
        let end = |incoming| self.ends.get([plane, incoming]).expect("a complete cell's faces are closed");
        let first = end(self.first_corners[usize::from(plane)]);
        let mut from = first;
        loop {
            let to = end(from.across);
            let beyond = self.generators[usize::from(from.across)];
            visit(&self.vertices[usize::from(from.vertex)], beyond, &self.vertices[usize::from(to.vertex)]);
            if to.vertex == first.vertex {
                return;
            }
            from = to;
        }
    }

    /// Whether two vertices joined by an edge are one point, exactly: then the plane that they do not share passes through both.
    pub(crate) fn coincide(&self, v: &CellVertex, w: &CellVertex) -> bool {
        if !(v.has_tie && w.has_tie)
            || v.position.distance(w.position) > POSSIBLY_COINCIDENT * v.position.length()
        {
            return false;
        }
        let generators = |vertex: &CellVertex| vertex.planes.map(|p| self.generators[usize::from(p)]);
        let other = generators(w).into_iter().find(|generator| !generators(v).contains(generator));
        other.is_some_and(|generator| self.search.input().decide(self.seed, generators(v), generator).tie)
    }
}

/// Bound on a vertex's distance from the seed: the error bounds each coordinate, so a distance by sqrt(3) times it.
fn distance(position: DVec3, error: f64) -> f64 {
    position.length() + 2.0 * error
}
