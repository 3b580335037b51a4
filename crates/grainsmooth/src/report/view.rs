//! What the page's view shows.

use std::io;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD as BASE64;
use glam::DVec3;
use voronoi::Dimension;

use super::filled;
use crate::formats::surface::Surface;
use crate::page::{
    Column, PAGE_STYLE, ShownNetwork, THREE, Values, columns_of_shape, network_alone, report_scripts,
};
use crate::{Polycrystal, Scene};

/// Most triangles that are shown: browsers without a graphics card still turn them.
const MOST_TRIANGLES: usize = 120_000;

/// The grains at the finest level that is not too fine, with points of the finest of all.
pub(super) fn view(polycrystal: &Polycrystal) -> io::Result<String> {
    let network = &polycrystal.network;
    let mut levels = (0..=network.level_count()).rev().map(|level| network.level(level));
    let level = levels
        .find(|level| level.element_count() <= MOST_TRIANGLES)
        .unwrap_or_else(|| network.control_mesh().into());
    let surface = Surface::of_level(polycrystal, level)
        .ok_or_else(|| io::Error::other("lines have no surface to turn"))?;
    let triangles: Vec<[u32; 3]> = surface.triangles().collect();
    let of_parts = (0..).zip(&surface.parts);
    let boundary_of: Vec<u32> = of_parts
        .flat_map(|(number, part)| std::iter::repeat_n(number, surface.numbers_of(part).len()))
        .collect();
    let sides: Vec<[Option<u32>; 2]> =
        surface.parts.iter().map(|part| part.sides.map(|side| side.grain().map(|grain| grain.0))).collect();
    let network = ShownNetwork::new(&surface.points, &triangles, &boundary_of, &sides);
    let columns = columns(polycrystal, &network);
    Ok(embedded(&network_alone(&network, &surface.points, &columns)?))
}

/// What is known of the grains.
fn columns(polycrystal: &Polycrystal, network: &ShownNetwork) -> Vec<Column> {
    let mut columns = columns_of_shape(network, Dimension::Three);
    let grains = polycrystal.grains();
    if grains.phases.is_some() {
        let phases = grains.phase_of();
        let kinds = network.ids.iter().map(|id| u32::try_from(*phases.get(*id as usize)?).ok());
        columns.push(Column { name: "phase".to_owned(), values: Values::Kinds(kinds.collect()) });
    }
    if let Some(texture) = &grains.texture {
        for (axis, direction) in [("x", DVec3::X), ("y", DVec3::Y), ("z", DVec3::Z)] {
            let all: Vec<[u8; 3]> = texture.colors(direction).collect();
            let colors = network.ids.iter().map(|id| all[*id as usize]).collect();
            let name = format!("crystal direction along {axis}");
            columns.push(Column { name, values: Values::Colors(colors) });
        }
    }
    columns
}

/// A mesh of triangles as a network of one grain whose boundary is all there is.
pub(super) fn view_of_scene(scene: &Scene) -> io::Result<String> {
    let (triangles, _) = scene.triangles();
    let network = ShownNetwork::new(&scene.points, &triangles, &vec![0; triangles.len()], &[[Some(0), None]]);
    Ok(embedded(&network_alone(&network, &scene.points, &[])?))
}

fn embedded(network: &[u8]) -> String {
    filled(
        include_str!("../../assets/view.html"),
        &[
            ("style", PAGE_STYLE),
            ("network", &BASE64.encode(network)),
            ("three", THREE),
            ("scripts", &report_scripts()),
        ],
    )
}
