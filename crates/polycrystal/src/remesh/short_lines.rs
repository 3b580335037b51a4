//! Lines that became points, and what became of their ends.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec3;
use voronoi::Translation;

use crate::mesh::node_type::Meeting;
use crate::network::merged::MergedSides;
use crate::remesh::torus::{Moved, Torus};
use crate::{BoundaryId, GrainId, Network, Side};

/// A line that became a point.
#[derive(Debug, Clone, PartialEq)]
pub struct MergedLine {
    /// Where the point was put, before volumes were restored.
    pub place: DVec3,
    /// Of the line.
    pub length: f64,
    /// The grains that meet at the point.
    pub grains: Vec<GrainId>,
}

/// Which lines become points, and what becomes of their ends.
#[derive(Debug, Default)]
pub(crate) struct ShortLines {
    /// The lines that become points.
    pub(super) lines: BTreeSet<u32>,
    /// Of each end that goes, by number of originals, the one that stays.
    pub(super) gone: BTreeMap<u32, Moved<u32>>,
    /// Where those that stay are put.
    pub(super) places: BTreeMap<u32, DVec3>,
    pub(crate) merged: Vec<MergedLine>,
    pub(crate) sides: Vec<MergedSides>,
}

impl ShortLines {
    /// Whether a line becomes a point.
    pub(crate) fn has(&self, line: u32) -> bool {
        self.lines.contains(&line)
    }

    /// Whether a node, by number of originals, becomes another one.
    pub(crate) fn is_gone(&self, original: u32) -> bool {
        self.gone.contains_key(&original)
    }

    /// The node that one becomes.
    pub(crate) fn node(&self, node: Moved<u32>) -> Moved<u32> {
        self.gone.get(&node.original).map_or(node, |kept| Moved {
            original: kept.original,
            translation: kept.translation + node.translation,
        })
    }

    /// Where a node that stays is put; nothing where it stays in its place.
    pub(crate) fn place(&self, original: u32) -> Option<DVec3> {
        self.places.get(&original).copied()
    }

    /// The nodes that stay in place of a line, by number of originals.
    pub(crate) fn staying(&self) -> impl Iterator<Item = u32> + '_ {
        self.places.keys().copied()
    }

    /// Two ends of a line on the torus, in order, as seen from one of them.
    pub(crate) fn ends(&self, ends: [u32; 2], torus: &Torus) -> [Moved<u32>; 2] {
        let [start, end] = ends.map(|end| self.node(torus.vertices[end as usize]));
        let from = |own: Moved<u32>, other: Moved<u32>| {
            let translation = other.translation - own.translation;
            [Moved { translation: Translation::ZERO, ..own }, Moved { translation, ..other }]
        };
        from(start, end).min(from(end, start))
    }
}

/// What meets at the points that lines became, some originals and their copies, as the new boundaries there show it.
pub(crate) fn meetings_at(
    merged: &BTreeSet<u32>,
    network: &Network,
    corners: impl Iterator<Item = (Moved<u32>, BoundaryId)>,
) -> BTreeMap<Moved<u32>, Meeting> {
    // In a periodic domain, what meets at copies meets at the original too, so far away.
    let is_periodic = network.domain().is_periodic();
    let seen_at = |point: Moved<u32>| match is_periodic {
        true => (Moved { translation: Translation::ZERO, ..point }, Translation::ZERO - point.translation),
        false => (point, Translation::ZERO),
    };
    let mut sides: BTreeMap<Moved<u32>, BTreeSet<(Side, Translation)>> = BTreeMap::new();
    let mut is_outer: BTreeMap<Moved<u32>, bool> = BTreeMap::new();
    for (point, boundary) in corners.filter(|(point, _)| merged.contains(&point.original)) {
        let boundary = &network.boundaries()[boundary.index()];
        *is_outer.entry(point).or_default() |= !boundary.is_interior();
        let (place, moved) = seen_at(point);
        for side in boundary.sides {
            match side {
                Side::Grain(_) => sides.entry(place).or_default().insert((side, moved)),
                Side::Exterior if boundary.twin.is_none() => {
                    sides.entry(place).or_default().insert((side, Translation::ZERO))
                }
                Side::Exterior => continue,
            };
        }
    }
    let meeting = |(point, is_outer): (Moved<u32>, bool)| {
        let sides = &sides[&seen_at(point).0];
        let grains = sides.iter().filter(|(side, _)| side.grain().is_some()).count();
        (point, Meeting::new(sides.len(), grains, is_outer))
    };
    is_outer.into_iter().map(meeting).collect()
}
