//! HKL's text file of orientation maps, .ctf: each pixel of a 2D grid with the orientation of its grain.

use std::io::{self, Write};

use polycrystal::Side;
use voronoi::Dimension;

use super::ang::lattice_constants;
use super::format::{Content, Extra, Format, HEAD, TEXT_POINT, Writer};
use super::orientation_map::OrientationMap;
use crate::maps::orientation_map::hkl::{LAUE_GROUPS, hkl_turn};

pub(super) const FORMAT: Format = Format {
    extension: "ctf",
    content: Content::Voxels(|_| 0),
    bytes: |size| HEAD + TEXT_POINT * size.voxels(),
    write: Writer::File(|polycrystal, out| OrientationMap::of(polycrystal, |map| write(map, out))),
    extra: Extra { dimension: Some(Dimension::Two), ..Extra::NONE },
};

/// Writes the map: one line a pixel, x fastest; angles in degrees, coordinates in the user's unit of length.
///
/// Band contrast and slope are 255 and the mean deviation 0; y points down, as everywhere in such maps. Pixels outside of all grains
/// have phase 0.
fn write(map: &OrientationMap<'_>, out: &mut dyn Write) -> io::Result<()> {
    let OrientationMap { grid, orientations, phase_of, phases } = map;
    let [columns, rows, _] = grid.size;
    let (x_step, y_step) = (grid.spacing.x, grid.spacing.y);
    write!(
        out,
        "Channel Text File\nPrj\tgrains\nAuthor\tgrainsmooth {}\nJobMode\tGrid\nXCells\t{columns}\nYCells\t{rows}\n\
         XStep\t{x_step:?}\nYStep\t{y_step:?}\nAcqE1\t0\nAcqE2\t0\nAcqE3\t0\n\
         Euler angles refer to Sample Coordinate system (CS0)!\tMag\t1\tCoverage\t100\tDevice\t0\tKV\t0\tTiltAngle\t0\tTiltAxis\t0\n\
         Phases\t{}\n",
        env!("CARGO_PKG_VERSION"),
        phases.len()
    )?;
    for (name, symmetry) in *phases {
        let number = 1 + LAUE_GROUPS.iter().take_while(|group| *group != symmetry).count();
        let [lengths, angles] =
            lattice_constants(*symmetry).map(|three| three.map(|one| format!("{one:.3}")).join(";"));
        writeln!(out, "{lengths}\t{angles}\t{name}\t{number}\t0")?;
    }
    writeln!(out, "Phase\tX\tY\tBands\tError\tEuler1\tEuler2\tEuler3\tMAD\tBC\tBS")?;
    let angles: Vec<[f64; 3]> = orientations
        .iter()
        .zip(*phase_of)
        .map(|(orientation, phase)| {
            let [phi1, phi, phi2] = orientation.euler_degrees();
            [phi1, phi, (phi2 + hkl_turn(phases[*phase].1)) % 360.0]
        })
        .collect();
    grid.rows_from_top(|row, labels| {
        for (column, side) in labels.iter().enumerate() {
            let (x, y) = (column as f64 * x_step, row as f64 * y_step);
            match side {
                Side::Grain(grain) => {
                    let [phi1, phi, phi2] = angles[grain.index()];
                    let phase = 1 + phase_of[grain.index()];
                    writeln!(
                        out,
                        "{phase}\t{x:?}\t{y:?}\t10\t0\t{phi1:.5}\t{phi:.5}\t{phi2:.5}\t0.0\t255\t255"
                    )?;
                }
                Side::Exterior => writeln!(out, "0\t{x:?}\t{y:?}\t0\t3\t0.0\t0.0\t0.0\t0.0\t0\t0")?,
            }
        }
        Ok(())
    })
}
