//! The search for the ends of a cell's edges.
//!
//! An edge leaves a vertex along two planes, and ends at the first plane to cut it. Whatever suggests that plane, the end is
//! taken only after every seed near enough has been shown not to cut it off.

use glam::DVec3;

use crate::candidates::Candidates;
use crate::exact_plane::Decision;
use crate::generator::Generator;
use crate::half_space::{EVALUATION_ERROR, HalfSpace, Intersection};
use crate::predicate::ExactInput;
use crate::search::{ImagesMissing, Search};
use crate::{Dimension, Wall};

/// In two dimensions the plane z = 0 is a third plane through every corner, so that polygons are faces of polyhedra.
pub(crate) const PLANE: Wall = Wall::ALL[5];

/// Relative error bound above which the coordinates of a vertex are computed exactly. The bound overestimates by an order
/// of magnitude, so coordinates are good to about 1e-13 of the cell's size.
const LOOSE: f64 = 2e-12;

/// How much farther than from known vertices the search looks at first: most of the vertices that it finds are within that, and
/// another round would cost more than the additional sites.
const FORESIGHT: f64 = 1.12;

/// A vertex of a cell.
#[derive(Debug, Clone, Copy)]
pub(crate) struct NewVertex {
    /// The planes that meet there, in general position always three (ties are broken symbolically), oriented so that the
    /// determinant of their normals is positive.
    pub(crate) planes: [Generator; 3],
    /// Relative to the cell's seed.
    pub(crate) position: DVec3,
    /// Whether a further plane passes through the vertex, exactly.
    pub(crate) has_tie: bool,
}

/// The search around one seed. Reused from seed to seed so that the buffers are allocated once.
pub(crate) struct EndSearch<'a> {
    search: &'a Search<'a>,
    input: ExactInput<'a>,
    seed: u32,
    candidates: Candidates,
    /// All seeds up to this distance are candidates.
    reach: f64,
    /// Up to this distance they show whether a vertex is one of the cell.
    radius: f64,
}

impl<'a> EndSearch<'a> {
    pub(crate) fn new(search: &'a Search<'a>) -> Self {
        let (input, candidates) = (search.input(), Candidates::default());
        Self { search, input, seed: 0, candidates, reach: -1.0, radius: -1.0 }
    }

    /// Turns to another seed.
    pub(crate) fn start(&mut self, seed: u32) {
        self.seed = seed;
        (self.reach, self.radius) = (-1.0, -1.0);
    }

    /// Prepares for the ends of edges from vertices up to a distance.
    pub(crate) fn expect(&mut self, distance: f64) -> Result<(), ImagesMissing> {
        let reach = self.search.reach(self.seed, distance);
        self.gather(FORESIGHT * reach).or_else(|ImagesMissing| self.gather(reach))
    }

    /// The other end of an edge from a vertex with the planes `used` at `start`. The edge runs along two of these, which are in
    /// positive orientation with the one at the other end.
    pub(crate) fn other_end(
        &mut self,
        edge: [Generator; 2],
        used: [Generator; 3],
        start: DVec3,
    ) -> Result<NewVertex, ImagesMissing> {
        self.gather_around(start.length())?;
        let edge = self.half_spaces(edge);
        let direction = edge[0].normal.cross(edge[1].normal);
        let mut end: Option<(Generator, Intersection, f32)> = None;
        loop {
            let ray = self.candidates.ray(start, direction);
            let nearest = end.map_or(f32::INFINITY, |(.., crossing)| crossing);
            let (mut crossing, mut number) = self.candidates.first_crossing(&ray);
            while crossing < nearest {
                let generator = self.candidates.generators()[number];
                if !used.contains(&generator)
                    && let Some(at) = self.intersect(&edge, generator)
                {
                    end = Some((generator, at, crossing));
                    break;
                }
                (crossing, number) = self.candidates.next_crossing(&ray, (crossing, number));
            }
            let (generator, at, _) = *end.get_or_insert_with(|| self.any_end(&edge));
            if distance(&at) <= self.radius {
                return Ok(self.confirm(&edge, generator, at));
            }
            let wanted = self.search.reach(self.seed, distance(&at));
            if wanted <= self.reach {
                return Ok(self.confirm(&edge, generator, at));
            }
            self.gather(self.search.grow(self.reach, wanted))?;
        }
    }

    /// The vertex of three planes, which the cell is known to have.
    pub(crate) fn vertex_of(&mut self, [a, b, c]: [Generator; 3]) -> Result<NewVertex, ImagesMissing> {
        let edge = self.half_spaces([a, b]);
        let at = self.intersect(&edge, c).expect("the planes of a vertex are in positive orientation");
        self.gather_around(distance(&at))?;
        Ok(self.confirm(&edge, c, at))
    }

    #[inline]
    fn half_spaces(&self, [a, b]: [Generator; 2]) -> [HalfSpace; 2] {
        [HalfSpace::new(self.seed, a, self.input), HalfSpace::new(self.seed, b, self.input)]
    }

    /// One of the outermost planes that cuts an edge somewhere, for when rounding hides all.
    fn any_end(&self, edge: &[HalfSpace; 2]) -> (Generator, Intersection, f32) {
        let cut = |plane| self.intersect(edge, plane).map(|at| (plane, at, f32::INFINITY));
        self.input
            .outermost_planes(self.seed)
            .find_map(cut)
            .expect("a cell's outermost planes end every edge")
    }

    /// The first end of an edge, given a plane that ends it there or later: whatever cuts that end off comes first.
    fn confirm(&self, edge: &[HalfSpace; 2], mut generator: Generator, mut at: Intersection) -> NewVertex {
        let input = self.input;
        let mut has_tie = false;
        'confirm: loop {
            let planes = [edge[0].generator, edge[1].generator, generator];
            let probe = self.candidates.probe(at.position, at.error);
            // The vertex's own planes are always among those that it may lie beyond.
            if self.candidates.count_maybe_beyond(probe) > 3 {
                has_tie = false;
                for other in self.candidates.maybe_beyond(probe) {
                    if planes.contains(&other) {
                        continue;
                    }
                    let plane = HalfSpace::new(self.seed, other, input);
                    let excess = plane.normal.dot(at.position) - plane.offset;
                    let error = plane.sum() * at.evaluation_error() + EVALUATION_ERROR * plane.offset_size;
                    let decision = if excess.abs() > error {
                        Decision { beyond: excess > 0.0, tie: false }
                    } else {
                        input.decide(self.seed, planes, other)
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
            return NewVertex { planes, position: at.position, has_tie };
        }
    }

    /// Where a plane cuts an edge; none where it runs along it or faces the other way.
    fn intersect(&self, edge: &[HalfSpace; 2], generator: Generator) -> Option<Intersection> {
        let input = self.input;
        let third = HalfSpace::new(self.seed, generator, input);
        let planes = [&edge[0], &edge[1], &third];
        if let Some(at) = Intersection::rounded(planes).filter(|at| at.is_good_to(LOOSE)) {
            return Some(at);
        }
        input
            .is_positive(self.seed, planes.map(|plane| plane.generator))
            .then(|| Intersection::exact(self.seed, planes, input))
    }

    /// Makes all sites candidates that can touch or cut the part of the cell within `radius`.
    #[inline]
    fn gather_around(&mut self, radius: f64) -> Result<(), ImagesMissing> {
        if radius <= self.radius { Ok(()) } else { self.gather(self.search.reach(self.seed, radius)) }
    }

    /// Makes all sites up to a distance candidates, and walls whose mirror images of the seed are as near.
    fn gather(&mut self, reach: f64) -> Result<(), ImagesMissing> {
        if reach <= self.reach {
            return Ok(());
        }
        let (seed, input, range) = (self.seed, self.input, [self.reach, reach]);
        let candidates = &mut self.candidates;
        if self.reach < 0.0 {
            candidates.restart(reach, self.search.first_image(), self.search.position_error());
        }
        self.search.gather(candidates, seed, range)?;
        let plane = (input.domain.dimension() == Dimension::Two).then_some(PLANE);
        for wall in Wall::ALL[..2 * input.domain.axes()].iter().copied().chain(plane) {
            let doubled = 2.0 * input.outermost_distance(seed, wall);
            // Across periodic axes the seed's own images are sites like others.
            if doubled > range[0] && doubled <= range[1] && !input.domain.periodic().test(wall.axis()) {
                candidates.push(&HalfSpace::new(seed, Generator::side(wall), input));
            }
        }
        input.for_each_facet_within(seed, range, |plane, _| candidates.push(&plane));
        candidates.fill_lanes();
        self.reach = reach;
        self.radius = self.search.radius(seed, reach);
        Ok(())
    }
}

/// Bound on a vertex's distance from the seed: the error bounds each coordinate, so a distance by sqrt(3) times it.
fn distance(at: &Intersection) -> f64 {
    at.position.length() + 2.0 * at.error
}
