use glam::DVec3;

use crate::exact::frame::Frame;
use crate::exact::generator::{Generator, Plane};
use crate::exact::input::ExactInput;
use crate::{Wall, WallPlane};

/// Half the distance between 1 and the next double: the largest relative error of one rounding.
pub(crate) const ROUNDOFF: f64 = f64::EPSILON / 2.0;

/// Roundings that a dot product of a rounded normal with a vertex, less an offset, can accumulate, with a margin of two.
pub(crate) const EVALUATION_ERROR: f64 = 16.0 * ROUNDOFF;

/// The same for the coordinates of the vertex of three planes, in units of the sums of absolute products.
const INTERSECTION_ERROR: f64 = 32.0 * ROUNDOFF;

/// A closed half-space `normal . y <= offset`, y relative to the cell's seed.
#[derive(Debug, Clone, Copy)]
pub(crate) struct HalfSpace {
    pub(crate) generator: Generator,
    pub(crate) normal: DVec3,
    pub(crate) offset: f64,
    /// The offset's terms without their signs: what its rounding error is relative to.
    pub(crate) offset_size: f64,
    /// Length of the normal.
    pub(crate) length: f64,
}

impl HalfSpace {
    /// The side on which `seed` lies of a generator's plane.
    #[inline(always)]
    pub(crate) fn new(seed: u32, generator: Generator, input: ExactInput) -> Self {
        match generator.plane() {
            Plane::Side(side) => {
                let offset = input.outermost_distance(seed, side);
                let normal = side.outward_normal();
                Self { generator, normal, offset, offset_size: offset, length: 1.0 }
            }
            Plane::Facet(wall) => Self::of_wall(input.seeds[seed as usize], wall, input.frame),
            Plane::Site(site) => {
                let normal = input.difference(seed, site);
                let squared_length = normal.length_squared();
                // Only the difference counts, rounded once: weights may be equal and much larger than all distances.
                let excess = input.weight(seed) - input.weight(site);
                Self {
                    generator,
                    normal,
                    offset: 0.5 * (squared_length + excess),
                    offset_size: 0.5 * (squared_length + excess.abs()),
                    length: squared_length.sqrt(),
                }
            }
        }
    }

    /// What lies behind a wall of a polyhedron.
    pub(crate) fn of_wall(seed: DVec3, wall: Wall, frame: &Frame) -> Self {
        let (plane, normal) = (&frame.wall_planes()[wall.index()], frame.unit_normals()[wall.index()]);
        Self::of_plane(seed, Generator::facet(wall), plane, normal)
    }

    /// The same for a wall with a plane, of which the normal has length 1.
    pub(crate) fn of_plane(seed: DVec3, generator: Generator, plane: &WallPlane, normal: DVec3) -> Self {
        let (offset, offset_size) = match *plane {
            WallPlane::HalfSpace { normal: exact, offset } => {
                let terms = exact * seed;
                let scale = exact.dot(normal);
                ((offset - terms.element_sum()) / scale, (offset.abs() + terms.abs().element_sum()) / scale)
            }
            WallPlane::Through([a, ..]) => {
                let terms = normal * (a - seed);
                (terms.element_sum(), terms.abs().element_sum())
            }
        };
        Self { generator, normal, offset, offset_size, length: 1.0 }
    }

    /// Sum of the normal's absolute coordinates.
    #[inline]
    pub(crate) fn sum(&self) -> f64 {
        self.normal.abs().element_sum()
    }
}

/// The common point of three planes.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Intersection {
    pub(crate) position: DVec3,
    /// Bound on the error of each coordinate.
    pub(crate) error: f64,
}

impl Intersection {
    /// In floating point, if that can tell that the planes are in positive orientation.
    #[inline]
    pub(crate) fn rounded([a, b, c]: [&HalfSpace; 3]) -> Option<Self> {
        let bc = b.normal.cross(c.normal);
        let ca = c.normal.cross(a.normal);
        let ab = a.normal.cross(b.normal);
        let determinant = a.normal.dot(bc);
        let position = (bc * a.offset + ca * b.offset + ab * c.offset) / determinant;
        // Cauchy's inequality bounds the sums of absolute products by products of lengths.
        let lengths = a.length * b.length * c.length;
        let numerators = a.offset_size * (b.length * c.length)
            + b.offset_size * (c.length * a.length)
            + c.offset_size * (a.length * b.length);
        let determinants = 2.0 * lengths;
        let safe_determinant = determinant - INTERSECTION_ERROR * determinants;
        let size = position.abs().max_element();
        let error = INTERSECTION_ERROR * (numerators + size * determinants) / safe_determinant;
        (safe_determinant > 0.0).then_some(Self { position, error })
    }

    /// To nearly the last place.
    pub(crate) fn exact(seed: u32, planes: [&HalfSpace; 3], input: ExactInput) -> Self {
        let position = input.vertex(seed, planes.map(|plane| plane.generator));
        Self { position, error: 4.0 * ROUNDOFF * position.abs().max_element() }
    }

    /// Bound on the distance from the seed.
    #[inline]
    pub(crate) fn distance(&self) -> f64 {
        // The error bounds each coordinate, so a distance by sqrt(3) times it.
        self.position.length() + 2.0 * self.error
    }

    /// Whether the error is at most `share` of the distance from the seed.
    pub(crate) fn is_good_to(&self, share: f64) -> bool {
        self.error <= share * self.position.length()
    }

    /// Bound on the error of `normal . position` for a normal of 1-norm 1: position and evaluation together.
    pub(crate) fn evaluation_error(&self) -> f64 {
        self.error + EVALUATION_ERROR * self.position.abs().max_element()
    }
}
