//! Writes the mesh of the benches as an OFF file to standard output, for the peers: `random` or `curve` names the order.
#![allow(clippy::print_stdout)]

#[path = "../sphere/mod.rs"]
mod sphere;

use std::io::Write;

use sphere::{sphere_hull, sphere_hull_along_curve};

fn main() -> std::io::Result<()> {
    let random = std::env::args().nth(1).as_deref() == Some("random");
    let (triangles, points) = if random { sphere_hull(10_002) } else { sphere_hull_along_curve(10_002) };
    let mut out = std::io::BufWriter::new(std::io::stdout().lock());
    writeln!(out, "OFF\n{} {} 0", points.len(), triangles.len())?;
    points.iter().try_for_each(|p| writeln!(out, "{:?} {:?} {:?}", p.x, p.y, p.z))?;
    triangles.iter().try_for_each(|[a, b, c]| writeln!(out, "3 {a} {b} {c}"))?;
    out.flush()
}
