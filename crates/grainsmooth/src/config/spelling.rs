//! Values of options, as they are spelled on the command line and in settings.

use std::fmt::Display;
use std::ops::{RangeBounds, RangeInclusive};
use std::str::FromStr;

use clap::ValueEnum;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use glam::BVec3;
use serde::Serializer;
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

/// A number of a range; `remedy` says which.
pub(crate) fn number(
    range: impl RangeBounds<f64> + Clone,
    remedy: &'static str,
) -> impl Fn(&str) -> Result<f64, String> + Clone {
    move |text| text.parse().ok().filter(|number| range.contains(number)).ok_or_else(|| remedy.to_owned())
}

/// A name, its help and what it stands for.
pub(crate) type Named<T> = (&'static str, &'static str, T);

/// One of some values by its name.
pub(crate) fn one_of<T: Copy + Send + Sync + 'static>(
    named: &'static [Named<T>],
) -> impl TypedValueParser<Value = T> {
    let possible = named.iter().map(|(name, help, _)| match *help {
        "" => PossibleValue::new(*name),
        help => PossibleValue::new(*name).help(help),
    });
    let value = |name: String| named.iter().find(|(known, ..)| *known == name).map(|(.., value)| *value);
    PossibleValuesParser::new(possible).try_map(move |name| value(name).ok_or("no value has this name"))
}

/// Axes by name, or none.
pub(crate) fn axes(text: &str) -> Result<BVec3, String> {
    if text == "none" {
        return Ok(BVec3::FALSE);
    }
    let mut named = [false; 3];
    let known =
        text.split(',').all(|name| match ["x", "y", "z"].iter().position(|axis| *axis == name.trim()) {
            Some(axis) => !std::mem::replace(&mut named[axis], true),
            None => false,
        });
    if known {
        Ok(named.into())
    } else {
        Err("name each axis once, with commas between: x, y, z, x,y or x,y,z; or none".to_owned())
    }
}

/// The name of one of several values on the command line.
pub fn name_of(value: &impl ValueEnum) -> String {
    value.to_possible_value().map_or_else(String::new, |named| named.get_name().to_owned())
}

/// Whether an option has the value that it has where it is not given, so that settings need not tell.
pub(crate) fn is_usual<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}

/// A value as it is given on the command line.
pub(crate) fn as_text<S: Serializer>(value: &impl Display, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_str(value)
}

/// The same of a value that may be missing.
pub(crate) fn as_text_if_given<S: Serializer>(
    value: &Option<impl Display>,
    serializer: S,
) -> Result<S::Ok, S::Error> {
    match value {
        Some(value) => serializer.collect_str(value),
        None => serializer.serialize_none(),
    }
}

/// An option that is given once for each of its values.
pub(crate) fn as_texts<S: Serializer>(values: &[impl Display], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(values.iter().map(ToString::to_string))
}

/// A switch that is on.
pub(crate) fn as_true<S: Serializer>(_: &impl Copy, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_bool(true)
}

/// A whole number of any size: TOML's own end at 2^63, from where on it is a text.
pub(crate) fn as_number<S: Serializer>(number: &u64, serializer: S) -> Result<S::Ok, S::Error> {
    match i64::try_from(*number) {
        Ok(number) => serializer.serialize_i64(number),
        Err(_) => serializer.collect_str(number),
    }
}
