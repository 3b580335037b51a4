//! Exact decisions in integers of any length.

use glam::DVec3;
use num_bigint::BigInt;
use num_traits::{Signed, ToPrimitive, Zero};

use crate::WallPlane;
use crate::exact::generator::{Generator, Plane};
use crate::exact::input::ExactInput;
use crate::exact::plane::{
    Decision, ExactPlane, decision, decompose, exponent_of, half_space_unit, normal_and_excess,
    times_power_of_two,
};

type BigPlane = ExactPlane<BigInt, BigInt>;

/// The planes of generators as a seed sees them, in units of two to an exponent.
pub(crate) fn planes<const N: usize>(
    input: ExactInput,
    seed: u32,
    generators: [Generator; N],
    exponent: i32,
) -> [BigPlane; N] {
    generators.map(|generator| plane(input, seed, generator, exponent))
}

fn plane(input: ExactInput, seed: u32, generator: Generator, exponent: i32) -> BigPlane {
    if let Plane::Facet(wall) = generator.plane() {
        let wall = &input.frame.wall_planes()[wall.index()];
        let (normal, offset) = wall_plane(wall, input.seeds[seed as usize], exponent);
        return ExactPlane { normal, doubled_offset: offset * 2, generator };
    }
    let integer = |number: f64, exponent: i32| Some(to_integer(number, exponent));
    let terms = normal_and_excess(input, seed, generator, exponent, integer);
    let (normal, excess) = terms.expect("a number has as many bits as it needs");
    let doubled_offset = match generator.as_site() {
        Some(_) => dot(&normal, &normal) + excess,
        None => excess,
    };
    ExactPlane { normal, doubled_offset, generator }
}

/// As [`ExactInput::decide`], for the three planes of a vertex and the one that may cut it off.
pub(crate) fn decide(planes: &[BigPlane; 4]) -> Decision {
    let [a, b, c, m] = planes.each_ref().map(|plane| &plane.normal);
    let (bc, ca, ab) = (cross(b, c), cross(c, a), cross(a, b));
    let coefficients = [dot(m, &bc), dot(m, &ca), dot(m, &ab), -dot(a, &bc)];
    debug_assert!(coefficients[3].is_negative(), "the planes of a vertex are in positive orientation");
    let products = coefficients.iter().zip(planes).map(|(factor, plane)| factor * &plane.doubled_offset);
    let value: BigInt = products.sum();
    decision(planes, &coefficients, value.cmp(&BigInt::zero()))
}

/// As [`ExactInput::is_positive`].
pub(crate) fn is_positive(planes: &[BigPlane; 3]) -> bool {
    let [a, b, c] = planes.each_ref().map(|plane| &plane.normal);
    dot(a, &cross(b, c)).is_positive()
}

/// As [`ExactInput::vertex`], in lengths again.
pub(crate) fn vertex(planes: &[BigPlane; 3], exponent: i32) -> DVec3 {
    let [a, b, c] = planes.each_ref().map(|plane| &plane.normal);
    let minors = [cross(b, c), cross(c, a), cross(a, b)];
    let denominator = dot(a, &minors[0]) * 2;
    let coordinate = |axis: usize| {
        let products = planes.iter().zip(&minors).map(|(plane, minor)| &plane.doubled_offset * &minor[axis]);
        ratio(products.sum(), &denominator, exponent)
    };
    DVec3::new(coordinate(0), coordinate(1), coordinate(2))
}

/// The normal of a wall and its distance from a point in units of the normal's length, for coordinates in units of two to an
/// exponent.
fn wall_plane(plane: &WallPlane, point: DVec3, exponent: i32) -> ([BigInt; 3], BigInt) {
    let integers = |point: DVec3| point.to_array().map(|coordinate| to_integer(coordinate, exponent));
    let point = integers(point);
    match plane {
        WallPlane::HalfSpace { normal, offset } => {
            let unit = half_space_unit(*normal, *offset, exponent);
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
    wall_plane(plane, point, wall_exponent(plane, point)).1.is_negative()
}

/// The outward normal of a wall, of length 1, each coordinate rounded twice; 0 if there is none.
pub(crate) fn unit_normal(plane: &WallPlane) -> DVec3 {
    let (normal, _) = wall_plane(plane, DVec3::ZERO, wall_exponent(plane, DVec3::ZERO));
    let largest = normal.iter().map(Signed::abs).max().unwrap_or_default();
    if largest.is_zero() {
        return DVec3::ZERO;
    }
    DVec3::from_array(normal.map(|coordinate| ratio(coordinate, &largest, 0))).normalize()
}

/// An exponent such that the coordinates of a point and of a wall's are integers times two to it.
fn wall_exponent(plane: &WallPlane, point: DVec3) -> i32 {
    let points: &[DVec3] = match plane {
        WallPlane::HalfSpace { .. } => &[],
        WallPlane::Through(points) => points,
    };
    let coordinates = points.iter().chain([&point]).flat_map(|point| point.to_array());
    coordinates.filter_map(exponent_of).min().unwrap_or(0)
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
    times_power_of_two(quotient.to_f64().unwrap_or(f64::NAN), i64::from(exponent) - shift)
}
