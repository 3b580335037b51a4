//! What is left of a network whose short lines became points.

use std::collections::BTreeMap;

use voronoi::Dimension;

use crate::mesh::boundary::Twin;
use crate::mesh::id::id;
use crate::network::control_mesh::JunctionCounts;
use crate::{BoundaryId, Network};

/// Numbers of sides that meet along a line which became a point, at both its ends, and at that point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct MergedSides {
    pub(crate) line: u8,
    pub(crate) ends: [u8; 2],
    pub(crate) point: u8,
}

impl JunctionCounts {
    /// Counts points in place of lines.
    fn merge(&mut self, merged: &[MergedSides], dimension: Dimension) {
        for MergedSides { line, ends, point } in merged {
            let (lines, new_lines) = match dimension {
                Dimension::Two => (&ends[..], Some(*point)),
                Dimension::Three => (std::slice::from_ref(line), None),
            };
            exchange(&mut self.lines_by_sides, lines, new_lines.filter(|sides| *sides >= 3));
            exchange(&mut self.points_by_sides, ends, Some(*point).filter(|sides| *sides >= 4));
        }
        self.triple_lines = self.lines_by_sides.values().sum();
        self.quadruple_points = self.points_by_sides.values().sum();
    }
}

/// Counts one place instead of others. Places with fewer sides than those counted are none of them.
fn exchange(counts: &mut BTreeMap<u8, usize>, gone: &[u8], new: Option<u8>) {
    for sides in gone {
        if let Some(count) = counts.get_mut(sides) {
            *count -= 1;
        }
    }
    counts.retain(|_, count| *count > 0);
    if let Some(sides) = new {
        *counts.entry(sides).or_default() += 1;
    }
}

impl Network {
    /// The network, of one level, after lines became points. In the plane boundaries may have gone with them: those that are left keep their order.
    pub(crate) fn with_merged_lines(mut self, merged: &[MergedSides]) -> Self {
        if merged.is_empty() {
            return self;
        }
        self.junctions.merge(merged, self.domain.dimension());
        let mut is_left = vec![false; self.boundaries.len()];
        self.levels.iter().flat_map(|level| &level.boundary_of).for_each(|own| is_left[own.index()] = true);
        let mut numbers = Vec::with_capacity(is_left.len());
        let mut count = 0;
        for is_left in &is_left {
            numbers.push(BoundaryId(id(count)));
            count += usize::from(*is_left);
        }
        let new = |old: BoundaryId| numbers[old.index()];
        let lasting = |index: &usize| is_left[*index];
        let kept: Vec<usize> = (0..is_left.len()).filter(lasting).collect();
        self.boundaries = kept
            .iter()
            .map(|index| {
                let mut boundary = self.boundaries[*index];
                boundary.twin = boundary.twin.map(|twin| Twin { boundary: new(twin.boundary), ..twin });
                boundary
            })
            .collect();
        self.tensions = kept.iter().map(|index| self.tensions[*index]).collect();
        self.mobilities = kept.iter().map(|index| self.mobilities[*index]).collect();
        self.levels.iter_mut().flat_map(|level| &mut level.boundary_of).for_each(|own| *own = new(*own));
        self
    }
}
