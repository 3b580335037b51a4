//! Whether nodes are tied to others whole periods away, and outer faces to other faces.

use std::collections::BTreeMap;

use glam::DVec3;

use super::Found;
use super::conforming::Faces;
use crate::VolumeFile;
use crate::volume_mesh::element_shape::corners_of_key;

/// How far a copy may be from where whole periods lead, as a share of the mesh's size: numbers in .inp have as few as fourteen digits.
const OFF_PERIOD: f64 = 1e-12;

pub(super) fn check(file: &VolumeFile, faces: &Faces, found: &mut Found) {
    if file.ties.is_empty() {
        return;
    }
    let size = size(file);
    let Some(periods) = periods(file, size) else { return };
    let mut neighbours = vec![Vec::new(); file.points.len()];
    for tie in &file.ties {
        let [copy, original] = [tie.copy, tie.original];
        let apart = file.place(copy) - file.place(original);
        let whole = DVec3::select(periods.cmpgt(DVec3::ZERO), (apart / periods).round(), DVec3::ZERO);
        let [copy_name, original_name] = [copy, original].map(|node| file.node(node));
        let off = (apart - whole * periods).abs().max_element();
        if off > OFF_PERIOD * size || whole == DVec3::ZERO {
            let message = format!(
                "node {copy_name} is tied to {original_name}, but stands no whole periods away from it"
            );
            found.push("wrong tie", message, Some(file.place(copy)));
        }
        if let Some(told) = tie.periods.filter(|told| DVec3::from_array(told.map(f64::from)) != whole) {
            let message = format!(
                "node {copy_name} is tied to {original_name} over {} {} {} periods, and stands {} {} {} away",
                told[0], told[1], told[2], whole.x, whole.y, whole.z
            );
            found.push("wrong tie", message, Some(file.place(copy)));
        }
        #[expect(clippy::cast_possible_truncation, reason = "whole and small")]
        let whole = whole.to_array().map(|count| count as i64);
        neighbours[original as usize].push((copy, whole));
        neighbours[copy as usize].push((original, whole.map(i64::wrapping_neg)));
    }
    if file.joints.is_empty() {
        check_faces(file, faces, periods, &moved(&neighbours), found);
    }
}

/// A node of those that are tied together, and the whole periods from there.
type Moved = (u32, [i64; 3]);

/// Each node as one of those that it is tied to, moved by whole periods. Gmsh ties surfaces, so that a node may be tied to several.
fn moved(neighbours: &[Vec<Moved>]) -> Vec<Moved> {
    let mut moved: Vec<Option<Moved>> = vec![None; neighbours.len()];
    for first in (0u32..).take(neighbours.len()) {
        let mut open = vec![(first, (first, [0; 3]))];
        while let Some((node, at)) = open.pop() {
            if moved[node as usize].is_some() {
                continue;
            }
            moved[node as usize] = Some(at);
            let further = |by: &[i64; 3]| [0, 1, 2].map(|axis| at.1[axis] + by[axis]);
            open.extend(neighbours[node as usize].iter().map(|(next, by)| (*next, (at.0, further(by)))));
        }
    }
    moved.into_iter().flatten().collect()
}

/// Every outer face is at a wall, or comes a second time whole periods away.
fn check_faces(file: &VolumeFile, faces: &Faces, periods: DVec3, moved: &[Moved], found: &mut Found) {
    let mut counts: BTreeMap<Vec<Moved>, Vec<[u32; 3]>> = BTreeMap::new();
    for face in faces.outer() {
        let mut key: Vec<Moved> =
            corners_of_key(&face).iter().map(|corner| moved[*corner as usize]).collect();
        key.sort_unstable();
        let (_, from) = key[0];
        let seen = key.into_iter().map(|(node, at)| (node, [0, 1, 2].map(|axis| at[axis] - from[axis])));
        counts.entry(seen.collect()).or_default().push(face);
    }
    let ends = file.bounds();
    let is_at_wall = |face: &[u32; 3]| {
        let corners = corners_of_key(face);
        (0..file.shape.axes()).filter(|axis| periods[*axis] == 0.0).any(|axis| {
            ends.iter().any(|end| corners.iter().all(|corner| file.place(*corner)[axis] == end[axis]))
        })
    };
    let lone: Vec<[u32; 3]> = counts
        .into_values()
        .filter(|same| same.len() != 2)
        .flatten()
        .filter(|face| !is_at_wall(face))
        .collect();
    if let Some(first) = lone.first() {
        let node = file.node(first[0]);
        let [_, _, face] = file.shape.words();
        let message =
            format!("{} outer {face}s are tied to no other, such as that at node {node}", lone.len());
        found.push("wrong tie", message, Some(file.place(first[0])));
    }
}

fn size(file: &VolumeFile) -> f64 {
    let points = || file.points.iter().copied();
    let (lower, upper) =
        (points().fold(DVec3::INFINITY, DVec3::min), points().fold(DVec3::NEG_INFINITY, DVec3::max));
    (upper - lower).max_element()
}

/// The least distances of tied nodes along the axes; 0 where none is tied along one.
fn periods(file: &VolumeFile, size: f64) -> Option<DVec3> {
    let apart = || file.ties.iter().map(|tie| (file.place(tie.copy) - file.place(tie.original)).abs());
    let along = |axis: usize| {
        let some = apart().map(|by| by[axis]).filter(|by| *by > OFF_PERIOD * size);
        some.fold(f64::INFINITY, f64::min)
    };
    let periods = [0, 1, 2].map(along).map(|period| if period.is_finite() { period } else { 0.0 });
    (periods != [0.0; 3]).then(|| DVec3::from_array(periods))
}
