use polycrystal::AngleStatistics;
use serde::Serialize;

/// Mean and standard deviation.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Spread {
    /// Mean.
    pub mean: f64,
    /// Standard deviation.
    pub standard_deviation: f64,
}

impl Spread {
    /// That of some values; the standard deviation is that of these, not an estimate for more. Nothing of nothing.
    pub(crate) fn of(values: &[f64]) -> Option<Self> {
        let count = values.len() as f64;
        let mean = values.iter().sum::<f64>() / count;
        let variance = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / count;
        (!values.is_empty()).then_some(Self { mean, standard_deviation: variance.sqrt() })
    }
}

impl From<AngleStatistics> for Spread {
    fn from(angles: AngleStatistics) -> Self {
        Self { mean: angles.mean, standard_deviation: angles.standard_deviation }
    }
}
