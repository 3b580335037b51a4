//! What is asked of the triangles on boundaries.

use clap::{Args, ValueEnum};
use serde::Serialize;

use super::spelling::{is_usual, length, number};

/// What is asked of the triangles on boundaries, as finite elements need them.
#[derive(Debug, Clone, Copy, PartialEq, Default, Args, Serialize)]
#[command(next_help_heading = "Finite elements")]
#[serde(rename_all = "kebab-case")]
pub struct ElementOptions {
    /// Remesh boundaries with triangles whose edges are H long, in the unit of --box
    ///
    /// Example: --element-size 0.02
    #[arg(long, value_name = "H", value_parser = element_size, allow_negative_numbers = true, conflicts_with = "elements_per_grain")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub element_size: Option<f64>,

    /// Set the edge length to 1/K of the mean grain diameter instead
    ///
    /// Example: --elements-per-grain 5 --relax equilibrium
    #[arg(long, value_name = "K", value_parser = number(0.1..=1000.0, "give a number from 0.1 to 1000"), allow_negative_numbers = true)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub elements_per_grain: Option<f64>,

    /// Use smaller triangles where boundaries are curved: edges no longer than S times the radius of curvature
    ///
    /// Example: --elements-per-grain 5 --adapt-curvature 0.3
    #[arg(long, value_name = "S", value_parser = number(0.01..=10.0, "give a share of the radius from 0.01 to 10"), allow_negative_numbers = true)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub adapt_curvature: Option<f64>,

    /// How fast edges may grow with the distance from short triple lines and other narrow places, as length per length
    /// [default: 0.4]
    ///
    /// Example: --elements-per-grain 5 --size-growth 0.2
    #[arg(long, value_name = "G", value_parser = number(0.01..=10.0, "give a growth from 0.01 to 10"), allow_negative_numbers = true)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub size_growth: Option<f64>,

    /// Keep triple lines that are shorter than the elements, with smaller elements around them (keep), or turn them into points
    /// where every grain stays a closed ball (merge)
    ///
    /// Example: --elements-per-grain 3 --small-features merge
    #[arg(long, value_name = "RULE", value_enum, default_value_t)]
    #[serde(skip_serializing_if = "is_usual")]
    pub small_features: SmallFeatures,
}

/// What becomes of lines shorter than the elements.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum SmallFeatures {
    /// They stay, with smaller elements around.
    #[default]
    Keep,
    /// They become points.
    Merge,
}

impl ElementOptions {
    /// Whether boundaries are to have triangles of a size.
    pub fn are_asked(&self) -> bool {
        self.element_size.is_some() || self.elements_per_grain.is_some()
    }
}

fn element_size(text: &str) -> Result<f64, String> {
    length(text).ok_or_else(|| "an element size is a positive number between 1e-30 and 1e30".to_owned())
}
