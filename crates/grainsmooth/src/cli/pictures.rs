//! Options about pictures and the report.

use std::num::NonZeroU16;
use std::path::{Path, PathBuf};

use crate::{Coloring, Error, Html, Output, Picture, Png, Slice};
use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};

use super::usage;
use crate::spelling::whole_number;

/// Pictures and pages of the result.
#[derive(Debug, Args)]
#[command(next_help_heading = "Pictures")]
pub struct PictureArguments {
    /// Draw the network, seen from above one edge of the box, without a display
    ///
    /// Example: --picture grains.png
    #[arg(long, value_name = "PATH.png", value_parser = parse_png)]
    picture: Option<PathBuf>,

    /// Width and height of the picture in pixels [default: 1200 900]
    ///
    /// Example: --picture grains.png --picture-size 2400 1800
    #[arg(long, value_names = ["W", "H"], num_args = 2, value_parser = whole_number(16..=16_384_u16), allow_negative_numbers = true, requires = "picture")]
    picture_size: Option<Vec<u16>>,

    /// What the colours show: only which grain is which (grain); the equivalent diameter, number of boundaries
    /// (neighbors), phase, or crystal direction along an axis (ipf-x, ipf-y, ipf-z) of each grain; or the disorientation of
    /// each boundary
    ///
    /// There is a key on the right. Crystal directions and disorientations need a texture.
    ///
    /// Example: --picture directions.png --texture random --color-by ipf-z
    #[arg(long, value_name = "WHAT", value_parser = colorings(), default_value = "grain", requires = "picture")]
    color_by: Coloring,

    /// Exploded view: move each grain away from the centre by X times its distance from it
    ///
    /// Example: --picture apart.png --explode 0.4
    #[arg(long, value_name = "X", default_value_t = 0.0, value_parser = parse_explode, allow_negative_numbers = true, requires = "picture")]
    explode: f64,

    /// Cut the grains in the picture by a plane across an axis, and leave out the part in front of it
    ///
    /// Example: --picture inside.png --slice z=0.5
    #[arg(long, value_name = "AXIS=X", value_parser = parse_slice, requires = "picture")]
    slice: Option<Slice>,

    /// Leave the background of the picture transparent
    ///
    /// Example: --picture grains.png --transparent
    #[arg(long, requires = "picture")]
    transparent: bool,

    /// Write a web page with a 3D view of the grains, histograms and the figures of the run; it works offline
    ///
    /// Example: --report grains.html
    #[arg(long, value_name = "PATH.html", value_parser = parse_html)]
    report: Option<PathBuf>,
}

impl PictureArguments {
    /// Checks that a file holds what colours are to show.
    ///
    /// # Errors
    /// [`Error::Usage`] with what it lacks.
    pub fn check_known(&self, path: &Path, has_orientations: bool, has_phases: bool) -> Result<(), Error> {
        let coloring = self.coloring();
        let lacks = match coloring {
            Coloring::Phase if !has_phases => "phases",
            _ if coloring.needs_texture() && !has_orientations => "orientations",
            _ => return Ok(()),
        };
        let (name, path) = (coloring.name(), path.display());
        Err(usage(&format!("--color-by {name} needs {lacks}, which {path} does not hold; leave it out")))
    }

    /// How the picture is coloured.
    pub fn coloring(&self) -> Coloring {
        self.color_by
    }

    /// The plane that cuts the picture.
    pub fn slice(&self) -> Option<Slice> {
        self.slice
    }

    /// The picture asked for, its path found writable.
    pub fn picture(&self) -> Result<Option<(Picture, Output<Png>)>, Error> {
        let Some(path) = &self.picture else { return Ok(None) };
        Ok(Some((
            Picture {
                size: picture_size(self.picture_size.as_deref()),
                coloring: self.color_by,
                explode: self.explode,
                slice: self.slice,
                is_transparent: self.transparent,
            },
            Output::check_as(path, Png)?,
        )))
    }

    /// The report asked for, its path found writable.
    pub fn report(&self) -> Result<Option<Output<Html>>, Error> {
        self.report.as_ref().map(|path| Output::check_as(path, Html)).transpose()
    }
}

/// Pixels along both sides, the usual ones where none are given.
pub(super) fn picture_size(sides: Option<&[u16]>) -> [NonZeroU16; 2] {
    let at_least_one = |side: &u16| NonZeroU16::new(*side).unwrap_or(NonZeroU16::MIN);
    match sides {
        Some([width, height]) => [width, height].map(at_least_one),
        _ => Picture::SIZE,
    }
}

/// Every name of a way of colouring.
fn colorings() -> impl TypedValueParser<Value = Coloring> {
    let named = |name: String| Coloring::ALL.into_iter().find(|(_, known)| *known == name);
    PossibleValuesParser::new(Coloring::ALL.map(|(_, name)| name))
        .map(move |name| named(name).map(|(way, _)| way).unwrap_or_default())
}

pub(super) fn parse_png(text: &str) -> Result<PathBuf, String> {
    parse_named(text, "png")
}

pub(super) fn parse_html(text: &str) -> Result<PathBuf, String> {
    parse_named(text, "html")
}

/// A path with the only extension that fits; another would tell its readers something untrue.
fn parse_named(text: &str, extension: &str) -> Result<PathBuf, String> {
    let path = Path::new(text);
    if path.extension().is_some_and(|given| given.eq_ignore_ascii_case(extension)) {
        return Ok(path.to_owned());
    }
    Err(format!("unknown extension; name the file *.{extension}"))
}

fn parse_slice(text: &str) -> Result<Slice, String> {
    let found = text.split_once('=').and_then(|(axis, at)| {
        let axis = ["x", "y", "z"].into_iter().position(|known| known == axis)?;
        let at = at.parse().ok().filter(|at: &f64| at.is_finite())?;
        Some(Slice { axis, at })
    });
    found.ok_or_else(|| "give an axis and a coordinate, as z=0.5".to_owned())
}

fn parse_explode(text: &str) -> Result<f64, String> {
    // Beyond ten times their distance grains are dots.
    let share = text.parse().ok().filter(|share| (0.0..=10.0).contains(share));
    share.ok_or_else(|| "give a number from 0 (whole) to 10".to_owned())
}
