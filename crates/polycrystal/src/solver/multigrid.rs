//! A preconditioner for the pressures of the grains: one cycle of multigrid by aggregation.
//!
//! The matrix of the pressures is much like the Laplacian of the graph of neighbouring grains, whose smoothest parts
//! conjugate gradients alone need the more iterations for the more grains lie side by side. Each coarser grid takes a
//! grain and its neighbours as one (Vanek, Mandel and Brezina 1996, without smoothing), down to a grid that is solved
//! directly.

use cancellation::check_cancelled;
use rayon::prelude::*;

use crate::solver::rows::CsrRows;

/// Unknowns of the coarsest grid at most, whose dense factors are cheaper than any step of the flow.
const COARSEST: usize = 200;

/// Weight of Jacobi's method, below 2 over the largest eigenvalue of the matrix scaled to diagonal 1, which is about 2.
const DAMPING: f64 = 0.5;

/// CsrRows that one task multiplies.
const ROWS_PER_TASK: usize = 2048;

/// Share of the diagonal below which a pivot counts as rounding: a constant pressure has no effect, nor has that of a
/// grain in which nothing can move.
const SMALLEST_PIVOT: f64 = 1e-9;

/// Grids from fine to coarse.
pub(crate) struct Multigrid {
    grids: Vec<Grid>,
    /// Nothing where grains hardly touch, so that grids do not become coarser.
    coarsest: Option<Cholesky>,
}

struct Grid {
    matrix: CsrRows<f64>,
    inverse_diagonal: Vec<f64>,
    /// The unknown of the next grid that each unknown is part of.
    aggregates: Vec<u32>,
    aggregate_count: usize,
}

impl Multigrid {
    /// For a symmetric matrix that is positive semidefinite. CsrRows without a diagonal stay zero.
    pub(crate) fn new(matrix: CsrRows<f64>) -> Self {
        let mut grids = Vec::new();
        let mut matrix = matrix;
        loop {
            check_cancelled();
            let (aggregates, aggregate_count) = aggregate(&matrix);
            let is_coarsest = matrix.len() <= COARSEST || 2 * aggregate_count > matrix.len();
            let inverse_diagonal = inverse_diagonal(&matrix);
            let coarser =
                if is_coarsest { None } else { Some(coarsen(&matrix, &aggregates, aggregate_count)) };
            grids.push(Grid { matrix, inverse_diagonal, aggregates, aggregate_count });
            match coarser {
                Some(coarser) => matrix = coarser,
                None => break,
            }
        }
        let last = &grids[grids.len() - 1];
        let coarsest = (last.matrix.len() <= COARSEST).then(|| Cholesky::new(&last.matrix));
        Self { grids, coarsest }
    }

    /// The matrix times a vector.
    pub(crate) fn apply(&self, vector: &[f64]) -> Vec<f64> {
        self.grids[0].apply(vector)
    }

    /// An approximation of the matrix's inverse times a vector; symmetric and positive definite.
    pub(crate) fn precondition(&self, residual: &[f64]) -> Vec<f64> {
        self.cycle(0, residual)
    }

    fn cycle(&self, level: usize, residual: &[f64]) -> Vec<f64> {
        let grid = &self.grids[level];
        if level + 1 == self.grids.len() {
            return match &self.coarsest {
                Some(factors) => factors.solve(residual),
                None => grid.smooth(residual).collect(),
            };
        }
        let mut solution: Vec<f64> = grid.smooth(residual).collect();
        let left = grid.left(residual, &solution);
        let mut coarse = vec![0.0; grid.aggregate_count];
        grid.aggregates.iter().zip(&left).for_each(|(to, left)| coarse[*to as usize] += left);
        let coarse = self.cycle(level + 1, &coarse);
        solution.iter_mut().zip(&grid.aggregates).for_each(|(x, from)| *x += coarse[*from as usize]);
        let left = grid.left(residual, &solution);
        solution.iter_mut().zip(grid.smooth(&left)).for_each(|(x, more)| *x += more);
        solution
    }
}

impl Grid {
    fn apply(&self, vector: &[f64]) -> Vec<f64> {
        let product = |row: usize| {
            self.matrix.row(row).iter().map(|(column, value)| value * vector[*column as usize]).sum()
        };
        // Other threads would be asked for nothing, and that takes longer than a few rows.
        if self.matrix.len() <= ROWS_PER_TASK {
            return (0..self.matrix.len()).map(product).collect();
        }
        (0..self.matrix.len()).into_par_iter().with_min_len(ROWS_PER_TASK).map(product).collect()
    }

    fn left(&self, right_side: &[f64], solution: &[f64]) -> Vec<f64> {
        right_side.iter().zip(self.apply(solution)).map(|(b, image)| b - image).collect()
    }

    fn smooth<'a>(&'a self, residual: &'a [f64]) -> impl Iterator<Item = f64> + 'a {
        residual.iter().zip(&self.inverse_diagonal).map(|(r, inverse)| DAMPING * r * inverse)
    }
}

fn inverse_diagonal(matrix: &CsrRows<f64>) -> Vec<f64> {
    let inverse = |value: f64| if value > 0.0 { 1.0 / value } else { 0.0 };
    matrix.diagonal().into_iter().map(inverse).collect()
}

/// Groups each unknown whose neighbours are all free with these; what is left over joins a neighbour's group.
fn aggregate(matrix: &CsrRows<f64>) -> (Vec<u32>, usize) {
    const FREE: u32 = u32::MAX;
    let mut groups = vec![FREE; matrix.len()];
    let mut count = 0;
    for row in 0..matrix.len() {
        let neighbors = matrix.row(row);
        if groups[row] == FREE && neighbors.iter().all(|(other, _)| groups[*other as usize] == FREE) {
            groups[row] = count;
            neighbors.iter().for_each(|(other, _)| groups[*other as usize] = count);
            count += 1;
        }
    }
    let first = groups.clone();
    for row in (0..matrix.len()).filter(|row| first[*row] == FREE) {
        // An unknown with neighbours that are not free has one in a group.
        let strongest = matrix.row(row).iter().filter(|(other, _)| first[*other as usize] != FREE);
        let strongest = strongest.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()).then(b.0.cmp(&a.0)));
        groups[row] = strongest.map_or(0, |(other, _)| first[*other as usize]);
    }
    (groups, count as usize)
}

fn coarsen(matrix: &CsrRows<f64>, groups: &[u32], count: usize) -> CsrRows<f64> {
    let mut members: Vec<Vec<usize>> = vec![Vec::new(); count];
    groups.iter().enumerate().for_each(|(row, group)| members[*group as usize].push(row));
    CsrRows::made_by(count, |group, sums| {
        for (column, value) in members[group].iter().flat_map(|row| matrix.row(*row)) {
            sums.add(groups[*column as usize], *value);
        }
    })
}

/// Dense factors of a small matrix.
struct Cholesky {
    /// Row-major lower triangle.
    factor: Vec<Vec<f64>>,
}

impl Cholesky {
    fn new(matrix: &CsrRows<f64>) -> Self {
        let count = matrix.len();
        let mut factor: Vec<Vec<f64>> = Vec::with_capacity(count);
        for i in 0..count {
            let mut row = vec![0.0; i + 1];
            for (column, value) in matrix.row(i).iter().filter(|(column, _)| *column as usize <= i) {
                row[*column as usize] = *value;
            }
            let own = row[i];
            for j in 0..i {
                let known: f64 = row[..j].iter().zip(&factor[j]).map(|(a, b)| a * b).sum();
                row[j] = (row[j] - known) / factor[j][j];
            }
            let known: f64 = row[..i].iter().map(|value| value * value).sum();
            let pivot = own - known;
            // An infinite one leaves its unknown zero.
            row[i] = if pivot > SMALLEST_PIVOT * own { pivot.sqrt() } else { f64::INFINITY };
            factor.push(row);
        }
        Self { factor }
    }

    fn solve(&self, right_side: &[f64]) -> Vec<f64> {
        let mut solution = right_side.to_vec();
        for (i, row) in self.factor.iter().enumerate() {
            let known: f64 = row[..i].iter().zip(&solution).map(|(a, b)| a * b).sum();
            solution[i] = (solution[i] - known) / row[i];
        }
        for (i, row) in self.factor.iter().enumerate().rev() {
            solution[i] /= row[i];
            let (before, own) = (&row[..i], solution[i]);
            solution[..i].iter_mut().zip(before).for_each(|(x, value)| *x -= value * own);
        }
        solution
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solver::conjugate_gradients::{Limits, solve};
    use crate::solver::rows::NewRow;

    /// The Laplacian of a cube of points, whose rows sum to zero.
    fn laplacian(side: u32) -> CsrRows<f64> {
        let at = |[x, y, z]: [u32; 3]| (x * side + y) * side + z;
        CsrRows::made_by(side.pow(3) as usize, |row, entries| {
            let i = u32::try_from(row).expect("few");
            let place = [i / side / side, i / side % side, i % side];
            for axis in 0..3 {
                for next in [place[axis].checked_sub(1), Some(place[axis] + 1).filter(|next| *next < side)] {
                    let Some(next) = next else { continue };
                    let mut other = place;
                    other[axis] = next;
                    entries.add(at(other), -1.0);
                    entries.add(i, 1.0);
                }
            }
        })
    }

    #[test]
    fn a_few_iterations_solve_laplacians_of_any_size() {
        for side in [4, 12, 24] {
            let grids = Multigrid::new(laplacian(side));
            let count = side.pow(3);
            let right_side: Vec<f64> =
                (0..count).map(|i| f64::from(i) - 0.5 * f64::from(count - 1)).collect();
            let precondition = |r: &[f64]| grids.precondition(r);
            let limits = Limits { tolerance: 1e-10, steps: 40 };
            let solution = solve(|v| grids.apply(v), precondition, &right_side, &limits);
            let largest = right_side.iter().zip(grids.apply(&solution)).map(|(b, image)| (b - image).abs());
            let largest = largest.fold(0.0, f64::max);
            assert!(largest < 1e-6 * f64::from(count), "{largest} left of {count}");
        }
    }

    #[test]
    fn unknowns_without_a_row_stay_zero() {
        let only_first = |row: usize, entries: &mut NewRow<'_, f64>| {
            if row == 0 {
                entries.add(0, 2.0);
            }
        };
        let grids = Multigrid::new(CsrRows::made_by(2, only_first));
        let solution = grids.precondition(&[3.0, 0.0]);
        assert!((solution[0] - 1.5).abs() < 1e-9 && solution[1] == 0.0);
    }
}
