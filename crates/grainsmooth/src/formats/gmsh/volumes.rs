//! Tetrahedra on volumes of Gmsh, one for each grain, and physical groups: every grain, every boundary between grains, every side of a box.
//!
//! Solvers such as FEniCSx read only elements in physical groups, each in one; so points and curves have no elements, and a boundary at a side of the box is in the group of that side.

use std::collections::BTreeMap;
use std::io::{self, Write};

use polycrystal::BoundaryId;

use super::super::lines::Junctions;
use super::super::surface::Surface;
use super::periodic;
use super::{
    block_count, bounds, entity_counts, tag, write_block, write_element, write_entities, write_head,
    write_nodes, write_triangles,
};
use crate::Polycrystal;
use crate::names::side_of_box;
use crate::volume_mesh::VolumeMesh;
use crate::volume_mesh::element_nodes::ElementNodes;

/// Gmsh's codes for triangles and tetrahedra of first and of second order.
const LINEAR: [u32; 2] = [2, 4];
const QUADRATIC: [u32; 2] = [9, 11];

pub(super) fn write(
    surface: &Surface<'_>,
    mesh: &VolumeMesh,
    polycrystal: &Polycrystal,
    out: &mut dyn Write,
) -> io::Result<()> {
    let (elements, pairs) = polycrystal.elements(mesh)?;
    let junctions = Junctions::of(surface);
    let groups = Groups::of(polycrystal);
    let grain_count = polycrystal.network.grain_count();
    write_head(polycrystal, out)?;
    groups.write_names(grain_count, out)?;
    writeln!(out, "$Entities\n{} {grain_count}", entity_counts(surface, &junctions))?;
    write_entities(surface, &junctions, |boundary| Some(groups.of_boundary[boundary.index()]), out)?;
    write_volumes(surface, mesh, grain_count, out)?;
    writeln!(out, "$EndEntities")?;

    let Nodes { on_surfaces, in_volumes } = Nodes::of(surface, mesh, &elements, grain_count);
    let (blocks, count) = (on_surfaces.len() + in_volumes.len(), elements.points.len());
    writeln!(out, "$Nodes\n{} {count} 1 {count}", block_count(surface, &junctions) + blocks)?;
    write_nodes(surface, &junctions, out)?;
    for (part, nodes) in surface.parts.iter().zip(&on_surfaces) {
        write_block([2, tag(part.boundary)], nodes, &elements.points, out)?;
    }
    for (volume, nodes) in (1..).zip(&in_volumes) {
        write_block([3, volume], nodes, &elements.points, out)?;
    }
    writeln!(out, "$EndNodes")?;

    let count = surface.triangle_count() + mesh.tetrahedra.len();
    let of_grains: Vec<_> = mesh.grains.chunk_by(|a, b| a == b).collect();
    writeln!(out, "$Elements\n{} {count} 1 {count}", surface.parts.len() + of_grains.len())?;
    let mut element = 1u64..;
    let mut next = move || element.next().unwrap_or_default();
    let [triangle, tetrahedron] = if elements.are_quadratic() { QUADRATIC } else { LINEAR };
    write_triangles(surface, triangle, |corners| elements.of_triangle(corners), &mut next, out)?;
    let mut nodes_of = elements.iter();
    for of_grain in of_grains {
        writeln!(out, "3 {} {tetrahedron} {}", of_grain[0].index() + 1, of_grain.len())?;
        for nodes in nodes_of.by_ref().take(of_grain.len()) {
            let mut nodes = nodes.to_vec();
            if elements.are_quadratic() {
                // Gmsh has the last two edges in the other order.
                nodes.swap(8, 9);
            }
            write_element(next(), &nodes, out)?;
        }
    }
    writeln!(out, "$EndElements")?;
    periodic::write(surface, polycrystal, &elements, &pairs, out)
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

/// Nodes that are no points of the network: the middles of edges on each surface, and the nodes inside each grain.
struct Nodes {
    /// Nothing for elements of first order.
    on_surfaces: Vec<Vec<u32>>,
    in_volumes: Vec<Vec<u32>>,
}

impl Nodes {
    fn of(surface: &Surface<'_>, mesh: &VolumeMesh, elements: &ElementNodes<'_>, grain_count: usize) -> Self {
        let mut is_listed = vec![false; elements.points.len()];
        is_listed[..mesh.surface_points].fill(true);
        let mut is_new = |node: &u32| !std::mem::replace(&mut is_listed[*node as usize], true);
        let mut on_surfaces = Vec::new();
        for part in surface.parts.iter().filter(|_| elements.are_quadratic()) {
            let nodes = surface.triangles_of(part).flat_map(|corners| elements.of_triangle(corners));
            on_surfaces.push(nodes.filter(&mut is_new).collect());
        }
        let mut in_volumes = vec![Vec::new(); grain_count];
        for (nodes, grain) in elements.iter().zip(&mesh.grains) {
            in_volumes[grain.index()].extend(nodes.iter().copied().filter(&mut is_new));
        }
        Self { on_surfaces, in_volumes }
    }
}
