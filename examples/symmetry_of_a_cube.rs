//! A cube of triangles loses its symmetry under subdivision, unless the diagonals of its faces are split first.
//!
//!     cargo run --release --example symmetry_of_a_cube
#![allow(clippy::print_stdout, reason = "an example shows its result")]

use glam::DVec3;
use subzero::{Features, HalfEdgeMesh, MeshError, TriangleMesh};

const SQUARES: [[u32; 4]; 6] =
    [[3, 2, 1, 0], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]];

fn main() -> Result<(), MeshError> {
    let circle = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
    let cube: Vec<DVec3> =
        [-1.0, 1.0].iter().flat_map(|&z| circle.map(|(x, y)| DVec3::new(x, y, z))).collect();
    let triangles: Vec<[u32; 3]> = SQUARES.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    println!("as it is:        {:.6}", spread_of_corners(&triangles, &cube)?);

    let mut points = cube;
    let mut mesh = HalfEdgeMesh::new(points.len(), &triangles)?;
    mesh.split_edges(&SQUARES.map(|[a, _, c, _]| [a, c]), &mut points)?;
    let triangles: Vec<[u32; 3]> = mesh.triangles().map(|(_, triangle)| triangle).collect();
    println!("diagonals split: {:.6}", spread_of_corners(&triangles, &points)?);
    Ok(())
}

/// How much the distances of the eight corners from the centre differ after three steps of Loop's scheme.
fn spread_of_corners(triangles: &[[u32; 3]], points: &[DVec3]) -> Result<f64, MeshError> {
    let mut mesh = TriangleMesh::new(points.len(), triangles.to_vec(), &Features::default())?;
    let mut points = points.to_vec();
    for _ in 0..3 {
        let refined = mesh.loop_refine()?;
        points = refined.stencils.apply(&points);
        mesh = refined.mesh;
    }
    let distances = || points[..8].iter().map(|point| point.length());
    Ok(distances().fold(0.0, f64::max) - distances().fold(f64::INFINITY, f64::min))
}
