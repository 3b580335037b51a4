//! Random seeds that keep a distance from each other.

use glam::DVec3;
use voronoi::Domain;

use crate::seeds::random::random_points;

/// The smallest distance between seeds, as a share of the mean spacing (the edge of a cube, in the plane of a square, of the
/// volume that falls to a seed). Darts thrown without end would pack up to 0.90 in space (38 % of it covered by balls of that
/// diameter) and 0.83 in the plane (55 %; Feder 1980); at this share about one in twenty still finds room.
const CLEARANCE: f64 = 0.75;

/// Darts in a row that find no room before the distance is made smaller.
const PATIENCE: u32 = 10_000;

/// What the distance is made smaller by.
const SHRINKAGE: f64 = 0.95;

/// Draws `count` points, uniform in the domain but for keeping a distance from each other: dart throwing.
///
/// The points are the first ones of the stream behind [`random_seeds`](crate::random_seeds) that lie at least 0.75 mean spacings
/// from those before. (Should there be no room left for that, the distance is lowered by 5 % after every 10 000 darts in
/// vain.) In a box distances are measured across opposite walls too, so that the seeds suit one that repeats.
///
/// ```
/// use grainsmooth::poisson_disc_seeds;
/// use grainsmooth::voronoi::Domain;
///
/// let seeds = poisson_disc_seeds(8, &Domain::unit_cube(), 7);
/// for (k, seed) in seeds.iter().enumerate() {
///     assert!(seeds[..k].iter().all(|other| other.distance(*seed) >= 0.3), "0.75 of the spacing 1/2, or a little less");
/// }
/// ```
pub fn poisson_disc_seeds(count: usize, domain: &Domain, random_seed: u64) -> Vec<DVec3> {
    throw_darts(count, domain, random_seed, CLEARANCE)
}

fn throw_darts(count: usize, domain: &Domain, random_seed: u64, clearance: f64) -> Vec<DVec3> {
    let spacing = domain.dimension().cube_edge(domain.measure() / count as f64);
    let mut distance = clearance * spacing;
    let mut bins = Bins::new(domain, distance, count);
    let mut darts = random_points(domain, random_seed);
    let mut misses = 0;
    let mut seeds = Vec::with_capacity(count);
    while seeds.len() < count {
        let dart = darts.next().expect("the stream has no end");
        if bins.is_free(dart, distance) {
            bins.insert(dart);
            seeds.push(dart);
            misses = 0;
        } else {
            misses += 1;
        }
        if misses == PATIENCE {
            distance *= SHRINKAGE;
            misses = 0;
        }
    }
    seeds
}

/// Points sorted into equal boxes that are nowhere narrower than a distance.
struct Bins {
    lower: DVec3,
    size: DVec3,
    is_box: bool,
    counts: [usize; 3],
    points: Vec<Vec<DVec3>>,
}

impl Bins {
    fn new(domain: &Domain, width: f64, point_count: usize) -> Self {
        let (lower, size) = (domain.lower(), domain.size());
        // More bins than points along one axis would only be empty.
        let most = point_count as f64;
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "from 1 to the number of points"
        )]
        let mut counts = size.to_array().map(|side| (side / width).floor().clamp(1.0, most) as usize);
        while counts.iter().fold(1usize, |product, count| product.saturating_mul(*count))
            > 4 * point_count + 8
        {
            let largest = counts.iter_mut().max().expect("three axes");
            *largest = largest.div_ceil(2);
        }
        Self {
            lower,
            size,
            is_box: domain.is_box(),
            counts,
            points: vec![Vec::new(); counts.iter().product()],
        }
    }

    fn bin(&self, point: DVec3) -> [usize; 3] {
        [0, 1, 2].map(|axis| {
            // A rectangle has no size along z, and one bin.
            let share =
                if self.counts[axis] == 1 { 0.0 } else { (point - self.lower)[axis] / self.size[axis] };
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "a share from 0 to 1"
            )]
            let bin = (share * self.counts[axis] as f64) as usize;
            bin.min(self.counts[axis] - 1)
        })
    }

    fn index(&self, [x, y, z]: [usize; 3]) -> usize {
        (z * self.counts[1] + y) * self.counts[0] + x
    }

    fn insert(&mut self, point: DVec3) {
        let index = self.index(self.bin(point));
        self.points[index].push(point);
    }

    fn is_free(&self, point: DVec3, distance: f64) -> bool {
        let bin = self.bin(point);
        let around = |axis: usize| {
            let count = self.counts[axis];
            let all = [bin[axis], (bin[axis] + 1) % count, (bin[axis] + count - 1) % count];
            // Fewer than three bins along an axis are met more than once.
            all.into_iter().take(count)
        };
        around(2).all(|z| {
            around(1).all(|y| {
                around(0).all(|x| {
                    let near = &self.points[self.index([x, y, z])];
                    near.iter().all(|other| self.distance(point, *other) >= distance)
                })
            })
        })
    }

    /// The distance of two points; in a box, of one whose opposite walls are joined.
    fn distance(&self, a: DVec3, b: DVec3) -> f64 {
        let apart = (a - b).abs();
        if !self.is_box {
            return apart.length();
        }
        apart.min(self.size - apart).length()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn smallest_distance(seeds: &[DVec3], size: DVec3) -> f64 {
        let mut smallest = f64::INFINITY;
        for (i, a) in seeds.iter().enumerate() {
            for b in &seeds[..i] {
                let apart = (*a - *b).abs();
                smallest = smallest.min(apart.min(size - apart).length());
            }
        }
        smallest
    }

    #[test]
    fn seeds_keep_three_quarters_of_the_mean_spacing() {
        let box_size = DVec3::new(1.0, 3.0, 0.5);
        for (domain, spacing) in [
            (Domain::cuboid(DVec3::ZERO, box_size).expect("a box"), (1.5f64 / 1000.0).cbrt()),
            (Domain::rectangle(DVec3::ZERO, box_size).expect("a rectangle"), (3.0f64 / 1000.0).sqrt()),
        ] {
            let seeds = poisson_disc_seeds(1000, &domain, 5);
            assert_eq!(seeds.len(), 1000);
            assert!(seeds.iter().all(|seed| domain.contains(*seed)));
            let smallest = smallest_distance(&seeds, domain.size());
            assert!(smallest >= 0.75 * spacing && smallest < 0.76 * spacing, "{smallest} of {spacing}");
            assert_eq!(poisson_disc_seeds(1000, &domain, 5), seeds);
            assert_ne!(poisson_disc_seeds(1000, &domain, 6), seeds);
        }
    }

    #[test]
    fn where_there_is_no_room_the_distance_becomes_smaller() {
        // Spheres packed most densely have a diameter of 1.12 mean spacings.
        let seeds = throw_darts(50, &Domain::unit_cube(), 1, 2.0);
        let smallest = smallest_distance(&seeds, DVec3::ONE) * 50f64.cbrt();
        assert!(smallest > 0.7 && smallest < 1.12, "{smallest}");
        for size in [DVec3::new(1.0, 1.0, 1e-12), DVec3::new(1e-9, 1.0, 1e9)] {
            let domain = Domain::cuboid(DVec3::ZERO, size).expect("a box");
            for count in [1, 2, 3, 40] {
                assert_eq!(poisson_disc_seeds(count, &domain, 1).len(), count);
            }
        }
    }
}
