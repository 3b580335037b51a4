//! Control points that move as one.

use glam::DVec3;
use rayon::prelude::*;
use subzero::EdgeId;

use crate::energy::patches::Patches;
use crate::flow::pressure_response::CHUNK;
use crate::mesh::disjoint_sets::DisjointSets;
use crate::mesh::grouped::Grouped;
use crate::{Freedom, Level, Mesh};

/// Groups of control points that are displaced by the same vector, so that what lies between them keeps its shape.
///
/// Under curvature flow a feature of size l lives for a time of order l^2: one much smaller than a step would turn inside
/// out within it. Rigid groups take such features out of the flow without taking them out of the network.
#[derive(Debug, Clone)]
pub(crate) struct TiedPoints(DisjointSets);

impl TiedPoints {
    /// Every point of a level on its own, but for those that are others moved by whole periods.
    pub(crate) fn new(level: &Level) -> Self {
        let mut groups = Self(DisjointSets::new(level.vertex_count()));
        level.copies.vertices.iter().for_each(|pair| groups.0.join(pair.secondary, pair.primary));
        groups
    }

    /// Makes some control points move as one.
    pub(crate) fn join_all(&mut self, points: &[u32]) {
        points.windows(2).for_each(|pair| self.0.join(pair[0], pair[1]));
    }

    /// Joins the ends of all edges of a mesh that are shorter than `length` times the smaller of the sizes at their ends.
    pub(crate) fn join_short_edges(&mut self, mesh: &Mesh, points: &[DVec3], sizes: &[f64], length: f64) {
        let is_short = |[a, b]: &[u32; 2]| {
            let size = sizes[*a as usize].min(sizes[*b as usize]);
            points[*a as usize].distance(points[*b as usize]) < length * size
        };
        let short: Vec<[u32; 2]> = match mesh {
            Mesh::Triangles(mesh) => {
                let edges = (0..mesh.counts().edges).into_par_iter();
                edges.map(|edge| mesh.edge(EdgeId(edge))).filter(is_short).collect()
            }
            Mesh::Segments(mesh) => mesh.segments().iter().copied().filter(is_short).collect(),
        };
        short.iter().for_each(|[a, b]| self.0.join(*a, *b));
    }

    /// Numbers the groups from 0, in order of their smallest points.
    pub(crate) fn number(&self) -> Numbering {
        let (numbers, count) = self.0.numbers();
        let members = numbers.iter().map(|number| *number as usize).zip(0u32..);
        let members = Grouped::new(count as usize, members);
        Numbering { numbers, members }
    }
}

/// Tied points by number.
pub(crate) struct Numbering {
    numbers: Vec<u32>,
    /// The control points of each group.
    members: Grouped<u32>,
}

impl Numbering {
    /// The places of all control points of a group in some patches.
    #[inline]
    pub(crate) fn places<'a>(&'a self, group: usize, patches: &'a Patches) -> impl Iterator<Item = u32> + 'a {
        let members = self.members(group).iter();
        members.flat_map(|point| patches.places_of_point(*point).iter().copied())
    }

    pub(crate) fn group_count(&self) -> usize {
        self.members.count()
    }

    /// The group of each control point.
    pub(crate) fn numbers(&self) -> &[u32] {
        &self.numbers
    }

    /// The groups of some control points.
    pub(crate) fn of(&self, points: impl IntoIterator<Item = u32>) -> Vec<u32> {
        points.into_iter().map(|point| self.numbers[point as usize]).collect()
    }

    /// The displacement of each control point, given those of the groups.
    pub(crate) fn of_points(&self, of_groups: &[DVec3]) -> Vec<DVec3> {
        let numbers = self.numbers.par_iter().with_min_len(CHUNK);
        numbers.map(|number| of_groups[*number as usize]).collect()
    }

    /// The mean displacement of the points of each group, as far as all of them can move so; given those of points and how each can move.
    pub(crate) fn means(&self, of_points: &[DVec3], freedom: impl Fn(u32) -> Freedom + Sync) -> Vec<DVec3> {
        let mean = |group: usize| {
            let members = self.members(group);
            let sum: DVec3 = members.iter().map(|point| of_points[*point as usize]).sum();
            self.freedom(group, &freedom).project(sum / members.len() as f64)
        };
        (0..self.group_count()).into_par_iter().with_min_len(CHUNK).map(mean).collect()
    }

    /// How the points of a group can move as one, given how each can.
    pub(crate) fn freedom(&self, group: usize, of_point: impl Fn(u32) -> Freedom) -> Freedom {
        let freedoms = self.members(group).iter().map(|point| of_point(*point));
        freedoms.fold(Freedom::Everywhere, Freedom::and)
    }

    /// The control points of a group.
    pub(crate) fn members(&self, group: usize) -> &[u32] {
        self.members.of(group)
    }
}
