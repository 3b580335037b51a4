//! Labels of voxels, and the points between them.

use std::borrow::Cow;
use std::collections::BTreeMap;

use rayon::prelude::*;
use voronoi::Dimension;

use crate::voxels::labels::{OUTSIDE, VoxelLabel, Voxels};
use crate::voxels::pattern::{Meeting, SplitPoint, copies, octants_around, touching, two_sheets};
use crate::{GrainId, NetworkError};

/// Labels of voxels (in the plane: pixels), x fastest, and how many each has.
pub(super) struct Lattice<'a> {
    /// Number of voxels along each axis.
    pub(super) shape: [usize; 3],
    /// Along which axes the last voxels touch the first.
    pub(super) periodic: [bool; 3],
    pub(super) is_plane: bool,
    pub(super) labels: Cow<'a, [VoxelLabel]>,
    /// Number of voxels of each label but [`OUTSIDE`].
    pub(super) counts: Vec<u64>,
    /// The same before any voxel changed its label. By these it is decided which grain is joined along an edge, so that a change has no effect far away.
    sizes: Vec<u64>,
    /// How often each voxel changed its label, of those that did.
    changes: BTreeMap<usize, u32>,
}

/// A place of the lattice: 0 at the lower walls, the number of voxels at the upper ones. Along a period both are one place, that at 0.
pub(super) type Place = [usize; 3];

/// A place where boundaries are, and the copies of the point there.
#[derive(Debug, Clone, Copy)]
pub(super) struct MixedPlace {
    pub(super) place: Place,
    pub(super) copies: SplitPoint,
}

/// Fewer voxels than this along a period would have a neighbour on both sides.
const LEAST_PERIOD: usize = 3;

/// Rounds of changes around earlier ones. Measured maps take two or three.
const MOST_ROUNDS: usize = 50;

/// What is to be done with a grain that touches itself: a voxel gets the label of another one beside it.
struct Change {
    voxel: usize,
    label: u32,
}

impl<'a> Lattice<'a> {
    /// # Errors
    /// [`NetworkError::NoGrain`]; [`NetworkError::MissingGrain`]; [`NetworkError::ShortPeriod`].
    pub(super) fn new(voxels: &'a Voxels) -> Result<Self, NetworkError> {
        let labels = voxels.labels();
        let of_grains = || labels.iter().map(|label| label.0).filter(|label| *label != OUTSIDE);
        let largest = of_grains().max().ok_or(NetworkError::NoGrain)?;
        // A number as large as there are voxels leaves out a smaller one.
        let mut counts = vec![0; (largest as usize).min(labels.len()) + 1];
        for label in of_grains() {
            if let Some(count) = counts.get_mut(label as usize) {
                *count += 1;
            }
        }
        if let Some(grain) =
            (0u32..).zip(&counts).find_map(|(grain, count)| (*count == 0).then_some(GrainId(grain)))
        {
            return Err(NetworkError::MissingGrain { grain });
        }
        let (shape, periodic) = (voxels.shape(), voxels.domain().periodic().into());
        for (axis, (voxels, is_periodic)) in ['x', 'y', 'z'].into_iter().zip(shape.into_iter().zip(periodic))
        {
            if is_periodic && voxels < LEAST_PERIOD {
                return Err(NetworkError::ShortPeriod { axis, voxels, least: LEAST_PERIOD });
            }
        }
        let is_plane = voxels.domain().dimension() == Dimension::Two;
        let sizes = counts.clone();
        Ok(Self {
            shape,
            periodic,
            is_plane,
            labels: Cow::Borrowed(labels),
            counts,
            sizes,
            changes: BTreeMap::new(),
        })
    }

    /// Number of places along an axis.
    pub(super) fn place_count(&self, axis: usize) -> usize {
        self.shape[axis] + usize::from(!self.periodic[axis])
    }

    /// A coordinate of a voxel that is one of the grid; along a period any has such a voxel.
    fn wrapped(&self, axis: usize, coordinate: Option<usize>) -> Option<usize> {
        let count = self.shape[axis];
        match coordinate {
            Some(coordinate) if coordinate < count => Some(coordinate),
            Some(coordinate) => self.periodic[axis].then(|| coordinate - count),
            // Below 0.
            None => self.periodic[axis].then(|| count - 1),
        }
    }

    /// Number of voxels that a label had at first: no grain is larger than the outside.
    pub(super) fn volume(&self, label: u32) -> u64 {
        if label == OUTSIDE { u64::MAX } else { self.sizes[label as usize] }
    }

    /// The label of the voxel above a place, so many steps on; that of the outside beyond the grid.
    fn label(&self, place: Place, step: [isize; 3]) -> u32 {
        let voxel = self.voxel(place, step);
        voxel.map_or(OUTSIDE, |voxel| self.labels[voxel].0)
    }

    /// The number of that voxel, if it is one of the grid.
    pub(super) fn voxel(&self, place: Place, step: [isize; 3]) -> Option<usize> {
        let mut number = 0;
        for axis in [2, 1, 0] {
            let coordinate = self.wrapped(axis, place[axis].checked_add_signed(step[axis]))?;
            number = number * self.shape[axis] + coordinate;
        }
        Some(number)
    }

    /// The voxel in an octant of a place.
    fn voxel_in(&self, place: Place, octant: usize) -> Option<usize> {
        self.voxel(place, std::array::from_fn(|axis| if octant >> axis & 1 == 1 { 0 } else { -1 }))
    }

    /// The labels of the octants of a place.
    fn octants(&self, place: Place) -> [u32; 8] {
        std::array::from_fn(|octant| {
            self.voxel_in(place, octant).map_or(OUTSIDE, |voxel| self.labels[voxel].0)
        })
    }

    /// The places where not all labels are the same, in order, plane by plane.
    pub(super) fn mixed_places(&self) -> Vec<Vec<MixedPlace>> {
        if self.is_plane {
            return (0..self.place_count(1)).into_par_iter().map(|y| self.mixed_in_row(y)).collect();
        }
        (0..self.place_count(2)).into_par_iter().map(|z| self.mixed_in_plane(z)).collect()
    }

    fn mixed_in_plane(&self, z: usize) -> Vec<MixedPlace> {
        let [width, height, _] = self.shape;
        let row = |y: Option<usize>, z: Option<usize>| {
            let (y, z) = (self.wrapped(1, y)?, self.wrapped(2, z)?);
            let start = (z * height + y) * width;
            Some(&self.labels[start..start + width])
        };
        let mut found = Vec::new();
        for y in 0..self.place_count(1) {
            let lower = |at: usize| at.checked_sub(1);
            let rows = [
                row(lower(y), lower(z)),
                row(Some(y), lower(z)),
                row(lower(y), Some(z)),
                row(Some(y), Some(z)),
            ];
            let column = |x: Option<usize>| {
                let x = self.wrapped(0, x);
                rows.map(|row| row.zip(x).map_or(OUTSIDE, |(row, x)| row[x].0))
            };
            let mut left = column(None);
            for x in 0..self.place_count(0) {
                let right = column(Some(x));
                let is_mixed = left != [left[0]; 4] || right != left;
                if is_mixed {
                    let labels =
                        std::array::from_fn(|octant| if octant & 1 == 0 { left } else { right }[octant >> 1]);
                    let copies = copies(labels, &|label| self.volume(label));
                    found.push(MixedPlace { place: [x, y, z], copies });
                }
                left = right;
            }
        }
        found
    }

    fn mixed_in_row(&self, y: usize) -> Vec<MixedPlace> {
        let places = (0..self.place_count(0)).map(|x| [x, y, 0]);
        let mixed = places.filter_map(|place| {
            let around = self.pixels(place);
            if around == [around[0]; 4] {
                return None;
            }
            let meeting = Meeting::of(around, &|label| self.volume(label));
            let mut of_quarters = [0; 12];
            of_quarters[..4].copy_from_slice(&meeting.sheets());
            let count = if meeting == Meeting::Together { 1 } else { 2 };
            Some(MixedPlace { place, copies: SplitPoint { of_quarters, count } })
        });
        mixed.collect()
    }

    /// The labels of the pixels around a place, counter-clockwise from the lower left.
    fn pixels(&self, place: Place) -> [u32; 4] {
        [[-1, -1], [0, -1], [0, 0], [-1, 0]].map(|[x, y]| self.label(place, [x, y, 0]))
    }

    /// Gives voxels other labels until no grain touches itself in a point or along an edge from which its sheets cannot be parted, and returns how many changed; in the plane
    /// they always can.
    ///
    /// # Errors
    /// [`NetworkError::VoxelsTouch`] when that leads nowhere.
    pub(super) fn part_what_touches(
        &mut self,
        mixed: &mut Vec<Vec<MixedPlace>>,
    ) -> Result<usize, NetworkError> {
        if self.is_plane {
            return Ok(0);
        }
        let mut places: Vec<Place> = mixed.iter().flatten().map(|mixed| mixed.place).collect();
        for _ in 0..MOST_ROUNDS {
            places = places.into_par_iter().filter(|place| self.change_at(*place).is_some()).collect();
            if places.is_empty() {
                if !self.changes.is_empty() {
                    *mixed = self.mixed_places();
                }
                return Ok(self.changes.len());
            }
            let mut around = Vec::new();
            for place in places {
                // What changed before may have mended this.
                let Some(Change { voxel, label }) = self.change_at(place) else { continue };
                let was = std::mem::replace(&mut self.labels.to_mut()[voxel], VoxelLabel(label));
                self.counts[was.0 as usize] -= 1;
                if label != OUTSIDE {
                    self.counts[label as usize] += 1;
                }
                *self.changes.entry(voxel).or_default() += 1;
                around.extend(self.places_around(self.place_of(voxel)));
            }
            around.sort_unstable_by_key(|[x, y, z]| [*z, *y, *x]);
            around.dedup();
            places = around;
        }
        let left = places.into_iter().filter(|place| self.change_at(*place).is_some()).count();
        Err(NetworkError::VoxelsTouch { places: left })
    }

    pub(super) fn place_of(&self, voxel: usize) -> Place {
        let [width, height, _] = self.shape;
        [voxel % width, voxel / width % height, voxel / width / height]
    }

    /// The places from which a change of a voxel can be seen: its own corners, and those an edge further.
    fn places_around(&self, [x, y, z]: Place) -> impl Iterator<Item = Place> {
        let near = |at: usize, axis: usize| {
            let count = self.shape[axis];
            if self.periodic[axis] {
                return (at + count - 1..=at + count + 2).map(|place| place % count).collect();
            }
            (at.saturating_sub(1)..=(at + 2).min(count)).collect()
        };
        let (xs, ys, zs): (Vec<usize>, Vec<usize>, Vec<usize>) = (near(x, 0), near(y, 1), near(z, 2));
        zs.into_iter().flat_map(move |z| {
            let xs = xs.clone();
            ys.clone().into_iter().flat_map(move |y| xs.clone().into_iter().map(move |x| [x, y, z]))
        })
    }

    /// What parts a grain that touches itself at a place, or along an edge that goes up from there.
    fn change_at(&self, place: Place) -> Option<Change> {
        let labels = self.octants(place);
        let volume = |label: u32| self.volume(label);
        let here = copies(labels, &volume);
        let alone = touching(labels, &here, &volume).map(|found| found.octants);
        let at_edge = |axis: usize| {
            let mut end = place;
            end[axis] += 1;
            if end[axis] > self.shape[axis] {
                return None;
            }
            let [one, other] = two_sheets(labels, &here, axis, 1, &volume)?;
            if one != other {
                return None;
            }
            let labels = self.octants(end);
            let there = copies(labels, &volume);
            let [one, other] = two_sheets(labels, &there, axis, 0, &volume)?;
            (one == other).then(|| octants_around(axis).to_vec())
        };
        // At a point the first will do; another one where that changed before, which may be what another place needs.
        let is_at_point = alone.is_some();
        let octants = alone.or_else(|| (0..3).find_map(at_edge))?;
        let candidates = octants.into_iter().filter_map(|octant| self.voxel_in(place, octant));
        let best = candidates
            .enumerate()
            .filter_map(|(rank, voxel)| {
                let times = self.changes.get(&voxel).copied().unwrap_or(0);
                let rank = if is_at_point { rank.min(1) } else { 0 };
                self.loneliness(voxel).map(|(alike, label)| (times, rank, alike, voxel, label))
            })
            .min();
        best.map(|(.., voxel, label)| Change { voxel, label })
    }

    /// How many of the voxels beside one have its label, and the label that most of the others have; nothing where the voxel is all that its grain has.
    fn loneliness(&self, voxel: usize) -> Option<(usize, u32)> {
        let own = self.labels[voxel].0;
        if own == OUTSIDE || self.counts[own as usize] < 2 {
            return None;
        }
        let place = self.place_of(voxel);
        let beside = (0..6).filter_map(|face| {
            let mut step = [0; 3];
            step[face / 2] = if face % 2 == 0 { -1 } else { 1 };
            self.voxel(place, step).map(|voxel| self.labels[voxel].0)
        });
        let mut labels: Vec<u32> = beside.collect();
        labels.sort_unstable();
        let alike = labels.iter().filter(|label| **label == own).count();
        let others = labels.chunk_by(|a, b| a == b).filter(|labels| labels[0] != own);
        // The most frequent one, of equals the smallest.
        let most = others.max_by_key(|labels| (labels.len(), std::cmp::Reverse(labels[0])))?;
        Some((alike, most[0]))
    }
}
