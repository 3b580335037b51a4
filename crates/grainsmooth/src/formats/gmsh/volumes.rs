//! Tetrahedra on volumes of Gmsh, one for each grain, and physical groups: every grain, every boundary between grains, every side of a box.
//!
//! Solvers such as FEniCSx read only elements in physical groups, each in one; so points and curves have no elements, and a boundary at a side of the box is in the group of that side.

use std::collections::BTreeMap;
use std::io::{self, Write};

use glam::DVec3;
use polycrystal::BoundaryId;

use super::super::lines::Junctions;
use super::super::surface::Surface;
use super::periodic;
use super::{
    block_count, bounds, entity_counts, tag, write_entities, write_head, write_nodes, write_triangles,
};
use crate::Polycrystal;
use crate::names::side_of_box;
use crate::volume_mesh::VolumeMesh;

/// Gmsh's code for tetrahedra.
const TETRAHEDRON: u32 = 4;

pub(super) fn write(
    surface: &Surface<'_>,
    mesh: &VolumeMesh,
    polycrystal: &Polycrystal,
    out: &mut dyn Write,
) -> io::Result<()> {
    let junctions = Junctions::of(surface);
    let groups = Groups::of(polycrystal);
    let grain_count = polycrystal.network.grain_count();
    write_head(polycrystal, out)?;
    groups.write_names(grain_count, out)?;
    writeln!(out, "$Entities\n{} {grain_count}", entity_counts(surface, &junctions))?;
    write_entities(surface, &junctions, |boundary| Some(groups.of_boundary[boundary.index()]), out)?;
    write_volumes(surface, mesh, grain_count, out)?;
    writeln!(out, "$EndEntities")?;
    let count = mesh.points.len();
    let inner = inner_points(mesh, grain_count);
    writeln!(out, "$Nodes\n{} {count} 1 {count}", block_count(surface, &junctions) + grain_count)?;
    write_nodes(surface, &junctions, out)?;
    for (tag, points) in (1..).zip(&inner) {
        writeln!(out, "3 {tag} 0 {}", points.len())?;
        points.iter().try_for_each(|point| writeln!(out, "{}", point + 1))?;
        for DVec3 { x, y, z } in points.iter().map(|point| mesh.points[*point]) {
            writeln!(out, "{x:?} {y:?} {z:?}")?;
        }
    }
    writeln!(out, "$EndNodes")?;
    let count = surface.triangle_count() + mesh.tetrahedra.len();
    let of_grains: Vec<_> = mesh.grains.chunk_by(|a, b| a == b).collect();
    writeln!(out, "$Elements\n{} {count} 1 {count}", surface.parts.len() + of_grains.len())?;
    let mut element = 1u64..;
    let mut next = move || element.next().unwrap_or_default();
    write_triangles(surface, &mut next, out)?;
    let mut tetrahedra = mesh.tetrahedra.iter();
    for of_grain in of_grains {
        writeln!(out, "3 {} {TETRAHEDRON} {}", of_grain[0].index() + 1, of_grain.len())?;
        for [a, b, c, d] in tetrahedra.by_ref().take(of_grain.len()) {
            writeln!(out, "{} {} {} {} {}", next(), a + 1, b + 1, c + 1, d + 1)?;
        }
    }
    writeln!(out, "$EndElements")?;
    periodic::write(surface, polycrystal, out)
}

/// The physical surfaces.
struct Groups {
    /// The number of each boundary's group: its own, counted from 1, or that of the side of the box.
    of_boundary: Vec<usize>,
    /// The sides of the box, by name, with the numbers of their groups.
    sides: BTreeMap<String, usize>,
}

impl Groups {
    fn of(polycrystal: &Polycrystal) -> Self {
        let network = &polycrystal.network;
        let boundaries = network.boundaries();
        let side = |wall| side_of_box(network.domain(), wall);
        let mut sides: BTreeMap<String, usize> =
            boundaries.iter().filter_map(|boundary| Some((side(boundary.wall?)?, 0))).collect();
        for (number, group) in (boundaries.len() + 1..).zip(sides.values_mut()) {
            *group = number;
        }
        let numbered = (0u32..).map(BoundaryId).zip(boundaries);
        let group = |(id, boundary): (BoundaryId, &polycrystal::Boundary)| {
            boundary.wall.and_then(side).map_or(tag(id), |side| sides[&side])
        };
        Self { of_boundary: numbered.map(group).collect(), sides }
    }

    /// Writes the names: `grain0`, `boundary0` and `x0`.
    fn write_names(&self, grain_count: usize, out: &mut dyn Write) -> io::Result<()> {
        let boundaries = (0..).zip(&self.of_boundary).filter(|(boundary, group)| **group == boundary + 1);
        let boundaries = boundaries.map(|(boundary, group)| (format!("boundary{boundary}"), *group));
        let surfaces: Vec<(String, usize)> =
            boundaries.chain(self.sides.iter().map(|(side, group)| (side.clone(), *group))).collect();
        writeln!(out, "$PhysicalNames\n{}", surfaces.len() + grain_count)?;
        surfaces.iter().try_for_each(|(name, group)| writeln!(out, "2 {group} \"{name}\""))?;
        (0..grain_count).try_for_each(|grain| writeln!(out, "3 {} \"grain{grain}\"", grain + 1))?;
        writeln!(out, "$EndPhysicalNames")
    }
}

/// Writes a volume for each grain, which is a physical volume of the same number, with the surfaces around it.
fn write_volumes(
    surface: &Surface<'_>,
    mesh: &VolumeMesh,
    grain_count: usize,
    out: &mut dyn Write,
) -> io::Result<()> {
    for (volume, parts) in (1..).zip(surface.parts_of_grains(grain_count)) {
        let corners =
            parts.iter().flat_map(|(part, _)| surface.triangles_of(&surface.parts[*part]).flatten());
        write!(out, "{volume} {} 1 {volume} {}", bounds(&mesh.points, corners), parts.len())?;
        for (part, is_inward) in parts {
            let sign = if is_inward { "-" } else { "" };
            write!(out, " {sign}{}", tag(surface.parts[part].boundary))?;
        }
        writeln!(out)?;
    }
    Ok(())
}

/// The points inside each grain.
fn inner_points(mesh: &VolumeMesh, grain_count: usize) -> Vec<Vec<usize>> {
    let mut grain_of = vec![None; mesh.points.len() - mesh.surface_points];
    for (corners, grain) in mesh.tetrahedra.iter().zip(&mesh.grains) {
        for inner in corners.iter().filter_map(|corner| (*corner as usize).checked_sub(mesh.surface_points)) {
            grain_of[inner] = Some(grain.index());
        }
    }
    let mut points = vec![Vec::new(); grain_count];
    for (point, grain) in (mesh.surface_points..).zip(grain_of) {
        if let Some(grain) = grain {
            points[grain].push(point);
        }
    }
    points
}
