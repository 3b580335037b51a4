use std::ops::{Add, Sub};

use glam::DVec3;

/// A translation by whole periods of the domain along x, y and z.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Translation(pub [i8; 3]);

impl Translation {
    /// No translation.
    pub const ZERO: Self = Self([0; 3]);

    /// The translation as a length, given the periods.
    pub(crate) fn times(self, periods: DVec3) -> DVec3 {
        DVec3::from_array(self.0.map(f64::from)) * periods
    }
}

impl Add for Translation {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self([0, 1, 2].map(|axis| self.0[axis] + other.0[axis]))
    }
}

impl Sub for Translation {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self([0, 1, 2].map(|axis| self.0[axis] - other.0[axis]))
    }
}
