//! STL: triangles without shared points, in single precision.

use std::io::{self, Write};

use voronoi::Dimension;

use super::format::{Content, Extra, Format, GrainSurface, Writer};
use super::surface::Surface;
use crate::mesh::file::stl::{TITLE_BYTES, check_range, write_binary};
use crate::mesh::normal::unit_normal;
use crate::names::SEED_ID;
use crate::{Polycrystal, Provenance, StlEncoding};

/// Every boundary once.
pub(super) const FORMAT: Format = Format {
    extension: "stl",
    content: Content::Boundaries,
    bytes: |size| match size.config.file.stl {
        StlEncoding::Ascii => 270 * size.mesh.triangles,
        StlEncoding::Binary => 84 + 50 * size.mesh.triangles,
    },
    write: Writer::File(|polycrystal, out| write(&polycrystal.surface()?, "network", polycrystal, out)),
    extra: Extra { dimension: Some(Dimension::Three), write_grain: Some(write_grain), ..Extra::NONE },
};

/// The first line of a text is cut by some readers (Gmsh) after 255 bytes; the rest would not be understood.
const TEXT_TITLE_BYTES: usize = 240;

/// Writes all triangles as one solid.
fn write_grain(file: &GrainSurface<'_>, out: &mut dyn Write) -> io::Result<()> {
    let seed = file.renumbered().first().map_or(String::new(), |seed| format!(" {SEED_ID} {seed}"));
    write(file.surface, &format!("grain{}{seed}", file.grain.0), file.polycrystal, out)
}

fn write(
    surface: &Surface<'_>,
    name: &str,
    polycrystal: &Polycrystal,
    out: &mut dyn Write,
) -> io::Result<()> {
    check_range(surface.points.iter().copied())?;
    let provenance = polycrystal.provenance();
    match polycrystal.file().stl {
        StlEncoding::Binary => {
            let triangles = surface.triangles().map(|triangle| surface.corners(triangle));
            write_binary(&title(name, provenance, TITLE_BYTES), triangles, out)
        }
        StlEncoding::Ascii => write_ascii(surface, name, &title(name, provenance, TEXT_TITLE_BYTES), out),
    }
}

/// The name of a solid, and in what its settings differ from the default ones if there is room: nowhere else is any.
fn title(name: &str, provenance: Provenance<'_>, room: usize) -> String {
    let title = format!("{name}, grainsmooth {}", env!("CARGO_PKG_VERSION"));
    let with_settings = provenance.differences().map(|differences| format!("{title} {differences}"));
    with_settings.filter(|text| text.len() <= room && !text.contains('\n')).unwrap_or(title)
}

fn write_ascii(surface: &Surface<'_>, name: &str, title: &str, out: &mut dyn Write) -> io::Result<()> {
    writeln!(out, "solid {title}")?;
    for triangle in surface.triangles() {
        let corners = surface.corners(triangle);
        let [x, y, z] = unit_normal(corners).as_vec3().to_array();
        writeln!(out, "facet normal {x:e} {y:e} {z:e}\nouter loop")?;
        for [x, y, z] in corners.map(|corner| corner.as_vec3().to_array()) {
            writeln!(out, "vertex {x:e} {y:e} {z:e}")?;
        }
        writeln!(out, "endloop\nendfacet")?;
    }
    writeln!(out, "endsolid {name}")
}
