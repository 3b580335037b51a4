/// How triple lines and the domain's edges are smoothed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Junctions {
    /// As cubic B-splines between quadruple points.
    #[default]
    Crease,
    /// Not at all: every control point on them is a corner, and they stay polylines.
    Corner,
}
