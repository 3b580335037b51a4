//! Planes in integers, and what exact decisions among them have in common whatever the integers.
//!
//! A cell of seed i is bounded by planes `n . y <= D / 2`, with y relative to the seed: for a bisector with seed j,
//! `n = s_j - s_i` and `D = |n|^2 + w_i - w_j` with the power weights w; for a wall, `n` is its outward normal and `D` twice the distance to it.
//! Three planes a, b, c with positive determinant meet in a vertex; a fourth plane m cuts it off when
//!
//! `n_m . (D_a n_b x n_c + D_b n_c x n_a + D_c n_a x n_b) - D_m det(n_a, n_b, n_c) > 0`.
//!
//! For four seeds this is the in-sphere determinant, so its sign is the same whichever of the cells asks.
//!
//! Ties are broken by simulation of simplicity (Edelsbrunner and Mücke 1990) on the power weights: each seed j gets an
//! infinitesimal weight e_j, and e_j >> e_k where j comes before k in the lexicographic order of positions. D changes by
//! e_i - e_j, the expression is linear in the D, and the first seed whose coefficient is not zero decides. One always
//! exists: that of the fourth seed is the determinant. Only the order among the seeds involved counts, which neither their
//! numbering nor a translation changes, so all periodic copies of a decision come out the same (as in CGAL's periodic
//! triangulations, Caroli and Teillaud 2009).
//!
//! Walls move, too: the D of wall k grows by an infinitesimal d_k far below all e_j, with d_k >> d_l where k < l. It only
//! matters where four walls of a polyhedron meet in a point, or one touches a corner or an edge that others make.
//!
//! A periodic image of a seed is exact, too: the seed moved by whole multiples of the exact difference of two opposite walls.

use std::cmp::Ordering;
use std::iter::Sum;
use std::ops::{Add, Mul, Sub};

use glam::DVec3;

use crate::exact::generator::{Generator, Plane};
use crate::exact::input::ExactInput;
use crate::{Wall, WallPlane};

/// On which side of a plane a vertex lies once ties are broken.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Decision {
    /// The plane cuts the vertex off.
    pub(crate) beyond: bool,
    /// The vertex lies exactly on the plane; `beyond` is then the symbolic answer.
    pub(crate) tie: bool,
}

/// A plane in integers: coordinates in units of two to some exponent.
pub(crate) struct ExactPlane<N, D> {
    pub(crate) normal: [N; 3],
    pub(crate) doubled_offset: D,
    pub(crate) generator: Generator,
}

/// The normal of the plane of a site or a side of the domain's box as a seed sees it, and twice the side's distance, or what twice
/// a bisector's offset is more than the square of its normal, made from what `integer` gives for a number and an exponent.
pub(crate) fn normal_and_excess<N>(
    input: ExactInput,
    seed: u32,
    generator: Generator,
    exponent: i32,
    integer: impl Fn(f64, i32) -> Option<N>,
) -> Option<([N; 3], N)>
where
    N: From<i8> + Add<Output = N> + Sub<Output = N> + Mul<Output = N>,
{
    let difference = |a: f64, b: f64| Some(integer(a, exponent)? - integer(b, exponent)?);
    let period = |axis: usize| difference(input.frame.upper[axis], input.frame.lower[axis]);
    let own = input.seeds[seed as usize];
    let mut normal = [0; 3].map(N::from);
    match generator.plane() {
        Plane::Site(site) => {
            let image = input.image(site);
            let other = input.seeds[image.seed as usize];
            for (axis, coordinate) in normal.iter_mut().enumerate() {
                let difference = difference(other[axis], own[axis])?;
                *coordinate = match image.translation.0[axis] {
                    0 => difference,
                    translation => difference + period(axis)? * N::from(translation),
                };
            }
            let weight = |site: u32| integer(input.weight(site), 2 * exponent);
            Some((normal, weight(seed)? - weight(site)?))
        }
        Plane::Side(side) => {
            let axis = side.axis();
            let direction = if side.is_upper() { 1 } else { -1 };
            normal[axis] = N::from(direction);
            let doubled_distance = if input.frame.periodic.test(axis) {
                period(axis)?
            } else {
                difference(input.frame.side_coordinate(side), own[axis])? * N::from(2 * direction)
            };
            Some((normal, doubled_distance))
        }
        Plane::Facet(_) => None,
    }
}

/// The decision on the vertex of the first three of some planes and the last, from the coefficients of their doubled offsets in the
/// expression and the sign of its value.
pub(crate) fn decision<N: Ord + Default, D, C: Ord + Default + for<'c> Sum<&'c C>>(
    planes: &[ExactPlane<N, D>; 4],
    coefficients: &[C; 4],
    value: Ordering,
) -> Decision {
    if value.is_ne() {
        return Decision { beyond: value.is_gt(), tie: false };
    }
    let sign = |coefficient: &C| coefficient.cmp(&C::default());
    let with_planes = coefficients.iter().zip(planes);
    let of_sites = with_planes.filter(|(_, plane)| plane.generator.as_site().is_some());
    let own = sign(&of_sites.map(|(coefficient, _)| coefficient).sum());
    Decision { beyond: break_tie(planes, coefficients.each_ref().map(sign), own), tie: true }
}

/// What is moved symbolically; what comes first moves farther.
#[derive(PartialEq, Eq, PartialOrd, Ord)]
enum Moved<'a, N> {
    /// A site, by its position relative to the seed, which is the normal of the bisector.
    Site(&'a [N; 3]),
    Wall(Generator),
}

/// The sign of the expression's change under the symbolic weights, or else the symbolic motion of walls, from the signs of the
/// coefficients of the planes, and of the sum of those of sites.
fn break_tie<N: Ord + Default, D>(
    planes: &[ExactPlane<N, D>; 4],
    signs: [Ordering; 4],
    own: Ordering,
) -> bool {
    let origin = [(); 3].map(|()| N::default());
    let change = |k: usize| {
        let generator = planes[k].generator;
        match generator.as_site() {
            Some(_) => (Moved::Site(&planes[k].normal), signs[k].reverse()),
            None => (Moved::Wall(generator), signs[k]),
        }
    };
    let mut changes = [(Moved::Site(&origin), own), change(0), change(1), change(2), change(3)];
    changes.sort_unstable();
    changes.iter().find(|(_, sign)| sign.is_ne()).is_some_and(|(_, sign)| sign.is_gt())
}

/// The exponent of the units in which the normal of a half-space and its offset, for coordinates in units of two to an exponent, are
/// integers.
pub(crate) fn half_space_unit(normal: DVec3, offset: f64, exponent: i32) -> i32 {
    let of_normal = normal.to_array().into_iter().filter_map(exponent_of);
    of_normal.chain(exponent_of(offset).map(|of_offset| of_offset - exponent)).min().unwrap_or(0)
}

/// The smallest exponent such that all coordinates involved are integers times two to it, and all weights integers times
/// two to twice it.
pub(crate) fn common_exponent(input: ExactInput, seed: u32, generators: &[Generator]) -> i32 {
    let of_point = |point: DVec3| point.to_array().into_iter().filter_map(exponent_of).min();
    let of_site = |site: u32| {
        let image = input.image(site);
        let of_period = (0..3).filter(|axis| image.translation.0[*axis] != 0).flat_map(|axis| {
            [input.frame.lower[axis], input.frame.upper[axis]].into_iter().filter_map(exponent_of)
        });
        let of_weight = exponent_of(input.weight(site)).map(|exponent| exponent.div_euclid(2));
        of_weight.into_iter().chain(of_point(input.seeds[image.seed as usize])).chain(of_period).min()
    };
    let of_side = |side: Wall| {
        let opposite = Wall(side.0 ^ 1);
        [side, opposite].into_iter().filter_map(|side| exponent_of(input.frame.side_coordinate(side))).min()
    };
    let of_planes = generators.iter().filter_map(|generator| match generator.plane() {
        Plane::Site(site) => of_site(site),
        Plane::Side(side) => of_side(side),
        Plane::Facet(wall) => match &input.frame.wall_planes()[wall.index()] {
            // Has units of its own.
            WallPlane::HalfSpace { .. } => None,
            WallPlane::Through(points) => points.iter().copied().filter_map(of_point).min(),
        },
    });
    of_planes.chain(of_site(seed)).min().unwrap_or(0)
}

/// The exponent of a number's last bit; none of zero, which is an integer in any unit.
pub(crate) fn exponent_of(number: f64) -> Option<i32> {
    let (mantissa, exponent) = decompose(number);
    (mantissa != 0).then_some(exponent)
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

/// `number * 2^exponent`, rounded once unless it is tiny.
pub(crate) fn times_power_of_two(number: f64, exponent: i64) -> f64 {
    // Two factors, for one power of two alone may leave the range of doubles where the product does not.
    let half = exponent / 2;
    let power = |e: i64| 2f64.powi(i32::try_from(e).unwrap_or(i32::MIN));
    number * power(half) * power(exponent - half)
}
