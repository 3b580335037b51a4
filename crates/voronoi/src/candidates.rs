//! The planes that may bound a cell, in arrays that loops without branches run over.

use glam::DVec3;

use crate::generator::Generator;
use crate::half_space::HalfSpace;

/// Coordinates of planes `normal . y <= offset`, and bounds on what their rounding errors are relative to.
#[derive(Debug, Default)]
pub(crate) struct Candidates {
    generators: Vec<Generator>,
    x: Vec<f64>,
    y: Vec<f64>,
    z: Vec<f64>,
    offsets: Vec<f64>,
    /// Where each plane meets the edge last looked at.
    crossings: Vec<f64>,
    /// Largest 1-norm of a normal.
    pub(crate) largest_sum: f64,
    /// Largest size of an offset's terms.
    pub(crate) largest_offset_size: f64,
}

impl Candidates {
    pub(crate) fn clear(&mut self) {
        self.generators.clear();
        for column in [&mut self.x, &mut self.y, &mut self.z, &mut self.offsets] {
            column.clear();
        }
        (self.largest_sum, self.largest_offset_size) = (0.0, 0.0);
    }

    pub(crate) fn len(&self) -> usize {
        self.generators.len()
    }

    pub(crate) fn generators(&self) -> &[Generator] {
        &self.generators
    }

    /// Adds a plane; `sum` and `offset_size` may be bounds.
    #[inline]
    pub(crate) fn push(&mut self, generator: Generator, normal: DVec3, offset: f64, offset_size: f64) {
        self.generators.push(generator);
        self.x.push(normal.x);
        self.y.push(normal.y);
        self.z.push(normal.z);
        self.offsets.push(offset);
        self.largest_sum = self.largest_sum.max(normal.abs().element_sum());
        self.largest_offset_size = self.largest_offset_size.max(offset_size);
    }

    pub(crate) fn push_plane(&mut self, plane: &HalfSpace) {
        self.push(plane.generator, plane.normal, plane.offset, plane.offset_size);
    }

    /// Works out how far along a ray each candidate from number `first` on cuts it, in units of `direction`; candidates whose
    /// normals lie along the ray by at most `threshold` do not.
    pub(crate) fn cross(&mut self, first: usize, start: DVec3, direction: DVec3, threshold: f64) {
        let count = self.generators.len() - first;
        self.crossings.clear();
        self.crossings.resize(count, f64::INFINITY);
        let (x, y, z) = (&self.x[first..][..count], &self.y[first..][..count], &self.z[first..][..count]);
        let (offsets, crossings) = (&self.offsets[first..][..count], &mut self.crossings[..count]);
        for c in 0..count {
            let slope = x[c] * direction.x + y[c] * direction.y + z[c] * direction.z;
            let gap = offsets[c] - (x[c] * start.x + y[c] * start.y + z[c] * start.z);
            let crossing = gap / slope;
            crossings[c] = if slope > threshold { crossing } else { f64::INFINITY };
        }
    }

    /// The first plane that the ray meets after the last [`Self::cross`], by its number among those crossed, and where.
    pub(crate) fn first_crossing(&self) -> (usize, f64) {
        let nearest =
            self.crossings.iter().fold(f64::INFINITY, |least, t| if *t < least { *t } else { least });
        (self.crossings.iter().position(|t| *t == nearest).unwrap_or(0), nearest)
    }

    /// Takes a plane out of the reckoning.
    pub(crate) fn forget_crossing(&mut self, number: usize) {
        self.crossings[number] = f64::INFINITY;
    }

    /// How far a point lies beyond a plane.
    pub(crate) fn excess(&self, candidate: usize, point: DVec3) -> f64 {
        let (x, y, z) = (self.x[candidate], self.y[candidate], self.z[candidate]);
        x * point.x + y * point.y + z * point.z - self.offsets[candidate]
    }

    /// Number of planes from which the point is at most `slack` inside.
    pub(crate) fn count_beyond(&self, point: DVec3, slack: f64) -> usize {
        let count = self.generators.len();
        let (x, y, z) = (&self.x[..count], &self.y[..count], &self.z[..count]);
        let offsets = &self.offsets[..count];
        let mut beyond = 0usize;
        for c in 0..count {
            let excess = x[c] * point.x + y[c] * point.y + z[c] * point.z - offsets[c];
            beyond += usize::from(excess >= -slack);
        }
        beyond
    }
}
