//! A table of the grains' Euler angles in degrees (Bunge) with their volumes as weights, as MTEX and VPSC read it.

use std::io::{self, Write};

use texture::Orientation;

use crate::Config;

/// Writes a line for each grain, in the order of their numbers.
pub(crate) fn write(
    orientations: &[Orientation],
    volumes: &[f64],
    config: &Config,
    out: &mut dyn Write,
) -> io::Result<()> {
    config.write_comments("# ", out)?;
    writeln!(out, "phi1 Phi phi2 weight")?;
    for (orientation, volume) in orientations.iter().zip(volumes) {
        let [phi1, phi, phi2] = orientation.euler_degrees();
        writeln!(out, "{phi1:?} {phi:?} {phi2:?} {volume:?}")?;
    }
    Ok(())
}
