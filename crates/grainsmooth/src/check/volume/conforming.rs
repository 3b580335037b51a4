//! Whether elements fit together: face to face, in the plane edge to edge, and node to node.

use std::collections::{BTreeMap, BTreeSet};

use super::Found;
use crate::VolumeFile;
use crate::volume_mesh::element_shape::{ElementShape, corners_of_key, face_key};

/// The faces of all elements, by their keys, with the elements on both sides.
pub(super) struct Faces {
    by_corners: BTreeMap<[u32; 3], Vec<u32>>,
}

impl Faces {
    pub(super) fn new(file: &VolumeFile) -> Self {
        let mut by_corners: BTreeMap<[u32; 3], Vec<u32>> = BTreeMap::new();
        for (element, corners) in (0u32..).zip(file.elements()) {
            for face in file.faces(corners) {
                by_corners.entry(face_key(&face)).or_default().push(element);
            }
        }
        Self { by_corners }
    }

    /// The elements at a face.
    pub(super) fn at(&self, face: [u32; 3]) -> &[u32] {
        self.by_corners.get(&face).map_or(&[], Vec::as_slice)
    }

    /// The faces of a single element.
    pub(super) fn outer(&self) -> impl Iterator<Item = [u32; 3]> {
        self.by_corners.iter().filter(|(_, at)| at.len() == 1).map(|(corners, _)| *corners)
    }

    /// The faces between elements of different grains.
    pub(super) fn between_grains<'a>(&'a self, file: &'a VolumeFile) -> impl Iterator<Item = [u32; 3]> + 'a {
        let differ = |at: &[u32]| match at {
            [a, b] => file.grains[*a as usize] != file.grains[*b as usize],
            _ => false,
        };
        self.by_corners.iter().filter(move |(_, at)| differ(at)).map(|(corners, _)| *corners)
    }
}

pub(super) fn check(file: &VolumeFile, faces: &Faces, found: &mut Found) {
    let [_, elements, face] = file.shape.words();
    for (corners, at) in faces.by_corners.iter().filter(|(_, at)| at.len() > 2) {
        let names: Vec<String> =
            at.iter().map(|element| file.element_numbers[*element as usize].to_string()).collect();
        let message = format!("{elements} {} share one {face}", names.join(", "));
        found.push("torn", message, Some(file.place(corners[0])));
    }
    check_nodes(file, found);
    check_joints(file, found);
    check_closed_by_joints(file, faces, found);
}

/// All nodes are used, and no two in one place but those that cohesive elements join.
fn check_nodes(file: &VolumeFile, found: &mut Found) {
    let mut is_used = vec![false; file.points.len()];
    let of_elements = file.elements().chain(file.middles()).flatten();
    let all = of_elements.chain(file.joints.iter().flatten()).chain(&file.control_nodes);
    all.for_each(|node| is_used[*node as usize] = true);
    for node in (0u32..).zip(is_used).filter(|(_, is_used)| !is_used).map(|(node, _)| node) {
        let message = format!("node {} is part of no element", file.node(node));
        found.push("unused node", message, Some(file.place(node)));
    }
    if !file.joints.is_empty() {
        return;
    }
    let is_control = |node: &u32| file.control_nodes.contains(node);
    let mut places: Vec<([u64; 3], u32)> = (0u32..)
        .zip(&file.points)
        .filter(|(node, _)| !is_control(node))
        .map(|(node, place)| (place.to_array().map(|coordinate| (coordinate + 0.0).to_bits()), node))
        .collect();
    places.sort_unstable();
    for same in places.chunk_by(|a, b| a.0 == b.0).filter(|same| same.len() > 1) {
        let names: Vec<String> = same.iter().map(|(_, node)| file.node(*node).to_string()).collect();
        let message =
            format!("nodes {} are in one place, where elements do not hang together", names.join(", "));
        found.push("torn", message, Some(file.place(same[0].1)));
    }
}

/// The two sides of a cohesive element lie on each other.
fn check_joints(file: &VolumeFile, found: &mut Found) {
    for joint in &file.joints {
        let (first, second) = joint.split_at(joint.len() / 2);
        let mut second = second.to_vec();
        if file.shape == ElementShape::Triangle {
            second.reverse();
        }
        for (one, other) in first.iter().zip(second) {
            if file.place(*one) != file.place(other) {
                let place = file.place(*one);
                let [one, other] = [*one, other].map(|node| file.node(node));
                let message =
                    format!("a cohesive element joins the nodes {one} and {other}, which are apart");
                found.push("torn", message, Some(place));
            }
        }
    }
}

/// Where grains have nodes of their own, cohesive elements close what is between them: each has an element on either side, unless the nodes there stand in for others whole periods away; and
/// no two faces lie on each other without one.
fn check_closed_by_joints(file: &VolumeFile, faces: &Faces, found: &mut Found) {
    if file.joints.is_empty() {
        return;
    }
    let is_tied: BTreeSet<u32> = file.ties.iter().map(|tie| tie.copy).collect();
    let mut joined: BTreeSet<[[u32; 3]; 2]> = BTreeSet::new();
    let [one, _, face] = file.shape.words();
    for joint in &file.joints {
        let (first, second) = joint.split_at(joint.len() / 2);
        for side in [first, second] {
            let stands_in = side.iter().all(|node| is_tied.contains(node));
            if faces.at(face_key(side)).len() != 1 && !stands_in {
                let node = file.node(side[0]);
                let message =
                    format!("a side of a cohesive element, at node {node}, is no outer {face} of a {one}");
                found.push("torn", message, Some(file.place(side[0])));
            }
        }
        let mut sides = [first, second].map(face_key);
        sides.sort_unstable();
        joined.insert(sides);
    }
    let bits = |node: u32| file.place(node).to_array().map(|coordinate| (coordinate + 0.0).to_bits());
    let mut at_places: BTreeMap<Vec<[u64; 3]>, Vec<[u32; 3]>> = BTreeMap::new();
    for key in faces.outer() {
        let mut places: Vec<[u64; 3]> = corners_of_key(&key).iter().map(|corner| bits(*corner)).collect();
        places.sort_unstable();
        at_places.entry(places).or_default().push(key);
    }
    for same in at_places.values().filter(|same| same.len() > 1) {
        let mut pair = [same[0], same[1]];
        pair.sort_unstable();
        if same.len() > 2 || !joined.contains(&pair) {
            let nodes = same.iter().map(|corners| file.node(corners[0]).to_string());
            let message = format!(
                "{face}s at nodes {} lie on each other, and no cohesive element joins them",
                nodes.collect::<Vec<_>>().join(", ")
            );
            found.push("torn", message, Some(file.place(same[0][0])));
        }
    }
}
