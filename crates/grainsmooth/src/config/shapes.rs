//! What is asked of the shapes of single grains.

use std::fmt;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use voronoi::Dimension;

use super::table_file::is_table_file;

/// How many times as long as wide a grain may be: one of 5:1:1 takes nine cells, one of 10:1:1 nineteen.
pub(crate) const MOST_RATIO: f64 = 10.0;

/// Where the shapes of grains come from.
#[derive(Debug, Clone, PartialEq)]
pub enum ShapeSource {
    /// One for all.
    Alike(ShapeSpec),
    /// A file with the shape of each grain.
    File(PathBuf),
}

/// An ellipsoid (in the plane: an ellipse) in words, such as `3:1:1 aligned`.
#[derive(Debug, Clone, PartialEq)]
pub struct ShapeSpec {
    /// Lengths in proportion: two in the plane, else three.
    pub lengths: Vec<f64>,
    /// Whether lengths are along x, y and z; else each grain has a direction of its own, at random.
    pub is_aligned: bool,
}

impl ShapeSource {
    /// A file where one has this name, or the name ends as those of tables do; else words.
    ///
    /// # Errors
    /// What is wrong with the words.
    pub fn parse(text: &str) -> Result<Self, String> {
        let path = Path::new(text);
        if is_table_file(path) {
            return Ok(Self::File(path.to_owned()));
        }
        text.parse().map(Self::Alike)
    }

    /// Checks that shapes are of a dimension.
    ///
    /// # Errors
    /// What to give instead.
    pub fn check(&self, dimension: Dimension) -> Result<(), &'static str> {
        match (self, dimension) {
            (Self::Alike(spec), Dimension::Two) if spec.lengths.len() != 2 => {
                Err("--grain-shapes takes two lengths, such as 2:1, with --dim 2")
            }
            (Self::Alike(spec), Dimension::Three) if spec.lengths.len() != 3 => {
                Err("--grain-shapes takes three lengths, such as 2:1:1, without --dim 2")
            }
            _ => Ok(()),
        }
    }
}

/// Whether lengths are positive and differ by no more than the largest ratio.
pub(crate) fn are_good_lengths(lengths: &[f64]) -> bool {
    let longest = lengths.iter().copied().fold(0.0, f64::max);
    lengths.iter().all(|length| length.is_finite() && *length > 0.0 && *length * MOST_RATIO >= longest)
}

impl FromStr for ShapeSpec {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let mut words = text.split([' ', ',']).filter(|word| !word.is_empty());
        let lengths: Option<Vec<f64>> =
            words.next().unwrap_or_default().split(':').map(|number| number.parse().ok()).collect();
        let is_aligned = match words.next() {
            None | Some("random") => Some(false),
            Some("aligned") => Some(true),
            Some(_) => None,
        };
        match (lengths, is_aligned, words.next()) {
            (Some(lengths), Some(is_aligned), None) if (2..=3).contains(&lengths.len()) => {
                if !are_good_lengths(&lengths) {
                    return Err(format!(
                        "lengths are positive, and the longest at most {MOST_RATIO} times the shortest"
                    ));
                }
                Ok(Self { lengths, is_aligned })
            }
            _ => Err("give lengths in proportion and whether they are along x, y, z, such as 2:1:1 or '3:1:1 aligned', or a file".to_owned()),
        }
    }
}

impl fmt::Display for ShapeSource {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Alike(ShapeSpec { lengths, is_aligned }) => {
                let lengths: Vec<String> = lengths.iter().map(f64::to_string).collect();
                write!(out, "{}{}", lengths.join(":"), if *is_aligned { " aligned" } else { "" })
            }
            Self::File(path) => path.display().fmt(out),
        }
    }
}
