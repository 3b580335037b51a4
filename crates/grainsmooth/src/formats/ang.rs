//! TSL's text file of orientation maps, .ang: each pixel of a 2D grid with the orientation of its grain.
//!
//! Orientations are made up, as grains have none of their own: uniform in the group of rotations, by grain and random seed.

use std::f64::consts::TAU;
use std::io::{self, Write};

use polycrystal::Side;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

use super::LabelGrid;
use crate::Config;

/// The generator's stream for orientations, apart from that of the seeds' positions.
const STREAM: u64 = 1;

/// In place of each Euler angle where there is none.
const ANGLE_OF_NONE: f64 = 2.0 * TAU;

/// Writes the map: one line a pixel, x fastest; angles in radians, coordinates in the user's unit of length.
///
/// The columns are the three Euler angles after Bunge, x, y, image quality 1, confidence 1, phase 1, detector signal 1 and
/// fit 0; y points down, as everywhere in such maps. Pixels outside of all grains have no solution: confidence -1.
pub(crate) fn write(
    grid: &LabelGrid<'_>,
    grain_count: usize,
    config: &Config,
    out: &mut dyn Write,
) -> io::Result<()> {
    let [columns, rows, _] = grid.size;
    let (x_step, y_step) = (grid.spacing.x, grid.spacing.y);
    config.write_comments("# ", out)?;
    write!(
        out,
        "# TEM_PIXperUM          1.000000\n# x-star                0.000000\n# y-star                0.000000\n\
         # z-star                0.000000\n# WorkingDistance       0.000000\n#\n# Phase 1\n\
         # MaterialName  grains\n# Formula     \n# Info \n# Symmetry              43\n\
         # LatticeConstants      1.000 1.000 1.000  90.000  90.000  90.000\n# NumberFamilies        0\n#\n\
         # GRID: SqrGrid\n# XSTEP: {x_step:?}\n# YSTEP: {y_step:?}\n# NCOLS_ODD: {columns}\n# NCOLS_EVEN: {columns}\n\
         # NROWS: {rows}\n#\n# OPERATOR: grainsmooth {}\n#\n# SAMPLEID: \n#\n# SCANID: \n#\n",
        env!("CARGO_PKG_VERSION")
    )?;
    let angles = euler_angles(grain_count, config.random_seed);
    // The first row of a map is the topmost.
    let mut row = 0;
    for slab in (0..grid.slab_count()).rev() {
        for labels in grid.slab(slab).chunks(columns).rev() {
            write_row(labels, row, [x_step, y_step], &angles, out)?;
            row += 1;
        }
    }
    Ok(())
}

/// Writes the pixels of a row.
fn write_row(
    labels: &[Side],
    row: usize,
    [x_step, y_step]: [f64; 2],
    angles: &[[f64; 3]],
    out: &mut dyn Write,
) -> io::Result<()> {
    for (column, side) in labels.iter().enumerate() {
        let (x, y) = (column as f64 * x_step, row as f64 * y_step);
        let Side::Grain(grain) = side else {
            // As TSL writes pixels without a solution.
            writeln!(
                out,
                "{ANGLE_OF_NONE:.5} {ANGLE_OF_NONE:.5} {ANGLE_OF_NONE:.5} {x:?} {y:?} -1.0 -1.000 0 -1 180.000"
            )?;
            continue;
        };
        let [phi1, big_phi, phi2] = angles[grain.index()];
        writeln!(out, "{phi1:.5} {big_phi:.5} {phi2:.5} {x:?} {y:?} 1.0 1.000 1 1 0.000")?;
    }
    Ok(())
}

/// Bunge's angles of every grain, in radians: two uniform, and the cosine of the middle one uniform.
fn euler_angles(grain_count: usize, random_seed: u64) -> Vec<[f64; 3]> {
    let mut generator = ChaCha8Rng::seed_from_u64(random_seed);
    generator.set_stream(STREAM);
    let mut fraction = || (generator.next_u64() >> 11) as f64 * 2f64.powi(-53);
    (0..grain_count).map(|_| [TAU * fraction(), (2.0 * fraction() - 1.0).acos(), TAU * fraction()]).collect()
}
