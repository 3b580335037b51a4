//! Grains with nodes of their own, and elements of zero thickness between them, which hold them together until they part.

use std::collections::BTreeMap;

use polycrystal::{BoundaryId, GrainId, Mesh, Network, Side};
use voronoi::{PeriodicPair, Translation};

use super::VolumeMesh;

/// Tetrahedra whose grains share no nodes, and prisms without thickness on all boundaries between grains.
#[derive(Debug)]
pub(crate) struct CohesiveMesh {
    /// The tetrahedra by the same numbers. Of the nodes at a point of a boundary, that of the smallest grain has the number of the point; the others follow behind all points.
    pub(crate) mesh: VolumeMesh,
    /// Prisms, boundary by boundary.
    pub(crate) prisms: Vec<Prism>,
    /// Nodes that move as others, whole periods away: no node is both.
    pub(crate) ties: Vec<PeriodicPair<u32>>,
}

/// An element between two grains.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Prism {
    /// A triangle of the grain with the smaller number, whose normal points to the other grain, and that of the other grain, in the same order.
    pub(crate) nodes: [u32; 6],
    /// The boundary; of two that are one, a period apart, the original.
    pub(crate) boundary: BoundaryId,
}

/// The nodes of grains at the points of a network.
struct Nodes {
    mesh: VolumeMesh,
    of: BTreeMap<(u32, GrainId), u32>,
}

impl Nodes {
    fn new(mesh: &VolumeMesh) -> Self {
        let mut nodes = Self { mesh: mesh.clone(), of: BTreeMap::new() };
        let is_at_boundary = |corner: &u32| (*corner as usize) < mesh.surface_points;
        // The smallest grain comes first.
        for (corners, grain) in mesh.tetrahedra.iter().zip(&mesh.grains) {
            for corner in corners.iter().copied().filter(is_at_boundary) {
                nodes.of.entry((corner, *grain)).or_insert(corner);
            }
        }
        let mut last = None;
        let mut copied = Vec::new();
        for ((point, _), node) in &mut nodes.of {
            if last.replace(*point) == Some(*point) {
                *node = number(mesh.points.len() + copied.len());
                copied.push(mesh.points[*point as usize]);
            }
        }
        nodes.mesh.points.extend(copied);
        for (corners, grain) in nodes.mesh.tetrahedra.iter_mut().zip(&mesh.grains) {
            for corner in corners.iter_mut() {
                *corner = nodes.of.get(&(*corner, *grain)).copied().unwrap_or(*corner);
            }
        }
        nodes
    }

    fn at(&self, point: u32, grain: GrainId) -> u32 {
        self.of[&(point, grain)]
    }
}

impl CohesiveMesh {
    /// Parts the grains of a network and puts prisms between them. `pairs` are the points of the network that are others moved by whole periods.
    ///
    /// Between grains a period apart the prisms stand at the original of the boundary; nodes of their own stand in for those of the grain beyond.
    pub(crate) fn new(mesh: &VolumeMesh, network: &Network, pairs: &[PeriodicPair<u32>]) -> Self {
        let mut nodes = Nodes::new(mesh);
        let mut prisms = Vec::new();
        let mut stand_ins = StandIns::new(mesh.surface_points, pairs);
        let level = network.finest_level();
        let boundaries = network.boundaries();
        if let Mesh::Triangles(triangles) = &level.mesh {
            let mut order: Vec<(BoundaryId, [u32; 3])> =
                level.boundary_of.iter().copied().zip(triangles.triangles().iter().copied()).collect();
            order.sort_by_key(|(boundary, _)| *boundary);
            for (id, corners) in order {
                let boundary = &boundaries[id.index()];
                let Side::Grain(first) = boundary.sides[0] else { continue };
                let (second, upper) = match (boundary.sides[1], boundary.twin) {
                    (Side::Grain(second), _) => (second, corners.map(|corner| nodes.at(corner, second))),
                    (Side::Exterior, Some(twin)) if id < twin.boundary => {
                        let Side::Grain(second) = boundaries[twin.boundary.index()].sides[0] else {
                            continue;
                        };
                        (
                            second,
                            corners
                                .map(|corner| stand_ins.node(&mut nodes, corner, second, twin.translation)),
                        )
                    }
                    _ => continue,
                };
                let lower = corners.map(|corner| nodes.at(corner, first));
                // A normal points away from the first side.
                let [[a, b, c], [d, e, f]] = [lower, upper];
                let prism = if first <= second { [a, b, c, d, e, f] } else { [d, f, e, a, c, b] };
                prisms.push(Prism { nodes: prism, boundary: id });
            }
        }
        let mut ties = stand_ins.ties();
        if ties.is_empty() {
            ties = within_grains(&nodes, pairs);
        }
        Self { mesh: nodes.mesh, prisms, ties }
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
            nodes.mesh.points.push(nodes.mesh.points[point as usize]);
            number(nodes.mesh.points.len() - 1)
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
