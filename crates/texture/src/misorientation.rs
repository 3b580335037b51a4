//! How far neighbours are turned from each other: histograms of disorientation angles, and swaps toward a given one.

use rand_core::Rng;
use thiserror::Error;

use crate::draw::{below, shuffle};
use crate::{CrystalSymmetry, Orientation, RandomDisorientations};

/// Two neighbours by number, and the area between them.
pub type Pair = (usize, usize, f64);

/// Shares of disorientation angles in bins that begin at 0.
#[derive(Debug, Clone, PartialEq)]
pub struct AngleHistogram {
    /// Upper ends in degrees, ascending.
    ends: Vec<f64>,
    /// They add up to 1.
    shares: Vec<f64>,
}

/// What is wrong with a histogram.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[non_exhaustive]
pub enum HistogramError {
    /// There is no bin.
    #[error("holds no bin; give the upper end of each in degrees, and its weight")]
    NoBins,
    /// An end is not above the one before.
    #[error("bin {bin} ends at {end}, not above the one before; list positive ends in increasing order")]
    Order {
        /// From 1.
        bin: usize,
        /// Its end in degrees.
        end: f64,
    },
    /// A weight is no share.
    #[error("bin {bin} has the weight {weight}; give 0 or more, and more than 0 somewhere")]
    Weight {
        /// From 1.
        bin: usize,
        /// Its weight.
        weight: f64,
    },
    /// No two crystals are so far apart.
    #[error(
        "bin {bin} begins at {start} degrees, but two {symmetry} crystals differ by at most {largest:.1}; give it the weight 0"
    )]
    Unreachable {
        /// From 1.
        bin: usize,
        /// Where it begins, in degrees.
        start: f64,
        /// The crystals.
        symmetry: CrystalSymmetry,
        /// The largest angle in degrees.
        largest: f64,
    },
}

impl HistogramError {
    /// The bin that is wrong, from 1; none where there is no bin.
    pub fn bin(&self) -> Option<usize> {
        match *self {
            Self::NoBins => None,
            Self::Order { bin, .. } | Self::Weight { bin, .. } | Self::Unreachable { bin, .. } => Some(bin),
        }
    }
}

impl AngleHistogram {
    /// The histogram with these upper ends of bins in degrees and weights, for crystals of a symmetry.
    ///
    /// # Errors
    /// Ends that do not rise, weights that are negative or all 0, and a weight where no two crystals are.
    pub fn new(bins: &[(f64, f64)], symmetry: CrystalSymmetry) -> Result<Self, HistogramError> {
        let largest = RandomDisorientations::new(symmetry).largest();
        let mut start = 0.0;
        for (bin, &(end, weight)) in (1..).zip(bins) {
            if !(end > start && end.is_finite()) {
                return Err(HistogramError::Order { bin, end });
            }
            if !(weight >= 0.0 && weight.is_finite()) {
                return Err(HistogramError::Weight { bin, weight });
            }
            if weight > 0.0 && start >= largest {
                return Err(HistogramError::Unreachable { bin, start, symmetry, largest });
            }
            start = end;
        }
        let Some((_, weight)) = bins.last() else { return Err(HistogramError::NoBins) };
        let sum: f64 = bins.iter().map(|(_, weight)| weight).sum();
        if sum == 0.0 {
            return Err(HistogramError::Weight { bin: bins.len(), weight: *weight });
        }
        let (ends, shares) = bins.iter().map(|(end, weight)| (*end, weight / sum)).unzip();
        Ok(Self { ends, shares })
    }

    /// Upper ends of the bins in degrees, with their shares.
    pub fn bins(&self) -> impl ExactSizeIterator<Item = (f64, f64)> {
        self.ends.iter().copied().zip(self.shares.iter().copied())
    }

    /// The bin of an angle; one more than there are beyond the last.
    fn bin(&self, angle: f64) -> usize {
        self.ends.partition_point(|end| *end < angle)
    }

    /// Sum of the differences of shares, of which `areas` has one more than there are bins.
    fn distance_of(&self, areas: &[f64], total: f64) -> f64 {
        let beyond = areas[self.shares.len()] / total;
        beyond + areas.iter().zip(&self.shares).map(|(area, share)| (area / total - share).abs()).sum::<f64>()
    }

    /// How far the disorientations of some pairs, by area, are from these shares: the sum of the differences of all bins, from 0 to 2.
    /// Not a number without pairs.
    pub fn distance(&self, orientations: &[Orientation], symmetry: CrystalSymmetry, pairs: &[Pair]) -> f64 {
        let mut areas = vec![0.0; self.shares.len() + 1];
        for (first, second, area) in pairs {
            areas[self.bin(symmetry.disorientation_angle(orientations[*first], orientations[*second]))] +=
                area;
        }
        self.distance_of(&areas, pairs.iter().map(|(.., area)| area).sum())
    }

    /// Swaps orientations toward the histogram: `tries` times two grains alike in volume, kept where the distance does not rise.
    /// Returns for each grain the number of the one whose orientation it gets; the distribution of orientations by volume so stays nearly as it was.
    ///
    /// `pairs` are the neighbours with their areas, `volumes` those of the grains.
    pub fn swaps(
        &self,
        orientations: &[Orientation],
        symmetry: CrystalSymmetry,
        pairs: &[Pair],
        volumes: &[f64],
        tries: usize,
        generator: &mut impl Rng,
    ) -> Vec<usize> {
        let mut sources: Vec<usize> = (0..orientations.len()).collect();
        let total: f64 = pairs.iter().map(|(.., area)| area).sum();
        if orientations.len() < 2 || total <= 0.0 {
            return sources;
        }
        let neighbors = Neighbors::new(orientations.len(), pairs);
        let mut by_volume = sources.clone();
        shuffle(&mut by_volume, generator);
        by_volume.sort_by(|a, b| volumes[*a].total_cmp(&volumes[*b]));
        // A twentieth of all grains is alike in volume, and ten of few.
        let alike = (orientations.len() / 20).max(10).min(orientations.len() - 1);
        let bin_of = |first: usize, second: usize| {
            self.bin(symmetry.disorientation_angle(orientations[first], orientations[second]))
        };
        let mut areas = vec![0.0; self.shares.len() + 1];
        let mut bins: Vec<usize> = pairs.iter().map(|(first, second, _)| bin_of(*first, *second)).collect();
        pairs.iter().zip(&bins).for_each(|((.., area), bin)| areas[*bin] += area);
        let mut distance = self.distance_of(&areas, total);
        let mut changed = Vec::new();
        for _ in 0..tries {
            let first = below(orientations.len(), generator);
            let offset = 1 + below(alike, generator);
            let second = if first + offset < orientations.len() {
                first + offset
            } else {
                first.saturating_sub(offset)
            };
            let (first, second) = (by_volume[first], by_volume[second]);
            if first == second {
                continue;
            }
            sources.swap(first, second);
            changed.clear();
            for &pair in neighbors.of(first).iter().chain(neighbors.of(second)) {
                let (a, b, area) = pairs[pair];
                // Between the two nothing changes.
                let bin = if (a == first && b == second) || (a == second && b == first) {
                    bins[pair]
                } else {
                    bin_of(sources[a], sources[b])
                };
                changed.push((pair, bins[pair]));
                areas[bins[pair]] -= area;
                areas[bin] += area;
                bins[pair] = bin;
            }
            let next = self.distance_of(&areas, total);
            if next <= distance {
                distance = next;
                continue;
            }
            sources.swap(first, second);
            for &(pair, bin) in changed.iter().rev() {
                areas[bins[pair]] -= pairs[pair].2;
                areas[bin] += pairs[pair].2;
                bins[pair] = bin;
            }
        }
        sources
    }
}

/// The pairs of each grain.
struct Neighbors {
    starts: Vec<usize>,
    pairs: Vec<usize>,
}

impl Neighbors {
    fn new(count: usize, pairs: &[Pair]) -> Self {
        let mut of_grains: Vec<(usize, usize)> = Vec::new();
        for (number, (first, second, _)) in pairs.iter().enumerate() {
            of_grains.extend([(*first, number), (*second, number)]);
        }
        of_grains.sort_unstable();
        let starts = (0..=count).map(|grain| of_grains.partition_point(|(of, _)| *of < grain)).collect();
        Self { starts, pairs: of_grains.into_iter().map(|(_, pair)| pair).collect() }
    }

    fn of(&self, grain: usize) -> &[usize] {
        &self.pairs[self.starts[grain]..self.starts[grain + 1]]
    }
}
