//! From the cells of a periodic domain to one complex of whole cells.
//!
//! Cells that differ by whole periods are one. A vertex of one cell may so be a vertex of another one moved by a shift:
//! each vertex is first named by its generators moved to where the cell with the smallest number owns it, and by the shift
//! back. What comes out first is the complex of the torus, every face once. Then each face that joins a cell to a moved one
//! gets its copy at the other cell, so that all cells are whole, and copies are told by their originals and a shift.

use std::sync::atomic::{AtomicBool, Ordering};

use glam::DVec3;
use rayon::prelude::*;

use crate::corner::Corner;
use crate::generator::{Generator, Plane, VertexKey};
use crate::images::Image;
use crate::measure::CellSum;
use crate::predicate::ExactInput;
use crate::search::Search;
use crate::tessellation::{CellId, FaceId, PeriodicPair, Shift, Side, Tessellation, VertexId};
use crate::tile::Tile;
use crate::torus::{FaceEnd, TorusFaces};
use crate::weld::{CellSums, VertexNumbers, measures, push_positions, put_vertices_on_walls};
use crate::{Dimension, Domain};

pub(crate) fn weld_periodic(search: &Search, seeds: &[DVec3], mut tiles: Vec<Tile>) -> Tessellation {
    let dimension = search.input().domain.dimension();
    let mut numbers = VertexNumbers::new(search.input()).of_tiles(&tiles);
    let mut positions = Vec::with_capacity(tiles.iter().map(|tile| tile.positions.len()).sum());
    tiles.iter().zip(&numbers).for_each(|(tile, numbers)| push_positions(&mut positions, tile, numbers));
    let are_coincident = tiles.iter().any(|tile| !tile.coincident.is_empty());
    if are_coincident {
        let roots = unite_coincident(positions.len(), &tiles, &numbers);
        tiles.par_iter_mut().zip(&mut numbers).for_each(|(tile, numbers)| {
            for corner in &mut *numbers {
                let root = roots[corner.vertex as usize];
                *corner = Corner { shift: corner.shift + root.shift, ..root };
            }
            tile.drop_repeated_corners(|corner| numbers[corner as usize], dimension.fewest_corners());
        });
    }
    let mut faces = TorusFaces::of_tiles(search, &tiles, &numbers);
    if are_coincident {
        // Both faces of a flat cell have the same corners.
        faces.remove_flat_cells(seeds.len());
    }
    let places = search.places();
    let mut tessellation = unwrapped(search.input().domain, seeds, &faces, &positions);
    let mut face_counts = None;
    if !are_coincident && dimension == Dimension::Three {
        let mut sums = CellSums::new(seeds.len());
        tiles.iter().for_each(|tile| sums.push_tile(tile));
        let sums = sums.whole();
        tessellation.measures = measures(&sums, &places, seeds);
        face_counts = Some(sums.iter().map(CellSum::face_count).collect());
    }
    tessellation.list_faces_of_cells(&places, face_counts);
    tessellation
}

/// Unites vertices that are one point: of each, the one that stands for it.
fn unite_coincident(count: usize, tiles: &[Tile], numbers: &[Vec<Corner>]) -> Vec<Corner> {
    let mut vertices = UnitedVertices::new(count);
    for (tile, numbers) in tiles.iter().zip(numbers) {
        for [v, w] in &tile.coincident {
            vertices.unite(numbers[*v as usize], numbers[*w as usize]);
        }
    }
    vertices.roots()
}

/// The generators of a vertex, all moved by whole periods to where the cell of the smallest number among them owns it, and
/// the shift from there back. Where that cell meets the vertex in several places, the smallest list of generators tells.
pub(crate) fn canonical(input: ExactInput, key: &VertexKey) -> (VertexKey, Shift) {
    let first_image =
        Generator::site(u32::try_from(input.seeds.len()).expect("site ids were checked to fit"));
    let is_image = |generator: &Generator| *generator >= first_image && generator.as_site().is_some();
    if !key.iter().any(is_image) {
        return (*key, Shift::NONE);
    }
    let planes = key.map(Generator::plane);
    let images = planes.map(|plane| match plane {
        Plane::Site(site) => Some(input.image(site)),
        Plane::Side(_) | Plane::Facet(_) => None,
    });
    let smallest = images.iter().flatten().map(|image| image.seed).min();
    let candidates = images.iter().flatten().filter(|image| Some(image.seed) == smallest);
    let moved = candidates.map(|owner| {
        let mut moved =
            images.map(|image| image.map(|Image { seed, shift }| Image { seed, shift: shift - owner.shift }));
        moved.sort_unstable();
        (moved, owner.shift)
    });
    let (moved, shift) = moved.min().expect("every vertex belongs to a cell");
    let mut sites =
        moved.iter().flatten().map(|image| input.site(*image).expect("the owner was cut by these sites"));
    let mut owned = planes.map(|plane| match plane {
        Plane::Site(_) => Generator::site(sites.next().expect("as many sites as before")),
        Plane::Side(wall) => Generator::side(wall),
        Plane::Facet(wall) => Generator::facet(wall),
    });
    owned.sort_unstable();
    (owned, shift)
}

/// Vertices of the torus joined where exact ties made them one point: a forest in which each knows its parent and how it
/// is moved relative to it.
pub(crate) struct UnitedVertices {
    parents: Vec<Corner>,
}

impl UnitedVertices {
    pub(crate) fn new(count: usize) -> Self {
        let parents = (0u32..).take(count).map(|vertex| Corner { vertex, shift: Shift::NONE });
        Self { parents: parents.collect() }
    }

    fn root(&mut self, of: Corner) -> Corner {
        let mut at = of;
        loop {
            let parent = self.parents[at.vertex as usize];
            if parent.vertex == at.vertex {
                return at;
            }
            let grandparent = self.parents[parent.vertex as usize];
            let skipped = Corner { shift: parent.shift + grandparent.shift, ..grandparent };
            self.parents[at.vertex as usize] = skipped;
            at = Corner { shift: at.shift + skipped.shift, ..skipped };
        }
    }

    pub(crate) fn unite(&mut self, v: Corner, w: Corner) {
        let (v, w) = (self.root(v), self.root(w));
        // The smaller number stays, so the result does not depend on the order of the pairs.
        let (kept, joined) = if v.vertex < w.vertex { (v, w) } else { (w, v) };
        if kept.vertex != joined.vertex {
            self.parents[joined.vertex as usize] = Corner { shift: kept.shift - joined.shift, ..kept };
        }
    }

    pub(crate) fn roots(mut self) -> Vec<Corner> {
        let vertices = (0u32..).take(self.parents.len());
        vertices.map(|vertex| self.root(Corner { vertex, shift: Shift::NONE })).collect()
    }
}

/// The tessellation with whole cells, their faces not listed yet: of a face between a cell and a moved one, a copy at each.
pub(crate) fn unwrapped(
    domain: &Domain,
    seeds: &[DVec3],
    faces: &TorusFaces,
    positions: &[DVec3],
) -> Tessellation {
    let places = VertexPlaces::new(faces, positions.len());
    let vertices = Vec::with_capacity(places.count());
    let mut tessellation = Tessellation::without_faces(domain, seeds, vertices);
    let period = |shift: Shift| shift.vector(domain);
    let moved = |original: &Corner| positions[original.vertex as usize] + period(original.shift);
    tessellation.vertices.par_extend(places.originals.par_iter().map(moved));
    for (copy, original) in places.copies() {
        let shift = copy.moved.shift - places.originals[original.index()].shift;
        let position = tessellation.vertices[original.index()] + period(shift);
        tessellation.vertices.push(position);
        tessellation.periodic_vertices.push(PeriodicPair { secondary: copy.id, primary: original, shift });
    }
    // Faces that join a cell to a moved one, by the shift back.
    let copied: Vec<(u32, Shift)> = (0u32..)
        .zip(faces.ends())
        .filter_map(|(face, ends)| match ends[1] {
            FaceEnd::Cell(Image { shift, .. }) if shift != Shift::NONE => Some((face, Shift::NONE - shift)),
            _ => None,
        })
        .collect();
    let corners_of =
        |face: u32| &faces.corners()[faces.starts()[face as usize]..faces.starts()[face as usize + 1]];
    let copied_corners: Vec<VertexId> = copied
        .par_iter()
        .flat_map_iter(|(face, back)| {
            let moved = move |corner: &Corner| Corner { shift: corner.shift + *back, ..*corner };
            corners_of(*face).iter().rev().map(moved).map(|corner| places.id(corner))
        })
        .collect();
    let face_count = faces.ends().len() + copied.len();
    tessellation.face_sides.reserve_exact(face_count);
    tessellation.face_starts.reserve_exact(face_count);
    tessellation.face_corners.reserve_exact(faces.corners().len() + copied_corners.len());
    let sides = |ends: [FaceEnd; 2], shift: Shift| ends.map(|end| side(end, shift));
    tessellation.face_sides.par_extend(faces.ends().par_iter().map(|ends| sides(*ends, Shift::NONE)));
    tessellation.face_starts.par_extend(&faces.starts()[1..]);
    tessellation.face_corners.par_extend(faces.corners().par_iter().map(|corner| places.id(*corner)));
    let mut copied_corners = &copied_corners[..];
    for (face, back) in copied {
        let [first, second] = faces.ends()[face as usize];
        let (corners, rest) = copied_corners.split_at(corners_of(face).len());
        copied_corners = rest;
        let secondary = tessellation.push_face(sides([second, first], back), corners.iter().copied());
        tessellation.periodic_faces.push(PeriodicPair { secondary, primary: FaceId(face), shift: back });
    }
    put_vertices_on_walls(&mut tessellation);
    tessellation
}

/// What lies on a side of a face that is moved by `shift`.
pub(crate) fn side(end: FaceEnd, shift: Shift) -> Side {
    match end {
        FaceEnd::Cell(image) => match image.shift + shift {
            Shift::NONE => Side::Cell(CellId(image.seed)),
            shift => Side::Image(CellId(image.seed), shift),
        },
        FaceEnd::Wall(wall) => Side::Wall(wall),
    }
}

/// Numbers of all places at which the whole cells have vertices: first an original of each vertex of the torus, where it
/// is not moved if there is a cell there, then the copies.
struct VertexPlaces {
    originals: Vec<Corner>,
    /// Of each vertex of the torus, its original.
    original_of: Vec<VertexId>,
    /// All places but those of unmoved originals, sorted, with their ids.
    moved: Vec<NumberedVertex>,
}

#[derive(Clone, Copy)]
struct NumberedVertex {
    moved: Corner,
    id: VertexId,
}

impl VertexPlaces {
    fn new(faces: &TorusFaces, vertex_count: usize) -> Self {
        let is_used: Vec<AtomicBool> = (0..vertex_count).map(|_| AtomicBool::new(false)).collect();
        // Of a corner, what there is to note: where it is not moved, that it is used.
        let note = |corner: Corner| match corner.shift {
            Shift::NONE => {
                is_used[corner.vertex as usize].store(true, Ordering::Relaxed);
                None
            }
            _ => Some(corner),
        };
        let moved = faces.par_iter().flat_map_iter(|(ends, corners)| {
            let back = match ends[1] {
                FaceEnd::Cell(Image { shift, .. }) if shift != Shift::NONE => Some(Shift::NONE - shift),
                _ => None,
            };
            let copies = back.into_iter().flat_map(move |back| {
                corners.iter().map(move |corner| Corner { shift: corner.shift + back, ..*corner })
            });
            corners.iter().copied().chain(copies).filter_map(note)
        });
        let mut moved: Vec<Corner> = moved.collect();
        moved.par_sort_unstable();
        moved.dedup();
        let mut places = Self {
            originals: Vec::with_capacity(vertex_count),
            original_of: Vec::with_capacity(vertex_count),
            moved: Vec::new(),
        };
        let id = |count: usize| VertexId(u32::try_from(count).expect("vertex ids fit 32 bits"));
        for (vertex, is_used) in (0u32..).zip(is_used) {
            let original = if is_used.into_inner() {
                Some(Corner { vertex, shift: Shift::NONE })
            } else {
                let first = moved.partition_point(|at| at.vertex < vertex);
                moved.get(first).copied().filter(|at| at.vertex == vertex)
            };
            places.original_of.push(id(places.originals.len()));
            places.originals.extend(original);
        }
        let mut next = places.originals.len();
        for moved in moved {
            let original = places.original_of[moved.vertex as usize];
            if places.originals[original.index()] == moved {
                places.moved.push(NumberedVertex { moved, id: original });
            } else {
                places.moved.push(NumberedVertex { moved, id: id(next) });
                next += 1;
            }
        }
        places
    }

    fn count(&self) -> usize {
        self.originals.len() + self.copies().count()
    }

    /// The copies in order of id, and their originals.
    fn copies(&self) -> impl Iterator<Item = (NumberedVertex, VertexId)> {
        let with_original = self.moved.iter().map(|at| (*at, self.original_of[at.moved.vertex as usize]));
        with_original.filter(|(at, original)| at.id != *original)
    }

    fn id(&self, at: Corner) -> VertexId {
        if at.shift == Shift::NONE {
            return self.original_of[at.vertex as usize];
        }
        let place = self.moved.binary_search_by_key(&at, |known| known.moved);
        self.moved[place.expect("all corners were numbered")].id
    }
}
