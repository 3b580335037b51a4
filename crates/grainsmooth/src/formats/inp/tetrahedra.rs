//! Tetrahedra that fill smooth grains, as elements C3D4.

use std::collections::BTreeMap;
use std::io::{self, Write};

use glam::DVec3;
use polycrystal::{GrainId, Mesh};

use super::{number, write_numbers, write_sections};
use crate::Polycrystal;
use crate::volume_mesh::VolumeMesh;

/// The corners of a tetrahedron's faces S1 to S4. Abaqus Analysis User's Guide, "Three-dimensional solid element library".
const FACES: [[usize; 3]; 4] = [[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]];

/// The sides of the box along each axis.
const AXES: [&str; 3] = ["X", "Y", "Z"];

/// Writes nodes, those of the network first; elements grain by grain; sets of both; and as surfaces each boundary, by the elements of its first side, and the sides of the box.
pub(super) fn write(polycrystal: &Polycrystal, mesh: &VolumeMesh, out: &mut dyn Write) -> io::Result<()> {
    writeln!(out, "*NODE, NSET=NODES")?;
    for (node, DVec3 { x, y, z }) in (1..).zip(&mesh.points) {
        writeln!(out, "{node}, {}, {}, {}", number(*x), number(*y), number(*z))?;
    }
    write_sides(polycrystal, mesh, out)?;
    writeln!(out, "*ELEMENT, TYPE=C3D4, ELSET=ELEMENTS")?;
    for (element, [a, b, c, d]) in (1..).zip(&mesh.tetrahedra) {
        writeln!(out, "{element}, {}, {}, {}, {}", a + 1, b + 1, c + 1, d + 1)?;
    }
    let mut first = 1;
    let mut grains = Vec::new();
    for of_grain in mesh.grains.chunk_by(|a, b| a == b) {
        let (grain, last) = (of_grain[0].index(), first + of_grain.len() - 1);
        writeln!(out, "*ELSET, ELSET=GRAIN_{grain}, GENERATE\n{first}, {last}, 1")?;
        grains.push(grain);
        first = last + 1;
    }
    write_surfaces(polycrystal, mesh, out)?;
    write_sections(&grains, polycrystal.grains(), out)
}

/// The nodes on each side of a box, each edge and each corner of it: `X0`, `X0Y1`, `X0Y1Z0` and so on.
fn write_sides(polycrystal: &Polycrystal, mesh: &VolumeMesh, out: &mut dyn Write) -> io::Result<()> {
    let domain = polycrystal.network.domain();
    if !domain.is_box() {
        return Ok(());
    }
    let ends = [domain.lower(), domain.upper()];
    // Of each axis: not at a side, at the lower, at the upper one.
    let mut sets: BTreeMap<[Option<usize>; 3], Vec<usize>> = BTreeMap::new();
    for (node, point) in mesh.points[..mesh.surface_points].iter().enumerate() {
        let at = [0, 1, 2].map(|axis| {
            let is_wall = !domain.periodic().test(axis);
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
        writeln!(out, "*NSET, NSET={name}")?;
        write_numbers(nodes.into_iter(), out)?;
    }
    Ok(())
}

/// Each boundary, `BOUNDARY_0` and so on, as the faces of the elements on its first side, and the sides of the box, `X0` and so on.
fn write_surfaces(polycrystal: &Polycrystal, mesh: &VolumeMesh, out: &mut dyn Write) -> io::Result<()> {
    let level = polycrystal.network.finest();
    let Mesh::Triangles(triangles) = &level.mesh else { return Ok(()) };
    let sorted = |mut corners: [u32; 3]| {
        corners.sort_unstable();
        corners
    };
    let is_on_surface = |corner: &u32| (*corner as usize) < mesh.surface_points;
    let mut faces: BTreeMap<(GrainId, [u32; 3]), (usize, usize)> = BTreeMap::new();
    for (element, (corners, grain)) in mesh.tetrahedra.iter().zip(&mesh.grains).enumerate() {
        for (face, of_face) in FACES.iter().enumerate() {
            let face_corners = of_face.map(|corner| corners[corner]);
            if face_corners.iter().all(is_on_surface) {
                faces.insert((*grain, sorted(face_corners)), (element + 1, face + 1));
            }
        }
    }
    let boundaries = polycrystal.network.boundaries();
    let domain = polycrystal.network.domain();
    let mut surfaces: BTreeMap<String, Vec<(usize, usize)>> = BTreeMap::new();
    let mut order = vec![Vec::new(); boundaries.len()];
    for (corners, boundary) in triangles.triangles().iter().zip(&level.boundary_of) {
        let Some((grain, _)) = boundaries[boundary.index()].signed_grains().next() else { continue };
        let Some(face) = faces.get(&(grain, sorted(*corners))) else { continue };
        order[boundary.index()].push(*face);
        let wall = boundaries[boundary.index()].wall.and_then(|wall| domain.across_axis(wall));
        if let Some((axis, coordinate)) = wall.filter(|_| domain.is_box()) {
            let end = usize::from(coordinate == domain.upper()[axis]);
            surfaces.entry(format!("{}{end}", AXES[axis])).or_default().push(*face);
        }
    }
    let named = order.into_iter().enumerate().map(|(number, faces)| (format!("BOUNDARY_{number}"), faces));
    for (name, faces) in named.chain(surfaces) {
        writeln!(out, "*SURFACE, TYPE=ELEMENT, NAME={name}")?;
        faces.iter().try_for_each(|(element, face)| writeln!(out, "{element}, S{face}"))?;
    }
    Ok(())
}
