use rayon::prelude::*;
use subzero::{EdgeId, FaceId, HalfEdgeId, RefinedMesh, TriangleMesh};

use crate::mesh::grouped::Grouped;
use crate::mesh::id::id;
use crate::mesh::level::LevelMesh;
use crate::{BoundaryId, Elements, LevelView};

/// Points whose edges a thread looks at in one go: enough to keep it busy.
const POINTS_AT_ONCE: usize = 1 << 14;

/// How the elements of a surface meet: triangles in edges, segments in points. In the plane, "edge" means such a point.
#[derive(Debug)]
pub(crate) struct Adjacency<'a> {
    /// The two elements at each edge inside a boundary; both have the same orientation.
    pub(crate) inner: Inner<'a>,
    /// The incidences of all other edges, sorted by edge.
    pub(crate) incidences: Vec<Incidence>,
}

/// The pairs of elements at edges inside boundaries.
#[derive(Debug)]
pub(crate) enum Inner<'a> {
    /// One by one.
    Listed(Vec<[u32; 2]>),
    /// As they follow from a mesh whose triangles have these boundaries.
    OfMesh { mesh: RefinedMesh<'a>, boundary_of: &'a [BoundaryId] },
}

impl Inner<'_> {
    /// All pairs, in the order of the edges.
    pub(crate) fn pairs(&self) -> Vec<[u32; 2]> {
        match self {
            Self::Listed(pairs) => pairs.clone(),
            Self::OfMesh { mesh, boundary_of } => {
                let edges = (0..mesh.mesh().counts().edges).into_par_iter();
                let inner = edges.filter_map(|edge| inner_half_edges(mesh.mesh(), boundary_of, EdgeId(edge)));
                let pairs = (0..mesh.levels()).fold(inner.collect(), |pairs: Vec<_>, level| {
                    refined_half_edges(&pairs, mesh.counts_of(level).triangles)
                });
                pairs.into_par_iter().map(|pair| pair.map(|h| h.triangle().0)).collect()
            }
        }
    }
}

/// The two half-edges of an edge between two triangles of one boundary.
fn inner_half_edges(
    mesh: &TriangleMesh,
    boundary_of: &[BoundaryId],
    edge: EdgeId,
) -> Option<[HalfEdgeId; 2]> {
    let pair = mesh.edge_half_edges(edge)?;
    let [one, other] = pair.map(|h| boundary_of[h.triangle().index()]);
    (one == other).then_some(pair)
}

/// The half-edges of each edge one level on from so many triangles, given those of each edge between two of them: two for its halves, and then
/// those for the edges inside the triangles.
fn refined_half_edges(pairs: &[[HalfEdgeId; 2]], triangles: u32) -> Vec<[HalfEdgeId; 2]> {
    // A triangle at a corner has the number of the half-edge that starts there.
    let in_corner = |HalfEdgeId(h): HalfEdgeId, k: u32| HalfEdgeId(3 * h + k);
    let halves = pairs.iter().flat_map(|[along, against]| {
        [
            [in_corner(*along, 0), in_corner(against.next(), 2)],
            [in_corner(along.next(), 2), in_corner(*against, 0)],
        ]
    });
    let half_edges = (0..3 * triangles).map(HalfEdgeId);
    let inside = half_edges.map(|h| [in_corner(h, 1), HalfEdgeId(9 * triangles + h.0)]);
    halves.chain(inside).collect()
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
        let corners = elements.corners(self.element);
        match elements {
            Elements::Triangles(_) | Elements::Refined(_) => [corners[corner], corners[(corner + 1) % 3]],
            Elements::Segments(_) => [corners[corner]; 2],
        }
    }

    /// 1 where the element runs along the edge as from its lower to its higher point (in the plane: starts at the point),
    /// -1 where against it.
    pub(crate) fn direction(&self, elements: Elements<'_>) -> i32 {
        let is_along = match elements {
            Elements::Triangles(_) | Elements::Refined(_) => {
                let [start, end] = self.ends(elements);
                start < end
            }
            Elements::Segments(_) => self.corner == 0,
        };
        if is_along { 1 } else { -1 }
    }
}

impl<'a> Adjacency<'a> {
    /// The adjacency of a level, from the edges that its mesh knows.
    pub(crate) fn of_level(level: impl Into<LevelView<'a>>) -> Self {
        let level = level.into();
        let boundary_of = level.labels();
        match level.mesh() {
            LevelMesh::Triangles(mesh) => Self::of_mesh(mesh, boundary_of),
            LevelMesh::Segments(mesh) => {
                let is_inner =
                    |pair: &[u32; 2]| boundary_of[pair[0] as usize] == boundary_of[pair[1] as usize];
                let pair = |point: u32| {
                    let segments = mesh.vertex_segments(point)?.map(|segment| segment.0);
                    Some(segments).filter(is_inner)
                };
                let points = 0..u32::try_from(mesh.vertex_count()).expect("ids fit 32 bits");
                let incidences = incidences_of_segments(mesh.segments());
                let mut incidences: Vec<Incidence> =
                    incidences.filter(|at| mesh.vertex_segments(at.edge).is_none()).collect();
                incidences.par_sort_unstable();
                Self { inner: Inner::Listed(points.filter_map(pair).collect()), incidences }
            }
        }
    }

    /// The adjacency of what follows from a mesh whose triangles have these boundaries.
    fn of_mesh(mesh: RefinedMesh<'a>, boundary_of: &'a [BoundaryId]) -> Self {
        let of_mesh = incidences_of_mesh(mesh.mesh(), boundary_of);
        let mut incidences = (1..=mesh.levels())
            .fold(of_mesh, |incidences, levels| refined_incidences(mesh.at(levels), &incidences));
        incidences.par_sort_unstable();
        Self { inner: Inner::OfMesh { mesh, boundary_of }, incidences }
    }

    /// The adjacency of any elements.
    pub(crate) fn of_elements(elements: Elements<'a>, boundary_of: &'a [BoundaryId]) -> Self {
        match elements {
            Elements::Triangles(triangles) => Self::of_triangles(triangles, boundary_of),
            Elements::Refined(mesh) => Self::of_mesh(mesh, boundary_of),
            Elements::Segments(segments) => {
                let mut incidences: Vec<Incidence> = incidences_of_segments(segments).collect();
                incidences.par_sort_unstable();
                let mut sorted = SortedOut::default();
                by_edge(&incidences).for_each(|at| sorted.add(at, elements, boundary_of));
                sorted.into()
            }
        }
    }

    /// The adjacency of triangles by their corners alone. Numbers of edges grow, with gaps.
    fn of_triangles(triangles: &[[u32; 3]], boundary_of: &[BoundaryId]) -> Self {
        let point_count = triangles.iter().flatten().max().map_or(0, |last| *last as usize + 1);
        // By the lower end of each edge: the other end, and the number of the edge among those of all triangles.
        let half_edges = Grouped::new(
            point_count,
            (0u32..).zip(triangles).flat_map(|(triangle, [a, b, c])| {
                let edges = (3 * triangle..).zip([[a, b], [b, c], [c, a]]);
                edges.map(|(half_edge, [from, to])| (*from.min(to) as usize, (*from.max(to), half_edge)))
            }),
        );
        let elements = Elements::Triangles(triangles);
        let at_points = |first: usize| {
            let mut sorted = SortedOut::default();
            let mut edge = id(half_edges.start(first));
            let (mut at_point, mut at_edge) = (Vec::new(), Vec::new());
            for point in first..point_count.min(first + POINTS_AT_ONCE) {
                at_point.clear();
                at_point.extend_from_slice(half_edges.of(point));
                at_point.sort_unstable();
                for at in at_point.chunk_by(|one, other| one.0 == other.0) {
                    at_edge.clear();
                    at_edge.extend(at.iter().map(|(_, half_edge)| Incidence {
                        edge,
                        element: half_edge / 3,
                        corner: [0, 1, 2][(half_edge % 3) as usize],
                    }));
                    sorted.add(&at_edge, elements, boundary_of);
                    edge += id(at.len());
                }
            }
            sorted
        };
        let chunks = (0..point_count.div_ceil(POINTS_AT_ONCE)).into_par_iter();
        let chunks: Vec<SortedOut> = chunks.map(|chunk| at_points(chunk * POINTS_AT_ONCE)).collect();
        drop(half_edges);
        let mut all = SortedOut::default();
        for chunk in chunks {
            all.inner.extend(chunk.inner);
            all.others.extend(chunk.others);
        }
        all.into()
    }

    /// The incidences of each edge that is not inside a boundary.
    pub(crate) fn non_manifold_edges(&self) -> impl Iterator<Item = &[Incidence]> {
        by_edge(&self.incidences)
    }
}

/// Edges inside boundaries, and the others.
#[derive(Default)]
struct SortedOut {
    inner: Vec<[u32; 2]>,
    others: Vec<Incidence>,
}

impl SortedOut {
    /// Adds the incidences of an edge.
    fn add(&mut self, at: &[Incidence], elements: Elements<'_>, boundary_of: &[BoundaryId]) {
        match at {
            [a, b]
                if boundary_of[a.element as usize] == boundary_of[b.element as usize]
                    && a.direction(elements) != b.direction(elements) =>
            {
                self.inner.push([a.element, b.element]);
            }
            _ => self.others.extend_from_slice(at),
        }
    }
}

impl From<SortedOut> for Adjacency<'_> {
    fn from(SortedOut { inner, others }: SortedOut) -> Self {
        Self { inner: Inner::Listed(inner), incidences: others }
    }
}

/// The incidences of each edge, where they are sorted by edge.
pub(crate) fn by_edge(incidences: &[Incidence]) -> impl Iterator<Item = &[Incidence]> {
    incidences.chunk_by(|a, b| a.edge == b.edge)
}

/// As [`by_edge`].
pub(crate) fn by_edge_in_parallel(incidences: &[Incidence]) -> impl ParallelIterator<Item = &[Incidence]> {
    incidences.par_chunk_by(|a, b| a.edge == b.edge)
}

/// The incidences of all edges of a mesh that are not inside a boundary.
fn incidences_of_mesh(mesh: &TriangleMesh, boundary_of: &[BoundaryId]) -> Vec<Incidence> {
    let edge_count = mesh.counts().edges;
    // A bit for each edge: they stay in the cache while the triangles go by.
    let is_non_manifold_edge = |edge: u32| inner_half_edges(mesh, boundary_of, EdgeId(edge)).is_none();
    let words = (0..edge_count.div_ceil(64)).into_par_iter().map(|word| {
        let edges = 64 * word..edge_count.min(64 * word + 64);
        edges.fold(0u64, |bits, edge| bits | u64::from(is_non_manifold_edge(edge)) << (edge % 64))
    });
    let non_manifold: Vec<u64> = words.collect();
    let is_non_manifold = |edge: u32| non_manifold[(edge / 64) as usize] >> (edge % 64) & 1 == 1;
    let incidences = (0..mesh.counts().triangles).into_par_iter().flat_map_iter(|element| {
        let edges = (0u8..).zip(mesh.triangle_edges(FaceId(element)));
        let non_manifold_edges = edges.filter(|(_, edge)| is_non_manifold(edge.0));
        non_manifold_edges.map(move |(corner, edge)| Incidence { edge: edge.0, element, corner })
    });
    incidences.collect()
}

/// The incidences on a level, given those of the one before: each triangle along an edge leaves two at its halves.
fn refined_incidences(finer: RefinedMesh<'_>, incidences: &[Incidence]) -> Vec<Incidence> {
    let halves = incidences.par_iter().flat_map_iter(|at| {
        let start = HalfEdgeId(3 * at.element + u32::from(at.corner));
        // Triangles at corners have the numbers of the half-edges that start there: the edge is their first, and the last of the next one.
        [(start, 0), (start.next(), 2)].map(|(child, corner)| {
            let edge = finer.edge_of(HalfEdgeId(3 * child.0 + u32::from(corner)));
            Incidence { edge: edge.0, element: child.0, corner }
        })
    });
    halves.collect()
}

fn incidences_of_segments(segments: &[[u32; 2]]) -> impl Iterator<Item = Incidence> {
    let segments = (0u32..).zip(segments);
    segments.flat_map(|(element, ends)| {
        (0u8..).zip(ends).map(move |(corner, end)| Incidence { edge: *end, element, corner })
    })
}
