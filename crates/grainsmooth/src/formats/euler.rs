//! A table of the grains' Euler angles in degrees (Bunge) with their volumes as weights, as MTEX and VPSC read it.

use std::io::{self, Write};

use texture::Orientation;

use crate::{Config, GrainPhases};

/// Writes a line for each grain, in the order of their numbers, with its phase where there are some.
pub(crate) fn write(
    orientations: &[Orientation],
    volumes: &[f64],
    phases: Option<&GrainPhases>,
    config: &Config,
    out: &mut dyn Write,
) -> io::Result<()> {
    config.write_comments("# ", out)?;
    writeln!(out, "phi1 Phi phi2 weight{}", if phases.is_some() { " phase" } else { "" })?;
    for (grain, (orientation, volume)) in orientations.iter().zip(volumes).enumerate() {
        let [phi1, phi, phi2] = orientation.euler_degrees();
        let phase = phases.map_or_else(String::new, |phases| format!(" {}", phases.number(grain)));
        writeln!(out, "{phi1:?} {phi:?} {phi2:?} {volume:?}{phase}")?;
    }
    Ok(())
}
