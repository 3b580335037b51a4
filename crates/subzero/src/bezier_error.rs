//! Why a Bezier curve or surface cannot be made.

/// Why control points, or what is made of them, were refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BezierError {
    /// A Bezier curve or surface without control points.
    #[error("a Bezier curve or surface needs at least one control point")]
    NoControlPoints,
    /// The control points of a Bezier surface form no grid.
    #[error(
        "row {row} of the control points has {found} points, but the first row has {length}; make all rows equally long"
    )]
    RaggedControlPoints {
        /// The first row that differs.
        row: usize,
        /// Points in the first row.
        length: usize,
        /// Points in that row.
        found: usize,
    },
    /// More points or half-edges of a tessellation than 32-bit ids can count.
    #[error("{count} {what} are too many: ids are 32 bits wide; use fewer steps or part of the surfaces")]
    TooLarge {
        /// What there are too many of.
        what: &'static str,
        /// How many there are.
        count: usize,
    },
}
