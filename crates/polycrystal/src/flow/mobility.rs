use glam::DVec3;

use crate::Freedom;

/// How an unknown answers to a force if there were only the diagonal of the matrix.
pub(crate) struct Mobility {
    /// 1 over the diagonal.
    pub(crate) inverse: f64,
    /// What the walls leave to it.
    pub(crate) freedom: Freedom,
}

impl Mobility {
    /// The displacement under a force.
    pub(crate) fn of(&self, force: DVec3) -> DVec3 {
        self.freedom.project(force) * self.inverse
    }
}
