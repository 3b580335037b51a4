//! The search for the ends of a cell's edges.
//!
//! An edge leaves a vertex along two planes, and ends at the first plane to cut it. Whatever suggests that plane, the end is
//! taken only after every seed near enough has been shown not to cut it off.

use std::collections::HashSet;

use foldhash::fast::FixedState;
use glam::DVec3;

use crate::Wall;
use crate::exact::generator::{Generator, PLANE};
use crate::exact::half_space::{EVALUATION_ERROR, HalfSpace, Intersection};
use crate::exact::input::ExactInput;
use crate::exact::plane::Decision;
use crate::sites::candidates::Candidates;
use crate::sites::search::{ImagesMissing, Search};
use crate::sites::site_tree::InBox;

/// Relative error bound above which the coordinates of a vertex are computed exactly. The bound overestimates by an order
/// of magnitude, so coordinates are good to about 1e-13 of the cell's size.
const LOOSE: f64 = 2e-12;

/// The same for vertices that only stand in for others on the way to the end of an edge.
const LOOSE_ON_THE_WAY: f64 = 1e-9;

/// How much farther than from known vertices the search looks at first: most of the vertices that it finds are within that, and
/// another round would cost more than the additional sites.
const FORESIGHT: f64 = 1.12;

/// Sites that are looked at to collect those around a cell, at most. For what is farther away, the boxes are asked about every single
/// vertex.
const MOST_CANDIDATES: usize = 500;

/// Growth of the radius from one round of the search around a cell to the next: twice the volume.
const GROWTH: f64 = 1.26;

/// Share of a radius that candidates are known to, below which all are gathered anew: single precision counts in units near the first. So much
/// of the distance of an edge's end is looked at in any case.
const LEAST_SHARE: f64 = 1e-3;

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
pub(crate) struct EdgeTracing<'a> {
    search: &'a Search<'a>,
    input: ExactInput<'a>,
    seed: u32,
    candidates: Candidates,
    /// All planes up to this distance are candidates.
    radius: f64,
    /// Whether candidates would be too many farther away.
    is_crowded: bool,
    /// What was made a candidate beyond these.
    suggested: HashSet<Generator, FixedState>,
    /// Planes that may cut off the vertex under way.
    maybe: Vec<Generator>,
}

impl<'a> EdgeTracing<'a> {
    pub(crate) fn new(search: &'a Search<'a>) -> Self {
        Self {
            search,
            input: search.input(),
            seed: 0,
            candidates: Candidates::default(),
            radius: -1.0,
            is_crowded: false,
            suggested: HashSet::default(),
            maybe: Vec::new(),
        }
    }

    /// Turns to another seed.
    pub(crate) fn start(&mut self, seed: u32) {
        self.seed = seed;
        self.radius = -1.0;
        self.is_crowded = false;
        self.suggested.clear();
    }

    /// Prepares for the ends of edges from vertices up to a distance.
    pub(crate) fn expect(&mut self, distance: f64) -> Result<(), ImagesMissing> {
        self.gather(FORESIGHT * distance).or_else(|ImagesMissing| self.gather(distance))
    }

    /// Takes planes for candidates, near or far, where there are too many candidates to know all.
    pub(crate) fn suggest(&mut self, planes: impl IntoIterator<Item = Generator>) {
        if !self.is_crowded {
            return;
        }
        if self.suggested.len() > MOST_CANDIDATES {
            // Where a cell has so many neighbours, the last ones are those near the edges that follow.
            self.suggested.clear();
            self.candidates.clear();
            self.radius = -1.0;
        }
        for plane in planes {
            if self.suggested.insert(plane) {
                self.candidates.push(&HalfSpace::new(self.seed, plane, self.input));
            }
        }
        self.candidates.fill_lanes();
    }

    /// The other end of an edge from a vertex at `start`, where a third plane cuts it. The edge runs along two planes, which are in
    /// positive orientation with the one at the other end.
    pub(crate) fn other_end(
        &mut self,
        planes: [Generator; 2],
        third: Generator,
        start: DVec3,
    ) -> Result<NewVertex, ImagesMissing> {
        self.gather(start.length())?;
        let used = [planes[0], planes[1], third];
        let edge = self.half_spaces(planes);
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
            let distance = at.distance();
            if distance <= self.radius || self.is_crowded {
                return self.confirm(&edge, generator, at);
            }
            self.gather(distance.min((GROWTH * self.radius).max(LEAST_SHARE * distance)))?;
        }
    }

    /// The vertex of three planes, which the cell is known to have.
    pub(crate) fn vertex_of(&mut self, [a, b, c]: [Generator; 3]) -> Result<NewVertex, ImagesMissing> {
        let edge = self.half_spaces([a, b]);
        let at = self.intersect(&edge, c).expect("the planes of a vertex are in positive orientation");
        self.gather(at.distance())?;
        self.confirm(&edge, c, at)
    }

    /// A plane that cuts off the vertex of some planes in positive orientation, if there is one.
    pub(crate) fn cutter(&mut self, [a, b, c]: [Generator; 3]) -> Result<Option<Generator>, ImagesMissing> {
        let edge = self.half_spaces([a, b]);
        let at = self.intersect(&edge, c).expect("the planes of a vertex are in positive orientation");
        Ok(self.find_cutter([a, b, c], &at)?.0)
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
    fn confirm(
        &mut self,
        edge: &[HalfSpace; 2],
        mut generator: Generator,
        mut at: Intersection,
    ) -> Result<NewVertex, ImagesMissing> {
        loop {
            let planes = [edge[0].generator, edge[1].generator, generator];
            let (cutter, has_tie) = self.find_cutter(planes, &at)?;
            let Some(cutter) = cutter else {
                if !at.is_good_to(LOOSE) {
                    at = self.exact(edge, generator);
                }
                return Ok(NewVertex { planes, position: at.position, has_tie });
            };
            self.suggest([cutter]);
            generator = cutter;
            at = self.intersect(edge, cutter).expect("a plane that cuts a vertex off ends the edge");
        }
    }

    /// A plane that cuts off the vertex of some planes in positive orientation, if there is one, and else whether a further plane passes
    /// through that, exactly.
    fn find_cutter(
        &mut self,
        planes: [Generator; 3],
        at: &Intersection,
    ) -> Result<(Option<Generator>, bool), ImagesMissing> {
        let (mut has_tie, mut farthest) = (false, f64::NEG_INFINITY);
        self.maybe.clear();
        let mut cutter = self.find_maybe_beyond(planes, at)?;
        for other in self.maybe.iter().filter(|other| !planes.contains(other)) {
            let plane = HalfSpace::new(self.seed, *other, self.input);
            let excess = plane.normal.dot(at.position) - plane.offset;
            let error = plane.sum() * at.evaluation_error() + EVALUATION_ERROR * plane.offset_size;
            let decision = if excess.abs() > error {
                Decision { beyond: excess > 0.0, tie: false }
            } else {
                self.input.decide(self.seed, planes, *other)
            };
            has_tie |= decision.tie;
            if decision.beyond && excess > farthest {
                (cutter, farthest) = (Some(*other), excess);
            }
        }
        Ok((cutter, has_tie))
    }

    /// Lists planes among which are all that may cut off the vertex of some planes, unless one certainly does: then that is returned.
    #[inline]
    fn find_maybe_beyond(
        &mut self,
        planes: [Generator; 3],
        at: &Intersection,
    ) -> Result<Option<Generator>, ImagesMissing> {
        let (seed, input) = (self.seed, self.input);
        if at.distance() <= self.radius {
            let probe = self.candidates.probe(at.position, at.error);
            // The vertex's own planes are always among those that it may lie beyond.
            if self.candidates.count_maybe_beyond(probe) > 3 {
                self.maybe.extend(self.candidates.maybe_beyond(probe));
            }
            return Ok(None);
        }
        if let Some(InBox { site, sites }) = self.search.farthest_cut(seed, planes, at, &mut self.maybe)? {
            // What is near that is likely to be near the end of this edge and of others.
            let others = sites.iter().filter(|other| **other != seed).map(|other| Generator::site(*other));
            self.suggest(others);
            return Ok(Some(site));
        }
        let place = input.seeds[seed as usize] + at.position;
        let maybe = &mut self.maybe;
        self.search
            .domain()
            .for_each_wall_within(place, 2.0 * at.error, |wall| maybe.push(Generator::facet(wall)));
        maybe.extend(sides(input).map(Generator::side));
        Ok(None)
    }

    /// Where a plane cuts an edge; none where it runs along it or faces the other way.
    fn intersect(&self, edge: &[HalfSpace; 2], generator: Generator) -> Option<Intersection> {
        let third = HalfSpace::new(self.seed, generator, self.input);
        let planes = [&edge[0], &edge[1], &third];
        if let Some(at) = Intersection::rounded(planes).filter(|at| at.is_good_to(LOOSE_ON_THE_WAY)) {
            return Some(at);
        }
        let is_positive = self.input.is_positive(self.seed, planes.map(|plane| plane.generator));
        is_positive.then(|| self.exact(edge, generator))
    }

    fn exact(&self, edge: &[HalfSpace; 2], generator: Generator) -> Intersection {
        let third = HalfSpace::new(self.seed, generator, self.input);
        Intersection::exact(self.seed, [&edge[0], &edge[1], &third], self.input)
    }

    /// Makes all planes up to a distance candidates, unless too many sites would have to be looked at.
    #[inline]
    fn gather(&mut self, radius: f64) -> Result<(), ImagesMissing> {
        if radius <= self.radius || self.is_crowded { Ok(()) } else { self.gather_sites(radius) }
    }

    fn gather_sites(&mut self, radius: f64) -> Result<(), ImagesMissing> {
        let (seed, search) = (self.seed, self.search);
        let from = (self.radius > LEAST_SHARE * radius).then_some(self.radius);
        if from.is_none() {
            let security_radius = search.security_radius(seed, radius);
            self.radius = -1.0;
            self.candidates.restart(security_radius, search.first_image(), search.position_error());
        }
        if !search.gather(&mut self.candidates, seed, from, radius, MOST_CANDIDATES)? {
            self.is_crowded = true;
            self.suggest(sides(self.input).map(Generator::side));
            return Ok(());
        }
        let (input, candidates) = (self.input, &mut self.candidates);
        let is_new = |distance: f64| from.is_none_or(|from| distance > from);
        for side in sides(input) {
            let distance = input.outermost_distance(seed, side);
            if is_new(distance) && distance <= radius {
                candidates.push(&HalfSpace::new(seed, Generator::side(side), input));
            }
        }
        search.domain().for_each_facet_within(input.seeds[seed as usize], radius, |plane, distance| {
            if is_new(distance) {
                candidates.push(&plane);
            }
        });
        candidates.fill_lanes();
        self.radius = radius;
        Ok(())
    }
}

/// The sides of the box that bound cells, with the plane of what is flat; across periodic axes a seed's own images are sites like
/// others.
fn sides(input: ExactInput<'_>) -> impl Iterator<Item = Wall> {
    let plane = (input.frame.axes == 2).then_some(PLANE);
    let walls = Wall::ALL[..2 * input.frame.axes].iter().copied();
    walls.chain(plane).filter(move |wall| !input.frame.periodic.test(wall.axis()))
}
