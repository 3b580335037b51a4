//! What bounds a domain.

use glam::DVec3;

/// A wall of a domain. Those of a box are numbered 0 to 5 in the order x0, x1, y0, y1, z0, z1, those of a polyhedron from
/// 0 in the order in which they were given.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Wall(pub(crate) u32);

impl Wall {
    /// The walls of a box in space; the first four are those of a rectangle.
    pub const ALL: [Wall; 6] = [Wall(0), Wall(1), Wall(2), Wall(3), Wall(4), Wall(5)];

    /// The wall with a number from 0.
    pub fn numbered(number: u32) -> Self {
        Self(number)
    }

    /// Of a wall of a box, the axis that it is perpendicular to: 0, 1 or 2.
    pub fn axis(self) -> usize {
        debug_assert!(self.0 < 6, "a wall of a box");
        (self.0 / 2) as usize
    }

    /// Whether a wall of a box bounds its axis from above (x1, y1, z1).
    pub fn is_upper(self) -> bool {
        self.0 % 2 == 1
    }

    /// Number from 0.
    pub fn number(self) -> u32 {
        self.0
    }

    /// The number as an index.
    pub fn index(self) -> usize {
        self.0 as usize
    }

    /// Of a wall of a box, the unit normal that points out of it.
    pub fn outward_normal(self) -> DVec3 {
        let direction = if self.is_upper() { 1.0 } else { -1.0 };
        DVec3::AXES[self.axis()] * direction
    }
}

/// The half-space on the inner side of a wall, border included. Its numbers are taken as exact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum WallPlane {
    /// All x with `normal . x <= offset`; the normal points outward and has any length but 0.
    HalfSpace {
        /// The outward normal.
        normal: DVec3,
        /// Distance from the origin along the normal, in units of the normal's length.
        offset: f64,
    },
    /// What lies behind the plane through three points, which wind counter-clockwise as seen from outside.
    ///
    /// Planes through common points meet in them, however many: so the faces of a pyramid have an apex, while their
    /// rounded coefficients have none. In the plane z = 0 the third point stands above one of the others.
    Through([DVec3; 3]),
}

impl WallPlane {
    /// The axis that the plane is perpendicular to, if there is one, and its coordinate there.
    pub(crate) fn across_axis(&self) -> Option<(usize, f64)> {
        match self {
            Self::HalfSpace { normal, offset } => {
                let axis = (0..3).find(|axis| normal[*axis] != 0.0)?;
                let others = normal.to_array().into_iter().filter(|coordinate| *coordinate != 0.0).count();
                (others == 1).then(|| (axis, offset / normal[axis]))
            }
            Self::Through([a, b, c]) => {
                let axis = (0..3).find(|axis| a[*axis] == b[*axis] && a[*axis] == c[*axis])?;
                Some((axis, a[axis]))
            }
        }
    }
}
