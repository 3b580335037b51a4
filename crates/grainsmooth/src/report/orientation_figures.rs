//! Pole figures and inverse pole figures as SVG with a raster of densities within.

use std::fmt::Write;
use std::io;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD as BASE64;
use colorous::VIRIDIS;
use glam::DVec3;
use rayon::prelude::*;
use texture::{CrystalSymmetry, FiberKernel, IpfKey, Orientation, PoleFigure, Projection};

use crate::figures::direction_frame::{Frame, named_corners};

/// Halfwidth of the kernel that smooths densities, in degrees: a single grain is a spot of this size.
const HALFWIDTH: f64 = 10.0;

/// Pixels of a raster along each side; densities change over some ten of them.
const PIXELS: u32 = 120;

// The picture and the raster within it, in SVG units.
const WIDTH: f64 = 400.0;
const HEIGHT: f64 = 325.0;
const LEFT: f64 = 70.0;
const TOP: f64 = 38.0;
const SIDE: f64 = 265.0;

/// Where titles begin, as those of charts.
const TITLE: f64 = 42.0;

type Color = [u8; 3];

/// The figures of weighted orientations, with whose they are behind each title: poles of the crystal's main directions, and what the sample's axes are in the crystals.
pub(super) fn figures(
    weighted: &[(Orientation, f64)],
    symmetry: CrystalSymmetry,
    whose: &str,
) -> io::Result<String> {
    let kernel = FiberKernel::new(HALFWIDTH).map_err(io::Error::other)?;
    let (mut poles, mut inverse) = (Vec::new(), Vec::new());
    for (name, axis) in main_directions(symmetry) {
        let figure = PoleFigure::of_crystal_axis(weighted, symmetry, axis, kernel);
        poles.push((name.to_owned(), values(&Frame::WHOLE, |direction| figure.density(direction))));
    }
    let part = Frame::of_sector(symmetry);
    for (name, axis) in [("X", DVec3::X), ("Y", DVec3::Y), ("Z", DVec3::Z)] {
        let figure = PoleFigure::of_sample_axis(weighted, symmetry, axis, kernel);
        inverse.push((name.to_owned(), values(&part, |direction| figure.density(direction))));
    }
    let mut html = String::new();
    let of_sample = [("X", DVec3::X), ("Y", DVec3::Y)];
    for (name, values) in poles {
        html += &density_figure(&format!("Pole figure {name}{whose}"), &values, &Frame::WHOLE, &of_sample)?;
    }
    let corners = named_corners(symmetry);
    for (name, values) in inverse {
        html += &density_figure(&format!("Inverse pole figure {name}{whose}"), &values, &part, &corners)?;
    }
    let key = IpfKey::new(symmetry);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "from 0 to 255")]
    let colors = values(&part, |direction| key.color(direction).map(|share| (255.0 * share).round() as u8));
    let svg = svg(&format!("Colours of crystal directions{whose}"), &colors, &part, &corners)?;
    html += &format!(
        "<figure>{svg}<figcaption>Of the arrays IPFColorX, IPFColorY and IPFColorZ.</figcaption></figure>"
    );
    Ok(html)
}

/// Directions whose pole figures are usual, by name.
fn main_directions(symmetry: CrystalSymmetry) -> [(&'static str, DVec3); 3] {
    let along = |degrees: f64| {
        let (sine, cosine) = degrees.to_radians().sin_cos();
        DVec3::new(cosine, sine, 0.0)
    };
    match symmetry {
        CrystalSymmetry::Octahedral | CrystalSymmetry::Tetrahedral => {
            [("{001}", DVec3::Z), ("{011}", DVec3::new(0.0, 1.0, 1.0)), ("{111}", DVec3::ONE)]
        }
        CrystalSymmetry::Hexagonal
        | CrystalSymmetry::HexagonalLow
        | CrystalSymmetry::Trigonal
        | CrystalSymmetry::TrigonalLow => {
            [("{0001}", DVec3::Z), ("{10-10}", along(30.0)), ("{11-20}", along(60.0))]
        }
        CrystalSymmetry::Tetragonal | CrystalSymmetry::TetragonalLow => {
            [("{001}", DVec3::Z), ("{100}", DVec3::X), ("{110}", along(45.0))]
        }
        _ => [("{001}", DVec3::Z), ("{100}", DVec3::X), ("{010}", DVec3::Y)],
    }
}

/// A value at each pixel that shows a direction.
fn values<T: Send>(frame: &Frame, value: impl Fn(DVec3) -> T + Sync) -> Vec<Option<T>> {
    let place = |index: u32| (f64::from(index) + 0.5) / f64::from(PIXELS);
    let pixels = (0..PIXELS * PIXELS).into_par_iter();
    pixels.map(|pixel| frame.direction([place(pixel % PIXELS), place(pixel / PIXELS)]).map(&value)).collect()
}

/// A place of a frame in SVG units.
fn in_svg([right, down]: [f64; 2]) -> [f64; 2] {
    [LEFT + SIDE * right, TOP + SIDE * down]
}

/// A figure of densities, with what its colours mean.
fn density_figure(
    title: &str,
    values: &[Option<f64>],
    frame: &Frame,
    labels: &[(&str, DVec3)],
) -> io::Result<String> {
    let shown = || values.iter().copied().flatten();
    let (low, high) = (shown().fold(f64::INFINITY, f64::min), shown().fold(0.0, f64::max));
    let color = |value: f64| {
        let color = VIRIDIS.eval_continuous((value / high).clamp(0.0, 1.0));
        [color.r, color.g, color.b]
    };
    let colors: Vec<Option<Color>> = values.iter().map(|value| value.map(color)).collect();
    let svg = svg(title, &colors, frame, labels)?;
    let stops: Vec<String> =
        (0..=8).map(|stop| format!("#{:x}", VIRIDIS.eval_continuous(f64::from(stop) / 8.0))).collect();
    let bar = format!(
        "0 <span class=\"key bar\" style=\"background: linear-gradient(90deg, {})\"></span>{high:.2} ",
        stops.join(", ")
    );
    Ok(format!(
        "<figure>{svg}<figcaption>{bar} multiples of random, by volume, the least {low:.2}; smoothed by {HALFWIDTH} degrees, equal areas.</figcaption></figure>",
    ))
}

fn svg(title: &str, colors: &[Option<Color>], frame: &Frame, labels: &[(&str, DVec3)]) -> io::Result<String> {
    let mut pixels = Vec::with_capacity(4 * colors.len());
    for color in colors {
        let [red, green, blue] = color.unwrap_or_default();
        pixels.extend([red, green, blue, if color.is_some() { u8::MAX } else { 0 }]);
    }
    let mut image = Vec::new();
    let mut encoder = png::Encoder::new(&mut image, PIXELS, PIXELS);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(png::BitDepth::Eight);
    encoder
        .write_header()
        .and_then(|mut writer| writer.write_image_data(&pixels))
        .map_err(io::Error::other)?;
    let point = |place| {
        let [x, y] = in_svg(place);
        format!("{x:.1} {y:.1}")
    };
    let points: Vec<String> = frame.outline().into_iter().map(point).collect();
    let mut svg = format!(
        "<svg viewBox=\"0 0 {WIDTH} {HEIGHT}\" role=\"img\" aria-label=\"{title}\"><text class=\"title\" x=\"{TITLE}\" y=\"16\">{title}</text>\
         <image x=\"{LEFT}\" y=\"{TOP}\" width=\"{SIDE}\" height=\"{SIDE}\" href=\"data:image/png;base64,{}\"/>\
         <polygon class=\"rim\" points=\"{}\"/>",
        BASE64.encode(&image),
        points.join(" ")
    );
    let middle = frame.center;
    for (name, direction) in labels {
        let [x, y] = Projection::EqualArea.project(*direction);
        let [at_x, at_y] = in_svg(frame.place(*direction));
        // Beside the corner, away from the middle.
        let above = y - middle[1] > 0.5 * frame.half;
        let (anchor, shift) = match x - middle[0] {
            right if right > 0.5 * frame.half && y.abs() < 1e-9 && frame.half == 1.0 => ("start", 4.0),
            _ => ("middle", 0.0),
        };
        let down = if shift > 0.0 {
            4.0
        } else if above {
            -5.0
        } else {
            15.0
        };
        write!(
            svg,
            "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"{anchor}\">{name}</text>",
            at_x + shift,
            at_y + down
        )
        .map_err(io::Error::other)?;
    }
    Ok(svg + "</svg>")
}
