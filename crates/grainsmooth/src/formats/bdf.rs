//! Bulk data of Nastran: tetrahedra that fill grains, in the plane triangles, each grain with a property of its own.
//!
//! MSC Nastran Quick Reference Guide, "Bulk data entries": GRID, CTETRA, PSOLID, CTRIA3, CTRIA6, PSHELL.

use std::io::{self, Write};

use super::format::{Content, Extra, Format, HEAD, TEXT_CORNERS, TEXT_POINT, Writer};
use crate::volume_mesh::element_shape::ElementShape;
use crate::{PlaneState, Polycrystal};

/// Characters of a number in an entry's wide fields.
const WIDE: usize = 16;

/// Fields of a line.
const OF_LINE: usize = 8;

/// Some three tetrahedra for each triangle, with half a node each.
pub(super) const FORMAT: Format = Format {
    extension: "bdf",
    content: Content::Elements,
    bytes: |size| HEAD + (2 * TEXT_POINT + 6 * TEXT_CORNERS) * size.mesh.triangles,
    write: Writer::File(write),
    extra: Extra { programs: "Nastran", ..Extra::NONE },
};

/// Writes grid points, elements, and properties: grain 0 is property 1, in the plane with a thickness of 1 and, for plane strain, -1 instead of a material that bends. Their materials count phases from 1, and are for the user to say.
fn write(polycrystal: &Polycrystal, out: &mut dyn Write) -> io::Result<()> {
    let (elements, _) = polycrystal.elements()?;
    polycrystal.provenance().write_comments("$ ", out)?;
    writeln!(out, "BEGIN BULK")?;
    let phase_of = polycrystal.grains().phase_of();
    let (entry, is_plane) = match (elements.shape, elements.are_quadratic()) {
        (ElementShape::Triangle, false) => ("CTRIA3", true),
        (ElementShape::Triangle, true) => ("CTRIA6", true),
        (ElementShape::Tetrahedron, _) => ("CTETRA", false),
    };
    let is_strained = polycrystal.file().volume.plane_state == Some(PlaneState::Strain);
    for grain in elements.grains.chunk_by(|a, b| a == b).map(|of_grain| of_grain[0].index()) {
        let (property, material) = (grain + 1, phase_of[grain] + 1);
        match (is_plane, is_strained) {
            (false, _) => writeln!(out, "PSOLID  {property:8}{material:8}")?,
            (true, false) => writeln!(out, "PSHELL  {property:8}{material:8}      1.")?,
            (true, true) => writeln!(out, "PSHELL  {property:8}{material:8}      1.      -1")?,
        }
    }
    for (node, point) in (1..).zip(&*elements.points) {
        let [x, y, z] = point.to_array().map(number);
        writeln!(out, "GRID*   {node:16}{:16}{x:>16}{y:>16}*\n*       {z:>16}", "")?;
    }
    for (element, (nodes, grain)) in (1..).zip(elements.iter().zip(elements.grains)) {
        write!(out, "{entry:8}{element:8}{:8}", grain.0 + 1)?;
        for (place, node) in nodes.iter().enumerate() {
            // The first line has the element's number and property too, and then the mark that it goes on.
            let continues = if place == OF_LINE - 2 { "+\n+       " } else { "" };
            write!(out, "{continues}{:8}", node + 1)?;
        }
        writeln!(out)?;
    }
    writeln!(out, "ENDDATA")
}

/// A number with as many digits as a wide field has room for.
fn number(number: f64) -> String {
    let all = format!("{number:?}");
    if all.len() <= WIDE && all.contains('.') {
        return all.replace('e', "E");
    }
    let is_plain = (1e-3..1e6).contains(&number.abs());
    let fitting = (0..WIDE).rev().map(|digits| match is_plain {
        true => format!("{number:.digits$}"),
        false => format!("{number:.digits$E}"),
    });
    fitting.into_iter().find(|text| text.len() <= WIDE && text.contains('.')).unwrap_or(all)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_fill_a_wide_field_and_have_a_point() {
        for value in [0.0, -0.5, 1.0, -1.0 / 3.0, 1e-7 / 3.0, -2e-300 / 3.0, 123_456.789_012_345_6, 2e20] {
            let text = number(value);
            assert!(text.len() <= WIDE && text.contains('.'), "{text}");
            let error = (text.parse::<f64>().expect("a number") - value).abs();
            assert!(error <= 1e-8 * value.abs(), "{text}");
        }
        assert_eq!(number(-1.0 / 3.0), "-0.3333333333333");
    }
}
