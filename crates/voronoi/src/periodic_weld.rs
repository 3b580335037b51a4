//! From the cells of a periodic domain to one complex of whole cells.
//!
//! Cells that differ by whole periods are one. A vertex of one cell may so be a vertex of another one moved by a shift:
//! each vertex is first named by its generators moved to where the cell with the smallest number owns it, and by the shift
//! back. What comes out first is the complex of the torus, every face once. Then each face that joins a cell to a moved one
//! gets its copy at the other cell, so that all cells are whole, and copies are told by their originals and a shift.

use glam::DVec3;
use rayon::prelude::*;

use crate::corner::Corner;
use crate::generator::{Generator, Plane, VertexKey};
use crate::images::Image;
use crate::predicate::ExactInput;
use crate::search::Search;
use crate::tessellation::{CellId, FaceId, PeriodicPair, Shift, Side, Tessellation, VertexId};
use crate::tile::Tile;
use crate::torus::{FaceEnd, TorusFaces};
use crate::weld::{cell_measures, list_faces_of_cells, number_vertices, positions, put_vertices_on_walls};
use crate::{Dimension, Domain};

pub(crate) fn weld_periodic(search: &Search, seeds: &[DVec3], tiles: &[Tile]) -> Tessellation {
    let dimension = search.input().domain.dimension();
    let numbers = number_vertices(search.input(), tiles);
    let positions = positions(tiles, &numbers);
    let mut vertices = UnitedVertices::new(positions.len());
    for (tile, numbers) in tiles.iter().zip(&numbers) {
        for [v, w] in &tile.coincident {
            vertices.unite(numbers[*v as usize], numbers[*w as usize]);
        }
    }
    let roots = vertices.roots();
    let faces: Vec<TorusFaces> = tiles
        .par_iter()
        .zip(&numbers)
        .map(|(tile, numbers)| {
            let mut faces = TorusFaces::new(dimension);
            push_faces(&mut faces, search, tile, numbers, &roots);
            faces
        })
        .collect();
    let mut faces = TorusFaces::concatenated(dimension, faces);
    let has_flat_cells = faces.remove_flat_cells(seeds.len());
    let mut tessellation = unwrapped(search.input().domain, seeds, &faces, &positions);
    let are_coincident = tiles.iter().any(|tile| !tile.coincident.is_empty());
    if !are_coincident && !has_flat_cells && dimension == Dimension::Three {
        tessellation.measures = cell_measures(search, seeds, tiles);
    }
    tessellation
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
struct UnitedVertices {
    parents: Vec<Corner>,
}

impl UnitedVertices {
    fn new(count: usize) -> Self {
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

    fn unite(&mut self, v: Corner, w: Corner) {
        let (v, w) = (self.root(v), self.root(w));
        // The smaller number stays, so the result does not depend on the order of the pairs.
        let (kept, joined) = if v.vertex < w.vertex { (v, w) } else { (w, v) };
        if kept.vertex != joined.vertex {
            self.parents[joined.vertex as usize] = Corner { shift: kept.shift - joined.shift, ..kept };
        }
    }

    fn roots(mut self) -> Vec<Corner> {
        let vertices = (0u32..).take(self.parents.len());
        vertices.map(|vertex| self.root(Corner { vertex, shift: Shift::NONE })).collect()
    }
}

/// Adds the faces of a tile, in the user's numbers of cells.
fn push_faces(faces: &mut TorusFaces, search: &Search, tile: &Tile, numbers: &[Corner], roots: &[Corner]) {
    for (ends, corners) in tile.faces() {
        let corners = corners.iter().map(|corner| {
            let Corner { vertex, shift } = numbers[*corner as usize];
            let root = roots[vertex as usize];
            Corner { shift: shift + root.shift, ..root }
        });
        faces.push(ends.map(|generator| search.end(generator)), corners);
    }
}

/// The tessellation with whole cells: of a face between a cell and a moved one, a copy at each.
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
    tessellation.vertices.extend(
        places.originals.iter().map(|original| positions[original.vertex as usize] + period(original.shift)),
    );
    for (copy, original) in places.copies() {
        let shift = copy.moved.shift - places.originals[original.index()].shift;
        let position = tessellation.vertices[original.index()] + period(shift);
        tessellation.vertices.push(position);
        tessellation.periodic_vertices.push(PeriodicPair { secondary: copy.id, primary: original, shift });
    }
    for (ends, corners) in faces.iter() {
        let corners = corners.iter().map(|corner| places.id(*corner));
        tessellation.push_face(ends.map(|end| side(end, Shift::NONE)), corners);
    }
    let primaries: Vec<FaceId> = tessellation.faces().collect();
    for (primary, (ends, corners)) in primaries.into_iter().zip(faces.iter()) {
        let [FaceEnd::Cell(first), FaceEnd::Cell(second)] = ends else { continue };
        if second.shift == Shift::NONE {
            continue;
        }
        let back = Shift::NONE - second.shift;
        let sides = [side(FaceEnd::Cell(second), back), side(FaceEnd::Cell(first), back)];
        let corners = corners.iter().rev();
        let corners = corners.map(|corner| places.id(Corner { shift: corner.shift + back, ..*corner }));
        let secondary = tessellation.push_face(sides, corners);
        tessellation.periodic_faces.push(PeriodicPair { secondary, primary, shift: back });
    }
    put_vertices_on_walls(&mut tessellation);
    list_faces_of_cells(&mut tessellation);
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
        let mut is_used = vec![false; vertex_count];
        let mut moved = Vec::new();
        let mut note = |corner: Corner| match corner.shift {
            Shift::NONE => is_used[corner.vertex as usize] = true,
            _ => moved.push(corner),
        };
        for (ends, corners) in faces.iter() {
            corners.iter().for_each(|corner| note(*corner));
            if let FaceEnd::Cell(Image { shift, .. }) = ends[1]
                && shift != Shift::NONE
            {
                corners.iter().for_each(|corner| note(Corner { shift: corner.shift - shift, ..*corner }));
            }
        }
        moved.sort_unstable();
        moved.dedup();
        let mut places =
            Self { originals: Vec::new(), original_of: Vec::with_capacity(vertex_count), moved: Vec::new() };
        let id = |count: usize| VertexId(u32::try_from(count).expect("vertex ids fit 32 bits"));
        for (vertex, is_used) in (0u32..).zip(&is_used) {
            let unmoved = Corner { vertex, shift: Shift::NONE };
            let first = moved.partition_point(|at| at.vertex < vertex);
            let original = if *is_used {
                Some(unmoved)
            } else {
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
