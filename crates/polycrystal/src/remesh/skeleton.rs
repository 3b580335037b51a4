//! The lines in which boundaries meet, and the points where lines end.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec3;
use voronoi::Translation;

use crate::mesh::id::id;
use crate::mesh::node_type::Meeting;
use crate::remesh::torus::{Moved, Torus};
use crate::{Level, WallSet, WallSets};
use subzero::{EdgeId, TriangleMesh};

/// A line on the torus, as one of its copies shows it.
#[derive(Debug)]
pub(crate) struct Line {
    /// From end to end; the first once more at the end of a line that is closed.
    pub(crate) vertices: Vec<u32>,
}

impl Line {
    pub(crate) fn is_closed(&self) -> bool {
        let [first, last] = self.ends();
        first == last
    }

    pub(crate) fn ends(&self) -> [u32; 2] {
        [self.vertices[0], self.vertices[self.vertices.len() - 1]]
    }

    fn steps<'a>(&'a self, points: &'a [DVec3]) -> impl Iterator<Item = [DVec3; 2]> + 'a {
        self.vertices.windows(2).map(|ends| [ends[0], ends[1]].map(|end| points[end as usize]))
    }

    pub(crate) fn length(&self, points: &[DVec3]) -> f64 {
        self.steps(points).map(|[from, to]| from.distance(to)).sum()
    }

    /// The place halfway along the line.
    pub(crate) fn middle(&self, points: &[DVec3]) -> DVec3 {
        let mut left = 0.5 * self.length(points);
        for [from, to] in self.steps(points) {
            let length = from.distance(to);
            if left <= length {
                return if length > 0.0 { from.lerp(to, left / length) } else { from };
            }
            left -= length;
        }
        points[self.ends()[1] as usize]
    }
}

/// Where a line stands.
#[derive(Debug)]
pub(crate) struct Occurrence {
    pub(crate) line: u32,
    /// From the place of [`Line::vertices`] to here.
    pub(crate) translation: Translation,
    /// In the order of [`Line::vertices`].
    pub(crate) vertices: Vec<u32>,
    /// The walls that points inside the line lie on.
    pub(crate) walls: WallSet,
    /// What meets along the line here; at a wall fewer grains than at the opposite one, where a grain only touches that.
    pub(crate) meeting: Meeting,
}

/// A step of an occurrence: the edge from its vertex of this number to the next.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct LineEdge {
    pub(crate) occurrence: u32,
    pub(crate) step: u32,
}

/// All lines of a network on its finest level.
#[derive(Debug)]
pub(crate) struct Skeleton {
    pub(crate) lines: Vec<Line>,
    pub(crate) occurrences: Vec<Occurrence>,
    /// Of each edge of the level; nothing inside boundaries.
    pub(crate) of_edge: Vec<Option<LineEdge>>,
    /// Whether lines end at a vertex.
    pub(crate) is_node: Vec<bool>,
}

/// An edge of the torus: an end as seen from the other one, whose original is not the greater.
type EdgeKey = (u32, Moved<u32>);

impl Skeleton {
    /// `is_corner` tells of vertices at which lines end though just two edges of one meet there.
    pub(crate) fn new(
        (level, mesh): (&Level, &TriangleMesh),
        sets: &WallSets,
        torus: &Torus,
        is_corner: impl Fn(usize) -> bool,
    ) -> Self {
        let edge_count = id(mesh.edge_count());
        let is_non_manifold =
            |edge: u32| match mesh.edge_triangles(EdgeId(edge)).map(|pair| pair.map(|triangle| triangle.0)) {
                Some([a, b]) => level.boundary_of[a as usize] != level.boundary_of[b as usize],
                None => true,
            };
        let key = |edge: u32| edge_key(torus, mesh.edge(EdgeId(edge)));
        let mut non_manifold_edges: Vec<u32> =
            (0..edge_count).filter(|edge| is_non_manifold(*edge)).collect();
        // What is a line somewhere is one at all copies, though fewer boundaries may be seen there.
        let is_copied = torus.vertices.iter().any(|moved| moved.translation != Translation::ZERO);
        if is_copied {
            let keys: BTreeSet<EdgeKey> = non_manifold_edges.iter().map(|edge| key(*edge)).collect();
            non_manifold_edges =
                (0..edge_count).filter(|edge| is_non_manifold(*edge) || keys.contains(&key(*edge))).collect();
        }
        let mut at_vertices: Vec<Vec<u32>> = vec![Vec::new(); level.vertex_count()];
        let mut around: Vec<Vec<Moved<u32>>> = vec![Vec::new(); level.vertex_count()];
        for edge in &non_manifold_edges {
            let [a, b] = mesh.edge(EdgeId(*edge));
            for [own, other] in [[a, b], [b, a]] {
                at_vertices[own as usize].push(*edge);
                let Moved { original, translation } = torus.vertices[own as usize];
                around[original as usize].push(torus.seen(other, translation));
            }
        }
        let count = |vertex: usize| {
            let mut others = around[torus.vertices[vertex].original as usize].clone();
            others.sort_unstable();
            others.dedup();
            others.len()
        };
        let is_node: Vec<bool> = (0..level.vertex_count())
            .map(|vertex| !matches!(count(vertex), 0 | 2) || is_corner(vertex))
            .collect();
        let mut skeleton = Self {
            lines: Vec::new(),
            occurrences: Vec::new(),
            of_edge: vec![None; mesh.edge_count()],
            is_node,
        };
        let mut known: BTreeMap<EdgeKey, u32> = BTreeMap::new();
        let starts_at_nodes = non_manifold_edges
            .iter()
            .copied()
            .filter(|edge| mesh.edge(EdgeId(*edge)).iter().any(|end| skeleton.is_node[*end as usize]));
        let order: Vec<u32> = starts_at_nodes.chain(non_manifold_edges.iter().copied()).collect();
        for edge in order {
            if skeleton.of_edge[edge as usize].is_some() {
                continue;
            }
            let (vertices, edges) = skeleton.trace(mesh, &at_vertices, edge);
            let least = edges.iter().map(|edge| key(*edge)).min().unwrap_or((0, torus.vertices[0]));
            let line = *known.entry(least).or_insert_with(|| {
                skeleton.lines.push(Line { vertices: vertices.clone() });
                id(skeleton.lines.len() - 1)
            });
            let walls =
                sets.intersection(level.walls[vertices[0] as usize], level.walls[vertices[1] as usize]);
            let (vertices, translation) = aligned(torus, &skeleton.lines[line as usize].vertices, vertices);
            let occurrence = id(skeleton.occurrences.len());
            let meeting = level.at_edges[edges[0] as usize];
            let steps: BTreeMap<[u32; 2], u32> = (0u32..)
                .zip(vertices.windows(2))
                .map(|(step, ends)| (sorted([ends[0], ends[1]]), step))
                .collect();
            for edge in edges {
                let step = steps[&sorted(mesh.edge(EdgeId(edge)))];
                skeleton.of_edge[edge as usize] = Some(LineEdge { occurrence, step });
            }
            skeleton.occurrences.push(Occurrence { line, translation, vertices, walls, meeting });
        }
        skeleton
    }

    /// The line through an edge: its vertices and edges. It starts at the edge's end where lines end, if there is one.
    fn trace(&self, mesh: &TriangleMesh, at_vertices: &[Vec<u32>], first: u32) -> (Vec<u32>, Vec<u32>) {
        let [a, b] = mesh.edge(EdgeId(first));
        let (start, mut at) = if self.is_node[a as usize] { (a, b) } else { (b, a) };
        let (mut vertices, mut edges, mut edge) = (vec![start, at], vec![first], first);
        while at != start && !self.is_node[at as usize] {
            let Some(next) = at_vertices[at as usize].iter().find(|other| **other != edge) else { break };
            edge = *next;
            let [a, b] = mesh.edge(EdgeId(edge));
            at = if a == at { b } else { a };
            vertices.push(at);
            edges.push(edge);
        }
        (vertices, edges)
    }
}

fn sorted([a, b]: [u32; 2]) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

fn edge_key(torus: &Torus, ends: [u32; 2]) -> EdgeKey {
    let from = |[own, other]: [u32; 2]| {
        let Moved { original, translation } = torus.vertices[own as usize];
        (original, torus.seen(other, translation))
    };
    from(ends).min(from([ends[1], ends[0]]))
}

/// The vertices of a copy of a line in the line's order, and the translation from the line.
fn aligned(torus: &Torus, line: &[u32], copy: Vec<u32>) -> (Vec<u32>, Translation) {
    let fits = |copy: &[u32]| {
        let translation =
            torus.vertices[copy[0] as usize].translation - torus.vertices[line[0] as usize].translation;
        let is_alike = |(own, other): (&u32, &u32)| {
            torus.seen(*other, translation) == torus.seen(*own, Translation::ZERO)
        };
        line.iter().zip(copy).all(is_alike).then_some(translation)
    };
    let is_closed = copy[0] == copy[copy.len() - 1];
    let turns = if is_closed { copy.len() - 1 } else { 1 };
    for turn in 0..turns {
        let mut turned = copy.clone();
        if is_closed {
            turned.pop();
            turned.rotate_left(turn);
            turned.push(turned[0]);
        }
        for _ in 0..2 {
            if let Some(translation) = fits(&turned) {
                return (turned, translation);
            }
            turned.reverse();
        }
    }
    unreachable!("copies of an edge are parts of copies of one line")
}
