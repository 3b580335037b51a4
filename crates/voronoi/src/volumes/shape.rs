//! Ellipsoids, and the spheres inscribed in them.

use std::f64::consts::{PI, TAU};

use glam::{DMat3, DVec3};

use crate::Dimension;

/// Axes that differ by less, in parts of one, are taken for equal: a line of spheres for a disc of them.
const EQUAL_AXES: f64 = 0.1;

/// The shape that a grain is to have: an ellipsoid as large as the grain. In the plane an ellipse.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GrainShape {
    /// Lengths of its axes in proportion, positive; in the plane the third is not used.
    pub lengths: DVec3,
    /// The directions of the axes, a rotation; in the plane the third is along z.
    pub axes: DMat3,
}

/// A sphere of a grain, seen from the grain's centre.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct InscribedSphere {
    pub(super) center: DVec3,
    pub(super) squared_radius: f64,
}

impl GrainShape {
    /// A ball.
    pub const BALL: Self = Self { lengths: DVec3::ONE, axes: DMat3::IDENTITY };

    /// The same with the logarithms of the proportions multiplied by a factor: 0 makes a ball of it.
    pub(super) fn with_contrast(self, factor: f64) -> Self {
        Self { lengths: self.lengths.powf(factor), ..self }
    }

    /// Spheres that touch the ellipsoid of a volume (in the plane: circles and area) from inside, the first at its centre. They stand
    /// along a line where two of its axes are alike, else on a disc in rings; with each degree of `fineness` there are more.
    ///
    /// Centres lie where inscribed spheres touch twice: with the semi-axes a, b, c on the ellipse with `(a^2 - c^2) / a` and `(b^2 - c^2) / b`, where the
    /// squared radius is `c^2 (1 - x^2 / (a^2 - c^2) - y^2 / (b^2 - c^2))`.
    pub(super) fn inscribed_spheres(
        &self,
        dimension: Dimension,
        volume: f64,
        fineness: u32,
    ) -> Vec<InscribedSphere> {
        let axes = [0, 1, 2].map(|axis| (self.lengths[axis], self.axes.col(axis)));
        let mut axes = match dimension {
            Dimension::Two => vec![axes[0], axes[1]],
            Dimension::Three => axes.to_vec(),
        };
        // Of equal axes the first stays first.
        axes.sort_by(|one, other| other.0.total_cmp(&one.0));
        let product: f64 = axes.iter().map(|(length, _)| length).product();
        let unit = match dimension {
            Dimension::Two => (volume / (PI * product)).sqrt(),
            Dimension::Three => (0.75 * volume / (PI * product)).cbrt(),
        };
        let (a, along_a) = (unit * axes[0].0, axes[0].1);
        let (b, along_b) = (unit * axes[1].0, axes[1].1);
        let c = unit * axes[axes.len() - 1].0;
        let center = InscribedSphere { center: DVec3::ZERO, squared_radius: c * c };
        let mut spheres = vec![center];
        if a < (1.0 + EQUAL_AXES) * c {
            return spheres;
        }
        let is_disc = b > (1.0 + EQUAL_AXES) * c;
        let reach = DVec3::new((a * a - c * c) / a, if is_disc { (b * b - c * c) / b } else { 0.0 }, 0.0);
        let rings = rings(a / c, is_disc) + fineness;
        for ring in 1..=rings {
            let share = f64::from(ring) / f64::from(rings);
            let count = if is_disc { 6 * ring } else { 2 };
            for step in 0..count {
                let (sine, cosine) = (TAU * f64::from(step) / f64::from(count)).sin_cos();
                let (x, y) = (share * reach.x * cosine, share * reach.y * sine);
                let below = x * x / (a * a - c * c) + if is_disc { y * y / (b * b - c * c) } else { 0.0 };
                spheres.push(InscribedSphere {
                    center: x * along_a + y * along_b,
                    squared_radius: c * c * (1.0 - below),
                });
            }
        }
        spheres
    }
}

/// Rings around the centre: of a line two spheres each. With 3 spheres for 2:1:1, 5 for 3:1:1, 9 for 5:1:1 and 7 for 3:3:1 a prototype came as near to
/// the ellipsoids as voxels of anisotropic diagrams do.
fn rings(ratio: f64, is_disc: bool) -> u32 {
    let wanted = if is_disc { 0.5 * (ratio - 1.0) } else { ratio - 1.0 };
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small number")]
    let whole = wanted.round().clamp(1.0, 20.0) as u32;
    whole
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Each sphere touches the ellipsoid from inside: the largest value of its equation on the sphere is 1.
    #[test]
    fn spheres_touch_their_ellipsoid_from_inside() {
        for lengths in [[2.0, 1.0, 1.0], [1.0, 5.0, 1.0], [3.0, 3.0, 1.0], [1.0, 2.0, 3.0]] {
            let shape = GrainShape { lengths: DVec3::from_array(lengths), axes: DMat3::from_rotation_y(0.7) };
            let volume = 4.0 / 3.0 * PI * shape.lengths.element_product();
            for sphere in shape.inscribed_spheres(Dimension::Three, volume, 1) {
                let radius = sphere.squared_radius.sqrt();
                let largest = directions().map(|direction| {
                    let point = shape.axes.transpose() * (sphere.center + radius * direction);
                    (point / shape.lengths).length_squared()
                });
                let largest = largest.fold(0.0, f64::max);
                assert!((0.99..1.0 + 1e-12).contains(&largest), "{lengths:?}: {largest}");
            }
        }
    }

    #[test]
    fn circles_touch_their_ellipse_from_inside() {
        let shape = GrainShape { lengths: DVec3::new(1.0, 3.0, 9.0), axes: DMat3::from_rotation_z(0.4) };
        let circles = shape.inscribed_spheres(Dimension::Two, 3.0 * PI, 0);
        assert_eq!(circles.len(), 5);
        for circle in circles {
            let radius = circle.squared_radius.sqrt();
            let largest = (0..1000).map(|step| {
                let (sine, cosine) = (TAU * f64::from(step) / 1000.0).sin_cos();
                let point = shape.axes.transpose() * (circle.center + radius * DVec3::new(cosine, sine, 0.0));
                (point.x.powi(2) + (point.y / 3.0).powi(2)).max(0.0)
            });
            let largest = largest.fold(0.0, f64::max);
            assert!((0.9999..1.0 + 1e-12).contains(&largest), "{largest}");
        }
    }

    fn directions() -> impl Iterator<Item = DVec3> {
        (0..200).flat_map(|polar| {
            let (sine, cosine) = (PI * f64::from(polar) / 199.0).sin_cos();
            (0..400).map(move |azimuth| {
                let (y, x) = (TAU * f64::from(azimuth) / 400.0).sin_cos();
                DVec3::new(sine * x, sine * y, cosine)
            })
        })
    }
}
