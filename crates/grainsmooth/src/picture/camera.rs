use glam::DVec3;

use super::{Picture, patch::Patch};

/// A parallel projection that fits the scene into the picture.
pub(super) struct Camera {
    right: DVec3,
    up: DVec3,
    /// From the scene to the viewer.
    pub(super) toward: DVec3,
    /// Samples per unit of length.
    pub(super) scale: f64,
    /// What the middle of the scene lies at, in units of length, and of the picture, in samples.
    middle: [f64; 2],
    center: [f64; 2],
}

impl Camera {
    /// Looks at the scene from above its upper front edge; z is up. `samples` is the size of the picture.
    pub(super) fn new(patches: &[Patch], samples: [f64; 2]) -> Self {
        // Turned so that the two upright faces of a box show unequal parts, which tells them apart.
        let toward = DVec3::new(0.55, -0.95, 0.62).normalize();
        Self::toward(toward, DVec3::Z, patches.iter().flat_map(|patch| &patch.points), samples)
    }

    /// Looks at points as [`new`](Self::new) does; from straight above where they lie in a plane of one z.
    pub(super) fn of_points<'a>(points: impl Iterator<Item = &'a DVec3> + Clone, samples: [f64; 2]) -> Self {
        let first = points.clone().next().map_or(0.0, |point| point.z);
        if points.clone().all(|point| point.z == first) {
            return Self::toward(DVec3::Z, DVec3::Y, points, samples);
        }
        let toward = DVec3::new(0.55, -0.95, 0.62).normalize();
        Self::toward(toward, DVec3::Z, points, samples)
    }

    fn toward<'a>(
        toward: DVec3,
        above: DVec3,
        points: impl Iterator<Item = &'a DVec3>,
        samples: [f64; 2],
    ) -> Self {
        let right = above.cross(toward).normalize();
        let up = toward.cross(right);
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for point in points {
            for (axis, place) in [point.dot(right), point.dot(up)].into_iter().enumerate() {
                low[axis] = low[axis].min(place);
                high[axis] = high[axis].max(place);
            }
        }
        let inner = 1.0 - 2.0 * Picture::MARGIN;
        let scale = [0, 1].map(|axis| inner * samples[axis] / (high[axis] - low[axis]));
        Self {
            right,
            up,
            toward,
            // A single point has no size.
            scale: Some(scale[0].min(scale[1])).filter(|scale| scale.is_finite()).unwrap_or(1.0),
            middle: [0, 1].map(|axis| low[axis].midpoint(high[axis])),
            center: samples.map(|side| side / 2.0),
        }
    }

    /// Place of a point in samples from the upper left, and how near to the viewer it is, in samples too.
    pub(super) fn project(&self, point: DVec3) -> DVec3 {
        DVec3::new(
            self.center[0] + self.scale * (point.dot(self.right) - self.middle[0]),
            self.center[1] - self.scale * (point.dot(self.up) - self.middle[1]),
            self.scale * point.dot(self.toward),
        )
    }

    /// How bright a surface of this unit normal is, from 0 to 1: light over the viewer's left shoulder, and some from everywhere.
    pub(super) fn brightness(&self, normal: DVec3) -> f64 {
        let light = (self.toward + 0.5 * self.up - 0.4 * self.right).normalize();
        0.5 + 0.5 * normal.dot(light).max(0.0)
    }
}
