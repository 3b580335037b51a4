//! Writes a .tess file; every number gives the same double back.

use std::collections::BTreeMap;
use std::io::{self, Write};

use glam::DVec3;
use texture::CrystalSymmetry;
use voronoi::{Dimension, Wall};

use super::super::ori::write as write_ori;
use crate::GrainTexture;
use crate::input::tess::{Oriented, POLYHEDRON, Tess, TessCopy, TessDomain, TessPeriodicity};

/// Writes the file, with the cells' orientations if they have some.
pub(crate) fn write(tess: &Tess, texture: Option<&GrainTexture>, out: &mut dyn Write) -> io::Result<()> {
    let dimension = tess.dimension.axes();
    let kind = if tess.periodicity.is_some() { "periodic" } else { "standard" };
    writeln!(out, "***tess\n **format\n   3.5\n **general\n   {dimension} {kind}")?;
    let cell_count = if dimension == 2 { tess.faces.len() } else { tess.polyhedra.len() };
    writeln!(out, " **cell\n  {cell_count}")?;
    if !tess.ids.is_empty() {
        let ids: Vec<String> = tess.ids.iter().map(|id| (u64::from(*id) + 1).to_string()).collect();
        writeln!(out, "  *id\n   {}", ids.join(" "))?;
    }
    if !tess.groups.is_empty() {
        let groups: Vec<String> = tess.groups.iter().map(u32::to_string).collect();
        writeln!(out, "  *group\n   {}", groups.join(" "))?;
    }
    // Neper knows no others.
    let symmetry = texture.and_then(GrainTexture::symmetry).filter(|symmetry| {
        matches!(
            symmetry,
            CrystalSymmetry::Triclinic | CrystalSymmetry::Octahedral | CrystalSymmetry::Hexagonal
        )
    });
    if let Some(symmetry) = symmetry {
        writeln!(out, "  *crysym\n   {symmetry}")?;
    }
    if !tess.seeds.is_empty() {
        writeln!(out, "  *seed")?;
    }
    for (id, seed) in (1..).zip(&tess.seeds) {
        writeln!(out, "   {id} {} {:?}", coordinates(seed.position), seed.radius)?;
    }
    if let Some(texture) = texture {
        writeln!(out, "  *ori\n   rodrigues:passive")?;
        write_ori(texture.orientations(), out)?;
    }
    writeln!(out, " **vertex\n  {}", tess.vertices.len())?;
    for (id, vertex) in (1..).zip(&tess.vertices) {
        writeln!(out, "   {id} {} 0", coordinates(*vertex))?;
    }
    writeln!(out, " **edge\n  {}", tess.edges.len())?;
    for (id, [start, end]) in (1..).zip(&tess.edges) {
        writeln!(out, "   {id} {} {} 0", start + 1, end + 1)?;
    }
    writeln!(out, " **face\n  {}", tess.faces.len())?;
    for (id, face) in (1..).zip(&tess.faces) {
        let corners: Vec<String> = face.vertices.iter().map(|vertex| (vertex + 1).to_string()).collect();
        writeln!(out, "   {id} {} {}", corners.len(), corners.join(" "))?;
        writeln!(out, "     {} {}", face.edges.len(), signed(&face.edges))?;
        let [d, a, b, c] = face.plane;
        // No state, and no point that the face is bent to.
        writeln!(out, "     {d:?} {a:?} {b:?} {c:?}\n     0 0 0 0 0")?;
    }
    if dimension == 3 {
        writeln!(out, " **polyhedron\n  {cell_count}")?;
        for (id, faces) in (1..).zip(&tess.polyhedra) {
            writeln!(out, "   {id} {} {}", faces.len(), signed(faces))?;
        }
    }
    if !tess.domain.walls.is_empty() {
        write_domain(tess, out)?;
    }
    if let Some(periodicity) = &tess.periodicity {
        write_periodicity(periodicity, tess, out)?;
    }
    writeln!(out, "***end")
}

fn write_periodicity(periodicity: &TessPeriodicity, tess: &Tess, out: &mut dyn Write) -> io::Result<()> {
    let [x, y, z] = periodicity.axes.map(u8::from);
    writeln!(out, " **periodicity\n  *general\n   {x} {y} {z}\n   {}", coordinates(periodicity.lengths))?;
    // Images of seeds are numbered on from the seeds.
    writeln!(out, "  *seed\n   {}", periodicity.seeds.len())?;
    for (id, (cell, [x, y, z])) in (tess.seeds.len() + 1..).zip(&periodicity.seeds) {
        writeln!(out, "   {id} {} {x} {y} {z}", cell + 1)?;
    }
    let mut part = |name: &str, copies: &[TessCopy], has_sense: bool| {
        writeln!(out, "  *{name}\n   {}", copies.len())?;
        for TessCopy { secondary, primary, translation: [x, y, z] } in copies {
            let sense = match (has_sense, primary.is_reversed) {
                (false, _) => "",
                (true, false) => " 1",
                (true, true) => " -1",
            };
            writeln!(out, "   {} {} {x} {y} {z}{sense}", secondary + 1, primary.index + 1)?;
        }
        Ok(())
    };
    part("vertex", &periodicity.vertices, false)?;
    part("edge", &periodicity.edges, true)?;
    match tess.dimension {
        Dimension::Two => Ok(()),
        Dimension::Three => part("face", &periodicity.faces, true),
    }
}

/// The domain: its corners, edges and faces, each with the vertices, edges and faces of the tessellation that lie on it.
fn write_domain(tess: &Tess, out: &mut dyn Write) -> io::Result<()> {
    let domain = &tess.domain;
    let is_polyhedron = domain.kind == POLYHEDRON;
    let frame = Frame::new(tess);
    writeln!(out, " **domain\n  *general\n   {}\n  *vertex\n   {}", domain.kind, frame.corners.len())?;
    for (id, corner) in (1..).zip(&frame.corners) {
        let at = frame.vertices_at.get(corner).map_or(&[][..], |vertices| vertices);
        let position = match at {
            [vertex, ..] if is_polyhedron => tess.vertices[*vertex as usize],
            // Across periodic axes cells have no vertices on walls.
            _ => DVec3::from_array(std::array::from_fn(|axis| {
                let is_upper = corner.contains(&Wall::ALL[2 * axis + 1]);
                if is_upper { domain.upper[axis] } else { domain.lower[axis] }
            })),
        };
        writeln!(out, "   {id} {} {}\n      {}", coordinates(position), name(domain, corner), list(at))?;
    }
    writeln!(out, "  *edge\n   {}", frame.edges.len())?;
    for (id, edge) in (1..).zip(&frame.edges) {
        let along = match edge[..] {
            [wall] => &domain.walls[wall.index()][..],
            _ => frame.edges_along.get(edge).map_or(&[][..], |edges| edges),
        };
        let corners: Vec<String> =
            frame.corners_on(edge).iter().map(|corner| (corner + 1).to_string()).collect();
        writeln!(
            out,
            "   {id} {} {}\n     line\n     0\n     {}\n     {}",
            corners.len(),
            corners.join(" "),
            name(domain, edge),
            list(along)
        )?;
    }
    if tess.dimension == Dimension::Two {
        return Ok(());
    }
    let walls = || walls(domain).filter(|(_, faces)| !is_polyhedron || !faces.is_empty());
    writeln!(out, "  *face\n   {}", walls().count())?;
    for (id, (wall, faces)) in (1..).zip(walls()) {
        let (corners, edges) = frame.around(wall);
        let numbers = |ids: &[usize]| ids.iter().map(|id| (id + 1).to_string()).collect::<Vec<_>>().join(" ");
        writeln!(
            out,
            "   {id} {} {}\n     {} {}\n     plane",
            corners.len(),
            numbers(&corners),
            edges.len(),
            numbers(&edges)
        )?;
        // Neper's planes of the domain point inward.
        let [d, a, b, c] = if is_polyhedron {
            tess.faces[faces[0] as usize].plane.map(|number| -number)
        } else {
            let inward = -wall.outward_normal();
            let place = if wall.is_upper() { domain.upper } else { domain.lower };
            [inward.dot(place), inward.x, inward.y, inward.z]
        };
        writeln!(out, "     4 {d:?} {a:?} {b:?} {c:?}")?;
        writeln!(out, "     {}\n     {}", name(domain, &[wall]), list(faces))?;
    }
    Ok(())
}

/// The walls with what lies on each.
fn walls(domain: &TessDomain) -> impl Iterator<Item = (Wall, &Vec<u32>)> {
    (0u32..).map(Wall::numbered).zip(&domain.walls)
}

/// The corners and edges of the domain by the walls that meet there, and what lies on them.
struct Frame {
    corners: Vec<Vec<Wall>>,
    edges: Vec<Vec<Wall>>,
    vertices_at: BTreeMap<Vec<Wall>, Vec<u32>>,
    edges_along: BTreeMap<Vec<Wall>, Vec<u32>>,
}

impl Frame {
    fn new(tess: &Tess) -> Self {
        let mut walls_of_vertices = vec![Vec::new(); tess.vertices.len()];
        for (wall, parts) in walls(&tess.domain) {
            for part in parts.iter().map(|&part| part as usize) {
                let vertices = match tess.dimension {
                    Dimension::Two => &tess.edges[part][..],
                    Dimension::Three => &tess.faces[part].vertices,
                };
                for &vertex in vertices {
                    let walls: &mut Vec<Wall> = &mut walls_of_vertices[vertex as usize];
                    if !walls.contains(&wall) {
                        walls.push(wall);
                    }
                }
            }
        }
        let walls_at_corner = usize::from(tess.dimension.axes());
        let mut vertices_at = BTreeMap::<_, Vec<u32>>::new();
        for (vertex, walls) in (0u32..).zip(&walls_of_vertices) {
            if walls.len() >= walls_at_corner {
                vertices_at.entry(walls.clone()).or_default().push(vertex);
            }
        }
        let mut edges_along = BTreeMap::<_, Vec<u32>>::new();
        for (edge, [start, end]) in (0u32..).zip(&tess.edges) {
            let [start, end] = [start, end].map(|end| &walls_of_vertices[*end as usize]);
            let common: Vec<Wall> = start.iter().copied().filter(|wall| end.contains(wall)).collect();
            if common.len() == 2 {
                edges_along.entry(common).or_default().push(edge);
            }
        }
        let [x0, x1, y0, y1, z0, z1] = Wall::ALL;
        let (corners, edges) = match tess.dimension {
            Dimension::Two if tess.domain.kind == POLYHEDRON => (
                vertices_at.keys().cloned().collect(),
                walls(&tess.domain)
                    .filter(|(_, parts)| !parts.is_empty())
                    .map(|(wall, _)| vec![wall])
                    .collect(),
            ),
            Dimension::Three if tess.domain.kind == POLYHEDRON => {
                (vertices_at.keys().cloned().collect(), edges_along.keys().cloned().collect())
            }
            // In Neper's order.
            Dimension::Two => (
                vec![vec![x0, y0], vec![x1, y0], vec![x1, y1], vec![x0, y1]],
                vec![vec![x0], vec![x1], vec![y0], vec![y1]],
            ),
            Dimension::Three => {
                let corner = |x, y, z| vec![x, y, z];
                let around = [[x0, y0], [x1, y0], [x1, y1], [x0, y1]];
                let corners = [z0, z1].into_iter().flat_map(|z| around.map(|[x, y]| corner(x, y, z)));
                let upright = around.map(|walls| walls.to_vec());
                let flat = [z0, z1].into_iter().flat_map(|z| [y0, x1, y1, x0].map(|side| vec![side, z]));
                (corners.collect(), upright.into_iter().chain(flat).collect())
            }
        };
        Self { corners, edges, vertices_at, edges_along }
    }

    /// The corners on an edge or a wall.
    fn corners_on(&self, walls: &[Wall]) -> Vec<usize> {
        (0..self.corners.len()).filter(|&corner| has_all(&self.corners[corner], walls)).collect()
    }

    /// The corners and edges around a wall, each edge from its corner to the next.
    fn around(&self, wall: Wall) -> (Vec<usize>, Vec<usize>) {
        let of_wall = self.corners_on(&[wall]);
        let sides: Vec<usize> =
            (0..self.edges.len()).filter(|&edge| self.edges[edge].contains(&wall)).collect();
        let is_at = |edge: usize, corner: usize| has_all(&self.corners[corner], &self.edges[edge]);
        let (mut corners, mut edges) = (vec![of_wall[0]], Vec::new());
        while edges.len() < of_wall.len() {
            let last = corners[corners.len() - 1];
            let step =
                sides.iter().filter(|edge| !edges.contains(*edge) && is_at(**edge, last)).find_map(|edge| {
                    let other = of_wall.iter().find(|corner| **corner != last && is_at(*edge, **corner));
                    other.map(|corner| (*edge, *corner))
                });
            let Some((edge, next)) = step else { break };
            edges.push(edge);
            corners.push(next);
        }
        corners.pop();
        (corners, edges)
    }
}

fn has_all(walls: &[Wall], wanted: &[Wall]) -> bool {
    wanted.iter().all(|wall| walls.contains(wall))
}

/// The name of what lies on all these walls, such as `x0y1`.
fn name(domain: &TessDomain, walls: &[Wall]) -> String {
    walls.iter().map(|wall| domain.label(*wall)).collect()
}

fn list(ids: &[u32]) -> String {
    let numbers = ids.iter().map(|id| format!(" {}", u64::from(*id) + 1));
    format!("{}{}", ids.len(), numbers.collect::<String>())
}

fn signed(parts: &[Oriented]) -> String {
    let number = |part: &Oriented| {
        let sign = if part.is_reversed { "-" } else { "" };
        format!("{sign}{}", u64::from(part.index) + 1)
    };
    parts.iter().map(number).collect::<Vec<_>>().join(" ")
}

fn coordinates(point: DVec3) -> String {
    format!("{:?} {:?} {:?}", point.x, point.y, point.z)
}
