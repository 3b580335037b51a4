//! What files hold of elements that fill grains: nodes, and elements of first or second order between them.

use std::borrow::Cow;
use std::collections::BTreeMap;

use glam::DVec3;
use polycrystal::{GrainId, Network, PlaneMesh};
use voronoi::{PeriodicPair, Translation};

use super::VolumeMesh;
use super::element_shape::{ElementFace, ElementShape, boundary_elements, edges_around};

/// Nodes and elements: triangles or tetrahedra with their corners alone, or with a node in the middle of each edge as well.
#[derive(Debug)]
pub(crate) struct ElementNodes<'a> {
    pub(crate) shape: ElementShape,
    /// Corners, those on boundaries first, then the middles of edges.
    pub(crate) points: Cow<'a, [DVec3]>,
    /// Number of points on boundaries, which have the numbers of the network.
    pub(crate) boundary_points: usize,
    /// Of all elements, one after the other.
    nodes: Cow<'a, [u32]>,
    /// Number of nodes of an element.
    pub(crate) node_count: usize,
    /// The grain of each element, grain by grain.
    pub(crate) grains: &'a [GrainId],
    /// The middle of each edge, by its ends, the smaller first; none of first order.
    middles: BTreeMap<[u32; 2], u32>,
}

impl<'a> From<&'a VolumeMesh> for ElementNodes<'a> {
    fn from(mesh: &'a VolumeMesh) -> Self {
        let corners = mesh.tetrahedra.as_flattened();
        Self::linear(ElementShape::Tetrahedron, (&mesh.points, mesh.surface_points), corners, &mesh.grains)
    }
}

impl<'a> From<&'a PlaneMesh> for ElementNodes<'a> {
    fn from(mesh: &'a PlaneMesh) -> Self {
        let corners = mesh.triangles.as_flattened();
        Self::linear(ElementShape::Triangle, (&mesh.points, mesh.line_points), corners, &mesh.grains)
    }
}

impl<'a> ElementNodes<'a> {
    fn linear(
        shape: ElementShape,
        (points, boundary_points): (&'a [DVec3], usize),
        nodes: &'a [u32],
        grains: &'a [GrainId],
    ) -> Self {
        let (points, nodes) = (Cow::Borrowed(points), Cow::Borrowed(nodes));
        let node_count = shape.corner_count();
        Self { shape, points, boundary_points, nodes, node_count, grains, middles: BTreeMap::new() }
    }

    /// The same elements of second order: edges bend to some middles, by their ends, and are straight elsewhere.
    pub(crate) fn quadratic(self, bent: &BTreeMap<[u32; 2], DVec3>) -> Self {
        let mut points = self.points.to_vec();
        let node_count = self.shape.corner_count() + self.shape.edges().len();
        let mut nodes = Vec::with_capacity(node_count * self.grains.len());
        let mut middles = BTreeMap::new();
        for corners in self.iter() {
            nodes.extend(corners);
            for ends in self.shape.edges() {
                let edge = sorted(ends.map(|end| corners[end]));
                nodes.push(*middles.entry(edge).or_insert_with(|| {
                    let [from, to] = edge.map(|end| points[end as usize]);
                    points.push(bent.get(&edge).copied().unwrap_or_else(|| from.midpoint(to)));
                    u32::try_from(points.len() - 1).expect("ids fit 32 bits")
                }));
            }
        }
        Self { points: points.into(), nodes: nodes.into(), node_count, middles, ..self }
    }

    /// Elements of first order between other points.
    pub(crate) fn between(&self, points: Vec<DVec3>, nodes: Vec<u32>) -> Self {
        let (points, nodes) = (points.into(), nodes.into());
        Self { points, nodes, middles: BTreeMap::new(), ..*self }
    }

    /// Whether edges have nodes in their middle.
    pub(crate) fn are_quadratic(&self) -> bool {
        self.node_count > self.shape.corner_count()
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
        let corners = self.shape.faces().nth(face.face).unwrap_or_default();
        let corners: Vec<u32> = corners.iter().map(|corner| nodes[*corner]).collect();
        self.on_boundary(&corners)
    }

    /// The nodes of a triangle, or a segment: its corners, then the middles of its edges.
    pub(crate) fn on_boundary(&self, corners: &[u32]) -> Vec<u32> {
        let middles = edges_around(corners).filter_map(|edge| self.middles.get(&sorted(edge)));
        corners.iter().chain(middles).copied().collect()
    }

    /// Adds to pairs of points those of the middles of edges between them: edges of the network that are others moved by whole periods.
    pub(crate) fn tie_middles(&self, network: &Network, pairs: &mut Vec<PeriodicPair<u32>>) {
        if pairs.is_empty() || self.middles.is_empty() {
            return;
        }
        let level = network.finest_level();
        let places: BTreeMap<u32, (u32, Translation)> =
            pairs.iter().map(|pair| (pair.secondary, (pair.primary, pair.translation))).collect();
        let place = |point: u32| places.get(&point).copied().unwrap_or((point, Translation::ZERO));
        let mut edges: Vec<[u32; 2]> = Vec::new();
        for (_, corners) in boundary_elements(&level) {
            edges.extend(edges_around(&corners).map(sorted));
        }
        edges.sort_unstable();
        edges.dedup();
        // An edge by its originals and the periods between them, whatever the periods from there to it.
        let mut firsts: BTreeMap<(u32, u32, Translation), (u32, Translation)> = BTreeMap::new();
        for edge in edges {
            let Some(&middle) = self.middles.get(&edge) else { continue };
            let [(a, from_a), (b, from_b)] = edge.map(place);
            let (key, from) = ((a, b, from_b - from_a), from_a).min(((b, a, from_a - from_b), from_b));
            let (primary, from_primary) = *firsts.entry(key).or_insert((middle, from));
            if primary != middle {
                let translation = from - from_primary;
                pairs.push(PeriodicPair { secondary: middle, primary, translation });
            }
        }
    }
}

pub(crate) fn sorted([a, b]: [u32; 2]) -> [u32; 2] {
    [a.min(b), a.max(b)]
}
