//! Tetrahedra on volumes of Gmsh, one for each grain, and physical groups: every grain, every boundary between grains, every side of a box.
//!
//! Solvers such as FEniCSx read only elements in physical groups, each in one; so points and curves have no elements, and a boundary at a side of the box is in the group of that side.

use std::borrow::Cow;
use std::io::{self, Write};

use super::super::lines::Junctions;
use super::super::surface::Surface;
use super::groups::Groups;
use super::periodic;
use super::{
    block_count, bounds, entity_counts, tag, write_block, write_element, write_entities, write_head,
    write_nodes, write_triangles,
};
use crate::Polycrystal;
use crate::volume_mesh::element_nodes::ElementNodes;

/// Gmsh's codes for triangles and tetrahedra of first and of second order.
const LINEAR: [u32; 2] = [2, 4];
const QUADRATIC: [u32; 2] = [9, 11];

pub(super) fn write(polycrystal: &Polycrystal, out: &mut dyn Write) -> io::Result<()> {
    let (elements, pairs) = polycrystal.elements()?;
    let mut surface = polycrystal.surface()?;
    // Those of elements of second order lie elsewhere than the network's.
    surface.points = Cow::Borrowed(&elements.points[..elements.boundary_points]);
    let surface = &surface;
    let junctions = Junctions::of(surface);
    let groups = Groups::of(polycrystal);
    let grain_count = polycrystal.network.grain_count();
    write_head(polycrystal, out)?;
    groups.write_names(grain_count, 2, out)?;
    writeln!(out, "$Entities\n{} {grain_count}", entity_counts(surface, &junctions))?;
    write_entities(surface, &junctions, |boundary| Some(groups.of_boundary[boundary.index()]), out)?;
    write_volumes(surface, grain_count, out)?;
    writeln!(out, "$EndEntities")?;

    let Nodes { on_surfaces, in_volumes } = Nodes::of(surface, &elements, grain_count);
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

    let count = surface.triangle_count() + elements.grains.len();
    let of_grains: Vec<_> = elements.grains.chunk_by(|a, b| a == b).collect();
    writeln!(out, "$Elements\n{} {count} 1 {count}", surface.parts.len() + of_grains.len())?;
    let mut element = 1u64..;
    let mut next = move || element.next().unwrap_or_default();
    let [triangle, tetrahedron] = if elements.are_quadratic() { QUADRATIC } else { LINEAR };
    write_triangles(surface, triangle, |corners| elements.on_boundary(&corners), &mut next, out)?;
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
    periodic::write(polycrystal, &elements, &pairs, out)
}

/// Writes a volume for each grain, which is a physical volume of the same number, with the surfaces around it.
fn write_volumes(surface: &Surface<'_>, grain_count: usize, out: &mut dyn Write) -> io::Result<()> {
    for (volume, parts) in (1..).zip(surface.parts_of_grains(grain_count)) {
        let corners =
            parts.iter().flat_map(|(part, _)| surface.triangles_of(&surface.parts[*part]).flatten());
        write!(out, "{volume} {} 1 {volume} {}", bounds(&surface.points, corners), parts.len())?;
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
    fn of(surface: &Surface<'_>, elements: &ElementNodes<'_>, grain_count: usize) -> Self {
        let mut is_listed = vec![false; elements.points.len()];
        is_listed[..elements.boundary_points].fill(true);
        let mut is_new = |node: &u32| !std::mem::replace(&mut is_listed[*node as usize], true);
        let mut on_surfaces = Vec::new();
        for part in surface.parts.iter().filter(|_| elements.are_quadratic()) {
            let nodes = surface.triangles_of(part).flat_map(|corners| elements.on_boundary(&corners));
            on_surfaces.push(nodes.filter(&mut is_new).collect());
        }
        let mut in_volumes = vec![Vec::new(); grain_count];
        for (nodes, grain) in elements.iter().zip(elements.grains) {
            in_volumes[grain.index()].extend(nodes.iter().copied().filter(&mut is_new));
        }
        Self { on_surfaces, in_volumes }
    }
}
