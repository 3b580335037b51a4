//! Which grains come together and which part.

use std::collections::{HashMap, HashSet};
use std::sync::atomic::{AtomicUsize, Ordering};

use cancellation::check_cancelled;
use glam::DVec3;
use rayon::prelude::*;
use smallvec::SmallVec;
use voronoi::{CellId, FaceId, Side};

use crate::energy::local_size::LocalSize;
use crate::energy::shape::distinct;
use crate::energy::sides::cell_and_offset;
use crate::events::event::Event;
use crate::events::local_area::{Conditions, Excess, LocalArea};
use crate::{CellComplex, ComplexEdge};

/// Length, in units of the feature size, below which triple lines may go; in equilibrium few are that short.
pub(crate) const SHORT: f64 = 0.12;

/// Length, in units of a short line, that what goes counts with at least: it may have shrunk to nothing.
const LEAST_GOING: f64 = 0.5;

/// Length, in units of a short line, below which lines that stay are put where they have the least area: too short for a step of the flow.
const TINY: f64 = 0.3;

/// Height, in the same unit, below which boundaries with three sides may go, however long these are: one with bent sides is a good
/// deal thinner than its corners have it.
const THIN: f64 = 2.0;

/// Length, in the same unit, that an event must leave to all lines.
const LEAST: f64 = 0.1;

/// Share of a cell's volume that all events between two steps of the flow may take or give: what is lost at once, no step brings back.
/// With 0.2 a small grain may be unable to leave a wall.
const LARGEST_CHANGE: f64 = 0.3;

/// How often lines between the same grains may go without lessening the area: what comes back is to stay.
const MOST_TRIES: u8 = 3;

/// Cells to a place that is looked at ahead, together with others: so few share a cell with one where something happens that looking
/// again costs little.
const CELLS_PER_PLACE: usize = 200;

/// Places that are worth looking at together.
const FEWEST_TOGETHER: usize = 8;

/// How often the topology changed. In the plane, a boundary is an edge and a triple line is a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Reconnections {
    /// Edge-to-triangle (2-3) flips: a triple line became a boundary with three sides, and two grains came to meet. In the plane,
    /// points of more than three edges that split in two, with an edge between them.
    pub lines_to_boundaries: usize,
    /// Triangle-to-edge (3-2) flips, the reverse: two grains parted. In the plane, edges that collapsed to such points.
    pub boundaries_to_lines: usize,
    /// Neighbour switches: a boundary with four sides gave way to one between the grains at two of its opposite sides. In the
    /// plane, an edge gave way to one between the grains at its ends (T1).
    pub neighbor_switches: usize,
}

impl Reconnections {
    /// All events.
    pub fn count(self) -> usize {
        self.lines_to_boundaries + self.boundaries_to_lines + self.neighbor_switches
    }

    pub(crate) fn add(&mut self, other: Self) {
        self.lines_to_boundaries += other.lines_to_boundaries;
        self.boundaries_to_lines += other.boundaries_to_lines;
        self.neighbor_switches += other.neighbor_switches;
    }
}

/// A place where something may happen.
#[derive(Debug, Clone, Copy)]
enum Place {
    /// A boundary with three sides.
    Triangle(FaceId),
    Line(ComplexEdge),
}

/// What is to happen at a place.
struct Decision {
    event: Event,
    /// Length that what goes counts with at least.
    least: f64,
    /// Where the vertices are to be that the event gives.
    points: Vec<DVec3>,
    /// The excess of cells after that.
    excess: Vec<(CellId, f64)>,
    done: Reconnections,
    /// The sides at a line that goes without lessening the area.
    insisting: Option<Vec<Side>>,
}

impl Decision {
    fn carry_out(&self, complex: &mut CellComplex) {
        let vertices = self.event.happen(complex, self.least).expect("what was possible still is");
        for (vertex, point) in vertices.into_iter().zip(&self.points) {
            complex.vertices[vertex as usize] = *point;
        }
    }
}

/// What a place is looked at with: how all is after a step.
#[derive(Clone, Copy)]
struct Surroundings<'a> {
    conditions: &'a Conditions<'a>,
    /// Where vertices were a while ago.
    before: &'a [DVec3],
}

/// What an event has to be good for.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Demand {
    LessArea,
    /// Less area, and longer lines.
    LongerLines,
    /// That it does not fold anything.
    NoFold,
}

/// Looks for events.
pub(crate) struct Reconnector {
    /// Length below which lines are short where no grain is small.
    short: f64,
    /// The size of small grains: around them lines are short only if they are as much shorter.
    size: LocalSize,
    /// Of lines, by all sides that touch them, how often they went without lessening the area.
    tries: HashMap<Vec<Side>, u8>,
    copies: Copies,
}

/// Complexes of the threads' own, which follow what is carried out.
#[derive(Default)]
struct Copies {
    /// Each with how much of the following it knows.
    complexes: Vec<(CellComplex, usize)>,
    carried_out: Vec<Decision>,
}

impl Copies {
    /// Makes all copies as the complex is, for so many threads.
    fn catch_up(&mut self, complex: &CellComplex, threads: usize) {
        if self.complexes.len() != threads {
            self.complexes = (0..threads).into_par_iter().map(|_| (complex.clone(), 0)).collect();
        } else {
            let carried_out = &self.carried_out;
            self.complexes.par_iter_mut().for_each(|(copy, known)| {
                follow(copy, known, carried_out);
                *known = 0;
                copy.vertices.copy_from_slice(&complex.vertices);
            });
        }
        self.carried_out.clear();
    }
}

/// Carries out what a copy does not know of yet.
fn follow(copy: &mut CellComplex, known: &mut usize, carried_out: &[Decision]) {
    carried_out[*known..].iter().for_each(|decision| decision.carry_out(copy));
    *known = carried_out.len();
}

impl Reconnector {
    pub(crate) fn new(short: f64, size: LocalSize) -> Self {
        Self { short, size, tries: HashMap::new(), copies: Copies::default() }
    }

    /// Goes on with other lengths, as of [`Self::new`].
    pub(crate) fn measure_by(&mut self, short: f64, size: LocalSize) {
        (self.short, self.size) = (short, size);
    }

    /// Length below which lines are short at some vertices.
    fn short_at(&self, complex: &CellComplex, vertices: &[u32], conditions: &Conditions<'_>) -> f64 {
        self.short * self.size.at_vertices(complex, vertices, conditions.volumes)
    }

    /// Lets all events happen that are due where lines are short, or boundaries with three sides thin; `before` is where vertices were a
    /// while ago, `excess` is kept up to date.
    pub(crate) fn pass(
        &mut self,
        complex: &mut CellComplex,
        conditions: &Conditions<'_>,
        before: &[DVec3],
        excess: &mut Excess,
    ) -> Reconnections {
        let around = Surroundings { conditions, before };
        let triangles: Vec<Place> = complex.faces_with_corners(3).into_iter().map(Place::Triangle).collect();
        let mut done = self.pass_places(&triangles, complex, around, excess);
        let lines: Vec<Place> = self.short_lines(complex, conditions).into_iter().map(Place::Line).collect();
        done.add(self.pass_places(&lines, complex, around, excess));
        done
    }

    /// As one place after the other. Other threads look at places ahead, each at a complex of its own; where cells have changed since, what
    /// they found is stale.
    fn pass_places(
        &mut self,
        places: &[Place],
        complex: &mut CellComplex,
        around: Surroundings<'_>,
        excess: &mut Excess,
    ) -> Reconnections {
        let mut done = Reconnections::default();
        let together = around.conditions.volumes.len() / CELLS_PER_PLACE;
        let threads = rayon::current_num_threads();
        if threads == 1 || together < FEWEST_TOGETHER {
            for place in places {
                check_cancelled();
                if let Some(decision) = self.decide(*place, complex, around, excess) {
                    done.add(self.carry_out(&decision, complex, excess));
                }
            }
            return done;
        }
        let mut copies = std::mem::take(&mut self.copies);
        copies.catch_up(complex, threads);
        for places in places.chunks(together) {
            // Some places take far longer than others: who is done takes the next.
            let next = AtomicUsize::new(0);
            let look_ahead = |(copy, known): &mut (CellComplex, usize)| {
                follow(copy, known, &copies.carried_out);
                let take =
                    || Some(next.fetch_add(1, Ordering::Relaxed)).filter(|taken| *taken < places.len());
                let look = |taken: usize| {
                    check_cancelled();
                    let cells = places[taken].cells(copy);
                    (taken, cells, self.decide(places[taken], copy, around, excess))
                };
                std::iter::from_fn(take).map(look).collect::<Vec<_>>()
            };
            let mut ahead: Vec<_> = copies.complexes.par_iter_mut().flat_map_iter(look_ahead).collect();
            ahead.sort_unstable_by_key(|(taken, ..)| *taken);
            let mut changed: HashSet<CellId> = HashSet::new();
            for (place, (_, mut cells, mut decision)) in places.iter().zip(ahead) {
                if cells.iter().any(|cell| changed.contains(cell)) {
                    cells = place.cells(complex);
                    decision = self.decide(*place, complex, around, excess);
                }
                if let Some(decision) = decision {
                    done.add(self.carry_out(&decision, complex, excess));
                    changed.extend(cells);
                    copies.carried_out.push(decision);
                }
            }
        }
        self.copies = copies;
        done
    }

    fn carry_out(
        &mut self,
        decision: &Decision,
        complex: &mut CellComplex,
        excess: &mut Excess,
    ) -> Reconnections {
        decision.carry_out(complex);
        decision.excess.iter().for_each(|(cell, by)| excess[cell.index()] = *by);
        if let Some(sides) = &decision.insisting {
            *self.tries.entry(sides.clone()).or_default() += 1;
        }
        decision.done
    }

    /// Whether a boundary with three sides is thin.
    fn is_thin(&self, face: FaceId, complex: &CellComplex, conditions: &Conditions<'_>) -> bool {
        let height = least_height(complex, face);
        let short = || self.short_at(complex, &Event::TriangleToEdge(face).vertices(complex), conditions);
        height < THIN * self.short && height < THIN * short()
    }

    /// The short lines, shortest first.
    fn short_lines(&self, complex: &CellComplex, conditions: &Conditions<'_>) -> Vec<ComplexEdge> {
        let edges = complex.faces().into_par_iter().flat_map_iter(|face| complex.edges_of(face));
        let lengths = edges.map(|edge| (length(complex, edge), edge));
        let mut short: Vec<(f64, ComplexEdge)> = lengths.filter(|(length, _)| *length < self.short).collect();
        short.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        // Each face of a line has it.
        short.dedup();
        short.retain(|(length, edge)| *length < self.short_at(complex, &edge.vertices(), conditions));
        short.into_iter().map(|(_, edge)| edge).collect()
    }

    /// What is to happen at a place, if anything. The complex is as it was, but for the time that this takes.
    fn decide(
        &self,
        place: Place,
        complex: &mut CellComplex,
        around: Surroundings<'_>,
        excess: &Excess,
    ) -> Option<Decision> {
        match place {
            Place::Triangle(face) => {
                let is_due =
                    complex.corners(face).len() == 3 && self.is_thin(face, complex, around.conditions);
                let close =
                    || self.consider(Event::TriangleToEdge(face), complex, around, Demand::LessArea, excess);
                is_due.then(close).flatten()
            }
            Place::Line(edge) if complex.has_edge(edge) => {
                self.decide_about_line(edge, complex, around, excess)
            }
            Place::Line(_) => None,
        }
    }

    fn decide_about_line(
        &self,
        edge: ComplexEdge,
        complex: &mut CellComplex,
        around: Surroundings<'_>,
        excess: &Excess,
    ) -> Option<Decision> {
        let faces = complex.faces_of_edge(edge);
        let with_corners = |count: usize| -> Vec<FaceId> {
            faces.iter().copied().filter(|face| complex.corners(*face).len() == count).collect()
        };
        let mut events = vec![Event::EdgeToTriangle(edge)];
        events.extend(with_corners(3).into_iter().map(Event::TriangleToEdge));
        let count = events.len();
        events.extend(with_corners(4).into_iter().map(|face| Event::NeighborSwitch(edge, face)));
        for event in &events {
            let decision = self.consider(*event, complex, around, Demand::LessArea, excess);
            if decision.is_some() {
                return decision;
            }
        }
        let now = length(complex, edge);
        let short = self.short_at(complex, &edge.vertices(), around.conditions);
        let is_shrinking = length_before(complex, edge, around.before).is_some_and(|before| now < before);
        if now < short && is_shrinking {
            let sides = sides_at(complex, edge);
            let tries = self.tries.get(&sides).copied().unwrap_or(0);
            for event in events[..count].iter().filter(|_| tries < MOST_TRIES) {
                if let Some(decision) = self.consider(*event, complex, around, Demand::NoFold, excess) {
                    return Some(Decision { insisting: Some(sides), ..decision });
                }
            }
        }
        let is_tiny = now < TINY * short;
        let settle = || self.consider(Event::Move(edge), complex, around, Demand::LongerLines, excess);
        is_tiny.then(settle).flatten()
    }

    /// What comes of an event that keeps its promise.
    fn consider(
        &self,
        event: Event,
        complex: &mut CellComplex,
        around: Surroundings<'_>,
        demand: Demand,
        excess: &Excess,
    ) -> Option<Decision> {
        let conditions = around.conditions;
        let old = event.vertices(complex);
        let short = self.short_at(complex, &old, conditions);
        let least = LEAST_GOING * short;
        let snapshot = complex.snapshot(&old);
        let mut as_it_is = LocalArea::new(complex, &old, conditions, excess);
        let changed = event.happen(complex, least).and_then(|new| {
            let mut changed = LocalArea::new(complex, &new, conditions, excess).with_volumes_of(&as_it_is);
            let (area, shortest) = match demand {
                Demand::LessArea => (changed.minimize(f64::NEG_INFINITY), LEAST * short),
                Demand::LongerLines => (changed.minimize(f64::NEG_INFINITY), as_it_is.shortest_edge()),
                Demand::NoFold => (0.0, LEAST * short),
            };
            let must_be_less = demand == Demand::LessArea;
            // What takes longest comes last: most events fail before.
            let keeps_promise = area.is_finite()
                && (!must_be_less || area < as_it_is.area_now())
                && changed.shortest_edge() > shortest
                && changed.keeps_volumes(LARGEST_CHANGE, &as_it_is)
                && changed.fold_count() <= as_it_is.fold_count()
                && (!must_be_less || area < as_it_is.minimize(area));
            keeps_promise.then_some(changed)
        });
        complex.restore(snapshot);
        let changed = changed?;
        let excess = changed.excesses().map(|(cell, by, _)| (cell, by)).collect();
        let points = changed.points().to_vec();
        Some(Decision { event, least, points, excess, done: Reconnections::of(event), insisting: None })
    }
}

impl Reconnections {
    fn of(event: Event) -> Self {
        let none = Self::default();
        match event {
            Event::EdgeToTriangle(_) => Self { lines_to_boundaries: 1, ..none },
            Event::TriangleToEdge(_) => Self { boundaries_to_lines: 1, ..none },
            Event::NeighborSwitch(..) => Self { neighbor_switches: 1, ..none },
            Event::Move(_) => none,
        }
    }
}

impl Place {
    /// All cells that what happens here may depend on or change; none where it is gone.
    fn cells(self, complex: &CellComplex) -> Vec<CellId> {
        let faces = match self {
            Self::Triangle(face) => vec![face],
            Self::Line(edge) if complex.has_edge(edge) => complex.faces_of_edge(edge),
            Self::Line(_) => Vec::new(),
        };
        let small = faces.into_iter().filter(|face| complex.corners(*face).len() <= 4);
        let corners = small.flat_map(|face| complex.corners(face)).map(|corner| corner.vertex);
        let ends = match self {
            Self::Triangle(_) => None,
            Self::Line(edge) => Some(edge.vertices()),
        };
        let ends = ends.into_iter().flatten();
        let vertices: SmallVec<[u32; 16]> = corners.chain(ends).collect();
        let sides = complex.faces_at(&vertices).into_iter().flat_map(|face| complex.sides(face));
        let cells = sides.filter_map(|side| cell_and_offset(side, complex.domain()));
        let mut cells: Vec<CellId> = cells.map(|(cell, _)| cell).collect();
        cells.sort_unstable();
        cells.dedup();
        cells
    }
}

/// All sides that touch a line, a cell and its images as one.
fn sides_at(complex: &CellComplex, edge: ComplexEdge) -> Vec<Side> {
    let faces = complex.faces_at(&edge.vertices());
    distinct(faces.into_iter().flat_map(|face| complex.sides(face)))
}

fn length(complex: &CellComplex, edge: ComplexEdge) -> f64 {
    complex.vertices[edge.start as usize].distance(complex.position(edge.end))
}

/// The length that a line had, if there was one; vertices that are new have higher numbers.
fn length_before(complex: &CellComplex, edge: ComplexEdge, before: &[DVec3]) -> Option<f64> {
    let [start, end] = edge.vertices().map(|vertex| before.get(vertex as usize));
    Some(start?.distance(*end? + edge.end.translation.vector(complex.domain())))
}

/// The distance from the longest side of a boundary with three sides to the corner opposite.
fn least_height(complex: &CellComplex, face: FaceId) -> f64 {
    let [a, b, c] = [0, 1, 2].map(|k| complex.position(complex.corners(face)[k]));
    let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
    (b - a).cross(c - a).length() / longest.max(f64::MIN_POSITIVE)
}
