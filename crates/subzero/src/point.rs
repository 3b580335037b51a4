//! What subdivision may average.

use glam::{DVec2, DVec3};

/// What subdivision may average: `f64`, [`DVec2`] or [`DVec3`].
pub trait Point: Copy + Send + Sync {
    /// The neutral element of the sum.
    fn zero() -> Self;

    /// `self + weight * other`.
    fn add_scaled(self, other: Self, weight: f64) -> Self;
}

impl Point for f64 {
    fn zero() -> Self {
        0.0
    }

    fn add_scaled(self, other: Self, weight: f64) -> Self {
        self + weight * other
    }
}

impl Point for DVec2 {
    fn zero() -> Self {
        Self::ZERO
    }

    fn add_scaled(self, other: Self, weight: f64) -> Self {
        self + other * weight
    }
}

impl Point for DVec3 {
    fn zero() -> Self {
        Self::ZERO
    }

    fn add_scaled(self, other: Self, weight: f64) -> Self {
        self + other * weight
    }
}
