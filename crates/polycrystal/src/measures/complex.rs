use std::borrow::Cow;

use rayon::prelude::*;
use voronoi::PeriodicVertex;

use crate::mesh::adjacency::{Adjacency, Incidence, Inner, by_edge, by_edge_in_parallel};
use crate::mesh::angles::{DihedralSector, WeightedAngle, angles, dihedral_sectors};
use crate::{BoundaryId, Elements, LevelView, Network, Side, Surface};

/// A surface with every edge once: in a periodic network without what is a copy of something else, and with the grains
/// beyond the period as sides.
pub(crate) struct Complex<'a> {
    pub(crate) surface: Surface<'a>,
    /// The two sides of each boundary.
    pub(crate) sides: Cow<'a, [[Side; 2]]>,
    /// The tension of each boundary.
    pub(crate) tensions: Cow<'a, [f64]>,
    /// Of each boundary the one that it is a copy of, or itself.
    pub(crate) originals: Vec<BoundaryId>,
    /// Of each point the one that it is a copy of; empty where there are no copies.
    points: Vec<u32>,
    /// The pairs of elements at edges inside boundaries, copies among them.
    inner: Inner<'a>,
    /// The incidences of all other edges, sorted by edge.
    incidences: Vec<Incidence>,
}

impl<'a> Complex<'a> {
    /// Any surface. Tensions are 1 between grains, and 0 at the exterior.
    pub(crate) fn of_surface(surface: &Surface<'a>) -> Self {
        let Adjacency { inner, incidences } = Adjacency::of_elements(surface.elements, surface.boundary_of);
        let originals = (0u32..).take(surface.sides.len()).map(BoundaryId).collect();
        let sides = Cow::Borrowed(surface.sides);
        let tension = |sides: &[Side; 2]| if sides.contains(&Side::Exterior) { 0.0 } else { 1.0 };
        let tensions = surface.sides.iter().map(tension).collect();
        Self { surface: *surface, sides, tensions, originals, points: Vec::new(), inner, incidences }
    }

    /// A level of a network, whose surface this is.
    pub(crate) fn of_level(network: &'a Network, level: LevelView<'a>, surface: &Surface<'a>) -> Self {
        let Adjacency { inner, mut incidences } = Adjacency::of_level(level);
        let boundaries = network.boundaries();
        let originals: Vec<BoundaryId> = (0u32..)
            .map(BoundaryId)
            .zip(boundaries)
            .map(|(id, boundary)| boundary.twin.map_or(id, |twin| twin.boundary.min(id)))
            .collect();
        let sides: Vec<[Side; 2]> = boundaries.iter().map(|at| at.sides_across(boundaries)).collect();
        let mut points = Vec::new();
        if network.domain().is_periodic() {
            incidences.retain(|at| {
                let boundary = surface.boundary(at.element);
                originals[boundary.index()] == boundary
            });
            let original_of = level.copies().originals(level.vertex_count());
            unite_edges(&mut incidences, surface.elements, &original_of);
            points = original_of.into_iter().map(|original| original.vertex).collect();
        }
        let tensions = Cow::Borrowed(network.tensions());
        Self { surface: *surface, sides: Cow::Owned(sides), tensions, originals, points, inner, incidences }
    }

    /// The point that a point is a copy of, or itself.
    pub(crate) fn original(&self, point: u32) -> u32 {
        self.points.get(point as usize).copied().unwrap_or(point)
    }

    /// Whether a boundary is not a copy of another.
    pub(crate) fn is_original(&self, boundary: BoundaryId) -> bool {
        self.originals[boundary.index()] == boundary
    }

    /// The boundary of an element that is no copy.
    pub(crate) fn boundary(&self, at: &Incidence) -> BoundaryId {
        self.surface.boundary(at.element)
    }

    /// Pairs of elements that meet inside a boundary that is no copy.
    pub(crate) fn inner_pairs(&self) -> Vec<[u32; 2]> {
        let mut pairs = self.inner.pairs();
        pairs.retain(|pair| self.is_original(self.surface.boundary(pair[0])));
        pairs
    }

    /// The incidences of each edge that is not inside a boundary.
    pub(crate) fn non_manifold_edges(&self) -> impl Iterator<Item = &[Incidence]> {
        by_edge(&self.incidences)
    }

    /// As [`Self::non_manifold_edges`].
    pub(crate) fn non_manifold_edges_in_parallel(&self) -> impl ParallelIterator<Item = &[Incidence]> {
        by_edge_in_parallel(&self.incidences)
    }

    /// The boundaries that meet at an edge, sorted.
    pub(crate) fn boundaries(&self, at: &[Incidence]) -> Vec<BoundaryId> {
        let mut boundaries: Vec<BoundaryId> = at.iter().map(|at| self.boundary(at)).collect();
        boundaries.sort_unstable();
        boundaries
    }

    /// The sectors into which boundaries divide what surrounds an edge, in order around it.
    pub(crate) fn dihedral_sectors(&self, at: &[Incidence]) -> Vec<DihedralSector> {
        dihedral_sectors(&self.surface, &self.sides, at)
    }

    /// The angles between boundaries where three grains meet.
    pub(crate) fn angles(&self) -> impl Iterator<Item = WeightedAngle> {
        angles(&self.surface, &self.sides, self.non_manifold_edges())
    }
}

/// Renumbers edges, copies like their originals.
fn unite_edges(incidences: &mut [Incidence], elements: Elements<'_>, original_of: &[PeriodicVertex]) {
    let key = |at: &Incidence| {
        let [start, end] = at.ends(elements).map(|end| original_of[end as usize]);
        let along = end.translation - start.translation;
        let against = start.translation - end.translation;
        match start.vertex.cmp(&end.vertex) {
            std::cmp::Ordering::Less => ([start.vertex, end.vertex], along),
            std::cmp::Ordering::Greater => ([end.vertex, start.vertex], against),
            std::cmp::Ordering::Equal => ([start.vertex, end.vertex], along.max(against)),
        }
    };
    let mut keyed: Vec<_> = incidences.iter().map(|at| (key(at), *at)).collect();
    keyed.par_sort_unstable();
    let groups = (0u32..).zip(keyed.chunk_by(|a, b| a.0 == b.0));
    let numbered =
        groups.flat_map(|(edge, group)| group.iter().map(move |(_, at)| Incidence { edge, ..*at }));
    incidences.iter_mut().zip(numbered).for_each(|(at, numbered)| *at = numbered);
}
