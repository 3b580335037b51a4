use std::fmt;

use glam::{BVec3, DVec3};

use crate::VoronoiError;

/// Number of space dimensions of a tessellation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dimension {
    /// Polygons in the plane z = 0.
    Two,
    /// Polyhedra in space.
    Three,
}

/// A side of the box, numbered 0 to 5 in the order x0, x1, y0, y1, z0, z1.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Wall(pub(crate) u8);

impl Wall {
    /// The walls of a box in space; the first four are those of a rectangle.
    pub const ALL: [Wall; 6] = [Wall(0), Wall(1), Wall(2), Wall(3), Wall(4), Wall(5)];

    /// The axis that the wall is perpendicular to: 0, 1 or 2.
    pub fn axis(self) -> usize {
        usize::from(self.0 / 2)
    }

    /// Whether the wall bounds its axis from above (x1, y1, z1).
    pub fn is_upper(self) -> bool {
        self.0 % 2 == 1
    }

    /// Number from 0 to 5.
    pub fn number(self) -> u8 {
        self.0
    }

    /// Position in [`Wall::ALL`].
    pub fn index(self) -> usize {
        usize::from(self.0)
    }

    /// Unit normal that points out of the box.
    pub fn outward_normal(self) -> DVec3 {
        let direction = if self.is_upper() { 1.0 } else { -1.0 };
        DVec3::AXES[self.axis()] * direction
    }
}

/// An axis-parallel box, or a rectangle in the plane z = 0, that may repeat periodically along some of its axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Domain {
    lower: DVec3,
    upper: DVec3,
    dimension: Dimension,
    periodic: BVec3,
}

impl Domain {
    /// A box in space from one corner to the opposite one.
    ///
    /// # Errors
    /// [`VoronoiError::BadDomain`] when a side is not positive and finite.
    pub fn cuboid(lower: DVec3, upper: DVec3) -> Result<Self, VoronoiError> {
        Self::checked(lower, upper, Dimension::Three)
    }

    /// A rectangle in the plane z = 0; the z coordinates of the corners are ignored.
    ///
    /// # Errors
    /// [`VoronoiError::BadDomain`] when a side is not positive and finite.
    pub fn rectangle(lower: DVec3, upper: DVec3) -> Result<Self, VoronoiError> {
        Self::checked(lower.with_z(0.0), upper.with_z(0.0), Dimension::Two)
    }

    /// The cube [0, 1]^3.
    pub fn unit_cube() -> Self {
        Self { lower: DVec3::ZERO, upper: DVec3::ONE, dimension: Dimension::Three, periodic: BVec3::FALSE }
    }

    /// The square [0, 1]^2.
    pub fn unit_square() -> Self {
        let upper = DVec3::new(1.0, 1.0, 0.0);
        Self { lower: DVec3::ZERO, upper, dimension: Dimension::Two, periodic: BVec3::FALSE }
    }

    /// The same domain, repeating along the given axes: its two walls there are one, and bound nothing.
    ///
    /// A rectangle cannot repeat along z, which is ignored.
    #[must_use]
    pub fn with_periods(self, axes: BVec3) -> Self {
        let in_domain = BVec3::new(true, true, self.dimension == Dimension::Three);
        Self { periodic: axes & in_domain, ..self }
    }

    fn checked(lower: DVec3, upper: DVec3, dimension: Dimension) -> Result<Self, VoronoiError> {
        let domain = Self { lower, upper, dimension, periodic: BVec3::FALSE };
        let size = domain.size();
        for axis in 0..domain.axes() {
            let length = size[axis];
            if !(length.is_finite() && length > 0.0) {
                return Err(VoronoiError::BadDomain { axis: ['x', 'y', 'z'][axis], length });
            }
        }
        Ok(domain)
    }

    /// The corner with the smallest coordinates.
    pub fn lower(&self) -> DVec3 {
        self.lower
    }

    /// The corner with the largest coordinates.
    pub fn upper(&self) -> DVec3 {
        self.upper
    }

    /// Side lengths; z is 0 for a rectangle.
    pub fn size(&self) -> DVec3 {
        self.upper - self.lower
    }

    /// Two or three dimensions.
    pub fn dimension(&self) -> Dimension {
        self.dimension
    }

    /// Volume of the box, or area of the rectangle.
    pub fn measure(&self) -> f64 {
        let size = self.size();
        (0..self.axes()).map(|axis| size[axis]).product()
    }

    /// The axes along which the domain repeats.
    pub fn periodic(&self) -> BVec3 {
        self.periodic
    }

    /// Whether the domain repeats along some axis.
    pub fn is_periodic(&self) -> bool {
        self.periodic.any()
    }

    /// The walls that bound the domain: six, or four in the plane, but for those across periodic axes.
    pub fn walls(&self) -> impl Iterator<Item = Wall> {
        let periodic = self.periodic;
        Wall::ALL[..2 * self.axes()].iter().copied().filter(move |wall| !periodic.test(wall.axis()))
    }

    /// Coordinate of a wall along its axis.
    pub fn wall_coordinate(&self, wall: Wall) -> f64 {
        if wall.is_upper() { self.upper[wall.axis()] } else { self.lower[wall.axis()] }
    }

    /// Whether a point lies in the domain or on its walls.
    pub fn contains(&self, point: DVec3) -> bool {
        point.cmpge(self.lower).all() && point.cmple(self.upper).all()
    }

    /// Number of axes along which the domain extends.
    pub(crate) fn axes(&self) -> usize {
        match self.dimension {
            Dimension::Two => 2,
            Dimension::Three => 3,
        }
    }
}

impl fmt::Display for Domain {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        for axis in 0..self.axes() {
            let separator = if axis == 0 { "" } else { " x " };
            write!(formatter, "{separator}[{}, {}]", self.lower[axis], self.upper[axis])?;
        }
        Ok(())
    }
}
