use rayon::prelude::*;
use subzero::TriangleMesh;

use crate::{BoundaryId, Level, Mesh};

/// One use of a place where boundaries meet: of an edge by a triangle, in the plane of a vertex by a segment.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct CreaseUse {
    /// The edge; in the plane, the vertex.
    pub(crate) place: u32,
    /// The triangle or segment.
    pub(crate) element: u32,
    /// The edge's number in the triangle; in the plane, 0 where the segment starts at the vertex, 1 where it ends.
    pub(crate) corner: u8,
}

/// The uses of all places where more than one boundary meets, sorted by place.
pub(crate) fn crease_uses(level: &Level) -> Vec<CreaseUse> {
    let mut uses: Vec<CreaseUse> = match &level.mesh {
        Mesh::Triangles(mesh) => (0..level.element_count())
            .into_par_iter()
            .flat_map_iter(|t| uses_of_triangle(mesh, &level.boundary_of, t))
            .collect(),
        Mesh::Segments(mesh) => {
            let segments = (0u32..).zip(mesh.segments());
            let uses = segments.flat_map(|(element, ends)| {
                (0u8..).zip(ends).map(move |(corner, end)| CreaseUse { place: *end, element, corner })
            });
            uses.filter(|at| mesh.vertex_segments(at.place).is_none()).collect()
        }
    };
    uses.par_sort_unstable();
    uses
}

fn uses_of_triangle(
    mesh: &TriangleMesh,
    boundary_of: &[BoundaryId],
    triangle: usize,
) -> impl Iterator<Item = CreaseUse> {
    let element = u32::try_from(triangle).expect("triangle ids fit 32 bits");
    let edges = (0u8..).zip(mesh.triangle_edges(element));
    edges
        .filter(move |(_, edge)| match mesh.edge_triangles(*edge) {
            Some([a, b]) => boundary_of[a as usize] != boundary_of[b as usize],
            None => true,
        })
        .map(move |(corner, place)| CreaseUse { place, element, corner })
}
