//! Control points that move as one.

use glam::DVec3;
use rayon::prelude::*;
use subzero::EdgeId;

use crate::energy::patches::Patches;
use crate::flow::pressure_response::CHUNK;
use crate::mesh::disjoint_sets::DisjointSets;
use crate::mesh::grouped::Grouped;
use crate::{Freedom, Level, Mesh, NetworkError};

/// Attempts at a step, each with what the last one broke moving as one.
const ATTEMPTS: usize = 24;

/// Attempts after which all displacements are halved with every other one: what moves at all may be too much.
const WHOLE_ATTEMPTS: usize = 12;

/// Groups of control points that are displaced by the same vector, so that what lies between them keeps its shape.
///
/// Under curvature flow a feature of size l lives for a time of order l^2: one much smaller than a step would turn inside
/// out within it. Rigid groups take such features out of the flow without taking them out of the network.
#[derive(Debug, Clone)]
pub(crate) struct TiedPoints(DisjointSets);

impl TiedPoints {
    /// Every point of a level on its own, but for those that are others moved by whole periods.
    pub(crate) fn new(level: &Level) -> Self {
        let mut groups = Self::apart(level.vertex_count());
        level.copies.vertices.iter().for_each(|pair| groups.0.join(pair.secondary, pair.primary));
        groups
    }

    /// So many points, each on its own.
    pub(crate) fn apart(count: usize) -> Self {
        Self(DisjointSets::new(count))
    }

    /// All but the groups that walls hold to a line or altogether, and that had some of their points before and now have more: they break what is around, which moves on, and would grow
    /// until nothing there moves.
    pub(crate) fn without_grown_at_walls(
        &self,
        before: &Self,
        level: &Level,
        of_point: impl Fn(u32) -> Freedom,
    ) -> Self {
        let own = Self::new(level);
        let mut left = own.clone();
        for group in self.0.of_several() {
            let parts = before.0.set_count(&group);
            let has_grown = 1 < parts && parts < own.0.set_count(&group);
            let is_held = matches!(freedom(&group, &of_point), Freedom::Along(_) | Freedom::Nowhere);
            if !(has_grown && is_held) {
                left.join_all(&group);
            }
        }
        left
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

    /// Gives all points of each group the mean of their displacements, for an attempt that is counted from 0.
    fn unite(&self, moves: &mut [DVec3], of_point: impl Fn(u32) -> Freedom, attempt: usize) {
        for group in self.0.of_several() {
            let sum: DVec3 = group.iter().map(|point| moves[*point as usize]).sum();
            let mean = freedom(&group, &of_point).project(sum / group.len() as f64);
            group.iter().for_each(|point| moves[*point as usize] = mean);
        }
        if attempt >= WHOLE_ATTEMPTS {
            moves.iter_mut().for_each(|by| *by *= 0.5);
        }
    }

    /// Where points are after displacements, of which those that would break something give way: all points that it depends on move as one.
    ///
    /// `broken` gives these points, for each place that is broken with all points where it is told.
    ///
    /// # Errors
    /// [`NetworkError::Folded`] where something is still broken after all attempts.
    pub(crate) fn moved_unbroken<P: AsRef<[u32]>>(
        &mut self,
        points: &[DVec3],
        mut moves: Vec<DVec3>,
        freedom: impl Fn(u32) -> Freedom,
        mut broken: impl FnMut(&[DVec3]) -> Vec<P>,
    ) -> Result<Vec<DVec3>, NetworkError> {
        self.unite(&mut moves, &freedom, 0);
        let mut count = 0;
        for attempt in 0..ATTEMPTS {
            let pairs = points.par_iter().zip(&moves).with_min_len(CHUNK);
            let moved: Vec<DVec3> = pairs.map(|(point, by)| *point + *by).collect();
            let broken = broken(&moved);
            count = broken.len();
            if count == 0 {
                return Ok(moved);
            }
            broken.iter().for_each(|points| self.join_all(points.as_ref()));
            self.unite(&mut moves, &freedom, attempt);
        }
        Err(NetworkError::Folded { count, grains: Vec::new() })
    }

    /// Numbers the groups from 0, in order of their smallest points.
    pub(crate) fn number(&self) -> Numbering {
        let (numbers, count) = self.0.numbers();
        let members = numbers.iter().map(|number| *number as usize).zip(0u32..);
        let members = Grouped::new(count as usize, members);
        Numbering { numbers, members }
    }
}

/// TiedPoints by number.
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

    /// The displacement of each control point, given those of the groups.
    pub(crate) fn of_points(&self, of_groups: &[DVec3]) -> Vec<DVec3> {
        let numbers = self.numbers.par_iter().with_min_len(CHUNK);
        numbers.map(|number| of_groups[*number as usize]).collect()
    }

    /// How the points of a group can move as one, given how each can.
    pub(crate) fn freedom(&self, group: usize, of_point: impl Fn(u32) -> Freedom) -> Freedom {
        freedom(self.members(group), of_point)
    }

    /// The control points of a group.
    pub(crate) fn members(&self, group: usize) -> &[u32] {
        self.members.of(group)
    }
}

fn freedom(group: &[u32], of_point: impl Fn(u32) -> Freedom) -> Freedom {
    group.iter().map(|point| of_point(*point)).fold(Freedom::Everywhere, Freedom::and)
}
