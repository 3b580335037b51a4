//! Triangles and lines with a depth buffer, in bands of rows that are drawn in parallel.

use std::f64::consts::TAU;
use std::num::NonZeroU16;

use glam::DVec3;
use rayon::prelude::*;
use tiny_skia::Pixmap;

use super::Picture;
use super::camera::Camera;
use super::color::Color;
use super::coloring::Paint;
use super::patch::Patch;

/// Samples along each side of a pixel: nine shades smooth an edge.
const SAMPLES: usize = 3;

/// Rows of pixels that are drawn together: enough that few triangles fall into two bands, and bands for all threads.
const BAND: usize = 32;

/// What lines are drawn in: nearly black.
pub(super) const LINE: Color = [0.1; 3];

/// Sides of a disc, which is a polygon: a circle at the size of points.
const DISC_SIDES: u32 = 16;

/// Draws patches in the colours of their grains or boundaries, as large as the picture allows.
pub(super) fn draw(patches: &[Patch], paint: &Paint, picture: &Picture, pixmap: &mut Pixmap) {
    let [width, height] = picture.size.map(|side| usize::from(side.get()));
    let camera = Camera::new(patches, [width, height].map(|side| (side * SAMPLES) as f64));
    let shown: Vec<Shown> = patches.par_iter().map(|patch| Shown::new(patch, &camera)).collect();
    let half_width = picture.line_width() * SAMPLES as f64 / 2.0;
    draw_bands(width, pixmap, |band| {
        for (patch, shown) in patches.iter().zip(&shown) {
            let color = match &paint.boundaries {
                Some(boundaries) => boundaries[patch.boundary],
                None => paint.grains[patch.grain],
            };
            if band.meets(shown.rows, half_width) {
                band.draw_patch(patch, shown, color, half_width);
            }
        }
    });
}

/// Draws in bands of rows of a picture of this width, in parallel.
fn draw_bands(width: usize, pixmap: &mut Pixmap, draw: impl Fn(&mut Band) + Sync) {
    let pixels = pixmap.data_mut().par_chunks_mut(4 * width * BAND);
    pixels.enumerate().for_each(|(number, pixels)| {
        let rows = pixels.len() / (4 * width);
        let mut band = Band::new(number * BAND * SAMPLES, rows * SAMPLES, width * SAMPLES);
        draw(&mut band);
        band.into_pixels(pixels);
    });
}

/// What is drawn of a mesh or of curves, placed in samples.
#[derive(Default)]
pub(super) struct Figures {
    /// Triangles, with a colour at each corner.
    pub(super) triangles: Vec<([DVec3; 3], [Color; 3])>,
    /// Lines with their colours and half widths.
    pub(super) lines: Vec<([DVec3; 2], Color, f64)>,
    /// Discs with their colours and radii.
    pub(super) discs: Vec<(DVec3, Color, f64)>,
}

/// Samples along each side of a picture.
pub(super) fn samples(size: [NonZeroU16; 2]) -> [f64; 2] {
    size.map(|side| f64::from(side.get()) * SAMPLES as f64)
}

/// Draws figures as they are placed; of those in one place the nearest.
pub(super) fn draw_figures(figures: &Figures, pixmap: &mut Pixmap) {
    let width = usize::try_from(pixmap.width()).unwrap_or(usize::MAX);
    draw_bands(width, pixmap, |band| {
        for (corners, colors) in &figures.triangles {
            let rows = corners.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], place| {
                [low.min(place.y), high.max(place.y)]
            });
            if band.meets(rows, 0.0) {
                let color = |weights: [f64; 3]| {
                    [0, 1, 2].map(|channel| (0..3).map(|at| weights[at] * colors[at][channel]).sum())
                };
                band.draw_triangle(*corners, color);
            }
        }
        for (ends, color, half_width) in &figures.lines {
            let [low, high] = [ends[0].y.min(ends[1].y), ends[0].y.max(ends[1].y)];
            if band.meets([low, high], 2.0 * half_width) {
                band.draw_line(*ends, *half_width, *color);
            }
        }
        for (middle, color, radius) in &figures.discs {
            if band.meets([middle.y; 2], *radius) {
                band.draw_disc(*middle, *radius, *color);
            }
        }
    });
}

/// A patch as the camera sees it.
struct Shown {
    /// Places of the points, in samples.
    places: Vec<DVec3>,
    /// Brightness at the points.
    brightness: Vec<f64>,
    /// First and last row of samples.
    rows: [f64; 2],
}

impl Shown {
    fn new(patch: &Patch, camera: &Camera) -> Self {
        let places: Vec<DVec3> = patch.points.iter().map(|point| camera.project(*point)).collect();
        let brightness = patch.normals.iter().map(|normal| camera.brightness(*normal)).collect();
        let rows = places.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], place| {
            [low.min(place.y), high.max(place.y)]
        });
        Self { places, brightness, rows }
    }
}

/// Some rows of samples.
struct Band {
    first_row: usize,
    row_count: usize,
    width: usize,
    /// How near what was drawn is.
    nearness: Vec<f64>,
    colors: Vec<Color>,
}

impl Band {
    fn new(first_row: usize, row_count: usize, width: usize) -> Self {
        let count = row_count * width;
        Self {
            first_row,
            row_count,
            width,
            nearness: vec![f64::NEG_INFINITY; count],
            colors: vec![[1.0; 3]; count],
        }
    }

    fn meets(&self, [first, last]: [f64; 2], margin: f64) -> bool {
        last + margin >= self.first_row as f64 && first - margin <= (self.first_row + self.row_count) as f64
    }

    fn draw_patch(&mut self, patch: &Patch, shown: &Shown, color: Color, half_width: f64) {
        for triangle in &patch.triangles {
            let corners = triangle.map(|point| shown.places[point as usize]);
            let brightness = triangle.map(|point| shown.brightness[point as usize]);
            self.draw_triangle(corners, |weights| {
                let shade: f64 = (0..3).map(|corner| weights[corner] * brightness[corner]).sum();
                color.map(|channel| channel * shade)
            });
        }
        for edge in &patch.rim {
            self.draw_line(edge.map(|point| shown.places[point as usize]), half_width, LINE);
        }
    }

    /// A line, as two triangles that face the viewer, a little nearer than it is lest its own surface hides it.
    fn draw_line(&mut self, ends: [DVec3; 2], half_width: f64, color: Color) {
        let along = (ends[1] - ends[0]).with_z(0.0).normalize_or_zero() * half_width;
        let across = DVec3::new(along.y, -along.x, 0.0);
        // A surface that rises by twice the line's width over that width, which is steep, still shows the line.
        let nearer = DVec3::Z * (4.0 * half_width);
        let [start, end] = [ends[0] - along + nearer, ends[1] + along + nearer];
        let [a, b, c, d] = [start + across, start - across, end - across, end + across];
        for corners in [[a, b, c], [a, c, d]] {
            self.draw_triangle(corners, |_| color);
        }
    }

    /// A disc that faces the viewer, nearer than the lines that end there.
    fn draw_disc(&mut self, middle: DVec3, radius: f64, color: Color) {
        let middle = middle + DVec3::Z * (4.0 * radius);
        let place = |step: u32| {
            let (sine, cosine) = (f64::from(step) * TAU / f64::from(DISC_SIDES)).sin_cos();
            // Rows count downward.
            middle + radius * DVec3::new(cosine, -sine, 0.0)
        };
        for step in 0..DISC_SIDES {
            self.draw_triangle([middle, place(step), place(step + 1)], |_| color);
        }
    }

    /// Draws where the triangle is nearest so far; `color` is told the weights of the corners. Triangles that face away are not
    /// drawn: every surface is closed, and its other side is nearer.
    fn draw_triangle(&mut self, [a, b, c]: [DVec3; 3], color: impl Fn([f64; 3]) -> Color) {
        let rows = self.samples_between(
            a.y.min(b.y).min(c.y),
            a.y.max(b.y).max(c.y),
            self.first_row,
            self.row_count,
        );
        let columns = self.samples_between(a.x.min(b.x).min(c.x), a.x.max(b.x).max(c.x), 0, self.width);
        let doubled_area = cross(b - a, c - a);
        // Rows count downward, so what winds counter-clockwise has a negative area here.
        if rows.is_empty() || columns.is_empty() || doubled_area >= 0.0 {
            return;
        }
        let per_area = doubled_area.recip();
        for row in rows {
            for column in columns.clone() {
                let sample = DVec3::new(column as f64 + 0.5, (self.first_row + row) as f64 + 0.5, 0.0);
                let weights =
                    [[b, c], [c, a], [a, b]].map(|[from, to]| cross(to - from, sample - from) * per_area);
                if weights.iter().any(|weight| *weight < 0.0) {
                    continue;
                }
                let nearness = weights[0] * a.z + weights[1] * b.z + weights[2] * c.z;
                let at = row * self.width + column;
                if nearness > self.nearness[at] {
                    self.nearness[at] = nearness;
                    self.colors[at] = color(weights);
                }
            }
        }
    }

    /// The samples whose middles lie between two places, counted from `first`, of which there are `count`.
    fn samples_between(&self, low: f64, high: f64, first: usize, count: usize) -> std::ops::Range<usize> {
        let within = |place: f64| (place - first as f64).clamp(0.0, count as f64);
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "casts of clamped numbers lose their fractions only"
        )]
        let range = within((low - 0.5).ceil()) as usize..within((high + 0.5).floor()) as usize;
        range
    }

    /// The means over pixels, as red, green, blue and opacity.
    fn into_pixels(self, pixels: &mut [u8]) {
        let pixels_a_row = self.width / SAMPLES;
        for (number, pixel) in pixels.chunks_exact_mut(4).enumerate() {
            let (row, column) = (number / pixels_a_row * SAMPLES, number % pixels_a_row * SAMPLES);
            for (channel, byte) in pixel[..3].iter_mut().enumerate() {
                let rows = (row..row + SAMPLES).map(|row| row * self.width + column);
                let samples = rows.flat_map(|start| &self.colors[start..start + SAMPLES]);
                let mean = samples.map(|color| color[channel]).sum::<f64>() / (SAMPLES * SAMPLES) as f64;
                #[expect(
                    clippy::cast_possible_truncation,
                    clippy::cast_sign_loss,
                    reason = "from 0 to 255 without a remainder"
                )]
                let value = (255.0 * mean).round() as u8;
                *byte = value;
            }
            pixel[3] = u8::MAX;
        }
    }
}

/// The third component of the cross product.
fn cross(a: DVec3, b: DVec3) -> f64 {
    a.x * b.y - a.y * b.x
}
