//! Seeds drawn at random.

use glam::DVec3;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use voronoi::{CellId, Dimension, Domain, Tessellation};

/// Share of its box that a domain must fill for points to be drawn in the box.
const FEWEST_HITS: f64 = 1.0 / 64.0;

/// Draws `count` points, independent and uniform in the domain; z = 0 in 2D.
///
/// The same arguments give the same points on every machine. The generator is ChaCha with 8 rounds. Its
/// 256-bit key is eight outputs of PCG32 (XSH-RR, multiplier 6364136223846793005, increment
/// 11634580027462260723) from the state `random_seed`, which advances before each output; this is
/// `seed_from_u64` of `rand_core`. Nonce and counter start at 0. Each coordinate takes the next 64 bits b of
/// the stream (little-endian) as lower + floor(b / 2^11) 2^-53 side, in the order x, y and, in 3D, z, one
/// seed after the other.
///
/// In a domain that is no box, the sides are those of the box around it, and points outside the domain are left out. Where
/// these would be more than 63 of 64, points are drawn in the simplices between the middle of the domain ([`Domain::center`]),
/// the first corner of a face and each two that follow (in the plane, the two ends of an edge): the first number chooses among
/// the simplices, laid end to end, the others, sorted, are the ends of the shares of the first corners.
///
/// ```
/// use grainsmooth::random_seeds;
/// use grainsmooth::voronoi::Domain;
///
/// let seeds = random_seeds(100, &Domain::unit_cube(), 7);
/// assert_eq!(seeds.len(), 100);
/// assert_eq!(seeds[..10], random_seeds(10, &Domain::unit_cube(), 7), "the same stream");
/// ```
pub fn random_seeds(count: usize, domain: &Domain, random_seed: u64) -> Vec<DVec3> {
    random_points(domain, random_seed).take(count).collect()
}

/// The stream of points behind [`random_seeds`], without end.
pub(crate) fn random_points(
    domain: &Domain,
    random_seed: u64,
) -> Box<dyn Iterator<Item = DVec3> + Send + '_> {
    let mut generator = ChaCha8Rng::seed_from_u64(random_seed);
    let mut fraction = move || unit_fraction(generator.next_u64());
    let (lower, size, dimension) = (domain.lower(), domain.size(), domain.dimension());
    let of_box = match dimension {
        Dimension::Two => size.x * size.y,
        Dimension::Three => size.element_product(),
    };
    if domain.measure() < FEWEST_HITS * of_box {
        let simplices = Simplices::new(domain);
        return Box::new(std::iter::repeat_with(move || simplices.point(domain, &mut fraction)));
    }
    let mut coordinate = move |axis: usize| lower[axis] + fraction() * size[axis];
    let in_box = std::iter::repeat_with(move || match dimension {
        Dimension::Two => DVec3::new(coordinate(0), coordinate(1), 0.0),
        Dimension::Three => DVec3::new(coordinate(0), coordinate(1), coordinate(2)),
    });
    Box::new(in_box.filter(|point| domain.is_box() || domain.contains(*point)))
}

/// A domain cut into tetrahedra around its middle; in the plane, into triangles.
struct Simplices {
    /// The corners but the middle, in the plane two; and the volume up to this one.
    simplices: Vec<(Vec<DVec3>, f64)>,
}

impl Simplices {
    fn new(domain: &Domain) -> Self {
        let center = domain.center();
        let whole = Tessellation::new(domain, &[center]).expect("the middle of a domain lies inside");
        let mut volume = 0.0;
        let mut simplices = Vec::new();
        for face in whole.cell_faces(CellId(0)) {
            let corners = whole.face_corners(*face).iter().map(|corner| whole.vertices()[corner.index()]);
            let corners: Vec<DVec3> = corners.collect();
            let mut push = |corners: &[DVec3], size: f64| {
                volume += size.abs();
                simplices.push((corners.to_vec(), volume));
            };
            match (domain.dimension(), &corners[..]) {
                (Dimension::Two, [a, b, ..]) => push(&[*a, *b], (a - center).cross(b - center).z),
                (_, [a, others @ ..]) => {
                    for ends in others.windows(2) {
                        let [b, c] = [ends[0], ends[1]];
                        push(&[*a, b, c], (a - center).cross(b - center).dot(c - center));
                    }
                }
                (_, []) => {}
            }
        }
        Self { simplices }
    }

    fn point(&self, domain: &Domain, fraction: &mut impl FnMut() -> f64) -> DVec3 {
        let center = domain.center();
        let all = self.simplices.last().map_or(0.0, |(_, volume)| *volume);
        let place = fraction() * all;
        let number = self.simplices.partition_point(|(_, volume)| *volume <= place);
        let Some((corners, _)) = self.simplices.get(number) else { return center };
        let mut shares: Vec<f64> = corners.iter().map(|_| fraction()).collect();
        shares.sort_unstable_by(f64::total_cmp);
        let starts = std::iter::once(0.0).chain(shares.iter().copied());
        let terms =
            shares.iter().zip(starts).zip(corners).map(|((end, start), corner)| (corner, end - start));
        let point = terms.fold(center, |point, (corner, share)| point + (corner - center) * share);
        // Rounding may put it a last place outside: the way to the middle leads inside.
        let steps = (-52..0).map(|exponent| point.lerp(center, 2f64.powi(exponent)));
        std::iter::once(point).chain(steps).find(|place| domain.contains(*place)).unwrap_or(center)
    }
}

/// A number in [0, 1) from the upper 53 bits, as many as a double holds.
pub(crate) fn unit_fraction(bits: u64) -> f64 {
    (bits >> 11) as f64 * 2f64.powi(-53)
}

#[cfg(test)]
mod tests {
    use voronoi::WallPlane;

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
    fn seeds_fill_a_plate_across_its_box_evenly() {
        // Of thickness 2e-9, along the diagonal plane x + y + z = 0 of a cube.
        let plane = |normal: DVec3, offset| WallPlane::HalfSpace { normal, offset };
        let axes = [DVec3::X, DVec3::Y, DVec3::Z];
        let sides = axes.iter().flat_map(|axis| [plane(*axis, 1.0), plane(-axis, 1.0)]);
        let faces = [plane(DVec3::ONE, 1e-9), plane(DVec3::NEG_ONE, 1e-9)];
        let domain = Domain::polyhedron(sides.chain(faces).collect()).unwrap();
        let seeds = random_seeds(20_000, &domain, 3);
        assert!(seeds.iter().all(|&seed| domain.contains(seed)));
        // A regular hexagon of radius r has the moment 5/24 r^2 along each of its axes, here two thirds of that along x.
        let squares = seeds.iter().map(|seed| seed.x * seed.x).sum::<f64>() / 2e4;
        assert!((squares / (2.0 * 5.0 / 24.0 * 2.0 / 3.0) - 1.0).abs() < 0.03, "{squares}");
        let mean = seeds.iter().sum::<DVec3>() / 2e4;
        assert!(mean.abs().max_element() < 0.02, "{mean}");
        let above = seeds.iter().filter(|seed| seed.element_sum() > 0.0).count();
        assert!((9_500..10_500).contains(&above), "{above}");

        let lines = [
            plane(DVec3::X, 1.0),
            plane(DVec3::new(-1.0, -1.0, 0.0), 1e-6),
            plane(DVec3::new(1.0, 1.0, 0.0), 1e-6),
            plane(DVec3::Y, 1.0),
        ];
        let domain = Domain::polygon(lines.to_vec()).unwrap();
        let seeds = random_seeds(10_000, &domain, 3);
        assert!(seeds.iter().all(|&seed| domain.contains(seed) && seed.z == 0.0));
        // Uniform from -1 to 1.
        let squares = seeds.iter().map(|seed| seed.x * seed.x).sum::<f64>() / 1e4;
        assert!((3.0 * squares - 1.0).abs() < 0.04, "{squares}");
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
