//! What the page's view shows.

use std::collections::BTreeMap;
use std::io;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD as BASE64;
use glam::DVec3;
use serde::Serialize;

use crate::formats::surface::{Surface, label};
use crate::picture::FRONT;
use crate::{Coloring, Polycrystal, Scene};

/// Most triangles that are shown, both sides of each counted once: browsers without a graphics card still turn them.
const MOST_TRIANGLES: usize = 120_000;

/// A network in units of the domain's longest side, its middle at the origin.
#[derive(Serialize)]
struct Network {
    /// Points as whole steps from the low corner: 16-bit numbers, three a point, little-endian in base 64.
    points: String,
    low: [f64; 3],
    step: [f64; 3],
    /// Points of the triangles, boundary after boundary: 32-bit numbers, little-endian in base 64.
    triangles: String,
    parts: Vec<Part>,
    /// Where grains move when they move apart.
    shifts: Vec<[f32; 3]>,
    /// Of each way of colouring, red, green and blue of each grain, from 0 to 1.
    colors: BTreeMap<&'static str, Vec<[f32; 3]>>,
}

/// The triangles of one boundary.
#[derive(Serialize)]
struct Part {
    count: usize,
    sides: [i64; 2],
}

/// The ways of colouring grains that a view offers.
fn colorings(polycrystal: &Polycrystal) -> impl Iterator<Item = Coloring> {
    Coloring::ALL.into_iter().filter(|way| way.colors_grains_of(polycrystal))
}

/// What the view's list of colours offers.
pub(super) fn options(polycrystal: &Polycrystal) -> String {
    let option = |way: Coloring| format!("<option value=\"{}\">by {}</option>", way.name(), way.words());
    colorings(polycrystal).map(option).collect()
}

/// The network of the finest level that is not too fine, with points of the finest of all.
pub(super) fn network_json(polycrystal: &Polycrystal) -> io::Result<String> {
    let levels = polycrystal.network.levels();
    let level =
        levels.iter().rev().find(|level| level.element_count() <= MOST_TRIANGLES).unwrap_or(&levels[0]);
    let surface = Surface::of_level(polycrystal, level)
        .ok_or_else(|| io::Error::other("lines have no surface to turn"))?;
    let domain = polycrystal.network.domain();
    let middle = domain.lower().midpoint(domain.upper());
    let unit = domain.size().max_element();
    let place = |point: DVec3| (point - middle) / unit;
    let placed = || surface.points.iter().map(|point| place(*point));
    let low = placed().reduce(DVec3::min).unwrap_or_default();
    let high = placed().reduce(DVec3::max).unwrap_or_default();
    let Packed { points, low, step } = Packed::between([low, high], place, &surface.points);
    let triangles: Vec<u8> = surface.triangles().flatten().flat_map(u32::to_le_bytes).collect();
    let part = |part: &crate::formats::surface::Part| Part {
        count: surface.triangles_of(part).count(),
        sides: part.sides.map(label),
    };
    let colors =
        |way: Coloring| (way.name(), way.paint(polycrystal).grains.into_iter().map(single).collect());
    let network = Network {
        points,
        low,
        step,
        triangles: BASE64.encode(triangles),
        parts: surface.parts.iter().map(part).collect(),
        shifts: polycrystal.shifts(1.0 / unit).into_iter().map(|shift| single(shift.to_array())).collect(),
        colors: colorings(polycrystal).map(colors).collect(),
    };
    Ok(serde_json::to_string(&network)?)
}

/// A mesh of triangles with both its sides, as a network of one grain whose boundary is all there is.
pub(super) fn scene_json(scene: &Scene) -> io::Result<String> {
    let (triangles, _) = scene.triangles();
    let Packed { points, low, step } = Packed::new(&scene.points);
    let count = triangles.len();
    let triangles: Vec<u8> = triangles.into_iter().flatten().flat_map(u32::to_le_bytes).collect();
    let network = Network {
        points,
        low,
        step,
        triangles: BASE64.encode(triangles),
        parts: vec![Part { count, sides: [0, 0] }],
        shifts: vec![[0.0; 3]],
        colors: BTreeMap::from([("surface", vec![single(FRONT)])]),
    };
    Ok(serde_json::to_string(&network)?)
}

/// Points in units of their longest side, their middle at the origin, as whole steps from their low corner.
struct Packed {
    points: String,
    low: [f64; 3],
    step: [f64; 3],
}

impl Packed {
    fn new(points: &[DVec3]) -> Self {
        let least = points.iter().copied().reduce(DVec3::min).unwrap_or_default();
        let most = points.iter().copied().reduce(DVec3::max).unwrap_or_default();
        let unit = Some((most - least).max_element()).filter(|unit| *unit > 0.0).unwrap_or(1.0);
        let middle = least.midpoint(most);
        Self::between(
            [least, most].map(|corner| (corner - middle) / unit),
            |point| (point - middle) / unit,
            points,
        )
    }

    /// Points that `place` puts between two corners.
    fn between([low, high]: [DVec3; 2], place: impl Fn(DVec3) -> DVec3, points: &[DVec3]) -> Self {
        // A flat side has no step.
        let step = ((high - low) / f64::from(u16::MAX)).max(DVec3::splat(f64::MIN_POSITIVE));
        let steps = points.iter().flat_map(|point| ((place(*point) - low) / step).round().to_array());
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "from 0 to 65535 without a remainder"
        )]
        let points: Vec<u8> = steps.flat_map(|steps| (steps as u16).to_le_bytes()).collect();
        Self { points: BASE64.encode(points), low: low.to_array(), step: step.to_array() }
    }
}

/// Screens need no more digits than single precision has.
#[allow(clippy::cast_possible_truncation)]
fn single(numbers: [f64; 3]) -> [f32; 3] {
    numbers.map(|number| number as f32)
}
