//! Which grains come together and which part.

use std::collections::HashMap;

use glam::DVec3;
use voronoi::{CellComplex, ComplexEdge, Corner, FaceId, Shift, Side};

use super::local_area::{Conditions, Excess, LocalArea};
use super::local_size::LocalSize;
use super::shape::distinct;

/// Share of the length of what goes by which what comes starts off its middle.
const OPENING: f64 = 0.3;

/// Length, in units of a short line, that what goes counts with at least: it may have shrunk to nothing.
const LEAST_GOING: f64 = 0.5;

/// Turns among walls that are not at right angles; each takes a point nearer to all of them.
const WALL_TURNS: usize = 50;

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

/// How often grains came together and parted. In the plane, a boundary is an edge, and what was a triple line is a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Reconnections {
    /// Triple lines that became boundaries with three sides: two grains came to meet. In the plane, points of more than three
    /// edges that opened to one more.
    pub opened: usize,
    /// Boundaries with three sides that became triple lines: two grains parted. In the plane, edges that shrank to such points.
    pub closed: usize,
    /// Boundaries with four sides that gave way to one between the grains at two opposite sides. In the plane, edges that gave
    /// way to one between the grains at their ends (T1).
    pub swapped: usize,
}

impl Reconnections {
    /// All events.
    pub fn count(self) -> usize {
        self.opened + self.closed + self.swapped
    }

    pub(super) fn add(&mut self, other: Self) {
        self.opened += other.opened;
        self.closed += other.closed;
        self.swapped += other.swapped;
    }
}

/// A change of topology.
#[derive(Debug, Clone, Copy)]
enum Event {
    Open(ComplexEdge),
    Close(FaceId),
    /// The face has four sides, one of which is the edge.
    Swap(ComplexEdge, FaceId),
}

/// What an event has to be good for.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Demand {
    LessArea,
    /// That it does not fold anything.
    NoFold,
}

/// Looks for events.
pub(super) struct Reconnector {
    /// Length below which lines are short where no grain is small.
    short: f64,
    /// The size of small grains: around them lines are short only if they are as much shorter.
    size: LocalSize,
    /// Of lines, by all sides that touch them, how often they went without lessening the area.
    tries: HashMap<Vec<Side>, u8>,
}

impl Reconnector {
    pub(super) fn new(short: f64, size: LocalSize) -> Self {
        Self { short, size, tries: HashMap::new() }
    }

    /// Length below which lines are short at some vertices.
    fn short_at(&self, complex: &CellComplex, vertices: &[u32], conditions: &Conditions<'_>) -> f64 {
        self.short * self.size.at_vertices(complex, vertices, conditions.volumes)
    }

    /// Lets all events happen that are due where lines are short, or boundaries with three sides thin; `before` has the lengths
    /// of lines a while ago, `excess` is kept up to date.
    pub(super) fn pass(
        &mut self,
        complex: &mut CellComplex,
        conditions: &Conditions<'_>,
        before: &HashMap<ComplexEdge, f64>,
        excess: &mut Excess,
    ) -> Reconnections {
        let mut done = Reconnections::default();
        for face in complex.faces_with_corners(3) {
            if complex.corners(face).len() == 3
                && self.is_thin(face, complex, conditions)
                && self.happens(Event::Close(face), complex, conditions, Demand::LessArea, excess)
            {
                done.closed += 1;
            }
        }
        for edge in self.short_lines(complex, conditions) {
            if complex.has_edge(edge) {
                done.add(self.pass_line(edge, complex, conditions, before, excess));
            }
        }
        done
    }

    /// Whether a boundary with three sides is thin.
    fn is_thin(&self, face: FaceId, complex: &CellComplex, conditions: &Conditions<'_>) -> bool {
        let height = least_height(complex, face);
        let short = || self.short_at(complex, &Event::Close(face).vertices(complex), conditions);
        height < THIN * self.short && height < THIN * short()
    }

    /// The short lines, shortest first.
    fn short_lines(&self, complex: &CellComplex, conditions: &Conditions<'_>) -> Vec<ComplexEdge> {
        let lengths = complex.edges().into_iter().map(|edge| (length(complex, edge), edge));
        let is_short = |(length, edge): &(f64, ComplexEdge)| {
            *length < self.short && *length < self.short_at(complex, &edge.vertices(), conditions)
        };
        let mut short: Vec<(f64, ComplexEdge)> = lengths.filter(is_short).collect();
        short.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        short.into_iter().map(|(_, edge)| edge).collect()
    }

    fn pass_line(
        &mut self,
        edge: ComplexEdge,
        complex: &mut CellComplex,
        conditions: &Conditions<'_>,
        before: &HashMap<ComplexEdge, f64>,
        excess: &mut Excess,
    ) -> Reconnections {
        let around = complex.faces_of_edge(edge);
        let with_corners = |count: usize| -> Vec<FaceId> {
            around.iter().copied().filter(|face| complex.corners(*face).len() == count).collect()
        };
        let [opened, closed, swapped] = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]
            .map(|[opened, closed, swapped]| Reconnections { opened, closed, swapped });
        let mut events = vec![(Event::Open(edge), opened)];
        events.extend(with_corners(3).into_iter().map(|face| (Event::Close(face), closed)));
        let count = events.len();
        events.extend(with_corners(4).into_iter().map(|face| (Event::Swap(edge, face), swapped)));
        for (event, done) in &events {
            if self.happens(*event, complex, conditions, Demand::LessArea, excess) {
                return *done;
            }
        }
        let now = length(complex, edge);
        let short = self.short_at(complex, &edge.vertices(), conditions);
        let is_shrinking = before.get(&edge).is_some_and(|before| now < *before);
        if now < short && is_shrinking {
            let sides = sides_at(complex, edge);
            let tries = self.tries.get(&sides).copied().unwrap_or(0);
            for (event, done) in events[..count].iter().filter(|_| tries < MOST_TRIES) {
                if self.happens(*event, complex, conditions, Demand::NoFold, excess) {
                    self.tries.insert(sides, tries + 1);
                    return *done;
                }
            }
        }
        if now < TINY * short {
            self.settle(edge, complex, conditions, excess);
        }
        Reconnections::default()
    }

    /// Lets an event happen if it keeps its promise.
    fn happens(
        &self,
        event: Event,
        complex: &mut CellComplex,
        conditions: &Conditions<'_>,
        demand: Demand,
        excess: &mut Excess,
    ) -> bool {
        let old = event.vertices(complex);
        let short = self.short_at(complex, &old, conditions);
        let snapshot = complex.snapshot(&old);
        let first_new = complex.vertices.len();
        let mut as_it_is = LocalArea::new(complex, &old, conditions, excess);
        let excesses: Vec<_> = as_it_is.excesses().collect();
        let folds = as_it_is.fold_count();
        if event.happen(complex, LEAST_GOING * short) {
            let added =
                (first_new..complex.vertices.len()).map(|new| u32::try_from(new).expect("ids fit 32 bits"));
            let all = old.into_iter().chain(added);
            let new: Vec<u32> = all.filter(|vertex| !complex.faces_at(&[*vertex]).is_empty()).collect();
            let mut changed = LocalArea::new(complex, &new, conditions, excess).with_volumes_of(&as_it_is);
            let is_good = match demand {
                Demand::LessArea => changed.minimize() < as_it_is.minimize(),
                Demand::NoFold => true,
            };
            if is_good
                && changed.shortest_edge() > LEAST * short
                && changed.keeps_volumes(LARGEST_CHANGE, &excesses)
                && changed.fold_count() <= folds
            {
                changed.place(complex);
                changed.excesses().for_each(|(cell, by, _)| excess[cell.index()] = by);
                return true;
            }
        }
        complex.restore(snapshot);
        false
    }

    /// Puts the ends of a line where it has the least area, unless it gets even shorter.
    fn settle(
        &self,
        edge: ComplexEdge,
        complex: &mut CellComplex,
        conditions: &Conditions<'_>,
        excess: &mut Excess,
    ) {
        let mut area = LocalArea::new(complex, &edge.vertices(), conditions, excess);
        let excesses: Vec<_> = area.excesses().collect();
        let (shortest, folds) = (area.shortest_edge(), area.fold_count());
        area.minimize();
        let keeps_volumes = area.keeps_volumes(LARGEST_CHANGE, &excesses);
        if area.shortest_edge() > shortest && keeps_volumes && area.fold_count() <= folds {
            area.place(complex);
            area.excesses().for_each(|(cell, by, _)| excess[cell.index()] = by);
        }
    }
}

impl Event {
    /// The vertices that it takes away or moves.
    fn vertices(self, complex: &CellComplex) -> Vec<u32> {
        match self {
            Self::Open(edge) => edge.vertices().to_vec(),
            Self::Close(face) | Self::Swap(_, face) => {
                complex.corners(face).iter().map(|corner| corner.vertex).collect()
            }
        }
    }

    /// Whether it is possible and has happened; where not, something may have changed all the same.
    ///
    /// What goes counts as no shorter than `least`.
    fn happen(self, complex: &mut CellComplex, least: f64) -> bool {
        match self {
            Self::Open(edge) => open(complex, edge, least),
            Self::Close(face) => close(complex, face, least),
            Self::Swap(edge, face) => open(complex, edge, least) && close(complex, face, least),
        }
    }
}

fn open(complex: &mut CellComplex, edge: ComplexEdge, least: f64) -> bool {
    let Some(star) = complex.reconnectable_edge(edge) else { return false };
    let start = Corner { vertex: edge.start, shift: Shift::NONE };
    let ends = [start, edge.end].map(|end| complex.position(end));
    let middle = ends[0].midpoint(ends[1]);
    let length = OPENING * ends[0].distance(ends[1]).max(least);
    let [first, second] = star.ends;
    let places = [0, 1, 2].map(|k| {
        let along: DVec3 = star.outer.iter().map(|outer| direction(complex, middle, outer[k])).sum();
        let sides = [first, second, star.around[(k + 1) % 3], star.around[(k + 2) % 3]];
        on_walls(complex, &sides, middle + along.normalize_or_zero() * length)
    });
    complex.edge_to_triangle(edge, places).is_some()
}

fn close(complex: &mut CellComplex, face: FaceId, least: f64) -> bool {
    let Some((star, corners)) = complex.reconnectable_triangle(face) else { return false };
    let corners = corners.map(|corner| complex.position(corner));
    let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
    let length = OPENING * corners[0].distance(middle).max(least);
    let [a, b, c] = star.around;
    let places = [0, 1].map(|end: usize| {
        let along: DVec3 = star.outer[end].iter().map(|outer| direction(complex, middle, *outer)).sum();
        on_walls(complex, &[a, b, c, star.ends[end]], middle + along.normalize_or_zero() * length)
    });
    complex.triangle_to_edge(face, places).is_some()
}

fn direction(complex: &CellComplex, from: DVec3, to: Corner) -> DVec3 {
    (complex.position(to) - from).normalize_or_zero()
}

/// The point of the walls among some sides that is near another one.
fn on_walls(complex: &CellComplex, sides: &[Side], mut point: DVec3) -> DVec3 {
    let walls = sides.iter().filter_map(|side| match side {
        Side::Wall(wall) => Some(complex.domain().wall_equation(*wall)),
        Side::Cell(_) | Side::Image(..) => None,
    });
    let walls: Vec<(DVec3, f64)> = walls.collect();
    for _ in 0..WALL_TURNS {
        for (normal, distance) in &walls {
            point += *normal * (distance - normal.dot(point));
        }
    }
    point
}

/// All sides that touch a line, a cell and its images as one.
fn sides_at(complex: &CellComplex, edge: ComplexEdge) -> Vec<Side> {
    let faces = complex.faces_at(&edge.vertices());
    distinct(faces.into_iter().flat_map(|face| complex.sides(face)))
}

/// The lengths of all lines.
pub(super) fn lengths(complex: &CellComplex) -> HashMap<ComplexEdge, f64> {
    complex.edges().into_iter().map(|edge| (edge, length(complex, edge))).collect()
}

fn length(complex: &CellComplex, edge: ComplexEdge) -> f64 {
    complex.vertices[edge.start as usize].distance(complex.position(edge.end))
}

/// The distance from the longest side of a boundary with three sides to the corner opposite.
fn least_height(complex: &CellComplex, face: FaceId) -> f64 {
    let [a, b, c] = [0, 1, 2].map(|k| complex.position(complex.corners(face)[k]));
    let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
    (b - a).cross(c - a).length() / longest.max(f64::MIN_POSITIVE)
}
