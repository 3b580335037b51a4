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
//! Ties are broken by simulation of simplicity (Edelsbrunner and Mücke 1990) on the power weights: seed j gets the weight
//! e_j, infinitesimal, with e_0 >> e_1 >> ... . D changes by e_i - e_j, the expression is linear in the D, and the first seed
//! whose coefficient is not zero decides. One always exists: the vertex itself moves with the weights in all directions.

use glam::DVec3;
use num_bigint::{BigInt, Sign};
use num_traits::{Signed, ToPrimitive, Zero};

use crate::Domain;
use crate::generator::Generator;
use crate::tessellation::Side;

/// On which side of a plane a vertex lies once ties are broken.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Decision {
    /// The plane cuts the vertex off.
    pub(crate) beyond: bool,
    /// The vertex lies exactly on the plane; `beyond` is then the symbolic answer.
    pub(crate) tie: bool,
}

/// The input that exact decisions are made from.
#[derive(Clone, Copy)]
pub(crate) struct ExactInput<'a> {
    pub(crate) domain: &'a Domain,
    pub(crate) seeds: &'a [DVec3],
    /// Power weights, one per seed; all 0 if there are none.
    pub(crate) weights: Option<&'a [f64]>,
}

struct ExactPlane {
    normal: [BigInt; 3],
    doubled_offset: BigInt,
}

impl ExactInput<'_> {
    /// Power weight of a seed.
    pub(crate) fn weight(self, seed: u32) -> f64 {
        self.weights.map_or(0.0, |weights| weights[seed as usize])
    }

    /// Whether plane `cutter` cuts off the vertex of `planes` (in positive orientation) from the cell of `seed`.
    pub(crate) fn decide(self, seed: u32, planes: [Generator; 3], cutter: Generator) -> Decision {
        let exponent = self.common_exponent(seed, &[planes[0], planes[1], planes[2], cutter]);
        let [a, b, c] = planes.map(|generator| self.plane(seed, generator, exponent));
        let m = self.plane(seed, cutter, exponent);
        let bc = cross(&b.normal, &c.normal);
        let ca = cross(&c.normal, &a.normal);
        let ab = cross(&a.normal, &b.normal);
        let determinant = dot(&a.normal, &bc);
        debug_assert!(determinant.is_positive());

        // Coefficients of D_a, D_b, D_c and D_m.
        let coefficients = [dot(&m.normal, &bc), dot(&m.normal, &ca), dot(&m.normal, &ab), -determinant];
        let offsets = [&a.doubled_offset, &b.doubled_offset, &c.doubled_offset, &m.doubled_offset];
        let value: BigInt =
            coefficients.iter().zip(offsets).map(|(coefficient, offset)| coefficient * offset).sum();
        match value.sign() {
            Sign::Plus => Decision { beyond: true, tie: false },
            Sign::Minus => Decision { beyond: false, tie: false },
            Sign::NoSign => {
                let generators = [planes[0], planes[1], planes[2], cutter];
                Decision { beyond: break_tie(seed, &generators, &coefficients), tie: true }
            }
        }
    }

    /// Whether three planes are in positive orientation: the determinant of their normals is positive.
    pub(crate) fn is_positive(self, seed: u32, planes: [Generator; 3]) -> bool {
        let exponent = self.common_exponent(seed, &planes);
        let [a, b, c] = planes.map(|generator| self.plane(seed, generator, exponent).normal);
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
    fn common_exponent(self, seed: u32, generators: &[Generator]) -> i32 {
        let smallest = |point: DVec3| {
            let exponents = point.to_array().map(decompose);
            exponents.into_iter().filter(|(mantissa, _)| *mantissa != 0).map(|(_, e)| e).min()
        };
        let of_seed = |seed: u32| {
            let (mantissa, exponent) = decompose(self.weight(seed));
            let of_weight = (mantissa != 0).then_some(exponent.div_euclid(2));
            of_weight.into_iter().chain(smallest(self.seeds[seed as usize])).min()
        };
        let of_planes = generators.iter().filter_map(|generator| match generator.side() {
            Side::Cell(cell) => of_seed(cell.0),
            Side::Wall(wall) => smallest(DVec3::splat(self.domain.wall_coordinate(wall))),
        });
        of_planes.chain(of_seed(seed)).min().unwrap_or(0)
    }

    fn plane(self, seed: u32, generator: Generator, exponent: i32) -> ExactPlane {
        let own = self.seeds[seed as usize];
        match generator.side() {
            Side::Cell(cell) => {
                let other = self.seeds[cell.index()];
                let normal =
                    [0, 1, 2].map(|axis| to_integer(other[axis], exponent) - to_integer(own[axis], exponent));
                let weight = |seed: u32| to_integer(self.weight(seed), 2 * exponent);
                let doubled_offset = dot(&normal, &normal) + weight(seed) - weight(cell.0);
                ExactPlane { normal, doubled_offset }
            }
            Side::Wall(wall) => {
                let direction = if wall.is_upper() { 1 } else { -1 };
                let mut normal = [BigInt::zero(), BigInt::zero(), BigInt::zero()];
                normal[wall.axis()] = BigInt::from(direction);
                let distance = to_integer(self.domain.wall_coordinate(wall), exponent)
                    - to_integer(own[wall.axis()], exponent);
                ExactPlane { normal, doubled_offset: distance * (2 * direction) }
            }
        }
    }
}

/// The sign of the expression's change under the symbolic weights.
fn break_tie(seed: u32, generators: &[Generator; 4], coefficients: &[BigInt; 4]) -> bool {
    let mut terms: Vec<(u32, BigInt)> = Vec::with_capacity(5);
    let mut own = BigInt::zero();
    for (generator, coefficient) in generators.iter().zip(coefficients) {
        if let Some(id) = generator.as_seed() {
            own += coefficient;
            terms.push((id, -coefficient));
        }
    }
    terms.push((seed, own));
    terms.sort_unstable_by_key(|(id, _)| *id);
    terms.iter().map(|(_, term)| term).find(|term| !term.is_zero()).is_some_and(Signed::is_positive)
}

fn cross(a: &[BigInt; 3], b: &[BigInt; 3]) -> [BigInt; 3] {
    [&a[1] * &b[2] - &a[2] * &b[1], &a[2] * &b[0] - &a[0] * &b[2], &a[0] * &b[1] - &a[1] * &b[0]]
}

fn dot(a: &[BigInt; 3], b: &[BigInt; 3]) -> BigInt {
    &a[0] * &b[0] + &a[1] * &b[1] + &a[2] * &b[2]
}

/// A finite double as mantissa times two to an exponent.
fn decompose(value: f64) -> (i64, i32) {
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
        let input = ExactInput { domain: &domain, seeds, weights: None };
        input.decide(seed, planes.map(Generator::seed), Generator::seed(cutter))
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
        let seeds = seeds();
        let input = ExactInput { domain: &domain, seeds: &seeds, weights: None };
        let vertex = input.vertex(0, [1, 2, 3].map(Generator::seed));
        assert_eq!(vertex, DVec3::splat(0.5));
        let tiny: Vec<DVec3> = seeds.iter().map(|seed| *seed * 1e-200).collect();
        let input = ExactInput { domain: &domain, seeds: &tiny, weights: None };
        assert_eq!(input.vertex(0, [1, 2, 3].map(Generator::seed)), DVec3::splat(0.5e-200));
    }

    #[test]
    fn walls_take_part_in_decisions() {
        let domain = Domain::unit_cube();
        let seeds = [DVec3::new(0.25, 0.5, 0.5), DVec3::new(0.75, 0.5, 0.5)];
        let input = ExactInput { domain: &domain, seeds: &seeds, weights: None };
        let walls = [Wall::ALL[1], Wall::ALL[3], Wall::ALL[5]].map(Generator::wall);
        assert!(input.decide(0, walls, Generator::seed(1)).beyond);
        assert_eq!(input.vertex(0, walls), DVec3::new(0.75, 0.5, 0.5));
    }
}
