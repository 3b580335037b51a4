//! One part of a texture.

use std::f64::consts::TAU;

use glam::{DQuat, DVec3};

use crate::{CrystalSymmetry, FiberKernel, Kernel, Orientation};

/// One part of a texture.
#[derive(Debug, Clone, PartialEq)]
pub enum Component {
    /// Any orientation is as likely as any other.
    Random,
    /// Orientations around one.
    Peak {
        /// The most frequent orientation.
        mode: Orientation,
        /// How they spread; nothing for the mode alone.
        kernel: Option<Kernel>,
    },
    /// A direction of the crystal around one of the sample, and any turn about it.
    Fiber {
        /// Unit direction in crystal coordinates.
        crystal: DVec3,
        /// Unit direction in sample coordinates.
        sample: DVec3,
        /// How the first spreads around the second; nothing for none.
        kernel: Option<FiberKernel>,
    },
    /// Some orientations.
    List {
        /// Each with the sum of its weight and of all before it; the last is 1.
        orientations: Vec<(Orientation, f64)>,
        /// How orientations spread around each; nothing for none.
        kernel: Option<Kernel>,
    },
}

impl Component {
    /// The orientation at four independent numbers from 0 to 1: which of a list, how far from it, and two of a direction.
    ///
    /// Uniform numbers give the component's distribution.
    pub(crate) fn at(&self, [choice, far, turn, height]: [f64; 4]) -> Orientation {
        match self {
            Self::Random => {
                let cosine: f64 = 1.0 - 2.0 * height;
                let euler = [360.0 * far, cosine.clamp(-1.0, 1.0).acos().to_degrees(), 360.0 * turn];
                Orientation::from_euler_degrees(euler)
            }
            Self::Peak { mode, kernel } => spread(*mode, *kernel, [far, turn, height]),
            Self::List { orientations, kernel } => {
                let found = orientations.partition_point(|(_, sum)| *sum <= choice);
                let (mode, _) = orientations[found.min(orientations.len() - 1)];
                spread(mode, *kernel, [far, turn, height])
            }
            Self::Fiber { crystal, sample, kernel } => {
                let aligned = DQuat::from_rotation_arc(*crystal, *sample);
                let turned = DQuat::from_axis_angle(*sample, TAU * turn) * aligned;
                let tilt = kernel.map_or(0.0, |kernel| kernel.tilt_within(far)).to_radians();
                let azimuth = DQuat::from_axis_angle(*sample, TAU * height);
                let axis = azimuth * sample.any_orthonormal_vector();
                Orientation::new(DQuat::from_axis_angle(axis, tilt) * turned)
            }
        }
    }

    /// Density at an orientation in multiples of random, over the equivalents of the crystal. Infinite nowhere: what has no spread
    /// counts as nothing.
    pub(crate) fn density(&self, orientation: Orientation, symmetry: CrystalSymmetry) -> f64 {
        let rotations = symmetry.rotations();
        let mean = |sum: f64| sum / rotations.len() as f64;
        let around = |mode: Orientation, kernel: Kernel| {
            let between = mode.raw().conjugate() * orientation.raw();
            let equivalents = rotations.iter().map(|rotation| {
                let cosine = rotation.dot(between).abs().min(1.0);
                kernel.density(2.0 * cosine.acos().to_degrees())
            });
            mean(equivalents.sum())
        };
        match self {
            Self::Random => 1.0,
            Self::Peak { mode, kernel } => kernel.map_or(0.0, |kernel| around(*mode, kernel)),
            Self::Fiber { crystal, sample, kernel } => kernel.map_or(0.0, |kernel| {
                let seen = orientation.to_crystal(*sample);
                mean(rotations.iter().map(|rotation| kernel.density((*rotation * *crystal).dot(seen))).sum())
            }),
            Self::List { orientations, kernel } => kernel.map_or(0.0, |kernel| {
                let befores = std::iter::once(0.0).chain(orientations.iter().map(|(_, sum)| *sum));
                let parts = orientations.iter().zip(befores);
                parts.map(|((mode, sum), before)| (sum - before) * around(*mode, kernel)).sum()
            }),
        }
    }

    /// Whether it has a density: what is drawn is not one of a few orientations, or of a line of them.
    pub fn is_spread(&self) -> bool {
        match self {
            Self::Random => true,
            Self::Peak { kernel, .. } | Self::List { kernel, .. } => kernel.is_some(),
            Self::Fiber { kernel, .. } => kernel.is_some(),
        }
    }
}

/// An orientation around another: at the angle of one number, around the axis of the other two.
fn spread(mode: Orientation, kernel: Option<Kernel>, [far, turn, height]: [f64; 3]) -> Orientation {
    let Some(kernel) = kernel else { return mode };
    let (sine, cosine) = (TAU * turn).sin_cos();
    let z = 1.0 - 2.0 * height;
    let radius = (1.0 - z * z).max(0.0).sqrt();
    let axis = DVec3::new(radius * cosine, radius * sine, z).normalize();
    let rotation = DQuat::from_axis_angle(axis, kernel.angle_within(far).to_radians());
    Orientation::new(rotation * mode.raw())
}
