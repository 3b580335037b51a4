use glam::DVec3;

use crate::exact::generator::Generator;

/// A vertex while the cells of its tile are completed: four generators and the vertex at the other end of each of the four
/// edges that leave it. Edge k runs along the planes of all generators but the one in slot k.
///
/// Vertices and edges are the tetrahedra and triangles of the dual (Delaunay) complex. A vertex fills one line of the cache.
#[repr(align(64))]
pub(crate) struct TileVertex {
    /// A seed of the tile, and the planes of its cell in positive orientation.
    pub(crate) generators: [Generator; 4],
    /// Relative to the first generator.
    pub(crate) position: DVec3,
    /// The vertex at the other end of each edge; [`NONE`] until it is found.
    pub(crate) ends: [u32; 4],
    /// The next vertex of which the edge between the planes in the last three slots waits for the same seed; [`NONE`] after the last.
    pub(crate) next_waiting: u32,
    /// Whether a fifth plane passes through the vertex, exactly.
    pub(crate) has_tie: bool,
    /// For each two slots a bit: whether the face between the two generators is done.
    pub(crate) done_faces: u8,
}

/// In place of a vertex's number.
pub(crate) const NONE: u32 = u32::MAX;

/// The other slots of a vertex as the generator in one of them sees them: planes in positive orientation.
const SEEN_FROM: [[usize; 3]; 4] = [[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]];

/// `SUCCESSOR[i][j]` comes after slot j, cyclically, as slot i sees it.
const SUCCESSOR: [[usize; 4]; 4] = {
    let mut successor = [[0; 4]; 4];
    let mut i = 0;
    while i < 4 {
        let [a, b, c] = SEEN_FROM[i];
        (successor[i][a], successor[i][b], successor[i][c]) = (b, c, a);
        i += 1;
    }
    successor
};

#[inline]
fn successor(slot: usize, other: usize) -> usize {
    // Spares a check wherever the result is an index.
    SUCCESSOR[slot][other] & 3
}

/// The slots of the two generators of each face.
pub(crate) const FACE_SLOTS: [[usize; 2]; 6] = [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]];

/// The bits of all faces, in the order of [`FACE_SLOTS`].
pub(crate) const ALL_FACES: u8 = 0b11_1111;

/// The bits of the faces of the generator in the first slot.
pub(crate) const FACES_OF_FIRST: u8 = 0b111;

/// The bit of the face of each two slots.
const FACE_BIT: [[u8; 4]; 4] = [[0, 1, 2, 4], [1, 0, 8, 16], [2, 8, 0, 32], [4, 16, 32, 0]];

/// The same of the two slots that are not given.
const FACE_BIT_BESIDE: [[u8; 4]; 4] = [[0, 32, 16, 8], [32, 0, 4, 2], [16, 4, 0, 1], [8, 2, 1, 0]];

impl TileVertex {
    /// The slot of a generator of the vertex.
    #[inline]
    pub(crate) fn slot(&self, generator: Generator) -> usize {
        let [_, b, c, d] = self.generators.map(|own| own == generator);
        debug_assert!(b || c || d || self.generators[0] == generator);
        // At most 3, as the compiler sees.
        usize::from(b | d) | usize::from(c | d) << 1
    }

    /// The planes of the vertex as the cell in a slot sees them, in positive orientation.
    #[inline]
    pub(crate) fn planes(&self, slot: usize) -> [Generator; 3] {
        SEEN_FROM[slot].map(|other| self.generators[other])
    }

    /// The two planes along which an edge runs, in the order in which they come before the next vertex's own plane in
    /// positive orientation, as the cell in `slot` sees it.
    #[inline]
    pub(crate) fn edge_planes(&self, slot: usize, edge: usize) -> [Generator; 2] {
        let from = successor(slot, edge);
        let to = successor(slot, from);
        [self.generators[to], self.generators[from]]
    }

    /// The slot of what lies beyond the edge to this vertex, counter-clockwise as seen from outside the cell in slot `cell`, of that
    /// cell's face with the generator in slot `other`.
    #[inline]
    pub(crate) fn slot_before(cell: usize, other: usize) -> usize {
        successor(cell, other)
    }

    /// The generator of the vertex that is none of three.
    #[inline]
    pub(crate) fn fourth(&self, others: [Generator; 3]) -> Generator {
        let all = self.generators.iter().chain(&others);
        Generator(all.fold(0, |code, generator| code ^ generator.0))
    }

    #[inline]
    pub(crate) fn is_done(&self, i: usize, j: usize) -> bool {
        self.done_faces & FACE_BIT[i][j] != 0
    }

    #[inline]
    pub(crate) fn mark_done(&mut self, i: usize, j: usize) {
        self.done_faces |= FACE_BIT[i][j];
    }

    /// Marks the face between the generators in the other two slots as done.
    #[inline]
    pub(crate) fn mark_done_beside(&mut self, k: usize, l: usize) {
        self.done_faces |= FACE_BIT_BESIDE[k][l];
    }
}
