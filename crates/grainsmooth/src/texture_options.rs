//! What is asked of the grains' orientations.

use std::path::{Path, PathBuf};

use texture::{AngleHistogram, CrystalSymmetry, SampleSymmetry, Texture};

use crate::Error;
use crate::texture_file::{TextureFormat, read_disorientation_file, read_texture_file};

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
    File(PathBuf),
}

impl TextureSource {
    /// A file where one has this name, or the name ends as those of textures do; else words.
    ///
    /// # Errors
    /// What is wrong with the words.
    pub fn new(text: &str) -> Result<Self, texture::SpecError> {
        let path = Path::new(text);
        if TextureFormat::of_path(path).is_some() || path.is_file() {
            return Ok(Self::File(path.to_owned()));
        }
        text.parse::<Texture>().map(|_| Self::Words(text.to_owned()))
    }

    /// As it is given.
    pub fn text(&self) -> String {
        match self {
            Self::Words(text) => text.clone(),
            Self::File(path) => path.display().to_string(),
        }
    }
}

impl TextureOptions {
    /// The histogram of disorientations that is asked for, if one is.
    ///
    /// # Errors
    /// [`Error::TextureFileUnreadable`]; [`Error::BadTextureFile`].
    pub fn histogram(&self) -> Result<Option<AngleHistogram>, Error> {
        let read = |path: &PathBuf| read_disorientation_file(path, self.symmetry);
        self.misorientations.as_ref().map(read).transpose()
    }

    /// The texture that is asked for, if one is.
    ///
    /// # Errors
    /// [`Error::Texture`]; [`Error::TextureFileUnreadable`], [`Error::BadTextureFile`]; [`Error::TextureSymmetry`] where a measured map
    /// has crystals of another symmetry.
    pub fn texture(&self) -> Result<Option<Texture>, Error> {
        let texture = match &self.source {
            None => return Ok(None),
            Some(TextureSource::Words(text)) => text.parse()?,
            Some(TextureSource::File(path)) => {
                let found = read_texture_file(path)?;
                if let Some(of_file) = found.symmetry.filter(|of_file| *of_file != self.symmetry) {
                    return Err(Error::TextureSymmetry { path: path.clone(), of_file, asked: self.symmetry });
                }
                let name = path.file_name().unwrap_or_default().to_string_lossy();
                Texture::of_list(&found.orientations, None, &name).ok_or_else(|| Error::BadTextureFile {
                    path: path.clone(),
                    line: 1,
                    problem: "no orientation has a weight above 0; give at least one".to_owned(),
                })?
            }
        };
        Ok(Some(texture.with_sample_symmetry(self.sample_symmetry)))
    }
}
