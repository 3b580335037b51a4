//! PLY: binary, little-endian, with the boundary and the two sides of each triangle.

use std::io::{self, Write};

use voronoi::Dimension;

use super::format::{Content, Extra, Format, Writer};
use super::surface::{Surface, label, write_seed_comments};
use crate::Provenance;

pub(super) const FORMAT: Format = Format {
    extension: "ply",
    content: Content::Boundaries,
    bytes: |size| 24 * size.mesh.points + 25 * size.mesh.triangles,
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

/// Writes all points and triangles.
fn write(
    surface: &Surface<'_>,
    provenance: Provenance<'_>,
    seed_ids: &[u32],
    out: &mut dyn Write,
) -> io::Result<()> {
    writeln!(out, "ply\nformat binary_little_endian 1.0\ncomment grainsmooth {}", env!("CARGO_PKG_VERSION"))?;
    provenance.write_comments("comment ", out)?;
    write_seed_comments(seed_ids, "comment ", out)?;
    write!(
        out,
        "element vertex {}\nproperty double x\nproperty double y\nproperty double z\n\
         element face {}\nproperty list uchar uint vertex_indices\n\
         property int boundary\nproperty int grain\nproperty int neighbor\nend_header\n",
        surface.points.len(),
        surface.triangle_count()
    )?;
    for coordinate in surface.points.iter().flat_map(|point| point.to_array()) {
        out.write_all(&coordinate.to_le_bytes())?;
    }
    for part in &surface.parts {
        let mut end = i64::from(part.boundary.0).to_le_bytes()[..4].to_vec();
        for side in part.sides {
            end.extend_from_slice(&label(side).to_le_bytes()[..4]);
        }
        for triangle in surface.triangles_of(part) {
            out.write_all(&[3])?;
            out.write_all(bytemuck::bytes_of(&triangle.map(u32::to_le)))?;
            out.write_all(&end)?;
        }
    }
    Ok(())
}
