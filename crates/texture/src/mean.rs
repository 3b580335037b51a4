//! The mean of orientations.

use glam::{DMat4, DVec4};

use crate::{CrystalSymmetry, Orientation};

/// Rounds in which equivalents are chosen anew; two or three do where orientations are near each other.
const ROUNDS: usize = 20;
/// Squarings of the matrix whose main direction is looked for: `2^40` steps of the power method.
const SQUARINGS: usize = 40;

/// The orientation whose squared distances to others, each with a weight, are least; of each of these the nearest equivalent counts.
///
/// Nothing without a positive weight. Of orientations spread over all directions the result means little: equivalents are chosen by the
/// heaviest first.
///
/// ```
/// use texture::{CrystalSymmetry, Orientation, mean_orientation};
///
/// let of = |phi1| (Orientation::from_euler_degrees([phi1, 0.0, 0.0]), 1.0);
/// let mean = mean_orientation(&[of(2.0), of(4.0)], CrystalSymmetry::Octahedral).expect("weights above 0");
/// let middle = Orientation::from_euler_degrees([3.0, 0.0, 0.0]);
/// assert!(CrystalSymmetry::Octahedral.disorientation_angle(mean, middle) < 1e-6);
/// ```
pub fn mean_orientation(weighted: &[(Orientation, f64)], symmetry: CrystalSymmetry) -> Option<Orientation> {
    let positive = || weighted.iter().filter(|(_, weight)| *weight > 0.0);
    let heaviest = positive().rev().max_by(|a, b| a.1.total_cmp(&b.1))?;
    let mut mean = heaviest.0;
    for _ in 0..ROUNDS {
        let mut moments = DMat4::ZERO;
        for (orientation, weight) in positive() {
            let equivalents = symmetry.rotations().iter().map(|rotation| orientation.raw() * *rotation);
            let nearness = |quaternion: &glam::DQuat| quaternion.dot(mean.raw()).abs();
            let nearest = equivalents.max_by(|a, b| nearness(a).total_cmp(&nearness(b)));
            let parts = DVec4::from(nearest.expect("every group has the identity"));
            moments +=
                DMat4::from_cols_array_2d(&parts.to_array().map(|part| (*weight * part * parts).to_array()));
        }
        let next = Orientation::new(glam::DQuat::from_vec4(main_direction(moments)));
        if next.raw().dot(mean.raw()).abs() > 1.0 - 1e-15 {
            return Some(next);
        }
        mean = next;
    }
    Some(mean)
}

/// The eigenvector of the largest eigenvalue.
fn main_direction(mut moments: DMat4) -> DVec4 {
    for _ in 0..SQUARINGS {
        let trace = moments.x_axis.x + moments.y_axis.y + moments.z_axis.z + moments.w_axis.w;
        moments *= 1.0 / trace;
        moments *= moments;
    }
    let columns = [moments.x_axis, moments.y_axis, moments.z_axis, moments.w_axis];
    let longest = columns.into_iter().max_by(|a, b| a.length_squared().total_cmp(&b.length_squared()));
    longest.expect("a matrix has columns").normalize()
}
