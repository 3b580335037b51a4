//! Which surfaces of Gmsh are others moved by whole periods, node by node.

use std::collections::{BTreeMap, BTreeSet};
use std::io::{self, Write};

use polycrystal::BoundaryId;
use voronoi::{PeriodicPair, Translation};

use super::super::surface::{Part, Surface};
use super::tag;
use crate::Polycrystal;
use crate::volume_mesh::element_nodes::ElementNodes;

/// A point on the torus, and the periods that lead from there to where it stands.
type Place = (u32, Translation);

/// A boundary that is another one, the original, moved by whole periods.
struct Copy {
    boundary: BoundaryId,
    original: BoundaryId,
    translation: Translation,
}

/// Writes the section `$Periodic`; nothing where nothing is periodic.
pub(super) fn write(
    surface: &Surface<'_>,
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
    let mut copies = twins(polycrystal);
    if copies.is_empty() {
        copies = opposite(surface, polycrystal, &places);
    }
    if copies.is_empty() {
        return Ok(());
    }
    writeln!(out, "$Periodic\n{}", copies.len())?;
    let points_of = |boundary: BoundaryId| -> BTreeSet<u32> {
        let triangles = surface.triangles_of(&surface.parts[boundary.index()]);
        triangles.flat_map(|corners| elements.of_triangle(corners)).collect()
    };
    for Copy { boundary, original, translation } in &copies {
        let by_place: BTreeMap<Place, u32> =
            points_of(*original).into_iter().map(|point| (places[point as usize], point)).collect();
        let pairs = points_of(*boundary).into_iter().filter_map(|point| {
            let (original, moved) = places[point as usize];
            Some((point, *by_place.get(&(original, moved - *translation))?))
        });
        let pairs: Vec<(u32, u32)> = pairs.collect();
        // No affine transformation: Gmsh would search for the nearest points with it, which are given here.
        writeln!(out, "2 {} {}\n0\n{}", tag(*boundary), tag(*original), pairs.len())?;
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
fn opposite(surface: &Surface<'_>, polycrystal: &Polycrystal, places: &[Place]) -> Vec<Copy> {
    let domain = polycrystal.network.domain();
    let cut = polycrystal.axes_cut_at_box();
    let across = |part: &Part| {
        let wall = polycrystal.network.boundaries()[part.boundary.index()].wall?;
        domain.across_axis(wall).filter(|(axis, _)| cut.test(*axis))
    };
    let corners = |triangle: [u32; 3], from: Translation| {
        let mut corners = triangle.map(|corner| {
            let (original, translation) = places[corner as usize];
            (original, translation - from)
        });
        corners.sort_unstable();
        corners
    };
    let mut lower = BTreeMap::new();
    for part in &surface.parts {
        if across(part).is_some_and(|(axis, coordinate)| coordinate == domain.lower()[axis]) {
            lower.extend(
                surface
                    .triangles_of(part)
                    .map(|triangle| (corners(triangle, Translation::ZERO), part.boundary)),
            );
        }
    }
    let copy = |part: &Part| {
        let (axis, _) = across(part).filter(|(axis, coordinate)| *coordinate == domain.upper()[*axis])?;
        let mut translation = Translation::ZERO;
        translation.0[axis] = 1;
        let first = surface.triangles_of(part).next()?;
        Some(Copy {
            boundary: part.boundary,
            original: *lower.get(&corners(first, translation))?,
            translation,
        })
    };
    surface.parts.iter().filter_map(copy).collect()
}
