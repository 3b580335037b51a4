//! Neper's list of orientations, .ori: a passive Rodrigues vector for each grain, in the order of their numbers.

use std::io::{self, Write};

use texture::Orientation;

use super::euler::OF_GRAIN;
use super::format::{Content, Extra, Format, Writer};

pub(super) const FORMAT: Format = Format {
    extension: "ori",
    content: Content::Orientations,
    bytes: |size| OF_GRAIN * size.grains,
    write: Writer::File(|polycrystal, out| write(polycrystal.texture()?.orientations(), out)),
    extra: Extra { programs: "Neper", ..Extra::NONE },
};

/// The least scalar part that is divided by: a half turn has none, and its vector would be infinite.
const LEAST_SCALAR: f64 = 1e-12;

/// Writes the list.
pub(super) fn write(orientations: &[Orientation], out: &mut dyn Write) -> io::Result<()> {
    for orientation in orientations {
        let [w, x, y, z] = orientation.quaternion();
        let [x, y, z] = [x, y, z].map(|part| part / w.max(LEAST_SCALAR));
        writeln!(out, "{x:?} {y:?} {z:?}")?;
    }
    Ok(())
}
