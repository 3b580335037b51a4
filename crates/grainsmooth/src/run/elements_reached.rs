//! What became of a wish for elements of a size.

use std::fmt;

use serde::Serialize;

/// What became of a wish for elements of a size.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ElementsReached {
    /// Length of edges that was asked for, in the unit of the box.
    pub size: f64,
    /// That of the edges on the mean.
    pub mean_edge: f64,
    /// How often elements became smaller somewhere, because boundaries crossed or folded there.
    pub refinements: usize,
}

impl fmt::Display for ElementsReached {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { size, mean_edge, refinements } = self;
        write!(out, "edges of {size:.4e} asked for, {mean_edge:.4e} on the mean")?;
        match refinements {
            0 => Ok(()),
            1 => write!(out, "; smaller in a place where boundaries folded or crossed"),
            times => write!(out, "; smaller in places where boundaries folded or crossed, {times} times"),
        }
    }
}
