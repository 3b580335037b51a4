//! The search for the ends of a cell's edges.
//!
//! An edge leaves a vertex along two planes, and ends at the first plane to cut it. Whatever suggests that plane, the end is
//! taken only after every seed near enough has been shown not to cut it off.

use glam::DVec3;

use crate::candidates::Candidates;
use crate::generator::Generator;
use crate::half_space::{EVALUATION_ERROR, HalfSpace, Intersection};
use crate::predicate::Decision;
use crate::search::{ImagesMissing, Search};
use crate::wide::Ray;
use crate::{Dimension, Wall};

/// In two dimensions the plane z = 0 is a third plane through every corner, so that polygons are faces of polyhedra.
pub(crate) const PLANE: Wall = Wall::ALL[5];

/// Relative error bound above which the coordinates of a vertex are computed exactly. The bound overestimates by an order
/// of magnitude, so coordinates are good to about 1e-13 of the cell's size.
const LOOSE: f64 = 2e-12;

/// Sine of the angle between a plane and an edge below which the plane is not suggested as the edge's end: there rounding
/// decides where they meet. Planes through the edge are such.
const GRAZING: f64 = 1e-10;

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
    seed: u32,
    candidates: Candidates,
    /// All seeds up to this distance are candidates.
    reach: f64,
}

impl<'a> EndSearch<'a> {
    pub(crate) fn new(search: &'a Search<'a>) -> Self {
        Self { search, seed: 0, candidates: Candidates::default(), reach: -1.0 }
    }

    /// Turns to another seed.
    pub(crate) fn start(&mut self, seed: u32) {
        self.seed = seed;
        self.candidates.clear();
        self.reach = -1.0;
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
        self.gather(self.search.reach(self.seed, start.length()))?;
        let edge = self.half_spaces(edge);
        let direction = edge[0].normal.cross(edge[1].normal);
        let threshold = GRAZING * direction.length() * self.candidates.largest_sum;
        let ray = Ray { start, direction, threshold };

        let mut end: Option<(Generator, Intersection, f64)> = None;
        loop {
            let nearest = end.map_or(f64::INFINITY, |(.., crossing)| crossing);
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
        self.gather(self.search.reach(self.seed, distance(&at)))?;
        Ok(self.confirm(&edge, c, at))
    }

    fn half_spaces(&self, planes: [Generator; 2]) -> [HalfSpace; 2] {
        planes.map(|generator| HalfSpace::new(self.seed, generator, self.search.input()))
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

    /// The first end of an edge, given a plane that ends it there or later: whatever cuts that end off comes first.
    fn confirm(&self, edge: &[HalfSpace; 2], mut generator: Generator, mut at: Intersection) -> NewVertex {
        let input = self.search.input();
        let mut has_tie = false;
        'confirm: loop {
            let planes = [edge[0].generator, edge[1].generator, generator];
            let per_sum = at.evaluation_error();
            let slack = self.candidates.largest_sum * per_sum
                + EVALUATION_ERROR * self.candidates.largest_offset_size;
            // The vertex's own planes are always among those that it may lie beyond.
            if self.candidates.count_beyond(at.position, slack) > 3 {
                has_tie = false;
                for number in 0..self.candidates.len() {
                    let excess = self.candidates.excess(number, at.position);
                    let other = self.candidates.generators()[number];
                    if excess < -slack || planes.contains(&other) {
                        continue;
                    }
                    let plane = HalfSpace::new(self.seed, other, input);
                    let error = plane.sum() * per_sum + EVALUATION_ERROR * plane.offset_size;
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
                self.candidates.push(&HalfSpace::new(seed, generator, input));
            }
        }
        self.search.gather(&mut self.candidates, seed, [self.reach, reach])?;
        let candidates = &mut self.candidates;
        input.for_each_facet_within(seed, [self.reach, reach], |plane, _| candidates.push(&plane));
        candidates.fill_lanes();
        self.reach = reach;
        Ok(())
    }
}

/// Bound on a vertex's distance from the seed: the error bounds each coordinate, so a distance by sqrt(3) times it.
fn distance(at: &Intersection) -> f64 {
    at.position.length() + 2.0 * at.error
}
