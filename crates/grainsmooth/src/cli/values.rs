//! Values of several options, as they are spelled.

use std::fmt::Display;
use std::ops::RangeInclusive;
use std::str::FromStr;

use voronoi::Domain;

/// Names less like a mistaken one are not taken for what was meant: Jaro-Winkler similarity, as clap has it.
const LEAST_SIMILARITY: f64 = 0.7;

/// The name most like a mistaken one, for a message.
pub fn nearest<'a>(mistaken: &str, names: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let similarity = |name: &str| strsim::jaro_winkler(&mistaken.to_lowercase(), name);
    let alike = names.into_iter().map(|name| (similarity(name), name));
    let nearest = alike.max_by(|a, b| a.0.total_cmp(&b.0))?;
    (nearest.0 > LEAST_SIMILARITY).then_some(nearest.1)
}

/// A whole number of a range.
pub fn whole_number<T>(range: RangeInclusive<T>) -> impl Fn(&str) -> Result<T, String> + Clone
where
    T: FromStr + PartialOrd + Display + Clone,
{
    move |text| {
        let number = text.parse().ok().filter(|number| range.contains(number));
        number.ok_or_else(|| format!("give a whole number from {} to {}", range.start(), range.end()))
    }
}

/// A length that can be computed with.
pub fn length(text: &str) -> Option<f64> {
    text.parse().ok().filter(|length| Domain::LENGTHS.contains(length))
}
