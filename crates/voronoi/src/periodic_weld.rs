//! From the cells of a periodic domain to one complex of whole cells.
//!
//! Cells that differ by whole periods are one. A vertex of one cell may so be a vertex of another one moved by a shift:
//! each vertex is first named by its generators moved to where the cell with the smallest number owns it, and by the shift
//! back. What comes out first is the complex of the torus, every face once. Then each face that joins a cell to a moved one
//! gets its copy at the other cell, so that all cells are whole, and copies are told by their originals and a shift.

use glam::DVec3;
use rayon::prelude::*;

use crate::batch::{CellBatch, CellView};
use crate::generator::{Generator, Plane, VertexKey};
use crate::images::Image;
use crate::predicate::ExactInput;
use crate::tessellation::{CellId, FaceId, PeriodicPair, Shift, Side, Tessellation, VertexId};
use crate::torus::{FaceEnd, MovedVertex, TorusFaces};
use crate::weld::{list_faces_of_cells, put_vertices_on_walls};

pub(crate) fn weld_periodic(input: ExactInput, batches: &[CellBatch]) -> Tessellation {
    let owned = OwnedVertices::new(input, batches);
    let mut vertices = UnitedVertices::new(owned.keys.len());
    let moved: Vec<Vec<MovedVertex>> = batches
        .par_iter()
        .map(|batch| {
            let of_cell = |cell: usize| batch.cell(cell).keys.iter().map(|key| owned.find(input, key));
            (0..batch.cell_count()).flat_map(of_cell).collect()
        })
        .collect();
    for (batch, moved) in batches.iter().zip(&moved) {
        for [v, w] in &batch.coincident {
            vertices.unite(moved[*v], moved[*w]);
        }
    }
    let roots = vertices.roots();
    let batch_size = batches.first().map_or(1, CellBatch::cell_count);
    let faces: Vec<TorusFaces> = (0..batches.len())
        .into_par_iter()
        .map(|b| {
            let mut faces = TorusFaces::new(input.domain.dimension());
            for cell in 0..batches[b].cell_count() {
                let view = batches[b].cell(cell);
                let corners = &moved[b][view.first_vertex..];
                push_owned_faces(&mut faces, input, &view, b * batch_size + cell, corners, &roots);
            }
            faces
        })
        .collect();
    drop(moved);
    let mut faces = TorusFaces::concatenated(input.domain.dimension(), faces);
    faces.remove_flat_cells(input.seeds.len());
    unwrapped(input, &faces, &owned.positions(batches))
}

/// The vertices of the torus in the order of the cells that own them: all their generators, none moved by less than they
/// are in the owner's own list.
struct OwnedVertices {
    /// The keys that cell c owns are `keys[starts[c]..starts[c + 1]]`, sorted.
    starts: Vec<u32>,
    keys: Vec<VertexKey>,
    /// Place of each among the cell's vertices.
    places: Vec<u32>,
}

impl OwnedVertices {
    fn new(input: ExactInput, batches: &[CellBatch]) -> Self {
        let mut owned = Self { starts: vec![0], keys: Vec::new(), places: Vec::new() };
        let mut own = 0u32;
        let id = |count: usize| u32::try_from(count).expect("vertex ids fit 32 bits");
        for batch in batches {
            for cell in 0..batch.cell_count() {
                let view = batch.cell(cell);
                for (place, key) in view.keys.iter().enumerate() {
                    if canonical(input, key) == (*key, Shift::NONE) && key[0] == Generator::site(own) {
                        owned.keys.push(*key);
                        owned.places.push(id(place));
                    }
                }
                owned.starts.push(id(owned.keys.len()));
                own += 1;
            }
        }
        owned
    }

    /// The vertex of a cell as an owned vertex and how it is moved.
    fn find(&self, input: ExactInput, key: &VertexKey) -> MovedVertex {
        let (key, shift) = canonical(input, key);
        let owner = key[0].as_site().expect("every vertex belongs to a cell") as usize;
        let (first, end) = (self.starts[owner], self.starts[owner + 1]);
        let place = self.keys[first as usize..end as usize].binary_search(&key);
        let place = place.expect("exact decisions give every cell the same vertices");
        MovedVertex { vertex: first + u32::try_from(place).expect("vertex ids fit 32 bits"), shift }
    }

    fn positions(&self, batches: &[CellBatch]) -> Vec<DVec3> {
        let batch_size = batches.first().map_or(1, CellBatch::cell_count);
        let cells = self.starts.windows(2).enumerate();
        let of_cell = cells.flat_map(|(cell, range)| {
            let positions = batches[cell / batch_size].cell(cell % batch_size).positions;
            self.places[range[0] as usize..range[1] as usize].iter().map(|place| positions[*place as usize])
        });
        of_cell.collect()
    }
}

/// The generators of a vertex, all moved by whole periods to where the cell of the smallest number among them owns it, and
/// the shift from there back. Where that cell meets the vertex in several places, the smallest list of generators tells.
fn canonical(input: ExactInput, key: &VertexKey) -> (VertexKey, Shift) {
    let first_image =
        Generator::site(u32::try_from(input.seeds.len()).expect("site ids were checked to fit"));
    let is_image = |generator: &Generator| *generator >= first_image && generator.as_site().is_some();
    if !key.iter().any(is_image) {
        return (*key, Shift::NONE);
    }
    let planes = key.map(Generator::plane);
    let images = planes.map(|plane| match plane {
        Plane::Site(site) => Some(input.image(site)),
        Plane::Wall(_) => None,
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
        Plane::Wall(wall) => Generator::wall(wall),
    });
    owned.sort_unstable();
    (owned, shift)
}

/// Vertices of the torus joined where exact ties made them one point: a forest in which each knows its parent and how it
/// is moved relative to it.
struct UnitedVertices {
    parents: Vec<MovedVertex>,
}

impl UnitedVertices {
    fn new(count: usize) -> Self {
        let parents = (0u32..).take(count).map(|vertex| MovedVertex { vertex, shift: Shift::NONE });
        Self { parents: parents.collect() }
    }

    fn root(&mut self, of: MovedVertex) -> MovedVertex {
        let mut at = of;
        loop {
            let parent = self.parents[at.vertex as usize];
            if parent.vertex == at.vertex {
                return at;
            }
            let grandparent = self.parents[parent.vertex as usize];
            let skipped = MovedVertex { shift: parent.shift + grandparent.shift, ..grandparent };
            self.parents[at.vertex as usize] = skipped;
            at = MovedVertex { shift: at.shift + skipped.shift, ..skipped };
        }
    }

    fn unite(&mut self, v: MovedVertex, w: MovedVertex) {
        let (v, w) = (self.root(v), self.root(w));
        // The smaller number stays, so the result does not depend on the order of the pairs.
        let (kept, joined) = if v.vertex < w.vertex { (v, w) } else { (w, v) };
        if kept.vertex != joined.vertex {
            self.parents[joined.vertex as usize] = MovedVertex { shift: kept.shift - joined.shift, ..kept };
        }
    }

    fn roots(mut self) -> Vec<MovedVertex> {
        let vertices = (0u32..).take(self.parents.len());
        vertices.map(|vertex| self.root(MovedVertex { vertex, shift: Shift::NONE })).collect()
    }
}

/// Adds the faces of a cell towards greater cells, its own images in the positive direction, and walls.
fn push_owned_faces(
    faces: &mut TorusFaces,
    input: ExactInput,
    view: &CellView,
    cell: usize,
    moved: &[MovedVertex],
    roots: &[MovedVertex],
) {
    let own =
        FaceEnd::Cell(Image { seed: u32::try_from(cell).expect("cell ids fit 32 bits"), shift: Shift::NONE });
    for (generator, corners) in view.faces() {
        let beyond = match generator.plane() {
            Plane::Site(site) => FaceEnd::Cell(input.image(site)),
            Plane::Wall(wall) => FaceEnd::Wall(wall),
        };
        if beyond > own {
            let corners = corners.iter().map(|corner| {
                let MovedVertex { vertex, shift } = moved[*corner as usize];
                let root = roots[vertex as usize];
                MovedVertex { shift: shift + root.shift, ..root }
            });
            faces.push([own, beyond], corners);
        }
    }
}

/// The tessellation with whole cells: of a face between a cell and a moved one, a copy at each.
fn unwrapped(input: ExactInput, faces: &TorusFaces, positions: &[DVec3]) -> Tessellation {
    let places = VertexPlaces::new(faces, positions.len());
    let mut tessellation = Tessellation {
        domain: *input.domain,
        seeds: input.seeds.to_vec(),
        vertices: Vec::with_capacity(places.count()),
        face_sides: Vec::new(),
        face_starts: vec![0],
        face_corners: Vec::new(),
        cell_starts: Vec::new(),
        cell_faces: Vec::new(),
        periodic_vertices: Vec::new(),
        periodic_faces: Vec::new(),
    };
    let period = |shift: Shift| shift.vector(input.domain);
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
        let corners = corners.map(|corner| places.id(MovedVertex { shift: corner.shift + back, ..*corner }));
        let secondary = tessellation.push_face(sides, corners);
        tessellation.periodic_faces.push(PeriodicPair { secondary, primary, shift: back });
    }
    put_vertices_on_walls(&mut tessellation);
    list_faces_of_cells(&mut tessellation);
    tessellation
}

fn side(end: FaceEnd, shift: Shift) -> Side {
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
    originals: Vec<MovedVertex>,
    /// Of each vertex of the torus, its original.
    original_of: Vec<VertexId>,
    /// All places but those of unmoved originals, sorted, with their ids.
    moved: Vec<NumberedVertex>,
}

#[derive(Clone, Copy)]
struct NumberedVertex {
    moved: MovedVertex,
    id: VertexId,
}

impl VertexPlaces {
    fn new(faces: &TorusFaces, vertex_count: usize) -> Self {
        let mut is_used = vec![false; vertex_count];
        let mut moved = Vec::new();
        let mut note = |corner: MovedVertex| match corner.shift {
            Shift::NONE => is_used[corner.vertex as usize] = true,
            _ => moved.push(corner),
        };
        for (ends, corners) in faces.iter() {
            corners.iter().for_each(|corner| note(*corner));
            if let FaceEnd::Cell(Image { shift, .. }) = ends[1]
                && shift != Shift::NONE
            {
                corners
                    .iter()
                    .for_each(|corner| note(MovedVertex { shift: corner.shift - shift, ..*corner }));
            }
        }
        moved.sort_unstable();
        moved.dedup();
        let mut places =
            Self { originals: Vec::new(), original_of: Vec::with_capacity(vertex_count), moved: Vec::new() };
        let id = |count: usize| VertexId(u32::try_from(count).expect("vertex ids fit 32 bits"));
        for (vertex, is_used) in (0u32..).zip(&is_used) {
            let unmoved = MovedVertex { vertex, shift: Shift::NONE };
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

    fn id(&self, at: MovedVertex) -> VertexId {
        if at.shift == Shift::NONE {
            return self.original_of[at.vertex as usize];
        }
        let place = self.moved.binary_search_by_key(&at, |known| known.moved);
        self.moved[place.expect("all corners were numbered")].id
    }
}
