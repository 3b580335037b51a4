//! Points of whole grains, where a map repeats: each once in the box, and copies of it at grains that are whole elsewhere.

use std::borrow::Cow;

use glam::DVec3;
use voronoi::{PeriodicVertex, Translation};

use crate::BoundaryId;
use crate::mesh::id::id;
use crate::voxels::staircase::Kind;

/// The points that follow those of the lattice, each of which is one of them moved by whole periods; none where the lattice has no periods.
#[derive(Debug, Clone, Default)]
pub(super) struct Copies {
    /// Number of points that are no copies.
    count: usize,
    /// What each copy is, in order.
    all: Vec<PeriodicVertex>,
    /// Lengths of the periods in voxels.
    periods: DVec3,
}

impl Copies {
    /// No copies of so many points.
    pub(super) fn none(count: usize) -> Self {
        Self { count, ..Self::default() }
    }

    /// The elements around whole grains: first those given, each where its first side is whole; then, of those whose sides are periods apart, a copy where the second one is.
    ///
    /// Kinds of copies follow the others, in the same order.
    pub(super) fn unwrapped<const N: usize>(
        count: usize,
        periods: DVec3,
        elements: &[[PeriodicVertex; N]],
        kind_of: &mut Vec<BoundaryId>,
        kinds: &[Kind],
    ) -> (Vec<[u32; N]>, Self) {
        let mut at_second = Vec::new();
        for (corners, kind) in elements.iter().zip(kind_of.clone()) {
            let beyond = kinds[kind.index()].beyond;
            if beyond != Translation::ZERO {
                at_second.push(corners.map(|corner| corner.moved(Translation::ZERO - beyond)));
                kind_of.push(BoundaryId(id(kinds.len() + kind.index())));
            }
        }
        let corners = || elements.iter().chain(&at_second);
        let mut all: Vec<PeriodicVertex> =
            corners().flatten().filter(|corner| corner.translation != Translation::ZERO).copied().collect();
        all.sort_unstable();
        all.dedup();
        let copies = Self { count, all, periods };
        let numbered = |corners: &[PeriodicVertex; N]| corners.map(|corner| copies.number(corner));
        (corners().map(numbered).collect(), copies)
    }

    fn number(&self, vertex: PeriodicVertex) -> u32 {
        if vertex.translation == Translation::ZERO {
            return vertex.vertex;
        }
        id(self.count + self.all.binary_search(&vertex).expect("all copies are listed"))
    }

    /// The point of the lattice that a point is, and by how many periods it is moved.
    pub(super) fn vertex(&self, point: u32) -> PeriodicVertex {
        match (point as usize).checked_sub(self.count) {
            Some(copy) => self.all[copy],
            None => PeriodicVertex { vertex: point, translation: Translation::ZERO },
        }
    }

    /// The point of the lattice that a point is a copy of, or is.
    pub(super) fn original(&self, point: u32) -> u32 {
        self.vertex(point).vertex
    }

    /// Where a point of the lattice is, moved by whole periods.
    pub(super) fn position(points: &[DVec3], vertex: PeriodicVertex, periods: DVec3) -> DVec3 {
        points[vertex.vertex as usize] + DVec3::from_array(vertex.translation.0.map(f64::from)) * periods
    }

    /// The points of the lattice with their copies behind.
    pub(super) fn with_copies<'a>(&self, points: &'a [DVec3]) -> Cow<'a, [DVec3]> {
        if self.all.is_empty() {
            return Cow::Borrowed(points);
        }
        let copies = self.all.iter().map(|copy| Self::position(points, *copy, self.periods));
        Cow::Owned(points.iter().copied().chain(copies).collect())
    }
}

/// From one point of the lattice to another that is near it, through the sides of the box along periods.
pub(super) fn across(periods: DVec3, from: DVec3, to: DVec3) -> DVec3 {
    let straight = to - from;
    let whole = (straight / periods.max(DVec3::splat(f64::MIN_POSITIVE))).round() * periods;
    DVec3::select(periods.cmpgt(DVec3::ZERO), straight - whole, straight)
}
