//! Colours of meshes and curves by numbers.

use colorous::VIRIDIS;

use super::color::{Color, channels, kind};
use super::legend::Legend;
use crate::figures::significant::significant;

/// Most whole numbers that have a colour each: as many as readers can tell apart.
const MOST_KINDS: usize = 8;

/// Where there is no number: grey.
const NO_NUMBER: Color = [0.75; 3];

/// The numbers that a mesh or curves are coloured by.
#[derive(Debug, Clone, PartialEq)]
pub struct SceneColors {
    /// What they are.
    pub name: String,
    /// One for each part.
    pub numbers: SceneNumbers,
}

/// What numbers belong to.
#[derive(Debug, Clone, PartialEq)]
pub enum SceneNumbers {
    /// The points.
    OfPoints(Vec<f64>),
    /// The faces; of curves the polylines.
    OfCells(Vec<f64>),
}

/// The colour of each number.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum ColorScale {
    /// Few whole numbers, each with a colour of its own.
    Kinds { name: String, numbers: Vec<f64> },
    /// From the least to the greatest.
    Range { name: String, ends: [f64; 2] },
}

impl ColorScale {
    /// One for the numbers of all scenes; nothing where there are none.
    pub(super) fn new<'a>(mut all: impl Iterator<Item = &'a SceneColors> + Clone) -> Option<Self> {
        let numbers = all.clone().flat_map(|colors| colors.numbers.all());
        let mut numbers: Vec<f64> = numbers.copied().collect();
        let name = all.next()?.name.clone();
        numbers.retain(|number| number.is_finite());
        numbers.sort_unstable_by(f64::total_cmp);
        numbers.dedup();
        let [least, .., greatest] = numbers[..] else {
            return Some(Self::Kinds { name, numbers });
        };
        let are_kinds = numbers.len() <= MOST_KINDS && numbers.iter().all(|number| number.fract() == 0.0);
        Some(if are_kinds {
            Self::Kinds { name, numbers }
        } else {
            Self::Range { name, ends: [least, greatest] }
        })
    }

    pub(super) fn color(&self, number: f64) -> Color {
        match self {
            _ if !number.is_finite() => NO_NUMBER,
            Self::Kinds { numbers, .. } => {
                kind(numbers.iter().position(|known| *known == number).unwrap_or_default())
            }
            Self::Range { ends: [least, greatest], .. } => {
                channels(VIRIDIS.eval_continuous((number - least) / (greatest - least)))
            }
        }
    }

    pub(super) fn legend(&self) -> Legend {
        match self {
            Self::Kinds { name, numbers } => Legend::Names(
                numbers.iter().map(|number| (self.color(*number), format!("{name} {number}"))).collect(),
            ),
            Self::Range { name, ends } => {
                Legend::Bar { title: name.clone(), ends: ends.map(|end| significant(end, 4)) }
            }
        }
    }
}

impl SceneNumbers {
    fn all(&self) -> &[f64] {
        match self {
            Self::OfPoints(numbers) | Self::OfCells(numbers) => numbers,
        }
    }

    /// That of a corner of a cell.
    pub(super) fn at(&self, cell: usize, point: u32) -> f64 {
        match self {
            Self::OfPoints(numbers) => numbers[point as usize],
            Self::OfCells(numbers) => numbers[cell],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scale_of(numbers: &[&[f64]]) -> Option<ColorScale> {
        let colors = numbers.iter().map(|numbers| SceneColors {
            name: "Height".to_owned(),
            numbers: SceneNumbers::OfCells(numbers.to_vec()),
        });
        ColorScale::new(colors.collect::<Vec<_>>().iter())
    }

    #[test]
    fn few_whole_numbers_are_kinds() {
        let scale = scale_of(&[&[3.0, 1.0], &[f64::NAN, -1.0]]).unwrap();
        assert_eq!([-1.0, 1.0, 3.0].map(|number| scale.color(number)), [0, 1, 2].map(kind));
        assert_eq!(scale.color(f64::NAN), NO_NUMBER);
        let Legend::Names(names) = scale.legend() else { panic!("a bar") };
        assert_eq!(names[2], (kind(2), "Height 3".to_owned()));
    }

    #[test]
    fn many_numbers_have_a_range_and_none_have_a_key() {
        let numbers: Vec<f64> = (0..20).map(|number| 0.5 * f64::from(number)).collect();
        let scale = scale_of(&[&numbers]).unwrap();
        assert_eq!(scale.color(9.5), channels(VIRIDIS.eval_continuous(1.0)));
        let bar = Legend::Bar { title: "Height".to_owned(), ends: ["0".to_owned(), "9.5".to_owned()] };
        assert_eq!(scale.legend(), bar);
        assert_eq!(scale_of(&[]), None);
        // One number alone has no range.
        let one = scale_of(&[&[0.25, f64::INFINITY]]).unwrap();
        assert_eq!(one.color(0.25), kind(0));
    }
}
