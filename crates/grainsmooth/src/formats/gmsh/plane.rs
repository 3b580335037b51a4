//! Triangles on surfaces of Gmsh, one for each grain, boundaries as curves, and physical groups: every grain, every boundary between grains, every side of a box.

use std::collections::BTreeMap;
use std::io::{self, Write};

use polycrystal::{BoundaryId, Corners};

use super::groups::Groups;
use super::{bounds, periodic, tag, write_block, write_element, write_head};
use crate::Polycrystal;
use crate::volume_mesh::element_shape::boundary_elements;

/// Gmsh's codes for segments and triangles of first and of second order.
const LINEAR: [u32; 2] = [1, 2];
const QUADRATIC: [u32; 2] = [8, 9];

pub(super) fn write(polycrystal: &Polycrystal, out: &mut dyn Write) -> io::Result<()> {
    let (elements, pairs) = polycrystal.elements()?;
    let network = &polycrystal.network;
    let groups = Groups::of(polycrystal);
    let grain_count = network.grain_count();
    let level = network.finest_level();
    let mut curves: BTreeMap<BoundaryId, Vec<Corners>> = BTreeMap::new();
    boundary_elements(&level).for_each(|(boundary, ends)| curves.entry(boundary).or_default().push(ends));
    let grains: Vec<_> = elements.grains.chunk_by(|a, b| a == b).collect();

    write_head(polycrystal, out)?;
    groups.write_names(grain_count, 1, out)?;
    writeln!(out, "$Entities\n0 {} {} 0", curves.len(), grains.len())?;
    for (boundary, segments) in &curves {
        let ends = segments.iter().flat_map(|ends| ends.iter().copied());
        let group = groups.of_boundary[boundary.index()];
        writeln!(out, "{} {} 1 {group} 0", tag(*boundary), bounds(&elements.points, ends))?;
    }
    let mut around: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for boundary in curves.keys() {
        for (grain, _) in network.boundaries()[boundary.index()].signed_grains() {
            around.entry(grain.index() + 1).or_default().push(tag(*boundary));
        }
    }
    let mut nodes_of = elements.iter();
    let mut nodes_of_grains: Vec<Vec<&[u32]>> = Vec::new();
    for of_grain in &grains {
        nodes_of_grains.push(nodes_of.by_ref().take(of_grain.len()).collect());
    }
    for (of_grain, nodes) in grains.iter().zip(&nodes_of_grains) {
        let grain = of_grain[0].index() + 1;
        let corners = nodes.iter().flat_map(|nodes| nodes.iter().copied());
        let curves = around.remove(&grain).unwrap_or_default();
        write!(out, "{grain} {} 1 {grain} {}", bounds(&elements.points, corners), curves.len())?;
        curves.iter().try_for_each(|curve| write!(out, " {curve}"))?;
        writeln!(out)?;
    }
    writeln!(out, "$EndEntities")?;

    let mut is_listed = vec![false; elements.points.len()];
    let mut is_new = |node: &u32| !std::mem::replace(&mut is_listed[*node as usize], true);
    let count = elements.points.len();
    writeln!(out, "$Nodes\n{} {count} 1 {count}", curves.len() + grains.len())?;
    for (boundary, segments) in &curves {
        let nodes = segments.iter().flat_map(|ends| elements.on_boundary(ends));
        let nodes: Vec<u32> = nodes.filter(&mut is_new).collect();
        write_block([1, tag(*boundary)], &nodes, &elements.points, out)?;
    }
    for (of_grain, nodes) in grains.iter().zip(&nodes_of_grains) {
        let nodes: Vec<u32> =
            nodes.iter().flat_map(|nodes| nodes.iter().copied()).filter(&mut is_new).collect();
        write_block([2, of_grain[0].index() + 1], &nodes, &elements.points, out)?;
    }
    writeln!(out, "$EndNodes")?;

    let [segment, triangle] = if elements.are_quadratic() { QUADRATIC } else { LINEAR };
    let count = level.element_count() + elements.grains.len();
    writeln!(out, "$Elements\n{} {count} 1 {count}", curves.len() + grains.len())?;
    let mut element = 1u64..;
    let mut next = move || element.next().unwrap_or_default();
    for (boundary, segments) in &curves {
        writeln!(out, "1 {} {segment} {}", tag(*boundary), segments.len())?;
        segments.iter().try_for_each(|ends| write_element(next(), &elements.on_boundary(ends), out))?;
    }
    for (of_grain, nodes) in grains.iter().zip(&nodes_of_grains) {
        writeln!(out, "2 {} {triangle} {}", of_grain[0].index() + 1, of_grain.len())?;
        nodes.iter().try_for_each(|nodes| write_element(next(), nodes, out))?;
    }
    writeln!(out, "$EndElements")?;
    periodic::write(polycrystal, &elements, &pairs, out)
}
