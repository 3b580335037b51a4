//! Writes a .tess file; every number gives the same double back.

use std::io::{self, Write};

use glam::DVec3;
use voronoi::{Dimension, Wall};

use super::{Oriented, Tess, TessCopy, TessDomain, TessPeriodicity};

/// Writes the file.
pub(crate) fn write(tess: &Tess, out: &mut dyn Write) -> io::Result<()> {
    let dimension = if tess.dimension == Dimension::Two { 2 } else { 3 };
    let kind = if tess.periodicity.is_some() { "periodic" } else { "standard" };
    writeln!(out, "***tess\n **format\n   3.5\n **general\n   {dimension} {kind}")?;
    let cell_count = if dimension == 2 { tess.faces.len() } else { tess.polyhedra.len() };
    writeln!(out, " **cell\n  {cell_count}")?;
    if !tess.seeds.is_empty() {
        writeln!(out, "  *seed")?;
    }
    for (id, seed) in (1..).zip(&tess.seeds) {
        writeln!(out, "   {id} {} {:?}", coordinates(seed.position), seed.radius)?;
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
        for TessCopy { secondary, primary, shift: [x, y, z] } in copies {
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

/// The box: its corners, edges and faces, each with the vertices, edges and faces of the tessellation that lie on it.
fn write_domain(tess: &Tess, out: &mut dyn Write) -> io::Result<()> {
    let domain = &tess.domain;
    let frame = Frame::new(tess);
    writeln!(out, " **domain\n  *general\n   {}\n  *vertex\n   {}", domain.kind, frame.corners.len())?;
    for (id, corner) in (1..).zip(&frame.corners) {
        let position: [f64; 3] = std::array::from_fn(|axis| {
            if corner.contains(&Wall::ALL[2 * axis + 1]) { domain.upper[axis] } else { domain.lower[axis] }
        });
        let vertices = (0u32..).zip(&frame.walls_of_vertices);
        let at: Vec<u32> = vertices.filter(|(_, walls)| has_all(walls, corner)).map(|(id, _)| id).collect();
        writeln!(out, "   {id} {} {}\n      {}", coordinates(position.into()), name(corner), list(&at))?;
    }
    writeln!(out, "  *edge\n   {}", frame.edges.len())?;
    for (id, edge) in (1..).zip(&frame.edges) {
        let corners = frame.corners_on(edge);
        let along: Vec<u32> = match edge[..] {
            [wall] => domain.walls[wall.index()].clone(),
            _ => {
                let on_both = |ends: &[u32; 2]| {
                    ends.iter().all(|end| has_all(&frame.walls_of_vertices[*end as usize], edge))
                };
                (0u32..).zip(&tess.edges).filter(|(_, ends)| on_both(ends)).map(|(id, _)| id).collect()
            }
        };
        let corners: Vec<String> = corners.iter().map(|corner| (corner + 1).to_string()).collect();
        writeln!(
            out,
            "   {id} 2 {}\n     line\n     0\n     {}\n     {}",
            corners.join(" "),
            name(edge),
            list(&along)
        )?;
    }
    if tess.dimension == Dimension::Two {
        return Ok(());
    }
    writeln!(out, "  *face\n   {}", domain.walls.len())?;
    for (wall, faces) in Wall::ALL.iter().zip(&domain.walls) {
        let (corners, edges) = frame.around(*wall);
        let numbers = |ids: &[usize]| ids.iter().map(|id| (id + 1).to_string()).collect::<Vec<_>>().join(" ");
        writeln!(
            out,
            "   {} 4 {}\n     4 {}\n     plane",
            wall.number() + 1,
            numbers(&corners),
            numbers(&edges)
        )?;
        // Neper's planes of the domain point inward.
        let inward = -wall.outward_normal();
        let place = if wall.is_upper() { domain.upper } else { domain.lower };
        writeln!(out, "     4 {:?} {}", inward.dot(place), coordinates(inward))?;
        writeln!(out, "     {}\n     {}", name(&[*wall]), list(faces))?;
    }
    Ok(())
}

/// The corners and edges of the box by the walls that meet there, and the walls of each vertex.
struct Frame {
    corners: Vec<Vec<Wall>>,
    edges: Vec<Vec<Wall>>,
    walls_of_vertices: Vec<Vec<Wall>>,
}

impl Frame {
    fn new(tess: &Tess) -> Self {
        let [x0, x1, y0, y1, z0, z1] = Wall::ALL;
        let (corners, edges) = match tess.dimension {
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
        let mut walls_of_vertices = vec![Vec::new(); tess.vertices.len()];
        for (wall, parts) in Wall::ALL.iter().zip(&tess.domain.walls) {
            for part in parts.iter().map(|&part| part as usize) {
                let vertices = match tess.dimension {
                    Dimension::Two => &tess.edges[part][..],
                    Dimension::Three => &tess.faces[part].vertices,
                };
                for &vertex in vertices {
                    let walls: &mut Vec<Wall> = &mut walls_of_vertices[vertex as usize];
                    if !walls.contains(wall) {
                        walls.push(*wall);
                    }
                }
            }
        }
        Self { corners, edges, walls_of_vertices }
    }

    /// The corners on an edge or a wall.
    fn corners_on(&self, walls: &[Wall]) -> Vec<usize> {
        (0..self.corners.len()).filter(|&corner| has_all(&self.corners[corner], walls)).collect()
    }

    /// The corners and edges around a wall, each edge from its corner to the next.
    fn around(&self, wall: Wall) -> (Vec<usize>, Vec<usize>) {
        let of_wall = self.corners_on(&[wall]);
        let between = |a: usize, b: usize| {
            let is_between =
                |edge: &Vec<Wall>| has_all(&self.corners[a], edge) && has_all(&self.corners[b], edge);
            self.edges.iter().position(is_between)
        };
        let (mut corners, mut edges) = (vec![of_wall[0]], Vec::new());
        while edges.len() < of_wall.len() {
            let last = corners[corners.len() - 1];
            let is_next = |corner: &&usize| {
                between(last, **corner).is_some_and(|edge| !edges.contains(&edge)) && **corner != last
            };
            let Some(&next) = of_wall.iter().find(is_next) else { break };
            edges.extend(between(last, next));
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
fn name(walls: &[Wall]) -> String {
    walls.iter().map(|wall| TessDomain::label(*wall)).collect()
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
