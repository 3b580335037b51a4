//! Each element by itself: not turned inside out, of one grain; and the volumes of grains, in the plane their areas.

use std::collections::BTreeMap;

use glam::DVec3;
use polycrystal::tetrahedron_gamma;

use super::{Found, VOLUME_TOLERANCE};
use crate::VolumeFile;
use crate::volume_mesh::element_shape::ElementShape;
use crate::volume_mesh::{curved, filled_plane, volume};

/// Gamma, in the plane the shape of a triangle, below which rounding alone may turn an element inside out.
const FLAT: f64 = 1e-12;

/// The shape of an element, negative where it is turned inside out, and what it fills.
fn shape_and_volume(corners: &[DVec3]) -> (f64, f64) {
    match *corners {
        [a, b, c, d] => (tetrahedron_gamma([a, b, c, d]), volume([a, b, c, d])),
        [a, b, c] => {
            let area = area([a, b, c]);
            let longest = [b - a, c - b, a - c].into_iter().map(DVec3::length_squared).fold(0.0, f64::max);
            (if longest == 0.0 { 0.0 } else { area / longest }, area)
        }
        _ => (0.0, 0.0),
    }
}

/// The area of a triangle, negative where it goes round clockwise.
fn area([a, b, c]: [DVec3; 3]) -> f64 {
    (b - a).cross(c - a).z / 2.0
}

/// A lower bound of the Jacobian determinant of an element of second order, and its mean, as shares of what they are with straight edges.
fn jacobian_shares(corners: &[DVec3], middles: &[DVec3]) -> (f64, f64) {
    match (corners, middles) {
        (&[a, b, c, d], &[e, f, g, h, i, j]) => curved::jacobian_shares([a, b, c, d], [e, f, g, h, i, j]),
        (&[a, b, c], &[d, e, f]) => filled_plane::jacobian_shares([a, b, c], [d, e, f]),
        _ => (1.0, 1.0),
    }
}

/// Checks each element; returns the volume of each grain, by its number. An element is one of its first grain.
pub(super) fn check(file: &VolumeFile, found: &mut Found) -> BTreeMap<u32, f64> {
    let mut volumes = BTreeMap::new();
    let [one, _, _] = file.shape.words();
    let mut middles = file.middles();
    for (element, (nodes, number)) in file.elements().zip(&file.element_numbers).enumerate() {
        let corners = file.places(nodes);
        let middle = corners.iter().sum::<DVec3>() / corners.len() as f64;
        let mut report = |kind, message| {
            let fault = found.push(kind, message, Some(middle));
            fault.elements = vec![u32::try_from(*number).unwrap_or(u32::MAX)];
        };
        let middles = middles.next();
        if (0..nodes.len()).any(|k| nodes[..k].contains(&nodes[k])) {
            report("inverted", format!("{one} {number} has a node twice"));
            continue;
        }
        let (shape, straight_volume) = shape_and_volume(&corners);
        let places = middles.map(|middles| file.places(middles)).unwrap_or_default();
        let (least_share, mean_share) = jacobian_shares(&corners, &places);
        if shape <= FLAT {
            let what = if file.shape == ElementShape::Triangle { "area" } else { "volume" };
            report("inverted", format!("{one} {number} has the {what} {straight_volume:.3e}"));
        } else if least_share <= 0.0 {
            let message = format!(
                "the Jacobian determinant of {one} {number} may be {least_share:.3} of what it is with straight edges"
            );
            report("inverted", message);
        }
        let grains = &file.grains[element][..];
        if let Some(grain) = grains.first() {
            *volumes.entry(grain.0).or_default() += mean_share * straight_volume;
        }
        match grains {
            [_] => {}
            [] => report("no grain", format!("{one} {number} is part of no grain")),
            grains => {
                let names: Vec<String> = grains.iter().map(|grain| grain.0.to_string()).collect();
                report("two grains", format!("{one} {number} is part of the grains {}", names.join(" and ")));
            }
        }
    }
    check_middles(file, found);
    volumes
}

/// Elements that share an edge have one node in its middle.
fn check_middles(file: &VolumeFile, found: &mut Found) {
    let mut known: BTreeMap<[u32; 2], u32> = BTreeMap::new();
    for (corners, middles) in file.elements().zip(file.middles()) {
        for (ends, middle) in file.shape.edges().iter().zip(middles) {
            let [a, b] = ends.map(|end| corners[end]);
            let first = *known.entry([a.min(b), a.max(b)]).or_insert(*middle);
            if first != *middle {
                let [a, b, first, second] = [a, b, first, *middle].map(|node| file.node(node));
                let message = format!(
                    "the edge from node {a} to {b} has two nodes in its middle, {first} and {second}"
                );
                found.push("torn", message, Some(file.place(*middle)));
            }
        }
    }
}

/// Compares the volumes of all grains with what the file says.
pub(super) fn check_volumes(file: &VolumeFile, volumes: &BTreeMap<u32, f64>, found: &mut Found) {
    let stated = file.volumes.iter().filter(|stated| stated.len() == volumes.len()).flatten();
    for ((grain, volume), stated) in volumes.iter().zip(stated) {
        if (volume / stated - 1.0).abs() > VOLUME_TOLERANCE {
            let message = format!("grain {grain} has the volume {volume}, and should have {stated}");
            found.push("wrong volume", message, None).grains = vec![*grain];
        }
    }
}
