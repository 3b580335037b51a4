//! The least motion of points that changes some sums as asked, such as the volumes of grains.

use std::collections::BTreeMap;

use glam::DVec3;

use crate::solver::conjugate_gradients::{Limits, SOLVED, solve};

/// A point: its weight, the square of its motion counting so much, and how each sum, by number, grows as it moves.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct MovingPoint {
    pub(crate) weight: f64,
    pub(crate) gradients: BTreeMap<u32, DVec3>,
}

/// The motions by which the sums change as asked, to first order: all points move along the gradients, by one multiplier for each sum. Points without weight stay.
pub(crate) fn least_motion(points: &[MovingPoint], asked: &[f64]) -> Vec<DVec3> {
    let mut matrix: Vec<BTreeMap<u32, f64>> = vec![BTreeMap::new(); asked.len()];
    for MovingPoint { weight, gradients } in points.iter().filter(|point| point.weight > 0.0) {
        for (sum, gradient) in gradients {
            for (other, along) in gradients {
                *matrix[*sum as usize].entry(*other).or_default() += gradient.dot(*along) / weight;
            }
        }
    }
    let apply = |multipliers: &[f64]| -> Vec<f64> {
        let row = |row: &BTreeMap<u32, f64>| {
            row.iter().map(|(other, value)| value * multipliers[*other as usize]).sum()
        };
        matrix.iter().map(row).collect()
    };
    let diagonal: Vec<f64> =
        (0u32..).zip(&matrix).map(|(sum, row)| row.get(&sum).copied().unwrap_or(0.0)).collect();
    let precondition = |residual: &[f64]| -> Vec<f64> {
        let entry = |(value, diagonal): (&f64, &f64)| if *diagonal > 0.0 { value / diagonal } else { 0.0 };
        residual.iter().zip(&diagonal).map(entry).collect()
    };
    let multipliers = solve(apply, precondition, asked, &Limits::of(asked.len(), SOLVED));
    let motion = |point: &MovingPoint| {
        let along = point.gradients.iter();
        let sum: DVec3 = along.map(|(sum, gradient)| *gradient * multipliers[*sum as usize]).sum();
        if point.weight > 0.0 { sum / point.weight } else { DVec3::ZERO }
    };
    points.iter().map(motion).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn light_points_move_more_and_sums_change_as_asked() {
        let point = |weight: f64, gradients: &[(u32, DVec3)]| MovingPoint {
            weight,
            gradients: gradients.iter().copied().collect(),
        };
        let points = [
            point(1.0, &[(0, DVec3::X)]),
            point(2.0, &[(0, DVec3::X), (1, DVec3::Y)]),
            point(0.0, &[(1, DVec3::Y)]),
        ];
        let motions = least_motion(&points, &[3.0, 1.0]);
        let expected = [DVec3::X * 2.0, DVec3::new(1.0, 1.0, 0.0), DVec3::ZERO];
        motions.iter().zip(expected).for_each(|(is, wanted)| assert!(is.distance(wanted) < 1e-5, "{is}"));
    }
}
