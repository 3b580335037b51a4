//! Triangles and lines with a depth buffer, in bands of rows that are drawn in parallel.

use std::f64::consts::TAU;
use std::num::NonZeroU16;

use glam::DVec3;
use rayon::prelude::*;
use tiny_skia::Pixmap;

use super::camera::Camera;
use super::color::Color;
use super::coloring::Paint;
use super::patch::Patch;
use super::{Picture, Slice};

/// Samples along each side of a pixel: nine shades smooth an edge.
const SAMPLES: usize = 3;

/// Rows of pixels that are drawn together: enough that few triangles fall into two bands, and bands for all threads.
const BAND: usize = 32;

/// What lines are drawn in: nearly black.
pub(super) const LINE: Color = [0.1; 3];

/// Sides of a disc, which is a polygon: a circle at the size of points.
const DISC_SIDES: u32 = 16;

/// Width of the edges of elements, in widths of other lines.
pub(super) const ELEMENT_EDGE: f64 = 0.35;

/// How much nearer than the far side of a wall its near side counts, in samples: both have the same place but for rounding.
const NEAR_SIDE: f64 = 1e-3;

/// Draws patches in the colours of their grains or boundaries, as large as the picture allows.
pub(super) fn draw(patches: &[Patch], paint: &Paint, picture: &Picture, pixmap: &mut Pixmap) {
    let [width, height] = picture.size.map(|side| usize::from(side.get()));
    let camera = Camera::new(patches, [width, height].map(|side| (side * SAMPLES) as f64));
    let cut = picture.slice.map(|slice| Cut::new(slice, &camera));
    let shown: Vec<Shown> =
        patches.par_iter().map(|patch| Shown::new(patch, &camera, cut.as_ref())).collect();
    let half_width = picture.line_width() * SAMPLES as f64 / 2.0;
    draw_bands(width, pixmap, |band| {
        let seen = || patches.iter().zip(&shown).filter(|(_, shown)| shown.rows[0] <= shown.rows[1]);
        let meeting: Vec<_> = seen().filter(|(_, shown)| band.meets(shown.rows, half_width)).collect();
        for (patch, shown) in &meeting {
            let color = match &paint.boundaries {
                Some(boundaries) => boundaries[patch.boundary],
                None => paint.grains[patch.grain],
            };
            band.draw_patch(patch, shown, color);
            if let Some(cut) = &cut {
                let inside = paint.grains[patch.grain].map(|channel| channel * cut.brightness);
                band.draw_inside(patch, shown, inside);
            }
        }
        if let Some(cut) = &cut {
            band.close(cut);
        }
        for (patch, shown) in &meeting {
            band.draw_rim(patch, shown, half_width);
        }
    });
}

/// A plane that cuts what is drawn, as the camera sees it.
struct Cut {
    slice: Slice,
    /// 1 or -1: what is beyond the plane in this direction of its axis, toward the viewer, is left out.
    sign: f64,
    /// How near the plane is at the upper left sample, and by how much nearer one to the right and one below.
    nearness: [f64; 3],
    /// Of what lies in the plane.
    brightness: f64,
}

impl Cut {
    fn new(slice: Slice, camera: &Camera) -> Self {
        let sign = camera.toward[slice.axis].signum();
        let mut normal = DVec3::ZERO;
        normal[slice.axis] = sign;
        // Three points of the plane tell how its depth changes over the picture.
        let mut point = DVec3::ZERO;
        point[slice.axis] = slice.at;
        let [one, two] = [(slice.axis + 1) % 3, (slice.axis + 2) % 3].map(|axis| DVec3::AXES[axis]);
        let places = [point, point + one, point + two].map(|point| camera.project(point));
        let (first, second) = (places[1] - places[0], places[2] - places[0]);
        let area = cross(first, second);
        let right = (first.z * second.y - second.z * first.y) / area;
        let down = (first.x * second.z - second.x * first.z) / area;
        let corner = places[0].z - right * places[0].x - down * places[0].y;
        Self { slice, sign, nearness: [corner, right, down], brightness: camera.brightness(normal) }
    }

    /// How far beyond the plane a point is.
    fn beyond(&self, point: DVec3) -> f64 {
        self.sign * (point[self.slice.axis] - self.slice.at)
    }
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
    /// How far beyond a plane each point is, if one cuts; what is beyond is not drawn.
    beyond: Option<Vec<f64>>,
    /// First and last row of samples; none where all is beyond.
    rows: [f64; 2],
}

impl Shown {
    fn new(patch: &Patch, camera: &Camera, cut: Option<&Cut>) -> Self {
        let places: Vec<DVec3> = patch.points.iter().map(|point| camera.project(*point)).collect();
        let brightness = patch.normals.iter().map(|normal| camera.brightness(*normal)).collect();
        let beyond: Option<Vec<f64>> =
            cut.map(|cut| patch.points.iter().map(|point| cut.beyond(*point)).collect());
        let mut rows = places.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], place| {
            [low.min(place.y), high.max(place.y)]
        });
        if beyond.as_ref().is_some_and(|beyond| beyond.iter().all(|distance| *distance > 0.0)) {
            rows = [f64::INFINITY, f64::NEG_INFINITY];
        }
        Self { places, brightness, beyond, rows }
    }

    /// How far beyond the plane some points are.
    fn beyond<const N: usize>(&self, points: [u32; N]) -> Option<[f64; N]> {
        self.beyond.as_ref().map(|beyond| points.map(|point| beyond[point as usize]))
    }
}

/// Some rows of samples.
struct Band {
    first_row: usize,
    row_count: usize,
    width: usize,
    /// How near what was drawn is; minus infinity where nothing was.
    nearness: Vec<f64>,
    /// Whether what was drawn is the inside of a grain.
    is_inside: Vec<bool>,
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
            is_inside: vec![false; count],
            colors: vec![[1.0; 3]; count],
        }
    }

    fn meets(&self, [first, last]: [f64; 2], margin: f64) -> bool {
        last + margin >= self.first_row as f64 && first - margin <= (self.first_row + self.row_count) as f64
    }

    fn draw_patch(&mut self, patch: &Patch, shown: &Shown, color: Color) {
        for triangle in &patch.triangles {
            let corners = triangle.map(|point| shown.places[point as usize]);
            let brightness = triangle.map(|point| shown.brightness[point as usize]);
            self.draw_cut_triangle((corners, shown.beyond(*triangle)), false, |weights| {
                let shade: f64 = (0..3).map(|corner| weights[corner] * brightness[corner]).sum();
                color.map(|channel| channel * shade)
            });
        }
    }

    /// Draws a patch where it faces away: there one looks into its grain, which the plane has cut.
    fn draw_inside(&mut self, patch: &Patch, shown: &Shown, color: Color) {
        for [a, b, c] in &patch.triangles {
            let corners = [*a, *c, *b].map(|point| shown.places[point as usize] + NEAR_SIDE * DVec3::Z);
            self.draw_cut_triangle((corners, shown.beyond([*a, *c, *b])), true, |_| color);
        }
    }

    /// Puts what was seen inside grains into the plane that cuts them.
    fn close(&mut self, Cut { nearness: [corner, right, down], .. }: &Cut) {
        for at in (0..self.nearness.len()).filter(|at| self.is_inside[*at]) {
            let (row, column) = (self.first_row + at / self.width, at % self.width);
            self.nearness[at] = corner + right * (column as f64 + 0.5) + down * (row as f64 + 0.5);
        }
    }

    /// Draws the edges of a patch's elements, those at its rim, and where the plane cuts it.
    fn draw_rim(&mut self, patch: &Patch, shown: &Shown, half_width: f64) {
        for (edges, width) in [(&patch.element_edges, ELEMENT_EDGE * half_width), (&patch.rim, half_width)] {
            for edge in edges {
                let ends = edge.map(|point| shown.places[point as usize]);
                self.draw_cut_line((ends, shown.beyond(*edge)), width, LINE);
            }
        }
        for triangle in &patch.triangles {
            let Some(beyond) = shown.beyond(*triangle) else { return };
            let place = |corner: usize| shown.places[triangle[corner] as usize];
            let sides = [[0, 1], [1, 2], [2, 0]].into_iter();
            let crossed = sides.filter(|[from, to]| (beyond[*from] > 0.0) != (beyond[*to] > 0.0));
            let ends: Vec<DVec3> = crossed
                .map(|[from, to]| place(from).lerp(place(to), beyond[from] / (beyond[from] - beyond[to])))
                .collect();
            if let [start, end] = ends[..] {
                self.draw_line([start, end], half_width, LINE);
            }
        }
    }

    /// A line, as two triangles that face the viewer, a little nearer than it is lest its own surface hides it.
    fn draw_line(&mut self, ends: [DVec3; 2], half_width: f64, color: Color) {
        self.draw_cut_line((ends, None), half_width, color);
    }

    /// The same, as far as its ends say that it is not beyond a plane.
    fn draw_cut_line(
        &mut self,
        (ends, beyond): ([DVec3; 2], Option<[f64; 2]>),
        half_width: f64,
        color: Color,
    ) {
        let along = (ends[1] - ends[0]).with_z(0.0).normalize_or_zero() * half_width;
        let across = DVec3::new(along.y, -along.x, 0.0);
        // A surface that rises by twice the line's width over that width, which is steep, still shows the line.
        let nearer = DVec3::Z * (4.0 * half_width);
        let [start, end] = [ends[0] - along + nearer, ends[1] + along + nearer];
        let [a, b, c, d] = [start + across, start - across, end - across, end + across];
        let at_ends = |ends: [usize; 3]| beyond.map(|beyond| ends.map(|end| beyond[end]));
        for (corners, ends) in [([a, b, c], [0, 0, 1]), ([a, c, d], [0, 1, 1])] {
            self.draw_cut_triangle((corners, at_ends(ends)), false, |_| color);
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
    fn draw_triangle(&mut self, corners: [DVec3; 3], color: impl Fn([f64; 3]) -> Color) {
        self.draw_cut_triangle((corners, None), false, color);
    }

    /// The same, as far as its corners say that it is not beyond a plane, from outside or from inside a grain.
    fn draw_cut_triangle(
        &mut self,
        ([a, b, c], beyond): ([DVec3; 3], Option<[f64; 3]>),
        is_inside: bool,
        color: impl Fn([f64; 3]) -> Color,
    ) {
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
                let mean = |[a, b, c]: [f64; 3]| weights[0] * a + weights[1] * b + weights[2] * c;
                if beyond.is_some_and(|beyond| mean(beyond) > 0.0) {
                    continue;
                }
                let nearness = mean([a.z, b.z, c.z]);
                let at = row * self.width + column;
                if nearness > self.nearness[at] {
                    self.nearness[at] = nearness;
                    self.is_inside[at] = is_inside;
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

    /// The means over pixels, as red, green, blue and opacity. What is behind stays as far as nothing was drawn before it.
    fn into_pixels(self, pixels: &mut [u8]) {
        let pixels_a_row = self.width / SAMPLES;
        let count = (SAMPLES * SAMPLES) as f64;
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "from 0 to 255 without a remainder"
        )]
        let byte = |share: f64| (255.0 * share).round() as u8;
        for (number, pixel) in pixels.chunks_exact_mut(4).enumerate() {
            let (row, column) = (number / pixels_a_row * SAMPLES, number % pixels_a_row * SAMPLES);
            let rows = (row..row + SAMPLES).map(|row| row * self.width + column);
            let samples = rows.flat_map(|start| start..start + SAMPLES);
            let drawn = samples.filter(|at| self.nearness[*at] > f64::NEG_INFINITY);
            let (mut sum, mut covered) = ([0.0; 3], 0.0);
            for at in drawn {
                sum = [0, 1, 2].map(|channel| sum[channel] + self.colors[at][channel]);
                covered += 1.0;
            }
            let open = 1.0 - covered / count;
            for (channel, sum) in sum.into_iter().chain([covered]).enumerate() {
                pixel[channel] = byte(sum / count + open * f64::from(pixel[channel]) / 255.0);
            }
        }
    }
}

/// The third component of the cross product.
fn cross(a: DVec3, b: DVec3) -> f64 {
    a.x * b.y - a.y * b.x
}
