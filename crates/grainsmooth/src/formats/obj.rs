//! OBJ: text, one group for each boundary.

use std::io::{self, Write};

use glam::DVec3;
use voronoi::Dimension;

use super::format::{Content, Extra, Format, TEXT_CORNERS, TEXT_POINT, Writer};
use super::surface::{Surface, side_name, write_seed_comments};
use crate::Provenance;

pub(super) const FORMAT: Format = Format {
    extension: "obj",
    content: Content::Boundaries,
    bytes: |size| TEXT_POINT * size.mesh.points + TEXT_CORNERS * size.mesh.triangles,
    write: Writer::File(|polycrystal, out| {
        write(&polycrystal.surface()?, polycrystal.provenance(), polycrystal.grains().renumbered(), out)
    }),
    extra: Extra {
        dimension: Some(Dimension::Three),
        write_grain: Some(|file, out| {
            write(file.surface, file.polycrystal.provenance(), file.renumbered(), out)
        }),
        ..Extra::NONE
    },
};

/// Writes all points, in the fewest digits that give the same number back, then the boundaries.
fn write(
    surface: &Surface<'_>,
    provenance: Provenance<'_>,
    seed_ids: &[u32],
    out: &mut dyn Write,
) -> io::Result<()> {
    writeln!(out, "# grainsmooth {}", env!("CARGO_PKG_VERSION"))?;
    provenance.write_comments("# ", out)?;
    write_seed_comments(seed_ids, "# ", out)?;
    for DVec3 { x, y, z } in surface.points.iter() {
        writeln!(out, "v {x:?} {y:?} {z:?}")?;
    }
    for part in &surface.parts {
        let [from, to] = part.sides.map(side_name);
        writeln!(out, "g boundary{} {from} {to}", part.boundary.0)?;
        for [a, b, c] in surface.triangles_of(part).map(|triangle| triangle.map(|id| u64::from(id) + 1)) {
            writeln!(out, "f {a} {b} {c}")?;
        }
    }
    Ok(())
}
