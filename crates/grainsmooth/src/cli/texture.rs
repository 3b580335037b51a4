//! Options about the orientations of grains.

use std::path::PathBuf;

use clap::Args;
use grainsmooth::{TextureOptions, TextureSource};
use texture::{CrystalSymmetry, SampleSymmetry};

/// How crystals stand in the sample.
#[derive(Debug, Args)]
#[command(next_help_heading = "Texture")]
pub struct TextureArguments {
    /// Give each grain an orientation: random, components with halfwidths in degrees, or a file
    ///
    /// Components are cube, goss, brass, copper, s and others; {112}<-1-11>(10); euler(30 45 60, 10); fiber(111||z, 10); gamma(10). Sums
    /// have weights by volume: 'cube(5)*0.3 + random*0.7'. A file holds Euler angles with weights (.csv, .txt), Neper's orientations
    /// (.ori), or a measured map (.ang, .ctf).
    ///
    /// Example: --texture 'goss(10)'
    #[arg(long, value_name = "SPEC|FILE", value_parser = parse_texture)]
    texture: Option<TextureSource>,

    /// Symmetry of the crystals: cubic, hexagonal, trigonal, tetragonal, orthorhombic, monoclinic, triclinic, or a group such as 432 or m-3m
    ///
    /// Example: --texture 'basal(20)' --crystal-symmetry hexagonal
    #[arg(long, value_name = "GROUP", default_value = "cubic", value_parser = parse_symmetry, allow_hyphen_values = true)]
    crystal_symmetry: CrystalSymmetry,

    /// Symmetry of the sample: triclinic (none) or orthorhombic, as of rolled sheet, where each component comes in all its variants
    ///
    /// Example: --texture 'copper(8) + s(8) + brass(8)' --sample-symmetry orthorhombic
    #[arg(long, value_name = "GROUP", default_value = "triclinic", value_parser = parse_sample_symmetry)]
    sample_symmetry: SampleSymmetry,

    /// Swap orientations until the disorientations of neighbours, by area, have the histogram in a file: on each line the upper end of a
    /// bin in degrees, and its weight
    ///
    /// Example: --texture random --misorientations angles.csv
    #[arg(long, value_name = "FILE", requires = "texture", conflicts_with = "no_mesh")]
    misorientations: Option<PathBuf>,
}

impl TextureArguments {
    /// Whether the sample is to have a symmetry.
    pub fn has_sample_symmetry(&self) -> bool {
        self.sample_symmetry != SampleSymmetry::default()
    }

    /// What is asked for.
    pub fn options(&self) -> TextureOptions {
        TextureOptions {
            source: self.texture.clone(),
            symmetry: self.crystal_symmetry,
            sample_symmetry: self.sample_symmetry,
            misorientations: self.misorientations.clone(),
        }
    }
}

fn parse_texture(text: &str) -> Result<TextureSource, String> {
    TextureSource::new(text).map_err(|error| error.to_string())
}

fn parse_symmetry(text: &str) -> Result<CrystalSymmetry, String> {
    text.parse().map_err(|error: texture::SymmetryError| error.to_string())
}

fn parse_sample_symmetry(text: &str) -> Result<SampleSymmetry, String> {
    text.parse()
}
