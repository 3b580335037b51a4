//! Diameters from a list, a histogram, or a table of the distribution function.

use thiserror::Error;

/// Why rows are no table. Rows are counted from 1.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[non_exhaustive]
pub enum TableError {
    /// There is nothing in it.
    #[error("holds no diameters; give one or more")]
    Empty,
    /// A diameter is negative, or no number; in a list also one of 0.
    #[error("the diameter {diameter} is not positive and finite; correct it or remove the line")]
    Diameter {
        /// Where it stands.
        row: usize,
        /// The diameter.
        diameter: f64,
    },
    /// A bin ends before it begins, or begins in the one before.
    #[error(
        "the bin from {from} to {to} has no width, or overlaps the one before; list bins from small to large"
    )]
    Bin {
        /// Where it stands.
        row: usize,
        /// Where the bin begins.
        from: f64,
        /// Where it ends.
        to: f64,
    },
    /// A weight is negative, or no number.
    #[error("the weight {weight} is not 0 or more; correct it or remove the line")]
    Weight {
        /// Where it stands.
        row: usize,
        /// The weight.
        weight: f64,
    },
    /// All weights are 0.
    #[error("every weight is 0; give a positive one")]
    NoWeight,
    /// Diameters or shares of a distribution function fall.
    #[error("diameters and shares of a distribution function must not fall; list them from small to large")]
    Falls {
        /// Where the smaller one stands.
        row: usize,
    },
    /// A distribution function that does not begin with 0.
    #[error(
        "the distribution function begins with {share}; begin with the smallest diameter and the share 0"
    )]
    Begins {
        /// Its first value.
        share: f64,
    },
}

impl TableError {
    /// The row that it is about, if it is about one.
    pub fn row(&self) -> Option<usize> {
        match self {
            Self::Diameter { row, .. }
            | Self::Bin { row, .. }
            | Self::Weight { row, .. }
            | Self::Falls { row } => Some(*row),
            Self::Begins { .. } => Some(1),
            Self::Empty | Self::NoWeight => None,
        }
    }
}

/// A part of the diameters: all alike between two ends, or all the same where these are.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Piece {
    ends: [f64; 2],
    /// Share by number.
    share: f64,
}

impl Piece {
    /// The integral of `d^power` over its diameters up to x, if all were in this piece.
    fn partial_moment(&self, power: u32, x: f64) -> f64 {
        let [lower, upper] = self.ends;
        let exponent = f64::from(power);
        match x {
            _ if x < lower => 0.0,
            _ if lower == upper => libm::pow(lower, exponent),
            _ => {
                let power_of = |x: f64| libm::pow(x, exponent + 1.0);
                (power_of(x.min(upper)) - power_of(lower)) / ((exponent + 1.0) * (upper - lower))
            }
        }
    }
}

/// Diameters from a list, a histogram, or a table of the distribution function.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// From small to large; they do not overlap.
    pieces: Vec<Piece>,
    /// Share by number of all pieces before each.
    below: Vec<f64>,
}

impl Table {
    /// All diameters of a list alike.
    ///
    /// ```
    /// use sizes::Table;
    ///
    /// assert!(Table::list(&[10.0, 12.0, 20.0]).is_ok());
    /// let problem = Table::list(&[10.0, -12.0]).expect_err("a negative diameter");
    /// assert_eq!(problem.row(), Some(2));
    /// ```
    ///
    /// # Errors
    /// [`TableError`].
    pub fn list(diameters: &[f64]) -> Result<Self, TableError> {
        let is_bad = |diameter: &f64| !(diameter.is_finite() && *diameter > 0.0);
        if let Some(place) = diameters.iter().position(is_bad) {
            return Err(TableError::Diameter { row: place + 1, diameter: diameters[place] });
        }
        let mut sorted = diameters.to_vec();
        sorted.sort_unstable_by(f64::total_cmp);
        Self::of_pieces(sorted.into_iter().map(|diameter| ([diameter, diameter], 1.0)))
    }

    /// A histogram: where each bin begins and ends, and its weight. With a number of axes weights are by volume (2: by area), as
    /// of grains of so many dimensions; else by number. In a bin all diameters are alike by number.
    ///
    /// ```
    /// use sizes::Table;
    ///
    /// assert!(Table::histogram(&[[1.0, 2.0, 0.3], [2.0, 3.0, 0.7]], None).is_ok());
    /// let overlapping = Table::histogram(&[[1.0, 2.0, 0.3], [1.5, 3.0, 0.7]], None);
    /// assert!(overlapping.is_err());
    /// ```
    ///
    /// # Errors
    /// [`TableError`].
    pub fn histogram(bins: &[[f64; 3]], weights_by: Option<u32>) -> Result<Self, TableError> {
        let mut end = 0.0;
        for (row, &[from, to, weight]) in (1..).zip(bins) {
            if let Some(diameter) = [from, to].into_iter().find(|end| !end.is_finite() || *end < 0.0) {
                return Err(TableError::Diameter { row, diameter });
            }
            if from < end || to <= from {
                return Err(TableError::Bin { row, from, to });
            }
            if !(weight.is_finite() && weight >= 0.0) {
                return Err(TableError::Weight { row, weight });
            }
            end = to;
        }
        let volume = |ends: [f64; 2]| match weights_by {
            Some(axes) => Piece { ends, share: 1.0 }.partial_moment(axes, ends[1]),
            None => 1.0,
        };
        Self::of_pieces(bins.iter().map(|&[from, to, weight]| ([from, to], weight / volume([from, to]))))
    }

    /// A distribution function by number: diameters, and the share of those that are no larger, from 0 to 1 or to any other number,
    /// such as 100. Between two lines all diameters are alike.
    ///
    /// # Errors
    /// [`TableError`].
    pub fn distribution_function(points: &[[f64; 2]]) -> Result<Self, TableError> {
        for (row, &[diameter, share]) in (1..).zip(points) {
            if !(diameter.is_finite() && diameter >= 0.0) {
                return Err(TableError::Diameter { row, diameter });
            }
            if !(share.is_finite() && share >= 0.0) {
                return Err(TableError::Weight { row, weight: share });
            }
            if row == 1 && share != 0.0 {
                return Err(TableError::Begins { share });
            }
            let is_lower = row > 1 && (diameter < points[row - 2][0] || share < points[row - 2][1]);
            if is_lower || (diameter == 0.0 && share > 0.0) {
                return Err(TableError::Falls { row });
            }
        }
        let pairs = points.windows(2);
        Self::of_pieces(pairs.map(|pair| ([pair[0][0], pair[1][0]], pair[1][1] - pair[0][1])))
    }

    fn of_pieces(pieces: impl Iterator<Item = ([f64; 2], f64)>) -> Result<Self, TableError> {
        let weighted: Vec<([f64; 2], f64)> = pieces.collect();
        if weighted.is_empty() {
            return Err(TableError::Empty);
        }
        let sum: f64 = weighted.iter().map(|(_, weight)| weight).sum();
        if sum <= 0.0 {
            return Err(TableError::NoWeight);
        }
        let pieces: Vec<Piece> = weighted
            .into_iter()
            .filter(|(_, weight)| *weight > 0.0)
            .map(|(ends, weight)| Piece { ends, share: weight / sum })
            .collect();
        let mut total = 0.0;
        let below = pieces.iter().map(|piece| {
            total += piece.share;
            total - piece.share
        });
        let below = below.collect();
        Ok(Self { pieces, below })
    }

    /// The largest diameter.
    pub(crate) fn largest(&self) -> f64 {
        self.pieces.last().map_or(0.0, |piece| piece.ends[1])
    }

    /// The integral of `d^power` over all diameters up to x.
    pub(crate) fn partial_moment(&self, power: u32, x: f64) -> f64 {
        let of = |piece: &Piece| piece.share * piece.partial_moment(power, x);
        // Those that begin above x have no part in it.
        let begun = self.pieces.partition_point(|piece| piece.ends[0] <= x);
        let (begun, is_all) = (&self.pieces[..begun], begun == self.pieces.len());
        match (power, begun) {
            (_, []) => 0.0,
            (0, _) if is_all && x >= self.largest() => 1.0,
            (0, [.., last]) => self.below[begun.len() - 1] + of(last),
            _ => begun.iter().map(of).sum(),
        }
    }
}
