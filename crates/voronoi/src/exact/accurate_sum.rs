//! Sums of doubles that keep what rounding leaves out.

/// A rounded sum, and what rounding left out (Knuth 1969).
pub(crate) fn sum_and_rest(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let of_b = sum - a;
    (sum, (a - (sum - of_b)) + (b - of_b))
}

/// A sum good to one or two last places whatever cancels: the partial sums are kept with all their digits
/// (Shewchuk 1997).
pub(crate) fn accurate_sum(terms: [f64; 4]) -> f64 {
    // Numbers whose digits do not overlap, from small to large.
    let mut parts = [0.0; 4];
    for (count, term) in terms.into_iter().enumerate() {
        let mut carry = term;
        for part in &mut parts[..count] {
            let (sum, rest) = sum_and_rest(carry, *part);
            *part = rest;
            carry = sum;
        }
        parts[count] = carry;
    }
    parts.iter().sum()
}
