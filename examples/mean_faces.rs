//! Counts the faces of many random Voronoi cells. Their mean is known exactly: 2 + 48 pi^2 / 35 = 15.535 (Meijering 1953).
//!
//!     cargo run --release --example mean_faces
#![allow(clippy::print_stdout, reason = "an example shows its result")]

use grainsmooth::random_seeds;
use voronoi::{CellId, Domain, Tessellation, VoronoiError};

fn main() -> Result<(), VoronoiError> {
    let domain = Domain::unit_cube();
    let tessellation = Tessellation::new(&domain, &random_seeds(20_000, &domain, 1))?;

    // Walls change the cells near them, and a cell is about 0.04 wide: only those deep inside count.
    let is_inner = |seed: glam::DVec3| (seed - 0.5).abs().max_element() < 0.35;
    let cells = (0u32..).map(CellId).zip(tessellation.seeds());
    let face_counts: Vec<usize> = cells
        .filter(|(_, seed)| is_inner(**seed))
        .map(|(cell, _)| tessellation.cell_faces(cell).len())
        .collect();

    let mean = face_counts.iter().sum::<usize>() as f64 / face_counts.len() as f64;
    println!("mean faces of {} inner cells: {mean:.3}, exact: 15.535", face_counts.len());
    Ok(())
}
