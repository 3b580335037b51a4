use rayon::prelude::*;

use subzero::{EdgeId, FaceId};

use crate::{BoundaryId, Elements, Level, Mesh};

/// How the elements of a surface meet: triangles in edges, segments in points. In the plane, "edge" means such a point.
#[derive(Debug)]
pub(crate) struct Adjacency {
    /// The two elements at each edge inside a boundary; both have the same orientation.
    pub(crate) inner: Vec<[u32; 2]>,
    /// The incidences of all other edges, sorted by edge.
    pub(crate) incidences: Vec<Incidence>,
}

/// A triangle at an edge that is not inside a boundary; in the plane, a segment at such a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Incidence {
    /// Number of the edge; in the plane, of the point.
    pub(crate) edge: u32,
    /// The triangle or segment.
    pub(crate) element: u32,
    /// The edge's number in the triangle; in the plane, 0 where the segment starts at the point, 1 where it ends.
    pub(crate) corner: u8,
}

impl Incidence {
    /// The edge as its triangle runs along it; in the plane, the point twice.
    pub(crate) fn ends(&self, elements: Elements<'_>) -> [u32; 2] {
        let corner = usize::from(self.corner);
        match elements {
            Elements::Triangles(triangles) => {
                let triangle = triangles[self.element as usize];
                [triangle[corner], triangle[(corner + 1) % 3]]
            }
            Elements::Segments(segments) => [segments[self.element as usize][corner]; 2],
        }
    }

    /// 1 where the element runs along the edge as from its lower to its higher point (in the plane: starts at the point),
    /// -1 where against it.
    pub(crate) fn direction(&self, elements: Elements<'_>) -> i32 {
        let is_along = match elements {
            Elements::Triangles(_) => {
                let [start, end] = self.ends(elements);
                start < end
            }
            Elements::Segments(_) => self.corner == 0,
        };
        if is_along { 1 } else { -1 }
    }
}

impl Adjacency {
    /// The adjacency of a level, from the edges that its mesh knows.
    pub(crate) fn of_level(level: &Level) -> Self {
        let boundary_of = &level.boundary_of;
        let is_inner = |pair: &[u32; 2]| boundary_of[pair[0] as usize] == boundary_of[pair[1] as usize];
        let inner_pair = |pair: Option<[u32; 2]>| pair.filter(is_inner);
        let (inner, mut incidences): (Vec<_>, Vec<_>) = match &level.mesh {
            Mesh::Triangles(mesh) => {
                let numbers = |pair: [FaceId; 2]| pair.map(|triangle| triangle.0);
                let edge_count = u32::try_from(mesh.edge_count()).expect("ids fit 32 bits");
                let pair = |edge: u32| inner_pair(mesh.edge_triangles(EdgeId(edge)).map(numbers));
                // A bit for each edge: they stay in the cache while the triangles go by.
                let words = (0..edge_count.div_ceil(64)).into_par_iter().map(|word| {
                    let edges = 64 * word..edge_count.min(64 * word + 64);
                    edges.fold(0u64, |bits, edge| bits | u64::from(pair(edge).is_none()) << (edge % 64))
                });
                let non_manifold: Vec<u64> = words.collect();
                let is_non_manifold = |edge: u32| non_manifold[(edge / 64) as usize] >> (edge % 64) & 1 == 1;
                let pairs = (0..edge_count).into_par_iter().filter(|edge| !is_non_manifold(*edge));
                let pairs = pairs.filter_map(|edge| mesh.edge_triangles(EdgeId(edge)).map(numbers));
                let elements = 0..u32::try_from(level.element_count()).expect("ids fit 32 bits");
                let incidences = elements.into_par_iter().flat_map_iter(|element| {
                    let edges = (0u8..).zip(mesh.triangle_edges(FaceId(element)));
                    let non_manifold_edges = edges.filter(|(_, edge)| is_non_manifold(edge.0));
                    non_manifold_edges.map(move |(corner, edge)| Incidence { edge: edge.0, element, corner })
                });
                (pairs.collect(), incidences.collect())
            }
            Mesh::Segments(mesh) => {
                let numbers = |pair: [EdgeId; 2]| pair.map(|segment| segment.0);
                let points = 0..u32::try_from(mesh.vertex_count()).expect("ids fit 32 bits");
                let inner = points.filter_map(|point| inner_pair(mesh.vertex_segments(point).map(numbers)));
                let incidences = incidences_of_segments(mesh.segments());
                (inner.collect(), incidences.filter(|at| mesh.vertex_segments(at.edge).is_none()).collect())
            }
        };
        incidences.par_sort_unstable();
        Self { inner, incidences }
    }

    /// The adjacency of any elements.
    pub(crate) fn of_elements(elements: Elements<'_>, boundary_of: &[BoundaryId]) -> Self {
        let mut incidences: Vec<Incidence> = match elements {
            Elements::Triangles(triangles) => incidences_of_triangles(triangles),
            Elements::Segments(segments) => incidences_of_segments(segments).collect(),
        };
        incidences.par_sort_unstable();
        let mut inner = Vec::new();
        let is_inner = |at: &[Incidence]| {
            let [a, b] = at else { return false };
            boundary_of[a.element as usize] == boundary_of[b.element as usize]
                && a.direction(elements) != b.direction(elements)
        };
        let mut others = Vec::new();
        for at in incidences.chunk_by(|a, b| a.edge == b.edge) {
            if is_inner(at) {
                inner.push([at[0].element, at[1].element]);
            } else {
                others.extend_from_slice(at);
            }
        }
        Self { inner, incidences: others }
    }

    /// The incidences of each edge that is not inside a boundary.
    pub(crate) fn non_manifold_edges(&self) -> impl Iterator<Item = &[Incidence]> {
        self.incidences.chunk_by(|a, b| a.edge == b.edge)
    }
}

fn incidences_of_triangles(triangles: &[[u32; 3]]) -> Vec<Incidence> {
    let mut sides: Vec<([u32; 2], u32, u8)> = (0..triangles.len())
        .into_par_iter()
        .flat_map_iter(|triangle| {
            let [a, b, c] = triangles[triangle];
            let element = u32::try_from(triangle).expect("ids fit 32 bits");
            let edges = (0u8..).zip([[a, b], [b, c], [c, a]]);
            edges.map(move |(corner, [from, to])| ([from.min(to), from.max(to)], element, corner))
        })
        .collect();
    sides.par_sort_unstable();
    let edges = (0u32..).zip(sides.chunk_by(|a, b| a.0 == b.0));
    let incidences = edges.flat_map(|(edge, sides)| {
        sides.iter().map(move |&(_, element, corner)| Incidence { edge, element, corner })
    });
    incidences.collect()
}

fn incidences_of_segments(segments: &[[u32; 2]]) -> impl Iterator<Item = Incidence> {
    let segments = (0u32..).zip(segments);
    segments.flat_map(|(element, ends)| {
        (0u8..).zip(ends).map(move |(corner, end)| Incidence { edge: *end, element, corner })
    })
}
