//! Textures in words.

use std::str::FromStr;

use glam::DVec3;
use thiserror::Error;

use crate::{Component, FiberKernel, Kernel, Orientation, Texture, miller};

/// A text that is no texture.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("texture '{text}': {problem}")]
pub struct SpecError {
    text: String,
    problem: String,
}

/// Ideal orientations of cubic metals: name, plane along Z (normal direction), direction along X (rolling direction).
const IDEAL: [(&str, [f64; 3], [f64; 3]); 8] = [
    ("cube", [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]),
    ("rotated-cube", [0.0, 0.0, 1.0], [1.0, 1.0, 0.0]),
    ("goss", [0.0, 1.0, 1.0], [1.0, 0.0, 0.0]),
    ("rotated-goss", [1.0, 1.0, 0.0], [1.0, -1.0, 0.0]),
    ("brass", [0.0, 1.0, 1.0], [2.0, -1.0, 1.0]),
    ("copper", [1.0, 1.0, 2.0], [-1.0, -1.0, 1.0]),
    ("s", [1.0, 2.0, 3.0], [6.0, 3.0, -4.0]),
    ("dillamore", [4.0, 4.0, 11.0], [-11.0, -11.0, 8.0]),
];

/// Fibers with a name: crystal direction and sample direction.
const FIBERS: [(&str, [f64; 3], DVec3); 5] = [
    ("alpha", [1.0, 1.0, 0.0], DVec3::X),
    ("gamma", [1.0, 1.0, 1.0], DVec3::Z),
    ("eta", [1.0, 0.0, 0.0], DVec3::X),
    ("theta", [0.0, 0.0, 1.0], DVec3::Z),
    ("basal", [0.0, 0.0, 1.0], DVec3::Z),
];

/// The ideal orientations that a texture can name.
pub fn ideal_orientations() -> impl ExactSizeIterator<Item = (&'static str, Orientation)> {
    IDEAL.iter().map(|(name, plane, direction)| {
        let [plane, direction] = [*plane, *direction].map(DVec3::from_array);
        let orientation = Orientation::from_plane_and_direction(plane, direction);
        (*name, orientation.expect("ideal orientations have two directions"))
    })
}

impl FromStr for Texture {
    type Err = SpecError;

    /// Reads a sum of components, each with a weight by volume; weights are divided by their sum, and all are equal where none is given.
    ///
    /// A component is `random`; an ideal orientation with a halfwidth in degrees, `goss(10)`; a plane and a direction, `{112}<-1-11>(10)`;
    /// Euler angles and a halfwidth, `euler(30 45 60, 10)`; a fiber, `fiber(111||z, 10)` with a crystal direction along a sample
    /// direction (`x`, `y`, `z`, or `rd`, `td`, `nd`, or indices), or one by name, `gamma(10)`. A halfwidth of 0 spreads nothing.
    fn from_str(text: &str) -> Result<Self, SpecError> {
        let of_problem = |problem: String| SpecError { text: text.to_owned(), problem };
        let terms = split(text, '+').map_err(of_problem)?;
        let mut parts = Vec::new();
        for term in &terms {
            parts.push(weighted(term).map_err(of_problem)?);
        }
        let weighted_count = parts.iter().filter(|(_, weight, _)| weight.is_some()).count();
        if weighted_count != 0 && weighted_count != parts.len() {
            let without = parts.iter().find(|(_, weight, _)| weight.is_none()).map_or("", |part| &part.2);
            return Err(of_problem(format!(
                "'{without}' has no weight, others do; write '{without}*0.5', for example"
            )));
        }
        Ok(Self::sum(
            parts.into_iter().map(|(component, weight, name)| (component, weight.unwrap_or(1.0), name)),
        ))
    }
}

/// A component with its weight, if it has one, and what it is called.
fn weighted(term: &str) -> Result<(Component, Option<f64>, String), String> {
    let mut weight = None;
    let mut found: Option<(Component, String)> = None;
    for factor in split(term, '*')? {
        let factor = factor.trim();
        if let Ok(number) = factor.parse::<f64>() {
            if !(number > 0.0 && number.is_finite()) {
                return Err(format!(
                    "the weight {factor} in '{}' is not positive and finite; leave out what has no share",
                    term.trim()
                ));
            }
            weight = Some(weight.unwrap_or(1.0) * number);
        } else if found.replace((component(factor)?, factor.to_owned())).is_some() {
            return Err(format!("'{}' multiplies two components; add them with +", term.trim()));
        }
    }
    let (component, name) = found.ok_or_else(|| {
        format!("'{}' has no component; write random, or goss(10), for example", term.trim())
    })?;
    Ok((component, weight, name))
}

fn component(text: &str) -> Result<Component, String> {
    let (name, arguments) =
        match text.split_once('(') {
            None => (text, None),
            Some((name, rest)) => {
                let inside = rest.strip_suffix(')');
                (
                    name,
                    Some(inside.ok_or_else(|| {
                        format!("'{text}' goes on after its last bracket; put * or + there")
                    })?),
                )
            }
        };
    if let Some(plane) = name.trim().strip_prefix('{') {
        return peak(text, ideal(text, plane)?, arguments);
    }
    let word = plain(name);
    if let Some((_, orientation)) = ideal_orientations().find(|(known, _)| plain(known) == word) {
        return peak(text, orientation, arguments);
    }
    if let Some((_, crystal, sample)) = FIBERS.iter().find(|(known, ..)| *known == word) {
        let crystal = DVec3::from_array(*crystal).normalize();
        return fiber(crystal, *sample, halfwidth(text, arguments)?);
    }
    match (word.as_str(), arguments) {
        ("random" | "uniform", None) => Ok(Component::Random),
        ("random" | "uniform", Some(_)) => Err(format!("'{text}': random takes no argument; write random")),
        ("euler", Some(arguments)) => euler(text, arguments),
        ("fiber" | "fibre", Some(arguments)) => {
            let (pair, width) = arguments.rsplit_once(',').ok_or_else(|| fiber_form(text))?;
            let (crystal, sample) = pair.split_once("||").ok_or_else(|| fiber_form(text))?;
            fiber(
                miller::direction(crystal.trim())?,
                sample_direction(sample.trim())?,
                halfwidth(text, Some(width))?,
            )
        }
        ("euler", None) => Err("write the angles and a halfwidth: euler(30 45 60, 10)".to_owned()),
        ("fiber" | "fibre", None) => Err(fiber_form(text)),
        _ => Err(unknown(name.trim())),
    }
}

fn fiber_form(text: &str) -> String {
    format!(
        "'{text}' is not a fiber; write a crystal direction, a sample direction and a halfwidth: fiber(111||z, 10)"
    )
}

fn unknown(name: &str) -> String {
    let names = || {
        let others = ["random", "fiber", "euler"].into_iter();
        IDEAL.iter().map(|(name, ..)| *name).chain(FIBERS.iter().map(|(name, ..)| *name)).chain(others)
    };
    let word = plain(name);
    let nearest = names().map(|known| (strsim::osa_distance(&plain(known), &word), known)).min();
    match nearest {
        Some((distance, known)) if distance <= 2 && distance < known.len() => {
            format!("'{name}' is unknown; did you mean '{known}'?")
        }
        _ => format!(
            "'{name}' is unknown; there are {} and {{plane}}<direction>",
            names().collect::<Vec<_>>().join(", ")
        ),
    }
}

/// Lower case, without what may stand between words.
fn plain(name: &str) -> String {
    name.trim().to_lowercase().replace(['-', '_', ' '], "")
}

/// `112}<-1-11>`, after the brace.
fn ideal(text: &str, rest: &str) -> Result<Orientation, String> {
    let form = || format!("'{text}' is not an ideal orientation; write it as {{112}}<-1-11>(10)");
    let (plane, rest) = rest.split_once('}').ok_or_else(form)?;
    let direction = rest.trim().strip_prefix('<').and_then(|rest| rest.strip_suffix('>')).ok_or_else(form)?;
    let [plane, direction] = [miller::direction(plane)?, miller::direction(direction)?];
    if plane.dot(direction).abs() > 1e-9 {
        return Err(format!(
            "in '{text}' the direction does not lie in the plane: their product is not 0; check the signs"
        ));
    }
    Orientation::from_plane_and_direction(plane, direction).ok_or_else(form)
}

fn euler(text: &str, arguments: &str) -> Result<Component, String> {
    let words = arguments.split([' ', ',', '\t']).filter(|word| !word.is_empty());
    let numbers: Option<Vec<f64>> =
        words.map(|word| word.parse().ok().filter(|number: &f64| number.is_finite())).collect();
    match numbers.as_deref() {
        Some([phi1, phi, phi2, width]) => {
            let mode = Orientation::from_euler_degrees([*phi1, *phi, *phi2]);
            Ok(Component::Peak { mode, kernel: kernel(*width, Kernel::new)? })
        }
        _ => Err(format!("'{text}' needs three angles and a halfwidth in degrees: euler(30 45 60, 10)")),
    }
}

fn peak(text: &str, mode: Orientation, arguments: Option<&str>) -> Result<Component, String> {
    Ok(Component::Peak { mode, kernel: kernel(halfwidth(text, arguments)?, Kernel::new)? })
}

fn fiber(crystal: DVec3, sample: DVec3, width: f64) -> Result<Component, String> {
    Ok(Component::Fiber { crystal, sample, kernel: kernel(width, FiberKernel::new)? })
}

fn kernel<K>(width: f64, new: fn(f64) -> Result<K, crate::HalfwidthError>) -> Result<Option<K>, String> {
    if width == 0.0 { Ok(None) } else { new(width).map(Some).map_err(|error| error.to_string()) }
}

fn halfwidth(text: &str, arguments: Option<&str>) -> Result<f64, String> {
    let name = text.split('(').next().unwrap_or(text).trim();
    let word = arguments.ok_or_else(|| {
        format!("'{name}' needs a halfwidth in degrees: {name}(10); {name}(0) gives each grain the same")
    })?;
    let number = word.trim().parse::<f64>().ok().filter(|number| number.is_finite());
    number.ok_or_else(|| {
        format!(
            "the halfwidth '{}' of '{name}' is not a number of degrees; write 10, for example",
            word.trim()
        )
    })
}

fn sample_direction(text: &str) -> Result<DVec3, String> {
    match text.to_lowercase().as_str() {
        "x" | "rd" => Ok(DVec3::X),
        "y" | "td" => Ok(DVec3::Y),
        "z" | "nd" => Ok(DVec3::Z),
        _ => miller::direction(text).map_err(|_| {
            format!("'{text}' is not a sample direction; give x, y, z, rd, td, nd or three numbers")
        }),
    }
}

/// Parts between a separator that stands outside all brackets.
fn split(text: &str, separator: char) -> Result<Vec<&str>, String> {
    let mut depth = 0_u32;
    let mut parts = Vec::new();
    let mut start = 0;
    for (position, character) in text.char_indices() {
        match character {
            '(' | '{' | '<' => depth += 1,
            ')' | '}' | '>' => {
                depth = depth
                    .checked_sub(1)
                    .ok_or_else(|| format!("'{character}' closes nothing; take it out"))?;
            }
            _ if character == separator && depth == 0 => {
                parts.push(&text[start..position]);
                start = position + character.len_utf8();
            }
            _ => {}
        }
    }
    if depth > 0 {
        return Err("a bracket is not closed; add it".to_owned());
    }
    parts.push(&text[start..]);
    match parts.iter().any(|part| part.trim().is_empty()) {
        true => Err(format!(
            "nothing stands on one side of a '{separator}'; write random, or goss(10), for example"
        )),
        false => Ok(parts),
    }
}
