//! Which edges of a complex in the plane shrink to points, and which points open to edges.
//!
//! A point with tensions pulling at it opens where that lessens the energy: along a new edge of tension g, between edges that pull with
//! forces F at one end and G at the other, it does so at the rate `g - |F - G| / 2` per length. Where all tensions are equal, each
//! point of four edges or more opens, for there are two that enclose less than 120 degrees.

use std::collections::HashMap;
use std::f64::consts::PI;

use glam::DVec2;
use voronoi::{CellId, FaceId, Side, Translation};

use crate::energy::local_size::LocalSize;
use crate::energy::shape::distinct;
use crate::energy::sides::boundary;
use crate::events::reconnection::Reconnections;
use crate::{Boundary, CellComplex, OutgoingHalfEdge};

/// Length, in units of the feature size, below which an edge that would vanish may go; around small grains, in units of theirs.
const SHORT: f64 = 0.3;

/// Length, in the same unit, below which the cells' own edges do as well: they tell nothing of where the tensions pull. Without it lengths are as good,
/// but three clusters of small grains in 80 no longer come to rest; with 0.03 two of 20 do not.
const TINY: f64 = 0.01;

/// Length of a new edge at most, in the same unit. With 0.09, or no bound, steps are a tenth fewer, but of the networks that end otherwise three quarters are longer ...
const OPENING: f64 = 0.03;

/// ... and as a share of the shortest edge beside it.
const OPENING_SHARE: f64 = 0.3;

/// What an opening saves, or saves more than another, that counts as nothing, as a share.
const TIED: f64 = 1e-9;

/// How often a point between the same cells may open: what comes back is to stay. With 3 as in space, three more points of 294 networks stay closed.
const MOST_TRIES: u8 = 8;

/// Edges that may change their topology.
pub(crate) struct CurvedEdges {
    pub(crate) complex: CellComplex,
    /// Of each edge, by number, the angle by which it turns left from start to end.
    pub(crate) turnings: Vec<f64>,
}

/// Looks for events.
pub(crate) struct Switcher<'a> {
    size: f64,
    /// Around small grains edges are short only if they are as much shorter.
    local_size: LocalSize,
    /// Of each cell.
    areas: &'a [f64],
    tension: &'a dyn Fn(&Boundary) -> f64,
    /// Of points, by the cells and walls there, how often they split.
    tries: HashMap<Vec<Side>, u8>,
}

/// A way to open a point.
struct Opening {
    /// The edges that get a vertex of their own.
    outgoing: Vec<OutgoingHalfEdge>,
    /// To the right and to the left of the new edge on the way there.
    sides: [Side; 2],
    /// Change of energy per length.
    rate: f64,
    /// How the new vertex and the old one move per length.
    moves: [DVec2; 2],
}

impl<'a> Switcher<'a> {
    /// For features of a size, and cells of some areas; tensions are those of boundaries.
    pub(crate) fn new(
        size: f64,
        local_size: LocalSize,
        areas: &'a [f64],
        tension: &'a dyn Fn(&Boundary) -> f64,
    ) -> Self {
        Self { size, local_size, areas, tension, tries: HashMap::new() }
    }

    /// Opens what is too short to start with, as far as it then has a reason, and points with too many edges.
    pub(crate) fn start(&mut self, edges: &mut CurvedEdges) -> Reconnections {
        self.switch(edges, TINY, |_| true, true)
    }

    /// Lets all events happen that are due, of these edges that would vanish, in order, and of points with too many edges.
    pub(crate) fn pass(&mut self, edges: &mut CurvedEdges, vanishing: &[FaceId]) -> Reconnections {
        self.switch(edges, SHORT, |face| vanishing.binary_search(&face).is_ok(), false)
    }

    fn switch(
        &mut self,
        edges: &mut CurvedEdges,
        short: f64,
        is_due: impl Fn(FaceId) -> bool,
        stretches: bool,
    ) -> Reconnections {
        let mut done = Reconnections::default();
        let due = edges.complex.faces().into_iter().filter(|face| is_due(*face));
        let due = due.filter_map(|face| Some((self.length_below(edges, face, short)?, face)));
        let mut due: Vec<(f64, FaceId)> = due.collect();
        due.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        for (_, face) in due {
            // An event beside it may have stretched it.
            if self.length_below(edges, face, short).is_some() {
                done.add(self.switch_edge(edges, face, stretches));
            }
        }
        loop {
            // All as they are before the first of them opens: lattices then open alike everywhere.
            let vertices =
                0..u32::try_from(edges.complex.vertices.len()).expect("vertices have 32-bit numbers");
            let openings = vertices.filter_map(|vertex| Some((vertex, self.best_opening(edges, vertex)?)));
            let openings: Vec<(u32, Opening)> = openings.collect();
            for (vertex, opening) in &openings {
                self.open(edges, *vertex, opening);
            }
            done.lines_to_boundaries += openings.len();
            if openings.is_empty() {
                break;
            }
        }
        done
    }

    /// The distance from one end of an edge to the other, where it is below so many feature sizes, and around small grains as many of theirs.
    fn length_below(&self, edges: &CurvedEdges, face: FaceId, short: f64) -> Option<f64> {
        let length = edges.chord(face).length();
        let ends = || edges.complex.corners(face).iter().map(|corner| corner.vertex).collect::<Vec<_>>();
        let local = || self.local_size.at_vertices(&edges.complex, &ends(), self.areas);
        let short = short * self.size;
        (length < short && length < short * local()).then_some(length)
    }

    /// Draws an edge together, and opens the point along the edge that saves most. If that is the same again, all is as it was; or
    /// it stays, where edges are to be stretched.
    fn switch_edge(&mut self, edges: &mut CurvedEdges, face: FaceId, stretches: bool) -> Reconnections {
        let none = Reconnections::default();
        if !edges.may_shrink(face) {
            return none;
        }
        let ends: Vec<u32> = edges.complex.corners(face).iter().map(|corner| corner.vertex).collect();
        let sides = edges.complex.sides(face);
        let snapshot = edges.complex.snapshot(&ends);
        let vertex = edges.shrink(face);
        let Some(opening) = self.best_opening(edges, vertex) else {
            return Reconnections { boundaries_to_lines: 1, ..none };
        };
        let new = self.open(edges, vertex, &opening);
        if edges.complex.sides(new) == sides {
            if !stretches {
                edges.complex.restore(snapshot);
            }
            return none;
        }
        Reconnections { neighbor_switches: 1, ..none }
    }

    fn open(&mut self, edges: &mut CurvedEdges, vertex: u32, opening: &Opening) -> FaceId {
        let outgoing = edges.complex.outgoing_half_edges(vertex);
        *self.tries.entry(sides_around(&outgoing)).or_default() += 1;
        let lengths = outgoing.iter().map(|half_edge| edges.chord(half_edge.face).length());
        let length = lengths.fold(OPENING / OPENING_SHARE * self.size, f64::min) * OPENING_SHARE;
        let face = edges.complex.point_to_edge(vertex, &opening.outgoing, opening.sides);
        let new = edges.complex.vertices.len() - 1;
        for (vertex, by) in [new, vertex as usize].into_iter().zip(opening.moves) {
            edges.complex.vertices[vertex] += (by * length).extend(0.0);
        }
        edges.turnings.resize(face.index() + 1, 0.0);
        edges.turnings[face.index()] = 0.0;
        face
    }

    /// The opening of a point that saves most, if any does.
    fn best_opening(&self, edges: &CurvedEdges, vertex: u32) -> Option<Opening> {
        let outgoing = edges.complex.outgoing_half_edges(vertex);
        let walls = edges.complex.walls_at(vertex).len();
        if outgoing.len() < [4, 4, 3][walls.min(2)] {
            return None;
        }
        let pulls: Vec<DVec2> = outgoing
            .iter()
            .map(|half_edge| {
                edges.outward(half_edge) * self.tension_between(edges.complex.sides(half_edge.face))
            })
            .collect();
        let at = Point { outgoing: &outgoing, pulls: &pulls, switcher: self };
        let openings = match walls {
            0 => at.openings_inside(),
            1 => at.openings_at_wall(edges.outward(&outgoing[0])),
            _ => at.openings_at_corner([0, outgoing.len() - 1].map(|end| edges.outward(&outgoing[end]))),
        };
        let best = openings.into_iter().reduce(Opening::better);
        best.filter(|_| self.tries.get(&sides_around(&outgoing)).is_none_or(|tries| *tries < MOST_TRIES))
    }

    fn tension_between(&self, sides: [Side; 2]) -> f64 {
        (self.tension)(&boundary(sides))
    }
}

impl Opening {
    /// The one that saves more; of two that save the same, the one less turned from the x axis, so that lattices open all one way.
    fn better(self, other: Self) -> Self {
        let gain = self.rate - other.rate;
        let is_tied = gain.abs() <= TIED * self.rate.abs();
        let turned = |opening: &Self| (opening.moves[0] - opening.moves[1]).to_angle().rem_euclid(PI);
        let is_other = if is_tied { turned(&other) < turned(&self) } else { gain > 0.0 };
        if is_other { other } else { self }
    }
}

/// A point that may open.
struct Point<'a> {
    /// Counter-clockwise, from wall to wall if there are any.
    outgoing: &'a [OutgoingHalfEdge],
    /// The forces with which they pull.
    pulls: &'a [DVec2],
    switcher: &'a Switcher<'a>,
}

impl Point<'_> {
    fn openings_inside(&self) -> Vec<Opening> {
        // Each pair of groups once: by that without the first edge.
        let count = self.outgoing.len();
        let groups = (1..count).flat_map(|start| (start + 2..=count).map(move |end| (start, end)));
        let groups = groups.filter(|(start, end)| count - (end - start) >= 2);
        groups
            .filter_map(|(start, end)| {
                let [own, others] = self.sums(start, end);
                let apart = 0.5 * (own - others);
                let direction = 0.5 * apart.normalize_or_zero();
                self.opening(
                    start,
                    end,
                    self.outer_sides(start, end),
                    apart.length(),
                    [direction, -direction],
                )
            })
            .collect()
    }

    fn openings_at_wall(&self, along_first: DVec2) -> Vec<Opening> {
        let count = self.outgoing.len();
        let along = (2..count - 1).filter_map(|end| {
            let [own, others] = self.sums(0, end);
            let saved = 0.5 * (own - others).dot(along_first);
            let moves = [0.5 * along_first, -0.5 * along_first];
            self.opening(0, end, self.outer_sides(0, end), saved, moves)
        });
        self.openings_inward().into_iter().chain(along).collect()
    }

    fn openings_at_corner(&self, [along_first, along_last]: [DVec2; 2]) -> Vec<Opening> {
        let count = self.outgoing.len();
        let along_first_wall = (2..count).filter_map(|end| {
            let [own, _] = self.sums(0, end);
            let saved = own.dot(along_first);
            self.opening(0, end, self.outer_sides(0, end), saved, [along_first, DVec2::ZERO])
        });
        let along_last_wall = (1..count - 1).filter_map(|end| {
            let [_, others] = self.sums(0, end);
            let sides = [self.outgoing[count - 1].sides[1], self.outgoing[end - 1].sides[1]];
            self.opening(0, end, sides, others.dot(along_last), [DVec2::ZERO, along_last])
        });
        self.openings_inward().into_iter().chain(along_first_wall).chain(along_last_wall).collect()
    }

    /// Those that lead from a wall inside.
    fn openings_inward(&self) -> Vec<Opening> {
        let count = self.outgoing.len();
        let groups = (1..count - 2).flat_map(|start| (start + 2..count).map(move |end| (start, end)));
        groups
            .filter_map(|(start, end)| {
                let [own, _] = self.sums(start, end);
                let moves = [own.normalize_or_zero(), DVec2::ZERO];
                self.opening(start, end, self.outer_sides(start, end), own.length(), moves)
            })
            .collect()
    }

    /// What a group of edges pulls with, and what the others do.
    fn sums(&self, start: usize, end: usize) -> [DVec2; 2] {
        let own = self.pulls[start..end].iter().sum();
        [own, self.pulls.iter().sum::<DVec2>() - own]
    }

    fn outer_sides(&self, start: usize, end: usize) -> [Side; 2] {
        [self.outgoing[start].sides[0], self.outgoing[end - 1].sides[1]]
    }

    /// An opening that takes so much energy from the edges there, if that is more than the new one has.
    fn opening(
        &self,
        start: usize,
        end: usize,
        sides: [Side; 2],
        saved: f64,
        moves: [DVec2; 2],
    ) -> Option<Opening> {
        if sides[0] == sides[1] || sides.iter().all(|side| matches!(side, Side::Wall(_))) {
            return None;
        }
        let tension = self.switcher.tension_between(sides);
        let rate = tension - saved;
        let is_due = saved > 0.0 && rate < -TIED * tension.max(saved);
        is_due.then(|| Opening { outgoing: self.outgoing[start..end].to_vec(), sides, rate, moves })
    }
}

/// All sides around a point, a cell and its images as one.
fn sides_around(outgoing: &[OutgoingHalfEdge]) -> Vec<Side> {
    distinct(outgoing.iter().flat_map(|half_edge| half_edge.sides))
}

impl CurvedEdges {
    /// From start to end of an edge.
    fn chord(&self, face: FaceId) -> DVec2 {
        match self.complex.corners(face) {
            [start, end] => (self.complex.position(*end) - self.complex.position(*start)).truncate(),
            _ => DVec2::INFINITY,
        }
    }

    /// The direction of an edge at one of its ends.
    fn outward(&self, half_edge: &OutgoingHalfEdge) -> DVec2 {
        let chord = self.chord(half_edge.face).normalize_or_zero();
        let half = 0.5 * self.turnings[half_edge.face.index()];
        if half_edge.end == 0 {
            DVec2::from_angle(-half).rotate(chord)
        } else {
            -DVec2::from_angle(half).rotate(chord)
        }
    }

    /// Whether all cells stay discs, with three sides or, at walls, two, when an edge shrinks to a point.
    fn may_shrink(&self, face: FaceId) -> bool {
        let &[start, end] = self.complex.corners(face) else { return false };
        let walls = [start, end].map(|end| self.complex.walls_at(end.vertex).len());
        let is_in_wall = matches!(self.complex.sides(face)[1], Side::Wall(_));
        let may_meet = if is_in_wall { walls != [2, 2] } else { walls[0] == 0 || walls[1] == 0 };
        start.vertex != end.vertex
            && may_meet
            && self.complex.cells_beside(face).all(|cell| self.can_lose(cell, face))
            && self.ends_meet_others(face)
    }

    fn can_lose(&self, cell: CellId, face: FaceId) -> bool {
        let left = || self.complex.faces_of_cell(cell).filter(|edge| *edge != face);
        let is_at_wall = left().any(|edge| matches!(self.complex.sides(edge)[1], Side::Wall(_)));
        left().count() >= if is_at_wall { 2 } else { 3 }
    }

    /// Whether no cell is at both ends of an edge without being beside it: it would meet itself.
    fn ends_meet_others(&self, face: FaceId) -> bool {
        let corners = self.complex.corners(face);
        let at_start = self.complex.outgoing_half_edges(corners[0].vertex);
        let own = at_start.iter().filter(|half_edge| half_edge.face == face && half_edge.end == 0);
        let beside: Vec<Side> = own.flat_map(|half_edge| half_edge.sides).collect();
        let by = corners[1].translation - corners[0].translation;
        let at_end = self.complex.outgoing_half_edges(corners[1].vertex);
        let beyond: Vec<Side> = at_end.iter().map(|half_edge| moved(half_edge.sides[0], by)).collect();
        let here = at_start.iter().map(|half_edge| half_edge.sides[0]).filter(|side| !beside.contains(side));
        let mut here = here.filter(|side| !matches!(side, Side::Wall(_)));
        !here.any(|side| beyond.contains(&side))
    }

    /// Draws an edge together and gives the vertex that is left.
    fn shrink(&mut self, face: FaceId) -> u32 {
        let &[start, end] = self.complex.corners(face) else { unreachable!("an edge has two ends") };
        let walls = [start, end].map(|end| self.complex.walls_at(end.vertex).len());
        let kept = usize::from(walls[1] > walls[0]);
        let vertex = [start, end][kept].vertex;
        if walls[0] == walls[1] {
            let half_way = 0.5 * self.chord(face);
            self.complex.vertices[vertex as usize] += half_way.extend(0.0);
        }
        self.complex.edge_to_point(face, kept);
        vertex
    }
}

fn moved(side: Side, by: Translation) -> Side {
    match side {
        Side::Image(cell, translation) => Side::Image(cell, translation + by),
        Side::Cell(_) | Side::Wall(_) => side,
    }
}
