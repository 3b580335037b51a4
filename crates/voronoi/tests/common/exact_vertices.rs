//! The check that no two vertices are one point, in integers of any length.

use std::collections::BTreeSet;

use glam::DVec3;
use num_bigint::BigInt;
use voronoi::{Dimension, Side, Tessellation, WallPlane};

/// Vertices nearer than this, relative to the largest coordinate of the domain, are compared exactly: coordinates are known
/// to about 1e-13 of it.
const POSSIBLY_COINCIDENT: f64 = 1e-12;

/// Bits behind the binary point of a double, at most: with so many all are integers.
const FRACTION_BITS: u32 = 1074;

/// All points x with `normal . x = offset`.
struct Plane {
    normal: [BigInt; 3],
    offset: BigInt,
}

/// Panics if two vertices are one point. Weights are those of a power tessellation.
pub fn assert_vertices_differ(tessellation: &Tessellation, weights: Option<&[f64]>) {
    let (lower, upper) = (tessellation.domain().lower(), tessellation.domain().upper());
    let tolerance = POSSIBLY_COINCIDENT * lower.abs().max(upper.abs()).max_element();
    let mut vertices: Vec<(DVec3, usize)> = tessellation.vertices().iter().copied().zip(0..).collect();
    vertices.sort_by(|(a, _), (b, _)| a.x.total_cmp(&b.x));
    let mut sides = None;
    for (place, (position, vertex)) in vertices.iter().enumerate() {
        let near = vertices[place + 1..].iter().take_while(|(other, _)| other.x <= position.x + tolerance);
        for (_, other) in near.filter(|(other, _)| other.distance(*position) <= tolerance) {
            let sides = sides.get_or_insert_with(|| vertex_sides(tessellation));
            let [(p, p_unit), (q, q_unit)] =
                [*vertex, *other].map(|vertex| point(tessellation, weights, &sides[vertex]));
            let is_one = (0..3).all(|axis| &p[axis] * &q_unit == &q[axis] * &p_unit);
            assert!(!is_one, "vertices {vertex} and {other} at {position} are one point");
        }
    }
}

/// Of each vertex, what meets there.
fn vertex_sides(tessellation: &Tessellation) -> Vec<BTreeSet<Side>> {
    let mut sides = vec![BTreeSet::new(); tessellation.vertices().len()];
    for face in tessellation.faces() {
        for corner in tessellation.face_corners(face) {
            sides[corner.index()].extend(tessellation.face_sides(face));
        }
    }
    sides
}

/// Where some sides meet, each coordinate as a numerator above one and the same denominator.
fn point(
    tessellation: &Tessellation,
    weights: Option<&[f64]>,
    sides: &BTreeSet<Side>,
) -> ([BigInt; 3], BigInt) {
    let mut planes = Vec::new();
    let mut first = None;
    for side in sides {
        match meeting(tessellation, weights, *side) {
            Meeting::Site(position, power) => match &first {
                None => first = Some((position, power)),
                Some((own, own_power)) => planes.push(Plane {
                    normal: [0, 1, 2].map(|axis| (&position[axis] - &own[axis]) * 2),
                    offset: power - own_power,
                }),
            },
            Meeting::Wall(plane) => planes.push(plane),
        }
    }
    if tessellation.domain().dimension() == Dimension::Two {
        planes.push(across(2, BigInt::ZERO));
    }
    for (i, a) in planes.iter().enumerate() {
        for (j, b) in planes.iter().enumerate().skip(i + 1) {
            for c in &planes[j + 1..] {
                let minors =
                    [cross(&b.normal, &c.normal), cross(&c.normal, &a.normal), cross(&a.normal, &b.normal)];
                let determinant = dot(&a.normal, &minors[0]);
                if determinant != BigInt::ZERO {
                    let offsets = [&a.offset, &b.offset, &c.offset];
                    let coordinate =
                        |axis: usize| offsets.iter().zip(&minors).map(|(d, minor)| *d * &minor[axis]).sum();
                    return ([0, 1, 2].map(coordinate), determinant);
                }
            }
        }
    }
    panic!("three planes through every vertex meet in a point")
}

/// What meets in a vertex.
enum Meeting {
    /// A site by its position and `|position|^2 - weight`.
    Site([BigInt; 3], BigInt),
    Wall(Plane),
}

fn meeting(tessellation: &Tessellation, weights: Option<&[f64]>, side: Side) -> Meeting {
    let domain = tessellation.domain();
    let (cell, translation) = match side {
        Side::Cell(cell) => (cell, [0; 3]),
        Side::Image(cell, translation) => (cell, translation.0),
        Side::Wall(wall) => {
            return Meeting::Wall(match domain.wall_planes().get(wall.index()) {
                None => across(wall.axis(), integer(domain.wall_coordinate(wall))),
                Some(WallPlane::HalfSpace { normal, offset }) => {
                    Plane { normal: integers(*normal), offset: integer(*offset) << FRACTION_BITS }
                }
                Some(WallPlane::Through(points)) => {
                    let [a, b, c] = points.map(integers);
                    let to = |end: &[BigInt; 3]| [0, 1, 2].map(|axis| &end[axis] - &a[axis]);
                    let normal = cross(&to(&b), &to(&c));
                    Plane { offset: dot(&normal, &a), normal }
                }
            });
        }
    };
    let period = |axis: usize| integer(domain.upper()[axis]) - integer(domain.lower()[axis]);
    let seed = integers(tessellation.seeds()[cell.index()]);
    let position = [0, 1, 2].map(|axis| &seed[axis] + period(axis) * translation[axis]);
    let weight = weights.map_or(0.0, |weights| weights[cell.index()]);
    let power = dot(&position, &position) - (integer(weight) << FRACTION_BITS);
    Meeting::Site(position, power)
}

fn across(axis: usize, coordinate: BigInt) -> Plane {
    let mut normal = [0; 3].map(BigInt::from);
    normal[axis] = BigInt::from(1);
    Plane { normal, offset: coordinate }
}

fn integers(vector: DVec3) -> [BigInt; 3] {
    vector.to_array().map(integer)
}

/// A double in units of its smallest kind.
fn integer(number: f64) -> BigInt {
    let bits = number.to_bits();
    let (fraction, exponent) = (bits & ((1 << 52) - 1), bits >> 52 & 0x7ff);
    // Subnormals have no hidden bit.
    let magnitude = match exponent {
        0 => BigInt::from(fraction),
        _ => BigInt::from(fraction | 1 << 52) << (exponent - 1),
    };
    if number < 0.0 { -magnitude } else { magnitude }
}

fn cross(a: &[BigInt; 3], b: &[BigInt; 3]) -> [BigInt; 3] {
    [&a[1] * &b[2] - &a[2] * &b[1], &a[2] * &b[0] - &a[0] * &b[2], &a[0] * &b[1] - &a[1] * &b[0]]
}

fn dot(a: &[BigInt; 3], b: &[BigInt; 3]) -> BigInt {
    &a[0] * &b[0] + &a[1] * &b[1] + &a[2] * &b[2]
}
