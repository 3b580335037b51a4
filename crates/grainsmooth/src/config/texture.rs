//! What is asked of the grains' orientations.

use std::fmt;
use std::path::{Path, PathBuf};

use clap::Args;
use serde::{Serialize, Serializer};
use texture::{CrystalSymmetry, SampleSymmetry, Texture};

use super::spelling::{as_text, as_text_if_given, is_usual};

/// What is asked of the grains' orientations.
#[derive(Debug, Clone, PartialEq, Eq, Default, Args, Serialize)]
#[command(next_help_heading = "Texture")]
#[serde(rename_all = "kebab-case")]
pub struct TextureOptions {
    /// Give each grain an orientation: random, components with halfwidths in degrees, or a file
    ///
    /// Components are cube, goss, brass, copper, s and others; {112}<-1-11>(10); euler(30 45 60, 10); fiber(111||z, 10);
    /// gamma(10). Sums are weighted by volume: 'cube(5)*0.3 + random*0.7'. A file holds Euler angles with weights (.csv,
    /// .txt), Neper's orientations (.ori), or a measured map (.ang, .ctf).
    ///
    /// Example: --texture 'goss(10)'
    #[arg(id = "texture", long = "texture", value_name = "SPEC|FILE", value_parser = TextureSource::new)]
    #[serde(
        rename = "texture",
        skip_serializing_if = "Option::is_none",
        serialize_with = "as_text_if_given"
    )]
    pub source: Option<TextureSource>,

    /// Symmetry of the crystals: cubic, hexagonal, trigonal, tetragonal, orthorhombic, monoclinic, triclinic, or a group such as 432 or m-3m
    ///
    /// Example: --texture 'basal(20)' --crystal-symmetry hexagonal
    #[arg(
        long = "crystal-symmetry",
        value_name = "GROUP",
        default_value = "cubic",
        allow_hyphen_values = true
    )]
    #[serde(rename = "crystal-symmetry", skip_serializing_if = "is_usual", serialize_with = "as_text")]
    pub symmetry: CrystalSymmetry,

    /// Symmetry of the sample: triclinic (none), or orthorhombic as for rolled sheet, where each component has all its
    /// variants
    ///
    /// Example: --texture 'copper(8) + s(8) + brass(8)' --sample-symmetry orthorhombic
    #[arg(long, value_name = "GROUP", default_value = "triclinic")]
    #[serde(skip_serializing_if = "is_usual", serialize_with = "as_name")]
    pub sample_symmetry: SampleSymmetry,

    /// Swap orientations until the disorientations between neighbours, weighted by area, match a histogram: a file with the
    /// upper end of a bin in degrees and its weight on each line
    ///
    /// Example: --texture random --misorientations angles.csv
    #[arg(long, value_name = "FILE", requires = "texture", conflicts_with = "no_mesh")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub misorientations: Option<PathBuf>,
}

fn as_name<S: Serializer>(symmetry: &SampleSymmetry, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(symmetry.name())
}

/// Where orientations come from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum TextureSource {
    /// Words, as [`Texture`] reads them.
    Words(String),
    /// A file of orientations.
    File {
        /// Where it is.
        path: PathBuf,
        /// Which of the phases of a map.
        phase: Option<i64>,
    },
}

impl TextureSource {
    /// A file where one has this name, or the name ends as those of textures do, with `#2` behind it for the second phase of a map; else words.
    ///
    /// # Errors
    /// What is wrong with the words.
    pub fn new(text: &str) -> Result<Self, texture::SpecError> {
        let is_file = |path: &Path| TextureFormat::of_path(path).is_some() || path.is_file();
        if is_file(Path::new(text)) {
            return Ok(Self::File { path: text.into(), phase: None });
        }
        if let Some((path, phase)) = text.rsplit_once('#')
            && let Some(TextureFormat::Ang | TextureFormat::Ctf) = TextureFormat::of_path(Path::new(path))
            && let Ok(phase) = phase.parse()
        {
            return Ok(Self::File { path: path.into(), phase: Some(phase) });
        }
        text.parse::<Texture>().map(|_| Self::Words(text.to_owned()))
    }
}

/// As it is given.
impl fmt::Display for TextureSource {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Words(text) => out.write_str(text),
            Self::File { path, phase: None } => path.display().fmt(out),
            Self::File { path, phase: Some(phase) } => write!(out, "{}#{phase}", path.display()),
        }
    }
}

/// A format of files with orientations.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TextureFormat {
    /// A table of Euler angles and weights.
    Euler,
    /// Neper's list of orientations.
    Ori,
    /// TSL's map.
    Ang,
    /// HKL's map.
    Ctf,
}

impl TextureFormat {
    /// The format that the path's extension names, in upper or lower case.
    pub fn of_path(path: &Path) -> Option<Self> {
        let extension = path.extension()?.to_str()?.to_lowercase();
        match extension.as_str() {
            "csv" | "txt" => Some(Self::Euler),
            "ori" => Some(Self::Ori),
            "ang" => Some(Self::Ang),
            "ctf" => Some(Self::Ctf),
            _ => None,
        }
    }
}
