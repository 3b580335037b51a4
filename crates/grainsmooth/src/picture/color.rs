/// Red, green and blue, from 0 to 1.
pub(crate) type Color = [f64; 3];

pub(super) fn channels(color: colorous::Color) -> Color {
    [color.r, color.g, color.b].map(|channel| f64::from(channel) / 255.0)
}
