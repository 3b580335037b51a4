//! Numbers as people read them.

/// A number with so many digits that mean something, in powers of ten where plain digits would be many zeros.
pub(crate) fn significant(value: f64, digits: usize) -> String {
    let scientific = format!("{value:.*e}", digits.saturating_sub(1));
    let plain: f64 = scientific.parse().unwrap_or(value);
    if plain == 0.0 || (1e-3..1e6).contains(&plain.abs()) { plain.to_string() } else { scientific }
}

/// The largest number of two digits that is not above a positive one.
pub(crate) fn two_digits_down(number: f64) -> f64 {
    let unit = 10f64.powf(number.log10().floor() - 1.0);
    let digits = format!("{:.1e}", (number / unit).floor() * unit);
    digits.parse().unwrap_or(number)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_are_those_that_mean_something() {
        let rounded = [0.0, 12.3456, -0.99996, 1e-9, 2.5e7, 1e300].map(|value| significant(value, 4));
        assert_eq!(rounded, ["0", "12.35", "-1", "1.000e-9", "2.500e7", "1.000e300"]);
    }
}
