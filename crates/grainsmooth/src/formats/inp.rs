//! Input files of Abaqus and CalculiX: tetrahedra that fill smooth grains, in the plane triangles; or each voxel a hexahedron, in the plane a square.
//!
//! Abaqus Analysis User's Guide, "Input syntax rules", "Solid (continuum) elements"; CalculiX CrunchiX User's Manual.

pub(crate) mod deck;
mod elements;
mod equations;
mod hexahedra;

use std::io::{self, Write};

use glam::DVec3;
use texture::CrystalSymmetry;

use super::format::{Content, Extra, Format, HEAD, TEXT_CORNERS, TEXT_POINT, Writer};
use crate::{GrainAttributes, Polycrystal};

/// A node and an element for each voxel, and its number in a set; or some three tetrahedra for each triangle, with half a node each.
pub(super) const FORMAT: Format = Format {
    extension: "inp",
    content: Content::ElementsOrVoxels,
    bytes: |size| match size.voxels() {
        0 => HEAD + (2 * TEXT_POINT + 4 * TEXT_CORNERS) * size.mesh.triangles,
        voxels => HEAD + (TEXT_POINT + 3 * TEXT_CORNERS) * voxels,
    },
    write: Writer::File(write),
    // All that are in a grain stand in one set.
    extra: Extra { programs: "Abaqus, CalculiX", memory_of_voxel: 16, ..Extra::NONE },
};

/// Most numbers in a line of a set.
const OF_LINE: usize = 16;

/// Most characters of a number: CalculiX stops at more.
const OF_NUMBER: usize = 20;

/// The material of all grains where there are no phases.
const ONE_MATERIAL: &str = "GRAINS";

/// Writes nodes, elements, and sets of them: `GRAIN_0` and so on, `PHASE_` with a name, and the nodes of the domain's sides, `X0` to `Z1`. With
/// orientations each grain has its own, by the crystal's first two axes. Materials, named as the phases are, and steps are for the user to
/// say.
fn write(polycrystal: &Polycrystal, out: &mut dyn Write) -> io::Result<()> {
    polycrystal.provenance().write_comments("** ", out)?;
    if polycrystal.file().voxels.is_some() {
        return hexahedra::write(&polycrystal.label_grid()?, polycrystal, out);
    }
    elements::write(polycrystal, out)
}

/// The material of each phase, and the symmetry of its crystals.
fn materials(grains: &GrainAttributes) -> Vec<(String, CrystalSymmetry)> {
    match &grains.phases {
        Some(_) => grains.named_symmetries(),
        None => vec![(ONE_MATERIAL.to_owned(), grains.symmetry)],
    }
}

/// Writes the set of each phase, and of each grain its orientation and its section.
fn write_sections(numbers: &[usize], grains: &GrainAttributes, out: &mut dyn Write) -> io::Result<()> {
    let phase_of = grains.phase_of();
    let names = materials(grains);
    for (phase, (name, _)) in names.iter().enumerate().filter(|_| grains.phases.is_some()) {
        let members: Vec<&usize> = numbers.iter().filter(|grain| phase_of[**grain] == phase).collect();
        if !members.is_empty() {
            writeln!(out, "*ELSET, ELSET=PHASE_{name}")?;
            members.iter().try_for_each(|grain| writeln!(out, "GRAIN_{grain},"))?;
        }
    }
    for grain in numbers {
        let (name, _) = &names[phase_of[*grain]];
        let mut orientation = String::new();
        if let Some(texture) = &grains.texture {
            let [first, second] =
                [DVec3::X, DVec3::Y].map(|axis| texture.orientations()[*grain].to_sample(axis));
            let numbers = [first.to_array(), second.to_array()].concat();
            let numbers: Vec<String> = numbers.into_iter().map(number).collect();
            writeln!(out, "*ORIENTATION, NAME=ORIENTATION_{grain}\n{}", numbers.join(", "))?;
            orientation = format!(", ORIENTATION=ORIENTATION_{grain}");
        }
        writeln!(out, "*SOLID SECTION, ELSET=GRAIN_{grain}, MATERIAL={name}{orientation}")?;
    }
    Ok(())
}

/// A number with all its digits where there is room for them.
fn number(number: f64) -> String {
    let [plain, short] = [format!("{number:?}"), format!("{number:e}")];
    let all = if plain.len() <= OF_NUMBER { plain } else { short };
    if all.len() <= OF_NUMBER { all } else { format!("{number:.13e}") }
}

/// Writes numbers that count from 0 as they count from 1.
fn write_numbers(numbers: impl Iterator<Item = usize>, out: &mut dyn Write) -> io::Result<()> {
    let mut numbers = numbers.map(|number| (number + 1).to_string()).peekable();
    while numbers.peek().is_some() {
        writeln!(out, "{}", numbers.by_ref().take(OF_LINE).collect::<Vec<_>>().join(", "))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_no_more_characters_than_calculix_reads() {
        for (value, text) in
            [(0.5, "0.5"), (1.0, "1.0"), (-0.1, "-0.1"), (1.4283072538232497e-1, "0.14283072538232497")]
        {
            assert_eq!(number(value), text);
        }
        for value in
            [-1.4283072538232497e-11, 1.234_567_890_123_456_7e-300, -1.0 / 3.0, 12_345.678_901_234_567]
        {
            let text = number(value);
            assert!(text.len() <= OF_NUMBER, "{text}");
            assert!((text.parse::<f64>().expect("a number") / value - 1.0).abs() < 1e-12, "{text}");
        }
    }
}
