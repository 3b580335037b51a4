//! Exact decisions in integers of fixed width, as most need no more: a tenth of the time that integers of any length take.

use std::cmp::Ordering;

use ethnum::I256;
use glam::DVec3;

use crate::exact::generator::{Generator, Plane};
use crate::exact::input::ExactInput;
use crate::exact::plane::{
    Decision, ExactPlane, decision, decompose, half_space_unit, normal_and_excess, times_power_of_two,
};
use crate::{Wall, WallPlane};

/// Bits of a normal's coordinates. The products of two normals then take 121, those of three 183, and twice an offset takes 125 at
/// most; the product of the last two would take 310 bits, but is made in halves.
const NORMAL_BITS: u32 = 60;

/// Bits of a seed's coordinates where it sees the walls of a polyhedron.
const POINT_BITS: u32 = 62;

/// Bits of coordinates, periods and weights, of which differences are taken.
const NUMBER_BITS: u32 = 120;

type NarrowPlane = ExactPlane<i64, i128>;

/// The planes of generators as a seed sees them, in units of two to an exponent; none where they are too long, or those of
/// walls through points.
pub(crate) fn planes<const N: usize>(
    input: ExactInput,
    seed: u32,
    generators: [Generator; N],
    exponent: i32,
) -> Option<[NarrowPlane; N]> {
    let planes = generators.map(|generator| plane(input, seed, generator, exponent));
    planes.iter().all(Option::is_some).then(|| planes.map(|plane| plane.expect("all are")))
}

fn plane(input: ExactInput, seed: u32, generator: Generator, exponent: i32) -> Option<NarrowPlane> {
    if let Plane::Facet(wall) = generator.plane() {
        return facet(input, seed, wall, exponent);
    }
    let (normal, excess) = normal_and_excess(input, seed, generator, exponent, integer)?;
    let normal = short(normal, NORMAL_BITS)?;
    let square = || normal.iter().map(|n| i128::from(*n) * i128::from(*n)).sum::<i128>();
    let doubled_offset = if generator.as_site().is_some() { square() + excess } else { excess };
    Some(ExactPlane { normal, doubled_offset, generator })
}

/// The plane of a polyhedron's wall, if it is that of a half-space.
fn facet(input: ExactInput, seed: u32, wall: Wall, exponent: i32) -> Option<NarrowPlane> {
    let WallPlane::HalfSpace { normal, offset } = input.frame.wall_planes()[wall.index()] else {
        return None;
    };
    let integers = |point: DVec3, exponent: i32| {
        let [x, y, z] = point.to_array().map(|coordinate| integer(coordinate, exponent));
        Some([x?, y?, z?])
    };
    let unit = half_space_unit(normal, offset, exponent);
    let point = short(integers(input.seeds[seed as usize], exponent)?, POINT_BITS)?;
    let normal = short(integers(normal, unit)?, NORMAL_BITS)?;
    let products = normal.iter().zip(point).map(|(n, x)| i128::from(*n) * i128::from(x));
    let offset = integer(offset, unit + exponent)? - products.sum::<i128>();
    Some(ExactPlane { normal, doubled_offset: 2 * offset, generator: Generator::facet(wall) })
}

/// Coordinates with at most some bits.
fn short(coordinates: [i128; 3], bits: u32) -> Option<[i64; 3]> {
    let mut short = [0; 3];
    for (short, coordinate) in short.iter_mut().zip(coordinates) {
        *short = i64::try_from(coordinate).ok().filter(|n| n.unsigned_abs() < 1 << bits)?;
    }
    Some(short)
}

/// As [`ExactInput::decide`], for the three planes of a vertex and the one that may cut it off.
pub(crate) fn decide(planes: &[NarrowPlane; 4]) -> Decision {
    let [a, b, c, m] = planes.each_ref().map(|plane| &plane.normal);
    let (bc, ca, ab) = (cross(b, c), cross(c, a), cross(a, b));
    let coefficients = [dot(m, &bc), dot(m, &ca), dot(m, &ab), -dot(a, &bc)];
    debug_assert!(coefficients[3] < I256::ZERO, "the planes of a vertex are in positive orientation");
    // Offsets are 2^64 times one number plus another.
    let (mut high, mut low) = (I256::ZERO, I256::ZERO);
    for (coefficient, plane) in coefficients.iter().zip(planes) {
        high += coefficient * I256::from(plane.doubled_offset >> 64);
        low += coefficient * I256::from(plane.doubled_offset & i128::from(u64::MAX));
    }
    let value = high + (low >> 64u32);
    let rest = low & I256::from(u64::MAX);
    decision(planes, &coefficients, sign(value).then(sign(rest)))
}

/// As [`ExactInput::is_positive`].
pub(crate) fn is_positive(planes: &[NarrowPlane; 3]) -> bool {
    let [a, b, c] = planes.each_ref().map(|plane| &plane.normal);
    dot(a, &cross(b, c)) > I256::ZERO
}

/// As [`ExactInput::vertex`], in lengths again.
pub(crate) fn vertex(planes: &[NarrowPlane; 3], exponent: i32) -> DVec3 {
    let [a, b, c] = planes.each_ref().map(|plane| &plane.normal);
    let minors = [cross(b, c), cross(c, a), cross(a, b)];
    let denominator = dot(a, &minors[0]) * I256::from(2);
    let coordinate = |axis: usize| {
        // Three products of 124 and 121 bits.
        let products = planes.iter().zip(&minors);
        let numerator =
            products.map(|(plane, minor)| I256::from(plane.doubled_offset) * I256::from(minor[axis])).sum();
        ratio(numerator, denominator, exponent)
    };
    DVec3::new(coordinate(0), coordinate(1), coordinate(2))
}

/// `numerator / denominator * 2^exponent` in double precision.
fn ratio(numerator: I256, denominator: I256, exponent: i32) -> f64 {
    if numerator == I256::ZERO {
        return 0.0;
    }
    // 64 bits of quotient, more than a double holds. With the at most 185 of the denominator that is less than there are.
    let bits = |value: I256| 256 - value.unsigned_abs().leading_zeros().cast_signed();
    let shift = bits(denominator) - bits(numerator) + 64;
    let shifted = if shift >= 0 { numerator << shift } else { numerator >> -shift };
    times_power_of_two((shifted / denominator).as_f64(), i64::from(exponent) - i64::from(shift))
}

fn sign(number: I256) -> Ordering {
    number.cmp(&I256::ZERO)
}

fn cross(a: &[i64; 3], b: &[i64; 3]) -> [i128; 3] {
    let minor =
        |i: usize, j: usize| i128::from(a[i]) * i128::from(b[j]) - i128::from(a[j]) * i128::from(b[i]);
    [minor(1, 2), minor(2, 0), minor(0, 1)]
}

fn dot(a: &[i64; 3], b: &[i128; 3]) -> I256 {
    let product = |axis: usize| I256::from(a[axis]) * I256::from(b[axis]);
    product(0) + product(1) + product(2)
}

/// A number in units of two to an exponent, if it has at most [`NUMBER_BITS`].
fn integer(number: f64, exponent: i32) -> Option<i128> {
    let (mantissa, own_exponent) = decompose(number);
    if mantissa == 0 {
        return Some(0);
    }
    let shift = (own_exponent - exponent).unsigned_abs();
    // A mantissa has 53 bits.
    (shift <= NUMBER_BITS - 53).then(|| i128::from(mantissa) << shift)
}

#[cfg(test)]
mod tests {
    use glam::BVec3;

    use super::*;
    use crate::Domain;
    use crate::exact::big_integer as big;
    use crate::exact::frame::Frame;
    use crate::exact::image::ImageTable;
    use crate::exact::plane::common_exponent;

    /// Decisions among seeds on a coarse grid, of which many are tied, and near it.
    #[test]
    fn decisions_are_those_of_integers_of_any_length() {
        let mut state = 1u64;
        let mut next = move |count: u32| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            u32::try_from((state >> 33) % u64::from(count)).expect("below 2^31")
        };
        let (mut tied, mut decided) = (0, 0);
        for round in 0..3000 {
            let frame = Frame {
                periodic: BVec3::new(round % 2 == 0, false, false),
                ..Frame::new(DVec3::ZERO, DVec3::ONE, 3, None)
            };
            let mut coordinate = || (f64::from(next(6)) + 0.5) / 6.0 + if next(9) == 0 { 1e-16 } else { 0.0 };
            let seeds: Vec<DVec3> =
                (0..5).map(|_| DVec3::new(coordinate(), coordinate(), coordinate())).collect();
            let weights: Vec<f64> = (0..5).map(|_| f64::from(next(3)) * 0.01).collect();
            let images = ImageTable::default().widened(&frame, &seeds, DVec3::ONE);
            let input = ExactInput {
                frame: &frame,
                seeds: &seeds,
                weights: (round % 3 == 0).then_some(&weights[..]),
                images: &images,
            };
            let sites = input.site_count();
            let mut generator = || match next(5) {
                0 => Generator::side(Wall::ALL[2 + next(4) as usize]),
                _ => Generator::site(1 + next(sites - 1)),
            };
            let generators = [generator(), generator(), generator(), generator()];
            let [a, b, c, _] = generators;
            let exponent = common_exponent(input, 0, &generators);
            let planes = planes(input, 0, generators, exponent).expect("few bits");
            let [x, y, z, _] = planes.each_ref().map(|plane| plane.normal);
            if dot(&x, &cross(&y, &z)) <= I256::ZERO {
                continue;
            }
            let decision = decide(&planes);
            let big = big::decide(&big::planes(input, 0, generators, exponent));
            assert_eq!(decision, big, "{seeds:?} {generators:?}");
            assert!(input.is_positive(0, [a, b, c]));
            let [x, y, z, _] = planes;
            let of_three = big::planes(input, 0, [a, b, c], exponent);
            assert_eq!(
                vertex(&[x, y, z], exponent),
                big::vertex(&of_three, exponent),
                "{seeds:?} {generators:?}"
            );
            tied += usize::from(decision.tie);
            decided += 1;
        }
        assert!(tied > 100 && decided - tied > 100, "{tied} of {decided}");
    }

    /// Vertices on the walls of a polyhedron, and decisions about them.
    #[test]
    fn half_spaces_are_those_of_integers_of_any_length() {
        let domain = Domain::ball(DVec3::splat(0.5), 0.5, 0.01).expect("a ball");
        let seeds = [DVec3::new(0.3, 0.4, 0.7), DVec3::new(0.35, 0.45, 0.8), DVec3::new(0.6, 0.1, 0.3)];
        let images = ImageTable::default();
        let input = ExactInput { frame: &domain.frame, seeds: &seeds, weights: None, images: &images };
        let walls: Vec<Generator> = domain.walls().map(Generator::facet).collect();
        let mut compared = 0;
        for three in walls.windows(3) {
            for of_vertex in [[three[0], three[1], Generator::site(1)], [three[1], three[0], three[2]]] {
                let [a, b, c] = of_vertex;
                let generators = [a, b, c, Generator::site(2)];
                let exponent = common_exponent(input, 0, &generators);
                let Some(planes) = planes(input, 0, generators, exponent) else { continue };
                let [x, y, z, _] = planes.each_ref().map(|plane| plane.normal);
                if dot(&x, &cross(&y, &z)) > I256::ZERO {
                    let big = big::planes(input, 0, generators, exponent);
                    assert_eq!(decide(&planes), big::decide(&big), "{generators:?}");
                    let [x, y, z, _] = planes;
                    let big = big::planes(input, 0, of_vertex, exponent);
                    assert_eq!(vertex(&[x, y, z], exponent), big::vertex(&big, exponent), "{generators:?}");
                    compared += 1;
                }
            }
        }
        assert!(compared > 50, "{compared} of {} walls", walls.len());
    }
}
