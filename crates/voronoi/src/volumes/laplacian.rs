//! How volumes change with weights: the matrix of a graph whose edges are the faces, and conjugate gradients for it.

use glam::DVec3;
use rayon::prelude::*;

use super::grains::Grains;
use crate::diagram::measures::face_area_and_centroid;
use crate::{CellId, FaceId, Side, Tessellation};

/// Iterations of conjugate gradients at most. Up to 20 000 grains took 20 to 50 in a prototype; more are a matrix that rounding spoilt.
const MOST_ITERATIONS: usize = 2000;

/// Rows that one task multiplies: few are done before another thread has heard of them.
const ROWS_PER_TASK: usize = 1024;

/// A face between cells of two grains that can move against one another.
pub(crate) struct Contact {
    /// The two cells.
    cells: [CellId; 2],
    /// Their grains.
    grains: [u32; 2],
    /// By how much the second stands moved by periods where it meets the first.
    image: DVec3,
    centroid: DVec3,
    /// The volume that goes over with a unit of weight: the area over twice the distance of the seeds.
    conductance: f64,
}

/// The matrix `dV_i / dw_j` of grains, symmetric, whose rows add up to 0 (Kitagawa, Merigot and Thibert 2019). Walls, faces within a grain
/// and those between a grain and its own images play no part in it.
pub(crate) struct Laplacian {
    contacts: Vec<Contact>,
    diagonal: Vec<f64>,
    starts: Vec<usize>,
    columns: Vec<u32>,
    conductances: Vec<f64>,
}

impl Laplacian {
    pub(crate) fn new(tessellation: &Tessellation, grains: &Grains) -> Self {
        let primaries = tessellation.face_count() - tessellation.periodic_faces().len();
        let faces = (0..primaries).into_par_iter();
        let contact = |face: usize| {
            contact(tessellation, grains, FaceId(u32::try_from(face).expect("face ids fit 32 bits")))
        };
        let contacts: Vec<Contact> = faces.filter_map(contact).collect();
        let count = grains.count();
        let mut starts = vec![0; count + 1];
        let ends = || contacts.iter().flat_map(|contact| contact.grains);
        ends().for_each(|grain| starts[grain as usize + 1] += 1);
        (0..count).for_each(|grain| starts[grain + 1] += starts[grain]);
        let mut next = starts.clone();
        let mut columns = vec![0; starts[count]];
        let mut conductances = vec![0.0; starts[count]];
        let mut diagonal = vec![0.0; count];
        for &Contact { grains: [a, b], conductance, .. } in &contacts {
            for (row, column) in [(a, b), (b, a)] {
                let place = next[row as usize];
                next[row as usize] += 1;
                (columns[place], conductances[place]) = (column, conductance);
                diagonal[row as usize] += conductance;
            }
        }
        Self { contacts, diagonal, starts, columns, conductances }
    }

    fn apply(&self, weights: &[f64]) -> Vec<f64> {
        let row = |(own, ends): (&f64, &[usize])| {
            let entries = ends[0]..ends[1];
            let entries = self.columns[entries.clone()].iter().zip(&self.conductances[entries]);
            entries.map(|(column, conductance)| conductance * (own - weights[*column as usize])).sum()
        };
        weights.par_iter().zip(self.starts.par_windows(2)).with_min_len(ROWS_PER_TASK).map(row).collect()
    }

    /// Improves a solution until its residual is down to a fraction of what it was, in the measure of the diagonal. The right side
    /// must add up to 0.
    pub(crate) fn solve(&self, right_side: &[f64], solution: &mut [f64], tolerance: f64) {
        let mut residual: Vec<f64> =
            right_side.iter().zip(self.apply(solution)).map(|(wanted, have)| wanted - have).collect();
        let precondition = |residual: &[f64]| -> Vec<f64> {
            let divide =
                |(value, diagonal): (&f64, &f64)| if *diagonal > 0.0 { value / diagonal } else { 0.0 };
            residual.iter().zip(&self.diagonal).map(divide).collect()
        };
        let mut direction = precondition(&residual);
        let mut square = dot(&residual, &direction);
        let goal = square * tolerance * tolerance;
        for _ in 0..MOST_ITERATIONS {
            let image = self.apply(&direction);
            let curvature = dot(&direction, &image);
            if square <= goal || curvature <= 0.0 {
                break;
            }
            let length = square / curvature;
            for (cell, value) in solution.iter_mut().enumerate() {
                *value += length * direction[cell];
                residual[cell] -= length * image[cell];
            }
            let scaled = precondition(&residual);
            let next = dot(&residual, &scaled);
            let share = next / square;
            square = next;
            direction.iter_mut().zip(scaled).for_each(|(old, new)| *old = new + share * *old);
        }
    }

    /// The right side whose solution are weights with which seeds that moved keep the cells' faces where they are, as nearly as can
    /// be: where each face has its centroid, both its cells have the same power.
    ///
    /// Each cell has a part of its weight that stays, its `base`.
    pub(crate) fn right_side_of_moved(&self, seeds: &[DVec3], base: impl Fn(CellId) -> f64) -> Vec<f64> {
        let mut right_side = vec![0.0; self.diagonal.len()];
        for &Contact { cells: [a, b], grains, image, centroid, conductance } in &self.contacts {
            let [to_a, to_b] = [seeds[a.index()], seeds[b.index()] + image].map(|seed| centroid - seed);
            let term = conductance * ((to_a - to_b).dot(to_a + to_b) - base(a) + base(b));
            right_side[grains[0] as usize] += term;
            right_side[grains[1] as usize] -= term;
        }
        right_side
    }
}

fn contact(tessellation: &Tessellation, grains: &Grains, face: FaceId) -> Option<Contact> {
    let [(first, _), (second, translation)] = {
        let [first, second] = tessellation.face_sides(face).map(Side::cell);
        [first?, second?]
    };
    let (cells, image) = ([first, second], translation.vector(tessellation.domain()));
    let of_cells = cells.map(|cell| grains.of(cell));
    if of_cells[0] == of_cells[1] {
        return None;
    }
    let [a, b] = cells.map(|cell| tessellation.seeds()[cell.index()]);
    let (area, centroid) = face_area_and_centroid(tessellation, face);
    let conductance = area / (2.0 * (b + image).distance(a));
    Some(Contact { cells, grains: of_cells, image, centroid, conductance })
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
