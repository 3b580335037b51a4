//! The least rotation between two crystals.

use glam::DVec3;

use crate::{CrystalSymmetry, Orientation, Sector};

/// How much less the scalar of another equivalent may be to count as equal: rounding is some 1e-16.
const TIE: f64 = 1e-12;

/// Cosine of 15 degrees. Rotations of a group are 60 degrees or more, so that none takes crystals that are turned by 30 degrees at most nearer to each other.
const IS_LEAST: f64 = 0.965_925_826_289_068_3;

/// The least rotation that takes one crystal to another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Disorientation {
    /// In degrees.
    pub angle: f64,
    /// Unit axis in crystal coordinates, in the [`Sector`] of the Laue group; the z axis for no rotation at all.
    ///
    /// It is the same in both crystals, as the rotation is around it. Of several least rotations the one counts whose axis is nearest
    /// to z, then to x.
    pub axis: DVec3,
}

impl CrystalSymmetry {
    /// The least rotation between two crystals of this symmetry. The order of the two does not matter.
    ///
    /// ```
    /// use glam::DVec3;
    /// use texture::{CrystalSymmetry, Orientation};
    ///
    /// let crystal = Orientation::from_euler_degrees([10.0, 20.0, 30.0]);
    /// let turned = Orientation::from_euler_degrees([10.0, 20.0, 110.0]);
    /// let least = CrystalSymmetry::Octahedral.disorientation(crystal, turned);
    /// assert!((least.angle - 10.0).abs() < 1e-9, "80 degrees about a cube axis are 10 the other way");
    /// assert!((least.axis - DVec3::Z).length() < 1e-9);
    /// ```
    pub fn disorientation(self, first: Orientation, second: Orientation) -> Disorientation {
        let between = first.raw().conjugate() * second.raw();
        let scalar = |rotation: &glam::DQuat| rotation.dot(between).abs();
        let largest = self.rotations().iter().map(scalar).fold(0.0, f64::max);
        let sector = Sector::of(self);
        let mut angle = f64::INFINITY;
        let mut axis = DVec3::NEG_Z;
        for rotation in self.rotations().iter().filter(|rotation| scalar(rotation) >= largest - TIE) {
            let least = rotation.conjugate() * between;
            angle = angle.min(2.0 * least.xyz().length().atan2(least.w.abs()).to_degrees());
            let reduced = sector.reduce(least.xyz().try_normalize().unwrap_or(DVec3::Z));
            let is_as_near = reduced.z > axis.z - 1e-9 && reduced.x > axis.x;
            if reduced.z > axis.z + 1e-9 || is_as_near {
                axis = reduced;
            }
        }
        Disorientation { angle, axis }
    }

    /// Only the angle of [`Self::disorientation`], in degrees: faster.
    pub fn disorientation_angle(self, first: Orientation, second: Orientation) -> f64 {
        let between = first.raw().conjugate() * second.raw();
        let angle = |least: glam::DQuat| 2.0 * least.xyz().length().atan2(least.w.abs()).to_degrees();
        if between.w.abs() >= IS_LEAST {
            return angle(between);
        }
        let scalar = |rotation: &glam::DQuat| rotation.dot(between).abs();
        let by_scalar = |a: &&glam::DQuat, b: &&glam::DQuat| scalar(a).total_cmp(&scalar(b));
        let rotation = self.rotations().iter().max_by(by_scalar).expect("every group has the identity");
        angle(rotation.conjugate() * between)
    }

    /// How far two crystals are from being twins, in degrees: turned against each other by an angle in degrees about an axis, which has components along the orthogonal axes of
    /// the crystal, and any length above 0.
    pub fn twin_deviation(self, first: Orientation, second: Orientation, degrees: f64, axis: DVec3) -> f64 {
        let twin = glam::DQuat::from_axis_angle(axis.normalize(), degrees.to_radians());
        let twins = self.rotations().iter().map(|rotation| Orientation::new(first.raw() * *rotation * twin));
        twins.map(|twin| self.disorientation_angle(twin, second)).fold(f64::INFINITY, f64::min)
    }
}
