//! What is asked of the grains' orientations.

use std::path::{Path, PathBuf};

use texture::{AngleHistogram, CrystalSymmetry, SampleSymmetry, Texture};

use crate::texture_file::{TextureFormat, read_disorientation_file, read_texture_file};
use crate::{Config, Error, PhaseOptions};

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

impl TextureOptions {
    /// The histogram of disorientations that is asked for, if one is.
    ///
    /// # Errors
    /// [`Error::TextureFileUnreadable`]; [`Error::BadTextureFile`].
    pub fn histogram(&self) -> Result<Option<AngleHistogram>, Error> {
        let read = |path: &PathBuf| read_disorientation_file(path, self.symmetry);
        self.misorientations.as_ref().map(read).transpose()
    }

    /// The texture of a source.
    ///
    /// # Errors
    /// [`Error::Texture`]; [`Error::TextureFileUnreadable`], [`Error::BadTextureFile`]; [`Error::TextureSymmetry`] where a measured map
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
                Texture::of_list(&found.orientations, None, &name).ok_or_else(|| Error::BadTextureFile {
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
