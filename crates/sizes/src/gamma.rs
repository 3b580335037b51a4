//! The incomplete gamma function.

/// Terms of the series or the fraction at most: some square root of the larger argument is what they take.
const MOST_TERMS: u32 = 100_000;

/// Where a term changes nothing.
const NEGLIGIBLE: f64 = 1e-17;

/// The share of the gamma distribution of some shape and scale 1 below a number: the regularised lower incomplete gamma function, by
/// its series, or on the other side of the mean by its continued fraction (Lentz's method).
pub(crate) fn gamma_share(shape: f64, x: f64) -> f64 {
    if x <= 0.0 {
        return 0.0;
    }
    if x == f64::INFINITY {
        return 1.0;
    }
    let factor = libm::exp(shape * libm::log(x) - x - libm::lgamma(shape));
    if x < shape + 1.0 {
        let (mut term, mut sum) = (1.0 / shape, 1.0 / shape);
        for step in 1..MOST_TERMS {
            term *= x / (shape + f64::from(step));
            sum += term;
            if term < NEGLIGIBLE * sum {
                break;
            }
        }
        return factor * sum;
    }
    let away_from_zero = |value: f64| if value.abs() < 1e-300 { 1e-300 } else { value };
    let mut base = x + 1.0 - shape;
    let mut numerator = 1e300;
    let mut denominator = 1.0 / away_from_zero(base);
    let mut fraction = denominator;
    for step in 1..MOST_TERMS {
        let step = f64::from(step);
        let next = -step * (step - shape);
        base += 2.0;
        denominator = 1.0 / away_from_zero(next * denominator + base);
        numerator = away_from_zero(base + next / numerator);
        let change = numerator * denominator;
        fraction *= change;
        if (change - 1.0).abs() < 1e-16 {
            break;
        }
    }
    1.0 - factor * fraction
}
