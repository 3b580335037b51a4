use rayon::prelude::*;

use subzero::{EdgeId, FaceId};

use crate::{BoundaryId, Elements, Level, Mesh};

/// How the elements of a surface meet: of triangles in edges, of segments in points.
#[derive(Debug)]
pub(crate) struct Seams {
    /// Places inside a boundary: two elements of it meet there, which wind alike.
    pub(crate) inner: Vec<[u32; 2]>,
    /// The uses of all other places, sorted by place.
    pub(crate) uses: Vec<Use>,
}

/// One use of a place where not two elements of one boundary meet: of an edge by a triangle, in the plane of a point by a
/// segment.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Use {
    /// Number of the place.
    pub(crate) place: u32,
    /// The triangle or segment.
    pub(crate) element: u32,
    /// The edge's number in the triangle; in the plane, 0 where the segment starts at the point, 1 where it ends.
    pub(crate) corner: u8,
}

impl Use {
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

impl Seams {
    /// The seams of a level, from the edges that its mesh knows.
    pub(crate) fn of_level(level: &Level) -> Self {
        let boundary_of = &level.boundary_of;
        let is_inner = |pair: &[u32; 2]| boundary_of[pair[0] as usize] == boundary_of[pair[1] as usize];
        let inner_pair = |pair: Option<[u32; 2]>| pair.filter(is_inner);
        let (inner, mut uses): (Vec<_>, Vec<_>) = match &level.mesh {
            Mesh::Triangles(mesh) => {
                let numbers = |pair: [FaceId; 2]| pair.map(|triangle| triangle.0);
                let edge_count = u32::try_from(mesh.edge_count()).expect("ids fit 32 bits");
                let pair = |edge: u32| inner_pair(mesh.edge_triangles(EdgeId(edge)).map(numbers));
                // A bit for each edge: they stay in the cache while the triangles go by.
                let words = (0..edge_count.div_ceil(64)).into_par_iter().map(|word| {
                    let edges = 64 * word..edge_count.min(64 * word + 64);
                    edges.fold(0u64, |bits, edge| bits | u64::from(pair(edge).is_none()) << (edge % 64))
                });
                let seams: Vec<u64> = words.collect();
                let is_seam = |edge: u32| seams[(edge / 64) as usize] >> (edge % 64) & 1 == 1;
                let pairs = (0..edge_count).into_par_iter().filter(|edge| !is_seam(*edge));
                let pairs = pairs.filter_map(|edge| mesh.edge_triangles(EdgeId(edge)).map(numbers));
                let elements = 0..u32::try_from(level.element_count()).expect("ids fit 32 bits");
                let uses = elements.into_par_iter().flat_map_iter(|element| {
                    let edges = (0u8..).zip(mesh.triangle_edges(FaceId(element)));
                    let at_seams = edges.filter(|(_, edge)| is_seam(edge.0));
                    at_seams.map(move |(corner, edge)| Use { place: edge.0, element, corner })
                });
                (pairs.collect(), uses.collect())
            }
            Mesh::Segments(mesh) => {
                let numbers = |pair: [EdgeId; 2]| pair.map(|segment| segment.0);
                let points = 0..u32::try_from(mesh.vertex_count()).expect("ids fit 32 bits");
                let inner = points.filter_map(|point| inner_pair(mesh.vertex_segments(point).map(numbers)));
                let uses = uses_of_segments(mesh.segments());
                (inner.collect(), uses.filter(|at| mesh.vertex_segments(at.place).is_none()).collect())
            }
        };
        uses.par_sort_unstable();
        Self { inner, uses }
    }

    /// The seams of any elements.
    pub(crate) fn of_elements(elements: Elements<'_>, boundary_of: &[BoundaryId]) -> Self {
        let mut uses: Vec<Use> = match elements {
            Elements::Triangles(triangles) => uses_of_triangles(triangles),
            Elements::Segments(segments) => uses_of_segments(segments).collect(),
        };
        uses.par_sort_unstable();
        let mut inner = Vec::new();
        let is_inner = |at: &[Use]| {
            let [a, b] = at else { return false };
            boundary_of[a.element as usize] == boundary_of[b.element as usize]
                && a.direction(elements) != b.direction(elements)
        };
        let mut others = Vec::new();
        for at in uses.chunk_by(|a, b| a.place == b.place) {
            if is_inner(at) {
                inner.push([at[0].element, at[1].element]);
            } else {
                others.extend_from_slice(at);
            }
        }
        Self { inner, uses: others }
    }

    /// The uses of each place that is not inside a boundary.
    pub(crate) fn places(&self) -> impl Iterator<Item = &[Use]> {
        self.uses.chunk_by(|a, b| a.place == b.place)
    }
}

fn uses_of_triangles(triangles: &[[u32; 3]]) -> Vec<Use> {
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
    let uses = edges.flat_map(|(place, sides)| {
        sides.iter().map(move |&(_, element, corner)| Use { place, element, corner })
    });
    uses.collect()
}

fn uses_of_segments(segments: &[[u32; 2]]) -> impl Iterator<Item = Use> {
    let segments = (0u32..).zip(segments);
    segments.flat_map(|(element, ends)| {
        (0u8..).zip(ends).map(move |(corner, end)| Use { place: *end, element, corner })
    })
}
