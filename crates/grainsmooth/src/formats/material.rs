//! DAMASK's material.yaml: a material for each grain, in the order of their numbers, which a .vti has as `material`.
//!
//! <https://damask-multiphysics.org/documentation/file_formats/material_config.html>

use std::io::{self, Write};

use texture::CrystalSymmetry;

use super::format::{Content, Extra, Format, HEAD, Writer};
use crate::{GrainAttributes, GrainTexture, Provenance};

pub(super) const FORMAT: Format = Format {
    extension: "yaml",
    content: Content::Orientations,
    bytes: |size| HEAD + 160 * size.grains,
    write: Writer::File(|polycrystal, out| {
        write(polycrystal.grains(), polycrystal.texture()?, polycrystal.provenance(), out)
    }),
    extra: Extra { programs: "DAMASK", ..Extra::NONE },
};

/// The name of the one phase where none are asked for.
const ONE_PHASE: &str = "A";

/// Writes the file. What mechanics a phase has is for its user to say.
fn write(
    grains: &GrainAttributes,
    texture: &GrainTexture,
    provenance: Provenance<'_>,
    out: &mut dyn Write,
) -> io::Result<()> {
    provenance.write_comments("# ", out)?;
    write!(out, "homogenization:\n  SX:\n    N_constituents: 1\n    mechanical: {{type: pass}}\nphase:\n")?;
    let has_phases = grains.phases.is_some();
    // In quotes, for names such as 2 and no are something else without.
    let named = |name: String| if has_phases { format!("\"{name}\"") } else { ONE_PHASE.to_owned() };
    let phases: Vec<(String, CrystalSymmetry)> =
        grains.named_symmetries().into_iter().map(|(name, symmetry)| (named(name), symmetry)).collect();
    for (name, symmetry) in &phases {
        writeln!(out, "  {name}:\n    {}", lattice(*symmetry))?;
    }
    writeln!(out, "material:")?;
    for (orientation, phase) in texture.orientations().iter().zip(grains.phase_of()) {
        let ([w, x, y, z], (name, _)) = (orientation.quaternion(), &phases[phase]);
        writeln!(
            out,
            "  - homogenization: SX\n    constituents: [{{phase: {name}, v: 1.0, O: [{w:?}, {x:?}, {y:?}, {z:?}]}}]"
        )?;
    }
    Ok(())
}

/// The lattice of a symmetry, as far as it tells.
fn lattice(symmetry: CrystalSymmetry) -> &'static str {
    match symmetry {
        CrystalSymmetry::Octahedral | CrystalSymmetry::Tetrahedral => "lattice: cF  # or cI: body-centred",
        CrystalSymmetry::Hexagonal | CrystalSymmetry::HexagonalLow => "lattice: hP\n    c/a: 1.633",
        CrystalSymmetry::Tetragonal | CrystalSymmetry::TetragonalLow => "lattice: tI\n    c/a: 1.0",
        _ => "lattice: cF  # DAMASK has cF, cI, hP and tI",
    }
}
