//! Power cells without volume that still have two faces.
//!
//! With the right weights the bisectors of a seed with two others, one on either side, are one and the same plane: the
//! seed's cell is then a polygon. Symbolically it has a thickness; once coincident vertices are united its two faces have the
//! same corners, and the cells beyond them touch each other. (In the plane: a segment with two edges.)

use crate::{CellId, FaceId, Side, Tessellation};

/// Takes flat cells out, so that their two neighbours share one face. True if there were any.
pub(crate) fn remove_flat_cells(tessellation: &mut Tessellation) -> bool {
    let fewest_faces = tessellation.domain.dimension().fewest_faces();
    let cells = (0u32..).take(tessellation.cell_count()).map(CellId);
    let is_flat = |cell: &CellId| (1..fewest_faces).contains(&tessellation.cell_faces(*cell).len());
    let flat: Vec<CellId> = cells.filter(is_flat).collect();
    if flat.is_empty() {
        return false;
    }
    // Where a face went: a stack of flat cells joins faces one after the other.
    let mut joined_to: Vec<FaceId> = tessellation.faces().collect();
    for cell in &flat {
        let &[kept, dropped] = tessellation.cell_faces(*cell) else {
            unreachable!("what a flat cell has beside its two faces has shrunk to lines")
        };
        let (kept, dropped) = (end(&joined_to, kept), end(&joined_to, dropped));
        let own = Side::Cell(*cell);
        let [a, b] = tessellation.face_sides[dropped.index()];
        let beyond = if a == own { b } else { a };
        let sides = &mut tessellation.face_sides[kept.index()];
        let place = usize::from(sides[1] == own);
        sides[place] = beyond;
        if sides[1] < sides[0] {
            sides.swap(0, 1);
            let corners = tessellation.face_starts[kept.index()]..tessellation.face_starts[kept.index() + 1];
            tessellation.face_corners[corners].reverse();
        }
        joined_to[dropped.index()] = kept;
    }
    keep_faces(tessellation, |face| joined_to[face.index()] == face);
    true
}

fn end(joined_to: &[FaceId], mut face: FaceId) -> FaceId {
    while joined_to[face.index()] != face {
        face = joined_to[face.index()];
    }
    face
}

fn keep_faces(tessellation: &mut Tessellation, keep: impl Fn(FaceId) -> bool) {
    let (mut sides, mut starts, mut corners) = (Vec::new(), vec![0], Vec::new());
    for face in tessellation.faces().filter(|face| keep(*face)) {
        sides.push(tessellation.face_sides(face));
        corners.extend_from_slice(tessellation.face_corners(face));
        starts.push(corners.len());
    }
    tessellation.face_sides = sides;
    tessellation.face_starts = starts;
    tessellation.face_corners = corners;
}
