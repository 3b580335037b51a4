//! DAMASK's material.yaml: a material for each grain, in the order of their numbers, which a .vti has as `material`.
//!
//! <https://damask-multiphysics.org/documentation/file_formats/material_config.html>

use std::io::{self, Write};

use texture::CrystalSymmetry;

use crate::{Config, GrainTexture};

/// Writes the file. What mechanics the phase has is for its user to say.
pub(crate) fn write(texture: &GrainTexture, config: &Config, out: &mut dyn Write) -> io::Result<()> {
    config.write_comments("# ", out)?;
    let lattice = match texture.symmetry() {
        CrystalSymmetry::Octahedral | CrystalSymmetry::Tetrahedral => "lattice: cF  # or cI: body-centred",
        CrystalSymmetry::Hexagonal | CrystalSymmetry::HexagonalLow => "lattice: hP\n    c/a: 1.633",
        CrystalSymmetry::Tetragonal | CrystalSymmetry::TetragonalLow => "lattice: tI\n    c/a: 1.0",
        _ => "lattice: cF  # DAMASK has cF, cI, hP and tI",
    };
    write!(
        out,
        "homogenization:\n  SX:\n    N_constituents: 1\n    mechanical: {{type: pass}}\n\
         phase:\n  A:\n    {lattice}\nmaterial:\n"
    )?;
    for orientation in texture.orientations() {
        let [w, x, y, z] = orientation.quaternion();
        writeln!(
            out,
            "  - homogenization: SX\n    constituents: [{{phase: A, v: 1.0, O: [{w:?}, {x:?}, {y:?}, {z:?}]}}]"
        )?;
    }
    Ok(())
}
