//! The limit of Loop subdivision, exactly and by refining: a tetrahedron's corners end a fifth of the way out.
//!
//!     cargo run --release --example limit_of_tetrahedron
#![allow(clippy::print_stdout, reason = "an example shows its result")]

use glam::DVec3;
use subzero::{Features, LoopWeights, MeshError, TriangleMesh};

fn main() -> Result<(), MeshError> {
    let triangles = vec![[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]];
    let mut points = vec![
        DVec3::new(1.0, 1.0, 1.0),
        DVec3::new(1.0, -1.0, -1.0),
        DVec3::new(-1.0, 1.0, -1.0),
        DVec3::new(-1.0, -1.0, 1.0),
    ];
    let mut mesh = TriangleMesh::new(points.len(), triangles, &Features::default())?;

    let limits = mesh.loop_limits(LoopWeights::Loop)?;
    println!("exact limit of corner (1, 1, 1): {}", limits.project(&points)[0]);
    let normal = limits.vertex_normals(&points)[0].unwrap_or_default();
    println!("its unit normal: {normal:.4}, which is (1, 1, 1)/sqrt(3)");

    for level in 1..=8 {
        let refined = mesh.loop_refine()?;
        points = refined.stencils.apply(&points);
        mesh = refined.mesh;
        println!("level {level}: {:.6}", points[0].x);
    }
    Ok(())
}
