//! LdlFactors of a sparse symmetric matrix, part of the plane by part of the plane.
//!
//! Each part eliminates its own unknowns within a dense matrix over these and the later ones that know them, and hands what is left
//! of the latter on to the part around it (Duff and Reid 1983). No pivots are looked for: the matrix is to be quasidefinite, that is,
//! positive definite over some unknowns and negative definite over the others, and has factors in any order then (Vanderbei 1995).

use cancellation::check_cancelled;

use crate::solver::dissection::{Dissection, Part};

/// Unknowns of an element.
pub(crate) const ELEMENT: usize = 6;

/// Unknowns that are eliminated at once: each row of what is left is then read and written a fourth as often.
const AT_ONCE: usize = 4;

/// Unknowns of two halves above which each is worth a task.
const TASK: usize = 2000;

/// A part of the matrix: its unknowns, of which some may be the same, and their entries.
pub(crate) struct Element {
    pub(crate) unknowns: [usize; ELEMENT],
    pub(crate) matrix: [[f64; ELEMENT]; ELEMENT],
}

/// A unit lower triangular matrix L and a diagonal one D whose product L D L^T is the matrix.
pub(crate) struct LdlFactors {
    whole: Front,
}

/// What a part of the plane has of the factors.
struct Front {
    halves: Vec<Front>,
    /// Of the unknowns of all within, how many come before its own.
    before: usize,
    /// Of each of its own unknowns one over the pivot, and ...
    inverse_pivots: Vec<f64>,
    /// ... the column of L below, one after the other.
    columns: Vec<f64>,
    /// The later unknowns that share an element with those within.
    border: Vec<usize>,
    /// Of each of these, its number among the unknowns of the front around.
    outer: Vec<usize>,
}

/// What a part leaves of the matrix over its border: the lower triangle, row by row, each as long as all.
struct Left {
    front: Front,
    matrix: Vec<f64>,
}

impl LdlFactors {
    /// Of the sum of some elements.
    pub(crate) fn new(order: &Dissection, elements: &[Element]) -> Self {
        let first = |element: &Element| element.unknowns.into_iter().min().expect("elements have unknowns");
        let mut sorted: Vec<(usize, &Element)> =
            elements.iter().map(|element| (first(element), element)).collect();
        sorted.sort_by_key(|(first, _)| *first);
        Self { whole: eliminate(&order.whole, &sorted).front }
    }

    /// How many entries of D are negative, and so eigenvalues of the matrix (Sylvester).
    pub(crate) fn negative_count(&self) -> usize {
        self.whole.negative_count()
    }

    /// Solves for a right side, in place.
    pub(crate) fn solve(&self, values: &mut [f64]) {
        self.whole.solve_lower(values);
        self.whole.solve_upper(values, &[]);
    }
}

/// Eliminates the unknowns of a part; elements are sorted by their first unknowns.
fn eliminate(part: &Part, elements: &[(usize, &Element)]) -> Left {
    check_cancelled();
    let start_of = |unknown: usize| elements.partition_point(|(first, _)| *first < unknown);
    let own = &elements[start_of(part.own)..];
    let task = |half: &Part| eliminate(half, &elements[start_of(half.start)..start_of(half.end)]);
    let mut halves: Vec<Left> = match &part.halves[..] {
        [first, second] => {
            let both: (Left, Left) = join(part.own - part.start, || task(first), || task(second));
            vec![both.0, both.1]
        }
        halves => halves.iter().map(task).collect(),
    };
    let known = own.iter().flat_map(|(_, element)| element.unknowns);
    let handed_on = halves.iter().flat_map(|half| half.front.border.iter().copied());
    let mut border: Vec<usize> = known.chain(handed_on).filter(|unknown| *unknown >= part.end).collect();
    border.sort_unstable();
    border.dedup();
    let pivots = part.end - part.own;
    let number = |unknown: usize| match unknown.checked_sub(part.end) {
        None => unknown - part.own,
        Some(_) => pivots + border.binary_search(&unknown).expect("the border has all of them"),
    };
    let size = pivots + border.len();
    let mut matrix = vec![0.0; size * size];
    for (_, element) in own {
        let numbers = element.unknowns.map(number);
        for (row, values) in numbers.iter().zip(&element.matrix) {
            for (column, value) in numbers.iter().zip(values).filter(|(column, _)| *column <= row) {
                matrix[row * size + column] += value;
            }
        }
    }
    for half in &mut halves {
        half.front.outer = half.front.border.iter().map(|unknown| number(*unknown)).collect();
        let rows = half.matrix.chunks(half.front.outer.len().max(1));
        for ((done, row), values) in half.front.outer.iter().enumerate().zip(rows) {
            // Both are sorted, so what was below the diagonal is so again.
            let to = &mut matrix[row * size..][..size];
            for (column, value) in half.front.outer.iter().zip(values).take(done + 1) {
                to[*column] += value;
            }
        }
        half.matrix = Vec::new();
    }
    let (inverse_pivots, columns) = eliminate_dense(&mut matrix, size, pivots);
    let mut left = Vec::with_capacity(border.len() * border.len());
    (pivots..size).for_each(|row| left.extend_from_slice(&matrix[row * size + pivots..][..border.len()]));
    let halves = halves.into_iter().map(|half| half.front).collect();
    let before = part.own - part.start;
    Left { front: Front { halves, before, inverse_pivots, columns, border, outer: Vec::new() }, matrix: left }
}

/// Eliminates the first unknowns of a dense matrix, of which the lower triangle counts.
fn eliminate_dense(matrix: &mut [f64], size: usize, pivots: usize) -> (Vec<f64>, Vec<f64>) {
    let mut inverse_pivots = Vec::with_capacity(pivots);
    let mut columns = Vec::with_capacity(pivots * size - pivots * (pivots + 1) / 2);
    let mut plain = [const { Vec::new() }; AT_ONCE];
    let mut scaled = plain.clone();
    for start in (0..pivots).step_by(AT_ONCE) {
        let end = pivots.min(start + AT_ONCE);
        for own in 0..AT_ONCE {
            plain[own].clear();
            scaled[own].clear();
            if start + own >= end {
                plain[own].resize(size, 0.0);
                scaled[own].resize(size, 0.0);
                continue;
            }
            plain[own].extend((0..size).map(|row| matrix[row * size + start + own]));
            let (known, others) = plain.split_at_mut(own);
            for (known, scaled) in known.iter().zip(&scaled) {
                let share = scaled[start + own];
                let below = others[0].iter_mut().zip(known);
                below.for_each(|(value, known)| *value -= share * known);
            }
            let pivot = plain[own][start + own];
            let inverse = if pivot == 0.0 { 0.0 } else { 1.0 / pivot };
            scaled[own].extend(plain[own].iter().map(|value| value * inverse));
            inverse_pivots.push(inverse);
            columns.extend(&scaled[own][start + own + 1..]);
        }
        for row in end..size {
            let [a, b, c, d] = [0, 1, 2, 3].map(|own| plain[own][row]);
            let [p, q, r, s] = [0, 1, 2, 3].map(|own| &scaled[own][end..=row]);
            let to = &mut matrix[row * size + end..][..=row - end];
            for (k, value) in to.iter_mut().enumerate() {
                *value -= a * p[k] + b * q[k] + c * r[k] + d * s[k];
            }
        }
    }
    (inverse_pivots, columns)
}

impl Front {
    /// The columns of its own unknowns, each with the number of that.
    fn columns(&self) -> impl DoubleEndedIterator<Item = (usize, &[f64])> {
        let pivots = self.inverse_pivots.len();
        let size = pivots + self.border.len();
        (0..pivots).map(move |own| {
            // Those before have one entry less each.
            let start = own * (size - 1) - own * own.saturating_sub(1) / 2;
            (own, &self.columns[start..][..size - 1 - own])
        })
    }

    /// Solves with L for the values of all unknowns within, and gives what the border gets.
    fn solve_lower(&self, values: &mut [f64]) -> Vec<f64> {
        let (within, own) = values.split_at_mut(self.before);
        let mut all = own.to_vec();
        all.resize(own.len() + self.border.len(), 0.0);
        let mut hand_on = |half: &Self, left: &[f64]| {
            half.outer.iter().zip(left).for_each(|(number, left)| all[*number] += left);
        };
        if let [first, second] = &self.halves[..] {
            let (of_first, of_second) = within.split_at_mut(first.len());
            let (left_first, left_second) =
                join(self.before, || first.solve_lower(of_first), || second.solve_lower(of_second));
            hand_on(first, &left_first);
            hand_on(second, &left_second);
        } else if let [only] = &self.halves[..] {
            hand_on(only, &only.solve_lower(within));
        }
        for (pivot, column) in self.columns() {
            let (known, below) = all.split_at_mut(pivot + 1);
            let known = known[pivot];
            below.iter_mut().zip(column).for_each(|(value, entry)| *value -= known * entry);
        }
        own.copy_from_slice(&all[..own.len()]);
        all.split_off(own.len())
    }

    /// Solves with D and L^T, for known values on the border.
    fn solve_upper(&self, values: &mut [f64], border: &[f64]) {
        let (within, own) = values.split_at_mut(self.before);
        let mut all = own.to_vec();
        all.extend(border);
        for (pivot, column) in self.columns().rev() {
            all[pivot] = all[pivot] * self.inverse_pivots[pivot] - dot(column, &all[pivot + 1..]);
        }
        own.copy_from_slice(&all[..own.len()]);
        let of_border = |half: &Self| -> Vec<f64> { half.outer.iter().map(|number| all[*number]).collect() };
        if let [first, second] = &self.halves[..] {
            let (of_first, of_second) = within.split_at_mut(first.len());
            join(
                self.before,
                || first.solve_upper(of_first, &of_border(first)),
                || second.solve_upper(of_second, &of_border(second)),
            );
        } else if let [only] = &self.halves[..] {
            only.solve_upper(within, &of_border(only));
        }
    }

    fn negative_count(&self) -> usize {
        let own = self.inverse_pivots.iter().filter(|inverse| **inverse < 0.0).count();
        own + self.halves.iter().map(Self::negative_count).sum::<usize>()
    }

    /// How many unknowns are within.
    fn len(&self) -> usize {
        self.before + self.inverse_pivots.len()
    }
}

/// Both of two tasks on so many unknowns in all, at once where there are many.
fn join<A: Send, B: Send>(
    count: usize,
    first: impl FnOnce() -> A + Send,
    second: impl FnOnce() -> B + Send,
) -> (A, B) {
    if count > TASK { rayon::join(first, second) } else { (first(), second()) }
}

/// The product of two vectors, in four sums that do not wait for each other.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let (a, last_a) = a.as_chunks::<4>();
    let (b, last_b) = b.as_chunks::<4>();
    let mut sums = [0.0; 4];
    for (a, b) in a.iter().zip(b) {
        (0..4).for_each(|k| sums[k] += a[k] * b[k]);
    }
    let last: f64 = last_a.iter().zip(last_b).map(|(a, b)| a * b).sum();
    sums.iter().sum::<f64>() + last
}

#[cfg(test)]
mod tests {
    use std::array::from_fn;

    use glam::DVec2;

    use super::*;

    /// Vertices and cells of a square lattice with so many cells a side.
    struct Lattice {
        order: Dissection,
        unknowns: Vec<[usize; ELEMENT]>,
    }

    impl Lattice {
        fn new(side: usize) -> Self {
            let vertex = |x: usize, y: usize| y * (side + 1) + x;
            let cell = |x: usize, y: usize| (x < side && y < side).then(|| y * side + x);
            let mut edges = Vec::new();
            for (x, y) in (0..=side).flat_map(|y| (0..=side).map(move |x| (x, y))) {
                if x < side {
                    edges.push(([vertex(x, y), vertex(x + 1, y)], [cell(x, y), cell(x, y.wrapping_sub(1))]));
                }
                if y < side {
                    edges.push(([vertex(x, y), vertex(x, y + 1)], [cell(x, y), cell(x.wrapping_sub(1), y)]));
                }
            }
            let point =
                |number: usize| DVec2::new((number % (side + 1)) as f64, (number / (side + 1)) as f64);
            let points = (0..(side + 1).pow(2)).map(point).collect();
            let order = Dissection::new(points, side * side, edges.iter().copied());
            let of_edge = |(ends, cells): &([usize; 2], [Option<usize>; 2])| {
                let [start, end] = ends.map(|end| order.vertex(end).unwrap());
                let some = cells[0].or(cells[1]);
                let [left, right] = cells.map(|cell| order.cell(cell.or(some).unwrap()));
                [start, start + 1, end, end + 1, left, right]
            };
            let unknowns = edges.iter().map(of_edge).collect();
            Self { order, unknowns }
        }
    }

    /// Numbers between -1 and 1 without a pattern.
    fn noise(number: usize) -> f64 {
        ((number as f64 * 12.9898).sin() * 43758.5453).fract()
    }

    #[test]
    fn solves_what_is_quasidefinite() {
        for side in [1, 2, 7, 30] {
            let Lattice { order, unknowns } = Lattice::new(side);
            let element = |(number, unknowns): (usize, &[usize; ELEMENT])| {
                let entry = |row: usize, column: usize| {
                    let (first, last) = (row.min(column), row.max(column));
                    let value = noise(number * 36 + first * 6 + last);
                    match (first < 4, last < 4) {
                        (true, true) if first == last => 1.0,
                        (false, false) if first == last => -1.0,
                        // What joins one sign with the other may be of any size.
                        (true, false) => 3.0 * value,
                        _ => 0.2 * value,
                    }
                };
                let matrix = from_fn(|row| from_fn(|column| entry(row, column)));
                Element { unknowns: *unknowns, matrix }
            };
            let elements: Vec<Element> = unknowns.iter().enumerate().map(element).collect();
            let factors = LdlFactors::new(&order, &elements);
            assert_eq!(factors.negative_count(), side * side);
            let right_side: Vec<f64> = (0..order.len()).map(noise).collect();
            let mut solution = right_side.clone();
            factors.solve(&mut solution);
            let mut left = right_side;
            for Element { unknowns, matrix } in &elements {
                for (row, values) in unknowns.iter().zip(matrix) {
                    let product: f64 =
                        unknowns.iter().zip(values).map(|(column, v)| v * solution[*column]).sum();
                    left[*row] -= product;
                }
            }
            let largest = left.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
            assert!(largest < 1e-11, "{largest} left with {side} cells a side");
        }
    }

    #[test]
    fn halves_of_the_plane_do_not_know_each_other() {
        fn check(part: &Part, unknowns: &[[usize; ELEMENT]]) {
            if let [first, second] = &part.halves[..] {
                assert!(first.start == part.start && first.end == second.start && second.end == part.own);
                for unknowns in unknowns {
                    let is_in =
                        |half: &Part| unknowns.iter().any(|unknown| (half.start..half.end).contains(unknown));
                    assert!(!is_in(first) || !is_in(second), "{unknowns:?}");
                }
            }
            part.halves.iter().for_each(|half| check(half, unknowns));
        }
        let Lattice { order, unknowns } = Lattice::new(20);
        assert_eq!(order.len(), 2 * 21 * 21 + 20 * 20);
        let mut all: Vec<usize> = unknowns.iter().flatten().copied().collect();
        all.sort_unstable();
        all.dedup();
        assert_eq!(all, (0..order.len()).collect::<Vec<usize>>());
        assert_eq!(order.whole.halves.len(), 2);
        check(&order.whole, &unknowns);
    }
}
