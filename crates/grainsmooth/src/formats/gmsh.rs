//! Gmsh's mesh format 4.1 with the boundaries as discrete surfaces, and a script with the grains as volumes between them.
//!
//! <https://gmsh.info/doc/texinfo/gmsh.html#MSH-file-format>. Gmsh fills only volumes that a script makes, never those of a
//! mesh file; `gmsh -3` on the script does. Gmsh counts from 1, so grain 0 is volume 1, and boundary 0 surface 1. Quadruple
//! points are its points, triple lines and the edges of the domain its curves.
//!
//! A volume of Gmsh is connected. Where the box cuts a periodic network, a grain in several pieces is several volumes, which
//! are one physical volume; and a boundary several surfaces, which are one physical surface. Where the file holds tetrahedra, they stand on one volume for
//! each grain, and there is no script.

mod groups;
mod periodic;
mod plane;
mod volumes;

use std::collections::BTreeMap;
use std::io::{self, Write};

use glam::DVec3;
use polycrystal::BoundaryId;
use voronoi::Dimension;

use super::connected::{ConnectedParts, pieces_of_grain};
use super::format::{Beside, Content, Extra, Format, TEXT_CORNERS, TEXT_POINT, Writer};
use super::lines::Junctions;
use super::surface::{Surface, side_name, write_seed_comments};
use crate::files::output::OutputPath;
use crate::{Error, Polycrystal, StagedFiles};

/// Gmsh's codes for elements.
const LINE: u32 = 1;
pub(crate) const TRIANGLE: u32 = 2;
const POINT: u32 = 15;

/// The extension of the script beside a mesh, which names what it holds.
const SCRIPT: &str = "geo";

pub(super) const FORMAT: Format = Format {
    extension: "msh",
    content: Content::BoundariesOrElements,
    bytes: |size| TEXT_POINT * size.mesh.points + (TEXT_CORNERS + 8) * size.mesh.triangles,
    write: Writer::Files(stage),
    extra: Extra {
        programs: "Gmsh",
        dimension: Some(Dimension::Three),
        beside: Some(Beside::File(SCRIPT)),
        ..Extra::NONE
    },
};

fn stage(polycrystal: &Polycrystal, output: &OutputPath<()>, files: &mut StagedFiles) -> Result<(), Error> {
    let script = OutputPath::check_as(output.path().with_extension(SCRIPT), ())?;
    let mesh = output.path().file_name().unwrap_or_default().to_string_lossy();
    if polycrystal.writes_elements() {
        output.stage(files, |out| match polycrystal.dimension() {
            Dimension::Two => plane::write(polycrystal, out),
            Dimension::Three => volumes::write(polycrystal, out),
        })?;
        // What an earlier run left would fill grains that are filled.
        if script.target().exists() {
            script.stage(files, |out| write_script_head(polycrystal, &mesh, out))?;
        }
        return Ok(());
    }
    output.stage(files, |out| write(&polycrystal.surface()?, polycrystal, out))?;
    script.stage(files, |out| write_script(&polycrystal.surface()?, polycrystal, &mesh, out))
}

/// Writes what opens the mesh file beside the script.
fn write_script_head(polycrystal: &Polycrystal, mesh: &str, out: &mut dyn Write) -> io::Result<()> {
    writeln!(out, "// grainsmooth {}", env!("CARGO_PKG_VERSION"))?;
    polycrystal.provenance().write_comments("// ", out)?;
    write_seed_comments(polycrystal.grains().renumbered(), "// ", out)?;
    writeln!(out, "Merge \"{mesh}\";")
}

/// Writes the script, which reads the mesh file of the given name beside it.
fn write_script(
    surface: &Surface<'_>,
    polycrystal: &Polycrystal,
    mesh: &str,
    out: &mut dyn Write,
) -> io::Result<()> {
    write_script_head(polycrystal, mesh, out)?;
    let grain_count = polycrystal.network.grain_count();
    let ConnectedParts { surface: connected, boundaries } = ConnectedParts::of(surface);
    let mut surfaces_of = vec![Vec::new(); surface.parts.len()];
    for (piece, boundary) in connected.parts.iter().zip(&boundaries) {
        surfaces_of[boundary.index()].push(tag(piece.boundary).to_string());
    }
    for part in &surface.parts {
        let ([from, to], tag) = (part.sides.map(side_name), tag(part.boundary));
        let (number, surfaces) = (part.boundary.0, surfaces_of[part.boundary.index()].join(", "));
        writeln!(out, "Physical Surface(\"boundary{number} {from} {to}\", {tag}) = {{{surfaces}}};")?;
    }
    // The first piece of a grain has its number; the others follow.
    let mut other_tags = grain_count + 1..;
    for (grain, parts) in connected.parts_of_grains(grain_count).iter().enumerate() {
        let first = grain + 1;
        let tags = std::iter::once(first).chain(other_tags.by_ref());
        let mut volumes = Vec::new();
        for (piece, tag) in pieces_of_grain(&connected, parts).iter().zip(tags) {
            let surfaces = piece.iter().map(|(part, is_inward)| {
                let sign = if *is_inward { "-" } else { "" };
                format!("{sign}{}", self::tag(connected.parts[*part].boundary))
            });
            let surfaces: Vec<String> = surfaces.collect();
            writeln!(out, "Surface Loop({tag}) = {{{}}};", surfaces.join(", "))?;
            writeln!(out, "Volume({tag}) = {{{tag}}};")?;
            volumes.push(tag.to_string());
        }
        writeln!(out, "Physical Volume(\"grain{grain}\", {first}) = {{{}}};", volumes.join(", "))?;
    }
    Ok(())
}

/// Writes the mesh file. Names stand in the script: meshio wants them for every cell, or for none.
fn write(surface: &Surface<'_>, polycrystal: &Polycrystal, out: &mut dyn Write) -> io::Result<()> {
    let surface = &ConnectedParts::of(surface).surface;
    let junctions = Junctions::of(surface);
    write_head(polycrystal, out)?;
    writeln!(out, "$Entities\n{} 0", entity_counts(surface, &junctions))?;
    write_entities(surface, &junctions, |_| None, out)?;
    writeln!(out, "$EndEntities")?;
    let count = surface.points.len();
    writeln!(out, "$Nodes\n{} {count} 1 {count}", block_count(surface, &junctions))?;
    write_nodes(surface, &junctions, out)?;
    writeln!(out, "$EndNodes")?;
    write_elements(surface, &junctions, out)
}

fn write_head(polycrystal: &Polycrystal, out: &mut dyn Write) -> io::Result<()> {
    write!(out, "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Comments\n{}", polycrystal.provenance().text())?;
    write_seed_comments(polycrystal.grains().renumbered(), "", out)?;
    writeln!(out, "$EndComments")
}

/// Numbers of points, curves and surfaces.
fn entity_counts(surface: &Surface<'_>, Junctions { lines, corners }: &Junctions) -> String {
    format!("{} {} {}", corners.len(), lines.len(), surface.parts.len())
}

/// The sum of them.
fn block_count(surface: &Surface<'_>, Junctions { lines, corners }: &Junctions) -> usize {
    corners.len() + lines.len() + surface.parts.len()
}

/// Writes points, curves, and surfaces with the physical groups that they may be in.
fn write_entities(
    surface: &Surface<'_>,
    junctions: &Junctions,
    group_of: impl Fn(BoundaryId) -> Option<usize>,
    out: &mut dyn Write,
) -> io::Result<()> {
    let Junctions { lines, corners } = junctions;
    let mut curves_of: BTreeMap<BoundaryId, Vec<usize>> = BTreeMap::new();
    for (tag, corner) in (1..).zip(corners) {
        let DVec3 { x, y, z } = surface.points[*corner as usize];
        writeln!(out, "{tag} {x:?} {y:?} {z:?} 0")?;
    }
    for (tag, line) in (1..).zip(lines) {
        write!(out, "{tag} {} 0", bounds(&surface.points, line.points.iter().copied()))?;
        let [start, end] =
            [line.points[0], line.points[line.points.len() - 1]].map(|end| corners.binary_search(&end));
        match (start, end) {
            (Ok(start), Ok(end)) => writeln!(out, " 2 {} -{}", start + 1, end + 1)?,
            _ => writeln!(out, " 0")?,
        }
        for boundary in &line.boundaries {
            curves_of.entry(*boundary).or_default().push(tag);
        }
    }
    for part in &surface.parts {
        let tag = tag(part.boundary);
        let curves = curves_of.get(&part.boundary).map(Vec::as_slice).unwrap_or_default();
        let group = group_of(part.boundary).map_or("0".to_owned(), |group| format!("1 {group}"));
        let bounds = bounds(&surface.points, surface.triangles_of(part).flatten());
        write!(out, "{tag} {bounds} {group} {}", curves.len())?;
        for curve in curves {
            write!(out, " {curve}")?;
        }
        writeln!(out)?;
    }
    Ok(())
}

/// The box around some points, as the format spells it.
fn bounds(all: &[DVec3], points: impl Iterator<Item = u32>) -> String {
    let (mut lower, mut upper) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for point in points.map(|point| all[point as usize]) {
        lower = lower.min(point);
        upper = upper.max(point);
    }
    format!("{:?} {:?} {:?} {:?} {:?} {:?}", lower.x, lower.y, lower.z, upper.x, upper.y, upper.z)
}

/// Writes a block of nodes for each point, curve and surface, each node with the first that it is on.
fn write_nodes(surface: &Surface<'_>, junctions: &Junctions, out: &mut dyn Write) -> io::Result<()> {
    let Junctions { lines, corners } = junctions;
    let mut is_written = vec![false; surface.points.len()];
    let mut block = |dimension: usize, tag: usize, points: &mut dyn Iterator<Item = u32>| {
        let is_new = |point: &u32| !std::mem::replace(&mut is_written[*point as usize], true);
        let new: Vec<u32> = points.filter(is_new).collect();
        write_block([dimension, tag], &new, &surface.points, out)
    };
    for (tag, corner) in (1..).zip(corners) {
        block(0, tag, &mut std::iter::once(*corner))?;
    }
    for (tag, line) in (1..).zip(lines) {
        block(1, tag, &mut line.points.iter().copied())?;
    }
    for part in &surface.parts {
        block(2, tag(part.boundary), &mut surface.triangles_of(part).flatten())?;
    }
    Ok(())
}

fn write_elements(surface: &Surface<'_>, junctions: &Junctions, out: &mut dyn Write) -> io::Result<()> {
    let Junctions { lines, corners } = junctions;
    let segments: usize = lines.iter().map(|line| line.points.len() - 1).sum();
    let count = corners.len() + segments + surface.triangle_count();
    writeln!(out, "$Elements\n{} {count} 1 {count}", block_count(surface, junctions))?;
    let mut element = 1u64..;
    let mut next = move || element.next().unwrap_or_default();
    for (tag, corner) in (1..).zip(corners) {
        writeln!(out, "0 {tag} {POINT} 1\n{} {}", next(), u64::from(*corner) + 1)?;
    }
    for (tag, line) in (1..).zip(lines) {
        writeln!(out, "1 {tag} {LINE} {}", line.points.len() - 1)?;
        for ends in line.points.windows(2) {
            writeln!(out, "{} {} {}", next(), u64::from(ends[0]) + 1, u64::from(ends[1]) + 1)?;
        }
    }
    write_triangles(surface, TRIANGLE, |corners| corners, next, out)?;
    writeln!(out, "$EndElements")
}

/// Writes a block of triangles for each surface, of a kind of Gmsh with the nodes that a triangle has.
fn write_triangles<Nodes: AsRef<[u32]>>(
    surface: &Surface<'_>,
    kind: u32,
    nodes_of: impl Fn([u32; 3]) -> Nodes,
    mut next: impl FnMut() -> u64,
    out: &mut dyn Write,
) -> io::Result<()> {
    for part in &surface.parts {
        writeln!(out, "2 {} {kind} {}", tag(part.boundary), surface.triangles_of(part).count())?;
        for triangle in surface.triangles_of(part) {
            write_element(next(), nodes_of(triangle).as_ref(), out)?;
        }
    }
    Ok(())
}

fn write_element(number: u64, nodes: &[u32], out: &mut dyn Write) -> io::Result<()> {
    write!(out, "{number}")?;
    nodes.iter().try_for_each(|node| write!(out, " {}", u64::from(*node) + 1))?;
    writeln!(out)
}

/// Writes a block of nodes.
fn write_block(
    [dimension, tag]: [usize; 2],
    nodes: &[u32],
    points: &[DVec3],
    out: &mut dyn Write,
) -> io::Result<()> {
    writeln!(out, "{dimension} {tag} 0 {}", nodes.len())?;
    nodes.iter().try_for_each(|node| writeln!(out, "{}", u64::from(*node) + 1))?;
    let mut places = nodes.iter().map(|node| points[*node as usize]);
    places.try_for_each(|DVec3 { x, y, z }| writeln!(out, "{x:?} {y:?} {z:?}"))
}

/// Number of a boundary's surface.
fn tag(boundary: BoundaryId) -> usize {
    boundary.index() + 1
}
