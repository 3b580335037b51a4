//! Pole figures and inverse pole figures as SVG with a raster of densities within.

use std::fmt::Write;
use std::io;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD as BASE64;
use colorous::VIRIDIS;
use glam::DVec3;
use rayon::prelude::*;
use texture::{CrystalSymmetry, FiberKernel, IpfKey, Orientation, PoleFigure, Projection, Sector};

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

/// A part of the upper half of directions, in equal-area projection.
struct Frame<'a> {
    /// Center of the raster and half its width, in units of the projection's radius.
    center: [f64; 2],
    half: f64,
    /// Whether a direction is shown.
    holds: &'a (dyn Fn(DVec3) -> bool + Sync),
}

impl Frame<'_> {
    /// The direction at a place of the raster, from 0 to 1 to the right and down.
    fn direction(&self, [right, down]: [f64; 2]) -> Option<DVec3> {
        let point = [
            self.center[0] + self.half * (2.0 * right - 1.0),
            self.center[1] - self.half * (2.0 * down - 1.0),
        ];
        Projection::EqualArea.direction(point).filter(|direction| (self.holds)(*direction))
    }

    /// The place of a direction in SVG units.
    fn place(&self, direction: DVec3) -> [f64; 2] {
        let [x, y] = Projection::EqualArea.project(direction);
        let share = |value: f64, center: f64| 0.5 + 0.5 * (value - center) / self.half;
        [LEFT + SIDE * share(x, self.center[0]), TOP + SIDE * (1.0 - share(y, self.center[1]))]
    }

    /// A value at each pixel that shows a direction.
    fn values<T: Send>(&self, value: impl Fn(DVec3) -> T + Sync) -> Vec<Option<T>> {
        let place = |index: u32| (f64::from(index) + 0.5) / f64::from(PIXELS);
        let pixels = (0..PIXELS * PIXELS).into_par_iter();
        pixels
            .map(|pixel| self.direction([place(pixel % PIXELS), place(pixel / PIXELS)]).map(&value))
            .collect()
    }
}

/// The figures of weighted orientations, with whose they are behind each title: poles of the crystal's main directions, and what the sample's axes are in the crystals.
pub(super) fn figures(
    weighted: &[(Orientation, f64)],
    symmetry: CrystalSymmetry,
    whose: &str,
) -> io::Result<String> {
    let kernel = FiberKernel::new(HALFWIDTH).map_err(io::Error::other)?;
    let whole = Frame { center: [0.0; 2], half: 1.0, holds: &|_| true };
    let (mut poles, mut inverse) = (Vec::new(), Vec::new());
    for (name, axis) in main_directions(symmetry) {
        let figure = PoleFigure::of_crystal_axis(weighted, symmetry, axis, kernel);
        poles.push((name.to_owned(), whole.values(|direction| figure.density(direction))));
    }
    let sector = Sector::of(symmetry);
    let holds = |direction: DVec3| sector.normals().iter().all(|normal| normal.dot(direction) >= -1e-9);
    let part = frame_of_sector(sector, &holds);
    for (name, axis) in [("X", DVec3::X), ("Y", DVec3::Y), ("Z", DVec3::Z)] {
        let figure = PoleFigure::of_sample_axis(weighted, symmetry, axis, kernel);
        inverse.push((name.to_owned(), part.values(|direction| figure.density(direction))));
    }
    let mut html = String::new();
    let of_sample = [("X", DVec3::X), ("Y", DVec3::Y)];
    for (name, values) in poles {
        html += &density_figure(
            &format!("Pole figure {name}{whose}"),
            &values,
            &whole,
            &outline(&whole),
            &of_sample,
        )?;
    }
    let corners: Vec<(&str, DVec3)> = corner_names(symmetry).into_iter().zip(sector.marks()).collect();
    let around = sector_outline(&part, sector);
    for (name, values) in inverse {
        html += &density_figure(
            &format!("Inverse pole figure {name}{whose}"),
            &values,
            &part,
            &around,
            &corners,
        )?;
    }
    let key = IpfKey::new(symmetry);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "from 0 to 255")]
    let colors = part.values(|direction| key.color(direction).map(|share| (255.0 * share).round() as u8));
    let svg = svg(&format!("Colours of crystal directions{whose}"), &colors, &part, &around, &corners)?;
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

/// Names of the sector's corners, red, green and blue.
fn corner_names(symmetry: CrystalSymmetry) -> [&'static str; 3] {
    match symmetry {
        CrystalSymmetry::Octahedral | CrystalSymmetry::Tetrahedral => ["001", "101", "111"],
        CrystalSymmetry::Hexagonal => ["0001", "2-1-10", "10-10"],
        CrystalSymmetry::HexagonalLow => ["0001", "2-1-10", "11-20"],
        CrystalSymmetry::Trigonal => ["0001", "1-100", "10-10"],
        CrystalSymmetry::TrigonalLow => ["0001", "2-1-10", "-12-10"],
        CrystalSymmetry::Tetragonal => ["001", "100", "110"],
        CrystalSymmetry::TetragonalLow | CrystalSymmetry::Orthorhombic => ["001", "100", "010"],
        CrystalSymmetry::Monoclinic => ["001", "100", "-100"],
        CrystalSymmetry::Triclinic => ["", "", ""],
    }
}

/// The square around a sector.
fn frame_of_sector<'a>(sector: &Sector, holds: &'a (dyn Fn(DVec3) -> bool + Sync)) -> Frame<'a> {
    let whole = Frame { center: [0.0; 2], half: 1.0, holds };
    let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    for direction in border(&whole, sector) {
        let point = Projection::EqualArea.project(direction);
        for axis in 0..2 {
            low[axis] = low[axis].min(point[axis]);
            high[axis] = high[axis].max(point[axis]);
        }
    }
    let half = 0.5 * (high[0] - low[0]).max(high[1] - low[1]);
    Frame { center: [0, 1].map(|axis| low[axis].midpoint(high[axis])), half, holds }
}

/// Directions on the border of a sector, in order around its middle.
fn border(frame: &Frame<'_>, sector: &Sector) -> Vec<DVec3> {
    let center = sector.center();
    let first = sector.marks()[0].reject_from_normalized(center).normalize();
    let second = center.cross(first);
    let out = |degrees: i32| {
        let (sine, cosine) = f64::from(degrees).to_radians().sin_cos();
        let tangent = cosine * first + sine * second;
        let at = |arc: f64| arc.cos() * center + arc.sin() * tangent;
        // The farthest that is still inside, by halving.
        let (mut inside, mut outside) = (0.0, std::f64::consts::PI);
        for _ in 0..40 {
            let middle = 0.5 * (inside + outside);
            if (frame.holds)(at(middle)) { inside = middle } else { outside = middle }
        }
        // Halving may end a rounding below the rim, where directions stand for their opposites.
        let end = at(inside);
        end.with_z(end.z.max(0.0))
    };
    (0..360).map(out).collect()
}

/// The rim of the upper half.
fn outline(frame: &Frame<'_>) -> Vec<[f64; 2]> {
    let rim = |degrees: i32| {
        let (sine, cosine) = f64::from(degrees).to_radians().sin_cos();
        frame.place(DVec3::new(cosine, sine, 0.0))
    };
    (0..360).map(rim).collect()
}

fn sector_outline(frame: &Frame<'_>, sector: &Sector) -> Vec<[f64; 2]> {
    // Corners stand among them, which degrees seldom meet.
    let center = sector.center();
    let first = sector.marks()[0].reject_from_normalized(center).normalize();
    let second = center.cross(first);
    let angle = |direction: &DVec3| {
        direction.dot(second).atan2(direction.dot(first)).rem_euclid(std::f64::consts::TAU)
    };
    let mut around = border(frame, sector);
    around.extend(sector.marks());
    around.sort_by(|a, b| angle(a).total_cmp(&angle(b)));
    around.into_iter().map(|direction| frame.place(direction)).collect()
}

/// A figure of densities, with what its colours mean.
fn density_figure(
    title: &str,
    values: &[Option<f64>],
    frame: &Frame<'_>,
    outline: &[[f64; 2]],
    labels: &[(&str, DVec3)],
) -> io::Result<String> {
    let shown = || values.iter().copied().flatten();
    let (low, high) = (shown().fold(f64::INFINITY, f64::min), shown().fold(0.0, f64::max));
    let color = |value: f64| {
        let color = VIRIDIS.eval_continuous((value / high).clamp(0.0, 1.0));
        [color.r, color.g, color.b]
    };
    let colors: Vec<Option<Color>> = values.iter().map(|value| value.map(color)).collect();
    let svg = svg(title, &colors, frame, outline, labels)?;
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

fn svg(
    title: &str,
    colors: &[Option<Color>],
    frame: &Frame<'_>,
    outline: &[[f64; 2]],
    labels: &[(&str, DVec3)],
) -> io::Result<String> {
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
    let points: Vec<String> = outline.iter().map(|[x, y]| format!("{x:.1} {y:.1}")).collect();
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
        let [at_x, at_y] = frame.place(*direction);
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
