//! A table of the grains' materials: number, seed, phase and Euler angles (Bunge, degrees), for scripts that define a material for each grain.

use std::io::{self, Write};

use super::euler::OF_GRAIN;
use super::format::{Content, Extra, Format, HEAD, Writer};
use crate::Polycrystal;

pub(super) const FORMAT: Format = Format {
    extension: "csv",
    content: Content::Grains,
    bytes: |size| HEAD + OF_GRAIN * size.grains,
    write: Writer::File(write),
    extra: Extra::NONE,
};

/// Writes a line for each grain, with its phase and its angles where grains have them.
fn write(polycrystal: &Polycrystal, out: &mut dyn Write) -> io::Result<()> {
    let grains = polycrystal.grains();
    let phases: Option<Vec<&str>> = grains.phases.as_ref().map(|phases| phases.names().collect());
    let orientations = grains.texture.as_ref().map(|texture| texture.orientations());
    polycrystal.provenance().write_comments("# ", out)?;
    write!(out, "GrainId,SeedId")?;
    write!(out, "{}", if phases.is_some() { ",Phase" } else { "" })?;
    writeln!(out, "{}", if orientations.is_some() { ",phi1,Phi,phi2" } else { "" })?;
    let phase_of = grains.phase_of();
    for (grain, seed) in grains.ids.iter().enumerate() {
        write!(out, "{grain},{seed}")?;
        if let Some(names) = &phases {
            write!(out, ",{}", names[phase_of[grain]])?;
        }
        if let Some(orientations) = orientations {
            let [phi1, phi, phi2] = orientations[grain].euler_degrees();
            write!(out, ",{phi1:?},{phi:?},{phi2:?}")?;
        }
        writeln!(out)?;
    }
    Ok(())
}
