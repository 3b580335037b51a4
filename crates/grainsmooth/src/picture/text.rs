//! Text in pictures.

use noto_sans_mono_bitmap::{FontWeight, RasterHeight, get_raster, get_raster_width};
use tiny_skia::Pixmap;

/// The heights of the letters that there are, in pixels.
const HEIGHTS: [RasterHeight; 4] =
    [RasterHeight::Size16, RasterHeight::Size20, RasterHeight::Size24, RasterHeight::Size32];

/// Letters of one height.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pen {
    raster: RasterHeight,
    /// Pixels along each side of one of the letters' own.
    factor: usize,
}

impl Pen {
    /// Letters about so many pixels high.
    pub(super) fn of_height(pixels: usize) -> Self {
        let factor = (pixels / 32).max(1);
        let raster = HEIGHTS.into_iter().rfind(|raster| factor * raster.val() <= pixels);
        Self { raster: raster.unwrap_or(RasterHeight::Size16), factor }
    }

    /// Height of a line, in pixels.
    pub(super) fn height(self) -> usize {
        self.factor * self.raster.val()
    }

    /// Width of a text, in pixels.
    pub(super) fn width(self, text: &str) -> usize {
        self.factor * get_raster_width(FontWeight::Regular, self.raster) * text.chars().count()
    }

    /// Writes a text in black from its upper left corner. What lies outside the picture, and letters of other scripts than Latin, are left
    /// out.
    pub(super) fn write(self, text: &str, [left, top]: [usize; 2], pixmap: &mut Pixmap) {
        let advance = self.factor * get_raster_width(FontWeight::Regular, self.raster);
        let [width, height] = [pixmap.width() as usize, pixmap.height() as usize];
        let data = pixmap.data_mut();
        for (number, letter) in text.chars().enumerate() {
            let Some(letter) = get_raster(letter, FontWeight::Regular, self.raster) else { continue };
            let left = left + number * advance;
            for y in top..(top + self.height()).min(height) {
                for x in left..(left + advance).min(width) {
                    let ink = letter.pixel((x - left) / self.factor, (y - top) / self.factor).unwrap_or(0);
                    let pixel = &mut data[4 * (y * width + x)..][..4];
                    // Colours are multiplied by opacity, and black has none.
                    let left =
                        |channel: u8| u16::from(channel) * u16::from(u8::MAX - ink) / u16::from(u8::MAX);
                    let added = [0, 0, 0, u16::from(ink)];
                    for (channel, added) in pixel.iter_mut().zip(added) {
                        *channel = u8::try_from(left(*channel) + added).unwrap_or(u8::MAX);
                    }
                }
            }
        }
    }
}
