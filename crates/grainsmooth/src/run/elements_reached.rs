//! What became of a wish for elements of a size.

use std::fmt;

use polycrystal::{MergedLine, NarrowTriangles};
use serde::Serialize;

use crate::Names;

/// What became of a wish for elements of a size.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ElementsReached {
    /// Length of edges that was asked for, in the unit of the box.
    pub size: f64,
    /// That of the edges on the mean.
    pub mean_edge: f64,
    /// How often elements became smaller somewhere, because boundaries crossed or folded there.
    pub refinements: usize,
    /// Triangles with a small angle; nothing in the plane, where the mesh between lines is made later.
    pub narrow: Option<TrianglesNarrow>,
    /// Lines shorter than the elements that became points, the shortest first.
    pub merged_lines: Vec<LineMerged>,
}

/// Triangles with an angle below [`NarrowTriangles::BOUND`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct TrianglesNarrow {
    /// How many there are.
    pub count: usize,
    /// Those in corners and strips between lines that are as narrow.
    pub between_lines: usize,
}

impl From<NarrowTriangles> for TrianglesNarrow {
    fn from(NarrowTriangles { count, between_lines }: NarrowTriangles) -> Self {
        Self { count, between_lines }
    }
}

/// A line that became a point.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LineMerged {
    /// Where the point was put.
    pub place: [f64; 3],
    /// Length of the line.
    pub length: f64,
    /// The grains that meet at the point, as files number them.
    pub grains: Vec<i32>,
}

impl LineMerged {
    pub(crate) fn new(line: &MergedLine, names: Names) -> Self {
        let grains = line.grains.iter().map(|grain| names.number(*grain)).collect();
        Self { place: line.place.to_array(), length: line.length, grains }
    }
}

impl fmt::Display for LineMerged {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { place: [x, y, z], length, grains } = self;
        let grains: Vec<String> = grains.iter().map(i32::to_string).collect();
        write!(out, "one of {length:.3e} between grains {} at ({x:.4}, {y:.4}, {z:.4})", grains.join(", "))
    }
}

impl fmt::Display for ElementsReached {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { size, mean_edge, refinements, narrow, .. } = self;
        write!(out, "edges of {size:.4e} asked for, {mean_edge:.4e} on the mean")?;
        if let Some(TrianglesNarrow { count: count @ 1.., between_lines }) = narrow {
            let bound = NarrowTriangles::BOUND;
            write!(
                out,
                "; {count} triangles below {bound} degrees, {between_lines} of them in corners and strips between lines"
            )?;
        }
        match refinements {
            0 => {}
            1 => write!(out, "; smaller in a place where boundaries folded or crossed")?,
            times => write!(out, "; smaller in places where boundaries folded or crossed, {times} times")?,
        }
        Ok(())
    }
}
