//! What motions would break gives way: they are smoothed there.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec3;
use rayon::prelude::*;

use crate::mesh::disjoint_sets::DisjointSets;
use crate::mesh::grouped::Grouped;
use crate::mesh::id::id;
use crate::solver::conjugate_gradients::{Limits, SOLVED, solve};
use crate::{Freedom, NetworkError};

/// Attempts at a step, each with more that gives way. Usual ones need three, grains about to vanish some twenty.
const ATTEMPTS: usize = 40;

/// Rings around a place in which motions are smoothed, of as many as times that it was broken; what lies deeper moves as one. Of five hard networks
/// 2 leave none folded; 1, 3 and 5 leave one each, 8 take twice as long.
const SMOOTHED_RINGS: usize = 2;

/// Distance, in units of the longest, below which neighbours that give way move as one, and others count as no nearer: products with one over it stay
/// exact. A noisy face-centred lattice, whose points of six grains are lines of 1e-12 each, takes 1.6 s to grow so; 54 s where its points each moved.
const LEAST_DISTANCE: f64 = 1e-6;

/// Motions of unknowns that are smoothed where they break something.
///
/// Each then moves by the mean of its neighbours, weighted by one over the distance to them at the start: what lies between unknowns that give way is carried along, and keeps the shape that it had.
/// A small grain that drifts by many times its width with a cluster stays what it is. What is broken more often moves as one, as no strain at all may be small enough. That is
/// local: to solve a step anew for all grains would take as many attempts as the worst place of all.
pub(crate) struct GivingWay<'a> {
    /// The neighbours of an unknown, and the distances to them at the start.
    neighbors: Box<dyn Fn(u32) -> Vec<(u32, f64)> + 'a>,
    freedom: Box<dyn Fn(u32) -> Freedom + 'a>,
    /// How often an unknown was in a place that was broken.
    times: BTreeMap<u32, usize>,
}

impl<'a> GivingWay<'a> {
    /// Nothing gives way yet. `neighbors` has the neighbours of an unknown, which may come several times, with the distances to them.
    pub(crate) fn new(
        neighbors: impl Fn(u32) -> Vec<(u32, f64)> + 'a,
        freedom: impl Fn(u32) -> Freedom + 'a,
    ) -> Self {
        Self { neighbors: Box::new(neighbors), freedom: Box::new(freedom), times: BTreeMap::new() }
    }

    /// Smooths motions until they break nothing. `broken` gives the unknowns of each place that is broken under some motions.
    ///
    /// # Errors
    /// [`NetworkError::Folded`] where something is still broken after all attempts.
    pub(crate) fn mend<P: AsRef<[u32]>>(
        &mut self,
        moves: &mut [DVec3],
        broken: impl FnMut(&[DVec3]) -> Vec<P>,
    ) -> Result<(), NetworkError> {
        until_unbroken(moves, broken, |moves, places| {
            self.smooth(moves, places.iter().flat_map(|place| place.as_ref()).copied());
        })
    }

    /// The same, but nothing is smoothed: what is broken moves as one by the mean of its motions, together with what that breaks beside it.
    ///
    /// # Errors
    /// As of [`Self::mend`].
    pub(crate) fn mend_by_tying<P: AsRef<[u32]>>(
        &self,
        moves: &mut [DVec3],
        broken: impl FnMut(&[DVec3]) -> Vec<P>,
    ) -> Result<(), NetworkError> {
        let mut tied = Vec::new();
        until_unbroken(moves, broken, |moves, places| {
            tied.extend(places);
            self.tie(moves, &tied);
        })
    }

    /// Makes the unknowns of each place move by the mean of their motions, and places that share some as one.
    fn tie<P: AsRef<[u32]>>(&self, moves: &mut [DVec3], places: &[P]) {
        let mut unknowns: Vec<u32> = places.iter().flat_map(|place| place.as_ref()).copied().collect();
        unknowns.sort_unstable();
        unknowns.dedup();
        let mut tied = DisjointSets::new(unknowns.len());
        let index = |unknown: u32| id(unknowns.binary_search(&unknown).expect("all are listed"));
        for place in places {
            place.as_ref().windows(2).for_each(|pair| tied.join(index(pair[0]), index(pair[1])));
        }
        let (numbers, count) = tied.numbers();
        let mut means = vec![(DVec3::ZERO, 0.0, Freedom::Everywhere); count as usize];
        for (unknown, number) in unknowns.iter().zip(&numbers) {
            let (sum, members, freedom) = &mut means[*number as usize];
            *sum += moves[*unknown as usize];
            *members += 1.0;
            *freedom = freedom.and((self.freedom)(*unknown));
        }
        for (unknown, number) in unknowns.iter().zip(&numbers) {
            let (sum, members, freedom) = means[*number as usize];
            moves[*unknown as usize] = freedom.project(sum / members);
        }
    }

    /// Smooths motions where so many rings around each unknown give way as often as it was in a place that was broken, this time included.
    pub(crate) fn smooth(&mut self, moves: &mut [DVec3], broken: impl IntoIterator<Item = u32>) {
        let broken: BTreeSet<u32> = broken.into_iter().collect();
        broken.into_iter().for_each(|unknown| *self.times.entry(unknown).or_default() += 1);
        let rings = self.rings();
        let giving_way: Vec<u32> = rings.keys().copied().collect();
        let mut neighbors: Vec<Vec<(u32, f64)>> =
            giving_way.iter().map(|unknown| (self.neighbors)(*unknown)).collect();
        let longest = neighbors.iter().flatten().map(|(_, distance)| *distance).fold(0.0, f64::max);
        neighbors.iter_mut().flatten().for_each(|(_, distance)| *distance /= longest);
        let is_deep = |unknown: &u32| rings.get(unknown).is_some_and(|ring| *ring > SMOOTHED_RINGS);
        let mut tied = DisjointSets::new(giving_way.len());
        for ((place, unknown), neighbors) in (0u32..).zip(&giving_way).zip(&neighbors) {
            for (other, distance) in neighbors {
                let moves_as_one = *distance < LEAST_DISTANCE || (is_deep(unknown) && is_deep(other));
                if moves_as_one && let Ok(other) = giving_way.binary_search(other) {
                    tied.join(place, id(other));
                }
            }
        }
        self.carry(moves, &giving_way, &neighbors, tied.numbers());
    }

    /// How many rings of neighbours reach an unknown, of those that any do.
    fn rings(&self) -> BTreeMap<u32, usize> {
        let mut rings = self.times.clone();
        for ring in (2..=self.times.values().copied().max().unwrap_or(0)).rev() {
            let at_ring = rings.iter().filter(|(_, own)| **own == ring);
            let around: Vec<(u32, f64)> =
                at_ring.flat_map(|(unknown, _)| (self.neighbors)(*unknown)).collect();
            for (unknown, _) in around {
                let own = rings.entry(unknown).or_default();
                *own = (*own).max(ring - 1);
            }
        }
        rings
    }

    /// Gives some unknowns, sorted, in groups by number, motions such that each group has the weighted mean of those of its neighbours. Distances to these are in units of the
    /// longest.
    fn carry(
        &self,
        moves: &mut [DVec3],
        unknowns: &[u32],
        neighbors: &[Vec<(u32, f64)>],
        (numbers, count): (Vec<u32>, u32),
    ) {
        let weight = |distance: f64| 1.0 / distance.max(LEAST_DISTANCE);
        let mut groups = vec![Group::default(); count as usize];
        for ((unknown, number), neighbors) in unknowns.iter().zip(&numbers).zip(neighbors) {
            let group = &mut groups[*number as usize];
            group.freedom = group.freedom.and((self.freedom)(*unknown));
            for (other, distance) in neighbors {
                let weight = weight(*distance);
                match unknowns.binary_search(other).map(|place| numbers[place]) {
                    Ok(other) if other == *number => continue,
                    Ok(other) => group.row.push((other as usize, weight)),
                    Err(_) => group.pull += moves[*other as usize] * weight,
                }
                group.weight += weight;
            }
        }
        let means = means_by_part(&groups);
        for (unknown, number) in unknowns.iter().zip(&numbers) {
            moves[*unknown as usize] = means[*number as usize];
        }
    }
}

/// Changes motions where they break something until they do not.
fn until_unbroken<P>(
    moves: &mut [DVec3],
    mut broken: impl FnMut(&[DVec3]) -> Vec<P>,
    mut change: impl FnMut(&mut [DVec3], Vec<P>),
) -> Result<(), NetworkError> {
    let mut count = 0;
    for _ in 0..ATTEMPTS {
        let places = broken(moves);
        count = places.len();
        if count == 0 {
            return Ok(());
        }
        change(moves, places);
    }
    Err(NetworkError::Folded { count, grains: Vec::new() })
}

/// The weighted mean of the motions around each group. Places that are apart are solved each for itself: together they would take as many iterations as
/// the worst of them.
fn means_by_part(groups: &[Group]) -> Vec<DVec3> {
    let mut connected = DisjointSets::new(groups.len());
    for (number, group) in (0u32..).zip(groups) {
        group.row.iter().for_each(|(other, _)| connected.join(number, id(*other)));
    }
    let (parts, part_count) = connected.numbers();
    let parts = Grouped::new(part_count as usize, parts.iter().map(|part| *part as usize).zip(0usize..));
    let of_part = |part: usize| {
        let members = parts.of(part);
        let place = |group: usize| members.binary_search(&group).expect("rows stay within their part");
        let alone = |group: &usize| {
            let Group { freedom, pull, weight, ref row } = groups[*group];
            Group { freedom, pull, weight, row: row.iter().map(|(other, by)| (place(*other), *by)).collect() }
        };
        means(&members.iter().map(alone).collect::<Vec<_>>())
    };
    let found: Vec<Vec<DVec3>> = (0..parts.count()).into_par_iter().map(of_part).collect();
    let mut means = vec![DVec3::ZERO; groups.len()];
    for (part, found) in found.into_iter().enumerate() {
        parts.of(part).iter().zip(found).for_each(|(group, mean)| means[*group] = mean);
    }
    means
}

/// The same of groups that hang together.
fn means(groups: &[Group]) -> Vec<DVec3> {
    let at = |vector: &[f64], group: usize| DVec3::from_slice(&vector[3 * group..]);
    let right_side: Vec<f64> =
        groups.iter().flat_map(|group| group.freedom.project(group.pull).to_array()).collect();
    let apply = |vector: &[f64]| -> Vec<f64> {
        let image = |(number, Group { freedom, row, weight, .. }): (usize, &Group)| {
            let pull: DVec3 = row.iter().map(|(other, weight)| at(vector, *other) * *weight).sum();
            freedom.project(at(vector, number) * *weight - pull).to_array()
        };
        groups.iter().enumerate().flat_map(image).collect()
    };
    let precondition = |residual: &[f64]| -> Vec<f64> {
        // What nothing is beside stays.
        let over_weight =
            |(place, left): (usize, &f64)| left / groups[place / 3].weight.max(f64::MIN_POSITIVE);
        residual.iter().enumerate().map(over_weight).collect()
    };
    let means = solve(apply, precondition, &right_side, &Limits::of(right_side.len(), SOLVED));
    (0..groups.len()).map(|group| at(&means, group)).collect()
}

/// Unknowns that move as one.
#[derive(Debug, Clone, Default)]
struct Group {
    freedom: Freedom,
    /// Other groups and their weights.
    row: Vec<(usize, f64)>,
    /// What does not give way, by weight and motion.
    pull: DVec3,
    /// The sum of all weights.
    weight: f64,
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Unknowns in a row, at the given distances from each other, which may all move but for the first and the last.
    fn row(distances: &[f64]) -> GivingWay<'_> {
        let last = u32::try_from(distances.len()).expect("few");
        let neighbors = move |unknown: u32| {
            let before = unknown.checked_sub(1).map(|before| (before, distances[before as usize]));
            let after = (unknown < last).then(|| (unknown + 1, distances[unknown as usize]));
            before.into_iter().chain(after).collect()
        };
        let freedom = move |unknown| {
            if unknown == 0 || unknown == last { Freedom::Nowhere } else { Freedom::Everywhere }
        };
        GivingWay::new(neighbors, freedom)
    }

    /// Motions are then linear in the distance along the row, however unlike its parts are.
    #[test]
    fn what_lies_between_is_carried_along() {
        let distances = [1.0, 1.0, 1e-3, 2.0, 1.0];
        let mut moves = [0.0, 0.0, 5.0, -7.0, 4.0, 0.0].map(|by| DVec3::X * by);
        row(&distances).smooth(&mut moves, [2, 3]);
        let slope = 4.0 / 3.001;
        let expected = [0.0, 0.0, slope, 1.001 * slope, 4.0, 0.0];
        for (by, expected) in moves.iter().zip(expected) {
            assert!(by.distance(DVec3::X * expected) < 1e-9, "{by} instead of {expected}");
        }
    }

    /// Rings grow, and what is deep within them moves as one.
    #[test]
    fn what_is_broken_again_and_again_moves_as_one() {
        let distances = [1.0; 60];
        let mut moves = vec![DVec3::ZERO; 61];
        moves[31..].fill(DVec3::Y);
        let mut giving_way = row(&distances);
        for _ in 0..SMOOTHED_RINGS + 3 {
            giving_way.smooth(&mut moves, [30]);
        }
        for (unknown, by) in (0i32..).zip(&moves) {
            let outside = f64::from((unknown - 30).signum() * ((unknown - 30).abs() - 2).max(0));
            let expected = 0.5 + (outside / (SMOOTHED_RINGS as f64 + 1.0) / 2.0).clamp(-0.5, 0.5);
            assert!((by.y - expected).abs() < 1e-9, "{unknown}: {by} instead of {expected}");
        }
    }

    /// Each moved by itself once, by a millionth of the way relative to the other: that turned the line between them over again and again.
    #[test]
    fn neighbors_without_distance_move_as_one() {
        let mut moves = [0.0, 0.0, 5.0, -7.0, 4.0, 4.0].map(|by| DVec3::X * by);
        row(&[1.0, 1.0, 1e-12, 1.0, 1.0]).smooth(&mut moves, [2, 3]);
        assert_eq!(moves[2], moves[3]);
        assert!(moves[2].distance(DVec3::X * 2.0) < 1e-9, "{}", moves[2]);
    }

    #[test]
    fn what_no_attempt_mends_is_counted() {
        let mut moves = vec![DVec3::Y; 5];
        let error = row(&[1.0; 4]).mend(&mut moves, |_| vec![[1, 2], [2, 3]]);
        assert!(matches!(error, Err(NetworkError::Folded { count: 2, .. })), "{error:?}");
    }
}
