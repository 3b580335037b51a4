//! Each tetrahedron by itself: not turned inside out, of one grain; and the volumes of grains.

use std::array;
use std::collections::BTreeMap;

use glam::DVec3;

use super::{Found, VOLUME_TOLERANCE};
use crate::VolumeFile;
use crate::volume_mesh::curved::least_jacobian_share;
use crate::volume_mesh::element_shape::EDGES;
use crate::volume_mesh::{VolumeMesh, gamma, volume};

/// Gamma below which rounding alone may turn an element inside out.
const FLAT: f64 = 1e-12;

pub(super) fn check(file: &VolumeFile, found: &mut Found) {
    for (element, (nodes, number)) in file.tetrahedra.iter().zip(&file.element_numbers).enumerate() {
        let corners = file.corners(element);
        let middle = corners.iter().sum::<DVec3>() / 4.0;
        let mut report = |kind, message| {
            let fault = found.push(kind, message, Some(middle));
            fault.elements = vec![u32::try_from(*number).unwrap_or(u32::MAX)];
        };
        if (0..4).any(|k| nodes[..k].contains(&nodes[k])) {
            report("inverted", format!("tetrahedron {number} has a node twice"));
            continue;
        }
        if gamma(corners) <= FLAT {
            report("inverted", format!("tetrahedron {number} has the volume {:.3e}", volume(corners)));
        } else if let Some(middles) = file.middles.get(element) {
            let share = least_jacobian_share(corners, array::from_fn(|edge| file.place(middles[edge])));
            if share <= 0.0 {
                let message = format!(
                    "the Jacobian determinant of tetrahedron {number} may be {share:.3} of what it is with straight edges"
                );
                report("inverted", message);
            }
        }
        match &file.grains[element][..] {
            [_] => {}
            [] => report("no grain", format!("tetrahedron {number} is part of no grain")),
            grains => {
                let names: Vec<String> = grains.iter().map(|grain| grain.0.to_string()).collect();
                report(
                    "two grains",
                    format!("tetrahedron {number} is part of the grains {}", names.join(" and ")),
                );
            }
        }
    }
    check_middles(file, found);
}

/// Tetrahedra that share an edge have one node in its middle.
fn check_middles(file: &VolumeFile, found: &mut Found) {
    let mut known: BTreeMap<[u32; 2], u32> = BTreeMap::new();
    for (corners, middles) in file.tetrahedra.iter().zip(&file.middles) {
        for (ends, middle) in EDGES.into_iter().zip(middles) {
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

/// Volumes of all grains, compared with what the file says.
pub(super) fn check_volumes(file: &VolumeFile, mesh: &VolumeMesh, found: &mut Found) -> Vec<(u32, f64)> {
    let mut volumes: BTreeMap<u32, f64> = BTreeMap::new();
    for (element, grain) in mesh.grains.iter().enumerate() {
        *volumes.entry(grain.0).or_default() += volume(mesh.corners(element));
    }
    let stated = file.volumes.iter().filter(|stated| stated.len() == volumes.len()).flatten();
    // With straight edges alone: what bends adds to volumes.
    for ((grain, volume), stated) in volumes.iter().zip(stated).filter(|_| file.middles.is_empty()) {
        if (volume / stated - 1.0).abs() > VOLUME_TOLERANCE {
            let message = format!("grain {grain} has the volume {volume}, and should have {stated}");
            found.push("wrong volume", message, None).grains = vec![*grain];
        }
    }
    volumes.into_iter().collect()
}
