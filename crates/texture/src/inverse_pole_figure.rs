//! Colours of crystal directions.

use std::f64::consts::TAU;

use glam::DVec3;

use crate::{CrystalSymmetry, Orientation, Sector};

/// Intervals of Simpson's rule for a part of the hue: with 64 the hue errs by less than 1e-6.
const INTERVALS: u32 = 64;

/// The colours of TSL's key (Nolze and Hielscher 2016): the corners of the sector are red, green and blue, its middle is white.
///
/// The hue grows with the area of the border's distance around the middle, so that each third has all its colours.
#[derive(Debug, Clone)]
pub struct IpfKey {
    sector: &'static Sector,
    /// Tangents at the middle; angles are counted from the first.
    tangents: [DVec3; 2],
    /// Angle of each mark in radians, and the integral of the border's distance from it to the next.
    parts: [(f64, f64); 3],
}

impl IpfKey {
    /// The key of a symmetry.
    pub fn new(symmetry: CrystalSymmetry) -> Self {
        let sector = Sector::of(symmetry);
        let center = sector.center();
        let first = sector.marks()[0].reject_from_normalized(center).normalize();
        let tangents = [first, center.cross(first)];
        let mut key = Self { sector, tangents, parts: [(0.0, 0.0); 3] };
        let [_, second, third] = sector.marks().map(|mark| key.angle(mark));
        let ends = [0.0, second, third, TAU];
        let parts = [0, 1, 2].map(|part| (ends[part], key.integral(ends[part], ends[part + 1])));
        key.parts = parts;
        key
    }

    /// The colour of a crystal direction: red, green and blue from 0 to 1.
    ///
    /// ```
    /// use glam::DVec3;
    /// use texture::{CrystalSymmetry, IpfKey};
    ///
    /// let [red, green, blue] = IpfKey::new(CrystalSymmetry::Octahedral).color(DVec3::Z);
    /// assert!(red > 0.99 && green < 0.01 && blue < 0.01, "[001] of a cubic crystal is red");
    /// ```
    pub fn color(&self, direction: DVec3) -> [f64; 3] {
        let direction = self.sector.reduce(direction.normalize());
        let arc = direction.cross(self.sector.center()).length().atan2(direction.dot(self.sector.center()));
        if arc < 1e-12 {
            return [1.0; 3];
        }
        let angle = self.angle(direction);
        let part = self.parts.iter().rposition(|(start, _)| *start <= angle).unwrap_or(0);
        let (start, whole) = self.parts[part];
        let thirds = [0.0, 1.0, 2.0][part] + self.integral(start, angle) / whole;
        let lightness = 1.0 - 0.5 * (arc / self.sector.arc_to_border(self.tangent(angle))).min(1.0);
        saturated(2.0 * thirds, lightness)
    }

    /// The colour of what a direction of the sample is in the crystal, as bytes.
    pub fn color_of(&self, orientation: Orientation, sample_direction: DVec3) -> [u8; 3] {
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // From 0 to 255.
        self.color(orientation.to_crystal(sample_direction)).map(|part| (255.0 * part).round() as u8)
    }

    /// Angle around the middle, counter-clockwise from the first mark, from 0 to below a whole turn.
    fn angle(&self, direction: DVec3) -> f64 {
        let angle = direction.dot(self.tangents[1]).atan2(direction.dot(self.tangents[0]));
        let turned = angle.rem_euclid(TAU);
        if turned < TAU { turned } else { 0.0 }
    }

    fn tangent(&self, angle: f64) -> DVec3 {
        angle.cos() * self.tangents[0] + angle.sin() * self.tangents[1]
    }

    /// Integral of the arc to the border between two angles, by Simpson's rule.
    fn integral(&self, from: f64, to: f64) -> f64 {
        let step = (to - from) / f64::from(INTERVALS);
        let arc = |index: u32| {
            let weight = match index {
                0 | INTERVALS => 1.0,
                odd if odd % 2 == 1 => 4.0,
                _ => 2.0,
            };
            weight * self.sector.arc_to_border(self.tangent(from + step * f64::from(index)))
        };
        (0..=INTERVALS).map(arc).sum::<f64>() * step / 3.0
    }
}

/// A colour of full saturation by hue in sixths of the circle and lightness, both of HSL.
fn saturated(sixths: f64, lightness: f64) -> [f64; 3] {
    let chroma = 1.0 - (2.0 * lightness - 1.0).abs();
    // Each part is at its most within one sixth of its own hue, and none two sixths away.
    let part = |own: f64| {
        let distance = (sixths - own).abs();
        let away = distance.min(6.0 - distance);
        lightness + chroma * ((2.0 - away).clamp(0.0, 1.0) - 0.5)
    };
    [part(0.0), part(2.0), part(4.0)].map(|value| value.clamp(0.0, 1.0))
}
