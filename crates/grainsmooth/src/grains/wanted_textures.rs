//! The textures that grains are to have.

use std::path::PathBuf;

use texture::{AngleHistogram, CrystalSymmetry, Texture};

use crate::config::phases::PhaseOptions;
use crate::config::texture::{TextureOptions, TextureSource};
use crate::input::texture_file::{read_disorientation_file, read_texture_file};
use crate::{Config, Error};

impl TextureOptions {
    /// The histogram of disorientations that is asked for, if one is.
    ///
    /// # Errors
    /// [`Error::Unreadable`]; [`Error::BadLine`].
    pub fn histogram(&self) -> Result<Option<AngleHistogram>, Error> {
        let read = |path: &PathBuf| read_disorientation_file(path, self.symmetry);
        self.misorientations.as_ref().map(read).transpose()
    }

    /// The texture of a source.
    ///
    /// # Errors
    /// [`Error::Texture`]; [`Error::Unreadable`], [`Error::BadLine`]; [`Error::TextureSymmetry`] where a measured map
    /// has crystals of another symmetry, which `option` asks for.
    fn read(
        &self,
        source: &TextureSource,
        symmetry: CrystalSymmetry,
        option: &'static str,
    ) -> Result<Texture, Error> {
        let texture = match source {
            TextureSource::Words(text) => text.parse()?,
            TextureSource::File { path, phase } => {
                let found = read_texture_file(path, *phase)?;
                if let Some(of_file) = found.symmetry.filter(|of_file| *of_file != symmetry) {
                    return Err(Error::TextureSymmetry {
                        path: path.clone(),
                        of_file,
                        asked: symmetry,
                        option,
                    });
                }
                let name = path.file_name().unwrap_or_default().to_string_lossy();
                Texture::of_list(&found.orientations, None, &name).ok_or_else(|| Error::BadLine {
                    path: path.clone(),
                    line: 1,
                    problem: "no orientation has a weight above 0; give at least one".to_owned(),
                })?
            }
        };
        Ok(texture.with_sample_symmetry(self.sample_symmetry))
    }
}

/// The orientations of some grains.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct PhaseTexture {
    pub(crate) texture: Texture,
    pub(crate) symmetry: CrystalSymmetry,
}

impl Config {
    /// The texture of each phase, of all grains without phases; none where none is asked for. A phase without one is random where another
    /// has one.
    ///
    /// # Errors
    /// Whatever is wrong with words or files of orientations.
    pub(crate) fn textures(&self) -> Result<Vec<PhaseTexture>, Error> {
        if self.has_texture() { self.textures_or_random() } else { Ok(Vec::new()) }
    }

    /// The same with random orientations where none are asked for.
    ///
    /// # Errors
    /// As of [`Self::textures`].
    pub(crate) fn textures_or_random(&self) -> Result<Vec<PhaseTexture>, Error> {
        let options = &self.texture;
        let read = |source: Option<&TextureSource>, symmetry, option| {
            let texture = match source {
                Some(source) => options.read(source, symmetry, option)?,
                None => Texture::random(),
            };
            Ok(PhaseTexture { texture, symmetry })
        };
        if self.phases.is_empty() {
            return Ok(vec![read(options.source.as_ref(), options.symmetry, "--crystal-symmetry ")?]);
        }
        let of_phase = |phase: &PhaseOptions| {
            let source = phase.texture.as_ref().or(options.source.as_ref());
            read(source, phase.symmetry.unwrap_or(options.symmetry), "symmetry=")
        };
        self.phases.iter().map(of_phase).collect()
    }
}
