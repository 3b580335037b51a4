//! A boundary with the new points of its lines.

use std::collections::{BTreeMap, BTreeSet};

use subzero::FaceId;

use crate::mesh::disjoint_sets::DisjointSets;
use crate::mesh::id::id;
use crate::remesh::lines::DividedLine;
use crate::remesh::patch::Patch;
use crate::remesh::reference::Reference;
use crate::remesh::short_lines::ShortLines;
use crate::remesh::size_field::{SizeField, Surroundings};
use crate::remesh::skeleton::{LineEdge, Occurrence};
use crate::remesh::torus::Moved;

/// The points of the new network, as numbers of originals: nodes, then the points of each line, then those of each boundary.
#[derive(Debug)]
pub(crate) struct Numbering {
    /// Of each vertex that is an original and a node.
    nodes: BTreeMap<u32, u32>,
    /// The first of each line.
    first_of_line: Vec<u32>,
    /// Number of points on lines and at nodes.
    pub(crate) count: usize,
}

impl Numbering {
    pub(crate) fn new(around: &Surroundings<'_>, lines: &[DividedLine]) -> Self {
        let is_original = |vertex: &u32| {
            around.torus.vertices[*vertex as usize].original == *vertex && !around.short.is_gone(*vertex)
        };
        let nodes = (0u32..).zip(&around.skeleton.is_node).filter(|(_, is_node)| **is_node);
        let nodes: BTreeMap<u32, u32> = nodes.map(|(node, _)| node).filter(is_original).zip(0u32..).collect();
        let mut count = nodes.len();
        let mut first_of_line = Vec::with_capacity(lines.len());
        for (line, divided) in around.skeleton.lines.iter().zip(lines) {
            first_of_line.push(id(count));
            count += divided.points.len() + usize::from(is_loop(line.vertices[0], line.is_closed(), around));
        }
        Self { nodes, first_of_line, count }
    }

    /// The nodes: the vertex of each.
    pub(crate) fn nodes(&self) -> impl Iterator<Item = u32> {
        self.nodes.keys().copied()
    }

    /// The points that short lines became.
    pub(crate) fn merged(&self, short: &ShortLines) -> BTreeSet<u32> {
        short.staying().map(|node| self.nodes[&node]).collect()
    }

    /// The new points of an occurrence of a line, from end to end; a single one where the line becomes a point.
    pub(crate) fn along(
        &self,
        around: &Surroundings<'_>,
        occurrence: &Occurrence,
        count: usize,
    ) -> Vec<Moved<u32>> {
        let first = self.first_of_line[occurrence.line as usize];
        let inner =
            (0..id(count)).map(|k| Moved { original: first + k, translation: occurrence.translation });
        let (start, end) = (occurrence.vertices[0], occurrence.vertices[occurrence.vertices.len() - 1]);
        // The start of a closed line is numbered after its other points.
        let start_of_loop = Moved { original: first + id(count), translation: occurrence.translation };
        let end_point = |vertex: u32| {
            let Moved { original, translation } = around.node(vertex);
            self.nodes.get(&original).map_or(start_of_loop, |node| Moved { original: *node, translation })
        };
        if around.short.has(occurrence.line) {
            return vec![end_point(start)];
        }
        std::iter::once(end_point(start)).chain(inner).chain([end_point(end)]).collect()
    }
}

/// Whether a line is closed without a node on it.
pub(crate) fn is_loop(start: u32, is_closed: bool, around: &Surroundings<'_>) -> bool {
    is_closed && !around.skeleton.is_node[start as usize]
}

/// A boundary whose outline has the new points, and inside it all smooth ones.
pub(crate) struct Outlined {
    pub(crate) patch: Patch,
    pub(crate) reference: Reference,
    /// A triangle of the reference at each point of the patch.
    pub(crate) near: Vec<u32>,
    /// The new points by the number in the patch.
    pub(crate) keys: BTreeMap<u32, Moved<u32>>,
}

/// A directed edge of the outline.
#[derive(Debug, Clone, Copy)]
struct Step {
    to: u32,
    edge: LineEdge,
}

impl Outlined {
    /// The boundary of some triangles, with the smooth points of its lines gone to the new ones.
    pub(crate) fn new(
        around: &Surroundings<'_>,
        triangles: &[u32],
        sizes: &SizeField,
        lines: &[DividedLine],
        numbering: &Numbering,
        position: impl Fn(Moved<u32>) -> glam::DVec3,
    ) -> Self {
        let (corners, vertices) = own_corners(around, triangles);
        let points: Vec<_> = vertices.iter().map(|vertex| around.points[*vertex as usize]).collect();
        let of_points = vertices.iter().map(|vertex| sizes.at(*vertex)).collect();
        let mut near = vec![0; points.len()];
        let mut steps: BTreeMap<u32, Step> = BTreeMap::new();
        for (own, triangle) in (0u32..).zip(triangles) {
            let local = corners[own as usize];
            local.iter().for_each(|corner| near[*corner as usize] = own);
            for (k, edge) in around.mesh.triangle_edges(FaceId(*triangle)).into_iter().enumerate() {
                if let Some(edge) = around.skeleton.of_edge[edge.index()] {
                    steps.insert(local[k], Step { to: local[(k + 1) % 3], edge });
                }
            }
        }
        let mut lines_of: Vec<Vec<u32>> = vec![Vec::new(); points.len()];
        for (from, step) in &steps {
            for end in [*from, step.to] {
                let lines = &mut lines_of[end as usize];
                if !lines.contains(&step.edge.occurrence) {
                    lines.push(step.edge.occurrence);
                }
            }
        }
        let patch = Patch::new(points.clone(), lines_of, &corners);
        let reference = Reference::new(points, of_points, corners, sizes.gradation);
        let mut outlined = Self { patch, reference, near, keys: BTreeMap::new() };
        let starts = |from: u32| starts_line(around, vertices[from as usize], &steps[&from]);
        let is_point = |run: &Vec<(u32, LineEdge)>| {
            around.short.has(around.skeleton.occurrences[run[0].1.occurrence as usize].line)
        };
        let (points, runs): (Vec<_>, Vec<_>) = runs(steps.clone(), starts).into_iter().partition(is_point);
        let mut merged = BTreeMap::new();
        for run in points {
            let [stays, goes] = outlined.close(around, &run, numbering, &position);
            merged.insert(goes, stays);
        }
        for run in runs {
            let (start, edge) = run[0];
            let mut points: Vec<u32> =
                run.iter().map(|(point, _)| *merged.get(point).unwrap_or(point)).collect();
            let vertices_along = &around.skeleton.occurrences[edge.occurrence as usize].vertices;
            if vertices_along[edge.step as usize] != vertices[start as usize] {
                points.reverse();
            }
            outlined.reduce(around, (&points, edge.occurrence), lines, numbering, &position);
        }
        outlined
    }

    /// Moves the points of one line, in its order, to the new ones: the nearest smooth point takes the place of each, and others close into these.
    fn reduce(
        &mut self,
        around: &Surroundings<'_>,
        (points, number): (&[u32], u32),
        lines: &[DividedLine],
        numbering: &Numbering,
        position: &impl Fn(Moved<u32>) -> glam::DVec3,
    ) {
        let occurrence = &around.skeleton.occurrences[number as usize];
        let line = &lines[occurrence.line as usize];
        let mut fine = vec![points[0]];
        for (ends, parts) in points.windows(2).zip(&line.parts) {
            let (mut from, to) = (ends[0], ends[1]);
            for part in 1..*parts {
                let share = 1.0 / (parts + 1 - part) as f64;
                let place = self.patch.place(from).lerp(self.patch.place(to), share);
                from = self.patch.split([from, to], place, vec![number]);
                self.near.push(self.near[to as usize]);
                fine.push(from);
            }
            fine.push(to);
        }
        for (which, stays) in line.staying.iter().enumerate() {
            let stays = *stays as usize;
            let goes = |point: usize| line.goes_to.get(point).is_some_and(|to| *to as usize == which);
            for point in (stays + 1..fine.len()).take_while(|point| goes(*point)) {
                self.close_into([fine[point], fine[stays]]);
            }
            for point in (0..stays).rev().take_while(|point| goes(*point)) {
                self.close_into([fine[point], fine[stays]]);
            }
        }
        let keys = numbering.along(around, occurrence, line.points.len());
        for (stays, key) in line.staying.iter().zip(keys) {
            let point = fine[*stays as usize];
            self.patch.points[point as usize] = position(key);
            self.keys.insert(point, key);
        }
    }

    /// Closes a line into one of its ends; returns that and the other.
    fn close(
        &mut self,
        around: &Surroundings<'_>,
        run: &[(u32, LineEdge)],
        numbering: &Numbering,
        position: &impl Fn(Moved<u32>) -> glam::DVec3,
    ) -> [u32; 2] {
        let [stays, goes] = [run[0].0, run[run.len() - 1].0];
        let number = run[0].1.occurrence;
        run[1..].iter().for_each(|(point, _)| self.close_into([*point, stays]));
        let of_other = std::mem::take(&mut self.patch.lines[goes as usize]);
        let lines = &mut self.patch.lines[stays as usize];
        lines.extend(of_other);
        lines.retain(|line| *line != number);
        let key = numbering.along(around, &around.skeleton.occurrences[number as usize], 0)[0];
        self.patch.points[stays as usize] = position(key);
        self.keys.insert(stays, key);
        [stays, goes]
    }

    /// Collapses an edge of the outline, after what it would pinch is halved.
    fn close_into(&mut self, ends: [u32; 2]) {
        for between in self.patch.pinched(ends) {
            let is_inner = |end: &u32| self.patch.at_edge([*end, between]).len() == 2;
            let Some(end) = ends.into_iter().find(is_inner) else { continue };
            let place = self.patch.place(end).midpoint(self.patch.place(between));
            self.patch.split([end, between], place, Vec::new());
            self.near.push(self.near[between as usize]);
        }
        self.patch.collapse(ends);
    }
}

/// The triangles of a boundary by points of its own, and the vertex of each such point. A vertex at which the boundary touches itself is several points.
fn own_corners(around: &Surroundings<'_>, triangles: &[u32]) -> (Vec<[u32; 3]>, Vec<u32>) {
    let mut fans = DisjointSets::new(3 * triangles.len());
    let corners_of = |triangle: u32| around.mesh.triangles()[triangle as usize];
    let find = |triangle: u32, vertex: u32| {
        let own = triangles.binary_search(&triangle).ok()?;
        let k = corners_of(triangle).iter().position(|corner| *corner == vertex)?;
        Some(id(3 * own + k))
    };
    for triangle in triangles {
        for edge in around.mesh.triangle_edges(FaceId(*triangle)) {
            if around.skeleton.of_edge[edge.index()].is_some() {
                continue;
            }
            let Some([first, second]) =
                around.mesh.edge_triangles(edge).map(|pair| pair.map(|triangle| triangle.0))
            else {
                continue;
            };
            for vertex in around.mesh.edge(edge) {
                if let (Some(one), Some(other)) = (find(first, vertex), find(second, vertex)) {
                    fans.join(one, other);
                }
            }
        }
    }
    let mut numbers = vec![None; 3 * triangles.len()];
    let mut vertices = Vec::new();
    let corners = (0u32..).zip(triangles).map(|(own, triangle)| {
        let mut k = 0;
        corners_of(*triangle).map(|vertex| {
            let root = fans.root(3 * own + k);
            k += 1;
            *numbers[root as usize].get_or_insert_with(|| {
                vertices.push(vertex);
                id(vertices.len() - 1)
            })
        })
    });
    let corners = corners.collect();
    (corners, vertices)
}

/// Whether a line starts with a step of the outline: at a node, or where the line of a loop does.
fn starts_line(around: &Surroundings<'_>, vertex: u32, step: &Step) -> bool {
    let vertices = &around.skeleton.occurrences[step.edge.occurrence as usize].vertices;
    around.skeleton.is_node[vertex as usize] || vertices[0] == vertex
}

/// The outline, line by line: the points of each, with the edge after each point; the last one with the edge before it.
fn runs(mut steps: BTreeMap<u32, Step>, starts: impl Fn(u32) -> bool) -> Vec<Vec<(u32, LineEdge)>> {
    let mut runs = Vec::new();
    let first: Vec<u32> = steps.keys().copied().filter(|from| starts(*from)).collect();
    for start in first {
        let mut run = Vec::new();
        let mut at = start;
        while let Some(step) = steps.remove(&at) {
            run.push((at, step.edge));
            at = step.to;
            if starts(at) {
                break;
            }
        }
        let Some((_, last)) = run.last().copied() else { continue };
        run.push((at, last));
        runs.push(run);
    }
    runs
}
