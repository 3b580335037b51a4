//! A table of the grains' Euler angles in degrees (Bunge) with their volumes as weights, as MTEX and VPSC read it.

use std::io::{self, Write};

use texture::Orientation;

use super::format::{Content, Extra, Format, HEAD, Writer};
use crate::{GrainPhases, Provenance};

pub(super) const FORMAT: Format = Format {
    extension: "txt",
    content: Content::Orientations,
    bytes: |size| HEAD + OF_GRAIN * size.grains,
    write: Writer::File(|polycrystal, out| {
        let (volumes, phases) = (polycrystal.network.cell_volumes(), polycrystal.grains().phases.as_ref());
        write(polycrystal.texture()?.orientations(), volumes, phases, polycrystal.provenance(), out)
    }),
    extra: Extra::NONE,
};

/// Bytes of a grain: three or four numbers of 20 characters.
pub(super) const OF_GRAIN: u128 = 80;

/// Writes a line for each grain, in the order of their numbers, with its phase where there are some.
fn write(
    orientations: &[Orientation],
    volumes: &[f64],
    phases: Option<&GrainPhases>,
    provenance: Provenance<'_>,
    out: &mut dyn Write,
) -> io::Result<()> {
    provenance.write_comments("# ", out)?;
    writeln!(out, "phi1 Phi phi2 weight{}", if phases.is_some() { " phase" } else { "" })?;
    for (grain, (orientation, volume)) in orientations.iter().zip(volumes).enumerate() {
        let [phi1, phi, phi2] = orientation.euler_degrees();
        let phase = phases.map_or_else(String::new, |phases| format!(" {}", phases.number(grain)));
        writeln!(out, "{phi1:?} {phi:?} {phi2:?} {volume:?}{phase}")?;
    }
    Ok(())
}
