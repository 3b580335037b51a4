//! What subdivision may average.

use bytemuck::Zeroable;
use glam::{DVec2, DVec3};

/// What subdivision may average: `f64`, [`DVec2`] or [`DVec3`].
///
/// Zero is all zero bytes, which lets large arrays of points start as untouched memory.
pub trait Point: Copy + Send + Sync + Zeroable {
    /// The neutral element of the sum.
    fn zero() -> Self {
        Self::zeroed()
    }

    /// `self + weight * other`.
    fn add_scaled(self, other: Self, weight: f64) -> Self;

    /// `weight * self`.
    fn scaled(self, weight: f64) -> Self {
        Self::zero().add_scaled(self, weight)
    }
}

impl Point for f64 {
    fn add_scaled(self, other: Self, weight: f64) -> Self {
        self + weight * other
    }

    fn scaled(self, weight: f64) -> Self {
        weight * self
    }
}

impl Point for DVec2 {
    fn add_scaled(self, other: Self, weight: f64) -> Self {
        self + other * weight
    }

    fn scaled(self, weight: f64) -> Self {
        self * weight
    }
}

impl Point for DVec3 {
    fn add_scaled(self, other: Self, weight: f64) -> Self {
        self + other * weight
    }

    fn scaled(self, weight: f64) -> Self {
        self * weight
    }
}
