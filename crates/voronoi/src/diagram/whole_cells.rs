//! Whole cells from the complex of the torus.
//!
//! Each face that joins a cell to a moved one gets its copy at the other cell, so that all cells are whole, and copies are told by
//! their originals and a translation.

use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};

use glam::DVec3;
use rayon::prelude::*;

use crate::diagram::torus::TorusFaces;
use crate::exact::face_end::FaceEnd;
use crate::exact::image::Image;
use crate::{Domain, FaceId, PeriodicPair, PeriodicVertex, Side, Tessellation, Translation, VertexId};

/// The tessellation with whole cells, their faces not listed yet: of a face between a cell and a moved one, a copy at each.
pub(crate) fn unwrapped(
    domain: &Domain,
    seeds: &[DVec3],
    faces: &TorusFaces,
    positions: &[DVec3],
) -> Tessellation {
    with_numbering(domain, seeds, faces, positions).0
}

impl Tessellation {
    /// Whole cells from a complex that has each vertex and face once, also in a periodic domain, and the vertex of that which each of
    /// theirs is. Vertices and faces keep their order; vertices without faces are left out. Faces may be told from either side, and moved by
    /// whole periods, with corners around them as in [`Self::face_corners`]; equal corners that follow one another are one, and faces that
    /// shrink to lines or points by that are left out.
    ///
    /// Cells need not be convex, nor faces plane.
    pub fn of_whole_cells<Corners: IntoIterator<Item = PeriodicVertex>>(
        domain: &Domain,
        seeds: &[DVec3],
        positions: &[DVec3],
        faces: impl IntoIterator<Item = ([Side; 2], Corners)>,
    ) -> (Self, Vec<PeriodicVertex>) {
        let mut of_torus = TorusFaces::new(domain.dimension());
        for (sides, corners) in faces {
            let corners = corners.into_iter();
            of_torus.push_in_order(sides.map(Side::end), corners);
        }
        let (mut tessellation, numbering) = with_numbering(domain, seeds, &of_torus, positions);
        tessellation.list_faces_of_cells_in_order();
        (tessellation, numbering.all())
    }
}

fn with_numbering(
    domain: &Domain,
    seeds: &[DVec3],
    faces: &TorusFaces,
    positions: &[DVec3],
) -> (Tessellation, VertexNumbering) {
    let numbering = VertexNumbering::new(faces, positions.len());
    let vertices = Vec::with_capacity(numbering.count());
    let mut tessellation = Tessellation::without_faces(domain, seeds, vertices);
    let period = |translation: Translation| translation.vector(domain);
    let moved =
        |original: &PeriodicVertex| positions[original.vertex as usize] + period(original.translation);
    tessellation.vertices.par_extend(numbering.originals.par_iter().map(moved));
    for (copy, original) in numbering.copies() {
        let translation = copy.moved.translation - numbering.originals[original.index()].translation;
        let position = tessellation.vertices[original.index()] + period(translation);
        tessellation.vertices.push(position);
        tessellation.periodic_vertices.push(PeriodicPair {
            secondary: copy.id,
            primary: original,
            translation,
        });
    }
    // Faces that join a cell to a moved one, by the translation back.
    let copied: Vec<(u32, Translation)> = (0u32..)
        .zip(faces.ends())
        .filter_map(|(face, ends)| match ends[1] {
            FaceEnd::Cell(Image { translation, .. }) if translation != Translation::ZERO => {
                Some((face, Translation::ZERO - translation))
            }
            _ => None,
        })
        .collect();
    let corners_of =
        |face: u32| &faces.corners()[faces.starts()[face as usize]..faces.starts()[face as usize + 1]];
    let copied_corners: Vec<VertexId> = copied
        .par_iter()
        .flat_map_iter(|(face, back)| {
            let moved = move |corner: &PeriodicVertex| corner.moved(*back);
            corners_of(*face).iter().rev().map(moved).map(|corner| numbering.id(corner))
        })
        .collect();
    let face_count = faces.ends().len() + copied.len();
    tessellation.face_sides.reserve_exact(face_count);
    tessellation.face_starts.reserve_exact(face_count);
    tessellation.face_corners.reserve_exact(faces.corners().len() + copied_corners.len());
    let sides = |ends: [FaceEnd; 2], translation: Translation| ends.map(|end| Side::of(end, translation));
    tessellation.face_sides.par_extend(faces.ends().par_iter().map(|ends| sides(*ends, Translation::ZERO)));
    tessellation.face_starts.par_extend(&faces.starts()[1..]);
    tessellation.face_corners.par_extend(faces.corners().par_iter().map(|corner| numbering.id(*corner)));
    let mut copied_corners = &copied_corners[..];
    for (face, back) in copied {
        let [first, second] = faces.ends()[face as usize];
        let (corners, rest) = copied_corners.split_at(corners_of(face).len());
        copied_corners = rest;
        let secondary = tessellation.push_face(sides([second, first], back), corners.iter().copied());
        tessellation.periodic_faces.push(PeriodicPair {
            secondary,
            primary: FaceId(face),
            translation: back,
        });
    }
    tessellation.put_vertices_on_walls();
    (tessellation, numbering)
}

/// Numbers of the vertices of whole cells: first an original of each vertex of the torus, where it
/// is not moved if there is a cell there, then the copies.
struct VertexNumbering {
    originals: Vec<PeriodicVertex>,
    /// Of each vertex of the torus, its original.
    original_of: Vec<VertexId>,
    /// All but unmoved originals, sorted, with their ids.
    moved: Vec<NumberedVertex>,
    /// Those of vertex v of the torus are `moved[moved_starts[v]..moved_starts[v + 1]]`.
    moved_starts: Vec<u32>,
}

#[derive(Clone, Copy)]
struct NumberedVertex {
    moved: PeriodicVertex,
    id: VertexId,
}

impl VertexNumbering {
    fn new(faces: &TorusFaces, vertex_count: usize) -> Self {
        let is_used: Vec<AtomicBool> = (0..vertex_count).map(|_| AtomicBool::new(false)).collect();
        // Of a corner, what there is to note: where it is not moved, that it is used.
        let note = |corner: PeriodicVertex, moved: &mut Vec<PeriodicVertex>| match corner.translation {
            Translation::ZERO => {
                let is_used = &is_used[corner.vertex as usize];
                // Most are noted already; only to read leaves memory shared among threads.
                if !is_used.load(Ordering::Relaxed) {
                    is_used.store(true, Ordering::Relaxed);
                }
            }
            _ => moved.push(corner),
        };
        let with_moved = |mut moved: Vec<PeriodicVertex>,
                          (ends, corners): ([FaceEnd; 2], &[PeriodicVertex])| {
            corners.iter().for_each(|corner| note(*corner, &mut moved));
            let back = Translation::ZERO - ends[1].translation();
            if back != Translation::ZERO {
                corners.iter().for_each(|corner| note(corner.moved(back), &mut moved));
            }
            moved
        };
        let parts: Vec<Vec<PeriodicVertex>> = faces.par_iter().fold(Vec::new, with_moved).collect();
        let mut moved = parts.concat();
        moved.par_sort_unstable();
        moved.dedup();
        let mut numbering = Self {
            originals: Vec::with_capacity(vertex_count),
            original_of: Vec::with_capacity(vertex_count),
            moved: Vec::with_capacity(moved.len()),
            moved_starts: starts_by_vertex(&moved, vertex_count),
        };
        let id = |count: usize| VertexId(u32::try_from(count).expect("vertex ids fit 32 bits"));
        for (vertex, is_used) in (0u32..).zip(is_used) {
            let original = if is_used.into_inner() {
                Some(PeriodicVertex { vertex, translation: Translation::ZERO })
            } else {
                moved[numbering.moved_range(vertex)].first().copied()
            };
            numbering.original_of.push(id(numbering.originals.len()));
            numbering.originals.extend(original);
        }
        let mut next = numbering.originals.len();
        for moved in moved {
            let original = numbering.original_of[moved.vertex as usize];
            if numbering.originals[original.index()] == moved {
                numbering.moved.push(NumberedVertex { moved, id: original });
            } else {
                numbering.moved.push(NumberedVertex { moved, id: id(next) });
                next += 1;
            }
        }
        numbering
    }

    fn count(&self) -> usize {
        self.originals.len() + self.copies().count()
    }

    /// The copies in order of id, and their originals.
    fn copies(&self) -> impl Iterator<Item = (NumberedVertex, VertexId)> {
        let with_original = self.moved.iter().map(|at| (*at, self.original_of[at.moved.vertex as usize]));
        with_original.filter(|(at, original)| at.id != *original)
    }

    /// The vertices of the torus, and their copies, in order of id.
    fn all(&self) -> Vec<PeriodicVertex> {
        self.originals.iter().copied().chain(self.copies().map(|(copy, _)| copy.moved)).collect()
    }

    fn id(&self, at: PeriodicVertex) -> VertexId {
        if at.translation == Translation::ZERO {
            return self.original_of[at.vertex as usize];
        }
        let mut places = self.moved[self.moved_range(at.vertex)].iter();
        places.find(|known| known.moved == at).expect("all corners were numbered").id
    }

    /// Where those of a vertex of the torus stand among all that are moved.
    fn moved_range(&self, vertex: u32) -> Range<usize> {
        let vertex = vertex as usize;
        self.moved_starts[vertex] as usize..self.moved_starts[vertex + 1] as usize
    }
}

/// Where the entries of each vertex start among all, which are sorted, and after the last vertex their number.
fn starts_by_vertex(sorted: &[PeriodicVertex], vertex_count: usize) -> Vec<u32> {
    let mut starts = vec![0; vertex_count + 1];
    for at in sorted {
        starts[at.vertex as usize + 1] += 1;
    }
    for vertex in 0..vertex_count {
        starts[vertex + 1] += starts[vertex];
    }
    starts
}
