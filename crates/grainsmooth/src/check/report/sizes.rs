//! The sizes that a file's settings ask for, beside those of its grains.

use std::fmt;

use serde::Serialize;
use sizes::Spec;
use toml::Table;
use voronoi::Dimension;

use crate::config::sizes::USUAL_DIAMETERS;
use crate::grains::quantiles::quantile_volumes;
use crate::grains::sizes::cdf_distance;

/// How near the diameters of grains are to the distribution that the settings of their file ask for.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SizesFound {
    /// What is asked for, in words.
    pub asked: String,
    /// The largest difference between the share of grains up to a diameter and the distribution's.
    pub cdf_distance: f64,
    /// The same of the shares of the volume.
    pub cdf_distance_by_volume: f64,
}

/// Settings with which the distribution alone does not say what diameters grains are to have.
const OTHER_TARGETS: [&str; 6] = ["free", "gradient", "inside", "min-diameter", "phase", "volumes"];

/// What becomes of grains of some volumes (in the plane: areas); nothing where settings ask for no distribution in words, or where diameters
/// are drawn at random, which leaves open by what they are multiplied.
pub(super) fn sizes(settings: &Table, volumes: &[f64], dimension: Dimension) -> Option<SizesFound> {
    let text = |key| settings.get(key).and_then(toml::Value::as_str);
    if OTHER_TARGETS.iter().any(|key| settings.contains_key(*key)) || text("draw") == Some("random") {
        return None;
    }
    let is_packed = text("seeding") == Some("packed");
    let asked = text("diameters").or(is_packed.then_some(USUAL_DIAMETERS))?;
    let axes = dimension.axes().into();
    let distribution = asked.parse::<Spec>().ok()?.distribution(axes);
    let drawn: f64 = quantile_volumes(dimension, &distribution, volumes.len()).iter().sum();
    let scale = dimension.cube_edge(volumes.iter().sum::<f64>() / drawn);
    let diameters: Vec<f64> = volumes.iter().map(|volume| dimension.ball_diameter(*volume) / scale).collect();
    Some(SizesFound {
        asked: asked.to_owned(),
        cdf_distance: cdf_distance(diameters.clone(), &distribution, 0),
        cdf_distance_by_volume: cdf_distance(diameters, &distribution, axes),
    })
}

impl fmt::Display for SizesFound {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { asked, cdf_distance, cdf_distance_by_volume } = self;
        write!(
            out,
            "asked {asked}; distribution function within {cdf_distance:.4} (by volume {cdf_distance_by_volume:.4})"
        )
    }
}
