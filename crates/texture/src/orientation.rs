//! How a crystal stands in the sample.

use std::f64::consts::TAU;

use glam::{DMat3, DQuat, DVec3};

/// How a crystal stands in the sample.
///
/// The unit quaternion is (cos, +v) for the passive rotation of Bunge, as DAMASK and Neper have it, with the scalar part not negative.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Orientation(DQuat);

impl Orientation {
    /// The crystal's axes along those of the sample.
    pub const IDENTITY: Self = Self(DQuat::IDENTITY);

    /// From a quaternion with the scalar first; its length does not matter.
    ///
    /// Nothing for one that is zero or not finite.
    ///
    /// ```
    /// use texture::Orientation;
    ///
    /// let orientation = Orientation::from_quaternion([-2.0, 0.0, 0.0, 0.0]).expect("not zero");
    /// assert_eq!(orientation.quaternion(), [1.0, 0.0, 0.0, 0.0], "of length 1, w not negative");
    /// assert_eq!(Orientation::from_quaternion([0.0; 4]), None);
    /// ```
    pub fn from_quaternion([w, x, y, z]: [f64; 4]) -> Option<Self> {
        let quaternion = DQuat::from_xyzw(x, y, z, w);
        let length = quaternion.length();
        (length > 0.0 && length.is_finite()).then(|| Self::new(quaternion))
    }

    /// Of a quaternion that is not zero.
    pub(crate) fn new(quaternion: DQuat) -> Self {
        let unit = quaternion.normalize();
        let first = [unit.w, unit.x, unit.y, unit.z].into_iter().find(|part| *part != 0.0);
        // Of a half turn both signs have the scalar 0: the first part that is not zero tells.
        let unit = if first.is_some_and(|part| part < 0.0) { -unit } else { unit };
        // No part is -0, which would be written so.
        Self(DQuat::from_xyzw(unit.x + 0.0, unit.y + 0.0, unit.z + 0.0, unit.w + 0.0))
    }

    /// From Bunge's Euler angles phi1, Phi, phi2 in degrees.
    ///
    /// ```
    /// use glam::DVec3;
    /// use texture::Orientation;
    ///
    /// let turned = Orientation::from_euler_degrees([90.0, 0.0, 0.0]);
    /// // The sample's y axis is the crystal's x axis.
    /// assert!((turned.to_crystal(DVec3::Y) - DVec3::X).length() < 1e-12);
    /// ```
    pub fn from_euler_degrees([phi1, phi, phi2]: [f64; 3]) -> Self {
        let [first, middle, second] = [phi1, phi, phi2].map(|angle| (angle % 720.0).to_radians() / 2.0);
        let (sum, difference) = ((first + second).sin_cos(), (first - second).sin_cos());
        let (sine, cosine) = middle.sin_cos();
        Self::new(DQuat::from_xyzw(sine * difference.1, sine * difference.0, cosine * sum.0, cosine * sum.1))
    }

    /// From a matrix that takes components along the axes of the sample to those along the axes of the crystal.
    ///
    /// The nearest rotation is taken as far as rounding goes.
    pub fn from_matrix(to_crystal: DMat3) -> Self {
        Self::new(DQuat::from_mat3(&to_crystal.transpose()))
    }

    /// From a Rodrigues vector in Neper's passive sense: the axis times the tangent of half the angle.
    pub fn from_rodrigues(vector: DVec3) -> Self {
        Self::new(DQuat::from_xyzw(vector.x, vector.y, vector.z, 1.0))
    }

    /// The orientation with a crystal direction along the sample's X axis and a plane's normal along its Z axis; both in components
    /// along the crystal's axes. What of the direction does not lie in the plane is left out.
    ///
    /// Nothing where they are parallel or zero.
    ///
    /// ```
    /// use glam::DVec3;
    /// use texture::Orientation;
    ///
    /// // Goss, {011}<100>: as rolled sheets of iron and silicon have it.
    /// let goss = Orientation::from_plane_and_direction(DVec3::new(0.0, 1.0, 1.0), DVec3::X).expect("not parallel");
    /// assert!((goss.to_crystal(DVec3::X) - DVec3::X).length() < 1e-12, "[100] along the sample's X axis");
    /// assert_eq!(Orientation::from_plane_and_direction(DVec3::X, DVec3::X), None);
    /// ```
    pub fn from_plane_and_direction(normal: DVec3, direction: DVec3) -> Option<Self> {
        let z = normal.try_normalize()?;
        let x = direction.reject_from_normalized(z);
        let x = (x.length() > 1e-9 * direction.length()).then(|| x.normalize())?;
        Some(Self::from_matrix(DMat3::from_cols(x, z.cross(x), z)))
    }

    /// The orientation of the crystal after it was turned with its sample by an angle in degrees about an axis of the sample, of any length above 0.
    #[must_use]
    pub fn turned(self, axis: DVec3, degrees: f64) -> Self {
        Self::new(DQuat::from_axis_angle(axis.normalize(), degrees.to_radians()) * self.0)
    }

    /// The unit quaternion, scalar first and not negative.
    pub fn quaternion(self) -> [f64; 4] {
        [self.0.w, self.0.x, self.0.y, self.0.z]
    }

    pub(crate) fn raw(self) -> DQuat {
        self.0
    }

    /// Bunge's Euler angles phi1, Phi, phi2 in degrees: from 0 to below 360, from 0 to 180, from 0 to below 360.
    ///
    /// Where Phi is 0 or 180 only the sum or the difference of the others counts, and phi2 is 0.
    pub fn euler_degrees(self) -> [f64; 3] {
        let [w, x, y, z] = self.quaternion();
        let (inclined, upright) = (x.hypot(y), w.hypot(z));
        let (half_sum, half_difference) = (z.atan2(w), y.atan2(x));
        let (phi1, phi2) = if inclined < f64::EPSILON {
            (2.0 * half_sum, 0.0)
        } else if upright < f64::EPSILON {
            (2.0 * half_difference, 0.0)
        } else {
            (half_sum + half_difference, half_sum - half_difference)
        };
        [turned_positive(phi1), 2.0 * inclined.atan2(upright).to_degrees(), turned_positive(phi2)]
    }

    /// The matrix that takes components along the axes of the sample to those along the axes of the crystal.
    pub fn matrix(self) -> DMat3 {
        DMat3::from_quat(self.0.conjugate())
    }

    /// Neper's passive Rodrigues vector; not finite for half turns.
    pub fn rodrigues(self) -> DVec3 {
        self.0.xyz() / self.0.w
    }

    /// A direction of the sample in components along the crystal's axes.
    pub fn to_crystal(self, direction: DVec3) -> DVec3 {
        self.0.conjugate() * direction
    }

    /// A direction of the crystal in components along the sample's axes.
    pub fn to_sample(self, direction: DVec3) -> DVec3 {
        self.0 * direction
    }
}

/// An angle in radians as degrees from 0 to below 360.
fn turned_positive(radians: f64) -> f64 {
    let degrees = radians.rem_euclid(TAU).to_degrees();
    // A tiny negative angle comes back as a whole turn.
    if degrees < 360.0 { degrees } else { 0.0 }
}
