//! STL: triangles without shared points, in single precision.

use std::io::{self, Write};

use voronoi::Dimension;

use super::format::{Content, Format, GrainSurface, Writer};
use super::surface::{Surface, unit_normal};
use crate::names::SEED_ID;
use crate::{Polycrystal, Provenance, StlEncoding};

/// Every boundary once.
pub(super) const FORMAT: Format = Format {
    extension: "stl",
    programs: "",
    content: Content::Boundaries,
    dimension: Some(Dimension::Three),
    beside: None,
    bytes: |size| match size.config.file.stl {
        StlEncoding::Ascii => 270 * size.mesh.triangles,
        StlEncoding::Binary => 84 + 50 * size.mesh.triangles,
    },
    write: Writer::File(|polycrystal, out| write(&polycrystal.surface()?, "network", polycrystal, out)),
    write_grain: Some(write_grain),
};

/// The first line of a text is cut by some readers (Gmsh) after 255 bytes; the rest would not be understood.
const TITLE_BYTES: usize = 240;

/// What the header of a binary file begins with must not be `solid`, which would make it text to many readers.
const HEADER_BYTES: usize = 80;

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
    if let Some(point) = surface.points.iter().find(|point| !point.as_vec3().is_finite()) {
        return Err(io::Error::other(format!(
            "{point} is too far out for STL's single precision; write .vtp instead"
        )));
    }
    let provenance = polycrystal.provenance();
    match polycrystal.file().stl {
        StlEncoding::Binary => write_binary(surface, &title(name, provenance, HEADER_BYTES), out),
        StlEncoding::Ascii => write_ascii(surface, name, &title(name, provenance, TITLE_BYTES), out),
    }
}

/// The name of a solid, and in what its settings differ from the default ones if there is room: nowhere else is any.
fn title(name: &str, provenance: Provenance<'_>, room: usize) -> String {
    let title = format!("{name}, grainsmooth {}", env!("CARGO_PKG_VERSION"));
    let with_settings = provenance.differences().map(|differences| format!("{title} {differences}"));
    with_settings.filter(|text| text.len() <= room && !text.contains('\n')).unwrap_or(title)
}

fn write_binary(surface: &Surface<'_>, title: &str, out: &mut dyn Write) -> io::Result<()> {
    let count = u32::try_from(surface.triangle_count())
        .map_err(|_| io::Error::other("more triangles than STL can count; write .vtp instead"))?;
    let mut header = title.as_bytes().to_vec();
    header.resize(HEADER_BYTES, b' ');
    out.write_all(&header)?;
    out.write_all(&count.to_le_bytes())?;
    let mut record = [0; 50];
    for triangle in surface.triangles() {
        let corners = surface.corners(triangle);
        let vectors = [unit_normal(corners), corners[0], corners[1], corners[2]];
        let numbers = vectors.iter().flat_map(|vector| vector.as_vec3().to_array());
        for (place, number) in record.as_chunks_mut::<4>().0.iter_mut().zip(numbers) {
            *place = number.to_le_bytes();
        }
        out.write_all(&record)?;
    }
    Ok(())
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
