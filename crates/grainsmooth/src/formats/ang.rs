//! TSL's text file of orientation maps, .ang: each pixel of a 2D grid with the orientation of its grain.
//!
//! Where no texture is asked for orientations are made up, as grains have none of their own: random, by the config's seed.

use std::f64::consts::TAU;
use std::io::{self, Write};

use polycrystal::Side;
use texture::{CrystalSymmetry, Orientation};
use voronoi::Dimension;

use super::format::{Content, Extra, Format, HEAD, TEXT_POINT, Writer};
use super::orientation_map::OrientationMap;
use crate::Provenance;

pub(super) const FORMAT: Format = Format {
    extension: "ang",
    content: Content::Voxels(|_| 0),
    bytes: |size| HEAD + TEXT_POINT * size.voxels(),
    write: Writer::File(|polycrystal, out| {
        OrientationMap::of(polycrystal, |map| write(map, polycrystal.provenance(), out))
    }),
    extra: Extra { dimension: Some(Dimension::Two), ..Extra::NONE },
};

/// In place of each Euler angle where there is none.
const ANGLE_OF_NONE: f64 = 2.0 * TAU;

/// Writes the map: one line a pixel, x fastest; angles in radians, coordinates in the user's unit of length.
///
/// The columns are the three Euler angles after Bunge, x, y, image quality 1, confidence 1, the phase from 1, detector signal 1 and
/// fit 0; y points down, as everywhere in such maps. Pixels outside of all grains have no solution: confidence -1.
fn write(map: &OrientationMap<'_>, provenance: Provenance<'_>, out: &mut dyn Write) -> io::Result<()> {
    let OrientationMap { grid, orientations, phases, .. } = map;
    let [columns, rows, _] = grid.size;
    let (x_step, y_step) = (grid.spacing.x, grid.spacing.y);
    provenance.write_comments("# ", out)?;
    write!(
        out,
        "# TEM_PIXperUM          1.000000\n# x-star                0.000000\n# y-star                0.000000\n\
         # z-star                0.000000\n# WorkingDistance       0.000000\n#\n"
    )?;
    for (phase, (name, symmetry)) in (1..).zip(*phases) {
        let [[a, b, c], [alpha, beta, gamma]] = lattice_constants(*symmetry);
        let number = symmetry_number(*symmetry);
        write!(
            out,
            "# Phase {phase}\n# MaterialName  {name}\n# Formula     \n# Info \n# Symmetry              {number}\n\
             # LatticeConstants      {a:.3} {b:.3} {c:.3}  {alpha:.3}  {beta:.3}  {gamma:.3}\n# NumberFamilies        0\n#\n"
        )?;
    }
    write!(
        out,
        "# GRID: SqrGrid\n# XSTEP: {x_step:?}\n# YSTEP: {y_step:?}\n# NCOLS_ODD: {columns}\n# NCOLS_EVEN: {columns}\n\
         # NROWS: {rows}\n#\n# OPERATOR: grainsmooth {}\n#\n# SAMPLEID: \n#\n# SCANID: \n#\n",
        env!("CARGO_PKG_VERSION")
    )?;
    let radians = |orientation: &Orientation| orientation.euler_degrees().map(f64::to_radians);
    let angles: Vec<[f64; 3]> = orientations.iter().map(radians).collect();
    grid.rows_from_top(|row, labels| write_row(labels, row, [x_step, y_step], &angles, map.phase_of, out))
}

/// Writes the pixels of a row.
fn write_row(
    labels: &[Side],
    row: usize,
    [x_step, y_step]: [f64; 2],
    angles: &[[f64; 3]],
    phase_of: &[usize],
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
        let phase = 1 + phase_of[grain.index()];
        writeln!(out, "{phi1:.5} {big_phi:.5} {phi2:.5} {x:?} {y:?} 1.0 1.000 {phase} 1 0.000")?;
    }
    Ok(())
}

/// Lengths and angles of a unit cell that goes with a symmetry; nobody knows those of made-up grains.
pub(super) fn lattice_constants(symmetry: CrystalSymmetry) -> [[f64; 3]; 2] {
    match symmetry {
        CrystalSymmetry::TrigonalLow
        | CrystalSymmetry::Trigonal
        | CrystalSymmetry::HexagonalLow
        | CrystalSymmetry::Hexagonal => [[1.0, 1.0, 1.6], [90.0, 90.0, 120.0]],
        _ => [[1.0; 3], [90.0; 3]],
    }
}

/// TSL's number of a Laue group.
fn symmetry_number(symmetry: CrystalSymmetry) -> u8 {
    match symmetry {
        CrystalSymmetry::Triclinic => 1,
        CrystalSymmetry::Monoclinic => 20,
        CrystalSymmetry::Orthorhombic => 22,
        CrystalSymmetry::TetragonalLow => 4,
        CrystalSymmetry::Tetragonal => 42,
        CrystalSymmetry::TrigonalLow => 3,
        CrystalSymmetry::Trigonal => 32,
        CrystalSymmetry::HexagonalLow => 6,
        CrystalSymmetry::Hexagonal => 62,
        CrystalSymmetry::Tetrahedral => 23,
        CrystalSymmetry::Octahedral => 43,
    }
}
