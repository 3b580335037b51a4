//! How long edges are to be, at each point of the smooth network.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use glam::DVec3;
use rayon::prelude::*;
use subzero::{EdgeId, FaceId, TriangleMesh};

use crate::mesh::id::id;
use crate::remesh::ElementSize;
use crate::remesh::gradation::Gradation;
use crate::remesh::parts::Parts;
use crate::remesh::short_lines::ShortLines;
use crate::remesh::skeleton::{Line, Occurrence, Skeleton};
use crate::remesh::torus::{Moved, Torus};
use crate::remesh::tuning::RemeshTuning;
use crate::{Level, NetworkError};

/// The size at each vertex of the finest level; the same at all copies of one.
pub(crate) struct SizeField {
    sizes: Vec<f64>,
    pub(crate) gradation: Gradation,
}

/// What sizes are found from.
pub(crate) struct Surroundings<'a> {
    pub(crate) level: &'a Level,
    pub(crate) mesh: &'a TriangleMesh,
    pub(crate) points: &'a [DVec3],
    pub(crate) torus: &'a Torus,
    pub(crate) skeleton: &'a Skeleton,
    pub(crate) parts: &'a Parts,
    pub(crate) short: ShortLines,
    /// Whether all triangles lie in the plane, so that boundaries are lines.
    pub(crate) is_plane: bool,
}

impl<'a> Surroundings<'a> {
    /// The lines that do not become points, with their numbers.
    fn lasting_lines(&self) -> impl Iterator<Item = (u32, &'a Line)> + '_ {
        (0u32..).zip(&self.skeleton.lines).filter(|(number, _)| !self.short.has(*number))
    }

    /// Refuses lines that elements cannot grow from.
    pub(crate) fn check_lines(&self, asked: &ElementSize, tuning: &RemeshTuning) -> Result<(), NetworkError> {
        let lengths = self.lasting_lines().map(|(_, line)| line.length(self.points));
        let length = lengths.fold(f64::INFINITY, f64::min);
        if length < tuning.shortest_line * asked.length {
            return Err(NetworkError::LineTooShort { length, size: asked.length });
        }
        Ok(())
    }

    /// What the vertex at which a line ends is in the new network.
    pub(crate) fn node(&self, vertex: u32) -> Moved<u32> {
        self.short.node(self.torus.vertices[vertex as usize])
    }
}

impl SizeField {
    /// The size asked for, less where lines are short or near each other, and within some distance of places; from there it grows steadily.
    pub(crate) fn new(
        around: &Surroundings<'_>,
        asked: &ElementSize,
        halved: &[Halved],
        tuning: &RemeshTuning,
    ) -> Self {
        let gradation = Gradation { growth: asked.growth, most: asked.length };
        let mut field = Self { sizes: vec![asked.length; around.points.len()], gradation };
        if let Some(share) = asked.of_radius {
            let floor = asked.length * tuning.smallest_share;
            field.limit_by_curvature(around, share, floor);
            if around.is_plane {
                field.limit_by_curvature_of_lines(around, share, floor);
            }
        }
        field.limit_on_lines(around, asked.length);
        field.limit_between_lines(around, asked.length, tuning);
        for Halved { place, within, factor } in halved {
            for (vertex, point) in around.points.iter().enumerate() {
                if point.distance(*place) < *within {
                    field.lower(around.torus, vertex, asked.length * factor);
                }
            }
        }
        field.grow_from_least(around, asked);
        field.share(around.torus);
        field
    }

    pub(crate) fn at(&self, vertex: u32) -> f64 {
        self.sizes[vertex as usize]
    }

    fn lower(&mut self, torus: &Torus, vertex: usize, to: f64) {
        let size = &mut self.sizes[torus.vertices[vertex].original as usize];
        *size = size.min(to);
    }

    /// Gives copies the size of their originals.
    fn share(&mut self, torus: &Torus) {
        for (vertex, moved) in torus.vertices.iter().enumerate() {
            self.sizes[vertex] = self.sizes[moved.original as usize];
        }
    }

    /// No size is more than the length of a line at its points.
    fn limit_on_lines(&mut self, around: &Surroundings<'_>, asked: f64) {
        for (_, line) in around.lasting_lines() {
            let length = line.length(around.points);
            if length < asked {
                line.vertices.iter().for_each(|vertex| self.lower(around.torus, *vertex as usize, length));
            }
        }
    }

    /// No size on a line is more than the distance to other lines of a boundary there that share no end with it.
    fn limit_between_lines(&mut self, around: &Surroundings<'_>, asked: f64, tuning: &RemeshTuning) {
        let limits: Vec<Vec<(u32, f64)>> = (0..around.parts.boundaries.len())
            .into_par_iter()
            .map(|part| {
                let edges = around
                    .parts
                    .triangles
                    .of(part)
                    .iter()
                    .flat_map(|triangle| around.mesh.triangle_edges(FaceId(*triangle)));
                let lines = edges.filter_map(|edge| around.skeleton.of_edge[edge.index()]);
                let mut lines: Vec<u32> = lines.map(|line| line.occurrence).collect();
                lines.sort_unstable();
                lines.dedup();
                let lines = lines.iter().map(|line| &around.skeleton.occurrences[*line as usize]);
                let lines: Vec<&Occurrence> =
                    lines.filter(|occurrence| !around.short.has(occurrence.line)).collect();
                distances(&lines, around, asked)
            })
            .collect();
        let floor = tuning.smallest_share * asked;
        for (vertex, distance) in limits.into_iter().flatten() {
            self.lower(around.torus, vertex as usize, distance.max(floor));
        }
    }

    /// No size is more than a share of the radius of curvature, as neighbouring normals show it.
    fn limit_by_curvature(&mut self, around: &Surroundings<'_>, share: f64, floor: f64) {
        let normal = |triangle: u32| {
            let [a, b, c] =
                around.mesh.triangles()[triangle as usize].map(|corner| around.points[corner as usize]);
            (b - a).cross(c - a).normalize_or_zero()
        };
        let middle = |triangle: u32| {
            let corners =
                around.mesh.triangles()[triangle as usize].map(|corner| around.points[corner as usize]);
            corners.iter().sum::<DVec3>() / 3.0
        };
        for edge in 0..id(around.mesh.edge_count()) {
            let Some([first, second]) =
                around.mesh.edge_triangles(EdgeId(edge)).map(|pair| pair.map(|triangle| triangle.0))
            else {
                continue;
            };
            if around.skeleton.of_edge[edge as usize].is_some() {
                continue;
            }
            let turn = normal(first).distance(normal(second));
            if turn > 0.0 {
                let radius = middle(first).distance(middle(second)) / turn;
                let limit = (share * radius).max(floor);
                around
                    .mesh
                    .edge(EdgeId(edge))
                    .iter()
                    .for_each(|end| self.lower(around.torus, *end as usize, limit));
            }
        }
    }

    /// No size on a line is more than a share of its radius of curvature, as its steps show it.
    fn limit_by_curvature_of_lines(&mut self, around: &Surroundings<'_>, share: f64, floor: f64) {
        for (_, line) in around.lasting_lines() {
            for around_middle in line.vertices.windows(3) {
                let [before, at, after] = [0, 1, 2].map(|k| around.points[around_middle[k] as usize]);
                let (step, next) = (at - before, after - at);
                let turn = step.angle_between(next);
                if turn > 0.0 {
                    let radius = 0.5 * (step.length() + next.length()) / turn;
                    let limit = (share * radius).max(floor);
                    around_middle.iter().for_each(|vertex| self.lower(around.torus, *vertex as usize, limit));
                }
            }
        }
    }

    /// Nowhere do sizes grow faster than asked, along edges of the network.
    fn grow_from_least(&mut self, around: &Surroundings<'_>, asked: &ElementSize) {
        let original = |vertex: u32| around.torus.vertices[vertex as usize].original;
        let is_less = |vertex: &u32| self.sizes[*vertex as usize] < asked.length;
        // Positive numbers are in the order of their bits.
        let mut front: BinaryHeap<Reverse<(u64, u32)>> = (0..id(self.sizes.len()))
            .filter(is_less)
            .map(|vertex| Reverse((self.sizes[vertex as usize].to_bits(), vertex)))
            .collect();
        if front.is_empty() {
            return;
        }
        let count = around.mesh.edge_count();
        let ends = (0..id(count)).map(|edge| around.mesh.edge(EdgeId(edge)));
        let neighbours = crate::mesh::grouped::Grouped::new(
            self.sizes.len(),
            ends.flat_map(|[a, b]| {
                let length = around.points[a as usize].distance(around.points[b as usize]);
                let [a, b] = [a, b].map(original);
                [(a as usize, (b, length)), (b as usize, (a, length))]
            }),
        );
        while let Some(Reverse((bits, vertex))) = front.pop() {
            if bits > self.sizes[vertex as usize].to_bits() {
                continue;
            }
            for (other, length) in neighbours.of(vertex as usize) {
                let reached = f64::from_bits(bits) + asked.growth * length;
                if reached < self.sizes[*other as usize] {
                    self.sizes[*other as usize] = reached;
                    front.push(Reverse((reached.to_bits(), *other)));
                }
            }
        }
    }
}

/// A place where elements are to be smaller.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Halved {
    pub(crate) place: DVec3,
    /// Distance up to which it holds.
    pub(crate) within: f64,
    /// Share of the size that is asked for.
    pub(crate) factor: f64,
}

/// Of the vertices of lines the distances, where less than a limit, to other lines that share no end.
fn distances(lines: &[&Occurrence], around: &Surroundings<'_>, limit: f64) -> Vec<(u32, f64)> {
    let place = |vertex: u32| around.points[vertex as usize];
    let bounds: Vec<[DVec3; 2]> = lines
        .iter()
        .map(|line| {
            let places = line.vertices.iter().map(|vertex| place(*vertex));
            places.fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[lower, upper], place| {
                [lower.min(place), upper.max(place)]
            })
        })
        .collect();
    let ends = |line: &Occurrence| {
        [line.vertices[0], line.vertices[line.vertices.len() - 1]].map(|end| around.node(end))
    };
    let mut found = Vec::new();
    for (own, line) in lines.iter().enumerate() {
        for (other, across) in lines.iter().enumerate() {
            if own == other || ends(line).iter().any(|end| ends(across).contains(end)) {
                continue;
            }
            let [lower, upper] = bounds[other];
            for vertex in &line.vertices {
                let point = place(*vertex);
                if point.distance(point.clamp(lower, upper)) >= limit {
                    continue;
                }
                let segments = across.vertices.windows(2).map(|ends| [place(ends[0]), place(ends[1])]);
                let distance = segments.map(|ends| distance_to_segment(point, ends)).fold(limit, f64::min);
                if distance < limit {
                    found.push((*vertex, distance));
                }
            }
        }
    }
    found
}

fn distance_to_segment(point: DVec3, [from, to]: [DVec3; 2]) -> f64 {
    let along = to - from;
    let share = ((point - from).dot(along) / along.length_squared()).clamp(0.0, 1.0);
    point.distance(from + along * share)
}
