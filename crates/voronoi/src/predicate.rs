//! What cells are cut by, in floating point, and exact decisions for when that cannot tell.

use glam::DVec3;

use crate::accurate_sum::{accurate_sum, sum_and_rest};
use crate::exact_plane::{Decision, common_exponent};
use crate::generator::Generator;
use crate::half_space::{EVALUATION_ERROR, HalfSpace};
use crate::images::{Image, ImageTable};
use crate::tessellation::Shift;
use crate::{Domain, Wall, big, narrow};

/// The input that exact decisions are made from. Sites are the seeds, then the periodic images of seeds.
#[derive(Clone, Copy)]
pub(crate) struct ExactInput<'a> {
    pub(crate) domain: &'a Domain,
    pub(crate) seeds: &'a [DVec3],
    /// Power weights, one per seed; all 0 if there are none.
    pub(crate) weights: Option<&'a [f64]>,
    pub(crate) images: &'a ImageTable,
}

impl<'a> ExactInput<'a> {
    /// The seed, and by how many periods it is moved, that a site is the image of.
    pub(crate) fn image(self, site: u32) -> Image {
        match (site as usize).checked_sub(self.seeds.len()) {
            None => Image { seed: site, shift: Shift::NONE },
            Some(image) => self.images.list()[image],
        }
    }

    /// The site that is an image of a seed, if there is one.
    pub(crate) fn site(self, image: Image) -> Option<u32> {
        if image.shift == Shift::NONE {
            return Some(image.seed);
        }
        let place = self.images.find(image)?;
        Some(u32::try_from(self.seeds.len() + place).expect("site ids were checked to fit"))
    }

    /// Number of sites.
    pub(crate) fn site_count(self) -> u32 {
        let count = self.seeds.len() + self.images.list().len();
        u32::try_from(count).expect("site ids were checked to fit")
    }

    /// Where a site lies, rounded.
    pub(crate) fn position(self, site: u32) -> DVec3 {
        let Image { seed, shift } = self.image(site);
        self.seeds[seed as usize] + shift.vector(self.domain)
    }

    /// What bounds the cell of a seed across an axis before any other seed does: a wall, or its own image one period away.
    pub(crate) fn outermost(self, seed: u32, wall: Wall) -> Generator {
        if !self.domain.periodic().test(wall.axis()) {
            return Generator::side(wall);
        }
        let mut shift = [0; 3];
        shift[wall.axis()] = if wall.is_upper() { 1 } else { -1 };
        self.site(Image { seed, shift: Shift(shift) }).map_or(Generator::side(wall), Generator::site)
    }

    /// The planes that bound the cell of a seed before any other seed does, two for each axis.
    pub(crate) fn outermost_planes(self, seed: u32) -> impl Iterator<Item = Generator> + use<'a> {
        Wall::ALL[..2 * self.domain.axes()].iter().map(move |wall| self.outermost(seed, *wall))
    }

    /// Distance of a seed from a wall, across a periodic axis half a period.
    #[inline]
    pub(crate) fn outermost_distance(self, seed: u32, wall: Wall) -> f64 {
        let axis = wall.axis();
        if self.domain.periodic().test(axis) {
            return 0.5 * self.domain.size()[axis];
        }
        (self.domain.side_coordinate(wall) - self.seeds[seed as usize][axis]).abs()
    }

    /// Visits the walls of a polyhedron that are at most as far away from a seed as some distance, with theirs.
    #[inline]
    pub(crate) fn for_each_facet_within(self, seed: u32, to: f64, mut visit: impl FnMut(HalfSpace, f64)) {
        let own = self.seeds[seed as usize];
        self.domain.for_each_wall_within(own, to, |wall| {
            let plane = HalfSpace::of_wall(own, wall, self.domain);
            // Rounding must not make it farther than it is.
            let distance = (plane.offset - EVALUATION_ERROR * plane.offset_size).max(0.0);
            if distance <= to {
                visit(plane, distance);
            }
        });
    }

    /// Whether a site is one of those that a cell begins with: the seed itself or one of its nearest images.
    pub(crate) fn bounds_from_start(self, seed: u32, site: u32) -> bool {
        let image = self.image(site);
        image.seed == seed && image.shift.0.iter().map(|shift| shift.unsigned_abs()).sum::<u8>() <= 1
    }

    /// Power weight of a site.
    #[inline]
    pub(crate) fn weight(self, site: u32) -> f64 {
        self.weights.map_or(0.0, |weights| weights[self.image(site).seed as usize])
    }

    /// The vector from a seed to a site, each coordinate rounded once or twice.
    #[inline]
    pub(crate) fn difference(self, seed: u32, site: u32) -> DVec3 {
        match self.seeds.get(site as usize) {
            Some(other) => other - self.seeds[seed as usize],
            None => self.difference_to_image(seed, site),
        }
    }

    fn difference_to_image(self, seed: u32, site: u32) -> DVec3 {
        let own = self.seeds[seed as usize];
        let image = self.image(site);
        let other = self.seeds[image.seed as usize];
        DVec3::from_array([0, 1, 2].map(|axis| {
            if image.shift.0[axis] == 0 {
                return other[axis] - own[axis];
            }
            // Shifts of at most two periods keep the products exact.
            let shift = f64::from(image.shift.0[axis]);
            let (lower, upper) = (self.domain.lower()[axis], self.domain.upper()[axis]);
            let (period, period_rest) = sum_and_rest(upper, -lower);
            if period_rest == 0.0 {
                // Either the second sum is exact, or it cancels too little for the rests to count.
                let (difference, rest) = sum_and_rest(other[axis], -own[axis]);
                let (sum, second_rest) = sum_and_rest(difference, shift * period);
                return sum + (rest + second_rest);
            }
            accurate_sum([other[axis], -own[axis], shift * upper, -shift * lower])
        }))
    }

    /// Whether plane `cutter` cuts off the vertex of `planes` (in positive orientation) from the cell of `seed`.
    pub(crate) fn decide(self, seed: u32, planes: [Generator; 3], cutter: Generator) -> Decision {
        let [a, b, c] = planes;
        let generators = [a, b, c, cutter];
        let exponent = common_exponent(self, seed, &generators);
        match narrow::planes(self, seed, generators, exponent) {
            Some(planes) => narrow::decide(&planes),
            None => big::decide(&big::planes(self, seed, generators, exponent)),
        }
    }

    /// Whether three planes are in positive orientation: the determinant of their normals is positive.
    pub(crate) fn is_positive(self, seed: u32, planes: [Generator; 3]) -> bool {
        let exponent = common_exponent(self, seed, &planes);
        match narrow::planes(self, seed, planes, exponent) {
            Some(planes) => narrow::is_positive(&planes),
            None => big::is_positive(&big::planes(self, seed, planes, exponent)),
        }
    }

    /// The vertex of three planes relative to the seed, each coordinate rounded to nearest but for one or two last places.
    pub(crate) fn vertex(self, seed: u32, planes: [Generator; 3]) -> DVec3 {
        let exponent = common_exponent(self, seed, &planes);
        match narrow::planes(self, seed, planes, exponent) {
            Some(planes) => narrow::vertex(&planes, exponent),
            None => big::vertex(&big::planes(self, seed, planes, exponent), exponent),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Wall;

    fn seeds() -> Vec<DVec3> {
        vec![
            DVec3::ZERO,
            DVec3::new(1.0, 0.0, 0.0),
            DVec3::new(0.0, 1.0, 0.0),
            DVec3::new(0.0, 0.0, 1.0),
            DVec3::new(1.0, 1.0, 1.0),
        ]
    }

    fn decide(seeds: &[DVec3], seed: u32, planes: [u32; 3], cutter: u32) -> Decision {
        let domain = Domain::unit_cube();
        let images = ImageTable::default();
        let input = ExactInput { domain: &domain, seeds, weights: None, images: &images };
        input.decide(seed, planes.map(Generator::site), Generator::site(cutter))
    }

    #[test]
    fn sign_is_exact_one_unit_in_the_last_place_from_a_tie() {
        let mut seeds = seeds();
        assert!(decide(&seeds, 0, [1, 2, 3], 4).tie);
        seeds[4].x = 1.0f64.next_down();
        assert_eq!(decide(&seeds, 0, [1, 2, 3], 4), Decision { beyond: true, tie: false });
        seeds[4].x = 1.0f64.next_up();
        assert_eq!(decide(&seeds, 0, [1, 2, 3], 4), Decision { beyond: false, tie: false });
    }

    #[test]
    fn a_broken_tie_is_the_same_from_every_cell() {
        // Vertex {0, 1, 2, 3} against seed 4, asked by each of the four cells; the odd permutations swap two planes.
        let seeds = seeds();
        let answers = [
            decide(&seeds, 0, [1, 2, 3], 4),
            decide(&seeds, 1, [0, 3, 2], 4),
            decide(&seeds, 2, [0, 1, 3], 4),
            decide(&seeds, 3, [0, 2, 1], 4),
        ];
        assert!(answers.iter().all(|answer| *answer == answers[0] && answer.tie), "{answers:?}");
    }

    #[test]
    fn exact_vertex_is_the_circumcentre() {
        let domain = Domain::unit_cube();
        let images = ImageTable::default();
        let seeds = seeds();
        let input = ExactInput { domain: &domain, seeds: &seeds, weights: None, images: &images };
        let vertex = input.vertex(0, [1, 2, 3].map(Generator::site));
        assert_eq!(vertex, DVec3::splat(0.5));
        let tiny: Vec<DVec3> = seeds.iter().map(|seed| *seed * 1e-200).collect();
        let input = ExactInput { domain: &domain, seeds: &tiny, weights: None, images: &images };
        assert_eq!(input.vertex(0, [1, 2, 3].map(Generator::site)), DVec3::splat(0.5e-200));
    }

    #[test]
    fn walls_take_part_in_decisions() {
        let domain = Domain::unit_cube();
        let images = ImageTable::default();
        let seeds = [DVec3::new(0.25, 0.5, 0.5), DVec3::new(0.75, 0.5, 0.5)];
        let input = ExactInput { domain: &domain, seeds: &seeds, weights: None, images: &images };
        let walls = [Wall::ALL[1], Wall::ALL[3], Wall::ALL[5]].map(Generator::side);
        assert!(input.decide(0, walls, Generator::site(1)).beyond);
        assert_eq!(input.vertex(0, walls), DVec3::new(0.75, 0.5, 0.5));
    }
}
