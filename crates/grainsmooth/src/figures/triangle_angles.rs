//! How thin triangles are, as text and for programs.

use std::fmt;

use polycrystal::TriangleQuality;
use serde::Serialize;

/// The smallest angles of triangles, in degrees.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct TriangleAngles {
    /// That of the thinnest triangle.
    pub least: f64,
    /// That which a hundredth of the triangles is below.
    pub first_percentile: f64,
    /// Number of triangles with an angle below [`TriangleQuality::BOUND`].
    pub thin: usize,
}

impl From<TriangleQuality> for TriangleAngles {
    fn from(TriangleQuality { least, first_percentile, thin }: TriangleQuality) -> Self {
        Self { least, first_percentile, thin }
    }
}

impl fmt::Display for TriangleAngles {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { least, first_percentile, thin } = self;
        write!(
            out,
            "one in a hundred has an angle below {first_percentile:.1} degrees; the least is {least:.2}"
        )?;
        match thin {
            0 => Ok(()),
            count => write!(out, ", {count} are below {}", TriangleQuality::BOUND),
        }
    }
}
