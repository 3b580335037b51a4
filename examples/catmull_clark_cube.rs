//! Catmull-Clark subdivision of a cube with edges from -1 to 1: its corners move to 5/9, and end at 1/2.
//!
//!     cargo run --release --example catmull_clark_cube
#![allow(clippy::print_stdout, reason = "an example shows its result")]

use glam::DVec3;
use subzero::{Crease, Features, MeshError, PolygonMesh};

fn main() -> Result<(), MeshError> {
    let squares = [[3, 2, 1, 0], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]];
    let squares = squares.map(Vec::from);
    let circle = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
    let cube: Vec<DVec3> =
        [-1.0, 1.0].iter().flat_map(|&z| circle.map(|(x, y)| DVec3::new(x, y, z))).collect();

    let mesh = PolygonMesh::new(cube.len(), &squares, &Features::default())?;
    let refined = mesh.catmull_clark_refine()?;
    println!("corner after one step: {:.6}", refined.stencils.apply(&cube)[6].x);
    println!("corner in the limit:   {:.6}", mesh.catmull_clark_limits()?.positions.apply(&cube)[6].x);

    // With the four edges of the top creased, the top's rim is a B-spline curve: (1, 6, 1)/8 of a square.
    let creases = [[4, 5], [5, 6], [6, 7], [7, 4]].map(Crease::infinite);
    let mesh =
        PolygonMesh::new(cube.len(), &squares, &Features { creases: &creases, ..Features::default() })?;
    let corner = mesh.catmull_clark_refine()?.stencils.apply(&cube)[6];
    println!("on the creased rim:    {:.6}, and z stays {}", corner.x, corner.z);
    Ok(())
}
