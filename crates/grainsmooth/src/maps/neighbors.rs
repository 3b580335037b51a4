//! Which places of a grid touch each other.

use glam::BVec3;

/// A grid of voxels, pixels or hexagons, x fastest.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Grid {
    /// So many along each axis. Each touches six others, in the plane four; along periodic axes the last touch the first.
    Voxels([usize; 3], BVec3),
    /// Each touches six others.
    Hexagons(Hexagons),
}

/// Rows of points, every second one shifted to the right by half a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Hexagons {
    /// Half steps from the first to the last column, and one more: columns of shifted rows and of others, taken together.
    pub(super) half_columns: usize,
    pub(super) rows: usize,
    /// Whether the first row is a shifted one.
    pub(super) is_first_shifted: bool,
}

impl Hexagons {
    /// Places of each row; of shifted ones the last may not exist.
    pub(super) fn columns(self) -> usize {
        self.half_columns.div_ceil(2)
    }

    /// 1 for shifted rows, 0 for others.
    pub(super) fn shift(self, row: usize) -> usize {
        (row + usize::from(self.is_first_shifted)) % 2
    }

    /// The place that covers half a step of a row, counted from the middle of the first column.
    pub(super) fn at(self, half_step: usize, row: usize) -> usize {
        let shift = self.shift(row);
        // Places reach half a step to both sides of their points.
        let half_column = if half_step % 2 == shift { half_step } else { half_step + 1 };
        let column = half_column.saturating_sub(shift) / 2;
        row * self.columns() + column.min((self.half_columns - 1 - shift) / 2)
    }

    fn exists(self, column: usize, row: usize) -> bool {
        2 * column + self.shift(row) < self.half_columns
    }

    fn neighbors(self, place: usize) -> [Option<usize>; 6] {
        let (column, row) = (place % self.columns(), place / self.columns());
        let at = |column: Option<usize>, row: Option<usize>| {
            let (column, row) = (column?, row.filter(|row| *row < self.rows)?);
            self.exists(column, row).then(|| row * self.columns() + column)
        };
        // Those above and below to the left and to the right.
        let right = column + self.shift(row);
        let left = right.checked_sub(1);
        let (above, below) = (row.checked_sub(1), Some(row + 1));
        [
            at(left, above),
            at(Some(right), above),
            at(column.checked_sub(1), Some(row)),
            at(Some(column + 1), Some(row)),
            at(left, below),
            at(Some(right), below),
        ]
    }
}

impl Grid {
    /// Whether there is such a place: the last ones of shifted rows may be none.
    pub(super) fn exists(self, place: usize) -> bool {
        match self {
            Self::Voxels(..) => true,
            Self::Hexagons(hexagons) => {
                hexagons.exists(place % hexagons.columns(), place / hexagons.columns())
            }
        }
    }

    /// The places that touch one.
    pub(super) fn neighbors(self, place: usize) -> impl Iterator<Item = usize> {
        let all = match self {
            Self::Voxels([nx, ny, nz], periodic) => {
                let beside = |axis: usize, at: usize, count: usize, step: usize| {
                    let around = periodic.test(axis).then_some(step * (count - 1));
                    let before =
                        if at > 0 { Some(place - step) } else { around.map(|around| place + around) };
                    let after =
                        if at + 1 < count { Some(place + step) } else { around.map(|around| place - around) };
                    [before, after]
                };
                let [left, right] = beside(0, place % nx, nx, 1);
                let [lower, upper] = beside(1, place / nx % ny, ny, nx);
                let [below, above] = beside(2, place / nx / ny, nz, nx * ny);
                [left, right, lower, upper, below, above]
            }
            Self::Hexagons(hexagons) => hexagons.neighbors(place),
        };
        all.into_iter().flatten()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hexagons_touch_six_others_and_each_other() {
        for is_first_shifted in [false, true] {
            for half_columns in [8, 9] {
                let hexagons = Hexagons { half_columns, rows: 4, is_first_shifted };
                let grid = Grid::Hexagons(hexagons);
                let count = hexagons.columns() * hexagons.rows;
                for place in 0..count {
                    for other in grid.neighbors(place) {
                        assert!(other < count && other != place);
                        assert!(!grid.exists(place) || grid.neighbors(other).any(|back| back == place));
                    }
                }
                let inner = hexagons.columns() + 1;
                assert_eq!(grid.neighbors(inner).count(), 6);
            }
        }
    }

    /// Seen as bricks, hexagons touch those that they touch as hexagons.
    #[test]
    fn halves_of_hexagons_cover_all() {
        for is_first_shifted in [false, true] {
            for half_columns in [8, 9] {
                let hexagons = Hexagons { half_columns, rows: 4, is_first_shifted };
                let grid = Grid::Hexagons(hexagons);
                let width = half_columns - 1;
                let at = |half_step, row| hexagons.at(half_step, row);
                let mut pairs = std::collections::BTreeSet::new();
                for row in 0..4 {
                    for half in 0..width {
                        let place = at(half, row);
                        assert!(grid.exists(place));
                        if half + 1 < width {
                            pairs.insert([place, at(half + 1, row)]);
                        }
                        if row < 3 {
                            pairs.insert([place, at(half, row + 1)]);
                        }
                    }
                }
                let touching = |[a, b]: &[usize; 2]| a == b || grid.neighbors(*a).any(|other| other == *b);
                assert!(pairs.iter().all(touching));
                let all = (0..hexagons.columns() * 4).filter(|place| grid.exists(*place));
                let forward =
                    all.flat_map(|a| grid.neighbors(a).filter(move |b| *b > a).map(move |b| [a, b]));
                assert!(forward.into_iter().all(|pair| pairs.contains(&pair)));
            }
        }
    }
}
