//! Refine the connectivity once, then move the control points as often as you like: each time costs one `apply`.
//!
//!     cargo run --release --example topology_once
#![allow(clippy::print_stdout, reason = "an example shows its result")]

use glam::DVec3;
use subzero::{Features, MeshError, StencilTable, TriangleMesh};

fn main() -> Result<(), MeshError> {
    let octahedron: Vec<[u32; 3]> = (0..4).flat_map(|i| [[i, (i + 1) % 4, 4], [(i + 1) % 4, i, 5]]).collect();
    let mut mesh = TriangleMesh::new(6, octahedron, &Features::default())?;
    let mut table = StencilTable::identity(6);
    for _ in 0..4 {
        let refined = mesh.loop_refine()?;
        table = table.then(&refined.stencils);
        mesh = refined.mesh;
    }
    println!("{} points from 6, {} triangles", table.len(), mesh.triangles().len());

    let corners = [DVec3::X, DVec3::Y, DVec3::NEG_X, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z];
    let mut fine = vec![DVec3::ZERO; table.len()];
    for height in [1.0, 2.0, 3.0] {
        let control = corners.map(|point| point * DVec3::new(1.0, 1.0, height));
        table.apply_into(&control, &mut fine);
        // Subdivision takes means, so stretching commutes with it: the height triples from the first to the last.
        let top = fine.iter().map(|point| point.z).fold(0.0, f64::max);
        println!("control points up to {height}: surface up to {top:.6}");
    }
    Ok(())
}
