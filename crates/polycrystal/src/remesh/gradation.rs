//! Sizes between the vertices at which they are known.

use glam::DVec3;

/// How sizes grow away from where they are small. Edges of the smooth network may be much longer than sizes at their ends: caps of a box that cuts grains have such.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Gradation {
    /// By how much sizes grow per length.
    pub(crate) growth: f64,
    /// The size asked for: none is larger.
    pub(crate) most: f64,
}

impl Gradation {
    /// The size at a place, from the places around and the sizes there.
    pub(crate) fn size<const N: usize>(&self, place: DVec3, around: [(DVec3, f64); N]) -> f64 {
        around.iter().map(|(from, size)| size + self.growth * place.distance(*from)).fold(self.most, f64::min)
    }

    /// An edge of some length between two sizes.
    pub(crate) fn edge(&self, length: f64, [from, to]: [f64; 2]) -> GradedEdge {
        let crest = (0.5 * (from + to + self.growth * length)).min(self.most).max(from).max(to);
        let slope = |size: f64| ((crest - size) / self.growth, (crest / size).ln() / self.growth);
        let ([rise, fall], sizes) = ([slope(from), slope(to)], [from, to]);
        let level = (length - rise.0 - fall.0).max(0.0);
        GradedEdge {
            length,
            growth: self.growth,
            sizes,
            crest,
            rise: rise.1,
            level: level / crest,
            fall: fall.1,
        }
    }
}

/// An edge along which sizes grow from both ends to a crest, and stay at it between.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct GradedEdge {
    length: f64,
    growth: f64,
    /// At the ends.
    sizes: [f64; 2],
    crest: f64,
    /// Number of segments of the size of each place: up to the crest, on it, and down from it.
    rise: f64,
    level: f64,
    fall: f64,
}

impl GradedEdge {
    /// How many segments of the size of each place the edge has.
    pub(crate) fn segments(&self) -> f64 {
        self.rise + self.level + self.fall
    }

    /// The share of the length after so many segments.
    pub(crate) fn share(&self, segments: f64) -> f64 {
        let grown = |size: f64, segments: f64| size * (self.growth * segments).exp_m1() / self.growth;
        let left = self.segments() - segments;
        let along = if segments < self.rise {
            grown(self.sizes[0], segments)
        } else if left < self.fall {
            self.length - grown(self.sizes[1], left)
        } else {
            grown(self.sizes[0], self.rise) + (segments - self.rise) * self.crest
        };
        (along / self.length).clamp(0.0, 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GRADATION: Gradation = Gradation { growth: 0.5, most: 2.0 };

    #[test]
    fn sizes_grow_from_the_nearest_small_one_up_to_the_one_asked_for() {
        let ends = [(DVec3::ZERO, 0.1), (10.0 * DVec3::X, 1.0)];
        for (place, size) in [(0.0, 0.1), (1.0, 0.6), (5.0, 2.0), (9.0, 1.5), (10.0, 1.0)] {
            assert!((GRADATION.size(place * DVec3::X, ends) - size).abs() < 1e-15);
        }
    }

    #[test]
    fn segments_are_the_integral_of_one_over_the_size() {
        for (length, sizes) in [(10.0, [0.1, 1.0]), (0.3, [0.1, 0.12]), (4.0, [2.0, 2.0]), (1.0, [0.5, 1.0])]
        {
            let edge = GRADATION.edge(length, sizes);
            let ends = [(DVec3::ZERO, sizes[0]), (length * DVec3::X, sizes[1])];
            let steps = 100_000;
            let mut sum = 0.0;
            for step in 0..steps {
                let share = (f64::from(step) + 0.5) / f64::from(steps);
                sum += length / f64::from(steps) / GRADATION.size(share * length * DVec3::X, ends);
                if step % 9973 == 0 {
                    assert!((edge.share(sum) - share).abs() < 1e-4, "{sizes:?} at {share}");
                }
            }
            assert!((edge.segments() - sum).abs() < 1e-6 * sum, "{sizes:?}: {} and {sum}", edge.segments());
        }
    }
}
