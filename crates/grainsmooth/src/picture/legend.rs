//! What the colours of a picture mean, beside it.

use colorous::VIRIDIS;
use texture::{CrystalSymmetry, IpfKey};
use tiny_skia::Pixmap;

use super::color::{Color, channels};
use super::text::Pen;
use crate::figures::direction_frame::{Frame, named_corners};

/// Height of letters as a share of a picture's shorter side: those of print that is read at arm's length.
const LETTERS: f64 = 0.027;

/// A key to colours.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Legend {
    /// A bar of Viridis, with what its lower and upper ends stand for.
    Bar {
        /// What is shown.
        title: String,
        /// The least and the greatest value.
        ends: [String; 2],
    },
    /// A square of each colour, with its name.
    Names(Vec<(Color, String)>),
    /// The crystal directions along an axis of the sample.
    Directions {
        /// What is shown.
        title: String,
        /// Those of the crystals.
        symmetries: Vec<CrystalSymmetry>,
    },
}

impl Legend {
    fn texts(&self) -> Vec<&str> {
        match self {
            Self::Bar { title, ends: [least, greatest] } => vec![title, least, greatest],
            Self::Names(names) => names.iter().map(|(_, name)| name.as_str()).collect(),
            Self::Directions { title, .. } => vec![title],
        }
    }

    fn pen([width, height]: [usize; 2]) -> Pen {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "pictures are not that large"
        )]
        let letters = (LETTERS * width.min(height) as f64) as usize;
        Pen::of_height(letters)
    }

    /// The columns of a picture of a size, in pixels, that this takes at the right; at most half of them.
    pub(super) fn width(&self, size: [usize; 2]) -> usize {
        let pen = Self::pen(size);
        let text = self.texts().into_iter().map(|text| pen.width(text)).max().unwrap_or(0);
        let width = match self {
            Self::Bar { .. } => text,
            Self::Names(_) => text + 2 * pen.height(),
            Self::Directions { .. } => text.max(8 * pen.height()),
        };
        (width + pen.height()).min(size[0] / 2)
    }

    /// Draws it into the right of a picture.
    pub(super) fn draw(&self, pixmap: &mut Pixmap) {
        let size = [pixmap.width() as usize, pixmap.height() as usize];
        let pen = Self::pen(size);
        let line = pen.height();
        let left = size[0] - self.width(size);
        let write = |text: &str, top: usize, pixmap: &mut Pixmap| pen.write(text, [left, top], pixmap);
        match self {
            Self::Bar { title, ends: [least, greatest] } => {
                let (top, height) = (size[1] / 4, size[1] / 2);
                write(title, top.saturating_sub(3 * line), pixmap);
                write(greatest, top.saturating_sub(line + line / 4), pixmap);
                for row in 0..height {
                    let share = 1.0 - (row as f64 + 0.5) / height as f64;
                    let color = channels(VIRIDIS.eval_continuous(share));
                    (left..left + line).for_each(|x| set(pixmap, [x, top + row], color));
                }
                write(least, top + height + line / 4, pixmap);
            }
            Self::Names(names) => {
                let step = line + line / 2;
                let mut top = (size[1] / 2).saturating_sub(names.len() * step / 2);
                for (color, name) in names {
                    for place in (0..line * line).map(|number| [left + number % line, top + number / line]) {
                        set(pixmap, place, *color);
                    }
                    pen.write(name, [left + line + line / 2, top], pixmap);
                    top += step;
                }
            }
            Self::Directions { title, symmetries } => {
                let side = self.width(size).saturating_sub(line);
                let step = side + 3 * line;
                let top = (size[1] / 2).saturating_sub(symmetries.len() * step / 2);
                write(title, top.saturating_sub(line), pixmap);
                for (number, symmetry) in symmetries.iter().enumerate() {
                    draw_directions(*symmetry, [left, top + number * step + 2 * line], side, pen, pixmap);
                }
            }
        }
    }
}

/// Draws the colours of a symmetry's directions into a square with its upper left corner at a place, and names above and below.
fn draw_directions(
    symmetry: CrystalSymmetry,
    [left, top]: [usize; 2],
    side: usize,
    pen: Pen,
    pixmap: &mut Pixmap,
) {
    let line = pen.height();
    let (frame, key) = (Frame::of_sector(symmetry), IpfKey::new(symmetry));
    let share = |pixel: usize| (pixel as f64 + 0.5) / side as f64;
    for place in (0..side * side).map(|number| [number % side, number / side]) {
        if let Some(direction) = frame.direction(place.map(share)) {
            set(pixmap, [left + place[0], top + place[1]], key.color(direction));
        }
    }
    for (name, direction) in named_corners(symmetry) {
        let [right, down] = frame.place(direction);
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "shares from 0 to 1 of a number of pixels"
        )]
        let [x, y] = [right, down].map(|share| (share * side as f64) as usize);
        // Not over the ends of the square.
        let end = (left + side + line).saturating_sub(pen.width(name));
        let x = (left + x).saturating_sub(pen.width(name) / 2).clamp(left, end.max(left));
        let y = if down < 0.5 { (top + y).saturating_sub(line + line / 4) } else { top + y + line / 4 };
        pen.write(name, [x, y], pixmap);
    }
}

/// Colours a pixel, if the picture has it.
fn set(pixmap: &mut Pixmap, [x, y]: [usize; 2], color: Color) {
    let [width, height] = [pixmap.width() as usize, pixmap.height() as usize];
    if x < width && y < height {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "from 0 to 255")]
        let [red, green, blue] = color.map(|channel| (255.0 * channel).round() as u8);
        pixmap.data_mut()[4 * (y * width + x)..][..4].copy_from_slice(&[red, green, blue, u8::MAX]);
    }
}
