//! The method of conjugate gradients with Jacobi's preconditioner, on one thread: for the few unknowns of the grains.

/// When to stop.
pub(super) struct Limits {
    /// The preconditioned residual as a share of its first value.
    pub(super) tolerance: f64,
    pub(super) steps: usize,
}

/// Solves `A x = b` for a symmetric positive (semi)definite A and consistent b, starting from zero.
///
/// `apply(p, out)` writes `A p`; `inverse_diagonal` is 1 / A_ii for each unknown, 0 for unknowns that stay zero.
pub(super) fn solve(
    apply: impl Fn(&[f64], &mut [f64]),
    right_side: &[f64],
    inverse_diagonal: &[f64],
    limits: &Limits,
) -> Vec<f64> {
    let mut solution = vec![0.0; right_side.len()];
    let mut image = solution.clone();
    let mut residual = right_side.to_vec();
    let mut direction: Vec<f64> = residual.iter().zip(inverse_diagonal).map(|(r, d)| r * d).collect();
    let mut size = dot(&residual, &direction);
    let enough = size * limits.tolerance.powi(2);
    for _ in 0..limits.steps {
        if size <= enough {
            break;
        }
        apply(&direction, &mut image);
        let step = size / dot(&direction, &image);
        solution.iter_mut().zip(&direction).for_each(|(x, p)| *x += p * step);
        residual.iter_mut().zip(&image).for_each(|(r, q)| *r -= q * step);
        let next: f64 = residual.iter().zip(inverse_diagonal).map(|(r, d)| r * r * d).sum();
        let growth = next / size;
        let preconditioned = residual.iter().zip(inverse_diagonal);
        direction.iter_mut().zip(preconditioned).for_each(|(p, (r, d))| *p = r * d + *p * growth);
        size = next;
    }
    solution
}

pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn solves_a_chain_of_springs_with_fixed_ends() {
        // -x[i-1] + 2 x[i] - x[i+1] = h^2 with x = 0 beyond the ends: a parabola.
        let h = 1.0 / 51.0;
        let apply = |p: &[f64], out: &mut [f64]| {
            for i in 0..p.len() {
                let before = if i > 0 { p[i - 1] } else { 0.0 };
                out[i] = p[i] * 2.0 - before - p.get(i + 1).copied().unwrap_or(0.0);
            }
        };
        let limits = Limits { tolerance: 1e-13, steps: 200 };
        let solution = solve(apply, &[h * h; 50], &[0.5; 50], &limits);
        for (i, x) in (1u32..).zip(&solution) {
            let at = f64::from(i) * h;
            assert!((x - 0.5 * at * (1.0 - at)).abs() < 1e-12, "{x} at {at}");
        }
    }

    #[test]
    fn unknowns_with_zero_diagonal_stay_zero() {
        let apply = |p: &[f64], out: &mut [f64]| out.copy_from_slice(p);
        let limits = Limits { tolerance: 1e-12, steps: 5 };
        assert_eq!(solve(apply, &[3.0, 3.0], &[1.0, 0.0], &limits), [3.0, 0.0]);
    }
}
