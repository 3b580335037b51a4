/// Whether grains keep their volumes (in the plane: areas).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Volumes {
    /// Each grain has the volume of its cell on the finest level.
    #[default]
    Kept,
    /// Grains grow and shrink as curvature has them: grain growth, as long as no boundary vanishes.
    Free,
}
