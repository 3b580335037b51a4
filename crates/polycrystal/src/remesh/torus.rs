//! Which vertices are others moved by whole periods.

use std::collections::BTreeMap;

use glam::{BVec3, DVec3};
use voronoi::{PeriodicPair, PeriodicVertex, Translation};

use crate::{Level, Network, NetworkError};

/// A vertex, or a part of a boundary, and the periods that lead from it to what it stands for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(crate) struct Moved<Id> {
    pub(crate) original: Id,
    pub(crate) translation: Translation,
}

/// Points as seen from the least of them, which is no other way the same at any copy, and the periods that lead there.
pub(crate) fn seen_from_least<const N: usize>(mut points: [Moved<u32>; N]) -> ([Moved<u32>; N], Translation) {
    points.sort_unstable();
    let from = points[0].translation;
    (points.map(|point| Moved { translation: point.translation - from, ..point }), from)
}

/// The copies of a network.
///
/// In a periodic network they are known. Where one was cut at its box, they are what has the same coordinates, bit for bit, on opposite walls.
#[derive(Debug)]
pub(crate) struct Torus {
    /// Of each vertex of the finest level.
    pub(crate) vertices: Vec<Moved<u32>>,
}

impl Torus {
    /// The copies of a network that repeats along some axes: its own, or those of the network that was cut at the box.
    pub(crate) fn new(
        network: &Network,
        level: &Level,
        points: &[DVec3],
        cut: BVec3,
    ) -> Result<Self, NetworkError> {
        if !cut.any() || network.domain().is_periodic() {
            return Ok(Self::of_copies(level));
        }
        Self::of_walls(network, points, cut)
    }

    fn of_copies(level: &Level) -> Self {
        let moved =
            |original: PeriodicVertex| Moved { original: original.vertex, translation: original.translation };
        let vertices = level.copies.originals(level.vertex_count()).into_iter().map(moved).collect();
        Self { vertices }
    }

    /// Points on upper walls are copies of those on lower ones.
    fn of_walls(network: &Network, points: &[DVec3], cut: BVec3) -> Result<Self, NetworkError> {
        let domain = network.domain();
        let (lower, upper) = (domain.lower(), domain.upper());
        let bits = |point: DVec3| point.to_array().map(|coordinate| (coordinate + 0.0).to_bits());
        let by_place: BTreeMap<[u64; 3], u32> = (0u32..)
            .zip(points)
            .filter(|(_, point)| (0..3).any(|axis| cut.test(axis) && point[axis] == lower[axis]))
            .map(|(vertex, point)| (bits(*point), vertex))
            .collect();
        let mut vertices = Vec::with_capacity(points.len());
        for (vertex, point) in (0u32..).zip(points) {
            let (mut below, mut translation) = (*point, Translation::ZERO);
            for axis in (0..3).filter(|axis| cut.test(*axis) && point[*axis] == upper[*axis]) {
                below[axis] = lower[axis];
                translation.0[axis] = 1;
            }
            let original = if translation == Translation::ZERO {
                Some(vertex)
            } else {
                by_place.get(&bits(below)).copied()
            };
            let original = original.ok_or(NetworkError::NoCopyOnWall { point: vertex })?;
            vertices.push(Moved { original, translation });
        }
        Ok(Self { vertices })
    }

    /// The vertex, as seen from where the translation leads.
    pub(crate) fn seen(&self, vertex: u32, from: Translation) -> Moved<u32> {
        let Moved { original, translation } = self.vertices[vertex as usize];
        Moved { original, translation: translation - from }
    }
}

impl Network {
    /// The vertices of the finest level that stand for others, whole periods away, for its points: known copies of a periodic network, or, along the axes of `cut`, the
    /// points on the upper walls of one that was cut at its box. No original is a copy itself.
    ///
    /// # Errors
    /// [`NetworkError::NoCopyOnWall`] where opposite walls are not alike.
    ///
    /// # Panics
    /// When there is not one point per vertex.
    pub fn periodic_vertices(
        &self,
        points: &[DVec3],
        cut: BVec3,
    ) -> Result<Vec<PeriodicPair<u32>>, NetworkError> {
        assert_eq!(points.len(), self.finest().vertex_count(), "there must be one point per vertex");
        let torus = Torus::new(self, &self.finest_level(), points, cut)?;
        let vertices =
            (0u32..).zip(torus.vertices).filter(|(_, moved)| moved.translation != Translation::ZERO);
        let pair = |(secondary, Moved { original, translation }): (u32, Moved<u32>)| PeriodicPair {
            secondary,
            primary: original,
            translation,
        };
        Ok(vertices.map(pair).collect())
    }
}
