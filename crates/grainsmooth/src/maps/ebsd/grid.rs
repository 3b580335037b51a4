//! The grid that the points of a map stand on, found from their coordinates alone: headers are often wrong.

use glam::BVec3;
use rayon::prelude::*;

use super::super::neighbors::{Grid, Hexagons};
use super::super::options::Crop;
use crate::error::map_file::MapProblem;
use crate::maps::orientation_map::MapPoint;

/// Coordinates that differ by less count as one, as a share of the width of the map: rounding in files is coarser, steps are wider.
const SAME: f64 = 1e-7;

/// How far a point may stand from its place, in steps: files round coordinates.
const OFF: f64 = 0.3;

/// Places of a grid for each of its points: only every second one has one in hexagonal maps, and some may lack in others.
const MOST_PLACES_OF_POINT: usize = 4;

/// A grid with its points.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct PointGrid {
    pub(super) grid: Grid,
    pub(super) columns: usize,
    pub(super) rows: usize,
    /// One above the other, the uppermost first; 1 in the plane.
    pub(super) sections: usize,
    /// From section to section, where that is known.
    pub(super) thickness: Option<f64>,
    /// Sections that were shifted against the first.
    pub(super) shifted: usize,
    /// Between neighbours along a row, and between rows; rows go downward.
    pub(super) step: [f64; 2],
    /// Coordinates of the first column and of the first row.
    pub(super) first: [f64; 2],
    /// The sum of the coordinates of the first and of the last row, by which the map is turned upside down.
    pub(super) mirror: f64,
    /// The number of the point at each place.
    pub(super) points: Vec<Option<u32>>,
}

/// Values that are multiples of a step.
struct Axis {
    first: f64,
    step: f64,
    count: usize,
}

impl PointGrid {
    /// The square or hexagonal grid of points in any order.
    ///
    /// # Errors
    /// [`MapProblem::NoGrid`] where points stand on none, or two at one place.
    pub(super) fn new(points: &[MapPoint]) -> Result<Self, MapProblem> {
        let line = |point: &MapPoint| point.line;
        if points.is_empty() {
            return Err(MapProblem::Line {
                line: 1,
                what: "holds no point; give a map with some".to_owned(),
            });
        }
        if let Some(point) = points.iter().find(|point| !point.place.iter().all(|along| along.is_finite())) {
            return Err(no_grid(line(point), "has no x and y"));
        }
        let along = |axis: usize| Axis::of(points.iter().map(|point| point.place[axis]).collect());
        let [mut x, mut y] = [along(0), along(1)];
        // A single row or column has the step of the other direction.
        match (x.count, y.count) {
            (1, 1) => {}
            (1, _) => x.step = y.step,
            (_, 1) => y.step = x.step,
            _ => {}
        }
        let count = x.count.saturating_mul(y.count);
        if count > points.len().saturating_mul(MOST_PLACES_OF_POINT) {
            return Err(no_grid(points.first().map_or(1, line), "and those behind it stand on no grid"));
        }
        let place = |point: &MapPoint| {
            let column = x.nearest(point.place[0])?;
            Some([column, y.nearest(point.place[1])?])
        };
        let mut places = Vec::with_capacity(points.len());
        for point in points {
            places
                .push(place(point).ok_or_else(|| no_grid(line(point), "stands off the grid of the others"))?);
        }
        let is_shifted = |[column, row]: &[usize; 2]| (column + row) % 2 == 1;
        let first_shifted = places.first().is_some_and(is_shifted);
        let is_hexagonal =
            x.count > 2 && y.count > 1 && places.iter().all(|at| is_shifted(at) == first_shifted);
        let (grid, columns) = if is_hexagonal {
            let hexagons = Hexagons { half_columns: x.count, rows: y.count, is_first_shifted: first_shifted };
            (Grid::Hexagons(hexagons), hexagons.columns())
        } else {
            (Grid::Voxels([x.count, y.count, 1], BVec3::FALSE), x.count)
        };
        let mut all: Vec<Option<u32>> = vec![None; columns * y.count];
        for ((number, point), [column, row]) in (0u32..).zip(points).zip(places) {
            let column = if is_hexagonal { column / 2 } else { column };
            if let Some(other) = all[row * columns + column].replace(number) {
                let other = points[other as usize].line;
                return Err(no_grid(line(point), &format!("stands where that of line {other} does")));
            }
        }
        Ok(Self {
            grid,
            columns,
            rows: y.count,
            sections: 1,
            thickness: None,
            shifted: 0,
            step: [if is_hexagonal { 2.0 * x.step } else { x.step }, y.step],
            first: [x.first, y.first],
            mirror: 2.0 * y.first + y.step * (y.count - 1) as f64,
            points: all,
        })
    }

    /// The part that is asked for, by columns, and by rows and sections from the top.
    ///
    /// # Errors
    /// [`MapProblem::Crop`].
    pub(super) fn cropped(self, crop: &Crop) -> Result<Self, MapProblem> {
        let [columns, rows, sections] = crop.ranges([self.columns, self.rows, self.sections])?;
        let row = |row: usize| &self.points[row * self.columns..][columns.clone()];
        let section = |section: usize| rows.clone().flat_map(move |at| row(section * self.rows + at));
        let points = sections.clone().flat_map(section).copied().collect();
        let grid = match self.grid {
            Grid::Voxels(..) => Grid::Voxels([columns.len(), rows.len(), sections.len()], BVec3::FALSE),
            Grid::Hexagons(hexagons) => Grid::Hexagons(Hexagons {
                half_columns: (2 * columns.len()).min(hexagons.half_columns - 2 * columns.start),
                rows: rows.len(),
                is_first_shifted: hexagons.shift(rows.start) == 1,
            }),
        };
        let [x, y] = self.first;
        Ok(Self {
            grid,
            columns: columns.len(),
            rows: rows.len(),
            sections: sections.len(),
            first: [x + columns.start as f64 * self.step[0], y + rows.start as f64 * self.step[1]],
            points,
            ..self
        })
    }
}

impl Axis {
    fn of(mut values: Vec<f64>) -> Self {
        values.par_sort_unstable_by(f64::total_cmp);
        let (Some(first), Some(last)) = (values.first().copied(), values.last().copied()) else {
            return Self { first: 0.0, step: 1.0, count: 0 };
        };
        let same = SAME * (last - first);
        values.dedup_by(|next, kept| *next - *kept <= same);
        let mut gaps: Vec<f64> = values.windows(2).map(|pair| pair[1] - pair[0]).collect();
        if gaps.is_empty() {
            return Self { first, step: 1.0, count: 1 };
        }
        let middle = gaps.len() / 2;
        let usual = *gaps.select_nth_unstable_by(middle, f64::total_cmp).1;
        // Rounded coordinates are no multiples of the usual gap; each gap is one within half a step.
        let steps: f64 = gaps.iter().map(|gap| (gap / usual).round()).sum();
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a positive number; what is too large is refused"
        )]
        let count = steps as usize + 1;
        let step = (last - first) / steps;
        // Files have fewer digits, and 0.4 is to be 0.4.
        let step = format!("{step:.9e}").parse().unwrap_or(step);
        Self { first, step, count }
    }

    /// The number of the value that is near one.
    fn nearest(&self, value: f64) -> Option<usize> {
        let steps = (value - self.first) / self.step;
        let nearest = steps.round();
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "from 0 to the number of values"
        )]
        ((steps - nearest).abs() <= OFF).then_some(nearest as usize).filter(|number| *number < self.count)
    }
}

fn no_grid(line: usize, what: &str) -> MapProblem {
    MapProblem::NoGrid { line, what: what.to_owned() }
}
