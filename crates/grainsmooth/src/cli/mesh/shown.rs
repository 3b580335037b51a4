//! Options about pictures and reports of meshes.

use std::path::PathBuf;

use crate::{Error, Html, Output, Png, ScenePicture, Shading};
use clap::Args;

use crate::cli::pictures::{parse_html, parse_png, picture_size};
use crate::spelling::{Named, one_of, whole_number};

/// Pictures and pages of the result.
#[derive(Debug, Args)]
#[command(next_help_heading = "Pictures")]
pub struct ShownArguments {
    /// Draw the result, without a display; with --each-level, an animation (APNG) of the levels
    #[arg(long, value_name = "PATH.png", value_parser = parse_png)]
    picture: Option<PathBuf>,

    /// Width and height of the picture in pixels [default: 1200 900]
    #[arg(long, value_names = ["W", "H"], num_args = 2, value_parser = whole_number(16..=16_384_u16), allow_negative_numbers = true, requires = "picture")]
    picture_size: Option<Vec<u16>>,

    /// Draw faces in one shade with their edges, and curves with their points (flat), or draw smooth surfaces (smooth)
    #[arg(long, value_parser = one_of(&SHADINGS), default_value = "flat", requires = "picture")]
    shading: Shading,

    /// Colour the picture by an array of the result, with a key on the right
    ///
    /// The array has one number for each point, face or polyline: Generation, or one that the input has and that is kept.
    ///
    /// Example: --picture smooth.png --color-by Generation
    #[arg(long, value_name = "ARRAY", requires = "picture")]
    color_by: Option<String>,

    /// Write a web page with a 3D view of the result, histograms and the figures of the run; it works offline
    #[arg(long, value_name = "PATH.html", value_parser = parse_html)]
    report: Option<PathBuf>,
}

const SHADINGS: [Named<Shading>; 2] = [("flat", "", Shading::Flat), ("smooth", "", Shading::Smooth)];

impl ShownArguments {
    /// The picture asked for, its path found writable.
    pub fn picture(&self) -> Result<Option<(ScenePicture, Output<Png>)>, Error> {
        let Some(path) = &self.picture else { return Ok(None) };
        let picture =
            ScenePicture { size: picture_size(self.picture_size.as_deref()), shading: self.shading };
        Ok(Some((picture, Output::check_as(path, Png)?)))
    }

    /// The array that colours the picture.
    pub fn color_by(&self) -> Option<&str> {
        self.color_by.as_deref()
    }

    /// The report asked for, its path found writable.
    pub fn report(&self) -> Result<Option<Output<Html>>, Error> {
        self.report.as_ref().map(|path| Output::check_as(path, Html)).transpose()
    }
}
