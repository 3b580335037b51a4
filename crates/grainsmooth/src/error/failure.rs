//! A run that failed after its cells were made.

use std::fmt;

use polycrystal::{Attempt, NetworkError};
use voronoi::Dimension;

use super::failed_grain::FailedGrain;

/// Why no network could be made of some cells. In words it is one line: what went wrong last, with whom, and what helps.
#[derive(Debug)]
pub struct Failure {
    /// Of the cells.
    pub dimension: Dimension,
    /// What went wrong on the last way that was tried.
    pub cause: NetworkError,
    /// The grain that it failed at, if it is about grains.
    pub grain: Option<FailedGrain>,
    /// What helps where grains cannot grow freely for so long.
    pub growth: Option<Growth>,
    /// Whether short lines were kept, and all goes well where they may go.
    pub works_without_short_lines: bool,
    /// The grains around each line of the cells (in the plane: point) where one tension exceeds the sum of the others.
    pub without_equilibrium: Vec<Vec<u32>>,
    /// Whether grains were to have given shapes.
    pub has_shapes: bool,
    /// What was tried before, and what each attempt said.
    pub attempts: Vec<Attempt>,
}

/// What is known of grains that cannot grow freely for as long as asked.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Growth {
    /// They can for this time.
    Until(f64),
    /// They cannot for any time that was tried.
    Never,
}

impl Failure {
    /// The same, with what helps where grains grow.
    pub(crate) fn with_growth(self, growth: Growth) -> Self {
        Self { growth: Some(growth), ..self }
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "{}", self.cause)?;
        if let Some(grain) = &self.grain {
            write!(out, "; {grain}")?;
        }
        if let [first, ..] = &self.without_equilibrium[..] {
            // No merged cell helps where tensions leave nothing at rest.
            return write!(
                out,
                "; at {} triple {} one tension exceeds the sum of the others, as of grains {}, and nothing is at rest there: give tensions of which none is above twice the least",
                self.without_equilibrium.len(),
                if self.dimension == Dimension::Two { "points" } else { "lines" },
                line_name(first)
            );
        }
        if self.has_shapes && !matches!(self.growth, Some(Growth::Until(_))) {
            return write!(out, "; give --grain-shapes a lower ratio, or other seeds");
        }
        if self.works_without_short_lines {
            return write!(out, "; without --regularize 0, which keeps short triple lines, it works");
        }
        if self.grain.is_some_and(|grain| grain.is_tiny()) {
            write!(out, ", too small beside the others")?;
        }
        match (self.growth, self.grain.and_then(|grain| grain.least_diameter())) {
            (Some(Growth::Until(time)), _) => write!(out, "; --relax {time} works"),
            (Some(Growth::Never), _) => write!(
                out,
                "; no shorter time that was tried works: merge the smallest cells, such as with --min-diameter 0.5"
            ),
            (None, Some(diameter)) => write!(out, "; merge such cells with --min-diameter {diameter}"),
            (None, None) => Ok(()),
        }
    }
}

/// The numbers of grains around a line, as messages name it.
pub(crate) fn line_name(grains: &[u32]) -> String {
    grains.iter().map(u32::to_string).collect::<Vec<_>>().join("-")
}
