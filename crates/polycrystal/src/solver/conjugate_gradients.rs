//! The method of conjugate gradients with a preconditioner, for the few unknowns of the grains.

use cancellation::check_cancelled;

/// When to stop.
pub(crate) struct Limits {
    /// The preconditioned residual as a share of its first value.
    pub(crate) tolerance: f64,
    pub(crate) steps: usize,
}

/// Residual that is small enough, as a share of its first value, where what is left is asked for once more.
pub(crate) const SOLVED: f64 = 1e-6;

impl Limits {
    /// Those of so many unknowns. Without rounding as many steps are enough; where there is no solution, more of them would only blow up what rounding
    /// leaves.
    pub(crate) fn of(unknowns: usize, tolerance: f64) -> Self {
        Self { tolerance, steps: 2 * unknowns + 20 }
    }
}

/// Solves `A x = b` for a symmetric positive (semi)definite A and consistent b, starting from zero.
///
/// `apply` multiplies a vector with A, `precondition` with a symmetric, positive (semi)definite matrix that is much like
/// A's inverse.
pub(crate) fn solve(
    apply: impl Fn(&[f64]) -> Vec<f64>,
    precondition: impl Fn(&[f64]) -> Vec<f64>,
    right_side: &[f64],
    limits: &Limits,
) -> Vec<f64> {
    let mut solution = vec![0.0; right_side.len()];
    let mut residual = right_side.to_vec();
    let mut direction = precondition(&residual);
    let mut size = dot(&residual, &direction);
    let enough = size * limits.tolerance.powi(2);
    for _ in 0..limits.steps {
        check_cancelled();
        if size <= enough {
            break;
        }
        let image = apply(&direction);
        let stiffness = dot(&direction, &image);
        // What cannot move has no answer.
        if stiffness.is_nan() || stiffness <= 0.0 {
            break;
        }
        let step = size / stiffness;
        solution.iter_mut().zip(&direction).for_each(|(x, p)| *x += p * step);
        residual.iter_mut().zip(&image).for_each(|(r, q)| *r -= q * step);
        let preconditioned = precondition(&residual);
        let next = dot(&residual, &preconditioned);
        let growth = next / size;
        direction.iter_mut().zip(&preconditioned).for_each(|(p, z)| *p = z + *p * growth);
        size = next;
    }
    solution
}

pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn solves_a_chain_of_springs_with_fixed_ends() {
        // -x[i-1] + 2 x[i] - x[i+1] = h^2 with x = 0 beyond the ends: a parabola.
        let h = 1.0 / 51.0;
        let apply = |p: &[f64]| -> Vec<f64> {
            let at = |i: Option<usize>| i.and_then(|i| p.get(i)).copied().unwrap_or(0.0);
            (0..p.len()).map(|i| 2.0 * p[i] - at(i.checked_sub(1)) - at(Some(i + 1))).collect()
        };
        let precondition = |r: &[f64]| r.iter().map(|r| 0.5 * r).collect();
        let limits = Limits { tolerance: 1e-13, steps: 200 };
        let solution = solve(apply, precondition, &[h * h; 50], &limits);
        for (i, x) in (1u32..).zip(&solution) {
            let at = f64::from(i) * h;
            assert!((x - 0.5 * at * (1.0 - at)).abs() < 1e-12, "{x} at {at}");
        }
    }
}
