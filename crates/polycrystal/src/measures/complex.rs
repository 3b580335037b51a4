use std::borrow::Cow;

use voronoi::Shift;

use crate::mesh::angles::{DihedralSector, WeightedAngle, angles, dihedral_sectors};
use crate::mesh::seams::{Seams, Use};
use crate::{BoundaryId, Elements, Level, Network, Side, Surface};

/// A surface with every place once: in a periodic network without what is a copy of something else, and with the grains
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
    /// Places inside boundaries: two elements each.
    pub(crate) inner: Vec<[u32; 2]>,
    /// The uses of all other places, sorted by place.
    uses: Vec<Use>,
}

impl<'a> Complex<'a> {
    /// Any surface. Tensions are 1 between grains, and 0 at the exterior.
    pub(crate) fn of_surface(surface: &Surface<'a>) -> Self {
        let Seams { inner, uses } = Seams::of_elements(surface.elements, surface.boundary_of);
        let originals = (0u32..).take(surface.sides.len()).map(BoundaryId).collect();
        let sides = Cow::Borrowed(surface.sides);
        let tension = |sides: &[Side; 2]| if sides.contains(&Side::Exterior) { 0.0 } else { 1.0 };
        let tensions = surface.sides.iter().map(tension).collect();
        Self { surface: *surface, sides, tensions, originals, points: Vec::new(), inner, uses }
    }

    /// A level of a network, whose surface this is.
    pub(crate) fn of_level(network: &'a Network, level: &Level, surface: &Surface<'a>) -> Self {
        let Seams { mut inner, mut uses } = Seams::of_level(level);
        let boundaries = network.boundaries();
        let originals: Vec<BoundaryId> = (0u32..)
            .map(BoundaryId)
            .zip(boundaries)
            .map(|(id, boundary)| boundary.twin.map_or(id, |twin| twin.boundary.min(id)))
            .collect();
        let sides: Vec<[Side; 2]> = boundaries.iter().map(|at| at.sides_across(boundaries)).collect();
        let mut points = Vec::new();
        if network.domain().is_periodic() {
            let is_original = |element: u32| {
                let boundary = surface.boundary_of[element as usize];
                originals[boundary.index()] == boundary
            };
            inner.retain(|pair| is_original(pair[0]));
            uses.retain(|at| is_original(at.element));
            let mut places: Vec<(u32, Shift)> = ids(level.vertex_count()).map(|v| (v, Shift::NONE)).collect();
            for pair in &level.copies.vertices {
                places[pair.secondary as usize] = (pair.primary, pair.shift);
            }
            unite_places(&mut uses, surface.elements, &places);
            points = places.into_iter().map(|(original, _)| original).collect();
        }
        let tensions = Cow::Borrowed(network.tensions());
        Self { surface: *surface, sides: Cow::Owned(sides), tensions, originals, points, inner, uses }
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
    pub(crate) fn boundary(&self, at: &Use) -> BoundaryId {
        self.surface.boundary_of[at.element as usize]
    }

    /// The uses of each place where not two elements of one boundary meet.
    pub(crate) fn places(&self) -> impl Iterator<Item = &[Use]> {
        self.uses.chunk_by(|a, b| a.place == b.place)
    }

    /// The boundaries that meet at a place, sorted.
    pub(crate) fn boundaries(&self, at: &[Use]) -> Vec<BoundaryId> {
        let mut boundaries: Vec<BoundaryId> = at.iter().map(|at| self.boundary(at)).collect();
        boundaries.sort_unstable();
        boundaries
    }

    /// The sectors into which boundaries divide what surrounds a place, in order around it.
    pub(crate) fn dihedral_sectors(&self, at: &[Use]) -> Vec<DihedralSector> {
        dihedral_sectors(&self.surface, &self.sides, at)
    }

    /// The angles between boundaries where three grains meet.
    pub(crate) fn angles(&self) -> impl Iterator<Item = WeightedAngle> {
        angles(&self.surface, &self.sides, self.places())
    }
}

/// Numbers places anew, copies like their originals.
fn unite_places(uses: &mut [Use], elements: Elements<'_>, places: &[(u32, Shift)]) {
    let key = |at: &Use| {
        let [start, end] = at.ends(elements).map(|end| places[end as usize]);
        let along = end.1 - start.1;
        let against = start.1 - end.1;
        match start.0.cmp(&end.0) {
            std::cmp::Ordering::Less => ([start.0, end.0], along),
            std::cmp::Ordering::Greater => ([end.0, start.0], against),
            std::cmp::Ordering::Equal => ([start.0, end.0], along.max(against)),
        }
    };
    let mut keyed: Vec<_> = uses.iter().map(|at| (key(at), *at)).collect();
    keyed.sort_unstable();
    let groups = (0u32..).zip(keyed.chunk_by(|a, b| a.0 == b.0));
    let numbered = groups.flat_map(|(place, group)| group.iter().map(move |(_, at)| Use { place, ..*at }));
    uses.iter_mut().zip(numbered).for_each(|(at, numbered)| *at = numbered);
}

fn ids(count: usize) -> impl Iterator<Item = u32> {
    0..u32::try_from(count).expect("ids fit 32 bits")
}
