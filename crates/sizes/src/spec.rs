//! Distributions in words.

use std::str::FromStr;

use thiserror::Error;

use crate::{Distribution, Law, Part};

/// A text that is no distribution.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("diameters '{text}': {problem}")]
pub struct SpecError {
    text: String,
    problem: String,
}

/// A distribution of diameters in words.
#[derive(Debug, Clone, PartialEq)]
pub struct Spec {
    text: String,
    parts: Vec<(f64, Part)>,
    is_by_volume: bool,
}

/// A law as it is written: its name, the numbers that it takes in any of several forms, and an example.
struct Form {
    name: &'static str,
    numbers: &'static [&'static [&'static str]],
    /// Whether the numbers of the first form may come without their names.
    may_be_nameless: bool,
    example: &'static str,
}

const FORMS: [Form; 6] = [
    Form { name: "equal", numbers: &[&["d"]], may_be_nameless: true, example: "equal(20)" },
    Form {
        name: "normal",
        numbers: &[&["mean", "sd"], &["mean", "cv"]],
        may_be_nameless: false,
        example: "normal(mean=20, sd=5)",
    },
    Form {
        name: "lognormal",
        numbers: &[&["mean", "cv"], &["mean", "sd"], &["median", "sigma"]],
        may_be_nameless: false,
        example: "lognormal(mean=20, cv=0.35)",
    },
    Form { name: "uniform", numbers: &[&["min", "max"]], may_be_nameless: true, example: "uniform(10, 30)" },
    Form {
        name: "weibull",
        numbers: &[&["shape", "scale"], &["shape", "mean"]],
        may_be_nameless: false,
        example: "weibull(shape=2.8, scale=20)",
    },
    Form {
        name: "gamma",
        numbers: &[&["shape", "scale"], &["mean", "cv"]],
        may_be_nameless: false,
        example: "gamma(mean=20, cv=0.35)",
    },
];

impl Spec {
    /// The distribution, for grains of two or three dimensions: what weights by volume mean depends on these.
    pub fn distribution(&self, axes: u32) -> Distribution {
        Distribution::new(self.parts.clone(), self.is_by_volume.then_some(axes))
    }

    /// The words.
    pub fn text(&self) -> &str {
        &self.text
    }
}

impl FromStr for Spec {
    type Err = SpecError;

    /// Reads a sum of laws: `lognormal(mean=20, cv=0.35)`, or `0.8*lognormal(mean=20, cv=0.3) + 0.2*equal(60)`.
    ///
    /// A law may have cut-offs among its numbers, `from=` and `to=`. Behind the sum may stand cut-offs for each of its laws, and `by=volume`,
    /// with which weights are shares of the volume and not of the number: `..., from=5, to=80, by=volume`.
    fn from_str(text: &str) -> Result<Self, SpecError> {
        read(text).map_err(|problem| SpecError { text: text.to_owned(), problem })
    }
}

fn read(text: &str) -> Result<Spec, String> {
    let (sum, options) = without_options(text)?;
    let mut ends = [0.0, f64::INFINITY];
    let mut is_by_volume = false;
    for option in options.split([',', ' ', '\t']).filter(|option| !option.is_empty()) {
        match option.split_once('=').map(|(key, value)| (key.trim(), value.trim())) {
            Some(("from", value)) => ends[0] = length("from", value)?,
            Some(("to", value)) => ends[1] = length("to", value)?,
            Some(("by", "volume")) => is_by_volume = true,
            Some(("by", "number")) => is_by_volume = false,
            Some(("by", value)) => {
                return Err(format!("by={value} is unknown; write by=number or by=volume"));
            }
            _ => {
                return Err(format!(
                    "'{option}' is unknown; behind the sum may stand from=5, to=80, by=volume"
                ));
            }
        }
    }
    let mut parts = Vec::new();
    for term in split(&sum, '+')? {
        parts.push((term, weighted(term, ends)?));
    }
    let has_weight = |(_, (weight, _)): &(&str, (Option<f64>, Part))| weight.is_some();
    if parts.iter().any(has_weight)
        && let Some((term, _)) = parts.iter().find(|part| !has_weight(part))
    {
        let term = term.trim();
        return Err(format!("'{term}' has no weight, others do; write 0.5*{term}, for example"));
    }
    let parts = parts.into_iter().map(|(_, (weight, part))| (weight.unwrap_or(1.0), part)).collect();
    Ok(Spec { text: text.to_owned(), parts, is_by_volume })
}

/// The sum, and the options behind it: these begin with the word before the first `=` outside all brackets.
fn without_options(text: &str) -> Result<(String, String), String> {
    let mut text = text.trim().to_owned();
    for (blank, none) in [(" =", "="), ("= ", "=")] {
        while text.contains(blank) {
            text = text.replace(blank, none);
        }
    }
    let mut depth = 0_u32;
    let mut equals = None;
    for (place, character) in text.char_indices() {
        match character {
            '(' => depth += 1,
            ')' => depth = depth.checked_sub(1).ok_or("a ')' closes nothing; take it out")?,
            '=' if depth == 0 => {
                equals = Some(place);
                break;
            }
            _ => {}
        }
    }
    if depth > 0 {
        return Err("a bracket is not closed; add ')'".to_owned());
    }
    let Some(equals) = equals else { return Ok((text, String::new())) };
    let start = text[..equals].rfind([',', ' ', ')', '\t']).map_or(0, |before| before + 1);
    let options = text.split_off(start);
    Ok((text.trim_end_matches([',', ' ', '\t']).to_owned(), options))
}

/// A law with its weight, if it has one.
fn weighted(term: &str, ends: [f64; 2]) -> Result<(Option<f64>, Part), String> {
    let mut weight = None;
    let mut found = None;
    for factor in split(term, '*')? {
        let factor = factor.trim();
        if let Ok(number) = factor.parse::<f64>() {
            if !(number > 0.0 && number.is_finite()) {
                return Err(format!(
                    "the weight {factor} is not positive and finite; leave out what has no share"
                ));
            }
            weight = Some(weight.unwrap_or(1.0) * number);
        } else if found.replace(part(factor, ends)?).is_some() {
            return Err(format!("'{}' multiplies two distributions; add them with +", term.trim()));
        }
    }
    let part = found.ok_or_else(|| match weight {
        Some(number) => format!("'{}' is a number alone; write equal({number})", term.trim()),
        None => format!("'{}' is not a distribution; write {}, for example", term.trim(), FORMS[2].example),
    })?;
    Ok((weight, part))
}

fn part(text: &str, [from, to]: [f64; 2]) -> Result<Part, String> {
    let (name, numbers) = text.split_once('(').map_or((text, None), |(name, rest)| (name, Some(rest)));
    let name = name.trim().to_lowercase();
    let form = FORMS.iter().find(|form| form.name == name).ok_or_else(|| unknown(&name))?;
    let numbers = numbers.ok_or_else(|| needs(text, form))?;
    let numbers = numbers
        .strip_suffix(')')
        .ok_or_else(|| format!("'{text}' goes on after its bracket; put * or + there"))?;
    let mut named: Vec<(&str, f64)> = Vec::new();
    let mut ends = [from, to];
    let list: Vec<&str> = numbers.split(',').map(str::trim).filter(|number| !number.is_empty()).collect();
    for (place, number) in list.iter().enumerate() {
        let nameless = || form.numbers[0].get(place).copied().filter(|_| form.may_be_nameless);
        let (key, value) = match number.split_once('=') {
            Some((key, value)) => (key.trim(), value.trim()),
            None => (nameless().ok_or_else(|| needs(text, form))?, *number),
        };
        match key {
            "from" => ends[0] = ends[0].max(length(key, value)?),
            "to" => ends[1] = ends[1].min(length(key, value)?),
            _ => named.push((key, finite(key, value)?)),
        }
    }
    if ends[0] > ends[1] {
        return Err(format!("'{text}' is cut off from {} to {}; give a range", ends[0], ends[1]));
    }
    let values = |keys: &&[&str]| -> Option<Vec<f64>> {
        let value = |key: &&str| named.iter().find(|(name, _)| name == key).map(|(_, value)| *value);
        if named.len() == keys.len() { keys.iter().map(value).collect() } else { None }
    };
    let found = form.numbers.iter().find_map(|keys| Some((*keys, values(keys)?)));
    let (keys, values) = found.ok_or_else(|| needs(text, form))?;
    if let Some((key, value)) = keys.iter().zip(&values).find(|(key, value)| **value <= 0.0 && **key != "min")
    {
        let hint = if matches!(*key, "sd" | "cv" | "sigma") {
            "; for grains of one size write equal(20)"
        } else {
            ""
        };
        return Err(format!("{key}={value} in '{text}' is not positive; give a positive number{hint}"));
    }
    let law = law(form.name, keys, &values).map_err(|problem| format!("'{text}': {problem}"))?;
    Part::new(law, ends[0], ends[1]).map_err(|error| format!("'{text}': {error}"))
}

fn law(name: &str, keys: &[&str], values: &[f64]) -> Result<Law, String> {
    let of_variation = |mean: f64, variation: f64| {
        let square = 1.0 + variation * variation;
        Law::LogNormal { median: mean / square.sqrt(), sigma: libm::log(square).sqrt() }
    };
    Ok(match (name, keys, values) {
        ("equal", _, &[diameter]) => Law::Equal(diameter),
        ("normal", [_, "sd"], &[mean, deviation]) => Law::Normal { mean, deviation },
        ("normal", _, &[mean, variation]) => Law::Normal { mean, deviation: mean * variation },
        ("lognormal", ["mean", "cv"], &[mean, variation]) => of_variation(mean, variation),
        ("lognormal", ["mean", _], &[mean, deviation]) => of_variation(mean, deviation / mean),
        ("lognormal", _, &[median, sigma]) => Law::LogNormal { median, sigma },
        ("uniform", _, &[least, largest]) if 0.0 <= least && least < largest => {
            Law::Uniform { least, largest }
        }
        ("uniform", _, &[least, largest]) => {
            return Err(format!(
                "from {least} to {largest} is not a range of diameters; write the smaller one first"
            ));
        }
        ("weibull", [_, "scale"], &[shape, scale]) => Law::Weibull { shape, scale },
        ("weibull", _, &[shape, mean]) => {
            Law::Weibull { shape, scale: mean / libm::tgamma(1.0 + 1.0 / shape) }
        }
        ("gamma", ["shape", _], &[shape, scale]) => Law::Gamma { shape, scale },
        ("gamma", _, &[mean, variation]) => {
            let square = variation * variation;
            Law::Gamma { shape: 1.0 / square, scale: mean * square }
        }
        _ => return Err("has other numbers than it needs; see the manual".to_owned()),
    })
}

fn needs(text: &str, form: &Form) -> String {
    let alternatives: Vec<String> = form.numbers.iter().map(|keys| keys.join(" and ")).collect();
    format!("'{text}' needs {}, and may have from and to: {}", alternatives.join(", or "), form.example)
}

fn unknown(name: &str) -> String {
    let nearest = FORMS.iter().map(|form| (strsim::osa_distance(form.name, name), form.name)).min();
    match nearest {
        Some((distance, known)) if distance <= 2 && distance < known.len() => {
            format!("'{name}' is unknown; did you mean '{known}'?")
        }
        _ => {
            let names: Vec<&str> = FORMS.iter().map(|form| form.name).collect();
            format!("'{name}' is unknown; there are {}, and sums of them", names.join(", "))
        }
    }
}

fn finite(key: &str, text: &str) -> Result<f64, String> {
    let number = text.parse::<f64>().ok().filter(|number| number.is_finite());
    number.ok_or_else(|| format!("{key}={text} is not a finite number; write {key}=0.5, for example"))
}

/// A cut-off.
fn length(key: &str, text: &str) -> Result<f64, String> {
    let number = finite(key, text)?;
    if number < 0.0 { Err(format!("{key}={text} is negative; give a diameter")) } else { Ok(number) }
}

/// Parts between a separator that stands outside all brackets.
fn split(text: &str, separator: char) -> Result<Vec<&str>, String> {
    let (mut depth, mut start) = (0_u32, 0);
    let mut parts = Vec::new();
    for (place, character) in text.char_indices() {
        match character {
            '(' => depth += 1,
            ')' => depth = depth.saturating_sub(1),
            _ if character == separator && depth == 0 => {
                parts.push(&text[start..place]);
                start = place + character.len_utf8();
            }
            _ => {}
        }
    }
    parts.push(&text[start..]);
    match parts.iter().any(|part| part.trim().is_empty()) {
        true if parts.len() == 1 => Err(format!("is empty; write {}, for example", FORMS[2].example)),
        true => Err(format!(
            "nothing stands on one side of a '{separator}'; write {}, for example",
            FORMS[2].example
        )),
        false => Ok(parts),
    }
}
