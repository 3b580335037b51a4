use glam::DVec3;

/// The smallest angles of triangles, in degrees: solvers and statistics suffer from small ones.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TriangleQuality {
    /// That of the thinnest triangle.
    pub least: f64,
    /// That which a hundredth of the triangles is below.
    pub first_percentile: f64,
    /// How many triangles are thin: their smallest angles are below [`TriangleQuality::BOUND`].
    pub thin: usize,
}

impl TriangleQuality {
    /// The smallest angle, in degrees, of a triangle that is not thin. Relaxation in space leaves no thin triangle where one can
    /// be helped by its corners moving along boundaries and lines. Flat boundaries are what their cells are.
    pub const BOUND: f64 = 1.5;
}

/// What the angles of so many triangles come to, without all of them: the smallest hundredth is kept.
#[derive(Debug, Clone)]
pub(crate) struct SmallestAngles {
    /// Rank of the percentile among all squared sines, from the smallest.
    rank: usize,
    /// The smallest squared sines, up to that rank and some more.
    smallest: Vec<f64>,
    /// No larger one can have a rank up to that.
    bound: f64,
    thin: usize,
}

impl SmallestAngles {
    /// Of none yet of so many triangles.
    pub(crate) fn new(count: usize) -> Self {
        Self { rank: count / 100, smallest: Vec::new(), bound: f64::INFINITY, thin: 0 }
    }

    /// Adds a triangle by the squared sine of its smallest angle.
    pub(crate) fn add(&mut self, squared_sine: f64) {
        if squared_sine < TriangleQuality::BOUND.to_radians().sin().powi(2) {
            self.thin += 1;
        }
        if squared_sine <= self.bound {
            self.smallest.push(squared_sine);
            self.select_if_many();
        }
    }

    /// The same with other triangles of the same.
    pub(crate) fn with(mut self, other: Self) -> Self {
        self.thin += other.thin;
        self.smallest.extend(other.smallest);
        self.bound = self.bound.min(other.bound);
        self.select_if_many();
        self
    }

    fn select_if_many(&mut self) {
        if self.smallest.len() > 2 * (self.rank + 1) + 100 {
            self.select();
        }
    }

    /// Forgets what is beyond the rank.
    fn select(&mut self) {
        let (_, at, _) = self.smallest.select_nth_unstable_by(self.rank, f64::total_cmp);
        self.bound = *at;
        self.smallest.truncate(self.rank + 1);
    }

    /// The quality of all triangles; nothing where there are none.
    pub(crate) fn quality(mut self) -> Option<TriangleQuality> {
        if self.smallest.is_empty() {
            return None;
        }
        self.select();
        let least = self.smallest.iter().copied().fold(f64::INFINITY, f64::min);
        let [least, first_percentile] = [least, self.bound].map(|squared| squared.sqrt().asin().to_degrees());
        Some(TriangleQuality { least, first_percentile, thin: self.thin })
    }
}

/// The square of the sine of a triangle's smallest angle, which is across from its shortest side; 0 where two corners are one.
pub(crate) fn squared_sine([a, b, c]: [DVec3; 3]) -> f64 {
    let sides = [b - a, c - b, a - c].map(DVec3::length_squared);
    let product: f64 = sides.iter().product();
    let shortest = sides.into_iter().fold(f64::INFINITY, f64::min);
    if product == 0.0 { 0.0 } else { (b - a).cross(c - a).length_squared() * shortest / product }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn quality(sines: &[f64]) -> Option<TriangleQuality> {
        let angles = |sines: &[f64], count: usize| {
            let mut angles = SmallestAngles::new(count);
            sines.iter().for_each(|squared| angles.add(*squared));
            angles
        };
        let [first, second] = [&sines[..sines.len() / 3], &sines[sines.len() / 3..]];
        let quality = angles(first, sines.len()).with(angles(second, sines.len())).quality();
        assert_eq!(quality, angles(sines, sines.len()).quality());
        quality
    }

    #[test]
    fn one_thin_triangle_of_many_is_the_least_but_not_the_percentile() {
        let mut sines = vec![squared_sine([DVec3::ZERO, DVec3::X, DVec3::Y]); 150];
        sines[70] = squared_sine([DVec3::ZERO, DVec3::X, DVec3::new(1.0, 0.1, 0.0)]);
        let thin = quality(&sines).expect("triangles");
        assert!((thin.least - 0.1f64.atan().to_degrees()).abs() < 1e-12);
        assert!((thin.first_percentile - 45.0).abs() < 1e-12);
        assert_eq!(quality(&[]), None);
    }

    #[test]
    fn the_percentile_is_that_of_all_sorted() {
        for count in [1, 99, 100, 1234, 5000] {
            let mut sines: Vec<f64> = (0..count).map(|k| f64::from(k * 7919 % 10_007) / 10_007.0).collect();
            let found = quality(&sines).expect("triangles");
            sines.sort_unstable_by(f64::total_cmp);
            let degrees = |squared: f64| squared.sqrt().asin().to_degrees();
            assert_eq!(
                [found.least, found.first_percentile],
                [sines[0], sines[sines.len() / 100]].map(degrees)
            );
        }
    }
}
