//! Elements that fill smooth grains: tetrahedra C3D4 or C3D10, in the plane triangles such as CPS3 or CPE6.

use std::collections::{BTreeMap, BTreeSet};
use std::io::{self, Write};

use glam::DVec3;

use super::{equations, number, write_numbers, write_sections};
use crate::names::{AXES, side_of_box};
use crate::volume_mesh::cohesive::{CohesiveMesh, Joint};
use crate::volume_mesh::element_nodes::ElementNodes;
use crate::volume_mesh::element_shape::{ElementFace, ElementShape};
use crate::{PlaneState, Polycrystal};

/// Writes nodes, those of the network first; elements grain by grain; sets of both; as surfaces each boundary, by the elements of its first side, and the sides of the box;
/// and, where they are asked for, cohesive elements and equations.
pub(super) fn write(polycrystal: &Polycrystal, out: &mut dyn Write) -> io::Result<()> {
    let network = &polycrystal.network;
    let (mut elements, mut pairs) = polycrystal.elements()?;
    // The nodes of faces are those of a grain that may have its own.
    let faces = elements.faces_at_boundaries(network);
    let mut joints = Vec::new();
    if polycrystal.file().volume.cohesive {
        let cohesive = CohesiveMesh::new(&elements, network, &pairs);
        (elements, joints, pairs) = (cohesive.elements, cohesive.joints, cohesive.ties);
    }
    writeln!(out, "*NODE, NSET=NODES")?;
    (1..).zip(&*elements.points).try_for_each(|(node, point)| write_node(node, *point, out))?;
    write_sides(polycrystal, &elements.points, out)?;
    let family = match (elements.shape, polycrystal.file().volume.plane_state.unwrap_or_default()) {
        (ElementShape::Tetrahedron, _) => "C3D",
        (ElementShape::Triangle, PlaneState::Stress) => "CPS",
        (ElementShape::Triangle, PlaneState::Strain) => "CPE",
    };
    writeln!(out, "*ELEMENT, TYPE={family}{}, ELSET=ELEMENTS", elements.node_count)?;
    (1..).zip(elements.iter()).try_for_each(|(element, nodes)| write_element(element, nodes, out))?;
    let mut first = 1;
    let mut grains = Vec::new();
    for of_grain in elements.grains.chunk_by(|a, b| a == b) {
        let grain = of_grain[0].index();
        first = write_element_set(&format!("GRAIN_{grain}"), first, of_grain.len(), out)?;
        grains.push(grain);
    }
    if !joints.is_empty() {
        write_joints(&joints, first, out)?;
    }
    write_surfaces(polycrystal, &faces, &elements, out)?;
    write_sections(&grains, polycrystal.grains(), out)?;
    if equations::are_asked(polycrystal) {
        equations::write(polycrystal, elements.points.len(), &pairs, out)?;
    }
    Ok(())
}

/// Writes cohesive elements from a number on, their sets, and their section: separations are strains, for a thickness of 1.
fn write_joints(joints: &[Joint], mut first: usize, out: &mut dyn Write) -> io::Result<()> {
    let kind = if joints[0].nodes.len() == 4 { "COH2D4" } else { "COH3D6" };
    writeln!(out, "*ELEMENT, TYPE={kind}, ELSET=COHESIVE")?;
    (first..).zip(joints).try_for_each(|(element, joint)| write_element(element, &joint.nodes, out))?;
    for of_boundary in joints.chunk_by(|a, b| a.boundary == b.boundary) {
        let name = format!("BOUNDARY_{}", of_boundary[0].boundary.0);
        first = write_element_set(&name, first, of_boundary.len(), out)?;
    }
    writeln!(
        out,
        "*COHESIVE SECTION, ELSET=COHESIVE, MATERIAL=COHESIVE, RESPONSE=TRACTION SEPARATION, THICKNESS=SPECIFIED\n1.0"
    )
}

fn write_element(element: usize, nodes: &[u32], out: &mut dyn Write) -> io::Result<()> {
    write!(out, "{element}")?;
    nodes.iter().try_for_each(|node| write!(out, ", {}", node + 1))?;
    writeln!(out)
}

/// Writes a set of so many elements; returns the number of the first behind it.
fn write_element_set(name: &str, first: usize, count: usize, out: &mut dyn Write) -> io::Result<usize> {
    writeln!(out, "*ELSET, ELSET={name}, GENERATE\n{first}, {}, 1", first + count - 1)?;
    Ok(first + count)
}

pub(super) fn write_node(node: usize, point: DVec3, out: &mut dyn Write) -> io::Result<()> {
    let [x, y, z] = point.to_array().map(number);
    writeln!(out, "{node}, {x}, {y}, {z}")
}

/// The nodes on each side of a box, each edge and each corner of it: `X0`, `X0Y1`, `X0Y1Z0` and so on.
fn write_sides(polycrystal: &Polycrystal, points: &[DVec3], out: &mut dyn Write) -> io::Result<()> {
    let domain = polycrystal.network.domain();
    if !domain.is_box() {
        return Ok(());
    }
    let axis_count = usize::from(polycrystal.dimension().axes());
    let ends = [domain.lower(), domain.upper()];
    // Of each axis: not at a side, at the lower, at the upper one.
    let mut sets: BTreeMap<[Option<usize>; 3], Vec<usize>> = BTreeMap::new();
    for (node, point) in points.iter().enumerate() {
        let at = [0, 1, 2].map(|axis| {
            let is_wall = axis < axis_count && !domain.periodic().test(axis);
            (0..2).find(|end| is_wall && point[axis] == ends[*end][axis])
        });
        for chosen in 1..8 {
            let some = [0, 1, 2].map(|axis| at[axis].filter(|_| chosen >> axis & 1 == 1));
            let is_whole = (0..3).all(|axis| (chosen >> axis & 1 == 1) == some[axis].is_some());
            if is_whole {
                sets.entry(some).or_default().push(node);
            }
        }
    }
    for (at, nodes) in sets {
        let name = |(axis, end): (&str, Option<usize>)| end.map(|end| format!("{axis}{end}"));
        let name: String = AXES.into_iter().zip(at).filter_map(name).collect();
        writeln!(out, "*NSET, NSET={}", name.to_uppercase())?;
        write_numbers(nodes.into_iter(), out)?;
    }
    Ok(())
}

/// Each boundary, `BOUNDARY_0` and so on, as a set of nodes and as the faces of the elements on its first side; the sides of the box, `X0` and so on, as faces too.
fn write_surfaces(
    polycrystal: &Polycrystal,
    faces: &[[Option<ElementFace>; 2]],
    elements: &ElementNodes<'_>,
    out: &mut dyn Write,
) -> io::Result<()> {
    let network = &polycrystal.network;
    let boundaries = network.boundaries();
    let mut of_boundaries = vec![(BTreeSet::new(), Vec::new()); boundaries.len()];
    let mut of_sides: BTreeMap<String, Vec<ElementFace>> = BTreeMap::new();
    let level = network.finest_level();
    for (both, boundary) in faces.iter().zip(&level.boundary_of) {
        let (nodes, faces) = &mut of_boundaries[boundary.index()];
        for face in both.iter().flatten() {
            nodes.extend(elements.nodes_of_face(*face).into_iter().map(|node| node as usize));
        }
        let Some(face) = both[0] else { continue };
        faces.push(face);
        let wall = boundaries[boundary.index()].wall;
        if let Some(side) = wall.and_then(|wall| side_of_box(network.domain(), wall)) {
            of_sides.entry(side.to_uppercase()).or_default().push(face);
        }
    }
    for (boundary, (nodes, faces)) in of_boundaries.into_iter().enumerate() {
        writeln!(out, "*NSET, NSET=BOUNDARY_{boundary}")?;
        write_numbers(nodes.into_iter(), out)?;
        write_surface(&format!("BOUNDARY_{boundary}"), &faces, out)?;
    }
    of_sides.iter().try_for_each(|(name, faces)| write_surface(name, faces, out))
}

fn write_surface(name: &str, faces: &[ElementFace], out: &mut dyn Write) -> io::Result<()> {
    writeln!(out, "*SURFACE, TYPE=ELEMENT, NAME={name}")?;
    faces.iter().try_for_each(|ElementFace { element, face }| writeln!(out, "{}, S{}", element + 1, face + 1))
}
