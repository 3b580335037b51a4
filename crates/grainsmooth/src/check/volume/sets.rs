//! Whether sets are complete: the nodes and faces of the sides of a box, and the faces of every boundary.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec3;
use toml::Table;

use super::Found;
use super::conforming::Faces;
use crate::VolumeFile;
use crate::names::AXES;
use crate::volume_mesh::element_shape::{corners_of_key, face_key};

pub(super) fn check(file: &VolumeFile, faces: &Faces, settings: Option<&Table>, found: &mut Found) {
    let sides = Sides::new(file);
    sides.check_nodes(file, settings, found);
    sides.check_faces(file, faces, found);
    check_boundaries(file, faces, found);
}

/// The sides of the box around the mesh: `X0` and so on, with axis and coordinate.
struct Sides(Vec<(String, usize, f64)>);

impl Sides {
    fn new(file: &VolumeFile) -> Self {
        let ends = file.bounds();
        let side =
            |axis: usize, end: usize| (format!("{}{end}", AXES[axis].to_uppercase()), axis, ends[end][axis]);
        Self((0..file.shape.axes()).flat_map(|axis| [side(axis, 0), side(axis, 1)]).collect())
    }

    /// Sets of nodes hold all nodes on their sides, edges and corners, and no others.
    fn check_nodes(&self, file: &VolumeFile, settings: Option<&Table>, found: &mut Found) {
        let has_sets = self.0.iter().any(|(name, ..)| file.node_sets.contains_key(name));
        if !has_sets {
            return;
        }
        let text = |key: &str| settings.and_then(|settings| settings.get(key)?.as_str()).unwrap_or_default();
        let is_whole = |axis: usize| text("periodic").contains(AXES[axis]) && text("periodic-cut") != "box";
        for (name, axis, coordinate) in self.0.iter().filter(|(_, axis, _)| !is_whole(*axis)) {
            let is_control = |node: &u32| file.control_nodes.contains(node);
            let nodes = (0u32..)
                .zip(&file.points)
                .filter(|(node, point)| point[*axis] == *coordinate && !is_control(node));
            let expected: BTreeSet<u32> = nodes.map(|(node, _)| node).collect();
            let set: BTreeSet<u32> = file.node_sets.get(name).into_iter().flatten().copied().collect();
            report(file, "node", name, (&expected, &set), found);
        }
        let of_sides: BTreeMap<&str, (usize, f64)> =
            self.0.iter().map(|(name, axis, coordinate)| (name.as_str(), (*axis, *coordinate))).collect();
        // `X0Y1`, `X0Y1Z0`.
        for (name, set) in &file.node_sets {
            let parts: Option<Vec<(usize, f64)>> = (name.is_ascii()
                && name.len() >= 4
                && name.len().is_multiple_of(2))
            .then(|| (0..name.len()).step_by(2).map(|at| of_sides.get(&name[at..at + 2]).copied()).collect())
            .flatten();
            let Some(parts) = parts else { continue };
            let is_there = |point: &DVec3| parts.iter().all(|(axis, coordinate)| point[*axis] == *coordinate);
            let nodes = (0u32..).zip(&file.points);
            let nodes = nodes.filter(|(node, point)| is_there(point) && !file.control_nodes.contains(node));
            let expected = nodes.map(|(node, _)| node).collect();
            report(file, "node", name, (&expected, &set.iter().copied().collect()), found);
        }
    }

    /// Sets of faces hold all outer faces on their sides, and no others.
    fn check_faces(&self, file: &VolumeFile, faces: &Faces, found: &mut Found) {
        for (name, axis, coordinate) in &self.0 {
            let Some(set) = file.surfaces.get(name) else { continue };
            let is_at = |corner: &u32| file.place(*corner)[*axis] == *coordinate;
            let is_there = |face: &[u32; 3]| corners_of_key(face).iter().all(is_at);
            let expected: BTreeSet<[u32; 3]> = faces.outer().filter(is_there).collect();
            let set: BTreeSet<[u32; 3]> = set.iter().copied().collect();
            let [_, _, what] = file.shape.words();
            report(file, what, name, (&expected, &set), found);
        }
    }
}

/// A member of a set: a node, or a face.
trait Member: Ord {
    fn node(&self) -> u32;
}

impl Member for u32 {
    fn node(&self) -> u32 {
        *self
    }
}

impl Member for [u32; 3] {
    fn node(&self) -> u32 {
        self[0]
    }
}

/// Reports what a set lacks, and what it should not have.
fn report<M: Member>(
    file: &VolumeFile,
    what: &str,
    name: &str,
    (expected, set): (&BTreeSet<M>, &BTreeSet<M>),
    found: &mut Found,
) {
    let mut differ = |more: &BTreeSet<M>, fewer: &BTreeSet<M>, how: &str| {
        let mut members = more.difference(fewer);
        let count = members.clone().count();
        let Some(first) = members.next() else { return };
        let node = first.node();
        let message =
            format!("the set {name} {how} {count} {what}s, such as that at node {}", file.node(node));
        found.push("incomplete set", message, Some(file.place(node)));
    };
    differ(expected, set, "lacks");
    differ(set, expected, "should not have");
}

/// Every face between two grains, and every outer one, is in the set of one boundary; each such set lies between the same two grains.
fn check_boundaries(file: &VolumeFile, faces: &Faces, found: &mut Found) {
    if file.surfaces.is_empty() {
        return;
    }
    let mut sets: BTreeMap<[u32; 3], &str> = BTreeMap::new();
    let [one, _, face] = file.shape.words();
    // A boundary at a side of the box may be in the set of that side instead.
    let is_boundary = |name: &str| name.starts_with("BOUNDARY_");
    for (name, set) in file.surfaces.iter().filter(|(name, _)| is_boundary(name)) {
        let mut sides = BTreeSet::new();
        for corners in set {
            let at = faces.at(*corners);
            let mut grains: Vec<_> = at.iter().map(|element| &file.grains[*element as usize]).collect();
            grains.sort_unstable();
            sides.insert(grains);
            if at.is_empty() || sets.insert(*corners, name).is_some() {
                let why = match at {
                    [] => format!("is no {face} of a {one}"),
                    _ => "is in another set too".to_owned(),
                };
                let node = file.node(corners[0]);
                let message = format!("one {face} of the set {name}, at node {node}, {why}");
                found.push("incomplete set", message, Some(file.place(corners[0])));
            }
        }
        if sides.len() > 1 {
            found.push("incomplete set", format!("the set {name} lies between several grains"), None);
        }
    }
    let of_sides: BTreeSet<[u32; 3]> = file
        .surfaces
        .iter()
        .filter(|(name, _)| !is_boundary(name))
        .flat_map(|(_, set)| set.iter().copied())
        .collect();
    let is_listed = |corners: &[u32; 3]| sets.contains_key(corners) || of_sides.contains(corners);
    // Where cohesive elements stand between grains, only the face of the first side is in a set.
    let second_sides: BTreeSet<[u32; 3]> =
        file.joints.iter().map(|joint| face_key(&joint[joint.len() / 2..])).collect();
    let outer = faces.outer().filter(|corners| !second_sides.contains(corners));
    let missing: Vec<[u32; 3]> =
        faces.between_grains(file).chain(outer).filter(|corners| !is_listed(corners)).collect();
    if let Some(first) = missing.first() {
        let node = file.node(first[0]);
        let message = format!(
            "{} {face}s between grains or at the exterior are in no set, such as that at node {node}",
            missing.len()
        );
        found.push("incomplete set", message, Some(file.place(first[0])));
    }
}
