//! Layers of the map that a network comes from: alone, and with the boundaries of the network drawn on them.

use std::fmt::Write as _;
use std::io;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD as BASE64;
use glam::DVec3;
use polycrystal::Surface;
use voronoi::Dimension;

use crate::figures::significant::significant;
use crate::picture::color::Color;
use crate::{Coloring, MapSlice, Polycrystal};

/// Width of one of both pictures, and what is free between them, in units of the drawing.
const WIDTH: f64 = 400.0;
const GAP: f64 = 12.0;

/// Room for the title.
const TITLE: f64 = 24.0;

/// Where no grain is.
const NONE: [u8; 4] = [0; 4];

/// A figure for each layer; nothing where the network comes from no map.
pub(super) fn figures(polycrystal: &Polycrystal) -> io::Result<String> {
    let Some(map) = polycrystal.measurement().and_then(|measurement| measurement.map.as_ref()) else {
        return Ok(String::new());
    };
    let coloring = if polycrystal.grains().texture.is_some() { Coloring::IpfZ } else { Coloring::Grain };
    let colors = coloring.paint(polycrystal).grains;
    let meaning = match coloring {
        Coloring::IpfZ => "Colours: the crystal's direction along z (inverse pole figure).",
        _ => "Colours tell grains apart.",
    };
    map.slices.iter().map(|slice| figure(polycrystal, slice, &colors, meaning)).collect()
}

fn figure(
    polycrystal: &Polycrystal,
    slice: &MapSlice,
    colors: &[Color],
    meaning: &str,
) -> io::Result<String> {
    let image = BASE64.encode(&png(slice, colors)?);
    let sides = [0, 1].map(|axis| slice.size[axis] as f64 * slice.spacing[axis]);
    let scale = WIDTH / sides[0];
    let height = sides[1] * scale;
    let place =
        |[right, up]: [f64; 2]| [(right - slice.lower[0]) * scale, height - (up - slice.lower[1]) * scale];
    let mut path = String::new();
    for ends in segments(polycrystal, slice) {
        let [[x0, y0], [x1, y1]] = ends.map(place);
        let is_seen = x0.max(x1) >= 0.0 && x0.min(x1) <= WIDTH && y0.max(y1) >= 0.0 && y0.min(y1) <= height;
        if is_seen {
            write!(path, "M{x0:.1} {y0:.1}L{x1:.1} {y1:.1}").map_err(io::Error::other)?;
        }
    }
    let axis = ["x", "y", "z"][slice.across];
    let (title, layer) = match polycrystal.dimension() {
        Dimension::Two => ("Map and network".to_owned(), String::new()),
        Dimension::Three => (
            format!("Map and network across {axis}"),
            format!(", its middle layer at {axis} = {}", significant(slice.place, 4)),
        ),
    };
    let (right, bottom) = (WIDTH + GAP, TITLE + height);
    let picture = |x: f64| {
        format!(
            "<image x=\"{x}\" y=\"{TITLE}\" width=\"{WIDTH}\" height=\"{height:.1}\" preserveAspectRatio=\"none\" \
             style=\"image-rendering: pixelated\" href=\"data:image/png;base64,{image}\"/>"
        )
    };
    Ok(format!(
        "<figure class=\"wide\"><svg viewBox=\"0 0 {} {bottom:.1}\" role=\"img\" aria-label=\"{title}\">\
         <text class=\"title\" x=\"0\" y=\"16\">{title}</text>{}{}\
         <svg x=\"{right}\" y=\"{TITLE}\" width=\"{WIDTH}\" height=\"{height:.1}\"><path class=\"boundary\" d=\"{path}\"/></svg></svg>\
         <figcaption>Left the map as cleaned{layer}; right the boundaries of the network on it. {meaning}</figcaption></figure>",
        right + WIDTH,
        picture(0.0),
        picture(right),
    ))
}

/// The layer with a pixel a voxel, its upper end on top.
fn png(slice: &MapSlice, colors: &[Color]) -> io::Result<Vec<u8>> {
    let pixel = |label: &i32| match usize::try_from(*label) {
        Ok(grain) => {
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "from 0 to 255")]
            let [red, green, blue] = colors[grain].map(|channel| (255.0 * channel).round() as u8);
            [red, green, blue, u8::MAX]
        }
        Err(_) => NONE,
    };
    let pixels: Vec<u8> = slice.labels.chunks(slice.size[0]).rev().flatten().flat_map(pixel).collect();
    let [width, height] = slice.size.map(u32::try_from);
    let (width, height) = (width.map_err(io::Error::other)?, height.map_err(io::Error::other)?);
    let mut image = Vec::new();
    let mut encoder = png::Encoder::new(&mut image, width, height);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(png::BitDepth::Eight);
    let written = encoder.write_header().and_then(|mut writer| writer.write_image_data(&pixels));
    written.map_err(io::Error::other)?;
    Ok(image)
}

/// Where boundaries and their periodic copies meet a layer, in its axes.
fn segments(polycrystal: &Polycrystal, slice: &MapSlice) -> Vec<[[f64; 2]; 2]> {
    let network = &polycrystal.network;
    let level = network.finest();
    let sides = network.sides();
    let surface = Surface {
        points: &polycrystal.points,
        elements: level.elements(),
        boundary_of: level.labels(),
        sides: &sides,
    };
    let domain = network.domain();
    let mut copies = vec![DVec3::ZERO];
    for axis in (0..3).filter(|axis| domain.periodic().test(*axis)) {
        let period = domain.size()[axis] * DVec3::AXES[axis];
        copies = copies.iter().flat_map(|copy| [*copy, *copy - period, *copy + period]).collect();
    }
    let in_layer = |point: DVec3| slice.axes.map(|axis| point[axis]);
    let mut found = Vec::new();
    for element in 0..u32::try_from(surface.elements.len()).expect("elements are numbered by u32") {
        let corners = surface.elements.corners(element);
        for copy in &copies {
            let at = |corner: u32| surface.points[corner as usize] + *copy;
            match *corners {
                [from, to] => found.push([from, to].map(|corner| in_layer(at(corner)))),
                [a, b, c] => {
                    let corners = [a, b, c].map(at);
                    let above = corners.map(|corner| corner[slice.across] >= slice.place);
                    let crossing = |[from, to]: [usize; 2]| {
                        let [from, to] = [corners[from], corners[to]];
                        let share = (slice.place - from[slice.across]) / (to - from)[slice.across];
                        in_layer(from.lerp(to, share))
                    };
                    let crossed = [[0, 1], [1, 2], [2, 0]].into_iter();
                    let crossed: Vec<_> =
                        crossed.filter(|[from, to]| above[*from] != above[*to]).map(crossing).collect();
                    found.extend(<[_; 2]>::try_from(crossed).ok());
                }
                _ => {}
            }
        }
    }
    found
}
