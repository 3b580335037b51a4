//! Which surfaces of Gmsh, in the plane curves, are others moved by whole periods, node by node.

use std::collections::{BTreeMap, BTreeSet};
use std::io::{self, Write};

use polycrystal::{BoundaryId, Corners};
use voronoi::{PeriodicPair, Translation};

use super::tag;
use crate::Polycrystal;
use crate::volume_mesh::element_nodes::ElementNodes;
use crate::volume_mesh::element_shape::boundary_elements;

/// A point on the torus, and the periods that lead from there to where it stands.
type Place = (u32, Translation);

/// The elements of each boundary.
type ByBoundary = BTreeMap<BoundaryId, Vec<Corners>>;

/// A boundary that is another one, the original, moved by whole periods.
struct Copy {
    boundary: BoundaryId,
    original: BoundaryId,
    translation: Translation,
}

/// Writes the section `$Periodic`; nothing where nothing is periodic.
pub(super) fn write(
    polycrystal: &Polycrystal,
    elements: &ElementNodes<'_>,
    pairs: &[PeriodicPair<u32>],
    out: &mut dyn Write,
) -> io::Result<()> {
    let mut places: Vec<Place> =
        (0u32..).take(elements.points.len()).map(|point| (point, Translation::ZERO)).collect();
    for pair in pairs {
        places[pair.secondary as usize] = (pair.primary, pair.translation);
    }
    let level = polycrystal.network.finest_level();
    let mut by_boundary: ByBoundary = BTreeMap::new();
    boundary_elements(&level).for_each(|(boundary, of)| by_boundary.entry(boundary).or_default().push(of));
    let mut copies = twins(polycrystal);
    if copies.is_empty() {
        copies = opposite(&by_boundary, polycrystal, &places);
    }
    if copies.is_empty() {
        return Ok(());
    }
    writeln!(out, "$Periodic\n{}", copies.len())?;
    let points_of = |boundary: BoundaryId| -> BTreeSet<u32> {
        let own = by_boundary.get(&boundary).into_iter().flatten();
        own.flat_map(|corners| elements.on_boundary(corners)).collect()
    };
    let dimension = polycrystal.dimension().axes() - 1;
    for Copy { boundary, original, translation } in &copies {
        let by_place: BTreeMap<Place, u32> =
            points_of(*original).into_iter().map(|point| (places[point as usize], point)).collect();
        let pairs = points_of(*boundary).into_iter().filter_map(|point| {
            let (original, moved) = places[point as usize];
            Some((point, *by_place.get(&(original, moved - *translation))?))
        });
        let pairs: Vec<(u32, u32)> = pairs.collect();
        // No affine transformation: Gmsh would search for the nearest points with it, which are given here.
        writeln!(out, "{dimension} {} {}\n0\n{}", tag(*boundary), tag(*original), pairs.len())?;
        pairs.iter().try_for_each(|(copy, original)| writeln!(out, "{} {}", copy + 1, original + 1))?;
    }
    writeln!(out, "$EndPeriodic")
}

/// The copies of a periodic network, which are known.
fn twins(polycrystal: &Polycrystal) -> Vec<Copy> {
    let numbered = (0u32..).map(BoundaryId).zip(polycrystal.network.boundaries());
    let copy = |(boundary, of): (BoundaryId, &polycrystal::Boundary)| {
        let twin = of.twin.filter(|twin| twin.boundary < boundary)?;
        Some(Copy { boundary, original: twin.boundary, translation: Translation::ZERO - twin.translation })
    };
    numbered.filter_map(copy).collect()
}

/// Boundaries on the upper sides of a box at which a periodic network was cut, with those on the lower sides.
fn opposite(by_boundary: &ByBoundary, polycrystal: &Polycrystal, places: &[Place]) -> Vec<Copy> {
    let domain = polycrystal.network.domain();
    let cut = polycrystal.axes_cut_at_box();
    let across = |boundary: BoundaryId| {
        let wall = polycrystal.network.boundaries()[boundary.index()].wall?;
        domain.across_axis(wall).filter(|(axis, _)| cut.test(*axis))
    };
    let seen = |corners: &Corners, from: Translation| {
        let places = corners.iter().map(|corner| places[*corner as usize]);
        let mut places: Vec<Place> = places.map(|(original, at)| (original, at - from)).collect();
        places.sort_unstable();
        places
    };
    let mut lower = BTreeMap::new();
    for (boundary, elements) in by_boundary {
        if across(*boundary).is_some_and(|(axis, coordinate)| coordinate == domain.lower()[axis]) {
            lower.extend(elements.iter().map(|corners| (seen(corners, Translation::ZERO), *boundary)));
        }
    }
    let copy = |(boundary, elements): (&BoundaryId, &Vec<Corners>)| {
        let (axis, _) =
            across(*boundary).filter(|(axis, coordinate)| *coordinate == domain.upper()[*axis])?;
        let mut translation = Translation::ZERO;
        translation.0[axis] = 1;
        let original = *lower.get(&seen(elements.first()?, translation))?;
        Some(Copy { boundary: *boundary, original, translation })
    };
    by_boundary.iter().filter_map(copy).collect()
}
