//! Events in the plane: grains that vanish, and neighbours that switch. Those in space are in `sheets`.

use glam::{DVec2, DVec3};
use voronoi::{CellId, Dimension, FaceId};

use super::curves::Curves;
use super::front::Happened;
use crate::GrainId;
use crate::arcs::switching::Switcher;
use crate::energy::local_size::LocalSize;
use crate::flow::tuning::Tuning;

impl Curves<'_> {
    /// Lets all events happen that are due, given the areas of grains and their mean.
    pub(super) fn let_happen(&mut self, areas: &[f64], mean: f64) -> Happened {
        let size = mean.sqrt();
        let mut before: Vec<[DVec2; 2]> = vec![[DVec2::ZERO; 2]; self.inner.len()];
        for face in self.complex().faces() {
            before[face.index()] = self.ends(face);
        }
        let is_small = |cell: u32, area: f64| {
            area < self.tuning.vanished * mean && self.complex().faces_of_cell(CellId(cell)).len() > 0
        };
        let mut small: Vec<(f64, u32)> = areas.iter().copied().zip(0u32..).collect();
        small.retain(|(area, cell)| is_small(*cell, *area));
        small.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let mut vanished = Vec::new();
        for (_, cell) in small {
            if self.vanish(CellId(cell), &mut before) {
                vanished.push(GrainId(cell));
            }
        }
        let vanishing = self.vanishing(self.tuning.short * size);
        for face in self.complex().faces() {
            self.edges.turnings[face.index()] = turning(&self.line(face));
        }
        let local_size = LocalSize::new(Dimension::Two, Tuning::default().small_grain * size);
        let mut switcher = Switcher::new(size, local_size, areas, self.recipe.network.tension);
        let reconnections = switcher.pass(&mut self.edges, &vanishing);
        self.inner.resize(self.edges.turnings.len(), Vec::new());
        for face in self.complex().faces() {
            self.follow_ends(face, &mut before);
        }
        Happened { vanished, reconnections }
    }

    /// Draws a grain together into a point in its middle, or on its walls. One that parts a neighbour from itself, or lies along several walls,
    /// goes to a neighbour instead. Whether it could.
    fn vanish(&mut self, cell: CellId, before: &mut [[DVec2; 2]]) -> bool {
        let corners = self.complex().corners_of_cell(cell);
        let Some(vertex) = self.edges.complex.cell_to_point(cell) else {
            return self.give_to_neighbor(cell, before);
        };
        let complex = &mut self.edges.complex;
        let walls = complex.walls_at(vertex);
        if walls.len() < 2 {
            let kept = corners.iter().find(|(corner, _)| corner.vertex == vertex).expect("it is one of them");
            let on_walls = corners.iter().filter(|(_, at)| walls.iter().all(|wall| at.contains(wall)));
            let places: Vec<DVec3> = on_walls.map(|(corner, _)| complex.position(*corner)).collect();
            let middle = places.iter().sum::<DVec3>() / places.len() as f64;
            complex.vertices[vertex as usize] = middle - kept.0.translation.vector(complex.domain());
        }
        for face in self.complex().faces_at(&[vertex]) {
            self.follow_ends(face, before);
        }
        if walls.len() < 2 {
            self.join_edges(vertex, before);
        }
        true
    }

    /// Gives a grain to the neighbour that it shares the longest edge with, of those that can have it.
    fn give_to_neighbor(&mut self, cell: CellId, before: &mut [[DVec2; 2]]) -> bool {
        let mut edges: Vec<FaceId> = self.complex().faces_of_cell(cell).collect();
        edges.sort_unstable_by(|a, b| self.length(*b).total_cmp(&self.length(*a)).then(a.cmp(b)));
        for edge in edges {
            let ends: Vec<u32> = self.complex().corners(edge).iter().map(|corner| corner.vertex).collect();
            let lines: Vec<(FaceId, Vec<DVec2>)> =
                self.complex().faces_of_cell(cell).map(|edge| (edge, self.line(edge))).collect();
            let Some(changed) = self.edges.complex.cell_to_neighbor(cell, edge) else { continue };
            for (face, is_reversed) in changed {
                let known = lines.iter().find(|(other, _)| *other == face);
                let mut line = known.expect("it was the grain's").1.clone();
                if is_reversed {
                    line.reverse();
                }
                let ends = self.ends(face);
                let offset = ends[0] - line[0];
                self.inner[face.index()] =
                    line[1..line.len() - 1].iter().map(|point| *point + offset).collect();
                before[face.index()] = ends;
            }
            for vertex in ends {
                self.join_edges(vertex, before);
            }
            return true;
        }
        false
    }

    /// Makes one edge of the two at a vertex that only they are left at.
    fn join_edges(&mut self, vertex: u32, before: &mut [[DVec2; 2]]) {
        let lines: Vec<(FaceId, Vec<DVec2>)> =
            self.complex().faces_at(&[vertex]).into_iter().map(|face| (face, self.line(face))).collect();
        let Some([kept, gone]) = self.edges.complex.join_edges(vertex) else { return };
        let line =
            |face: FaceId| &lines.iter().find(|(other, _)| *other == face).expect("it is one of the two").1;
        let (first, then) = (line(kept), line(gone));
        let offset = first[first.len() - 1] - then[0];
        let inner =
            first[1..].iter().copied().chain(then[1..then.len() - 1].iter().map(|point| *point + offset));
        self.inner[kept.index()] = inner.collect();
        before[kept.index()] = self.ends(kept);
    }

    /// The edges that are short and have become shorter.
    fn vanishing(&self, short: f64) -> Vec<FaceId> {
        let faces = self.complex().faces().into_iter();
        let is_vanishing = |face: &FaceId| {
            let length = self.length(*face);
            length < short && length < self.lengths[face.index()]
        };
        faces.filter(is_vanishing).collect()
    }

    /// Moves the points of an edge whose ends have moved: each by its share of the way.
    fn follow_ends(&mut self, face: FaceId, before: &mut [[DVec2; 2]]) {
        let ends = self.ends(face);
        let Some(before) = before.get_mut(face.index()) else { return };
        let moves = [0, 1].map(|end| ends[end] - before[end]);
        let inner = &mut self.inner[face.index()];
        let count = inner.len() as f64 + 1.0;
        for (done, point) in inner.iter_mut().enumerate() {
            *point += moves[0].lerp(moves[1], (done as f64 + 1.0) / count);
        }
        *before = ends;
    }
}

/// By how much a line turns left from its start to its end.
fn turning(line: &[DVec2]) -> f64 {
    let first = line[1] - line[0];
    let last = line[line.len() - 1] - line[line.len() - 2];
    first.angle_to(last)
}
