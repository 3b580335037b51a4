//! Pictures of the network, drawn in memory: no display and no graphics card is needed.

mod camera;
pub(crate) mod color;
mod coloring;
mod legend;
mod parts;
mod patch;
mod plane;
mod raster;
mod scene;
mod scene_colors;
mod text;

use std::io;
use std::num::NonZeroU16;

use polycrystal::Mesh;
use tiny_skia::{Pixmap, PixmapPaint, Transform};

use crate::{Error, Output, Polycrystal, StagedFiles};

use coloring::Paint;
use legend::Legend;
use patch::Seen;

pub(crate) use color::differing;
pub use coloring::Coloring;
pub(crate) use parts::{Parts, Pieces};
pub use scene::{Scene, ScenePicture, Shading};
pub use scene_colors::{SceneColors, SceneNumbers};

/// The format of pictures, 8 bits a channel on white.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Png;

/// What a picture shows, and how large it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Picture {
    /// Width and height in pixels.
    pub size: [NonZeroU16; 2],
    /// What the colours mean.
    pub coloring: Coloring,
    /// How far every grain is moved away from the middle, as a share of its distance from there; 0 draws the whole. What the box cut of a
    /// grain moves by itself.
    pub explode: f64,
    /// A plane that cuts what is shown, in space; the part before it is left out.
    pub slice: Option<Slice>,
    /// What is behind: nothing, or white.
    pub is_transparent: bool,
}

/// A plane across an axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Slice {
    /// The axis: x, y or z from 0.
    pub axis: usize,
    /// The coordinate along it.
    pub at: f64,
}

impl Default for Picture {
    fn default() -> Self {
        Self { size: Self::SIZE, coloring: Coloring::Grain, explode: 0.0, slice: None, is_transparent: false }
    }
}

impl Picture {
    /// The usual size: wide enough for a column of print at 300 dots an inch.
    pub const SIZE: [NonZeroU16; 2] = [NonZeroU16::new(1200).unwrap(), NonZeroU16::new(900).unwrap()];

    /// Share of the picture's width and height that stays free on each side.
    const MARGIN: f64 = 0.04;

    /// The width of a line, in pixels: one in 800 of the shorter side, which print still shows.
    fn line_width(&self) -> f64 {
        let shorter = self.size[0].min(self.size[1]);
        (f64::from(shorter.get()) / 800.0).max(1.0)
    }
}

impl Polycrystal {
    /// Draws the network from above one of its upper edges, in the plane from straight above: every grain shaded in its
    /// colour, the lines where boundaries meet in black.
    ///
    /// # Errors
    /// [`Error::WriteOutput`]; [`Error::OutputTwice`].
    pub fn stage_picture(
        &self,
        picture: &Picture,
        output: &Output<Png>,
        files: &mut StagedFiles,
    ) -> Result<(), Error> {
        output.stage(files, |out| out.write_all(&self.png(picture)?))
    }

    /// The bytes of a PNG file of the network, as [`stage_picture`](Self::stage_picture) draws it.
    ///
    /// # Errors
    /// Where memory for the pixels is missing.
    pub fn png(&self, picture: &Picture) -> io::Result<Vec<u8>> {
        let paint = picture.coloring.paint(self);
        let pixmap = beside_legend(paint.legend.as_ref(), picture.size, picture.is_transparent, |size| {
            let mut pixmap = blank(size, picture.is_transparent)?;
            self.draw(&Picture { size, ..*picture }, &paint, &mut pixmap)?;
            Ok(pixmap)
        })?;
        self.encoded(pixmap).map_err(io::Error::other)
    }

    fn draw(&self, picture: &Picture, paint: &Paint, pixmap: &mut Pixmap) -> io::Result<()> {
        let domain = self.network.domain();
        let middle = domain.lower().midpoint(domain.upper());
        match &self.network.finest().held().mesh {
            Mesh::Triangles(_) => {
                let is_whole = picture.explode == 0.0 && picture.slice.is_none();
                let seen = match (is_whole, &paint.boundaries) {
                    (false, _) => Seen::Grains,
                    (true, None) => Seen::Outside,
                    (true, Some(_)) => Seen::Boundaries,
                };
                let patches = patch::patches(self, (middle, picture.explode), seen)?;
                raster::draw(&patches, paint, picture, pixmap);
            }
            Mesh::Segments(lines) => plane::draw(self, lines, middle, paint, picture, pixmap),
        }
        Ok(())
    }

    /// A picture as PNG, with the settings of the run.
    fn encoded(&self, pixmap: Pixmap) -> Result<Vec<u8>, png::EncodingError> {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, pixmap.width(), pixmap.height());
        encoder.set_color(png::ColorType::Rgba);
        encoder.set_depth(png::BitDepth::Eight);
        encoder
            .add_text_chunk("Software".to_owned(), format!("grainsmooth {}", env!("CARGO_PKG_VERSION")))?;
        encoder.add_itxt_chunk("Config".to_owned(), self.provenance().text())?;
        encoder.write_header()?.write_image_data(&pixmap.take_demultiplied())?;
        Ok(bytes)
    }

    /// Number of boundaries of each grain.
    pub(crate) fn boundary_counts(&self) -> Vec<usize> {
        let mut counts = vec![0; self.network.grain_count()];
        for boundary in self.network.boundaries() {
            for (grain, _) in boundary.signed_grains() {
                counts[grain.index()] += 1;
            }
        }
        counts
    }

    /// Diameter of the ball (in the plane: the disc) of each grain's volume.
    pub(crate) fn equivalent_diameters(&self) -> Vec<f64> {
        let volumes = self.network.cell_volumes().iter();
        volumes.map(|volume| self.dimension().ball_diameter(*volume)).collect()
    }
}

/// A picture of a size with its legend, if there is one, on the right; `draw` makes the rest of it in the size that is left.
fn beside_legend(
    legend: Option<&Legend>,
    size: [NonZeroU16; 2],
    is_transparent: bool,
    draw: impl FnOnce([NonZeroU16; 2]) -> io::Result<Pixmap>,
) -> io::Result<Pixmap> {
    let Some(legend) = legend else { return draw(size) };
    let mut pixmap = blank(size, is_transparent)?;
    let [width, height] = size;
    let taken = legend.width(size.map(|side| usize::from(side.get())));
    let left = u16::try_from(usize::from(width.get()) - taken).ok().and_then(NonZeroU16::new);
    let drawn = draw([left.unwrap_or(width), height])?;
    pixmap.draw_pixmap(0, 0, drawn.as_ref(), &PixmapPaint::default(), Transform::identity(), None);
    legend.draw(&mut pixmap);
    Ok(pixmap)
}

/// An empty picture, white or transparent.
fn blank(size: [NonZeroU16; 2], is_transparent: bool) -> io::Result<Pixmap> {
    let [width, height] = size.map(|side| u32::from(side.get()));
    let mut pixmap = Pixmap::new(width, height)
        .ok_or_else(|| io::Error::other("the picture is too large; give a smaller --picture-size"))?;
    if !is_transparent {
        pixmap.fill(tiny_skia::Color::WHITE);
    }
    Ok(pixmap)
}
