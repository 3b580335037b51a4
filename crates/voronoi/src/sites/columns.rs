use glam::DVec3;

/// Sites by index: their numbers, their coordinates, and their weights if there are any.
#[derive(Clone, Copy)]
pub(crate) struct Columns<'a> {
    pub(crate) sites: &'a [u32],
    pub(crate) x: &'a [f64],
    pub(crate) y: &'a [f64],
    pub(crate) z: &'a [f64],
    pub(crate) weights: Option<&'a [f64]>,
}

impl Columns<'_> {
    #[inline(always)]
    pub(crate) fn position(&self, index: usize) -> DVec3 {
        DVec3::new(self.x[index], self.y[index], self.z[index])
    }

    #[inline(always)]
    pub(crate) fn weight(&self, index: usize) -> f64 {
        self.weights.map_or(0.0, |weights| weights[index])
    }
}
