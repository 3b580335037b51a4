//! Seeds drawn at random.

use glam::DVec3;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use voronoi::{Dimension, Domain};

/// Draws `count` points, independent and uniform in the domain; z = 0 in 2D.
///
/// The same arguments give the same points on every machine. The generator is ChaCha with 8 rounds. Its
/// 256-bit key is eight outputs of PCG32 (XSH-RR, multiplier 6364136223846793005, increment
/// 11634580027462260723) from the state `random_seed`, which advances before each output; this is
/// `seed_from_u64` of `rand_core`. Nonce and counter start at 0. Each coordinate takes the next 64 bits b of
/// the stream (little-endian) as lower + floor(b / 2^11) 2^-53 side, in the order x, y and, in 3D, z, one
/// seed after the other.
///
/// In a domain that is no box, the sides are those of the box around it, and points outside the domain are left out.
pub fn random_seeds(count: usize, domain: &Domain, random_seed: u64) -> Vec<DVec3> {
    random_points(domain, random_seed).take(count).collect()
}

/// The stream of points behind [`random_seeds`], without end.
pub(crate) fn random_points(domain: &Domain, random_seed: u64) -> impl Iterator<Item = DVec3> + use<'_> {
    let mut generator = ChaCha8Rng::seed_from_u64(random_seed);
    let (lower, size, dimension) = (domain.lower(), domain.size(), domain.dimension());
    let mut coordinate = move |axis: usize| lower[axis] + unit_fraction(generator.next_u64()) * size[axis];
    let in_box = std::iter::repeat_with(move || match dimension {
        Dimension::Two => DVec3::new(coordinate(0), coordinate(1), 0.0),
        Dimension::Three => DVec3::new(coordinate(0), coordinate(1), coordinate(2)),
    });
    in_box.filter(|point| domain.is_box() || domain.contains(*point))
}

/// A number in [0, 1) from the upper 53 bits, as many as a double holds.
fn unit_fraction(bits: u64) -> f64 {
    (bits >> 11) as f64 * 2f64.powi(-53)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn first_numbers_are_pinned() {
        // Computed apart from this crate, from the description above.
        let seeds = random_seeds(100, &Domain::unit_cube(), 1);
        assert_eq!(seeds[0], DVec3::new(0.40248566366484806, 0.08038370892978197, 0.5965601809348549));
        assert_eq!(seeds[1], DVec3::new(0.2193245804838001, 0.28369059130373764, 0.7106102236811087));
        assert_eq!(seeds[99], DVec3::new(0.4146468404438297, 0.24135386601091247, 0.8037501530529534));
    }

    #[test]
    fn longer_list_begins_with_the_shorter_and_the_plane_draws_two_numbers_a_seed() {
        let space = random_seeds(4, &Domain::unit_cube(), 7);
        assert_eq!(random_seeds(2, &Domain::unit_cube(), 7), space[..2]);
        let stream: Vec<f64> = space.iter().flat_map(|seed| seed.to_array()).collect();
        let plane = random_seeds(6, &Domain::unit_square(), 7);
        assert_eq!(plane.iter().flat_map(|seed| [seed.x, seed.y]).collect::<Vec<_>>(), stream);
        assert!(plane.iter().all(|seed| seed.z == 0.0));
    }

    #[test]
    fn seeds_fill_the_box_evenly() {
        let (lower, upper) = (DVec3::new(-1.0, 2.0, 0.0), DVec3::new(2.0, 3.0, 0.2e-8));
        let domain = Domain::cuboid(lower, upper).unwrap();
        let seeds = random_seeds(100_000, &domain, 3);
        assert!(seeds.iter().all(|&seed| domain.contains(seed)));
        // The mean of n uniform numbers has the standard error side / sqrt(12 n).
        let mean = seeds.iter().sum::<DVec3>() / 1e5;
        let error = (mean - (lower + upper) / 2.0) / domain.size() * (12.0 * 1e5_f64).sqrt();
        assert!(error.abs().max_element() < 4.0, "{error}");
    }
}
