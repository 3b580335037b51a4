//! What files hold of tetrahedra: nodes, and elements of first or second order between them.

use std::borrow::Cow;
use std::collections::BTreeMap;

use glam::DVec3;
use polycrystal::{Mesh, Network};
use voronoi::{PeriodicPair, Translation};

use super::VolumeMesh;
use super::element_faces::{ElementFace, FACES};

/// The edges of a tetrahedron, by the corners that they join, in the order of their middle nodes in Abaqus, CalculiX, Nastran and VTK.
pub(crate) const EDGES: [[usize; 2]; 6] = [[0, 1], [1, 2], [0, 2], [0, 3], [1, 3], [2, 3]];

/// Number of corners of a tetrahedron.
const CORNERS: usize = 4;

/// Nodes and elements: tetrahedra with their corners alone, or with a node in the middle of each edge as well.
#[derive(Debug)]
pub(crate) struct ElementNodes<'a> {
    /// The points of the tetrahedra, then the middles of edges.
    pub(crate) points: Cow<'a, [DVec3]>,
    /// Of all elements, one after the other.
    nodes: Cow<'a, [u32]>,
    /// Number of nodes of an element.
    pub(crate) node_count: usize,
    /// The middle of each edge, by its ends, the smaller first; none of first order.
    middles: BTreeMap<[u32; 2], u32>,
}

impl<'a> ElementNodes<'a> {
    /// Elements of first order.
    pub(crate) fn linear(mesh: &'a VolumeMesh) -> Self {
        Self {
            points: Cow::Borrowed(&mesh.points),
            nodes: Cow::Borrowed(mesh.tetrahedra.as_flattened()),
            node_count: CORNERS,
            middles: BTreeMap::new(),
        }
    }

    /// Elements of second order; edges of boundaries bend to their middles, others are straight.
    pub(crate) fn quadratic(mesh: &VolumeMesh) -> Self {
        let mut points = mesh.points.clone();
        let mut nodes = Vec::with_capacity((CORNERS + EDGES.len()) * mesh.tetrahedra.len());
        let mut middles = BTreeMap::new();
        for corners in &mesh.tetrahedra {
            nodes.extend(corners);
            for edge in EDGES.map(|ends| sorted(ends.map(|end| corners[end]))) {
                nodes.push(*middles.entry(edge).or_insert_with(|| {
                    let [from, to] = edge.map(|end| points[end as usize]);
                    points.push(mesh.middles.get(&edge).copied().unwrap_or_else(|| from.midpoint(to)));
                    u32::try_from(points.len() - 1).expect("ids fit 32 bits")
                }));
            }
        }
        let node_count = CORNERS + EDGES.len();
        Self { points: points.into(), nodes: nodes.into(), node_count, middles }
    }

    /// Whether edges have nodes in their middle.
    pub(crate) fn are_quadratic(&self) -> bool {
        self.node_count > CORNERS
    }

    /// The nodes of each element: corners first.
    pub(crate) fn iter(&self) -> impl Iterator<Item = &[u32]> {
        self.nodes.chunks(self.node_count)
    }

    /// The nodes of all elements, one after the other.
    pub(crate) fn nodes(&self) -> &[u32] {
        &self.nodes
    }

    /// The nodes of a face: its corners, then the middles of its edges.
    pub(crate) fn nodes_of_face(&self, face: ElementFace) -> Vec<u32> {
        let nodes = &self.nodes[self.node_count * face.element..];
        self.of_triangle(FACES[face.face].map(|corner| nodes[corner]))
    }

    /// The nodes of a triangle: its corners, then the middles of its edges.
    pub(crate) fn of_triangle(&self, corners: [u32; 3]) -> Vec<u32> {
        let [a, b, c] = corners;
        let middles = [[a, b], [b, c], [c, a]].into_iter().filter_map(|edge| self.middles.get(&sorted(edge)));
        corners.into_iter().chain(middles.copied()).collect()
    }

    /// Pairs of points, and those of the middles of edges between them: edges of the network that are others moved by whole periods. Puts the middles where these lead.
    pub(crate) fn tie_middles(&mut self, network: &Network, pairs: &mut Vec<PeriodicPair<u32>>) {
        if pairs.is_empty() || self.middles.is_empty() {
            return;
        }
        let level = network.finest_level();
        let Mesh::Triangles(mesh) = &level.mesh else { return };
        let places: BTreeMap<u32, (u32, Translation)> =
            pairs.iter().map(|pair| (pair.secondary, (pair.primary, pair.translation))).collect();
        let place = |point: u32| places.get(&point).copied().unwrap_or((point, Translation::ZERO));
        let edges = mesh.triangles().iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]].map(sorted));
        let mut edges: Vec<[u32; 2]> = edges.collect();
        edges.sort_unstable();
        edges.dedup();
        // An edge by its originals and the periods between them, whatever the periods from there to it.
        let mut firsts: BTreeMap<(u32, u32, Translation), (u32, Translation)> = BTreeMap::new();
        let points = self.points.to_mut();
        for edge in edges {
            let Some(&middle) = self.middles.get(&edge) else { continue };
            let [(a, from_a), (b, from_b)] = edge.map(place);
            let (key, from) = ((a, b, from_b - from_a), from_a).min(((b, a, from_a - from_b), from_b));
            let (primary, from_primary) = *firsts.entry(key).or_insert((middle, from));
            if primary != middle {
                let translation = from - from_primary;
                let ends = edge.map(|end| points[end as usize]);
                let mut place = points[primary as usize] + translation.vector(network.domain());
                // What both ends have on a wall the sum may miss by a last place.
                for axis in (0..3).filter(|axis| ends[0][*axis] == ends[1][*axis]) {
                    place[axis] = ends[0][axis];
                }
                points[middle as usize] = place;
                pairs.push(PeriodicPair { secondary: middle, primary, translation });
            }
        }
    }
}

pub(crate) fn sorted([a, b]: [u32; 2]) -> [u32; 2] {
    [a.min(b), a.max(b)]
}
