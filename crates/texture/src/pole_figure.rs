//! Densities of directions, and their projections.

use glam::DVec3;

use crate::{CrystalSymmetry, FiberKernel, Orientation};

/// Cells along each side of the square around all directions in projection: of 1.3 degrees at the middle.
const CELLS: usize = 128;

/// A density of axes on the sphere in multiples of random: directions and their opposites count the same, as in diffraction.
#[derive(Debug, Clone)]
pub struct PoleFigure {
    /// With weights that add up to 1.
    axes: Vec<(DVec3, f64)>,
    kernel: FiberKernel,
    /// Cosine of the tilt from which on the kernel counts as nothing.
    cutoff: f64,
}

impl PoleFigure {
    /// Where an axis of the crystal and its equivalents point in the sample: orientations with weights, smoothed by a kernel.
    ///
    /// ```
    /// use glam::DVec3;
    /// use texture::{CrystalSymmetry, FiberKernel, Orientation, PoleFigure};
    ///
    /// let cube = [(Orientation::from_euler_degrees([0.0; 3]), 1.0)];
    /// let figure = PoleFigure::of_crystal_axis(&cube, CrystalSymmetry::Octahedral, DVec3::Z, FiberKernel::new(10.0)?);
    /// assert!(figure.density(DVec3::X) > 1.0, "one of the poles 001 lies along X");
    /// assert!(figure.density(DVec3::ONE.normalize()) < 1e-3);
    /// # Ok::<(), texture::HalfwidthError>(())
    /// ```
    pub fn of_crystal_axis(
        weighted: &[(Orientation, f64)],
        symmetry: CrystalSymmetry,
        axis: DVec3,
        kernel: FiberKernel,
    ) -> Self {
        let mut equivalents: Vec<DVec3> = Vec::new();
        for image in symmetry.rotations().iter().map(|rotation| *rotation * axis.normalize()) {
            if !equivalents.iter().any(|known| known.dot(image).abs() > 1.0 - 1e-9) {
                equivalents.push(image);
            }
        }
        let in_sample = weighted.iter().flat_map(|(orientation, weight)| {
            equivalents.iter().map(|axis| (orientation.to_sample(*axis), *weight))
        });
        Self::new(in_sample, kernel)
    }

    /// What an axis of the sample is in the crystals: an inverse pole figure, equal at equivalent directions.
    pub fn of_sample_axis(
        weighted: &[(Orientation, f64)],
        symmetry: CrystalSymmetry,
        axis: DVec3,
        kernel: FiberKernel,
    ) -> Self {
        let in_crystal = weighted.iter().flat_map(|(orientation, weight)| {
            let seen = orientation.to_crystal(axis.normalize());
            symmetry.rotations().iter().map(move |rotation| (*rotation * seen, *weight))
        });
        Self::new(in_crystal, kernel)
    }

    /// Axes that are nearer to each other than a degree or so count as one, for a kernel is wider: however many there are, few are left.
    fn new(axes: impl Iterator<Item = (DVec3, f64)>, kernel: FiberKernel) -> Self {
        let mut cells = vec![DVec3::ZERO; CELLS * CELLS];
        let mut weights = vec![0.0; CELLS * CELLS];
        let mut sum = 0.0;
        for (axis, weight) in axes {
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
            // From 0 to the number of cells.
            let place = Projection::EqualArea
                .project(axis)
                .map(|part| ((0.5 * (part + 1.0) * CELLS as f64) as usize).min(CELLS - 1));
            let cell = place[1] * CELLS + place[0];
            cells[cell] += weight * if axis.z < 0.0 { -axis } else { axis };
            weights[cell] += weight;
            sum += weight;
        }
        let filled =
            cells.into_iter().zip(weights).filter(|(axis, weight)| *weight > 0.0 && *axis != DVec3::ZERO);
        let axes = filled.map(|(axis, weight)| (axis.normalize(), weight / sum)).collect();
        Self { axes, kernel, cutoff: kernel.cosine_at(1e-7) }
    }

    /// Density along a direction, in multiples of random.
    pub fn density(&self, direction: DVec3) -> f64 {
        let direction = direction.normalize();
        let of_axis = |(axis, weight): &(DVec3, f64)| {
            let cosine = axis.dot(direction);
            let of_end = |cosine: f64| if cosine > self.cutoff { self.kernel.density(cosine) } else { 0.0 };
            0.5 * weight * (of_end(cosine) + of_end(-cosine))
        };
        self.axes.iter().map(of_axis).sum()
    }
}

/// How the upper half of all directions becomes a disc of radius 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Projection {
    /// Lambert's: equal areas stay equal.
    #[default]
    EqualArea,
    /// Angles stay equal.
    Stereographic,
}

impl Projection {
    /// The point of a direction; of one in the lower half that of its opposite.
    pub fn project(self, direction: DVec3) -> [f64; 2] {
        let unit = direction.normalize();
        let upper = if unit.z < 0.0 { -unit } else { unit };
        let factor = match self {
            // sin(t/2) sqrt 2 over sin t.
            Self::EqualArea => 1.0 / (1.0 + upper.z).sqrt(),
            Self::Stereographic => 1.0 / (1.0 + upper.z),
        };
        [factor * upper.x, factor * upper.y]
    }

    /// The direction of a point; nothing outside the disc.
    pub fn direction(self, [x, y]: [f64; 2]) -> Option<DVec3> {
        let square = x * x + y * y;
        if square > 1.0 {
            return None;
        }
        Some(match self {
            Self::EqualArea => {
                let factor = (2.0 - square).sqrt();
                DVec3::new(factor * x, factor * y, 1.0 - square)
            }
            Self::Stereographic => DVec3::new(2.0 * x, 2.0 * y, 1.0 - square) / (1.0 + square),
        })
    }
}
