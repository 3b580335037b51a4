//! Exact decisions, for when floating point cannot tell.
//!
//! A cell of seed i is bounded by planes `n . y <= D / 2`, with y relative to the seed: for a bisector with seed j,
//! `n = s_j - s_i` and `D = |n|^2 + w_i - w_j` with the power weights w; for a wall, `n` is its outward normal and `D` twice the distance to it. Three planes
//! a, b, c with positive determinant meet in a vertex; a fourth plane m cuts it off when
//!
//! `n_m . (D_a n_b x n_c + D_b n_c x n_a + D_c n_a x n_b) - D_m det(n_a, n_b, n_c) > 0`.
//!
//! For four seeds this is the in-sphere determinant, so its sign is the same whichever of the cells asks.
//!
//! Ties are broken by simulation of simplicity (Edelsbrunner and Mücke 1990) on the power weights: each seed j gets an
//! infinitesimal weight e_j, and e_j >> e_k where j comes before k in the lexicographic order of positions. D changes by
//! e_i - e_j, the expression is linear in the D, and the first seed whose coefficient is not zero decides. One always
//! exists: that of the fourth seed is the determinant. Only the order among the seeds involved counts, which neither their
//! numbering nor a shift changes, so all periodic copies of a decision come out the same (as in CGAL's periodic
//! triangulations, Caroli and Teillaud 2009).
//!
//! Walls move, too: the D of wall k grows by an infinitesimal d_k far below all e_j, with d_k >> d_l where k < l. It only
//! matters where four walls of a polyhedron meet in a point, or one touches a corner or an edge that others make.
//!
//! A periodic image of a seed is exact, too: the seed moved by whole multiples of the exact difference of two opposite walls.

use std::cmp::Ordering;

use glam::DVec3;
use num_bigint::BigInt;
use num_traits::{Signed, ToPrimitive, Zero};

use crate::generator::{Generator, Plane};
use crate::half_space::{EVALUATION_ERROR, HalfSpace};
use crate::images::{Image, ImageTable};
use crate::tessellation::Shift;
use crate::{Domain, Wall, WallPlane, narrow};

/// On which side of a plane a vertex lies once ties are broken.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Decision {
    /// The plane cuts the vertex off.
    pub(crate) beyond: bool,
    /// The vertex lies exactly on the plane; `beyond` is then the symbolic answer.
    pub(crate) tie: bool,
}

/// The input that exact decisions are made from. Sites are the seeds, then the periodic images of seeds.
#[derive(Clone, Copy)]
pub(crate) struct ExactInput<'a> {
    pub(crate) domain: &'a Domain,
    pub(crate) seeds: &'a [DVec3],
    /// Power weights, one per seed; all 0 if there are none.
    pub(crate) weights: Option<&'a [f64]>,
    pub(crate) images: &'a ImageTable,
}

/// A plane in integers: coordinates in units of two to some exponent.
pub(crate) struct ExactPlane<N, D> {
    pub(crate) normal: [N; 3],
    pub(crate) doubled_offset: D,
    pub(crate) generator: Generator,
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

    /// Visits the walls of a polyhedron that are so far from a seed that their mirror image of it is further away than `from`
    /// and at most `to`, with that distance: they come into reach like the bisectors with these images.
    #[inline]
    pub(crate) fn for_each_facet_within(
        self,
        seed: u32,
        [from, to]: [f64; 2],
        mut visit: impl FnMut(HalfSpace, f64),
    ) {
        let own = self.seeds[seed as usize];
        for wall in self.domain.walls_within(own, 0.5 * to) {
            let plane = HalfSpace::of_wall(own, wall, self.domain);
            // Rounding must not make it farther than it is.
            let doubled = (2.0 * (plane.offset - EVALUATION_ERROR * plane.offset_size)).max(0.0);
            if doubled > from && doubled <= to {
                visit(plane, doubled);
            }
        }
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
        let exponent = self.common_exponent(seed, &generators);
        match narrow::planes(self, seed, generators, exponent) {
            Some(planes) => narrow::decide(&planes),
            None => self.decide_at_length(seed, generators, exponent),
        }
    }

    /// The same with integers of any length.
    pub(crate) fn decide_at_length(self, seed: u32, generators: [Generator; 4], exponent: i32) -> Decision {
        let planes = generators.map(|generator| self.plane(seed, generator, exponent));
        let [a, b, c, m] = &planes;
        let bc = cross(&b.normal, &c.normal);
        let ca = cross(&c.normal, &a.normal);
        let ab = cross(&a.normal, &b.normal);
        let determinant = dot(&a.normal, &bc);
        debug_assert!(determinant.is_positive());

        // Coefficients of D_a, D_b, D_c and D_m.
        let coefficients = [dot(&m.normal, &bc), dot(&m.normal, &ca), dot(&m.normal, &ab), -determinant];
        let products = coefficients.iter().zip(&planes).map(|(factor, plane)| factor * &plane.doubled_offset);
        let value: BigInt = products.sum();
        if !value.is_zero() {
            return Decision { beyond: value.is_positive(), tie: false };
        }
        let of_sites =
            coefficients.iter().zip(&planes).filter(|(_, plane)| plane.generator.as_site().is_some());
        let own: BigInt = of_sites.map(|(coefficient, _)| coefficient).sum();
        let sign = |number: &BigInt| number.cmp(&BigInt::zero());
        let beyond = break_tie(&planes, coefficients.each_ref().map(sign), sign(&own));
        Decision { beyond, tie: true }
    }

    /// Whether three planes are in positive orientation: the determinant of their normals is positive.
    pub(crate) fn is_positive(self, seed: u32, generators: [Generator; 3]) -> bool {
        let exponent = self.common_exponent(seed, &generators);
        if let Some(planes) = narrow::planes(self, seed, generators, exponent) {
            return narrow::is_positive(&planes);
        }
        let [a, b, c] = generators.map(|generator| self.plane(seed, generator, exponent).normal);
        dot(&a, &cross(&b, &c)).is_positive()
    }

    /// The vertex of three planes relative to the seed, each coordinate rounded to nearest but for one or two last places.
    pub(crate) fn vertex(self, seed: u32, planes: [Generator; 3]) -> DVec3 {
        let exponent = self.common_exponent(seed, &planes);
        let [a, b, c] = planes.map(|generator| self.plane(seed, generator, exponent));
        let bc = cross(&b.normal, &c.normal);
        let ca = cross(&c.normal, &a.normal);
        let ab = cross(&a.normal, &b.normal);
        let denominator = dot(&a.normal, &bc) * 2;
        let coordinate = |axis: usize| {
            let numerator =
                &a.doubled_offset * &bc[axis] + &b.doubled_offset * &ca[axis] + &c.doubled_offset * &ab[axis];
            ratio(numerator, &denominator, exponent)
        };
        DVec3::new(coordinate(0), coordinate(1), coordinate(2))
    }

    /// The smallest exponent such that all coordinates involved are integers times two to it, and all weights integers times
    /// two to twice it.
    pub(crate) fn common_exponent(self, seed: u32, generators: &[Generator]) -> i32 {
        let of_number = |number: f64| {
            let (mantissa, exponent) = decompose(number);
            (mantissa != 0).then_some(exponent)
        };
        let of_point = |point: DVec3| point.to_array().into_iter().filter_map(of_number).min();
        let of_site = |site: u32| {
            let image = self.image(site);
            let of_period = (0..3).filter(|axis| image.shift.0[*axis] != 0).flat_map(|axis| {
                [self.domain.lower()[axis], self.domain.upper()[axis]].into_iter().filter_map(of_number)
            });
            let of_weight = of_number(self.weight(site)).map(|exponent| exponent.div_euclid(2));
            of_weight.into_iter().chain(of_point(self.seeds[image.seed as usize])).chain(of_period).min()
        };
        let of_side = |side: Wall| {
            let opposite = Wall(side.0 ^ 1);
            [side, opposite].into_iter().filter_map(|side| of_number(self.domain.side_coordinate(side))).min()
        };
        let of_planes = generators.iter().filter_map(|generator| match generator.plane() {
            Plane::Site(site) => of_site(site),
            Plane::Side(side) => of_side(side),
            Plane::Facet(wall) => match &self.domain.wall_planes()[wall.index()] {
                // Has units of its own.
                WallPlane::HalfSpace { .. } => None,
                WallPlane::Through(points) => points.iter().copied().filter_map(of_point).min(),
            },
        });
        of_planes.chain(of_site(seed)).min().unwrap_or(0)
    }

    fn plane(self, seed: u32, generator: Generator, exponent: i32) -> ExactPlane<BigInt, BigInt> {
        let own = self.seeds[seed as usize];
        let integer = |number: f64| to_integer(number, exponent);
        let period = |axis: usize| integer(self.domain.upper()[axis]) - integer(self.domain.lower()[axis]);
        match generator.plane() {
            Plane::Site(site) => {
                let image = self.image(site);
                let other = self.seeds[image.seed as usize];
                let normal = [0, 1, 2].map(|axis| {
                    let difference = integer(other[axis]) - integer(own[axis]);
                    match image.shift.0[axis] {
                        0 => difference,
                        shift => difference + period(axis) * shift,
                    }
                });
                let weight = |site: u32| to_integer(self.weight(site), 2 * exponent);
                let doubled_offset = dot(&normal, &normal) + weight(seed) - weight(site);
                ExactPlane { normal, doubled_offset, generator }
            }
            Plane::Facet(wall) => {
                let (normal, offset) = wall_plane(&self.domain.wall_planes()[wall.index()], own, exponent);
                ExactPlane { normal, doubled_offset: offset * 2, generator }
            }
            Plane::Side(side) => {
                let axis = side.axis();
                let direction = if side.is_upper() { 1 } else { -1 };
                let mut normal = [BigInt::zero(), BigInt::zero(), BigInt::zero()];
                normal[axis] = BigInt::from(direction);
                let doubled_offset = if self.domain.periodic().test(axis) {
                    period(axis)
                } else {
                    (integer(self.domain.side_coordinate(side)) - integer(own[axis])) * (2 * direction)
                };
                ExactPlane { normal, doubled_offset, generator }
            }
        }
    }
}

/// The normal of a wall and its distance from a point in units of the normal's length, for coordinates in units of two to an
/// exponent.
fn wall_plane(plane: &WallPlane, point: DVec3, exponent: i32) -> ([BigInt; 3], BigInt) {
    let integers = |point: DVec3| point.to_array().map(|coordinate| to_integer(coordinate, exponent));
    let point = integers(point);
    match plane {
        WallPlane::HalfSpace { normal, offset } => {
            let of_number = |number: f64| {
                let (mantissa, exponent) = decompose(number);
                (mantissa != 0).then_some(exponent)
            };
            let of_normal = normal.to_array().into_iter().filter_map(of_number);
            let unit = of_normal.chain(of_number(*offset).map(|of_offset| of_offset - exponent)).min();
            let unit = unit.unwrap_or(0);
            let normal = normal.to_array().map(|coordinate| to_integer(coordinate, unit));
            let offset = to_integer(*offset, unit + exponent) - dot(&normal, &point);
            (normal, offset)
        }
        WallPlane::Through(corners) => {
            let [a, b, c] = corners.map(integers);
            let normal = cross(&minus(&b, &a), &minus(&c, &a));
            let offset = dot(&normal, &minus(&a, &point));
            (normal, offset)
        }
    }
}

/// Whether a point lies beyond a wall, exactly.
pub(crate) fn is_outside(plane: &WallPlane, point: DVec3) -> bool {
    wall_plane(plane, point, exponent_of(plane, point)).1.is_negative()
}

/// The outward normal of a wall, of length 1, each coordinate rounded twice; 0 if there is none.
pub(crate) fn unit_normal(plane: &WallPlane) -> DVec3 {
    let (normal, _) = wall_plane(plane, DVec3::ZERO, exponent_of(plane, DVec3::ZERO));
    let largest = normal.iter().map(Signed::abs).max().unwrap_or_default();
    if largest.is_zero() {
        return DVec3::ZERO;
    }
    DVec3::from_array(normal.map(|coordinate| ratio(coordinate, &largest, 0))).normalize()
}

/// An exponent such that the coordinates of a point and of a wall's are integers times two to it.
fn exponent_of(plane: &WallPlane, point: DVec3) -> i32 {
    let points: &[DVec3] = match plane {
        WallPlane::HalfSpace { .. } => &[],
        WallPlane::Through(points) => points,
    };
    let coordinates = points.iter().chain([&point]).flat_map(|point| point.to_array());
    let exponents = coordinates.map(decompose).filter(|(mantissa, _)| *mantissa != 0);
    exponents.map(|(_, exponent)| exponent).min().unwrap_or(0)
}

/// The sign of the expression's change under the symbolic weights, or else the symbolic motion of walls, from the signs of the
/// coefficients of the planes, and of the sum of those of sites.
pub(crate) fn break_tie<N: Ord + Default, D>(
    planes: &[ExactPlane<N, D>; 4],
    signs: [Ordering; 4],
    own: Ordering,
) -> bool {
    // The normal of a bisector is the other site's position relative to the seed.
    let origin = [(); 3].map(|()| N::default());
    let mut of_sites = vec![(&origin, own)];
    let mut of_walls = Vec::new();
    for (plane, sign) in planes.iter().zip(signs) {
        if plane.generator.as_site().is_some() {
            of_sites.push((&plane.normal, sign.reverse()));
        } else {
            of_walls.push((plane.generator, sign));
        }
    }
    of_sites.sort_unstable();
    of_walls.sort_unstable();
    let mut signs = of_sites.iter().map(|(_, sign)| sign).chain(of_walls.iter().map(|(_, sign)| sign));
    signs.find(|sign| sign.is_ne()).is_some_and(|sign| sign.is_gt())
}

/// A rounded sum, and what rounding left out (Knuth 1969).
fn sum_and_rest(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let of_b = sum - a;
    (sum, (a - (sum - of_b)) + (b - of_b))
}

/// A sum good to one or two last places whatever cancels: the partial sums are kept with all their digits
/// (Shewchuk 1997).
fn accurate_sum(terms: [f64; 4]) -> f64 {
    // Numbers whose digits do not overlap, from small to large.
    let mut parts = [0.0; 4];
    for (count, term) in terms.into_iter().enumerate() {
        let mut carry = term;
        for part in &mut parts[..count] {
            let (sum, rest) = sum_and_rest(carry, *part);
            *part = rest;
            carry = sum;
        }
        parts[count] = carry;
    }
    parts.iter().sum()
}

fn cross(a: &[BigInt; 3], b: &[BigInt; 3]) -> [BigInt; 3] {
    [&a[1] * &b[2] - &a[2] * &b[1], &a[2] * &b[0] - &a[0] * &b[2], &a[0] * &b[1] - &a[1] * &b[0]]
}

fn minus(a: &[BigInt; 3], b: &[BigInt; 3]) -> [BigInt; 3] {
    [&a[0] - &b[0], &a[1] - &b[1], &a[2] - &b[2]]
}

fn dot(a: &[BigInt; 3], b: &[BigInt; 3]) -> BigInt {
    &a[0] * &b[0] + &a[1] * &b[1] + &a[2] * &b[2]
}

/// A finite double as mantissa times two to an exponent.
pub(crate) fn decompose(value: f64) -> (i64, i32) {
    let bits = value.to_bits();
    let fraction = (bits & ((1 << 52) - 1)).cast_signed();
    let biased = ((bits >> 52) & 0x7ff) as i32;
    // 1075 is the exponent's bias, 1023, and the 52 bits after the binary point; subnormals have no hidden bit.
    let (magnitude, exponent) =
        if biased == 0 { (fraction, -1074) } else { (fraction | (1 << 52), biased - 1075) };
    (if value < 0.0 { -magnitude } else { magnitude }, exponent)
}

fn to_integer(value: f64, exponent: i32) -> BigInt {
    let (mantissa, own_exponent) = decompose(value);
    if mantissa == 0 {
        return BigInt::zero();
    }
    BigInt::from(mantissa) << (own_exponent - exponent).unsigned_abs()
}

/// `numerator / denominator * 2^exponent` in double precision.
fn ratio(numerator: BigInt, denominator: &BigInt, exponent: i32) -> f64 {
    if numerator.is_zero() {
        return 0.0;
    }
    // 64 bits of quotient, more than a double holds, whatever the sizes of the two.
    let bits = |value: &BigInt| i64::try_from(value.bits()).unwrap_or(i64::MAX);
    let shift = bits(denominator) - bits(&numerator) + 64;
    let shifted = if shift >= 0 { numerator << shift } else { numerator >> shift.unsigned_abs() };
    let quotient = shifted / denominator;
    let scale = i64::from(exponent) - shift;
    // Two factors, for one power of two alone may leave the range of doubles where the product does not.
    let half = scale / 2;
    let power = |e: i64| 2f64.powi(i32::try_from(e).unwrap_or(i32::MIN));
    quotient.to_f64().unwrap_or(f64::NAN) * power(half) * power(scale - half)
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
