//! Grains with nodes of their own, and elements of zero thickness between them, which hold them together until they part.

use std::collections::BTreeMap;

use glam::DVec3;
use polycrystal::{BoundaryId, Corners, GrainId, Network, Side};
use voronoi::{PeriodicPair, Translation};

use super::element_nodes::ElementNodes;
use super::element_shape::boundary_elements;

/// Elements whose grains share no nodes, and cohesive elements on all boundaries between grains.
#[derive(Debug)]
pub(crate) struct CohesiveMesh<'a> {
    /// The elements by the same numbers. Of the nodes at a point of a boundary, that of the smallest grain has the number of the point; the others follow behind all points.
    pub(crate) elements: ElementNodes<'a>,
    /// Elements between grains, boundary by boundary.
    pub(crate) joints: Vec<Joint>,
    /// Nodes that move as others, whole periods away: no node is both.
    pub(crate) ties: Vec<PeriodicPair<u32>>,
}

/// An element of zero thickness between two grains: a prism, in the plane a quadrilateral.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Joint {
    /// In space a triangle of the grain with the smaller number, whose normal points to the other grain, and that of the other grain, in the same order. In the plane a segment of the
    /// first, with the other grain on its left, and back along that of the other.
    pub(crate) nodes: Vec<u32>,
    /// The boundary; of two that are one, a period apart, the original.
    pub(crate) boundary: BoundaryId,
}

/// The nodes of grains at the points of a network.
struct Nodes {
    points: Vec<DVec3>,
    /// Of all elements, one after the other.
    of_elements: Vec<u32>,
    of: BTreeMap<(u32, GrainId), u32>,
}

impl Nodes {
    fn new(elements: &ElementNodes<'_>) -> Self {
        let mut of: BTreeMap<(u32, GrainId), u32> = BTreeMap::new();
        let is_at_boundary = |corner: &u32| (*corner as usize) < elements.boundary_points;
        for (corners, grain) in elements.iter().zip(elements.grains) {
            for corner in corners.iter().copied().filter(is_at_boundary) {
                of.entry((corner, *grain)).or_insert(corner);
            }
        }
        // The smallest grain comes first.
        let mut last = None;
        let mut points = elements.points.to_vec();
        for ((point, _), node) in &mut of {
            if last.replace(*point) == Some(*point) {
                *node = number(points.len());
                points.push(points[*point as usize]);
            }
        }
        let own = |(corners, grain): (&[u32], &GrainId)| -> Vec<u32> {
            corners.iter().map(|corner| of.get(&(*corner, *grain)).copied().unwrap_or(*corner)).collect()
        };
        let of_elements = elements.iter().zip(elements.grains).flat_map(own).collect();
        Self { points, of_elements, of }
    }

    fn at(&self, point: u32, grain: GrainId) -> u32 {
        self.of[&(point, grain)]
    }
}

impl<'a> CohesiveMesh<'a> {
    /// Parts the grains of a network and puts elements between them. `pairs` are the points of the network that are others moved by whole periods.
    ///
    /// Between grains a period apart the elements stand at the original of the boundary; nodes of their own stand in for those of the grain beyond.
    pub(crate) fn new(elements: &ElementNodes<'a>, network: &Network, pairs: &[PeriodicPair<u32>]) -> Self {
        let mut nodes = Nodes::new(elements);
        let mut joints = Vec::new();
        let mut stand_ins = StandIns::new(elements.boundary_points, pairs);
        let level = network.finest_level();
        let boundaries = network.boundaries();
        let mut order: Vec<(BoundaryId, Corners)> = boundary_elements(&level).collect();
        order.sort_by_key(|(boundary, _)| *boundary);
        for (id, corners) in order {
            let boundary = &boundaries[id.index()];
            let Side::Grain(first) = boundary.sides[0] else { continue };
            let (second, upper): (GrainId, Vec<u32>) = match (boundary.sides[1], boundary.twin) {
                (Side::Grain(second), _) => {
                    (second, corners.iter().map(|corner| nodes.at(*corner, second)).collect())
                }
                (Side::Exterior, Some(twin)) if id < twin.boundary => {
                    let Side::Grain(second) = boundaries[twin.boundary.index()].sides[0] else { continue };
                    let mut stand_in =
                        |corner: &u32| stand_ins.node(&mut nodes, *corner, second, twin.translation);
                    (second, corners.iter().map(&mut stand_in).collect())
                }
                _ => continue,
            };
            let lower: Vec<u32> = corners.iter().map(|corner| nodes.at(*corner, first)).collect();
            joints.push(Joint { nodes: joined(&lower, &upper, first <= second), boundary: id });
        }
        let mut ties = stand_ins.ties();
        if ties.is_empty() {
            ties = within_grains(&nodes, pairs);
        }
        Self { elements: elements.between(nodes.points, nodes.of_elements), joints, ties }
    }
}

/// The nodes of a cohesive element between those on the first side of a boundary and those on its second one. The normal of three points away from the first side; the first side lies on the
/// left of two.
fn joined(lower: &[u32], upper: &[u32], is_first_smaller: bool) -> Vec<u32> {
    match (lower, upper, is_first_smaller) {
        (&[a, b], &[c, d], true) => vec![b, a, c, d],
        (&[a, b], &[c, d], false) => vec![c, d, b, a],
        (_, _, true) => [lower, upper].concat(),
        (_, _, false) => {
            [upper, lower].concat().chunks(3).flat_map(|side| [side[0], side[2], side[1]]).collect()
        }
    }
}

/// Where grains are cut at a box, they go on at its opposite side: ties between nodes of one grain.
fn within_grains(nodes: &Nodes, pairs: &[PeriodicPair<u32>]) -> Vec<PeriodicPair<u32>> {
    let of_pair = |pair: &PeriodicPair<u32>| {
        let PeriodicPair { secondary, primary, translation } = *pair;
        let grains = nodes.of.range((secondary, GrainId(0))..=(secondary, GrainId(u32::MAX)));
        let grains: Vec<(GrainId, u32)> = grains.map(|((_, grain), node)| (*grain, *node)).collect();
        grains.into_iter().filter_map(move |(grain, node)| {
            let primary = *nodes.of.get(&(primary, grain))?;
            Some(PeriodicPair { secondary: node, primary, translation })
        })
    };
    pairs.iter().flat_map(of_pair).collect()
}

/// Nodes that stand in for those of grains whole periods away.
struct StandIns {
    /// The original of each point, and the periods that lead from there to the point.
    places: Vec<(u32, Translation)>,
    points: BTreeMap<(u32, Translation), u32>,
    /// By the node that they stand in for, and the periods from there.
    nodes: BTreeMap<(u32, Translation), u32>,
}

impl StandIns {
    fn new(count: usize, pairs: &[PeriodicPair<u32>]) -> Self {
        let mut places: Vec<(u32, Translation)> =
            (0u32..).take(count).map(|point| (point, Translation::ZERO)).collect();
        for PeriodicPair { secondary, primary, translation } in pairs {
            places[*secondary as usize] = (*primary, *translation);
        }
        let points = (0u32..).zip(&places).map(|(point, place)| (*place, point)).collect();
        Self { places, points, nodes: BTreeMap::new() }
    }

    /// The node at a point that stands in for a grain's node whole periods away.
    fn node(&mut self, nodes: &mut Nodes, point: u32, grain: GrainId, translation: Translation) -> u32 {
        let (original, from) = self.places[point as usize];
        let node = nodes.at(self.points[&(original, from + translation)], grain);
        *self.nodes.entry((node, Translation::ZERO - translation)).or_insert_with(|| {
            nodes.points.push(nodes.points[point as usize]);
            number(nodes.points.len() - 1)
        })
    }

    fn ties(&self) -> Vec<PeriodicPair<u32>> {
        let tie = |(&(primary, translation), &secondary): (&(u32, Translation), &u32)| PeriodicPair {
            secondary,
            primary,
            translation,
        };
        self.nodes.iter().map(tie).collect()
    }
}

fn number(node: usize) -> u32 {
    u32::try_from(node).expect("ids fit 32 bits")
}
