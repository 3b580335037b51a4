//! What a triangle becomes when it is refined up to twice.

use crate::TriangleMesh;

/// A triangle that is refined a few times: the triangles in it, and how they meet. Places of vertices are those in
/// [`RefinedMesh::vertices_in`](crate::RefinedMesh::vertices_in), those of triangles as of [`RefinedMesh::triangle_in`](crate::RefinedMesh::triangle_in).
#[derive(Debug)]
pub struct RefinedTriangle {
    /// How many vertices there are in it and on its edges.
    pub vertices: usize,
    /// The corners of each triangle in it.
    pub triangles: &'static [[usize; 3]],
    /// The two triangles at each edge inside it.
    pub neighbours: &'static [[usize; 2]],
    /// The triangles along each of its edges, as the edge runs, and the number of the edge that each has there.
    pub along_edges: [&'static [(usize, usize)]; 3],
}

impl RefinedTriangle {
    /// That which is refined so many times.
    pub const OF_LEVELS: [Self; 3] = [
        Self {
            vertices: 3,
            triangles: &[[0, 1, 2]],
            neighbours: &[],
            along_edges: [&[(0, 0)], &[(0, 1)], &[(0, 2)]],
        },
        Self {
            vertices: 6,
            triangles: &ONCE,
            neighbours: &neighbours::<4, 3>(&ONCE),
            along_edges: [&[(0, 0), (1, 2)], &[(1, 0), (2, 2)], &[(2, 0), (0, 2)]],
        },
        Self {
            vertices: 15,
            triangles: &TriangleMesh::TRIANGLES_BEYOND,
            neighbours: &neighbours::<16, 18>(&TriangleMesh::TRIANGLES_BEYOND),
            along_edges: [
                &[(0, 0), (1, 2), (6, 0), (4, 2)],
                &[(4, 0), (5, 2), (10, 0), (8, 2)],
                &[(8, 0), (9, 2), (2, 0), (0, 2)],
            ],
        },
    ];
}

/// One at each corner, and the centre.
const ONCE: [[usize; 3]; 4] = [[0, 3, 5], [1, 4, 3], [2, 5, 4], [5, 3, 4]];

/// The pairs of triangles that have two corners in common.
const fn neighbours<const TRIANGLES: usize, const PAIRS: usize>(
    triangles: &[[usize; 3]; TRIANGLES],
) -> [[usize; 2]; PAIRS] {
    let mut pairs = [[0; 2]; PAIRS];
    let mut count = 0;
    let mut second = 0;
    while second < TRIANGLES {
        let mut first = 0;
        while first < second {
            if common(triangles[first], triangles[second]) == 2 {
                pairs[count] = [first, second];
                count += 1;
            }
            first += 1;
        }
        second += 1;
    }
    assert!(count == PAIRS);
    pairs
}

/// How many corners two triangles have in common.
const fn common(first: [usize; 3], second: [usize; 3]) -> usize {
    let mut count = 0;
    let mut place = 0;
    while place < 9 {
        if first[place / 3] == second[place % 3] {
            count += 1;
        }
        place += 1;
    }
    count
}
