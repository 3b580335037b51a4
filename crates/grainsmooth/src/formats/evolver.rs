//! Surface Evolver's datafile: every grain a body of fixed volume, walls as constraints, and tension between grains only.
//!
//! <https://kenbrakke.com/evolver/html/datafile.htm>. It counts from 1, so grain 0 is body 1.

use std::io::{self, Write};

use glam::DVec3;
use polycrystal::{WallSet, WallSets};
use voronoi::{Domain, Wall};

use super::surface::{Surface, side_name};
use crate::Config;

/// Writes the file; each point stays on its walls, and each body keeps its volume.
pub(crate) fn write(
    surface: &Surface<'_>,
    (domain, sets): (&Domain, &WallSets),
    walls: &[WallSet],
    volumes: &[f64],
    config: &Config,
    out: &mut dyn Write,
) -> io::Result<()> {
    writeln!(out, "// grainsmooth {}", env!("CARGO_PKG_VERSION"))?;
    config.write_comments("// ", out)?;
    writeln!(out)?;
    for wall in domain.walls() {
        writeln!(out, "constraint {}\nformula: {}\n", wall.number() + 1, formula(domain, wall))?;
    }
    writeln!(out, "vertices")?;
    for (id, (DVec3 { x, y, z }, walls)) in (1u64..).zip(surface.points.iter().zip(walls)) {
        writeln!(out, "{id} {x:?} {y:?} {z:?}{}", constraints(sets.walls(*walls)))?;
    }

    let edges = edges(surface);
    writeln!(out, "\nedges")?;
    for (id, [a, b]) in (1u64..).zip(&edges) {
        let common = sets.walls(sets.intersection(walls[*a as usize], walls[*b as usize]));
        writeln!(out, "{id} {} {}{}", u64::from(*a) + 1, u64::from(*b) + 1, constraints(common))?;
    }

    writeln!(out, "\nfaces")?;
    let mut next = 1u64..;
    let mut ids = Vec::with_capacity(surface.parts.len());
    for part in &surface.parts {
        let first = next.start;
        let [from, to] = part.sides.map(side_name);
        writeln!(out, "// boundary {}: {from} to {to}", part.boundary.0)?;
        for (corners, face) in surface.triangles_of(part).zip(&mut next) {
            write!(out, "{face}")?;
            let [a, b, c] = corners;
            for [from, to] in [[a, b], [b, c], [c, a]] {
                let sign = if from < to { "" } else { "-" };
                let edge = edges.binary_search(&[from.min(to), from.max(to)]).unwrap_or_default() + 1;
                write!(out, " {sign}{edge}")?;
            }
            let common = corners.map(|corner| walls[corner as usize]);
            let common = sets.walls(sets.intersection(sets.intersection(common[0], common[1]), common[2]));
            // Walls carry no energy.
            let density = if common.is_empty() { "" } else { " density 0" };
            writeln!(out, "{}{density}", constraints(common))?;
        }
        ids.push(first..next.start);
    }

    writeln!(out, "\nbodies")?;
    for (body, (parts, volume)) in (1..).zip(surface.parts_of_grains(volumes.len()).iter().zip(volumes)) {
        write!(out, "{body}")?;
        for (part, is_inward) in parts {
            let sign = if *is_inward { "-" } else { "" };
            for face in ids[*part].clone() {
                write!(out, " {sign}{face}")?;
            }
        }
        writeln!(out, " volume {volume:?}")?;
    }
    writeln!(out, "\nread")
}

/// All edges, smaller point first, sorted.
fn edges(surface: &Surface<'_>) -> Vec<[u32; 2]> {
    let of_triangle = |[a, b, c]: [u32; 3]| [[a, b], [b, c], [c, a]].map(|[a, b]| [a.min(b), a.max(b)]);
    let mut edges: Vec<[u32; 2]> = surface.triangles().flat_map(of_triangle).collect();
    edges.sort_unstable();
    edges.dedup();
    edges
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
