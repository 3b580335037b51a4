//! Surface Evolver's datafile: grains as bodies of fixed volume, walls as constraints, and tension as the network has it.
//!
//! Grains fill the domain, so that one volume follows from the others, and makes Evolver's system singular if it is held as well. On a
//! torus Evolver leaves one out itself; between walls the last body goes without.
//!
//! <https://kenbrakke.com/evolver/html/datafile.htm>. It counts from 1, so grain 0 is body 1. A periodic network is one of
//! Evolver's torus model: each point, edge and triangle once, and with each edge the number of periods that it crosses. An axis
//! with walls then has the box as its period too, which nothing crosses.

use std::io::{self, Write};

use glam::DVec3;
use polycrystal::{Network, Side};
use voronoi::{Dimension, Domain, Wall};

use super::format::{Content, Extra, Format, TEXT_CORNERS, TEXT_POINT, Writer};
use super::surface::{Part, side_name, write_seed_comments};
use crate::Polycrystal;

pub(super) const FORMAT: Format = Format {
    extension: "fe",
    content: Content::Boundaries,
    bytes: |size| TEXT_POINT * size.mesh.points + TEXT_CORNERS * (size.mesh.edges + size.mesh.triangles),
    write: Writer::File(write),
    extra: Extra { programs: "Surface Evolver", dimension: Some(Dimension::Three), ..Extra::NONE },
};

/// Writes the file; each point stays on its walls.
fn write(polycrystal: &Polycrystal, out: &mut dyn Write) -> io::Result<()> {
    let (surface, network) = (polycrystal.surface()?, &polycrystal.network);
    let level = network.finest_level();
    let (domain, sets, walls) = (network.domain(), network.wall_sets(), &level.walls);
    writeln!(out, "// grainsmooth {}", env!("CARGO_PKG_VERSION"))?;
    polycrystal.provenance().write_comments("// ", out)?;
    write_seed_comments(polycrystal.grains().renumbered(), "// ", out)?;
    writeln!(out)?;
    if domain.is_periodic() {
        // Filled, so that Evolver itself leaves out one of the volumes.
        let DVec3 { x, y, z } = domain.size();
        writeln!(out, "torus_filled\nperiods\n{x:?} 0 0\n0 {y:?} 0\n0 0 {z:?}\n")?;
    }
    for wall in domain.walls() {
        writeln!(out, "constraint {}\nformula: {}\n", wall.number() + 1, formula(domain, wall))?;
    }

    let places = places(network, &surface.points);
    writeln!(out, "vertices")?;
    let mut ids = vec![0; places.len()];
    let originals = (0..places.len()).filter(|&point| places[point].original as usize == point);
    for (id, point) in (1u64..).zip(originals) {
        ids[point] = id;
        let DVec3 { x, y, z } = places[point].position;
        writeln!(out, "{id} {x:?} {y:?} {z:?}{}", constraints(sets.walls(walls[point])))?;
    }

    let parts: Vec<(&Part, [Side; 2])> =
        surface.parts.iter().filter_map(|part| once(part, network)).collect();
    let mut edges: Vec<Edge> = parts
        .iter()
        .flat_map(|(part, _)| surface.triangles_of(part))
        .flat_map(|corners| edges_around(corners, &places).map(|(edge, _)| edge))
        .collect();
    edges.sort_unstable();
    edges.dedup();
    writeln!(out, "\nedges")?;
    for (id, edge) in (1u64..).zip(&edges) {
        let [a, b] = edge.ends.map(|end| end as usize);
        write!(out, "{id} {} {}", ids[a], ids[b])?;
        if domain.is_periodic() {
            out.write_all(wraps(edge.periods)?.as_bytes())?;
        }
        writeln!(out, "{}", constraints(sets.walls(sets.intersection(walls[a], walls[b]))))?;
    }

    writeln!(out, "\nfaces")?;
    let mut next = 1u64..;
    let mut bodies = vec![Vec::new(); network.grain_count()];
    for (part, sides) in &parts {
        let first = next.start;
        let [from, to] = sides.map(side_name);
        writeln!(out, "// boundary {}: {from} to {to}", part.boundary.0)?;
        let tension = network.tensions()[part.boundary.index()];
        for (corners, face) in surface.triangles_of(part).zip(&mut next) {
            write!(out, "{face}")?;
            for (edge, is_reversed) in edges_around(corners, &places) {
                let sign = if is_reversed { "-" } else { "" };
                let edge = edges.binary_search(&edge).expect("the edges of all triangles are listed") + 1;
                write!(out, " {sign}{edge}")?;
            }
            let [a, b, c] = corners.map(|corner| walls[corner as usize]);
            write!(out, "{}", constraints(sets.walls(sets.intersection(sets.intersection(a, b), c))))?;
            writeln!(out, "{}", density(tension))?;
        }
        for (side, sign) in sides.iter().zip(["", "-"]) {
            if let Side::Grain(grain) = side {
                bodies[grain.index()].push((sign, first..next.start));
            }
        }
    }

    writeln!(out, "\nbodies")?;
    let last = bodies.len();
    for (body, (faces, volume)) in (1..).zip(bodies.into_iter().zip(network.cell_volumes())) {
        write!(out, "{body}")?;
        for (sign, face) in faces.into_iter().flat_map(|(sign, range)| range.map(move |face| (sign, face))) {
            write!(out, " {sign}{face}")?;
        }
        let is_held = domain.is_periodic() || body < last;
        writeln!(out, "{} volume {volume:?}", if is_held { "" } else { " // follows from the others:" })?;
    }
    writeln!(out, "\nread")
}

/// Where a point is on the torus.
#[derive(Clone, Copy)]
struct Place {
    /// The point that this one is a copy of, or itself.
    original: u32,
    /// The original moved into the box along the periodic axes.
    position: DVec3,
    /// How many periods the point is from there.
    periods: [i32; 3],
}

fn places(network: &Network, points: &[DVec3]) -> Vec<Place> {
    let domain = network.domain();
    let place = |(original, point): (u32, &DVec3)| {
        let periods = ((point - domain.lower()) / domain.size()).floor();
        let periods = DVec3::select(domain.periodic(), periods, DVec3::ZERO);
        Place { original, position: point - periods * domain.size(), periods: periods.as_ivec3().to_array() }
    };
    let mut places: Vec<Place> = (0..).zip(points).map(place).collect();
    for pair in &network.finest().copies().vertices {
        let original = places[pair.primary as usize];
        let periods = [0, 1, 2].map(|axis| original.periods[axis] + i32::from(pair.translation.0[axis]));
        places[pair.secondary as usize] = Place { periods, ..original };
    }
    places
}

/// An edge on the torus, or in a domain with walls only.
#[derive(PartialEq, Eq, PartialOrd, Ord)]
struct Edge {
    /// Original points, the smaller number first.
    ends: [u32; 2],
    /// How many periods it crosses from the first to the second.
    periods: [i32; 3],
}

/// The edges around a triangle, and whether it runs along them from the second end to the first.
fn edges_around([a, b, c]: [u32; 3], places: &[Place]) -> [(Edge, bool); 3] {
    [[a, b], [b, c], [c, a]].map(|ends| {
        let edge = |ends: [u32; 2]| {
            let [from, to] = ends.map(|end| places[end as usize]);
            let periods = [0, 1, 2].map(|axis| to.periods[axis] - from.periods[axis]);
            Edge { ends: [from.original, to.original], periods }
        };
        let (along, against) = (edge(ends), edge([ends[1], ends[0]]));
        if against < along { (against, true) } else { (along, false) }
    })
}

/// A boundary and what it lies between; nothing for the copy of another one.
fn once<'a>(part: &'a Part, network: &Network) -> Option<(&'a Part, [Side; 2])> {
    let boundary = network.boundaries()[part.boundary.index()];
    match boundary.twin {
        None => Some((part, part.sides)),
        Some(twin) if part.boundary < twin.boundary => {
            Some((part, boundary.sides_across(network.boundaries())))
        }
        Some(_) => None,
    }
}

/// An edge's crossings of the walls of the box, axis by axis.
fn wraps(periods: [i32; 3]) -> io::Result<String> {
    let sign = |(axis, count): (&str, i32)| match count {
        0 => Ok(" *"),
        1 => Ok(" +"),
        -1 => Ok(" -"),
        _ => Err(io::Error::other(format!(
            "an edge is longer than the period along {axis}, which Surface Evolver cannot read; take more levels"
        ))),
    };
    ["x", "y", "z"].into_iter().zip(periods).map(sign).collect()
}

fn formula(domain: &Domain, wall: Wall) -> String {
    if let Some((axis, coordinate)) = domain.across_axis(wall) {
        return format!("{} = {coordinate:?}", ["x", "y", "z"][axis]);
    }
    let (DVec3 { x, y, z }, distance) = domain.wall_equation(wall);
    format!("({x:?})*x + ({y:?})*y + ({z:?})*z = {distance:?}")
}

fn constraints(walls: &[Wall]) -> String {
    if walls.is_empty() {
        return String::new();
    }
    // Three walls hold a point; more, as in the apex of a pyramid, would hold it twice.
    let numbers = walls.iter().take(3).map(|wall| format!(" {}", wall.number() + 1));
    format!(" constraints{}", numbers.collect::<String>())
}

/// Energy for each area, which is 1 where nothing is said.
fn density(tension: f64) -> String {
    if tension == 1.0 { String::new() } else { format!(" density {tension:?}") }
}
