//! Elements of a boundary in terms of the boundary's own points.

use std::ops::Range;

use subzero::{EdgeId, FaceId};
use voronoi::Dimension;

use crate::Mesh;

/// Triangles or segments, as numbers of points.
#[derive(Debug)]
pub(crate) enum LocalElements {
    Triangles(Vec<[u32; 3]>),
    Segments(Vec<[u32; 2]>),
}

/// Some of them.
#[derive(Debug, Clone, Copy)]
pub(crate) enum ElementsPart<'a> {
    Triangles(&'a [[u32; 3]]),
    Segments(&'a [[u32; 2]]),
}

impl LocalElements {
    /// None yet.
    pub(crate) fn new(dimension: Dimension) -> Self {
        match dimension {
            Dimension::Three => Self::Triangles(Vec::new()),
            Dimension::Two => Self::Segments(Vec::new()),
        }
    }

    /// Number of elements.
    pub(crate) fn len(&self) -> usize {
        match self {
            Self::Triangles(triangles) => triangles.len(),
            Self::Segments(segments) => segments.len(),
        }
    }

    /// Adds others of the same kind.
    pub(crate) fn append(&mut self, others: &Self) {
        match (self, others) {
            (Self::Triangles(all), Self::Triangles(others)) => all.extend_from_slice(others),
            (Self::Segments(all), Self::Segments(others)) => all.extend_from_slice(others),
            _ => unreachable!("all boundaries of a network are of a kind"),
        }
    }

    /// Those with numbers in a range.
    pub(crate) fn part(&self, range: Range<usize>) -> ElementsPart<'_> {
        match self {
            Self::Triangles(triangles) => ElementsPart::Triangles(&triangles[range]),
            Self::Segments(segments) => ElementsPart::Segments(&segments[range]),
        }
    }
}

/// Some elements in terms of their own points, and these points, sorted.
pub(crate) fn local_elements(all: crate::Elements<'_>, elements: &[u32]) -> (Vec<u32>, LocalElements) {
    let mut points = Vec::with_capacity(3 * elements.len());
    for element in elements {
        points.extend_from_slice(&all.corners(*element));
    }
    points.sort_unstable();
    points.dedup();
    let local = |point: u32| index_in(&points, point);
    let elements = match all.dimension() {
        Dimension::Three => {
            LocalElements::Triangles(elements.iter().map(|e| all.points(*e).map(local)).collect())
        }
        Dimension::Two => {
            LocalElements::Segments(elements.iter().map(|e| all.points(*e).map(local)).collect())
        }
    };
    (points, elements)
}

/// The edges of some elements, sorted; in the plane, these themselves.
pub(crate) fn edges_of(mesh: &Mesh, elements: &[u32]) -> Vec<u32> {
    match mesh {
        Mesh::Segments(_) => elements.to_vec(),
        Mesh::Triangles(mesh) => {
            let edges = elements.iter().flat_map(|e| mesh.triangle_edges(FaceId(*e)));
            let mut edges: Vec<u32> = edges.map(|edge| edge.0).collect();
            edges.sort_unstable();
            edges.dedup();
            edges
        }
    }
}

/// The ends of an edge; in the plane, of a segment.
pub(crate) fn ends_of(mesh: &Mesh, edge: u32) -> [u32; 2] {
    match mesh {
        Mesh::Segments(mesh) => mesh.segments()[edge as usize],
        Mesh::Triangles(mesh) => mesh.edge(EdgeId(edge)),
    }
}

/// Of each of some triangles the edges across from its corners, as places in these sorted edges; nothing in the plane.
pub(crate) fn edges_across(mesh: &Mesh, elements: &[u32], edges: &[u32]) -> Vec<[u32; 3]> {
    let Mesh::Triangles(mesh) = mesh else { return Vec::new() };
    let across = |element: &u32| {
        let [ab, bc, ca] = mesh.triangle_edges(FaceId(*element)).map(|edge| index_in(edges, edge.0));
        [bc, ca, ab]
    };
    elements.iter().map(across).collect()
}

/// The place of an id in a sorted list that holds it.
pub(crate) fn index_in(sorted: &[u32], id: u32) -> u32 {
    let index = sorted.binary_search(&id).expect("a patch's surface depends on its own control points alone");
    u32::try_from(index).expect("an index in a list of ids fits an id")
}
