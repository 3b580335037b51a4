//! What is asked of the grains' orientations.

use std::path::{Path, PathBuf};

use texture::{CrystalSymmetry, SampleSymmetry, Texture};

/// What is asked of the grains' orientations.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct TextureOptions {
    /// Where they come from; nothing for none.
    pub source: Option<TextureSource>,
    /// The symmetry of the crystals.
    pub symmetry: CrystalSymmetry,
    /// The symmetry of the sample.
    pub sample_symmetry: SampleSymmetry,
    /// The file of a histogram that the disorientations of neighbours are to have.
    pub misorientations: Option<PathBuf>,
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

    /// As it is given.
    pub fn text(&self) -> String {
        match self {
            Self::Words(text) => text.clone(),
            Self::File { path, phase: None } => path.display().to_string(),
            Self::File { path, phase: Some(phase) } => format!("{}#{phase}", path.display()),
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
