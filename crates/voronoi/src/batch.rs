//! Cells as they come from the cutters: each with vertices of its own, named by the generators that meet there.

use std::ops::Range;

use glam::DVec3;
use rayon::prelude::*;

use crate::convex_cell::ConvexCell;
use crate::generator::{Generator, VertexKey, vertex_key};
use crate::predicate::ExactInput;
use crate::search::Search;

/// Cells that one task cuts: enough to spread the cost of its buffers, few enough to share the work evenly.
const BATCH: usize = 256;

/// Distance of two vertices, relative to their distance from the seed, beyond which they cannot coincide: far above
/// the 1e-13 to which coordinates are known, so that only true candidates go to exact arithmetic.
const POSSIBLY_COINCIDENT: f64 = 1e-9;

/// Consecutive cells in flat arrays.
#[derive(Default)]
pub(crate) struct CellBatch {
    /// Vertices of cell c are `vertex_starts[c]..vertex_starts[c + 1]`, sorted by key.
    vertex_starts: Vec<usize>,
    keys: Vec<VertexKey>,
    positions: Vec<DVec3>,
    face_starts: Vec<usize>,
    generators: Vec<Generator>,
    corner_starts: Vec<usize>,
    corners: Vec<u32>,
    /// Pairs of vertices of a cell, as positions in the batch, that are one point.
    pub(crate) coincident: Vec<[usize; 2]>,
}

/// One cell of a batch.
pub(crate) struct CellView<'a> {
    batch: &'a CellBatch,
    cell: usize,
    pub(crate) keys: &'a [VertexKey],
    pub(crate) positions: &'a [DVec3],
    /// Position of the cell's first vertex in the batch.
    pub(crate) first_vertex: usize,
}

impl CellBatch {
    pub(crate) fn new() -> Self {
        Self { vertex_starts: vec![0], face_starts: vec![0], corner_starts: vec![0], ..Self::default() }
    }

    pub(crate) fn vertex_count(&self) -> usize {
        self.keys.len()
    }

    pub(crate) fn cell_count(&self) -> usize {
        self.vertex_starts.len() - 1
    }

    pub(crate) fn cell(&self, cell: usize) -> CellView<'_> {
        let range = self.vertex_starts[cell]..self.vertex_starts[cell + 1];
        CellView {
            batch: self,
            cell,
            keys: &self.keys[range.clone()],
            positions: &self.positions[range.clone()],
            first_vertex: range.start,
        }
    }

    /// Adds a vertex of the cell under way.
    pub(crate) fn push_vertex(&mut self, key: VertexKey, position: DVec3) {
        self.keys.push(key);
        self.positions.push(position);
    }

    /// Adds a face of the cell under way, its corners counted within the cell.
    pub(crate) fn push_face(&mut self, generator: Generator, corners: impl IntoIterator<Item = u32>) {
        self.generators.push(generator);
        self.corners.extend(corners);
        self.corner_starts.push(self.corners.len());
    }

    pub(crate) fn finish_cell(&mut self) {
        self.vertex_starts.push(self.keys.len());
        self.face_starts.push(self.generators.len());
    }

    fn push_cell(&mut self, seed: u32, cell: &ConvexCell, input: ExactInput) {
        let own = input.seeds[seed as usize];
        let mut order: Vec<(VertexKey, u32)> = (0u32..)
            .take(cell.vertex_count())
            .map(|v| (vertex_key(seed, cell.vertex_planes(v as usize)), v))
            .collect();
        order.sort_unstable();
        let mut rank = vec![0u32; order.len()];
        for (place, (key, v)) in (0u32..).zip(&order) {
            rank[*v as usize] = place;
            self.push_vertex(*key, own + cell.vertex(*v as usize, input));
        }
        let first = self.vertex_starts[self.vertex_starts.len() - 1];
        cell.for_each_face(|face| {
            self.push_face(face.generator, face.corners.iter().map(|v| rank[*v as usize]));
            if cell.has_ties() {
                let ring = face.corners.iter().zip(face.corners.iter().cycle().skip(1));
                for (&v, &w) in ring {
                    if coincide(cell, seed, v as usize, w as usize, input) {
                        let place = |v: u32| first + rank[v as usize] as usize;
                        self.coincident.push([place(v), place(w)]);
                    }
                }
            }
        });
        self.finish_cell();
    }
}

impl<'a> CellView<'a> {
    /// The faces as the generator beyond and the cell's own vertex numbers, counter-clockwise from outside.
    pub(crate) fn faces(&self) -> impl Iterator<Item = (Generator, &'a [u32])> {
        let batch = self.batch;
        (batch.face_starts[self.cell]..batch.face_starts[self.cell + 1]).map(move |face| {
            let corners = batch.corner_starts[face]..batch.corner_starts[face + 1];
            (batch.generators[face], &batch.corners[corners])
        })
    }
}

/// Whether two vertices joined by an edge are one point, exactly: then the generator that they do not share passes through both.
fn coincide(cell: &ConvexCell, seed: u32, v: usize, w: usize, input: ExactInput) -> bool {
    let (at_v, at_w) = (cell.vertex(v, input), cell.vertex(w, input));
    if at_v.distance(at_w) > POSSIBLY_COINCIDENT * at_v.length() {
        return false;
    }
    let planes = cell.vertex_planes(v);
    let other = cell.vertex_planes(w).into_iter().find(|generator| !planes.contains(generator));
    other.is_some_and(|generator| input.decide(seed, planes, generator).tie)
}

/// Cuts all cells in parallel; cell c of the result's batch b is that of seed `b * BATCH + c`.
pub(crate) fn cut_cells(search: &mut Search) -> Vec<CellBatch> {
    in_batches(search, |search, seeds| {
        let mut batch = CellBatch::new();
        let mut cell = ConvexCell::new();
        let mut buffer = Vec::new();
        for seed in seeds {
            let input = search.cut(&mut cell, seed, &mut buffer)?;
            batch.push_cell(seed, &cell, input);
        }
        Some(batch)
    })
}

/// Runs `cut` over consecutive ranges of seeds in parallel, again with wider search for those that ask for it.
pub(crate) fn in_batches<'a>(
    search: &mut Search<'a>,
    cut: impl Fn(&Search<'a>, Range<u32>) -> Option<CellBatch> + Sync,
) -> Vec<CellBatch> {
    let seed_id = |count: usize| u32::try_from(count).expect("seed ids were checked to fit");
    let seed_count = search.seed_count();
    let starts: Vec<usize> = (0..seed_count).step_by(BATCH).collect();
    let mut batches: Vec<Option<CellBatch>> = starts.iter().map(|_| None).collect();
    loop {
        batches.par_iter_mut().zip(&starts).filter(|(batch, _)| batch.is_none()).for_each(
            |(batch, start)| {
                *batch = cut(search, seed_id(*start)..seed_id(seed_count.min(start + BATCH)));
            },
        );
        if batches.iter().all(Option::is_some) {
            return batches.into_iter().flatten().collect();
        }
        search.widen();
    }
}
