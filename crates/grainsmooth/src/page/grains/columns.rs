//! What the page knows of each grain, and can colour it by.

use glam::DVec3;
use serde::Serialize;
use texture::{CrystalSymmetry, IpfKey};
use voronoi::Dimension;

use super::shown::{GrainFacts, ShownNetwork};
use crate::LabelledFile;
use crate::vtk::DataArray;

/// A fact of each grain.
#[derive(Debug, Serialize)]
pub(crate) struct Column {
    pub(crate) name: String,
    pub(crate) values: Values,
}

/// The numbers of a [`Column`], in the order of the network's grains.
#[derive(Debug, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Values {
    /// Any numbers; nothing where a grain has none.
    Numbers(Vec<Option<f64>>),
    /// Kinds, to be told apart.
    Kinds(Vec<Option<u32>>),
    /// Red, green and blue from 0 to 255.
    Colors(Vec<[u8; 3]>),
}

/// What follows from the grains' surfaces, in the plane from their lines.
pub(crate) fn columns_of_shape(network: &ShownNetwork, dimension: Dimension) -> Vec<Column> {
    let column = |name: &str, value: fn(&GrainFacts) -> f64| {
        let numbers = network.facts.iter().map(|facts| Some(value(facts)));
        Column { name: name.to_owned(), values: Values::Numbers(numbers.collect()) }
    };
    let neighbors = |facts: &GrainFacts| facts.neighbors as f64;
    match dimension {
        Dimension::Three => vec![
            column("volume", |facts| facts.volume),
            column("neighbors", neighbors),
            column("surface area", |facts| facts.area),
            column("equivalent diameter", |facts| Dimension::Three.ball_diameter(facts.volume)),
        ],
        Dimension::Two => vec![
            column("area", |facts| facts.volume),
            column("neighbors", neighbors),
            column("perimeter", |facts| facts.area),
            column("equivalent diameter", |facts| Dimension::Two.ball_diameter(facts.volume)),
        ],
    }
}

/// All that a file tells of its grains.
pub(super) fn columns(file: &LabelledFile, network: &ShownNetwork) -> Vec<Column> {
    let mut columns = columns_of_shape(network, file.surface().elements.dimension());
    if let Some(phases) = &file.phases {
        let found = |id: &u32| phases.binary_search_by_key(id, |(grain, _)| grain.0).ok();
        let phase = |id: &u32| found(id).map(|place| phases[place].1);
        let kinds = network.ids.iter().map(phase).collect();
        columns.push(Column { name: "phase".to_owned(), values: Values::Kinds(kinds) });
    }
    if let Some(orientations) = &file.orientations {
        let text = file.settings.as_ref().and_then(|settings| settings.get("crystal-symmetry")?.as_str());
        let symmetry: CrystalSymmetry = text.and_then(|name| name.parse().ok()).unwrap_or_default();
        let key = IpfKey::new(symmetry);
        for (axis, direction) in [("x", DVec3::X), ("y", DVec3::Y), ("z", DVec3::Z)] {
            let of_grain = |id: &u32| {
                let found = orientations.binary_search_by_key(id, |(grain, _)| grain.0).ok();
                // Grains without an orientation are white.
                found.map_or([255; 3], |place| key.color_of(orientations[place].1, direction))
            };
            let colors = network.ids.iter().map(of_grain).collect();
            let name = format!("crystal direction along {axis} ({symmetry})");
            columns.push(Column { name, values: Values::Colors(colors) });
        }
    }
    columns
}

/// The names of the components of an array.
pub(super) fn components(array: &DataArray) -> Vec<String> {
    let part = |part: usize| match array.components {
        1 => array.name.clone(),
        3 => format!("{} {}", array.name, ["x", "y", "z"][part]),
        _ => format!("{} {part}", array.name),
    };
    (0..array.components).map(part).collect()
}
